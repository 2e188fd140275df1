# SPDX-License-Identifier: Zlib
"""The commands below a chart make what it shows: each is run as it is printed. Run by ctest, or
python3 reports/tests/printed_commands_test.py build/test/bin/lpc."""

import html
import re
import shlex
import sqlite3
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
import pages  # noqa: E402
import style  # noqa: E402

LPC = ""  # the program, from the command line
BOXES = """summary = "s"
kind = "boxes"
timed = true
[axes]
dimension = 2
distribution = "uniform"
frames = 12
n = [8, 16, 32]
broadphase = ["naive", "region_tree", "planted_slow"]
"""
WORLDS = """summary = "s"
kind = "world"
[axes]
scene = "pyramid"
base = [2, 3]
steps = 5
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto}"
"soft_step" = "solver=soft_step"
"""


class PrintedCommands(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.addCleanup(style.plt.close, "all")
        self.folder = Path(scratch.name)
        (self.folder / "my sweeps").mkdir()
        (self.folder / "my sweeps" / "boxes.toml").write_text(BOXES, encoding="utf-8")
        (self.folder / "worlds.toml").write_text(WORLDS, encoding="utf-8")
        (self.folder / "both.toml").write_text('summary = "s"\nsweeps = ["my sweeps/boxes.toml", "worlds.toml"]\n',
                                               encoding="utf-8")
        self.plugin = ["--plugin", str(Path(LPC).parent.parent / "lib" / "liblpc_planted.so")]

    def lpc(self, *arguments):
        return subprocess.run([LPC, *arguments, *(() if "--quiet" in arguments else ("--quiet",))], cwd=self.folder,
                              capture_output=True, text=True, check=False)

    def fill(self, *arguments):
        done = self.lpc(*arguments, "--store", "s.db")
        self.assertEqual(done.returncode, 0, done.stderr)

    def opened(self):
        return load.Store(self.folder / "s.db")

    def planned(self, sweep):
        with sqlite3.connect(self.folder / "s.db") as db:
            return sorted(db.execute("SELECT key, axes FROM planned WHERE sweep=?", (sweep,)))

    def printed(self, sweep):
        """The lines of `lpc` below the charts of this sweep, which are the same for all."""
        store = self.opened()
        lines = pages.commands(store, chart.Chart("c", "", "", "", sweep), "s.db", "out")
        self.assertEqual(lines[-1], "reports/make.py --store s.db --out out --only c")
        return lines[:-1]

    def holds(self, sweep):
        """Whether what is printed plans this sweep's cells and nothing else, and finds all of them done."""
        before, lines = self.planned(sweep), self.printed(sweep)
        with sqlite3.connect(self.folder / "s.db") as db:
            db.execute("DELETE FROM planned WHERE sweep=?", (sweep,))
        for line in lines:
            program, *arguments = shlex.split(line)
            self.assertEqual(program, "build/release/bin/lpc")
            done = self.lpc(*arguments)
            if done.returncode != 0 or ("sweep" in arguments and " 0 run," not in done.stdout):
                return False
        return bool(before) and self.planned(sweep) == before

    def test_a_file_with_plugin_and_set(self):
        self.fill(*self.plugin, "sweep", "./my sweeps/boxes.toml", "--set", "n=12")
        self.assertTrue(self.holds("boxes"), self.printed("boxes"))
        with sqlite3.connect(self.folder / "s.db") as db:  # as before there were any
            db.execute("UPDATE sweep SET roles = json_remove(roles, '$.commands')")
        self.assertEqual(self.printed("boxes"), ["build/release/bin/lpc sweep boxes --store s.db"])
        self.assertFalse(self.holds("boxes"), "the sweep's name alone is another command")

    def test_parts_are_asked_for_one_by_one(self):
        for part in ("naive", "planted_slow", "naive"):
            self.fill(*self.plugin, "sweep", "./my sweeps/boxes.toml", "--only", part)
        self.assertEqual([re.search("--only (\\S+)", line).group(1) for line in self.printed("boxes")], ["naive", "planted_slow"])
        self.assertTrue(self.holds("boxes"))
        self.fill(*self.plugin, "sweep", "./my sweeps/boxes.toml")  # the whole, which the parts are of
        self.assertEqual(len(self.printed("boxes")), 1)
        self.assertTrue(self.holds("boxes"))

    def test_of_a_set_each_sweep_has_what_it_takes(self):
        self.fill(*self.plugin, "sweep", "both.toml", "--with", "none=solver=split_solver{velocity=catto,position=none}", "--set",
                  "base=2", "--set", "n=12", "--only", "none,catto,naive")
        for sweep, has, lacks in (("boxes", "n=12", "base=2"), ("worlds", "--with", "n=12")):
            line = self.printed(sweep)[0]
            self.assertIn(has, line)
            self.assertNotIn(lacks, line)
            self.assertTrue(self.holds(sweep), line)

    def test_needs(self):
        self.fill("needs", "pyramid", "--param", "base=2", "--seeds", "1", "--steps", "5", "--pipeline", "solver=soft_step")
        self.assertTrue(self.printed("needs_pyramid")[0].startswith("build/release/bin/lpc needs pyramid --seeds 1 "))
        self.assertTrue(self.holds("needs_pyramid"))

    def test_a_stopped_sweep_is_told_first_with_what_continues_it(self):
        self.fill(*self.plugin, "sweep", "./my sweeps/boxes.toml", "--set", "n=12")
        self.assertEqual(pages.missing(self.opened(), "s.db"), [])
        with sqlite3.connect(self.folder / "s.db") as db:
            db.execute("DELETE FROM trial WHERE json_extract(canonical, '$.broadphase') = 'planted_slow'")
        (sentence, lines), = pages.missing(self.opened(), "s.db")
        self.assertEqual(sentence, "1 of 3 trials of boxes are missing: the sweep was stopped, or still runs.")
        make.main(["--store", str(self.folder / "s.db"), "--out", str(self.folder / "out")])
        page = html.unescape((self.folder / "out" / "index.html").read_text(encoding="utf-8"))
        self.assertLess(page.index(sentence), page.index('id="contents"'), "on the first screen")
        for line in lines:
            self.assertIn(line.split(" --store")[0], page)
            self.assertEqual(self.lpc(*shlex.split(line)[1:]).returncode, 0)
        self.assertEqual(pages.missing(self.opened(), "s.db"), [])


if __name__ == "__main__":
    LPC = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
