#!/usr/bin/env python3
# SPDX-License-Identifier: Zlib
"""Damages shipped files (scenes, sweeps, pipelines, cases, recordings, stores, command lines) and runs the program on them; each
call must satisfy the rules of judge.py. Inputs that once failed (kept/KIND/) come first.
Run by ctest: mutate.py LPC SOURCE_DIR WORK_DIR [--sanitized] [--part FROM TO].
One input again: mutate.py LPC SOURCE_DIR WORK_DIR --replay KIND FILE.
LPC_TEST_CASES scales the number of cases, in per cent; LPC_TEST_SEED, a number, replaces the fixed seed."""

import argparse
import dataclasses
import os
import random
import re
import shutil
import subprocess
import sys
import time
import typing
from pathlib import Path

import judge
import mutations
import shipped

HERE = Path(__file__).resolve().parent
MOST_RUNS = 120     # when shrinking a failing input
MOST_ARGUMENT = 100_000  # bytes: the system allows 131,072 in one

CALLS = ["run|scene.toml|--param|n=3|--dimension|3|--record|out.rec|--profile|out.csv",
         "run|scene.toml|--pipeline|solver=soft_step{substeps=4} sleep=none|--dt|0.01|--seed|7|--json",
         "run|scene.toml|--precision|f64|--plot|height",
         "run|scene.toml|--film|out.strip.svg|--param|perturb=1e-3",
         "run|pendulum|--param|joint=hinge{motor_torque=2}|--dimension|2",
         "list|--stage|velocity", "list|--name|pyramid|--json", "list|--into|page.md",
         "sweep|sweep.toml|--dry-run|--only|catto,soft_step|--set|n=2|--with|x=solver=soft_step{substeps=$iterations}",
         "replay|run.rec|--beside|run.rec|--tolerance|1e-6|--film|out.svg",
         "merge|into.db|store.db", "import-benchmark|bench.json|--store|into.db"]


@dataclasses.dataclass
class Call:
    argv: list
    may_write: tuple = ()
    may_change: tuple = ()


@dataclasses.dataclass
class Kind:
    suffix: str
    cases: int
    mutate: typing.Callable
    calls: typing.Callable  # (the input's bytes) -> [Call]: the input lies in "input" + suffix
    beside: tuple = ()      # seed files that are also in the folder


def argument(data):
    return data[:MOST_ARGUMENT].replace(b"\0", b"")


def pipeline_calls(data):
    return [Call(["run", "box_drop", "--steps", "2", "--dimension", dimension, "--pipeline", argument(data)])
            for dimension in ("2", "3")]


def command_calls(data):
    argv = [argument(word) for word in data.split(b"|")]
    argv = [word for word in argv if b"/" not in word]  # nothing outside the folder
    return [Call(argv + ([b"--steps", b"2"] if argv[:1] == [b"run"] else []), ("*",), ("into.db", "page.md"))]


def fixed(*calls):
    return lambda data: list(calls)


