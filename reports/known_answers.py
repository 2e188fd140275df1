#!/usr/bin/python3
# SPDX-License-Identifier: Zlib
"""Writes docs/known_answers.md from tests/known_answers/answers.data: a summary by method, then a row for each problem. With
--measured it first corrects the rows whose measured error is outside its interval."""

import argparse
import math
import re
import sys
from pathlib import Path

EXAMPLE = """example:
  LPC_PRINT_ANSWERS=1 build/test/bin/test_known_answers_f64 > build/answers.txt
  reports/known_answers.py --measured build/answers.txt"""
SOURCE = Path(__file__).resolve().parent.parent
DATA, PAGE = SOURCE / "tests/known_answers/answers.data", SOURCE / "docs/known_answers.md"
MARKS = re.compile(r"<!-- answers -->\n.*?<!-- end -->", re.DOTALL)
CLASSES = (("exact", 1e-6), ("to 1 %", 0.01), ("to 10 %", 0.1), ("worse", float("inf")))  # largest error
FREQUENT = 50  # figures; methods with fewer share a row of the summary


class Row:
    """A figure of a problem under a method, with its measured error."""

    def __init__(self, problem, cells):
        self.problem, (self.figure, self.method, right, measured, self.f64, self.f32) = problem, cells
        self.right, self.measured = float(right), float(measured)
        self.error = abs(self.measured - self.right) / (abs(self.right) or 1)
        graded = math.radians(self.error) if self.right == 0 and self.figure.endswith(", degrees") else self.error
        self.grade = next(name for name, most in CLASSES if graded <= most)

    @property
    def amount(self):
        number = f"{self.error:.2g}" if self.right == 0 else f"{100 * self.error:.2g} %"
        return f"{float(number.split()[0]):g}{' %' if self.right else ''}"

    @property
    def name(self):
        """A resolver stands for split_solver with that resolver."""
        solver, _, which = self.method.partition(", ")
        resolver = re.fullmatch(r"split_solver\{velocity=(\w+(?:\{.*\})?)\}", solver)
        return f"`{resolver[1] if resolver else solver}`" + (f" ({which})" if which else "")


def problems_of(lines):
    """Groups of problems, in the order of the file: {group: {problem: {"formula", "setup", "rows"}}}."""
    groups, problem = {}, None
    for number, line in enumerate(lines, 1):
        if line.startswith("# "):
            group = groups.setdefault(line[2:], {})
        elif line.startswith("["):
            problem = group.setdefault(line[1:-1], {"formula": "", "setup": "", "rows": []})
            name = line[1:-1]
        elif line.startswith(("formula: ", "setup: ")):
            key, _, text = line.partition(": ")
            problem[key] = text
        elif problem is not None and line:
            cells = line.split(" | ")
            if len(cells) != 6:
                raise ValueError(f"line {number}: {len(cells)} cells; valid: 6, figure | method | right | measured | f64 | f32")
            problem["rows"].append(Row(name, cells))
    return groups


def errors(rows):
    """The methods of a problem by the class of their largest error."""
    worst = {}
    for row in rows:
        if row.name not in worst or row.error > worst[row.name].error:
            worst[row.name] = row
    told = {}  # by class and, in the last class, figure: methods by error
    for row in sorted(worst.values(), key=lambda row: row.error):
        grade = f"worse in *{row.figure}*" if row.grade == "worse" else row.grade
        equal = told.setdefault(grade, {})
        equal.setdefault("" if row.grade == "exact" else f" {row.amount}", []).append(row.name)
    texts = [f"{grade}: " + "; ".join(", ".join(names) + amount for amount, names in equal.items())
             for grade, equal in told.items()]
    return ". ".join(text[0].upper() + text[1:] for text in texts)


def summary(rows):
    """How many figures each method has in each class, and the problems of the worst class."""
    count = {}
    for row in rows:
        count[row.name] = count.get(row.name, 0) + 1
    others = sum(many < FREQUENT for many in count.values())
    parts = {name: [row for row in rows if row.name == name]
             for name, many in sorted(count.items(), key=lambda item: -item[1]) if many >= FREQUENT}
    parts[f"{others} other variants"] = [row for row in rows if count[row.name] < FREQUENT]
    lines = ["| method | figures | " + " | ".join(name for name, _ in CLASSES) + " | problems with a figure of the last class |",
             "| --- |" + " ---: |" * 5 + " --- |"]
    for name, part in parts.items():
        worse = list(dict.fromkeys(f"`{row.problem}`" for row in part if row.grade == "worse"))
        many = [str(sum(row.grade == grade for row in part)) for grade, _ in CLASSES]
        lines.append(f"| {name} | {len(part)} | {' | '.join(many)} | {', '.join(worse) if name[0] == '`' else len(worse)} |")
    return lines


