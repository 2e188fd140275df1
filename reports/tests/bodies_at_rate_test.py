# SPDX-License-Identifier: Zlib
"""Tests of how many bodies keep sixty steps a second: sizes and times with known answers. Run by ctest, or
python3 reports/tests/bodies_at_rate_test.py [PICTURE.png]."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import step_times  # noqa: E402
from charts.step_times import bodies_at_rate  # noqa: E402

LIMIT = step_times.LIMIT


class BodiesAtRate(with_store.WithStore):
    @staticmethod
    def ladders(of=None, report=("bodies_at_rate",)):
        """`of`: {method: {bodies: ms, or None for a failed run}}; the 99th percentile is twice the median."""
        def fill(maker):
            maker.sweep("heritage_bodies", "world", whole="label", n="parameter", report=list(report))
            for method, rungs in (of or {"linear": {100: LIMIT / 4, 1000: 2.5 * LIMIT}, "fast": {100: 0.1, 1000: 1.0},
                                         "slow": {100: 20.0, 1000: 200.0}, "hung": {100: 1.0, 1000: None}}).items():
                for n, ms in rungs.items():
                    axes = {"kind": "world", "scene": "rain", "dimension": 2, "whole": method, "n": n, "precision": "f64",
                            "timed": True, "repeat": 0}
                    if ms is None:
                        maker.trial("heritage_bodies", axes, {}, "timeout", "too long")
                    else:
                        maker.trial("heritage_bodies", axes, {"ms_per_step_median": ms, "ms_per_step_p99": 2 * ms, "bodies": n})
        return fill

    def one(self, **about):
        found = self.made(bodies_at_rate, self.ladders(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_known_ladders(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        # From a quarter of the limit at 100 to 2.5 times the limit at 1000, time is proportional to the bodies.
        self.assertEqual(made.finding.headline, "On rain in 2D fast keeps sixty steps a second with ≥ 1,000 bodies.")
        self.assertEqual({row["method"]: list(row.values())[2:] for row in made.finding.rows()}, {
            "linear": ["200", "400"], "fast": ["≥ 1,000", "≥ 1,000"], "slow": ["< 100", "< 100"], "hung": ["≥ 100", "≥ 100"]})
        hatched = [patch for patch in made.figure.axes[0].patches if patch.get_hatch()]
        self.assertEqual(len(hatched), 4, "those of fast and hung")

    def test_the_planted_bug_that_takes_the_largest_size_as_the_answer(self):
        self.assertEqual(step_times.largest([(100, 1.0), (1000, 2.0)])[1], step_times.TOP)
        self.assertEqual(step_times.largest([(100, 1.0), (1000, math.nan), (2000, 3.0)]), (100, step_times.TOP))
        self.assertEqual(step_times.largest([(100, 1.0), (200, 20.0), (300, 2.0), (400, 99.0)])[1], step_times.WITHIN)
        self.assertLess(step_times.largest([(100, 1.0), (200, 20.0), (300, 2.0), (400, 99.0)])[0], 200,
                        "the first size beyond the limit counts")
        self.assertIsNone(self.one(of={"a": {100: 0.1, 1000: 1.0}, "b": {100: 0.2, 1000: 2.0}}).headline)

    def test_the_headline_compares_methods_with_a_known_number(self):
        made = self.one(of={"a": {100: LIMIT / 4, 1000: 2.5 * LIMIT}, "b": {100: LIMIT / 8, 1000: 1.25 * LIMIT}})
        self.assertEqual(made.headline.text, "On rain in 2D b keeps sixty steps a second with 400 bodies, a with 200.")
        self.assertEqual(made.finding.headline, made.headline.text)
        self.assertEqual([row["method"] for row in made.finding.rows()], ["b", "a"])

    def test_it_is_made_only_if_a_sweep_lists_it(self):
        self.assertEqual(self.made(bodies_at_rate, synthetic_store.resolvers), [bodies_at_rate.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
