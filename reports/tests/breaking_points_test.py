# SPDX-License-Identifier: Zlib
"""Tests of the ladders on which methods fall: at what cost, and sentences where no rung tells methods apart. Run by ctest, or
python3 reports/tests/breaking_points_test.py."""

import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import overlap  # noqa: E402
import ranking  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts.breaking_points import breaking_points  # noqa: E402

EQUAL = {"equal": "cost", "metric": "work_row_updates", "setting": "iterations", "most": 256}


class Ladders(undrawn.Undrawn):
    def made(self, heights, budgets=(), sizes=(5, 10, 20), fallbacks=(), **roles):
        """`heights`: method -> the largest size that stands, at each budget; `fallbacks`: (method, size) of runs that leave all
        rows to Gauss-Seidel."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        equal = {"calibrate": EQUAL, "budget": "run"} if budgets else {}
        maker.sweep("mine", resolver="label", n="parameter", iterations="setting", **equal, **roles)
        for place, budget in enumerate(budgets or (None,)):
            for label, stands in heights.items():
                for n in sizes:
                    fell = n > stands[place]
                    # At equal cost every cell has iterations of its own.
                    own = {"budget": budget, "iterations": int(budget // n) + len(label)} if budget else {"iterations": 10}
                    maker.world("mine", {"scene": "stack", "dimension": 2, "resolver": label, "n": n, **own}, 1, 1e-3,
                                "collapsed" if fell else "ok", "drift" if fell else "", 50 if fell else None, repeats=0)
                    if (label, n) in fallbacks:
                        maker.leave_rows(100)
        maker.close()
        found = chart.made(breaking_points, chart.Context(load.Store(Path(folder.name) / "store.db")))
        self.assertEqual(len(found), 1)
        if self.draws:
            self.assertEqual(overlap.overlaps(found[0].figure), ([], []))
        return found[0]

    @undrawn.drawn
    def test_the_headline_names_the_setting(self):
        made = self.made({"catto": (20,), "naive": (5,)})
        self.assertEqual(made.finding.headline, "On stack in 2D with iterations=10 naive fails first, at n = 10; catto holds to "
                         "the largest value tried, 20.")
        self.assertEqual(self.rows(made), [("catto", 20, None, "holds to the last value tried"), ("naive", 5, 10, "collapsed")])
        self.assertIn("their costs differ", made.note)
        self.assertEqual(made.headline.text, made.finding.headline)
        self.assertEqual([tick.get_text() for tick in made.figure.axes[0].get_xticklabels()], ["5", "10", "20"])
        many = self.made({"catto": (300,), "naive": (30,)}, sizes=(3, 10, 30, 100, 300, 1000, 10000))
        self.assertEqual([tick.get_text() for tick in many.figure.axes[0].get_xticklabels()],
                         ["3", "10", "30", "100", "300", "1,000", "10,000"],
                         "each value that the headline may name has its label")

    @undrawn.drawn
    def test_a_calibrated_ladder_is_one_per_budget_and_names_it(self):
        made = self.made({"catto": (10, 20), "naive": (5, 10)}, budgets=(800.0, 2400.0))
        self.assertEqual(made.finding.headline, "On stack in 2D with 800 row updates per step naive fails first, at n = 10; "
                         "catto fails last, at 20.")
        self.assertEqual(self.rows(made), [("catto", 10, 20, "collapsed"), ("naive", 5, 10, "collapsed"),
                                           ("catto", 20, None, "holds to the last value tried"), ("naive", 10, 20, "collapsed")])
        self.assertEqual([row["scene, parameter, setting"] for row in made.finding.rows()][1:3],
                         ["stack, n, 800 row updates per step", "stack, n, 2,400 row updates per step"])
        self.assertEqual([ax.get_title("left").split("\n")[1] for ax in made.figure.axes if ax.get_visible()],
                         ["800 row updates per step", "2,400 row updates per step"])
        self.assertEqual(len(made.table), 4, "no rung is lost because the iterations differ")
        self.assertEqual(list(made.table["largest that held"]), [10, 5, 20, 10])
        self.assertIn("compared at equal cost: at each value the runner gives each method iterations, the most within the "
                      "budget, at most 256.", made.note)

    def test_a_method_that_left_its_rows_to_gauss_seidel_up_to_its_failure_has_no_rank(self):
        heights, left = {"admm": (20,), "catto": (10,), "naive": (5,)}, {("admm", 10), ("naive", 20)}
        made = self.made(heights, fallbacks=left)
        self.assertEqual(made.finding.headline, "On stack in 2D with iterations=10 naive fails first, at n = 10; catto fails "
                         "last, at 20.")
        self.assertEqual(self.rows(made), [("catto", 10, 20, "collapsed"), ("naive", 5, 10, "collapsed"),
                                           ("admm", None, None, "not ranked: 100 % Gauss-Seidel")],
                         "fallbacks of naive beyond its failure do not count")
        self.assertEqual(set(made.headline.values), {"catto", "naive"})
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            self.assertIn("admm holds to the largest", self.made(heights, fallbacks=left).finding.headline,
                          "the planted bug was not seen")

    def test_if_all_fail_at_one_value_no_method_is_first_or_last(self):
        made = self.made({"catto": (10,), "naive": (10,)})
        self.assertEqual(made.finding.headline, "On stack in 2D with iterations=10 all 2 methods fail at n = 20, and hold below.")
        self.assertEqual(self.rows(made), [("catto and naive", 10, 20, "collapsed")])
        self.assertIsNone(made.headline)
        made = self.made({"catto": (1,), "naive": (1,)})
        self.assertIn("all 2 methods fail at n = 5, the smallest value tried.", made.finding.headline)
        self.assertEqual(self.rows(made), [("catto and naive", None, 5, "collapsed")])
        made = self.made({"catto": (99,), "naive": (99,)})
        self.assertEqual(made.finding.headline, "On stack in 2D with iterations=10 nothing fails up to n = 20.")
        self.assertIsNone(made.headline)

    @staticmethod
    def rows(made):
        names = ("methods", "largest that holds [1]", "first that fails [1]", "outcome")
        return [tuple(row.get(name) for name in names) for row in made.finding.rows()]


if __name__ == "__main__":
    unittest.main()
