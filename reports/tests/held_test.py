# SPDX-License-Identifier: Zlib
"""Tests of the chart of methods that hold what is hard to hold. Run by ctest, or python3 reports/tests/held_test.py."""

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

# (method, n) -> milliseconds, sideways drift in m; none: it falls
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
    def test_who_holds_and_at_what_cost(self):
        chart, = self.made(held, self.fill())
        self.assertRegex(chart.finding, r"^In 2D tower, n=10: Each method holds it\. The cheapest but catto is newton, at "
                         r"(1\.9|2|2\.\d+) times the time of catto\. tower, n=100: newton holds it\. The cheapest is newton, at "
                         r"1\.\d+ times the time of catto\.$")
        self.assertEqual(chart.headline.text, "tower, n=100 in 2D is held by newton alone.")
        self.assertTrue(math.isnan(chart.headline.values["catto"]), "what fell has no place among numbers")
        texts = [text.get_text() for text in chart.figure.axes[0].texts]
        self.assertIn("C at step 115", texts)
        self.assertIn("500 nm sag", texts)
        self.assertEqual(list(chart.table["outcome"]), ["ok", "ok", "collapsed", "ok"])

    @undrawn.drawn
    def test_who_has_sunk_is_told_by_how_much_and_does_not_hold(self):
        """A box of 1 m that has sunk by 0.99 m stands on nothing."""
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
        self.assertEqual(chart.finding, "In 2D mass_ratio: catto holds it. soft sinks by 5 % of the smallest body.")
        texts = [text.get_text() for text in chart.figure.axes[0].texts]
        for words in ("S by 5 %", "held to 10 % alone", "S by 99 %", "beyond 50 %"):
            self.assertIn(words, texts)
        self.assertEqual(list(chart.table["held to 1 %"]), ["yes", "no", "no"])
        self.assertEqual(list(chart.table["held to 10 %"]), ["yes", "no", "yes"])

    @undrawn.drawn
    def test_what_left_its_rows_to_gauss_seidel_holds_nothing(self):
        chart, = self.made(held, self.fill(fallbacks="newton"))
        self.assertEqual(chart.finding, "In 2D tower, n=10: catto holds it. Not ranked: newton (62 % Gauss-Seidel). tower, "
                         "n=100: No method holds it. Not ranked: newton (62 % Gauss-Seidel).")
        self.assertIsNone(chart.headline)
        self.assertIn("62 % Gauss-Seidel", [text.get_text() for text in chart.figure.axes[0].texts])
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            bug, = self.made(held, self.fill(fallbacks="newton"))
        self.assertIn("newton holds it", bug.finding, "the planted bug was not seen")

    def test_methods_whose_times_are_noise_are_cheapest_together(self):
        near = {**RUNS, ("other", 10): (2.01, 1e-6), ("other", 100): (2.99, 1e-5)}
        with unittest.mock.patch.dict(RUNS, near):
            chart, = self.made(held, self.fill())
        self.assertIn("The cheapest but catto are newton and other (not told apart), at", chart.finding)

    def test_a_chart_that_counts_what_fell_as_held_is_seen(self):
        chart, = self.made(held, self.fill())
        right, falls.holders = falls.holders, lambda column, limit=0.01: sorted(column.index)
        self.addCleanup(setattr, falls, "holders", right)
        wrong, = self.made(held, self.fill())
        self.assertNotEqual(wrong.finding, chart.finding)

    def test_it_is_made_where_a_sweep_asks_for_it(self):
        self.assertEqual(self.made(held, self.fill(asks=False)), [held.absent])


if __name__ == "__main__":
    unittest.main()
