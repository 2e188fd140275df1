# SPDX-License-Identifier: Zlib
"""Tests of the chart of sleeping: what is saved, how far bodies end from where they would, and how late they wake. Run by ctest,
or python3 reports/tests/sleeping_test.py."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import sleeping  # noqa: E402

# policy: multiply-adds, bodies awake, woken, steps until all are, and how far its second body ends from the baseline's
POLICIES = {"none": (100, 5, 0, 0, 0.0), "quick": (40, 2, 5, 0, 0.0), "slow": (20, 1, 5, 4, 0.03)}


class Sleeping(with_store.WithStore):
    @staticmethod
    def stack(policies=None, baseline="none", outcomes=None, ends=600, bodies=3, times=None):
        def fill(maker):
            for name in ("awake_mean", "woken", "wake_steps"):
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "world", name, "1", name, "detail", "", ""))
            maker.sweep("mine", baseline=baseline, policy="label")
            for name, (work, awake, woken, steps, off) in (policies or POLICIES).items():
                outcome = (outcomes or {}).get(name, "ok")
                axes = {"kind": "world", "scene": "stack", "dimension": 2, "precision": "f64", "policy": name}
                found = {"work_multiply_adds": work, "awake_mean": awake, "woken": woken, "wake_steps": steps}
                key = maker.trial("mine", axes, found, outcome, "", None if outcome == "ok" else 7,
                                  extra={"pipeline": f"sleep={name}"})
                last = ends if name != "slow" else 600
                maker.poses(key, 0, [[slot, 9.0, 9.0, 0.0] for slot in range(3)])
                for repeat, of in enumerate((times or {}).get(name, ())):
                    maker.trial("mine", {**axes, "timed": True, "repeat": repeat}, {"ms_per_step_median": of}, outcome,
                                series={"seconds": [of * 0.5e-3, of * 1.5e-3]}, extra={"pipeline": f"sleep={name}"})
                there = range(bodies if name == "slow" else 3)
                maker.poses(key, last, [[slot, slot + off * (slot == 1), 1.0, 0.0] for slot in there])
        return fill

    @undrawn.drawn
    def test_savings_distances_and_the_wave(self):
        made = self.made(sleeping.sleeping, self.stack())
        self.assertEqual(len(made), 1)
        self.assertEqual(made[0].finding, "On stack, 2D slow saves most, 80 % of the multiply-adds; its bodies end at most 30 mm "
                         "from where they end awake; quick moves no body; those that wake do so within 0 steps by quick and 4 by "
                         "slow.")
        table = made[0].table.set_index("policy")
        self.assertAlmostEqual(table.at["quick", "multiply-adds saved [1]"], 0.6)
        self.assertAlmostEqual(table.at["slow", "largest distance from the end without sleep [m]"], 0.03)
        self.assertAlmostEqual(table.at["slow", "median over bodies [m]"], 0)
        self.assertEqual(len(made[0].figure.axes), 2)
        self.assertIn("by slow 80 % and 30 mm", made[0].headline.text)

    @undrawn.drawn
    def test_time_saved_where_it_was_timed_with_the_count_beside_it(self):
        times = {"none": (10, 10, 10), "quick": (6, 6, 6), "slow": (2, 3, 9)}
        made = self.made(sleeping.sleeping, self.stack(times=times))[0]
        self.assertIn("slow saves most, 80 % of the multiply-adds and 70 % of the time, 10 to 80 over 3 repeats", made.finding)
        self.assertEqual({ax.get_xlabel() for ax in made.figure.axes}, {"time saved (%)"})
        table = made.table.set_index("policy")
        self.assertAlmostEqual(table.at["slow", "time saved [1]"], 0.7)
        self.assertAlmostEqual(table.at["slow", "multiply-adds saved [1]"], 0.8)
        untimed = self.made(sleeping.sleeping, self.stack(times={"none": (10,), "quick": (6,)}))[0]
        self.assertEqual({ax.get_xlabel() for ax in untimed.figure.axes}, {"multiply-adds saved (%)"})
        self.assertNotIn("of the time", untimed.finding)

    @undrawn.drawn
    def test_no_mark_is_cut_by_the_frame(self):
        low, high = self.made(sleeping.sleeping, self.stack())[0].figure.axes[1].get_ylim()
        self.assertTrue(low < 0 and high > 4, (low, high))

    def test_the_planted_bug_that_the_first_poses_are_compared_would_be_seen(self):
        context = self.context(self.stack())
        keys = list(context.store.trials.index)
        ends = [sleeping.at_the_end(context, key, 2) for key in keys]
        self.assertEqual([last for _, last in ends], [600] * 3)
        self.assertAlmostEqual(sleeping.distances(ends[2][0], ends[0][0])[0], 0.03)

    def test_runs_that_end_elsewhere_or_with_other_bodies_have_no_distance(self):
        for fill in (self.stack(ends=500), self.stack(bodies=2)):
            made = self.made(sleeping.sleeping, fill)[0]
            self.assertTrue(made.table.set_index("policy")["largest distance from the end without sleep [m]"].isna()["slow"])

    def test_what_failed_saves_nothing_and_is_told(self):
        made = self.made(sleeping.sleeping, self.stack(outcomes={"slow": "exploded"}))[0]
        self.assertTrue(made.finding.startswith("On stack, 2D quick saves most, 60 %"), made.finding)
        self.assertTrue(made.finding.endswith("slow fails."), made.finding)
        self.assertIsNone(made.headline)

    def test_where_nobody_sleeps_nothing_is_ranked(self):
        made = self.made(sleeping.sleeping, self.stack({name: (100, 5, 0, 0, 0.0) for name in POLICIES}))[0]
        self.assertEqual(made.finding, "On stack, 2D no body falls asleep.")
        self.assertIsNone(made.headline)

    def test_a_sweep_of_something_else_has_no_chart(self):
        context = self.context(self.stack())
        for key in context.store.trials.index:
            context.store.trials.at[key, "canonical"]["pipeline"] = "sleep=none"
        self.assertEqual(sleeping.sleeping.make(context, context.cells("mine")), [])

    def test_a_baseline_that_sleeps_is_none(self):
        for fill in (self.stack(baseline="quick"), self.stack(baseline="none", outcomes={"none": "exploded"})):
            self.assertEqual(self.made(sleeping.sleeping, fill), [sleeping.sleeping.absent])


if __name__ == "__main__":
    unittest.main()
