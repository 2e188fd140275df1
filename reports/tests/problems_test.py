# SPDX-License-Identifier: Zlib
"""Tests of the charts of frozen problems: curves, performance profiles and rates. Run by ctest, or
python3 reports/tests/problems_test.py."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import with_store  # noqa: E402
from charts import problems  # noqa: E402

def invented(maker, dear=False):
    maker.sweep("mine", "problems", "catto", velocity="stage", problems="run", start="run", order="run", friction="run")

    def trial(name, method, rate, friction="on", order="recorded", predicted=math.nan, outcome="ok", each=10.0):
        left = [rate ** n for n in range(41)]
        first = next((n for n, value in enumerate(left) if value < 1e-3), math.nan)
        axes = {"kind": "problems", "precision": "f64", "problems": name, "velocity": method, "start": "cold", "order": order,
                "friction": friction, "dimension": 2, "timed": False, "repeat": 0}
        maker.trial("mine", axes, {"problem_residual": left[-1], "updates_to_thousandth": each * first, "rate": rate,
                                   "predicted_rate": predicted, "row_updates": 40 * each} if outcome == "ok" else {}, outcome,
                    "" if outcome == "ok" else "it owns its loop",
                    series={"problem_residual": left, "row_updates": [each * n for n in range(41)]} if outcome == "ok" else None)
    for name, rates in {"easy": (0.5, 0.25), "hard": (0.99, 0.5)}.items():
        trial(name, "catto", rates[0])
        trial(name, "nncg", rates[1])
        trial(name, "soft_step", 0, outcome="unsupported")
        if dear:
            trial(name, "direct_lcp", 0.1, each=2500.0)
    for order, predicted in (("recorded", 0.9), ("coloured", 0.85)):
        trial("easy", "catto", 0.9, "off", order, predicted)


class Problems(with_store.WithStore):
    def test_who_solves_how_much_at_which_cost(self):
        curves, profile, rates = self.made(problems, invented)
        self.assertEqual(curves.finding, "Of 2 problems, with all iterations, who leaves least: nncg of 2 and catto of 1.",
                         "0.5^40 is rounding as 0.25^40 is")
        self.assertEqual([ax.get_title("left") or ax.get_title() for ax in curves.figure.axes if ax.get_visible()],
                         ["easy", "hard"])
        self.assertEqual(profile.finding, "Of 2 problems nncg solves most, 100 %; nncg is the cheapest for 100 %.")
        table = profile.table.set_index("method")
        self.assertEqual(list(table.index), ["catto", "nncg"], "not who is unsupported")
        self.assertEqual(table.loc["catto", "share solved"], 0.5)
        self.assertEqual(table.loc["catto", "median multiple"], 2)
        # (1 - 0.85) / (1 - 0.9): the planted rate that is not the predicted one is told.
        self.assertEqual(rates.finding, "On 2 frictionless cells the matrix tells catto's number of iterations to within "
                         "1.5 times.")

    def test_who_solves_beyond_the_chart_is_named(self):
        self.assertEqual(self.made(problems, invented)[1].holes, [])
        profile = self.made(problems, lambda maker: invented(maker, dear=True))[1]
        self.assertIn("direct_lcp and nncg solve most, 100 %", profile.finding)
        self.assertEqual(profile.holes, ["direct_lcp: 1 more of 2 problems at 200 times the best, not drawn"])

    def test_a_problem_that_nobody_solves_counts_and_the_best_is_one(self):
        found = problems.profile({"a": [10, 100, math.inf], "b": [20, 50, math.inf]})
        self.assertEqual([list(part) for part in found["a"]], [[1, 2], [1 / 3, 2 / 3]])
        self.assertEqual([list(part) for part in found["b"]], [[1, 2], [1 / 3, 2 / 3]])
        # The planted bug, times over the best of all problems and not of each, is seen: a would have 10 and not 2.
        self.assertNotIn(10, found["a"][0])


if __name__ == "__main__":
    unittest.main()
