# SPDX-License-Identifier: Zlib
"""Tests of the chart of who holds what is hard to hold. Run by ctest, or python3 reports/tests/held_test.py."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import held  # noqa: E402

# (method, n) -> milliseconds, sideways drift in m; none: it falls
RUNS = {("catto", 10): (1.0, 1e-3), ("catto", 100): (2.0, None), ("newton", 10): (2.0, 1e-6), ("newton", 100): (3.0, 1e-5)}


class Held(with_store.WithStore):
    def fill(self, asks=True):
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
        return fill

    @undrawn.drawn
    def test_who_holds_and_at_what_cost(self):
        chart, = self.made(held, self.fill())
        self.assertRegex(chart.finding, r"^In 2D tower, n=10 is held by all; the cheapest of them but catto is newton, "
                         r"(1\.9|2|2\.\d+) times the time of catto, 1 µm sideways; tower, n=100 is held by "
                         r"newton; the cheapest of them is newton, 1\.\d+ times the time of catto, 10 µm sideways\.$")
        self.assertEqual(chart.headline.text, "tower, n=100 in 2D is held by newton alone.")
        self.assertTrue(math.isnan(chart.headline.values["catto"]), "what fell has no place among numbers")
        texts = [text.get_text() for text in chart.figure.axes[0].texts]
        self.assertIn("C at step 115", texts)
        self.assertIn("500 nm sag", texts)
        self.assertEqual(list(chart.table["outcome"]), ["ok", "ok", "collapsed", "ok"])

    def test_a_chart_that_counts_what_fell_as_held_is_seen(self):
        chart, = self.made(held, self.fill())
        right, held.holders = held.holders, lambda column: sorted(column.index)
        self.addCleanup(setattr, held, "holders", right)
        wrong, = self.made(held, self.fill())
        self.assertNotEqual(wrong.finding, chart.finding)

    def test_it_is_made_where_a_sweep_asks_for_it(self):
        self.assertEqual(self.made(held, self.fill(asks=False)), [held.ABSENT])


if __name__ == "__main__":
    unittest.main()
