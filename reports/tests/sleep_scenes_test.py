# SPDX-License-Identifier: Zlib
"""Tests of waking waves, touches and slow rollers: runs with known answers. Run by ctest, or
python3 reports/tests/sleep_scenes_test.py [PICTURE.png]."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import with_store  # noqa: E402

import sleep_scenes  # noqa: E402
import undrawn  # noqa: E402
from charts.sleeping import sleeping  # noqa: E402

# policy: (woken, steps) of a wave of 5, woken by a touch at 0.05 m/s, from which step rollers sleep at 0.001 and 0.1 m/s
POLICIES = {"none": ((0, None), 0, None, None), "millington": ((5, 4), 0, 60, 68), "split_average": ((5, 4), 0, 1, None),
            "timer_island": ((5, 0), 5, 29, None)}


class SleepScenes(with_store.WithStore):
    @staticmethod
    def scenes(policies=None, outcomes=None):
        def fill(maker):
            for name in ("awake_mean", "woken", "wake_steps"):
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "world", name, "1", name, "detail", "", ""))
            maker.sweep("sleeping", baseline="none", policy="label", n="parameter", speed="parameter")
            for policy, (wave, touch, *rolls) in (policies or POLICIES).items():
                axes = {"kind": "world", "dimension": 2, "precision": "f64", "policy": policy}
                outcome = ((outcomes or {}).get(policy, "ok"),)
                about = {"extra": {"pipeline": f"sleep={policy}"}}
                # Without work there is no chart of savings, which another test covers.
                found = {"work_multiply_adds": 0, "awake_mean": 1}
                maker.trial("sleeping", {**axes, "scene": "sleep_wave", "n": 5},
                            {**found, "woken": wave[0], "wake_steps": wave[1]}, *outcome, **about)
                maker.trial("sleeping", {**axes, "scene": "sleep_touch", "speed": 0.05}, {**found, "woken": touch}, *outcome,
                            **about)
                for speed, at in zip((0.001, 0.1), rolls):
                    maker.trial("sleeping", {**axes, "scene": "sleep_roll", "speed": speed}, found, *outcome,
                                series={"awake": [float(at is None or step < at) for step in range(100)]}, **about)
        return fill

    def one(self, **about):
        found = [c for c in self.made(sleeping, self.scenes(**about)) if c.id == "sleeping_scenes_2d"]
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_results_of_each_policy(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "In 2D split_average lets a slow roller sleep sooner than millington at 1 of "
                                                "2 speeds, "
                         "later or never at 1 (2009 report, 6.5.1).")
        found = made.finding.table.set_index("policy")
        self.assertEqual(list(found.columns), ["5 boxes: steps until all wake", "touch at 0.05 m/s: boxes woken",
                                               "roller at 0.001 m/s: asleep from", "roller at 0.1 m/s: asleep from"])
        self.assertEqual([list(row) for row in found.to_numpy()],
                         [["no sleep", "0", "never", "never"], ["4", "0", "step 60", "step 68"], ["4", "0", "step 1", "never"],
                          ["0", "5", "step 29", "never"]])
        table = made.table.set_index(["scene", "boxes, or speed in m/s", "policy"])["result"]
        self.assertEqual(table["sleep_wave", 5, "none"], "no sleep")
        self.assertEqual(table["sleep_roll", 0.1, "split_average"], "never")

    def test_speeds_at_which_two_averages_help_are_counted(self):
        said = lambda single, split: sleep_scenes.rollers(  # noqa: E731
            [{"scene": "sleep_roll", "method": method, "at": at, "number": number} for method, numbers in
             (("millington", single), ("split_average", split)) for at, number in enumerate(numbers)], 2)
        self.assertIn(" at 2 of 2 speeds, later or never at 0 ", said((5, 6), (1, 2)))
        self.assertIn(" at 0 of 2 speeds, later or never at 2 ", said((5, 6), (7, 8)))
        self.assertIn(" at 0 of 2 speeds, later or never at 1 ", said((5, 6), (5, math.inf)))
        self.assertIn(" have no roller to compare.", said((), ()))

    def test_the_planted_bug_a_body_that_wakes_again_does_not_sleep(self):
        self.assertEqual(sleep_scenes.asleep_from([1, 1, 0, 1, 0, 0]), 4)
        self.assertIsNone(sleep_scenes.asleep_from([1, 0, 1]))
        self.assertEqual(sleep_scenes.asleep_from([0, 0]), 0)
        self.assertEqual([1, 1, 0, 1, 0, 0].index(0), 2, "the planted bug: the first step without an awake body")

    def test_failures_are_listed(self):
        made = self.one(outcomes={"timer_island": "exploded"})
        self.assertEqual(set(made.table[made.table["policy"] == "timer_island"]["result"]), {"exploded"})


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
