#!/usr/bin/python3
# SPDX-License-Identifier: Zlib
"""Tests claims of papers and engines: runs the commands of experiments/claims and fails where a verdict differs."""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CLAIMS, PAPERS = ROOT / "experiments" / "claims", ROOT / "docs" / "references.bib"
BEGIN, END = "<!-- claims -->", "<!-- end -->"
VERDICTS = ("confirmed", "refuted", "depends")
NEEDED = ("title", "statement", "source", "runs", "says", "verdict", "because")
OPTIONAL = ("differs", "shows")
EXAMPLE = """example:
  reports/claims.py --into docs/claims.md
  reports/claims.py --only "Naive Jacobi\""""


class UserError(Exception):
    """A mistake of the user: one line on stderr, exit code 2."""


def series_of(name):
    """(step, series) of a name: last_SERIES has no step, a metric has neither."""
    found = re.fullmatch(r"last_(?P<last>\w+)|after_(?P<step>\d+)_(?P<after>\w+)", name)
    return (found["step"] and int(found["step"]), found["last"] or found["after"]) if found else (None, None)


@dataclass
class Run:
    """One `lpc run`, with outcome, step, metrics, last_SERIES and after_STEP_SERIES as attributes. `seen`: those read so far."""
    command: str
    result: dict
    seen: list = field(default_factory=list)

    def __getattr__(self, name):
        value = self.value(name)
        if name not in self.seen:
            self.seen.append(name)
        return value

    def value(self, name):
        if name in ("outcome", "step"):
            return self.result[name]
        step, series = series_of(name)
        values = self.result["series"].get(series, [])[step or 0:] if series else []
        value = self.result["metrics"].get(name)
        if values:  # None where a value is no number
            value = values[-1] if step is None else None if None in values else max(values)
        if value is None:
            raise UserError(f"`{self.command}` has no {name}")
        return value


@dataclass
class Judged:
    """A claim with its runs and its measured verdict."""
    claim: dict
    runs: dict  # name -> Run
    verdict: str


def read(path=CLAIMS):
    """The claims of a file, or of all files of a folder, in the order of their names."""
    if Path(path).is_dir():
        return [claim for file in sorted(Path(path).glob("*.toml")) for claim in read(file)]
    try:
        claims = tomllib.loads(Path(path).read_text(encoding="utf-8")).get("claim", [])
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UserError(f"{path}: {error}") from error
    if not isinstance(claims, list) or not all(isinstance(claim, dict) for claim in claims):
        raise UserError(f"{path}: 'claim' is not a list of tables; valid: [[claim]]")
    papers = set(re.findall(r"(?m)^@\w+\{(\w+),", PAPERS.read_text(encoding="utf-8")))
    for claim in claims:
        where = f"{path}: '{claim.get('title', '?')}'"
        wrong = [key for key in NEEDED if not claim.get(key)] or [key for key in claim if key not in (*NEEDED, *OPTIONAL)]
        if wrong:
            raise UserError(f"{where}: {'lacks' if wrong[0] in NEEDED else 'has no key'} {wrong[0]}; valid: "
                            f"{', '.join((*NEEDED, *OPTIONAL))}")
        for key, value in claim.items():
            if key != "runs" and not isinstance(value, str):
                raise UserError(f"{where}: {key} is {value}; valid: text")
        if not isinstance(claim["runs"], dict) or not all(isinstance(command, str) for command in claim["runs"].values()):
            raise UserError(f"{where}: runs is {claim['runs']}; valid: a table of commands, runs.NAME = \"SCENE ...\"")
        for name, command in claim["runs"].items():
            try:
                shlex.split(command)
            except ValueError as error:
                raise UserError(f"{where}: runs.{name}: {command}: {str(error).lower()}; valid: what `lpc run` takes") from error
        if claim["verdict"] not in VERDICTS:
            raise UserError(f"{where}: verdict {claim['verdict']}; valid: {', '.join(VERDICTS)}")
        if claim["source"].split(",")[0] not in papers:
            raise UserError(f"{where}: docs/references.bib has no {claim['source'].split(',')[0]}")
    return claims


def run(lpc, command):
    """The result of `lpc run COMMAND`; a run that fails has a result, too."""
    done = subprocess.run([lpc, "run", *shlex.split(command), "--json"], capture_output=True, text=True)
    if done.returncode not in (0, 1) or not done.stdout:
        raise UserError(f"`lpc run {command}`: {done.stderr.strip() or f'ended with {done.returncode}'}")
    return json.loads(done.stdout)


def holds(where, text, runs):
    """The value of an expression. It may use the names of the runs, abs, all, max and min, and no others."""
    try:
        return bool(eval(" ".join(text.split()), {"__builtins__": {}, "abs": abs, "all": all, "max": max, "min": min, **runs}))
    except (NameError, SyntaxError, TypeError, AttributeError, ValueError, ArithmeticError) as error:
        raise UserError(f"'{where}': {text}: {error}") from error


