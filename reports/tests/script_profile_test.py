# SPDX-License-Identifier: Zlib
"""Tests of a script's profile under the names of 2009: known phases, counts and ratios. Run by ctest, or
python3 reports/tests/script_profile_test.py [PICTURE.png]."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402

import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import stages  # noqa: E402
from charts.stages import script_profile  # noqa: E402

STEPS = 1000
# Method: µs of a step in the first and in the second half, awake in the second half
RUNS = {"first": (100, 200, 40), "second": (30, 50, 2)}


class ScriptProfile(with_store.WithStore):
    @staticmethod
    def scripts(runs=None, repeats=4, report=("script_profile",), failed=(), slow=None):
        """`slow`: {repeat: how many times as slow it is in its last tenth}, where every repeat stores its times."""
        def fill(maker):
            maker.sweep("heritage_sleeping", "world", resolver="label", report=list(report))
            half = np.arange(STEPS) >= STEPS // 2
            for method, (before, after, awake) in (runs or RUNS).items():
                whole = np.where(half, after, before) * 1e-6
                series = {"seconds": whole, "bodies": np.full(STEPS, 50), "awake": np.where(half, awake, 45),
                          "points": np.full(STEPS, 60),
                          **{scope: whole * share for scope, share in
                             zip(stages.PHASES.values(), (0.1, 0.2, 0.05, 0.4, 0.05))}}
                axes = {"kind": "world", "scene": "director_1", "dimension": 2, "resolver": method, "precision": "f64"}
                outcome = ("exploded", "speed", STEPS - 1) if method in failed else ("ok",)
                maker.trial("heritage_sleeping", {**axes, "timed": False, "repeat": 0}, {"bodies": 50}, *outcome)
                for repeat in range(repeats):
                    late = np.where(np.arange(STEPS) >= STEPS * 9 // 10, (slow or {}).get(repeat, 1), 1)
                    mine = {name: values * late if name.startswith("sec") else values for name, values in series.items()
                            if repeat == 0 or name == "seconds"}
                    maker.trial("heritage_sleeping", {**axes, "timed": True, "repeat": repeat},
                                {"ms_per_step_median": (before + after) / 2e3 * (1 + 0.01 * (repeat % 2))}, *outcome,
                                series=None if repeat and slow is None else mine)
        return fill

    def one(self, **about):
        found = self.made(script_profile, self.scripts(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_numbers_of_each_run_and_the_ratio(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding, "On director_1, 2D first: 100 µs a step and 1.2 contact points a body before the half, "
                         "200 µs at the peak, 200 µs in the last tenth, 40 of 50 bodies awake in the end and at least 40 in "
                         "each step of the second half; second: 30 µs a step and 1.2 contact points a body before the half, "
                         "50 µs at the peak, 50 µs in the last tenth, 2 of 50 bodies awake in the end and at least 2 in each "
                         "step of the second half. By the median step of the whole run, and first as 1: second 0.27 times. "
                         "These times are of one repeat, where whatever else the machine did shows.")
        self.assertEqual(made.headline.text, "At the end of director_1, 2D a step takes 200 µs with first (40 bodies awake) and "
                                             "50 µs with second (2).")
        self.assertIn("The report has a peak just over 7 ms", made.note)
        share = made.table[made.table["run"] == "first"].set_index("phase")["share of the time [1]"]
        self.assertAlmostEqual(share["resolveVelocities"], 0.4)
        self.assertAlmostEqual(share["other"], 0.2)

    def test_the_planted_bug_a_ratio_without_repeats_is_not_told(self):
        runs = {"first": (100, 100, 3), "second": (70, 70, 3)}
        self.assertIn("second with too few repeats to measure a difference", self.one(runs=runs, repeats=1).finding)
        real, stages.noise.said = stages.noise.said, lambda a, b, metric, least: "0.70"
        try:
            self.assertIn("second 0.70 times", self.one(runs=runs, repeats=1).finding)
        finally:
            stages.noise.said = real

    def test_times_of_several_repeats_are_medians_with_their_range(self):
        even = self.one(slow={}).finding
        self.assertIn("200 µs (200 µs to 200 µs) in the last tenth", even)
        self.assertIn("Each step's time is the median of 4 repeats", even)
        made = self.one(slow={0: 2, 1: 1.1})
        self.assertIn("210 µs (200 µs to 400 µs) in the last tenth", made.finding)

    def test_the_planted_bug_a_slow_first_repeat_moves_the_range_alone(self):
        def check():
            made = self.one(slow={0: 2})
            share = made.table[made.table["run"] == "first"].set_index("phase")
            return ("100 µs (100 µs to 100 µs) a step and 1.2 contact points a body before the half, 200 µs (200 µs to 400 µs) "
                    "at the peak, 200 µs (200 µs to 400 µs) in the last tenth" in made.finding,
                    made.headline.text == self.one(slow={}).headline.text,
                    abs(share.at["resolveVelocities", "median of the last tenth [s]"] - 80e-6) < 1e-9,
                    abs(share.at["whole step", "median of the last tenth [s]"] - 200e-6) < 1e-9)
        self.assertEqual(check(), (True,) * 4)
        real, stages.wholes = stages.wholes, lambda store, cell: real(store, cell)[:1]
        try:
            self.assertEqual(check(), (False,) * 4)
        finally:
            stages.wholes = real

    def test_what_failed_has_no_end_to_compare(self):
        made = self.one(failed=("second",))
        self.assertNotIn("second:", made.finding)
        self.assertIsNone(made.headline)
        self.assertIn("exploded at step 999", " ".join(made.holes))

    def test_only_where_a_sweep_asks(self):
        self.assertEqual([c.id for c in self.made(script_profile, synthetic_store.stages)], [script_profile.absent.id])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
