# SPDX-License-Identifier: Zlib
"""Tests of the page and its tables. Run by ctest, or python3 reports/tests/page_test.py. Every check that guards a promise is
seen to fail on a planted bug."""

import csv
import json
import math
import re
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import pandas as pd  # noqa: E402

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import pages  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import table  # noqa: E402

PREFIXED = re.compile(r"^-?[\d.]+(e[-+]?\d+)? ?([pnµmk]?(m|s|J|m/s)|%)$")  # a number that was rounded for eyes


def check_for_programs(made):
    """No number of a table is a text, and every unit is one of SI."""
    for name in made.columns:
        unit = table.heading(name)[1]
        if unit not in ("", "1", "m", "s", "m/s", "rad", "J", "kg m/s"):
            return f"{name}: the unit is not SI"
        for value in made[name]:
            if isinstance(value, str) and (unit or PREFIXED.match(value)):
                return f"{name}: {value} is a text"
    return ""


def check_round_trip(rows, to_csv):
    """What is read from the two files is what was written, to the last bit."""
    with tempfile.TemporaryDirectory() as folder:
        to_csv(rows, Path(folder) / "t.csv")
        table.to_json(rows, {"id": "t"}, Path(folder) / "t.json")
        with open(Path(folder) / "t.csv", encoding="utf-8", newline="") as file:
            head, *lines = csv.reader(file)
        read = json.loads((Path(folder) / "t.json").read_text(encoding="utf-8"))
    if head != list(rows.columns) or [table.heading(name) for name in head] != [tuple(c.values()) for c in read["columns"]]:
        return f"columns {head}"
    for row, line, values in zip(rows.itertuples(index=False), lines, read["rows"], strict=True):
        for name, value, text, plain in zip(head, row, line, values, strict=True):
            if table.unknown(value):
                same = text == "" and plain is None
            elif isinstance(value, (str, bool)):
                same = str(value) == text == str(plain)
            else:
                same = float(text) == float(plain) == float(value)
            if not same:
                return f"{name}: {value!r} became {text!r} and {plain!r}"
    return ""


def rounded(rows, target):
    """Planted bug: six digits, as many a table is printed."""
    rows.to_csv(target, index=False, float_format="%.6g")


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        synthetic_store.write(Path(cls.folder.name) / "store.db")
        cls.store = load.Store(Path(cls.folder.name) / "store.db")
        cls.charts = make.all_charts(chart.Context(cls.store))
        style.plt.close("all")

    def test_every_table_has_raw_numbers_with_units_and_round_trips(self):
        shown = 0
        for made in self.charts:
            self.assertEqual(check_for_programs(made.table), "", made.id)
            self.assertEqual(check_round_trip(made.table, table.to_csv), "", made.id)
            shown += len(made.table)
        self.assertGreater(shown, 500)

    def test_what_is_formatted_or_rounded_is_seen(self):
        for bad in ({"error [m]": ["1.23 mm"]}, {"error": ["1.23 mm"]}, {"share": ["26%"]}, {"time [ms]": [1.5]}):
            self.assertNotEqual(check_for_programs(pd.DataFrame(bad)), "", bad)
        rows = pd.DataFrame(table.quantity("time", "ms", [0.1 + 0.2, None, math.inf, 0.0]))
        self.assertEqual(check_round_trip(rows, table.to_csv), "")
        self.assertNotEqual(check_round_trip(rows, rounded), "", "the planted bug was not seen")

    def test_units_become_si_and_are_rounded_for_eyes_only(self):
        rows = pd.DataFrame({"method": ["a<b"], **table.quantity("time per query", "ns", [158300.4])})
        self.assertEqual(list(rows["time per query [s]"]), [158300.4 / 1e9])
        page = table.to_html(rows)
        self.assertIn("<th>time per query</th>", page)
        self.assertIn("<td class=n>158 µs</td>", page)
        self.assertIn("<td>a&lt;b</td>", page)

    def test_a_table_says_what_it_is_and_when_it_was_measured(self):
        made = next(c for c in self.charts if c.id == "coverage")
        with tempfile.TemporaryDirectory() as folder:
            pages.write_charts(self.store, [made], Path(folder))
            read = json.loads((Path(folder) / "tables" / "coverage.json").read_text(encoding="utf-8"))
        self.assertEqual((read["id"], read["finding"], read["store"]), ("coverage", made.finding, "store.db"))
        for name in ("first_trial", "last_trial"):
            self.assertRegex(read[name], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")


if __name__ == "__main__":
    unittest.main()
