# SPDX-License-Identifier: Zlib
"""Tests of height and drift over time: which pile falls, and when. Run by ctest, or
python3 reports/tests/over_time_test.py [PICTURE.png]."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import standing  # noqa: E402
from charts.standing import over_time  # noqa: E402

import numpy as np  # noqa: E402

STEPS = 300


class OverTime(with_store.WithStore):
    @staticmethod
    def piles(falls=None, report=("over_time",), apart=0.0):
        def fill(maker):
            maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                             ("metric", "tilt_end", "world", "turn at the end", "rad", "invented", "detail", "less", ""))
            maker.sweep("heritage_positions", "world", resolver="label", report=list(report))
            usual = {"naive+linear": 100, "catto+linear": None, "catto+ngs": None} if falls is None else falls
            for i, (method, at) in enumerate(usual.items()):
                down = np.zeros(STEPS) if at is None else (np.arange(STEPS) >= at) * 8.0
                maker.trial("heritage_positions", {"kind": "world", "scene": "falling_stack", "dimension": 2, "resolver": method,
                                                   "precision": "f64", "timed": False, "repeat": 0},
                            {"tilt_end": 0.01 if at is None else 1.5},
                            series={"height": 10 - down - i * apart, "drift": 0.1 + down})
        return fill

    def one(self, **about):
        found = self.made(over_time, self.piles(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    def test_the_finding_has_the_methods_that_fall_and_that_stand(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "On falling_stack in 2D the pile falls with naive+linear; it stands with "
                         "catto+linear and catto+ngs.")
        self.assertEqual([tuple(row.values()) for row in made.finding.rows()], [
            ("catto+linear", "never", 0.01), ("catto+ngs", "never", 0.01), ("naive+linear", "100", 1.5)])
        self.assertIn("is not confirmed by this scene", made.note)
        self.assertEqual(made.headline.text, made.finding.headline)
        self.assertEqual(list(made.table["height at the end [m]"]), [10.0, 10.0, 2.0])

    def test_the_planted_bug_half_is_half(self):
        self.assertIsNone(standing.fallen_at([10, 6, 5.1, 5]))
        self.assertEqual(standing.fallen_at([10, 6, 4.9, 6]), 2)
        real, standing.LOST = standing.LOST, 0.0
        try:
            self.assertIsNone(standing.fallen_at([10, 6, 4.9, 6]))
        finally:
            standing.LOST = real

    def test_the_claim_of_2009_on_linear_is_confirmed_or_not(self):
        made = lambda **falls: self.one(falls={name.replace("_", "+"): at for name, at in falls.items()})  # noqa: E731
        rows = lambda found: {row["method"]: row["half of the height lost at step"] for row in found.finding.rows()}  # noqa: E731
        found = made(catto_linear=50, catto_ngs=None)
        self.assertIn("is confirmed by this scene", found.note)
        self.assertEqual(rows(found), {"catto+ngs": "never", "catto+linear": "50"})
        found = made(naive_linear=90, naive_ngs=50)
        self.assertIn("is not confirmed by this scene", found.note)
        self.assertEqual(rows(found), {"naive+linear": "90", "naive+ngs": "50"})
        self.assertIn("is confirmed under catto only by",
                      made(naive_linear=90, naive_ngs=50, catto_linear=50, catto_ngs=None).note)
        self.assertNotIn("this scene", made(catto_ngs=None, catto_nonlinear=None).note)

    @undrawn.drawn
    def test_the_planted_bug_that_draws_distant_curves_as_one_line(self):
        def drawn(apart):
            made = self.made(over_time, self.piles(falls={"catto+linear": None, "catto+ngs": None}, apart=apart))[0]
            return len([line for line in made.figure.axes[0].lines])
        self.assertEqual([drawn(1e-5), drawn(1.0)], [1, 2])
        real, standing.SEEN = standing.SEEN, 1.0
        try:
            self.assertEqual(drawn(1.0), 1)
        finally:
            standing.SEEN = real

    def test_if_all_stand_there_is_no_headline(self):
        self.assertIsNone(self.one(falls={"catto+linear": None, "catto+ngs": None}).headline)

    def test_only_where_a_sweep_asks(self):
        self.assertEqual(self.made(over_time, synthetic_store.resolvers), [over_time.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
