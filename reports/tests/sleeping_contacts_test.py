# SPDX-License-Identifier: Zlib
"""Tests of the chart of kept and renewed contacts of sleeping bodies: queries and time saved, and what changes. Run by ctest, or
python3 reports/tests/sleeping_contacts_test.py."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import sleeping  # noqa: E402

# policy: pair queries and ms with contacts kept and renewed, distance of the second body's ends, steps of the wave with each
POLICIES = {"none": (100, 100, 1.0, 1.0, 0.0, (0, 0)), "quick": (20, 100, 0.2, 0.8, 0.0, (3, 3)),
            "slow": (50, 100, 0.5, 0.8, 0.002, (3, 5))}


class SleepingContacts(with_store.WithStore):
    @staticmethod
    def stack(policies=None, fails=(), repeats=4, values=(0, 1), ends=600):
        def fill(maker):
            for name in ("work_pair_queries", "work_box_tests", "woken", "wake_steps"):
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "world", name, "1", name, "detail", "", ""))
            maker.sweep("mine", baseline="none", policy="label", sleeping_contacts="parameter")
            for name, (kept, anew, ms, ms_anew, off, late) in (policies or POLICIES).items():
                for value in values:
                    outcome = "exploded" if (name, value) in fails else "ok"
                    axes = {"kind": "world", "scene": "stack", "dimension": 2, "precision": "f64", "policy": name,
                            "sleeping_contacts": value}
                    found = {"work_pair_queries": (kept, anew)[value], "woken": 4, "wake_steps": late[value]}
                    bits = f"{name} {value if off else 0}"
                    key = maker.trial("mine", {**axes, "timed": False, "repeat": 0}, found, outcome, hash=bits)
                    maker.poses(key, 0, [[slot, 9.0 + value, 9.0, 0.0] for slot in range(3)])
                    last = ends if value else 600
                    maker.poses(key, last, [[slot, slot + off * value * (slot == 1), 1.0, 0.0] for slot in range(3)])
                    for repeat in range(repeats):
                        time = {"ms_per_step_median": (ms, ms_anew)[value] * (1 + 0.01 * (repeat % 2))}
                        maker.trial("mine", {**axes, "timed": True, "repeat": repeat}, {**found, **time}, outcome, hash=bits)
        return fill

    @undrawn.drawn
    def test_savings_and_changes(self):
        made = self.made(sleeping.sleeping_contacts, self.stack())
        self.assertEqual(len(made), 1)
        self.assertEqual(made[0].finding.headline, "Keeping contacts of sleeping bodies saves up to 80 % of the pair queries "
                                                   "(quick on "
                         "stack); 1 of 2 runs end in the same bits.")
        found = made[0].finding.table.set_index("policy")
        self.assertEqual(list(found.index), ["quick", "slow"])
        self.assertEqual(list(found["time of a step, renewed over kept"]), [4.0, 1.6])
        self.assertEqual(list(found["same bits"]), ["yes", "no"])
        self.assertAlmostEqual(found.at["slow", "largest distance of the ends [m]"], 0.002)
        self.assertEqual(list(found["wakes"]), ["the same", "not the same"])
        table = made[0].table.set_index("policy")
        self.assertEqual(list(table.index), ["quick", "slow"])
        self.assertAlmostEqual(table.at["quick", "pair queries saved [1]"], 0.8)
        self.assertAlmostEqual(table.at["slow", "largest distance of the ends [m]"], 0.002)
        self.assertAlmostEqual(table.at["slow", "from the end without sleep, renewed [m]"], 0.002)
        self.assertAlmostEqual(table.at["slow", "from the end without sleep, kept [m]"], 0)
        self.assertAlmostEqual(table.at["slow", "time per step, renewed [s]"], 0.000804)
        self.assertEqual(list(table["same bits"]), ["yes", "no"])
        self.assertEqual(len(made[0].figure.axes), 3)
        self.assertEqual(made[0].headline.text, "On stack a step of quick takes 4.0 times as long where contacts of sleeping "
                                                "bodies are "
                         "renewed; the final state is the same.")

    def test_the_planted_bug_that_the_first_poses_are_compared_would_be_seen(self):
        made, = self.made(sleeping.sleeping_contacts, self.stack())
        self.assertAlmostEqual(made.table["largest distance of the ends [m]"].max(), 0.002)

    @undrawn.drawn
    def test_times_inside_the_noise_are_no_headline(self):
        same = {name: (kept, anew, 1.0, 1.001, 0.0, (3, 3)) for name, (kept, anew, *_) in POLICIES.items()}
        made = self.made(sleeping.sleeping_contacts, self.stack(same))[0]
        self.assertEqual(list(made.finding.table["time of a step, renewed over kept"]), ["tie: inside the noise"] * 2)
        self.assertEqual(list(made.finding.table["same bits"]), ["yes", "yes"])
        self.assertEqual(list(made.finding.table["wakes"]), ["the same", "the same"])
        self.assertTrue(made.finding.headline.endswith("2 of 2 runs end in the same bits."), made.finding.headline)
        self.assertIsNone(made.headline)
        self.assertEqual(len(made.figure.axes), 2, "no panel of zeros")

    def test_too_few_repeats_are_a_tie(self):
        slight = {name: (kept, anew, 1.0, 1.3, 0.0, (3, 3)) for name, (kept, anew, *_) in POLICIES.items()}
        found = self.made(sleeping.sleeping_contacts, self.stack(slight, repeats=2))[0].finding.table
        self.assertEqual(list(found["time of a step, renewed over kept"]), ["tie: too few repeats"] * 2)

    def test_failures_are_listed(self):
        made = self.made(sleeping.sleeping_contacts, self.stack(fails=[("slow", 1)]))[0]
        self.assertEqual(list(made.finding.table["outcome"]), ["ok", "failed: renewed: exploded"])
        self.assertTrue(made.table.set_index("policy")["largest distance of the ends [m]"].isna()["slow"])
        made = self.made(sleeping.sleeping_contacts, self.stack(fails=[("slow", 1), ("quick", 0)]))[0]
        self.assertTrue(made.finding.headline.startswith("No policy that lets bodies sleep finishes"), made.finding.headline)

    def test_runs_that_end_elsewhere_in_time_have_no_distance(self):
        made = self.made(sleeping.sleeping_contacts, self.stack(ends=500))[0]
        self.assertTrue(made.table["largest distance of the ends [m]"].isna().all())

    def test_without_sleeping_bodies_nothing_is_ranked(self):
        awake = {name: (100, 100, 1.0, 1.0, 0.0, (0, 0)) for name in POLICIES}
        made = self.made(sleeping.sleeping_contacts, self.stack(awake))[0]
        self.assertEqual(made.finding.headline, "No body falls asleep in the sweep of kept and renewed contacts of sleeping "
                                                "bodies.")

    def test_a_sweep_without_the_switch_has_no_chart(self):
        self.assertEqual(self.made(sleeping.sleeping_contacts, self.stack(values=(0,))), [sleeping.sleeping_contacts.absent])


if __name__ == "__main__":
    unittest.main()
