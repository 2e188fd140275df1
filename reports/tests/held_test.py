# SPDX-License-Identifier: Zlib
"""Tests of the chart of methods that hold hard scenes. Run by ctest, or python3 reports/tests/held_test.py."""

import math
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import ranking  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import falls  # noqa: E402
from charts.falls import held  # noqa: E402

# (method, n) -> milliseconds, sideways drift in m; None: the run falls
RUNS = {("catto", 10): (1.0, 1e-3), ("catto", 100): (2.0, None), ("newton", 10): (2.0, 1e-6), ("newton", 100): (3.0, 1e-5)}
SUNK = {"soft": 0.05, "naive": 0.99}  # of the smallest body


class Held(with_store.WithStore):
    def fill(self, asks=True, fallbacks=None):
        def fill(maker):
            for name in ("lateral_max", "sag_end"):
                maker.db.execute("INSERT INTO metrics VALUES ('metric', ?, 'world', ?, 'm', '', 'detail', '', '')", (name, name))
            maker.sweep("hard", baseline="catto", resolver="label", n="parameter", **({"report": ["held"]} if asks else {}))
            for (method, n), (ms, drift) in RUNS.items():
                axes = {"scene": "tower", "dimension": 2, "n": n, "resolver": method}
                maker.world("hard", axes, ms, 1e-3, "ok" if drift else "collapsed", "" if drift else "drift",
                            None if drift else 115, repeats=5)
            planned = "SELECT key, json_extract(axes, '$.resolver'), json_extract(axes, '$.n') FROM planned"
            for key, method, n in maker.db.execute(planned).fetchall():
                drift = RUNS[method, n][1] or 1.0
                maker.db.execute("UPDATE trial SET metrics = json_set(metrics, '$.lateral_max', ?, '$.sag_end', ?) WHERE key = ?",
                                 (drift, drift / 2, key))
            if fallbacks:
                maker.leave_rows(62, where=fallbacks)
        return fill

    @undrawn.drawn
    def test_the_table_has_the_methods_that_hold_and_their_cost(self):
        chart, = self.made(held, self.fill())
        self.assertEqual(chart.finding.headline, "Only newton holds tower, n=100 in 2D.")
        self.assertEqual(chart.headline.text, chart.finding.headline)
        first, second = chart.finding.rows()
        self.assertEqual([list(row.values())[:4] for row in (first, second)], [
            ["tower, n=10", "all methods", "", "newton"], ["tower, n=100", "newton", "catto", "newton"]])
        self.assertRegex(first["its time over that of catto"], r"^(1\.9|2|2\.\d+) times$")
        self.assertRegex(second["its time over that of catto"], r"^1\.\d+ times$")
        self.assertTrue(math.isnan(chart.headline.values["catto"]), "a failed run has no number")
        texts = [text.get_text() for text in chart.figure.axes[0].texts]
        self.assertIn("C at step 115", texts)
        self.assertIn("500 nm sag", texts)
        self.assertEqual(list(chart.table["outcome"]), ["ok", "ok", "collapsed", "ok"])

    @undrawn.drawn
    def test_a_method_that_sinks_does_not_hold_and_has_its_depth(self):
        """A box of 1 m that has sunk by 0.99 m no longer stands."""
        def fill(maker):
            for name in ("lateral_max", "sag_end", "sunk"):
                maker.db.execute("INSERT INTO metrics VALUES ('metric', ?, 'world', ?, '1', '', 'detail', '', '')", (name, name))
            maker.sweep("hard", baseline="catto", resolver="label", report=["held"])
            for method in ("catto", *SUNK):
                maker.trial("hard", {"kind": "world", "scene": "mass_ratio", "dimension": 2, "resolver": method, "timed": False},
                            {"sunk": SUNK.get(method, 0.0), "lateral_max": 0.0, "sag_end": SUNK.get(method, 0.0)},
                            "sank" if method in SUNK else "ok", "sagged" if method in SUNK else "",
                            600 if method in SUNK else None)
        chart, = self.made(held, fill)
        self.assertEqual(chart.finding.headline, "Only catto holds mass_ratio in 2D.")
        self.assertEqual(chart.finding.rows(), [{"scene": "mass_ratio", "held by": "catto", "sinks": "soft by 5 %",
                                                 "fails": "naive"}])
        texts = [text.get_text() for text in chart.figure.axes[0].texts]
        for words in ("S by 5 %", "holds to 10 %", "S by 99 %", "beyond 50 %"):
            self.assertIn(words, texts)
        self.assertEqual(list(chart.table["held to 1 %"]), ["yes", "no", "no"])
        self.assertEqual(list(chart.table["held to 10 %"]), ["yes", "no", "yes"])

    @undrawn.drawn
    def test_a_method_that_left_its_rows_to_gauss_seidel_holds_nothing(self):
        chart, = self.made(held, self.fill(fallbacks="newton"))
        self.assertEqual(chart.finding.headline, "In 2D 1 of 2 scenes is held by a ranked method.")
        self.assertEqual([tuple(row.values()) for row in chart.finding.rows()], [
            ("tower, n=10", "catto", "", "not ranked: newton (62 % Gauss-Seidel)"),
            ("tower, n=100", "none", "catto", "not ranked: newton (62 % Gauss-Seidel)")])
        self.assertIsNone(chart.headline)
        self.assertIn("62 % Gauss-Seidel", [text.get_text() for text in chart.figure.axes[0].texts])
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            bug, = self.made(held, self.fill(fallbacks="newton"))
        self.assertIn("Only newton holds", bug.finding.headline, "the planted bug was not seen")

    def test_methods_whose_times_are_noise_are_cheapest_together(self):
        near = {**RUNS, ("other", 10): (2.01, 1e-6), ("other", 100): (2.99, 1e-5)}
        with unittest.mock.patch.dict(RUNS, near):
            chart, = self.made(held, self.fill())
        self.assertEqual({row["cheapest besides catto"] for row in chart.finding.rows()}, {"newton and other (tie)"})

    def test_the_planted_bug_that_a_failed_run_holds_is_seen(self):
        chart, = self.made(held, self.fill())
        right, falls.holders = falls.holders, lambda column, limit=0.01: sorted(column.index)
        self.addCleanup(setattr, falls, "holders", right)
        wrong, = self.made(held, self.fill())
        self.assertNotEqual(wrong.finding.text(), chart.finding.text())

    def test_it_is_made_only_if_a_sweep_lists_it(self):
        self.assertEqual(self.made(held, self.fill(asks=False)), [held.absent])


if __name__ == "__main__":
    unittest.main()
