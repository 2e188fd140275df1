# SPDX-License-Identifier: Zlib
"""Tests of the chart of momenta: who keeps them, by how much others do not, and who says so. Run by ctest, or
python3 reports/tests/momenta_test.py."""

import json
import math
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import conserved  # noqa: E402
from charts.conserved import momenta  # noqa: E402
from with_store import row  # noqa: E402

# (of p, of L) that a method changes; p is 50 kg m/s and L 5 kg m^2/s.
CHANGED = {"catto": (0.0, 1e-15), "naive": (1e-16, 0.0), "soft_step": (2e-14, 0.25), "avbd": (0.03, 0.05)}
DECLARED = {"soft_step": ["Solver.TurningKeepsAngularMomentum", "Symmetry.HeavyIsFixed"],
            "avbd": ["Solver.KeepsLinearMomentum", "Solver.KeepsAngularMomentum"]}
KEPT = "2 of 4 methods keep both momenta of free bodies to rounding"


class Momenta(with_store.WithStore):
    @staticmethod
    def free(changed=None, declared=None, fell=(), momentum=50, precision="f64"):
        """`fell`: methods whose runs explode; `momentum`: what the scene says it has."""
        def fill(maker):
            maker.sweep("mine", resolver="label")
            entries = [{"stage": "solver", "group": "solver", "name": name, "role": "competitor",
                        "failures": [{"when": "two that turn", "symptom": "s", "test": test} for test in
                                     (DECLARED if declared is None else declared).get(name, ())]} for name in CHANGED]
            maker.db.execute("UPDATE meta SET value=? WHERE key='registry'", (json.dumps({"algorithms": entries}),))
            for name, (p, angular) in (changed or CHANGED).items():
                maker.trial("mine", {"kind": "world", "precision": precision, "scene": "pair", "dimension": 2, "resolver": name},
                            {"momentum_error": 50 * p, "angular_momentum_error": 5 * angular},
                            *(("exploded", "speed", 7) if name in fell else ()),
                            extra={"pipeline": f"solver={name}", "params": {"momentum": momentum, "angular_momentum": 5}})
        return fill

    def test_who_changes_momenta_by_how_much_and_who_declares_it(self):
        made = self.made(momenta, self.free())
        self.assertEqual(len(made), 1)
        self.assertEqual(made[0].finding.headline, f"In 2D {KEPT}; soft_step changes angular momentum most (25 %).")
        self.assertEqual(made[0].headline.text, made[0].finding.headline)
        self.assertEqual(list(row(made[0], "soft_step").values())[:3], ["soft_step", "0.25", "+0.25"])
        self.assertEqual((row(made[0], "avbd")["linear momentum"], row(made[0], "avbd")["declared"]), ("0.03", "yes"))
        self.assertEqual(row(made[0], "2 methods")["methods"], "catto and naive")
        self.assertEqual(made[0].headline.values["catto"], 0)
        table = made[0].table.set_index("method")
        self.assertAlmostEqual(table.at["avbd", "relative change of momentum [1]"], 0.03)
        self.assertEqual(list(table["declares a change of linear momentum"]), [m == "avbd" for m in table.index])

    def test_who_changes_about_as_much_as_the_worst_is_named_beside_it(self):
        many = {**CHANGED, "avbd": (0.03, 0.68), "soft_step": (0.0, 0.45)}
        made = self.made(momenta, self.free(many))[0]
        self.assertIn("avbd and soft_step change angular momentum most (68 %).", made.headline.text)
        self.assertEqual(row(made, "soft_step")["change of angular momentum"], "0.45")
        with unittest.mock.patch.object(conserved, "ALIKE", 1.0):
            self.assertNotIn("soft_step", self.made(momenta, self.free(many))[0].headline.text, "the planted bug was not seen")

    @undrawn.drawn
    def test_rings_are_around_what_is_declared(self):
        made = self.made(momenta, self.free())[0]
        rings = [sum(line.get_markerfacecolor() == "none" for line in ax.get_lines()) for ax in made.figure.axes]
        self.assertEqual(rings, [1, 2], "avbd; soft_step and avbd")

    def test_the_planted_bug_a_method_that_is_silent_is_seen(self):
        said = {**DECLARED, "soft_step": ["Symmetry.HeavyIsFixed"]}
        made = self.made(momenta, self.free(declared=said))[0]
        self.assertEqual(row(made, "soft_step")["declared"], "not angular")
        self.assertEqual(row(made, "avbd")["declared"], "yes")

    def test_a_declaration_of_one_choice_is_that_of_no_other(self):
        context = self.context(self.free())
        key = context.store.trials.index[2]
        self.assertIn("Symmetry.HeavyIsFixed", context.store.declared(key))
        failures = next(e for e in context.store.algorithms if e["name"] == "soft_step")["failures"]
        failures[0]["when"] = "arms=as_made: two that turn"
        self.assertEqual(context.store.declared(key), {"Symmetry.HeavyIsFixed"})
        context.store.trials.at[key, "canonical"]["pipeline"] = "solver=soft_step{arms=as_made}"
        self.assertIn("Solver.TurningKeepsAngularMomentum", context.store.declared(key))

    def test_a_declaration_in_space_is_none_in_the_plane(self):
        context = self.context(self.free())
        key = context.store.trials.index[2]
        failures = next(e for e in context.store.algorithms if e["name"] == "soft_step")["failures"]
        for failure in failures:
            failure["dimensions"] = [3]
        self.assertEqual(context.store.declared(key), set())
        failures[0]["dimensions"] = [2, 3]
        self.assertEqual(context.store.declared(key), {failures[0]["test"]})

    def test_what_failed_has_no_momentum_and_is_told(self):
        made = self.made(momenta, self.free(fell=("avbd",)))[0]
        self.assertEqual(row(made, "avbd")["against the best"], "failed: exploded")
        self.assertEqual(row(made, "soft_step")["linear momentum"], "0")
        self.assertNotIn("avbd", made.headline.values)
        self.assertIn("exploded at step 7", made.holes[0])

    def test_rounding_is_that_of_the_arithmetic(self):
        small = {"catto": (0.0, 1e-6), "naive": (0.0, 1e-7), "soft_step": (0.0, 0.25), "avbd": (0.03, 0.05)}
        self.assertIn("0 of 4 methods", self.made(momenta, self.free({m: (p, max(v, 1e-6)) for m, (p, v) in small.items()}))[0]
                      .finding.headline)
        made = self.made(momenta, self.free(small, precision="f32"))[0]
        self.assertIn("2 of 4 methods keep both momenta of free bodies to rounding", made.finding.headline)
        self.assertIn("up to 0.0001 is rounding", made.note)

    def test_where_all_keep_them_nothing_is_ranked_and_without_a_total_there_is_no_chart(self):
        made = self.made(momenta, self.free(dict.fromkeys(CHANGED, (0.0, 0.0))))[0]
        self.assertEqual(made.finding.headline, "In 2D 4 of 4 methods keep both momenta of free bodies to rounding.")
        self.assertEqual(len(made.finding.table), 1)
        self.assertIsNone(made.headline)
        self.assertEqual(self.made(momenta, self.free(momentum=0)), [momenta.absent])
        self.assertTrue(math.isnan(self.context(self.free(momentum=0)).cells("mine", conserved.SHARES)["momentum_share"].iloc[0]))


if __name__ == "__main__":
    unittest.main()
