# SPDX-License-Identifier: Zlib
"""The README's figure, caption and numbers are of the same data: written by one command, compared here."""

import math
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import measured  # noqa: E402
import pandas as pd  # noqa: E402
import readme  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402

ROOT = HERE.parent.parent


def check(page):
    """What README, figure and numbers in this folder say otherwise than each other."""
    facts = readme.read_facts(page.parent / "docs" / "resolvers.json")
    text = page.read_text(encoding="utf-8")
    if readme.between_marks(text) != readme.block(facts):
        return f"the README's caption is not that of docs/resolvers.json; write it anew: {readme.COMMANDS[1]}"
    if readme.caption_of_figure((page.parent / "docs" / "resolvers.svg").read_text(encoding="utf-8")) != readme.caption(facts):
        return f"the figure is of other data than docs/resolvers.json; write it anew: {readme.COMMANDS[1]}"
    place = [column["title"] for column in facts["columns"]].index("iterations")
    drawn = sorted({row[place] for row in facts["rows"]} - {None})  # a method may have no such number
    return "" if drawn == facts["iterations"] else f"iterations are {drawn} in the numbers, not {facts['iterations']}"


def cell(method, ms, depth, outcome="ok", runs=()):
    return {"method": method, "iterations": 4.0, "outcome": outcome, readme.COST: ms, readme.ERROR: depth,
            measured.MEASURED: {readme.COST: measured.Measured(tuple(runs))}}


class Readme(undrawn.Undrawn):
    def test_caption_figure_and_numbers_agree(self):
        self.assertEqual(check(ROOT / "README.md"), "")

    @undrawn.drawn
    def test_a_caption_of_other_data_is_seen(self):
        names = {"catto+linear": "catto", "soft_step": "soft_step"}
        with tempfile.TemporaryDirectory() as folder, mock.patch.multiple(
                readme, METHODS=names, ERROR="max_penetration"):
            page = Path(folder) / "README.md"
            page.write_text(f"# Title\n\n{readme.BEGIN}\n{readme.END}\n\nthe rest\n", encoding="utf-8")
            synthetic_store.write(Path(folder) / "s.db", themes=(synthetic_store.resolvers,))
            context = chart.Context(load.Store(Path(folder) / "s.db"))
            told = readme.write(context, page)
            self.assertIn("14 boxes", told)
            self.assertIn("4, 10 and 40 iterations", told)
            written = page.read_text(encoding="utf-8")
            self.assertTrue(written.startswith("# Title") and written.endswith("the rest\n"))
            self.assertEqual(check(page), "")
            page.write_text(written.replace("14 boxes", "210 boxes"), encoding="utf-8")
            self.assertIn("the README's caption is not", check(page))
            page.write_text(written, encoding="utf-8")
            picture = page.parent / "docs" / "resolvers.svg"
            picture.write_text(picture.read_text(encoding="utf-8").replace("14 boxes", "210 boxes"), encoding="utf-8")
            self.assertIn("the figure is of other data", check(page))
            context.store.db.close()

    def test_the_finding_names_the_cheapest_that_is_right_ties_and_failures(self):
        cells = pd.DataFrame([cell("a", 0.2, 5e-4, runs=(0.19, 0.21)), cell("b", 0.3, 5e-4, runs=(0.2, 0.4)),
                              cell("c", 0.1, 5e-3), cell("d", 0.9, 0.0), cell("e", 0.1, math.nan, "collapsed")])
        self.assertEqual(readme.finding(cells), "a keeps the penetration below 1 mm at the least cost, 200 µs per step, as does "
                         "b within the noise; e at 4 iterations fails.")
        self.assertEqual(readme.finding(cells[cells["method"] == "c"]), "No method keeps the penetration below 1 mm.")

    def test_mistakes_are_told_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            store, page = Path(folder) / "s.db", Path(folder) / "README.md"
            synthetic_store.write(store, themes=())
            page.write_text("no marks\n", encoding="utf-8")
            self.assertEqual(make.main(["--store", str(store), "--readme", str(page)]), 2)
            self.assertEqual(sorted(p.name for p in Path(folder).iterdir()), ["README.md", "s.db"])


if __name__ == "__main__":
    unittest.main()
