# SPDX-License-Identifier: Zlib
"""Tests of the phases of the 2009 report over a script: known phases, counts and ratios. Run by ctest, or
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
        """`slow`: {repeat: factor of the times of its last tenth}; every repeat then stores its times."""
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
        table = made.finding.table.set_index("run")
        columns = ["before the half [s]", "peak [s]", "last tenth [s]", "contact points per body [1]",
                   "awake in the second half, least [1]", "repeats [1]"]
        for run, numbers in (("first", (100e-6, 200e-6, 200e-6, 1.2, 40, 1)), ("second", (30e-6, 50e-6, 50e-6, 1.2, 2, 1))):
            for column, number in zip(columns, numbers):
                self.assertAlmostEqual(table.at[run, column], number, msg=column)
        self.assertEqual(list(table["awake at the end"]), ["40 of 50", "2 of 50"])
        self.assertEqual(list(table["median step over the first run's"]), [1.0, 0.27])
        self.assertEqual(made.headline.text, "At the end of director_1, 2D a step takes 200 µs with first (40 bodies awake) and "
                                             "50 µs with second (2).")
        self.assertIn("just over 7 ms at the peak", made.note)
        share = made.table[made.table["run"] == "first"].set_index("phase")["share of the time [1]"]
        self.assertAlmostEqual(share["resolveVelocities"], 0.4)
        self.assertAlmostEqual(share["other"], 0.2)

    def test_the_planted_bug_a_ratio_without_repeats_is_a_tie(self):
        runs = {"first": (100, 100, 3), "second": (70, 70, 3)}
        ratio = lambda: self.one(runs=runs, repeats=1).finding.table["median step over the first run's"].iloc[1]  # noqa: E731
        self.assertEqual(ratio(), "tie: too few repeats")
        real, stages.noise.said = stages.noise.said, lambda a, b, metric, least: "0.70"
        try:
            self.assertEqual(ratio(), 0.7)
        finally:
            stages.noise.said = real

    def test_times_of_several_repeats_are_medians_with_their_range(self):
        last = lambda slow: self.one(slow=slow).finding.table.set_index("run").loc["first"]  # noqa: E731
        even, uneven = last({}), last({0: 2, 1: 1.1})
        self.assertEqual((even["range, last tenth"], even["repeats [1]"]), ("200 µs", 4))
        self.assertEqual(uneven["range, last tenth"], "200 µs to 400 µs")
        self.assertAlmostEqual(uneven["last tenth [s]"], 210e-6)

    def test_the_planted_bug_a_slow_first_repeat_moves_the_range_alone(self):
        def check():
            made = self.one(slow={0: 2})
            share = made.table[made.table["run"] == "first"].set_index("phase")
            row = made.finding.table.set_index("run").loc["first"]
            return (abs(row["last tenth [s]"] - 200e-6) < 1e-9 and list(row[["range, before the half", "range, peak",
                    "range, last tenth"]]) == ["100 µs", "200 µs to 400 µs", "200 µs to 400 µs"],
                    made.headline.text == self.one(slow={}).headline.text,
                    abs(share.at["resolveVelocities", "median of the last tenth [s]"] - 80e-6) < 1e-9,
                    abs(share.at["whole step", "median of the last tenth [s]"] - 200e-6) < 1e-9)
        self.assertEqual(check(), (True,) * 4)
        real, stages.wholes = stages.wholes, lambda store, cell: real(store, cell)[:1]
        try:
            self.assertEqual(check(), (False,) * 4)
        finally:
            stages.wholes = real

    def test_a_failed_run_has_no_end_to_compare(self):
        made = self.one(failed=("second",))
        self.assertEqual(list(made.finding.table["run"]), ["first"])
        self.assertIsNone(made.headline)
        self.assertIn("exploded at step 999", " ".join(made.holes))

    def test_only_where_a_sweep_asks(self):
        self.assertEqual([c.id for c in self.made(script_profile, synthetic_store.stages)], [script_profile.absent.id])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
