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

    def test_who_falls_and_who_stands(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding, "In 2D on falling_stack with naive+linear half of the height is lost at step 100; with "
                         "catto+linear and catto+ngs it stands, and no body is turned by more than 0.01 rad in the end. That a "
                         "position method which turns no body (linear) makes piles fall is not borne by this scene: under catto "
                         "linear and ngs stand.")
        self.assertEqual(made.headline.text, "On falling_stack in 2D a pile falls with naive+linear and stands with catto+linear "
                                             "and catto+ngs.")
        self.assertEqual(list(made.table["height at the end [m]"]), [10.0, 10.0, 2.0])

    def test_the_planted_bug_half_is_half(self):
        self.assertIsNone(standing.fallen_at([10, 6, 5.1, 5]))
        self.assertEqual(standing.fallen_at([10, 6, 4.9, 6]), 2)
        real, standing.LOST = standing.LOST, 0.0
        try:
            self.assertIsNone(standing.fallen_at([10, 6, 4.9, 6]))
        finally:
            standing.LOST = real

    def test_what_the_report_says_of_linear_is_borne_or_not(self):
        said = lambda **falls: self.one(falls={name.replace("_", "+"): at for name, at in falls.items()}).finding  # noqa: E731
        self.assertIn("is borne by this scene: under catto linear falls at step 50 and ngs stands.",
                      said(catto_linear=50, catto_ngs=None))
        self.assertIn("is not borne by this scene: under naive linear falls at step 90 and ngs falls at step 50.",
                      said(naive_linear=90, naive_ngs=50))
        self.assertIn("is borne in part by", said(naive_linear=90, naive_ngs=50, catto_linear=50, catto_ngs=None))
        self.assertNotIn("this scene", said(catto_ngs=None, catto_nonlinear=None))

    @undrawn.drawn
    def test_the_planted_bug_curves_apart_are_no_one_line(self):
        def drawn(apart):
            made = self.made(over_time, self.piles(falls={"catto+linear": None, "catto+ngs": None}, apart=apart))[0]
            return len([line for line in made.figure.axes[0].lines])
        self.assertEqual([drawn(1e-5), drawn(1.0)], [1, 2])
        real, standing.SEEN = standing.SEEN, 1.0
        try:
            self.assertEqual(drawn(1.0), 1)
        finally:
            standing.SEEN = real

    def test_where_all_stand_there_is_no_headline(self):
        self.assertIsNone(self.one(falls={"catto+linear": None, "catto+ngs": None}).headline)

    def test_only_where_a_sweep_asks(self):
        self.assertEqual(self.made(over_time, synthetic_store.resolvers), [over_time.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
