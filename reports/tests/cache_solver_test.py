# SPDX-License-Identifier: Zlib
"""Tests of the map of caches and resolvers: which pairs hold, and which choice matters more. Run by ctest, or
python3 reports/tests/cache_solver_test.py."""

import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import ranking  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import breaking_points  # noqa: E402
from charts.breaking_points import cache_solver  # noqa: E402

EQUAL = {"equal": "cost", "metric": "work_row_updates", "setting": "iterations", "most": 64}
HEIGHTS = {("catto", "none"): 0, ("catto", "by_feature"): 8, ("catto", "recycling"): 8,
           ("soft_step", "none"): 4, ("soft_step", "by_feature"): 8, ("soft_step", "recycling"): 24}
SIZES = (4, 8, 16, 24)


class CacheSolver(with_store.WithStore):
    @staticmethod
    def towers(heights=None, timed=False, fallbacks=()):
        """`heights`: (resolver, cache) -> the largest size that stands; `fallbacks`: pairs that leave all rows to
        Gauss-Seidel."""
        def fill(maker):
            maker.sweep("mine", resolver="label", cache="stage", n="parameter", iterations="setting", budget="run",
                        calibrate=EQUAL)
            for (resolver, cache), stands in (heights or HEIGHTS).items():
                for n in SIZES:
                    axes = {"scene": "stack", "dimension": 2, "n": n, "cache": cache, "resolver": resolver, "budget": 2400,
                            "iterations": 200 // n}
                    fell = n > stands
                    maker.world("mine", axes, 1e-2 * n, 1e-3, "collapsed" if fell else "ok", "drift" if fell else "",
                                50 if fell else None, repeats=5 if timed else 0, work=2350)
                    if (resolver, cache) in fallbacks:
                        maker.leave_rows(100)
        return fill

    @undrawn.drawn
    def test_the_headline_names_the_choice_that_matters_more(self):
        made = self.made(cache_solver, self.towers())
        self.assertEqual(len(made), 1)
        self.assertEqual(made[0].finding.headline, "On stack, 2D, at 2,400 row updates per step the cache matters more: another "
                         "cache changes the largest n that holds by 14, another resolver by 4 (medians).")
        self.assertEqual(self.rows(made[0]), [
            ("soft_step with recycling", 24, "", "best"),
            ("catto with by_feature, catto with recycling and soft_step with by_feature", 8, "", "0.3 times"),
            ("soft_step with none", 4, "", "0.2 times"), ("catto with none", None, "", "failed: at the smallest value tried"),
            ("change by another cache", 14, "8 to 20", "median change"),
            ("change by another resolver", 4, "0 to 16", "median change")])
        self.assertEqual(made[0].headline.text, "On stack, 2D, at 2,400 row updates per step soft_step holds to n = 24 with "
                         "the cache recycling, and to 4 with none.")
        panel = made[0].figure.axes[0]
        self.assertEqual([text.get_text() for text in panel.texts], ["8", "–", "8", "8", "4", "24"], "by rows of resolvers")
        self.assertEqual(list(made[0].table["largest n that holds"]), [8, 0, 8, 8, 4, 24])

    @staticmethod
    def rows(made):
        names = ("resolver and cache", "largest n that holds [1]", "range", "against the best")
        return [tuple(row.get(name) for name in names) for row in made.finding.rows()]

    @undrawn.drawn
    def test_a_pair_that_left_its_rows_to_gauss_seidel_has_no_rank(self):
        best = {("soft_step", "recycling")}
        made = self.made(cache_solver, self.towers(fallbacks=best))[0]
        self.assertIn(("catto with by_feature, catto with recycling and soft_step with by_feature", 8, "", "best"),
                      self.rows(made))
        self.assertIn(("soft_step with recycling", None, "", "not ranked: 100 % Gauss-Seidel"), self.rows(made))
        self.assertNotIn("recycling", made.headline.text)
        self.assertIn("100 % GS", [text.get_text() for text in made.figure.axes[0].texts])
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            made = self.made(cache_solver, self.towers(fallbacks=best))[0]
        self.assertIn(("soft_step with recycling", 24, "", "best"), self.rows(made), "the planted bug was not seen")

    def test_the_planted_bug_that_takes_the_other_axis_is_seen(self):
        found = {pair: float(height) for pair, height in HEIGHTS.items()}
        self.assertEqual(sorted(breaking_points.effects(found, 1)), [8, 20], "of each resolver over its caches")
        self.assertEqual(sorted(breaking_points.effects(found, 0)), [0, 4, 16], "of each cache over its resolvers")

    @undrawn.drawn
    def test_times_and_letters_of_failed_runs_are_shown(self):
        made = self.made(cache_solver, self.towers(timed=True))[0]
        titles = [ax.get_title("left") for ax in made.figure.axes]
        self.assertEqual(titles[0], "largest n that holds")
        self.assertEqual(titles[2], "time per step, n = 4", "the size at which most pairs hold")
        self.assertIn("C", [text.get_text() for text in made.figure.axes[2].texts], "catto with none fell there")
        self.assertIn("time per step at n = 4 [s]", made.table)

    def test_one_cache_makes_no_chart_and_equal_pairs_no_headline(self):
        self.assertEqual(self.made(cache_solver, self.towers({pair: 8 for pair in HEIGHTS if pair[1] == "none"})),
                         [cache_solver.absent])
        none = self.made(cache_solver, self.towers(dict.fromkeys(HEIGHTS, 0)))[0]
        self.assertIn("every pair fails at the smallest value tried.", none.finding.headline)
        self.assertIsNone(none.headline)
        alike = self.made(cache_solver, self.towers(dict.fromkeys(HEIGHTS, 24)))[0]
        self.assertEqual([row[1] for row in self.rows(alike)], [24, 0, 0])
        self.assertIn("cache and resolver matter alike", alike.finding.headline)
        self.assertIsNone(alike.headline)


if __name__ == "__main__":
    unittest.main()
