# SPDX-License-Identifier: Zlib
"""The page of `lpc needs` agrees with what the program prints, from the same store. Run by ctest, or
python3 reports/tests/needs_test.py build/test/bin/lpc."""

import json
import re
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import headlines  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import needs  # noqa: E402

LPC = ""  # the program, from the command line


def shown(form, value):
    return "-" if value != value else form % value


def as_printed(table):
    """The rows of the page, formatted as the program prints them."""
    rows = []
    for _, row in table.iterrows():
        time, low, high, updates, median, farthest = row.iloc[1:7]
        whole = "-" if time != time else f"{time:.2f} ({low:.2f} .. {high:.2f})"
        rows.append((row["model"], whole, shown("%.3f", updates), shown("%.2g", median), shown("%.2g", farthest), row["remark"]))
    return rows


def printed(text):
    """The rows below the table's head: columns of fixed widths, then the remark."""
    lines = text.split("\n")
    start = next(i for i, line in enumerate(lines) if line.startswith("model "))
    rows = []
    for line in lines[start + 1:]:
        if not line:
            break
        rows.append(tuple(part.strip() for part in (line[:18], line[18:43], line[43:56], line[56:68], line[68:80], line[80:])))
    return rows


class PageAndProgram(undrawn.Undrawn):
    def setUp(self):
        super().setUp()
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        self.path = Path(self.folder.name) / "needs.db"

    def ask(self, arguments):
        done = subprocess.run([LPC, "needs", *arguments.split(), "--quiet", "--store", str(self.path)], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def charts(self):
        return [c for c in make.all_charts(chart.Context(load.Store(self.path))) if c.section == needs.SECTION]

    def compare(self, arguments):
        """(printed text, chart), which must agree in every number and remark."""
        text = self.ask(arguments)
        made = self.charts()
        self.assertEqual(len(made), 1)
        self.assertEqual(printed(text), as_printed(made[0].table), text)
        if self.draws:
            self.assertEqual(overlap.overlaps(made[0].figure), ([], []))
        return text, made[0]

    def change(self, what):
        """Edits the trials of the store: what(axes, metrics) changes the metrics and returns an outcome."""
        db = sqlite3.connect(self.path)
        trials = db.execute("SELECT t.key, p.axes, t.metrics FROM trial t JOIN planned p USING (key)").fetchall()
        for key, axes, metrics in trials:
            numbers = json.loads(metrics)
            outcome = what(json.loads(axes), numbers)
            db.execute("UPDATE trial SET metrics=?, outcome=?, reason=? WHERE key=?",
                       (json.dumps(numbers), outcome, "" if outcome == "ok" else "as planted", key))
        db.commit()
        db.close()

    @undrawn.drawn
    def test_agree_on_an_unchanged_store(self):
        text, made = self.compare("slope --seeds 2 --steps 60 --perturb 0")
        self.assertEqual(printed(text)[0][-1], "seeds move nothing in this scene")
        self.assertIn("slope in 2D", made.title)
        self.path = self.path.with_name("another.db")
        text, made = self.compare("pyramid --param base=3 --steps 40 --seeds 4")
        self.assertEqual(printed(text)[0][0], "another seed")

    def test_agree_on_a_switch_without_effect(self):
        _, made = self.compare("pyramid --param base=3 --steps 40 --seeds 1 --pipeline sleep=none")
        remarks = dict(zip(made.table["model"], made.table["remark"]))
        self.assertEqual(remarks["+sleeping"], f"{needs.IDLE}: sleep=none")
        self.assertEqual(with_store.row(made, "+sleeping")["remark"], f"{needs.IDLE}: sleep=none")

    def test_agree_without_times(self):
        """The first steps are not timed, so a run of one step has no median."""
        self.compare("slope --seeds 1 --steps 1")

    def test_agree_on_every_remark(self):
        """Planted times, and runs that fail."""
        def as_planted(axes, metrics):
            model, seed = axes["model"], axes["seed"]
            metrics["ms_per_step_median"] = {"minimal": 1 + 0.03 * axes["repeat"] * (-1) ** seed, "3d": 5 + 0.1 * seed,
                                             "-cache": 1.5, "-friction": 0.5 + 0.2 * seed, "+joints": 1.02}.get(model, 0.9)
            metrics["work_multiply_adds"] += model in ("-cache", "-friction")
            if model == "+sleeping" and seed > 1:
                return "collapsed"
            return "ok"
        for seeds, cache in ((3, needs.UNKNOWN), (4, "")):
            self.ask(f"pyramid --param base=3 --steps 20 --seeds {seeds}")
            self.change(as_planted)
            text, made = self.compare(f"pyramid --param base=3 --steps 20 --seeds {seeds}")
            remarks = {row[0]: row[-1] for row in printed(text)}
            self.assertEqual(remarks["-cache"], cache)
            self.assertEqual(remarks["3d"], "", "a ratio beyond 2 counts even with few seeds")
            self.assertIn(needs.WITHIN, remarks["-friction"], "the ratios of its seeds span 1")
            self.assertEqual(remarks["+joints"], f"{needs.EQUAL}, {needs.WITHIN}")
            self.assertEqual(remarks["+sleeping"], f"{seeds - 1} of {seeds} collapsed: as planted")
            self.assertTrue(any("+sleeping: " in hole for hole in made.holes), made.holes)
        # Planted bug: a wrong page is noticed.
        self.addCleanup(setattr, needs, "WITHIN", needs.WITHIN)
        needs.WITHIN = "noise"
        self.assertNotEqual(printed(text), as_printed(self.charts()[0].table))

    def test_the_headline_names_the_switch_that_changes_the_time_most(self):
        def dear(axes, metrics):
            metrics["ms_per_step_median"] = (4.0 if axes["model"] == "3d" else 1.0) + 0.01 * axes["seed"] * axes["repeat"]
            return "ok"
        self.ask("pyramid --param base=3 --steps 40 --seeds 4")
        self.change(dear)
        _, made = self.compare("pyramid --param base=3 --steps 40 --seeds 4")
        self.assertRegex(made.finding.headline, r"^pyramid in 2D takes 4\.00 times the time with 3d, and its bodies end up to "
                         r"[\d.]+ .?m from their places with the own model\.$")
        self.assertEqual(made.headline.text, made.finding.headline)
        first = made.finding.rows()[0]
        self.assertEqual((first["model"], round(first[needs.TIME], 1)), ("3d", 4.0))
        self.assertRegex(first["range over seeds"], r"^4(\.0\d)?( to 4\.0\d)?$")
        self.assertIn("bodies end farther away than under another seed", with_store.row(made, "-friction")["remark"])
        for model in ("+continuous", "+joints"):
            self.assertEqual(with_store.row(made, model)["farthest body"], "0 m")
        self.assertIn("over 4 seeds", made.note)
        self.assertEqual(headlines.chosen([made]), [made], "it has a picture on the first screen")
        self.assertTrue(re.search("another seed starts", made.note))


if __name__ == "__main__":
    LPC = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
