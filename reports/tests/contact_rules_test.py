# SPDX-License-Identifier: Zlib
"""Tests of the chart of contact generators' rules: what is told of times and of results, on runs that are known. Run by ctest, or
python3 reports/tests/contact_rules_test.py [PICTURE.png]."""

import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import ranking  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import contacts  # noqa: E402
from charts.contacts import contact_rules  # noqa: E402
from with_store import row  # noqa: E402

# Method: us of a step, points, then by seed: sag, drift, jitter
RULES = {"sat_clip+spread": (100.0, 40, (0.001, 0.0011), (0.02, 0.021), (1e-4, 2e-4)),
         "sat_clip+deepest": (100.5, 40, (0.003, 0.0033), (0.019, 0.022), (0.0, 0.0)),
         "query_clip+spread": (200.0, 44, (0.001, 0.0011), (0.05, 0.06), (1e-4, 2e-4)),
         "deepest_point": (50.0, 10, None, None, None)}


class Rules(with_store.WithStore):
    @staticmethod
    def stack(of=None, axis="contacts", report=("contact_rules",), scenes=("tower",)):
        def fill(maker):
            for name, unit in ((contacts.POINTS, "1"), ("sag_end", "m"), ("lateral_max", "m"), ("jitter", "m/s")):
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "world", name.replace("_", " "), unit, "invented", "detail", "less", ""))
            maker.sweep("mine", baseline="sat_clip+spread", **{axis: "label"}, **({"report": list(report)} if report else {}))
            for scene in scenes:
                for method, facts in (of or RULES).items():
                    for seed in range(1, 11):
                        one(maker, scene, axis, method, seed, *facts)

        def one(maker, scene, axis, method, seed, us, points, *bought):
            axes = {"kind": "world", "precision": "f64", "scene": scene, "dimension": 3, axis: method, "seed": seed}
            if bought[0] is None:
                maker.trial("mine", {**axes, "timed": False, "repeat": 0}, {}, "collapsed", "drift", 77)
                return
            facts = dict(zip(contacts.BOUGHT, (of_seeds[seed % 2] * (1 + seed / 1000) for of_seeds in bought)))
            maker.trial("mine", {**axes, "timed": False, "repeat": 0}, {"contacts_end": points, **facts})
            for repeat in range(4):
                maker.trial("mine", {**axes, "timed": True, "repeat": repeat},
                            {"ms_per_step_median": us / 1000 * (1 + 0.02 * (repeat % 2)), "contacts_end": points, **facts})
        return fill

    def one(self, **about):
        found = self.made(contact_rules, self.stack(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_the_sentence(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "tower, 3D: sag end with sat_clip+deepest is 3.0 times that with "
                                                "sat_clip+spread.")
        self.assertEqual(made.headline.text, made.finding.headline)
        against = lambda name: list(row(made, name).values())[1:]  # noqa: E731
        self.assertEqual(against("query_clip+spread"), ["ok", "2.0 times", "tie", "2.7 times", "tie"])
        self.assertEqual(against("sat_clip+deepest"), ["ok", "inside the noise", "3.0 times", "tie", "0"])
        self.assertEqual(against("deepest_point"), ["collapsed", "", "", "", ""])
        self.assertIn("deepest_point: collapsed at step 77 (drift)", made.holes)
        panels = made.figure.axes
        self.assertEqual([label.get_text() for label in panels[0].get_yticklabels()],
                         ["sat_clip+spread", "deepest_point", "query_clip+spread", "sat_clip+deepest"])

    def test_the_planted_bug_one_seed_alone_decides_nothing(self):
        of = {"sat_clip+spread": RULES["sat_clip+spread"],
              "sat_clip+area": (100.0, 40, (0.0030, 0.0005), (0.02, 0.021), (1e-4, 2e-4))}
        self.assertEqual(row(self.one(of=of), "sat_clip+area")["sag end, against sat_clip+spread"], "tie")
        with unittest.mock.patch.object(ranking, "better", lambda a, b, metric, many: True):
            self.assertEqual(row(self.one(of=of), "sat_clip+area")["sag end, against sat_clip+spread"], "1.7 times")

    def test_a_chart_for_each_scene_and_none_of_other_methods(self):
        self.assertEqual([c.id for c in self.made(contact_rules, self.stack(scenes=("pyramid", "tower")))],
                         ["mine_contact_rules_pyramid__3d", "mine_contact_rules_tower__3d"])
        self.assertEqual(self.made(contact_rules, self.stack(axis="resolver", report=())), [contact_rules.absent])
        self.assertEqual(self.made(contact_rules, synthetic_store.resolvers), [contact_rules.absent])

    def test_without_the_baseline_it_says_so(self):
        self.assertIn("has no result", self.one(of={m: RULES[m] for m in ("deepest_point", "sat_clip+deepest")}).finding.headline)


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
