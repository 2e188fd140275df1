# SPDX-License-Identifier: Zlib
"""The README's figure, caption and numbers are of the same data: written by one command, compared here."""

import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import readme  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts.cost_against_error import cost_against_error  # noqa: E402

ROOT = HERE.parent.parent


def check(page):
    """What README, figure and numbers in this folder say otherwise than each other."""
    facts = readme.read_facts(page.parent / "docs" / "resolvers.json")
    text = page.read_text(encoding="utf-8")
    if readme.between_marks(text) != readme.block(facts):
        return f"the README's caption is not that of docs/resolvers.json; write it anew: {readme.COMMANDS[1]}"
    if readme.caption_of_figure((page.parent / "docs" / "resolvers.svg").read_text(encoding="utf-8")) != readme.caption(facts):
        return f"the figure is of other data than docs/resolvers.json; write it anew: {readme.COMMANDS[1]}"
    titles = [column["title"] for column in facts["columns"]]
    for axis, values in facts["settings"].items():
        drawn = sorted({row[titles.index(axis)] for row in facts["rows"]} - {None})  # a method may have no such number
        if drawn != values:
            return f"{axis} is {drawn} in the numbers and {values} in the caption"
    return ""


class Readme(undrawn.Undrawn):
    def test_caption_figure_and_numbers_agree(self):
        self.assertEqual(check(ROOT / "README.md"), "")

    @undrawn.drawn
    def test_a_caption_of_other_data_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "README.md"
            page.write_text(f"# Title\n\n{readme.BEGIN}\n{readme.END}\n\nthe rest\n", encoding="utf-8")
            synthetic_store.write(Path(folder) / "s.db", themes=(synthetic_store.resolvers,))
            context = chart.Context(load.Store(Path(folder) / "s.db"))
            charts = chart.made(cost_against_error, context)
            told = readme.write(context, charts, page)
            for made in charts:
                style.plt.close(made.figure)
            self.assertIn("15 bodies", told)
            self.assertIn("iterations 4, 10 and 40", told)
            written = page.read_text(encoding="utf-8")
            self.assertTrue(written.startswith("# Title") and written.endswith("the rest\n"))
            self.assertEqual(check(page), "")
            page.write_text(written.replace("15 bodies", "210 bodies"), encoding="utf-8")
            self.assertIn("the README's caption is not", check(page))
            page.write_text(written, encoding="utf-8")
            picture = page.parent / "docs" / "resolvers.svg"
            picture.write_text(picture.read_text(encoding="utf-8").replace("15 bodies", "210 bodies"), encoding="utf-8")
            self.assertIn("the figure is of other data", check(page))
            context.store.db.close()

    def test_mistakes_are_told_in_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            store, page = Path(folder) / "s.db", Path(folder) / "README.md"
            synthetic_store.write(store, themes=())
            page.write_text("no marks\n", encoding="utf-8")
            self.assertEqual(make.main(["--store", str(store), "--readme", str(page)]), 2)
            self.assertEqual(sorted(p.name for p in Path(folder).iterdir()), ["README.md", "s.db"])


if __name__ == "__main__":
    unittest.main()
