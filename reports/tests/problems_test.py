# SPDX-License-Identifier: Zlib
"""Tests of the charts of frozen problems: curves, performance profiles and rates. Run by ctest, or
python3 reports/tests/problems_test.py."""

import math
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import ranking  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import problems  # noqa: E402
from charts.problems import frozen_problems  # noqa: E402

def invented(maker, dear=False, ns=None, swept=()):
    """`ns`: {method: time of an iteration} of a timed sweep; `swept`: methods that leave half of their rows to Gauss-Seidel."""
    maker.sweep("mine", "problems", "catto", velocity="stage", problems="run", start="run", order="run", friction="run")

    def trial(name, method, rate, friction="on", order="recorded", predicted=math.nan, outcome="ok", each=10.0):
        left = [rate ** n for n in range(41)]
        first = next((n for n, value in enumerate(left) if value < 1e-3), math.nan)
        axes = {"kind": "problems", "precision": "f64", "problems": name, "velocity": method, "start": "cold", "order": order,
                "friction": friction, "dimension": 2, "timed": ns is not None, "repeat": 0}
        found = {"problem_residual": left[-1], "multiply_adds_to_thousandth": each * first, "rate": rate,
                 "predicted_rate": predicted, "multiply_adds": 40 * each, "rows": 30, "fallbacks": 15 if method in swept else 0}
        series = {"problem_residual": left, "multiply_adds": [each * n for n in range(41)]}
        if ns:
            found["ns_per_solve"] = 40 * ns[method]
            series["ns_per_solve"] = [math.nan] + [ns[method] * n for n in range(1, 41)]
        maker.trial("mine", axes, found if outcome == "ok" else {}, outcome, "" if outcome == "ok" else "it owns its loop",
                    series=series if outcome == "ok" else None)
    for name, rates in {"easy": (0.5, 0.25), "hard": (0.99, 0.5)}.items():
        trial(name, "catto", rates[0])
        trial(name, "nncg", rates[1])
        trial(name, "soft_step", 0, outcome="unsupported")
        if dear:
            trial(name, "direct_lcp", 0.1, each=2500.0)
    for order, predicted in (("recorded", 0.9), ("coloured", 0.85)):
        trial("easy", "catto", 0.9, "off", order, predicted)


