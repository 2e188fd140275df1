# SPDX-License-Identifier: Zlib
"""The manual's first scene and first sweep, run word for word, end in charts of that sweep. Run by ctest, or
python3 reports/tests/first_sweep_test.py build/test/bin/lpc."""

import re
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402

LPC = ""  # the program, from the command line
MANUAL = (HERE.parent.parent / "docs" / "manual.md").read_text(encoding="utf-8")


def block(heading, kind):
    """The first block of code of this kind below a heading of the manual."""
    section = re.search(rf"^## {heading}$(.*?)(?=^## |\Z)", MANUAL, re.S | re.M).group(1)
    return next(text for name, text in re.findall(r"^```(\w*)\n(.*?)^```$", section, re.S | re.M) if name == kind)


class FirstSweep(unittest.TestCase):
    def test_runs_as_the_manual_has_it_and_is_charted(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "leaning_stack.toml").write_text(block("A first scene", "toml"), encoding="utf-8")
            (Path(folder) / "friction.toml").write_text(block("A first sweep", "toml"), encoding="utf-8")
            commands = re.findall(r"^lpc sweep .*$", block("A first sweep", ""), re.M)
            self.assertTrue(commands, "the manual has no command")
            command = [LPC, *commands[0].split()[1:], "--quiet"]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("54 trials planned", done.stdout)
            made = make.all_charts(chart.Context(load.Store(Path(folder) / "results" / "mine.db")))
        drawn = {c.id for c in made if c.figure is not None}
        self.assertEqual({f"friction_leaning_stack__n_{n}" for n in (5, 10, 20)} - drawn, set(), "cost against error")
        self.assertIn("friction_raised_2d", drawn, "the ladder over n")
        self.assertIn("friction_steadiness_2d", drawn)
        self.assertEqual([c.finding for c in made if c.section.startswith("Which method") and c.figure is None], [])

    def test_one_more_method_joins_a_shipped_sweep(self):
        with_it = re.search(r"^lpc (sweep resolvers --with .*)$", MANUAL, re.M).group(1)
        counts = []
        for command in (with_it, "sweep resolvers --dry-run"):
            done = subprocess.run([LPC, *shlex.split(command)], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            counts.append(int(re.search(r"(\d+) trials", done.stdout).group(1)))
        self.assertGreater(counts[0], counts[1])


if __name__ == "__main__":
    LPC = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