def block(groups):
    """What stands between the marks, with them."""
    rows = [row for group in groups.values() for problem in group.values() for row in problem["rows"]]
    near = sum(row.error <= 0.01 for row in rows) / len(rows)
    lines = ["<!-- answers -->", "## Summary", "",
             f"{sum(map(len, groups.values()))} problems have {len({(row.problem, row.figure) for row in rows})} figures, which "
             f"are measured {len(rows):,} times by {len({row.name for row in rows})} methods and variants. {100 * near:.0f} % of "
             "the measurements are within 1 %.", "", *summary(rows)]
    for group, problems in groups.items():
        lines += ["", f"## {group}", "", "| problem | formula | setup | largest error of each method |",
                  "| --- | --- | --- | --- |"]
        lines += [f"| {name} | {p['formula']} | {p['setup']} | {errors(p['rows'])} |" for name, p in problems.items()]
    return "\n".join([*lines, "<!-- end -->"])


def interval(error, share, least):
    """The error and a share of it to each side; around 0 at least a bound for rounding."""
    if abs(error) < least:
        return f"-{least:g} .. {least:g}"
    return f"{error - share * abs(error):.2g} .. {error + share * abs(error):.2g}"


def holds(bounds, error):
    low, _, high = bounds.partition(" .. ")
    return bool(high) and float(low) <= error <= float(high)


def corrected(lines, measured):
    """The lines of the data after what LPC_PRINT_ANSWERS=1 printed, and how many have changed."""
    lines, changed = list(lines), 0
    for printed in measured:
        cells = printed.rstrip("\n").split(" | ")
        if len(cells) != 7 or cells[0] not in ("f64", "f32"):
            continue
        double, answer, figure, method, right, value, error = cells[0] == "f64", *cells[1:6], float(cells[6])
        if f"[{answer}]" not in lines:
            raise ValueError(f"no problem [{answer}]; add it with its formula and setup")
        begin = lines.index(f"[{answer}]")
        end = next((i for i in range(begin + 1, len(lines)) if not lines[i]), len(lines))
        at = next((i for i in range(begin, end) if lines[i].startswith(f"{figure} | {method} | ")), None)
        row = lines[at].split(" | ") if at is not None else [figure, method, right, f"{float(value):.7g}", "-", "-"]
        if at is not None and holds(row[4 if double else 5], error):
            continue
        if double:
            row[3], row[4] = f"{float(value):.7g}", interval(error, 0.25, 1e-13 if abs(error) < 1e-13 else 1e-11)
        else:
            row[5] = interval(error, 0.5, 1e-5)
        lines[end if at is None else at:end if at is None else at + 1] = [" | ".join(row)]
        changed += 1
    return lines, changed


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="reports/known_answers.py", description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", metavar="FILE", type=Path, default=DATA, help="problems, rows and intervals")
    parser.add_argument("--page", metavar="FILE", type=Path, default=PAGE,
                        help="the page to write, between '<!-- answers -->' and '<!-- end -->'")
    parser.add_argument("--measured", metavar="FILE", type=Path, action="append", default=[],
                        help="output of test_known_answers_f64 or _f32 with LPC_PRINT_ANSWERS=1; corrects the data")
    options = parser.parse_args(arguments)
    try:
        lines = options.data.read_text(encoding="utf-8").splitlines()
        for file in options.measured:
            lines, changed = corrected(lines, file.read_text(encoding="utf-8").splitlines())
            print(f"{file}: {changed} rows changed")
        text = options.page.read_text(encoding="utf-8")
        if not MARKS.search(text):
            raise ValueError(f"{options.page}: no lines '<!-- answers -->' and '<!-- end -->'")
        written = block(problems_of(lines))
        if options.measured:
            options.data.write_text("\n".join(lines) + "\n", encoding="utf-8")
        options.page.write_text(MARKS.sub(lambda _: written, text), encoding="utf-8")
    except (OSError, ValueError) as error:
        print(f"reports/known_answers.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
