# SPDX-License-Identifier: Zlib
"""Tests of waves, touches and slow rollers: runs whose answers are known. Run by ctest, or
python3 reports/tests/sleep_scenes_test.py [PICTURE.png]."""

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
                # Nothing that a chart of savings could be made of: of these runs another chart is tested.
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
    def test_what_each_policy_does(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding, "In 2D a sleeping stack of 5 boxes whose support goes is awake within 4 steps under "
                         "millington and split_average and 0 steps under timer_island; a touch at 0.05 m/s wakes 0 of a stack "
                         "under millington and split_average and 5 of a stack under timer_island; a roller of 0.001 m/s sleeps "
                         "from step 60 under millington, from step 1 under split_average and from step 29 under timer_island; a "
                         "roller of 0.1 m/s sleeps from step 68 under millington and never under split_average and timer_island. "
                         "That splitting the average lets slow rollers sleep sooner (6.5.1) does not hold everywhere: at 0.001 "
                         "m/s split_average sleeps sooner than millington and at 0.1 m/s split_average never sleeps, millington "
                         "does.")
        table = made.table.set_index(["scene", "boxes, or speed in m/s", "policy"])["told"]
        self.assertEqual(table["sleep_wave", 5, "none"], "no sleep")
        self.assertEqual(table["sleep_roll", 0.1, "split_average"], "never")

    def test_where_it_holds_and_where_not(self):
        said = lambda single, split: sleep_scenes.rollers(  # noqa: E731
            [{"scene": "sleep_roll", "method": method, "at": at, "number": number} for method, numbers in
             (("millington", single), ("split_average", split)) for at, number in enumerate(numbers)])
        self.assertIn(" holds: ", said((5, 6), (1, 2)))
        self.assertIn(" does not hold: ", said((5, 6), (7, 8)))
        self.assertIn(" does not hold: at 0 m/s split_average sleeps no sooner and at", said((5, 6), (5, 6)))
        self.assertEqual(said((), ()), "")

    def test_the_planted_bug_who_wakes_again_does_not_sleep(self):
        self.assertEqual(sleep_scenes.asleep_from([1, 1, 0, 1, 0, 0]), 4)
        self.assertIsNone(sleep_scenes.asleep_from([1, 0, 1]))
        self.assertEqual(sleep_scenes.asleep_from([0, 0]), 0)
        self.assertEqual([1, 1, 0, 1, 0, 0].index(0), 2, "as the first step without anybody awake would have it")

    def test_what_failed_is_told(self):
        made = self.one(outcomes={"timer_island": "exploded"})
        self.assertEqual(set(made.table[made.table["policy"] == "timer_island"]["told"]), {"exploded"})


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
