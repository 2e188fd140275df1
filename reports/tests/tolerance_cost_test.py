# SPDX-License-Identifier: Zlib
"""Tests of the chart of time over a tolerance: how a label is read, and savings beyond the noise. Run by ctest, or python3
reports/tests/tolerance_cost_test.py [PICTURE.png]."""

import math
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import coverage  # noqa: E402
import load  # noqa: E402
import noise  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import tolerances  # noqa: E402
from charts.tolerances import tolerance_cost  # noqa: E402

LOOSE = (0, 1e-9, 1e-6, 1e-3)


class Tolerance(with_store.WithStore):
    @staticmethod
    def loosened(gain=0.5, noisy=0.01, values=LOOSE, dimensions=(3,), kinds=(("box", "box"), ("box", "sphere"))):
        """A curve of gjk_epa that falls to `gain` of its time at the loosest; one value of mpr, which is no curve."""
        def fill(maker):
            maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                             ("metric", "support_calls", "pairs", "support points", "1", "invented", "detail", "cheaper", ""))
            maker.sweep("tolerance_cost", "pairs", pair_query="stage", report=["tolerance_cost"])
            for dimension in dimensions:
                for a, b in kinds:
                    for i, tolerance in enumerate(values):
                        share = i / max(1, len(values) - 1)
                        one(maker, dimension, a, b, f"gjk_epa{{faces=64,tolerance={tolerance:g}}}", 400 * gain**share,
                            20 - 5 * share, max(tolerance / 3, 1e-16))
                    one(maker, dimension, a, b, "mpr{tolerance=0}", 300, 10, 0.1)

        def one(maker, dimension, a, b, method, ns, calls, error):
            axes = {"kind": "pairs", "dimension": dimension, "pair_query": method, "kind_a": a, "kind_b": b, "precision": "f64",
                    "timed": True}
            for repeat in range(4):
                maker.trial("tolerance_cost", {**axes, "repeat": repeat},
                            {"ns_per_query": ns * (1 + noisy * (repeat % 2)), "max_error": error, "median_error": error / 9,
                             "support_calls": calls, "wrong_boolean": 3.0, "side_alone": 0.0, "wrong": 9.0},
                            *(("wrong", "9 wrong answers") if error > 1e-12 else ("ok",)), extra={"pair_query": method})
        return fill

    def one(self, **about):
        found = self.made(tolerance_cost, self.loosened(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_headline_and_numbers(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.headline.text, "On box–box in 3D a tolerance of 0.001 saves gjk_epa{faces=64} 50 % of its time; "
                                             "its "
                         "worst error is 0.00033 of the size instead of 1e-16.")
        self.assertEqual(made.finding.headline, made.headline.text)
        self.assertEqual(made.finding.table.to_numpy().tolist(), [
            ["gjk_epa{faces=64}", pair, "0 to 0.001", 0.5, "20 to 15", "1e-16 to 0.00033"] for pair in ("box–box", "box–sphere")])
        self.assertEqual(list(made.table["tolerance [1]"][:4]), list(LOOSE))
        self.assertNotIn("mpr", " ".join(made.table["method"]), "one value is no curve")

    def test_an_answer_inside_the_asked_tolerance_is_not_wrong(self):
        made = self.one()
        self.assertEqual(set(made.table["outcome"]), {"ok"})
        context = self.context(self.loosened())
        bad = coverage.not_ok(coverage.trials(context.store))
        self.assertEqual(len(bad), 2, "of two pairs of kinds")
        self.assertTrue(bad["cell"].str.contains("mpr").all(), "whose error is 0.1 at a tolerance of 0")
        self.assertEqual(set(bad["reason"]), {"9 wrong answers"})
        with unittest.mock.patch.object(load, "within_asked", lambda metrics, asked: False):
            self.assertEqual(set(self.one().table["outcome"]), {"ok", "wrong"}, "the planted bug was not seen")
            context = self.context(self.loosened())
            bad = coverage.not_ok(coverage.trials(context.store))
        self.assertIn("9 wrong answers, asked to 0.001 of the size", set(bad["reason"]))

    def test_a_tolerance_is_read_and_judged(self):
        asked = lambda query, precision="f64": load.loosened({"pair_query": query, "precision": precision})  # noqa: E731
        self.assertEqual(asked("gjk_epa{gap=best,tolerance=0,depth_tolerance=0.01,faces=9}"), 0.01)
        self.assertIsNone(asked("gjk_epa{tolerance=1e-13}"))
        self.assertIsNone(asked("gjk_epa{tolerance=1e-6}", "f32"))
        self.assertIsNone(asked("sat"))
        self.assertTrue(load.within_asked({"max_error": 1e-3, "wrong_boolean": 4, "side_alone": 0}, 1e-2))
        self.assertFalse(load.within_asked({"max_error": 1e-3, "wrong_boolean": 4, "side_alone": 9}, 1e-2), "no value")
        self.assertFalse(load.within_asked({"max_error": 2e-2}, 1e-2))
        self.assertFalse(load.within_asked({}, 1e-2))

    def test_the_planted_bug_a_difference_inside_the_noise_saves_nothing(self):
        about = {"gain": 0.9, "noisy": 0.3}
        found = self.one(**about).finding
        self.assertEqual(found.headline, "In 3D a looser tolerance saves no time beyond the noise.")
        self.assertEqual(list(found.table["time, loosest over tightest"]), ["tie: inside the noise"] * 2)
        self.assertIsNone(self.one(**about).headline)
        real, noise.tells = noise.tells, lambda a, b, metric, least: True
        try:
            self.assertIn("saves gjk_epa", self.one(**about).headline.text)
        finally:
            noise.tells = real

    def test_a_label_is_read(self):
        self.assertEqual(tolerances.parted("gjk_epa{tolerance=1e-06}"), ("gjk_epa", 1e-6))
        self.assertEqual(tolerances.parted("gjk_epa{tolerance=0,faces=9}"), ("gjk_epa{faces=9}", 0.0))
        self.assertEqual(tolerances.parted("gjk_epa{faces=9,tolerance=0.5}"), ("gjk_epa{faces=9}", 0.5))
        self.assertTrue(math.isnan(tolerances.parted("sat")[1]))

    def test_no_chart_without_a_curve(self):
        asked = self.made(tolerance_cost, self.loosened(values=(0, 1e-3)))
        self.assertEqual(asked[0].finding.headline, "The `report` of tolerance_cost lists this chart, but the sweep lacks its "
                                                    "data.")
        self.assertEqual(asked[0].holes, ["The chart needs a method with 3 values of its tolerance."])
        self.assertEqual(self.made(tolerance_cost, synthetic_store.queries), [tolerance_cost.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