class Problems(with_store.WithStore):
    @undrawn.drawn
    def test_residuals_profile_and_rates(self):
        curves, profile, rates = self.made(frozen_problems, invented)
        self.assertEqual(curves.finding.headline, "After all iterations nncg has the smallest residual on 2 of 2 problems.")
        found = curves.finding.table.set_index("method")
        self.assertEqual(found["smallest or tied on [1]"].to_dict(), {"nncg": 2, "catto": 1}, "0.5^40 is rounding as 0.25^40 is")
        self.assertAlmostEqual(found.at["catto", "median residual [1]"], 0.99**40 / 2)
        self.assertEqual([ax.get_title("left") or ax.get_title() for ax in curves.figure.axes if ax.get_visible()],
                         ["easy", "hard"])
        self.assertEqual(profile.finding.headline, "nncg solves the largest share of 2 problems (100 %) and is cheapest most "
                                                   "often "
                         "(100 %).")
        table = profile.finding.table.set_index("method")
        self.assertEqual(list(table.index), ["nncg", "catto"], "unsupported methods have no row")
        self.assertEqual(table.loc["catto", "share solved"], 0.5)
        self.assertEqual(table.loc["catto", "median multiple"], 2)
        # (1 - 0.85) / (1 - 0.9): the planted difference of the rates shows.
        self.assertEqual(rates.finding.headline, "On 2 frictionless cells the spectral radius predicts catto's number of "
                                                 "iterations "
                         "to within 1.5 times.")
        self.assertEqual(rates.finding.table[["order of rows", "iterations, measured over predicted"]].to_numpy().tolist(),
                         [["coloured", "1.5"], ["recorded", "1"]])

    def test_a_method_that_leaves_rows_to_gauss_seidel_has_no_rank(self):
        ns = {"catto": 1000.0, "nncg": 1250.0, "soft_step": 1.0}
        for about in ({}, {"ns": ns}):
            made = self.made(frozen_problems, lambda maker, about=about: invented(maker, swept=("nncg",), **about))
            for chart in made[:-1]:
                table = chart.finding.table.set_index("method")
                self.assertEqual(table.at["nncg", "outcome"], "not ranked on 2 of 2: 50 % Gauss-Seidel")
                self.assertEqual(table.index[-1], "nncg")
                self.assertNotIn("nncg", chart.finding.headline, chart.id)
            self.assertIn("catto solves the largest share of 2 problems (50 %)", made[-2].finding.headline)
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            found = self.made(frozen_problems, lambda maker: invented(maker, swept=("nncg",)))
            self.assertIn("nncg has the smallest residual on 2", found[0].finding.headline)

    def test_costs_beyond_the_axis_are_listed(self):
        self.assertEqual(self.made(frozen_problems, invented)[1].holes, [])
        profile = self.made(frozen_problems, lambda maker: invented(maker, dear=True))[1]
        self.assertIn("direct_lcp and nncg solve the largest share of 2 problems (100 %)", profile.finding.headline)
        self.assertEqual(profile.holes, ["direct_lcp: 1 more of 2 problems at 200 times the best, not drawn"])

    @undrawn.drawn
    def test_a_timed_sweep_has_curves_over_time(self):
        # On easy catto has 10 iterations to a thousandth and nncg 5: 1.6 times the time. On hard nncg is alone.
        ns = {"catto": 1000.0, "nncg": 1250.0, "soft_step": 1.0}
        curves, over_time, *_ = self.made(frozen_problems, lambda maker: invented(maker, ns=ns))
        self.assertEqual((curves.id, over_time.id), ("mine_cold_curves", "mine_cold_times"))
        self.assertEqual(over_time.finding.headline, "nncg solves 2 of 2 problems to 0.001 g dt within 2 times the fastest "
                                                     "method's "
                         "time.")
        counts = over_time.finding.table.set_index("method")["fastest or tied on [1]"].to_dict()
        self.assertEqual(counts, {"nncg": 2, "catto": 1})
        self.assertEqual(list(over_time.finding.table["outcome"]), ["", "no result on 1 of 2"])
        panels = [ax for ax in over_time.figure.axes if ax.get_visible()]
        self.assertEqual([ax.get_title("left") for ax in panels], ["easy", "hard"])
        self.assertEqual({ax.get_xlabel() for ax in panels}, {"time per solve"})
        drawn = [list(line.get_xdata()) for line in panels[0].lines if len(line.get_xdata()) > 2]
        self.assertEqual(drawn, [[ns[method] * n for n in range(1, 41)] for method in ("catto", "nncg")])
        self.assertIn("10 µs", [tick.get_text() for tick in panels[0].get_xticklabels()])
        table = over_time.table.set_index(["problem", "method"])["time per solve, to 0.001 g dt [s]"]
        self.assertEqual(list(table)[:4], [1e-5, 6.25e-6, math.inf, 1.25e-5])
        # Beside a cheaper catto nncg takes 2.1 times as long on easy.
        dear = self.made(frozen_problems, lambda maker: invented(maker, ns={**ns, "catto": 300.0}))[1]
        self.assertEqual(dear.finding.table.set_index("method")["fastest or tied on [1]"].to_dict(), {"catto": 1, "nncg": 1})
        self.assertEqual([chart.id for chart in self.made(frozen_problems, invented) if "times" in chart.id], [],
                         "nothing was timed")

    def test_the_time_to_a_residual_counts_from_where_it_stays(self):
        time, left = [math.nan, 1.0, 2.0, 3.0, 4.0], [1.0, 1e-4, 1e-2, 1e-4, 1e-5]
        self.assertEqual(problems.time_to(1e-3, time, left), 3)
        self.assertEqual(problems.time_to(1e-3, time, [1.0, 1e-4, 1e-4, 1e-4, math.nan]), math.inf, "no number solves nothing")
        self.assertEqual(problems.time_to(1e-3, time, [0.0] * 5), 1, "solved without iterations, which has no time")
        # The planted bug, the first time below, is seen.
        self.assertNotEqual(problems.time_to(1e-3, time, left), next(t for t, value in zip(time, left) if value < 1e-3))

    def test_a_problem_that_no_method_solves_counts_and_the_best_is_one(self):
        found = problems.profile({"a": [10, 100, math.inf], "b": [20, 50, math.inf]})
        self.assertEqual([list(part) for part in found["a"]], [[1, 2], [1 / 3, 2 / 3]])
        self.assertEqual([list(part) for part in found["b"]], [[1, 2], [1 / 3, 2 / 3]])
        # The planted bug, ratios to the best of all problems instead of each, is seen: a would have 10 instead of 2.
        self.assertNotIn(10, found["a"][0])


if __name__ == "__main__":
    unittest.main()
