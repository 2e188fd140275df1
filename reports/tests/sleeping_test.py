# SPDX-License-Identifier: Zlib
"""Tests of the chart of sleeping: savings, distances from the run without sleep, and steps until bodies wake. Run by ctest, or
python3 reports/tests/sleeping_test.py."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import sleeping  # noqa: E402

# policy: multiply-adds, bodies awake, woken, steps until all are awake, distance of its second body from the baseline's end
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
        self.assertEqual(made[0].finding.headline, "On stack, 2D slow saves most, 80 % of the multiply-adds; it moves bodies "
                                                   "by up to "
                         "30 mm.")
        found = made[0].finding.table.set_index("policy")
        self.assertEqual(list(found.index), ["slow", "quick"])
        self.assertEqual(found.at["quick", "outcome"], "all bodies end in place")
        self.assertEqual(found["steps until all are awake [1]"].to_dict(), {"slow": 4, "quick": 0})
        self.assertAlmostEqual(found.at["slow", "largest distance from the end without sleep [m]"], 0.03)
        table = made[0].table.set_index("policy")
        self.assertAlmostEqual(table.at["quick", "multiply-adds saved [1]"], 0.6)
        self.assertAlmostEqual(table.at["slow", "largest distance from the end without sleep [m]"], 0.03)
        self.assertAlmostEqual(table.at["slow", "median over bodies [m]"], 0)
        self.assertEqual(len(made[0].figure.axes), 2)
        self.assertIn("; slow saves 80 % and moves them 30 mm.", made[0].headline.text)

    @undrawn.drawn
    def test_a_timed_sweep_has_time_saved_and_the_count(self):
        times = {"none": (10, 10, 10), "quick": (6, 6, 6), "slow": (2, 3, 9)}
        made = self.made(sleeping.sleeping, self.stack(times=times))[0]
        self.assertIn("slow saves most, 80 % of the multiply-adds and 70 % of the time;", made.finding.headline)
        self.assertEqual(made.finding.table.set_index("policy").at["slow", "range of repeats"], "0.1 to 0.8")
        self.assertEqual({ax.get_xlabel() for ax in made.figure.axes}, {"time saved (%)"})
        table = made.table.set_index("policy")
        self.assertAlmostEqual(table.at["slow", "time saved [1]"], 0.7)
        self.assertAlmostEqual(table.at["slow", "multiply-adds saved [1]"], 0.8)
        untimed = self.made(sleeping.sleeping, self.stack(times={"none": (10,), "quick": (6,)}))[0]
        self.assertEqual({ax.get_xlabel() for ax in untimed.figure.axes}, {"multiply-adds saved (%)"})
        self.assertNotIn("of the time", untimed.finding.headline)

    def test_equal_savings_tie(self):
        made = self.made(sleeping.sleeping, self.stack({**POLICIES, "quick": (20, 1, 5, 0, 0.01)}))[0]
        self.assertEqual(made.finding.headline, "On stack, 2D quick and slow save most, 80 % of the multiply-adds; they move "
                                                "bodies by "
                         "up to 30 mm.")
        self.assertEqual(list(made.finding.table["outcome"]), ["tie with the best"] * 2)

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

    def test_a_failed_policy_saves_nothing_and_is_listed(self):
        made = self.made(sleeping.sleeping, self.stack(outcomes={"slow": "exploded"}))[0]
        self.assertTrue(made.finding.headline.startswith("On stack, 2D quick saves most, 60 %"), made.finding.headline)
        self.assertEqual(made.finding.table.set_index("policy").at["slow", "outcome"], "failed: exploded")
        self.assertIsNone(made.headline)

    def test_without_sleeping_bodies_nothing_is_ranked(self):
        made = self.made(sleeping.sleeping, self.stack({name: (100, 5, 0, 0, 0.0) for name in POLICIES}))[0]
        self.assertEqual(made.finding.headline, "On stack, 2D no body falls asleep.")
        self.assertIsNone(made.headline)

    def test_a_sweep_of_something_else_has_no_chart(self):
        context = self.context(self.stack())
        for key in context.store.trials.index:
            context.store.trials.at[key, "canonical"]["pipeline"] = "sleep=none"
        self.assertEqual(sleeping.sleeping.make(context, context.cells("mine")), [])

    def test_a_baseline_with_sleeping_bodies_makes_no_chart(self):
        for fill in (self.stack(baseline="quick"), self.stack(baseline="none", outcomes={"none": "exploded"})):
            self.assertEqual(self.made(sleeping.sleeping, fill), [sleeping.sleeping.absent])


if __name__ == "__main__":
    unittest.main()