KINDS = {
    "scene": Kind(".toml", 110, mutations.text, fixed(
        Call(["run", "input.toml", "--steps", "2"]),
        Call(["run", "input.toml", "--steps", "2", "--record", "o.rec", "--profile", "o.csv"], ("o.rec", "o.csv")))),
    "pipeline": Kind(".txt", 40, mutations.text, pipeline_calls),
    "sweep": Kind(".toml", 40, mutations.text, fixed(Call(["sweep", "input.toml", "--dry-run"]))),
    "trials": Kind(".toml", 8, mutations.text, fixed(
        Call(["sweep", "input.toml", "--set", "steps=2", "--set", "n=2", "--store", "o.db", "--jobs", "1", "--quiet"],
             ("o.db",)))),
    "cases": Kind(".json", 20, mutations.text, fixed(
        Call(["verify", "--cases", "input.json"]), Call(["verify", "--cases", "input.json", "--csv", "o.csv"], ("o.csv",)),
        Call(["verify", "--repro", "0", "--witness", "libccd_gjk", "--cases", "input.json", "--out", "o.cpp"], ("o.cpp",)))),
    "recording": Kind(".rec", 30, mutations.binary, fixed(
        Call(["replay", "input.rec"]), Call(["replay", "input.rec", "--film", "o/"], ("o/",)),
        Call(["replay", "input.rec", "--film", "o.strip.svg"], ("o.strip.svg",)),
        Call(["replay", "input.rec", "--beside", "run.rec", "--film", "o.svg"], ("o.svg",))), ("run.rec",)),
    "store": Kind(".db", 30, mutations.several(mutations.database, mutations.database, mutations.binary), fixed(
        Call(["sweep", "sweep.toml", "--store", "input.db", "--dry-run"]), Call(["merge", "o.db", "input.db"], ("o.db",)),
        Call(["merge", "input.db", "store.db"], (), ("input.db",)),
        Call(["sweep", "sweep.toml", "--store", "input.db", "--jobs", "1", "--quiet"], (), ("input.db",))),
        ("sweep.toml", "store.db")),
    "command": Kind(".txt", 30, mutations.text, command_calls,
                    ("scene.toml", "sweep.toml", "run.rec", "store.db", "bench.json", "page.md")),
}


