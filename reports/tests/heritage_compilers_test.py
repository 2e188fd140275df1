# SPDX-License-Identifier: Zlib
"""Tests of the chart of compilers and optimisation levels: files with known medians. Run by ctest, or
python3 reports/tests/heritage_compilers_test.py [PICTURE.png]."""

import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import pandas as pd  # noqa: E402

import heritage_compilers  # noqa: E402
import readme  # noqa: E402

TIMES = {("g++", "O0"): 20.0, ("g++", "O2"): 2.0, ("g++", "O3"): 1.0, ("clang++", "O0"): 20.1, ("clang++", "O3"): 0.5}  # ms


class Compilers(unittest.TestCase):
    def folder(self, times=None, repeats=3, steps=30, states="aa"):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        names = heritage_compilers.PHASES
        for (compiler, level), ms in (TIMES if times is None else times).items():
            for repeat in range(1, repeats + 1):
                lines = ["step,whole [s]," + ",".join(f"{name} [s]" for name in names) + ",bodies,contact points,state"]
                for step in range(steps):
                    whole = ms * 1e-3 * (1 + 0.02 * repeat) * (50 if step < heritage_compilers.WARM_UP else 1)
                    state = states[compiler == "clang++"] * 16 if step + 1 == steps else ""
                    lines.append(f"{step},{whole}," + ",".join(str(whole / 10) for _ in names) + f",326,900,{state}")
                (Path(made.name) / f"{compiler}_{level}_{repeat}.csv").write_text("\n".join(lines) + "\n")
        return Path(made.name)

    def test_medians_and_ratios(self):
        folder = self.folder()
        found = heritage_compilers.finding(heritage_compilers.builds_of(folder))
        self.assertEqual(found.headline, "On a resting 2D pyramid of 325 boxes -O3 is 40 times as fast as -O0 with clang++ "
                                         "and 20 times "
                         "with g++; all builds end in the same bits.")
        table = found.table.set_index(["compiler", "level"])
        self.assertEqual([round(ms, 6) for ms in table["time of a step [s]"]], [20.904e-3, 520e-6, 20.8e-3, 2.08e-3, 1.04e-3])
        shown = lambda column: [value if isinstance(value, str) else "" if pd.isna(value) else f"{value:.2g}"  # noqa: E731
                                for value in table[column]]
        self.assertEqual(shown("over the last level"), ["40", "", "20", "2", ""])
        self.assertEqual(shown("over clang++"), ["", "", "tie: inside the noise", "", "2"])
        target = Path(PICTURE) if PICTURE else folder / "picture.png"
        self.assertEqual(heritage_compilers.draw(heritage_compilers.builds_of(folder), target), ([], []))
        self.assertTrue(target.exists())

    def test_a_page_has_the_finding_of_its_picture(self):
        page, folder = Path(HERE.parent.parent / "docs/heritage_figures.md"), self.folder()
        words = lambda text: " ".join(text.split())  # noqa: E731
        fault = lambda text, picture: "" if words(heritage_compilers.block(  # noqa: E731
            readme.caption_of_figure(picture.read_text(encoding="utf-8")))) in words(text).replace(
                "| <!-- end", "|<!-- end") else "page and picture differ"
        self.assertEqual(fault(page.read_text(encoding="utf-8"), page.parent / "drawings/heritage_compilers.svg"), "")
        copy, picture = folder / "page.md", folder / "picture.svg"
        copy.write_text("before\n<!-- compilers -->\nold\n<!-- end -->\nafter\n", encoding="utf-8")
        self.assertEqual(heritage_compilers.main([str(folder), "--to", str(picture), "--page", str(copy)]), 0)
        self.assertEqual(fault(copy.read_text(encoding="utf-8"), picture), "")
        self.assertIn("|\n<!-- end -->\nafter\n", copy.read_text(encoding="utf-8"))
        planted = copy.read_text(encoding="utf-8").replace("20 times", "30 times")
        self.assertNotEqual(fault(planted, picture), "", "the planted bug was not seen")
        copy.write_text("no place\n", encoding="utf-8")
        self.assertEqual(heritage_compilers.main([str(folder), "--page", str(copy)]), 2)

    def test_the_planted_bug_other_bits_are_counted(self):
        found = heritage_compilers.finding(heritage_compilers.builds_of(self.folder(states="ab")))
        self.assertTrue(found.headline.endswith("builds end in 2 different states."), found.headline)

    def test_first_steps_do_not_count(self):
        folder = self.folder(times={("g++", "O2"): 2.0}, repeats=1, steps=15)  # ten of these are fifty times as slow
        self.assertAlmostEqual(heritage_compilers.builds_of(folder)["whole [s]"].iloc[0], 2.04e-3)
        real, heritage_compilers.WARM_UP = heritage_compilers.WARM_UP, 0
        try:
            self.assertAlmostEqual(heritage_compilers.builds_of(folder)["whole [s]"].iloc[0], 50 * 2.04e-3)
        finally:
            heritage_compilers.WARM_UP = real

    def test_an_empty_folder_is_an_error(self):
        self.assertEqual(heritage_compilers.main([str(self.folder(times={}))]), 2)


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
