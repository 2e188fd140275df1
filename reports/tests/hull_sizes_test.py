# SPDX-License-Identifier: Zlib
"""Tests of the chart over the vertices of hulls: known exponents, and no verdict inside the noise. Run by ctest, or python3
reports/tests/hull_sizes_test.py [PICTURE.png]."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402

import noise  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import pair_times  # noqa: E402
from charts.pair_times import hull_sizes  # noqa: E402

SIZES = (8, 16, 32, 64, 128, 256)
# Method: ns a query, support points, axis tests, of V vertices of each hull.
METHODS = {"gjk_epa": (lambda v: 300 + 0.5 * v, lambda v: 12 + math.log2(v), lambda v: 0),
           "sat": (lambda v: 0.2 * v**2, lambda v: 0, lambda v: v**2 / 4),
           "closed_form": (lambda v: 10.0 * v, lambda v: 0, lambda v: 0),
           "fcl": (lambda v: 900 + 8.0 * v, None, None)}


class Hulls(with_store.WithStore):
    @staticmethod
    def sizes(of=None, repeats=4, noisy=0.01, drawings=("apart",), hung=(), dimensions=(3,), counted=True):
        def fill(maker):
            for name in pair_times.WORK if counted else ():
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "pairs", name.replace("_", " "), "1", "invented", "detail", "cheaper", ""))
            maker.sweep("hull_sizes", "pairs", pair_query="stage", report=["hull_sizes"])
            for dimension in dimensions:
                for drawing in drawings:
                    for method, costs in (of or METHODS).items():
                        for v in SIZES:
                            one(maker, dimension, drawing, method, v, costs)

        def one(maker, dimension, drawing, method, v, costs):
            axes = {"kind": "pairs", "dimension": dimension, "pair_query": method, "kind_a": "polytope", "kind_b": "polytope",
                    "precision": "f64", "timed": True, "drawing": drawing, "vertices": v}
            work = dict(zip(pair_times.WORK, (math.nan if cost is None else cost(v) for cost in (*costs[1:], lambda v: 0))))
            for repeat in range(repeats):
                outcome = ("timeout", "too long", 0) if (method, v) in hung else ("ok",)
                facts = {"ns_single": costs[0](v) * (1 + noisy * (repeat % 2)), "max_error": 1e-15,
                         **(work if counted else {})}
                maker.trial("hull_sizes", {**axes, "repeat": repeat}, {} if outcome != ("ok",) else facts, *outcome)
        return fill

    def one(self, **about):
        found = self.made(hull_sizes, self.sizes(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_exponents_and_verdicts(self):
        made = self.one(drawings=("apart", "overlapping"))
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "In 3D time grows at most linearly in the vertices with gjk_epa, faster with sat "
                         "(2009 claim: O(E + V)).")
        found = made.finding.table.set_index("method")
        self.assertEqual(list(found["exponent, apart"]), ["0.09 ± 0.05", "0.32 ± 0.14", "1.00 ± 0.00", "2.00 ± 0.00"])
        self.assertEqual(list(found.index), ["gjk_epa", "fcl (witness)", "closed_form", "sat"])
        self.assertAlmostEqual(found.at["gjk_epa", "larger half, apart [1]"], 0.15, places=2)
        self.assertAlmostEqual(found.at["sat", "larger half, apart [1]"], 2.0, places=2)
        self.assertEqual(list(found["verdict, overlapping"]),
                         ["at most linear", "at most linear", "inside the noise of linear", "steeper than linear"])
        self.assertIn("(8 to 256 vertices)", made.note)
        exponents = made.table.drop_duplicates(["drawing", "method"]).set_index(["drawing", "method"])
        for drawing in ("apart", "overlapping"):
            self.assertAlmostEqual(exponents.at[(drawing, "gjk_epa"), "exponent of support calls [1]"], 0.08, places=2)
            self.assertAlmostEqual(exponents.at[(drawing, "sat"), "exponent of axis tests [1]"], 2.0)
        # A method has no line for work that it does not count.
        panels = made.figure.axes
        self.assertEqual([ax.get_title("left") for ax in panels], ["time of a single query", "support calls", "axis tests"] * 2)
        drawn = lambda ax: sum(len(line.get_xdata()) == len(SIZES) for line in ax.lines)  # noqa: E731
        self.assertEqual([drawn(ax) for ax in panels[:3]], [4, 1, 1])
        row = made.table[(made.table["method"] == "sat") & (made.table["vertices"] == 8)].iloc[0]
        self.assertAlmostEqual(row["exponent of axis tests [1]"], 2.0)
        self.assertAlmostEqual(row["axis tests [1]"], 16.0)

    def test_the_planted_bug_noise_makes_no_verdict(self):
        made = self.one(of={"sat": (lambda v: v**1.1, *METHODS["sat"][1:])}, noisy=0.6)
        self.assertEqual(list(made.finding.table["verdict, apart"]), ["inside the noise of linear"])
        real, pair_times.last_step = pair_times.last_step, lambda n, values, least: (1.1, 1.1)  # as if the noise were none
        try:
            bad = self.one(of={"sat": (lambda v: v**1.1, *METHODS["sat"][1:])}, noisy=0.6)
            self.assertEqual(list(bad.finding.table["verdict, apart"]), ["steeper than linear"])
        finally:
            pair_times.last_step = real

    def test_a_fit_is_that_of_the_power(self):
        n = np.array(SIZES, float)
        self.assertAlmostEqual(pair_times.exponent(n, 3 * n**1.5)[0], 1.5)
        self.assertTrue(math.isnan(pair_times.exponent(n, np.where(n > 32, math.nan, n))[0]), "three sizes are too few")
        slope, half = pair_times.exponent(n, n * np.array([1, 2, 1, 2, 1, 2]))
        self.assertGreater(half, abs(slope - 1), "the interval holds the power under the noise")

    @undrawn.drawn
    def test_a_failure_is_listed_and_has_no_time(self):
        made = self.one(hung=(("fcl", 256),))
        self.assertIn("fcl, vertices=256: timeout (too long)", made.holes)
        self.assertIn("T", [text for text, _ in _letters(made.figure)])

    def test_the_headline_names_the_fastest_at_both_ends(self):
        made = self.one()
        self.assertEqual(made.headline.text, "In 3D, on pairs apart, sat is fastest at 8 vertices of each hull, but gjk_epa "
                                             "at 256.")
        self.assertIsNone(self.one(of={"sat": METHODS["sat"]}).headline)

    def test_a_chart_for_each_dimension(self):
        found = self.made(hull_sizes, self.sizes(dimensions=(2, 3)))
        self.assertEqual([c.id for c in found], ["hull_sizes_2d", "hull_sizes_3d"])

    def test_without_sizes_or_counts_there_is_no_chart(self):
        self.assertEqual(self.made(hull_sizes, synthetic_store.queries), [hull_sizes.absent])
        asked = self.made(hull_sizes, self.sizes(counted=False))
        self.assertEqual(asked[0].finding.headline, "The `report` of hull_sizes lists this chart, but the sweep lacks its data.")


def _letters(figure):
    """Letters of outcomes, with their axes."""
    return [(str(line.get_marker())[len("$\\mathbf{"):-2], ax) for ax in figure.axes for line in ax.lines
            if str(line.get_marker()).startswith("$")]


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