class Seeds:
    """Inputs to damage: shipped files, and recordings and a store that the program makes."""

    def __init__(self, lpc, source, folder, make=True):
        self.folder = folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        (folder / "scene.toml").write_text(shipped.SMALL_SCENE)
        (folder / "sweep.toml").write_text(shipped.SMALL_SWEEP.replace("[2, 3]", "2").replace("[1, 4]", "4"))
        (folder / "bench.json").write_text('{"benchmarks": [{"name": "x", "real_time": 1.0, "time_unit": "ns"}]}')
        (folder / "page.md").write_text("<!-- registry -->\n<!-- end -->\n")

        if make:
            for arguments in (("run", "scene.toml", "--steps", "3", "--record", "run.rec"),
                              ("run", "pendulum", "--dimension", "3", "--steps", "3", "--record", "run3.rec"),
                              ("run", "compounds", "--dimension", "3", "--steps", "1", "--record", "compounds.rec"),
                              ("sweep", "sweep.toml", "--store", "store.db", "--quiet")):
                subprocess.run([lpc, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        self.of = {
            "scene": shipped.scenes(source), "pipeline": shipped.pipelines(source), "sweep": shipped.sweeps(source),
            "trials": [shipped.SMALL_SWEEP.encode()], "cases": shipped.cases(source),
            "recording": [p.read_bytes() for p in sorted(folder.glob("*.rec"))],
            "store": [p.read_bytes() for p in folder.glob("store.db")], "command": [c.encode() for c in CALLS],
        }


class Fuzzer:
    def __init__(self, lpc, source, work, sanitized, make=True):
        self.lpc, self.work = lpc, work
        self.limits = judge.Limits(cpu=60, address_space=False) if sanitized else judge.Limits()
        self.seeds = Seeds(lpc, source, work / "seeds", make)
        self.runs = 0
        self.codes = {}

    def fault(self, kind, data, only=None):
        """The fault of the first call of this kind that breaks a rule, or of the call `only`; empty if there is none."""
        k = KINDS[kind]
        for number, call in enumerate(k.calls(data)):
            if only is not None and number != only:
                continue
            folder = self.work / "case"
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            for name in k.beside:
                shutil.copy(self.seeds.folder / name, folder / name)
            (folder / f"input{k.suffix}").write_bytes(data)
            seen = judge.run([self.lpc, *call.argv], folder, self.limits)
            self.runs += 1
            self.codes[seen.code] = self.codes.get(seen.code, 0) + 1
            told = judge.fault(seen, self.limits, call.may_write, call.may_change)
            if told:
                return told
        return ""

    def smaller(self, kind, data, told, only):
        """Removes pieces that the same fault does not need."""
        until = self.runs + MOST_RUNS

        def fails(candidate):
            return self.fault(kind, candidate, only)[:12] == told[:12]

        for split in (rb"(?<=\n)", rb"(?<=[\s,{}\[\]])"):
            pieces = [p for p in re.split(split, data) if p] if KINDS[kind].mutate is mutations.text else [
                data[i:i + 16] for i in range(0, len(data), 16)]
            size = (len(pieces) + 1) // 2
            while size and self.runs < until:
                i = 0
                while i < len(pieces) and self.runs < until:
                    candidate = pieces[:i] + pieces[i + size:]
                    if candidate and fails(b"".join(candidate)):
                        pieces = candidate
                    else:
                        i += size
                size //= 2
            data = b"".join(pieces)
        return data

    def keep(self, kind, name, data):
        folder = self.work / "failures" / kind
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / (name + KINDS[kind].suffix)
        path.write_bytes(data)
        return path

    def tell(self, kind, path, told, original=""):
        print(f"{kind}: {told}\n  input: {path}{original}\n  again: {sys.executable} {HERE / 'mutate.py'} "
              f"{' '.join(sys.argv[1:4])} --replay {kind} {path}", flush=True)

    def one(self, kind, seed, number):
        """Whether case `number` of this seed satisfies the rules."""
        rng = random.Random(f"{seed} {kind} {number}")
        seeds = self.seeds.of[kind]
        data = KINDS[kind].mutate(rng, rng.choice(seeds), rng.choice(seeds))
        only = rng.randrange(len(KINDS[kind].calls(data)))
        told = self.fault(kind, data, only)
        if not told:
            return True
        path = self.keep(kind, f"{seed}-{number}", data)
        small = self.smaller(kind, data, told, only)
        self.tell(kind, self.keep(kind, f"{seed}-{number}-small", small), told, f" (of {path})")
        return False


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("lpc", type=Path)
    parser.add_argument("source", type=Path)
    parser.add_argument("work", type=Path)
    parser.add_argument("--sanitized", action="store_true")
    parser.add_argument("--replay", nargs=2, metavar=("KIND", "FILE"))
    parser.add_argument("--only", choices=sorted(KINDS), action="append", help="these kinds (for a longer search by hand)")
    parser.add_argument("--part", nargs=2, type=int, default=(0, 100), metavar=("FROM", "TO"),
                        help="of the cases of each kind, in per cent; what once failed belongs to the first")
    o = parser.parse_args()
    if o.replay and o.replay[0] not in KINDS:
        parser.error(f"there is no kind '{o.replay[0]}'; valid: {', '.join(sorted(KINDS))}")
    judge.adopt_orphans()
    o.work.mkdir(parents=True, exist_ok=True)
    fuzzer = Fuzzer(o.lpc.resolve(), o.source.resolve(), o.work.resolve(), o.sanitized)
    if o.replay:
        told = fuzzer.fault(o.replay[0], Path(o.replay[1]).read_bytes())
        print(told or "answered as it is owed")
        return 1 if told else 0
    percent = float(os.environ.get("LPC_TEST_CASES", "100"))
    seed = os.environ.get("LPC_TEST_SEED", "1")
    started, bad, cases = time.monotonic(), 0, 0
    kinds = o.only or KINDS
    for kind in kinds:
        for path in sorted((HERE / "kept" / kind).glob("*")) if o.part[0] == 0 else ():
            cases += 1
            if told := fuzzer.fault(kind, path.read_bytes()):
                fuzzer.tell(kind, path, told)
                bad += 1
    for kind in kinds:
        several = max(1, round(KINDS[kind].cases * percent / 100))
        for number in range(*(round(several * part / 100) for part in o.part)):
            cases += 1
            bad += not fuzzer.one(kind, seed, number)
    codes = ", ".join(f"{n} with {code}" for code, n in sorted(fuzzer.codes.items()))
    print(f"{cases} inputs, {fuzzer.runs} calls in {time.monotonic() - started:.0f} s ({codes}), {bad} not answered as is owed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