def judge(claims, lpc):
    """Judges every claim by its runs; a command that several claims share runs once."""
    commands = list(dict.fromkeys(command for claim in claims for command in claim["runs"].values()))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = dict(zip(commands, pool.map(lambda command: run(lpc, command), commands)))
    judged = []
    for claim in claims:
        runs = {name: Run(command, results[command]) for name, command in claim["runs"].items()}
        answers = [holds(claim["title"], claim[key], runs) for key in ("says", "differs") if key in claim]
        judged.append(Judged(claim, runs, ("confirmed" if answers[0] else "refuted") if len(set(answers)) == 1 else "depends"))
        for name, one in runs.items():  # also metrics that a short-circuited `and` skipped, and those of `shows`
            told = re.findall(rf"\b{name}\.(\w+)", claim["says"] + " " + claim.get("differs", ""))
            for metric in [*told, *claim.get("shows", "").split()]:
                getattr(one, metric)
    return judged


def units(lpc):
    listed = subprocess.run([lpc, "list", "--all", "--json"], capture_output=True, text=True, check=True).stdout
    return {m["name"]: m["unit"] for m in json.loads(listed)["metrics"] if m["kind"] in ("world", "any") and m["unit"] != "1"}


def figure(metric, value, unit):
    """A value with its unit; values below 1e-12 are rounding and read 0."""
    return f"{metric} {value if abs(value) >= 1e-12 else 0:.4g} {unit}".strip()


def page(judged, unit):
    """The text between the marks of docs/claims.md."""
    count = {verdict: sum(j.verdict == verdict for j in judged) for verdict in VERDICTS}
    lines = [f"{len(judged)} claims: {count['confirmed']} confirmed, {count['refuted']} refuted, {count['depends']} depend on "
             "a named condition.", "", "| | claim | verdict |", "| --- | --- | --- |"]
    lines += [f"| {i} | {j.claim['title']} | {j.verdict} |" for i, j in enumerate(judged, 1)]
    for i, j in enumerate(judged, 1):
        lines += ["", f"## {i}. {j.claim['title']}", "", f"> {j.claim['statement']}", "", f"Source: {j.claim['source']}.", "",
                  "| | command | measured |", "| --- | --- | --- |"]
        for name, one in j.runs.items():
            outcome = one.value("outcome") + ("" if one.value("outcome") == "ok" else f" at step {one.value('step')}")
            figures = [figure(m, one.value(m), unit.get(series_of(m)[1] or m, ""))
                       for m in one.seen if m not in ("outcome", "step")]
            lines.append(f"| {name} | `lpc run {one.command}` | {', '.join([outcome, *figures])} |")
        lines += ["", f"**{j.verdict.capitalize()}.** {j.claim['because']}"]
    return "\n".join([BEGIN, *lines, END])


def between_marks(path):
    """The page's text, and its part between the marks, with the marks."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}") from error
    found = re.findall(f"{BEGIN}.*?{END}", text, re.DOTALL)
    if len(found) != 1:
        raise UserError(f"{path} has {len(found)} places between {BEGIN} and {END}; valid: one")
    return text, found[0]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="reports/claims.py", description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lpc", metavar="FILE", default=str(ROOT / "build" / "release" / "bin" / "lpc"), help="the program")
    parser.add_argument("--claims", metavar="FILE", default=str(CLAIMS),
                        help="a file of claims, or a folder of such files; default: experiments/claims")
    parser.add_argument("--only", metavar="TITLE", help="judge one claim")
    parser.add_argument("--into", metavar="FILE", help="write the page: replaces the text between its marks")
    options = parser.parse_args(arguments)
    try:
        if not Path(options.lpc).is_file():
            raise UserError(f"--lpc: {options.lpc} is not a file")
        if options.only and options.into:
            raise UserError("--into writes all claims; valid: without --only")
        text, old = between_marks(options.into) if options.into else ("", "")
        claims = read(options.claims)
        chosen = [claim for claim in claims if options.only in (None, claim["title"])]
        if not chosen:
            raise UserError(f"--only: no claim '{options.only}'; valid: {', '.join(claim['title'] for claim in claims)}")
        judged = judge(chosen, options.lpc)
        other = [j for j in judged if j.verdict != j.claim["verdict"]]
        for j in other if options.into else judged:
            print(f"{j.claim['title']}: {j.verdict}" + (f", but written as {j.claim['verdict']}" if j in other else ""))
            for name, one in j.runs.items():
                print(f"  {name}: " + ", ".join(f"{m} {one.value(m)}" for m in dict.fromkeys(["outcome", *one.seen])))
        if options.into and not other:
            partial = Path(options.into + ".partial")
            partial.write_text(text.replace(old, page(judged, units(options.lpc))), encoding="utf-8")
            partial.replace(options.into)
    except UserError as error:
        print(f"reports/claims.py: {error}", file=sys.stderr)
        return 2
    return 1 if other else 0


if __name__ == "__main__":
    sys.exit(main())
