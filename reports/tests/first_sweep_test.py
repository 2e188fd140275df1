# SPDX-License-Identifier: Zlib
"""The manual's first scene and first sweep, run word for word, end in charts of that sweep. Run by ctest, or
python3 reports/tests/first_sweep_test.py build/test/bin/lpc [CLASS]: FirstSweep, or Choose, which takes longer."""

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
import overlap  # noqa: E402
import style  # noqa: E402
from charts import choose, cost_against_error  # noqa: E402

LPC = ""  # the program, from the command line
DOCS = HERE.parent.parent / "docs"
MANUAL = (DOCS / "manual.md").read_text(encoding="utf-8")
SWEEPS = (DOCS / "reference_sweeps.md").read_text(encoding="utf-8")


def block(heading, kind):
    """The first block of code of this kind below a heading of the manual."""
    section = re.search(rf"^## {heading}$(.*?)(?=^## |\Z)", MANUAL, re.S | re.M).group(1)
    return next(text for name, text in re.findall(r"^```(\w*)[^\n]*\n(.*?)^```$", section, re.S | re.M) if name == kind)


class FirstSweep(unittest.TestCase):
    def test_runs_as_the_manual_has_it_and_is_charted(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "leaning_stack.toml").write_text(block("A first scene", "toml"), encoding="utf-8")
            (Path(folder) / "friction.toml").write_text(block("A first sweep", "toml"), encoding="utf-8")
            commands = re.findall(r"^lpc sweep .*$", block("A first sweep", "sh"), re.M)
            self.assertTrue(commands, "the manual has no command")
            command = [LPC, *commands[0].split()[1:], "--quiet"]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("90 trials planned", done.stdout)
            made = make.all_charts(chart.Context(load.Store(Path(folder) / "results" / "mine.db")))
        drawn = {c.id for c in made if c.figure is not None}
        self.assertEqual({f"friction_leaning_stack__n_{n}" for n in (5, 10, 20)} - drawn, set(), "cost against error")
        self.assertIn("friction_raised_2d", drawn, "the ladder over n")
        self.assertIn("friction_steadiness_2d", drawn)
        self.assertEqual([c.finding.headline for c in made if c.section == cost_against_error.RIGHT_FOR_COST and
                          c.figure is None], [])

    def test_one_more_method_joins_a_shipped_sweep(self):
        with_it = re.search(r"^lpc (sweep resolvers --with .*)$", SWEEPS, re.M).group(1)
        counts = []
        for command in (with_it, "sweep resolvers --dry-run"):
            done = subprocess.run([LPC, *shlex.split(command)], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            counts.append(int(re.search(r"(\d+) trials", done.stdout).group(1)))
        self.assertGreater(counts[0], counts[1])

    def test_choose_takes_a_size(self):
        command = re.search(r"^lpc (sweep choose --set .*)$", SWEEPS, re.M).group(1)
        done = subprocess.run([LPC, *shlex.split(command), "--dry-run"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(re.findall(r"^choose_(\w+)", done.stdout, re.M), ["broadphase", "contacts", "resolver"])
        run = HERE.parent.parent / "experiments" / "run"
        for arguments, said in ((("choose", "--bodies", "many"), "--bodies needs a number, not 'many'"),
                                (("quick", "--bodies", "50"), "valid with: choose"), (("choose", "full"), "one set")):
            done = subprocess.run([run, *arguments], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn(said, done.stderr)


class Choose(unittest.TestCase):
    def test_it_says_what_to_take_for_fifty_bodies(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "choose.db"

            def run(*arguments):
                done = subprocess.run([LPC, *arguments], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                return done.stdout.strip()

            small = ("--set", "n=50", "--set", "steps=30", "--set", "seed=1", "--store", str(path), "--quiet")
            run("sweep", "choose", *small)
            taken = run("report", str(path), "--taken")
            if taken:  # unless it is what every stage was judged with
                run("sweep", "choose_together", *small, "--with", f"taken={taken}")
            self.assertEqual(run("report", str(path), "--taken"), "", "a canonical pipeline is found again by its short text")
            made = make.all_charts(chart.Context(load.Store(path)))
        self.addCleanup(style.plt.close, "all")
        found = [c for c in made if c.section == choose.SECTION]
        self.assertEqual([c.id for c in found], ["choose_mixed_pile__2d__n_50__steps_30"])
        table = found[0].table
        self.assertEqual(sorted(set(table["stage"])), ["as a whole", "broadphase", "contacts", "resolver"])
        taken = table[table["verdict"] == "take"]
        self.assertEqual(sorted(taken["stage"]), ["as a whole", "broadphase", "contacts", "resolver"], "one of each")
        self.assertEqual(set(taken["role"]), {"competitor"})
        self.assertLessEqual({"fcl_tree", "bullet_dbvt", "box2d", "soft_step", "naive"}, set(table["method"]))
        for name in taken[taken["stage"] != "as a whole"]["method"]:
            self.assertIn(name, set(found[0].finding.table["take"]))
        self.assertIn("as a whole", set(found[0].finding.table["stage"]))
        self.assertEqual(overlap.overlaps(found[0].figure), ([], []))


if __name__ == "__main__":
    LPC = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
