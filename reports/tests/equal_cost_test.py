# SPDX-License-Identifier: Zlib
"""Tests of the chart of methods at equal cost: ranks at each budget, ties, and methods that meet no budget. Run by ctest, or
python3 reports/tests/equal_cost_test.py."""

import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import pandas as pd  # noqa: E402

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import equal_cost  # noqa: E402

EQUAL = {"equal": "cost", "metric": "work_row_updates", "setting": "iterations"}


def cells(rows):
    """Rows of (method, outcome, error) of one budget, a method once per seed."""
    return pd.DataFrame([{"method": m, "outcome": outcome, "error": e} for m, outcome, e in rows])


def check_ranks(ranks_of):
    apart = cells([("a", "ok", 1.0), ("b", "ok", 2.0), ("c", "collapsed", 0.5), ("d", "unsupported", float("nan"))])
    found = {row[1]: row[0] for row in ranks_of(apart, "error")}
    if found != {"a": 1, "b": 2, "c": None, "d": None}:
        return f"apart: {found}"
    # Over three seeds a and b change places; c is always behind them.
    seeds = cells([("a", "ok", e) for e in (1.0, 1.2, 1.4)] + [("b", "ok", e) for e in (1.1, 1.3, 1.6)] +
                  [("c", "ok", e) for e in (2.0, 2.1, 2.2)])
    found = {row[1]: row[0] for row in ranks_of(seeds, "error")}
    if found != {"a": 1, "b": 1, "c": 3}:
        return f"over seeds: {found}"
    # b meets both of its neighbours, which are apart: it is as good as the first.
    rows = {"a": (1.0, 1.2), "b": (1.1, 2.1), "c": (1.5, 1.6)}
    chain = cells([(method, "ok", e) for method, errors in rows.items() for e in errors])
    found = {row[1]: row[0] for row in ranks_of(chain, "error")}
    if found != {"a": 1, "b": 1, "c": 2}:
        return f"in a chain: {found}"
    once = cells([("a", "ok", 1.0), ("a", "collapsed", 1.0), ("b", "ok", 2.0)])
    found = {row[1]: row[0] for row in ranks_of(once, "error")}
    return "" if found == {"a": None, "b": 1} else f"one seed fell: {found}"


def ranks_without_ties(part, name):
    """Planted bug: a difference is a rank, however small beside what another seed changes."""
    return [(None if row[0] is None else place, *row[1:]) for place, row in enumerate(equal_cost.ranks(part, name), 1)]


def ranks_of_those_that_stood(part, name):
    """Planted bug: what fell under one seed is ranked by the seeds under which it stood."""
    return equal_cost.ranks(part[part["outcome"] == "ok"], name)


class EqualCost(undrawn.Undrawn):
    def test_ranks(self):
        self.assertEqual(check_ranks(equal_cost.ranks), "")
        for bug in (ranks_without_ties, ranks_of_those_that_stood):
            self.assertNotEqual(check_ranks(bug), "", "the planted bug was not seen")

    def made(self, about=EQUAL, slow=1.0, **more):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        maker.sweep("mine", "world", "", resolver="label", iterations="setting", budget="run", calibrate=about, **more)
        errors = {"catto": (3e-3, 1e-3), "naive": (2e-2, 4e-3), "soft_step": (4e-3, 5e-4)}
        for label, found in errors.items():
            for i, budget in enumerate((100, 400)):
                axes = {"scene": "pyramid", "dimension": 2, "resolver": label, "budget": budget}
                if label == "naive" and i == 0:
                    maker.trial("mine", {"kind": "world", **axes, "timed": False, "repeat": 0}, {}, "unsupported",
                                "iterations=1 costs 120 (work_row_updates), the budget is 100")
                else:
                    dear = slow if label == "soft_step" else 1.0
                    maker.world("mine", {**axes, "iterations": 4 * (i + 1)}, dear * budget / 4000, found[i], work=0.9 * budget)
        maker.close()
        made = [c for c in make.all_charts(chart.Context(load.Store(Path(folder.name) / "store.db")))
                if c.sweep == "mine"]
        self.addCleanup(style.plt.close, "all")
        return made

    @undrawn.drawn
    def test_a_calibrated_sweep_has_this_chart_and_no_other(self):
        made = self.made()
        self.assertEqual([c.id for c in made], ["mine_pyramid__2d"])
        self.assertEqual(made[0].section, equal_cost.SECTION)
        self.assertEqual(overlap.overlaps(made[0].figure), ([], []))

    def test_the_finding_ranks_at_every_budget_and_tells_who_met_none(self):
        made = self.made()[0]
        self.assertIn("at 100 catto is first (3 mm), soft_step last (4 mm), without a rank naive", made.finding)
        self.assertIn("at 400 soft_step is first (500 µm), then catto (1 mm), naive last (4 mm)", made.finding)
        self.assertIn("No method is first at every budget.", made.finding)
        self.assertTrue(made.headline.text.endswith("; nobody is first at every budget."), made.headline.text)
        self.assertIn("iterations=1 costs 120", " ".join(made.holes))
        self.assertEqual(list(made.table["rank"]), [1, 2, "", 1, 2, 3])
        self.assertEqual(list(made.table["iterations"]), ["4", "4", "", "8", "8", "8"])

    def test_those_of_one_rank_between_first_and_last_are_named_together(self):
        self.assertEqual(equal_cost._tied([(2, "a", 1e-3, 0, 1), (2, "b", 1e-3, 0, 1)], "m"), "a and b, tied (1 mm)")

    @undrawn.drawn
    def test_what_equal_row_updates_hide_in_time_is_said_and_drawn(self):
        made = self.made(slow=5)[0]
        self.assertRegex(made.finding, r"What is equal by row updates per step is not so by time per step: at (100|400) "
                         r"soft_step has [45]\.\d times that of (catto|naive) \(\d+ µs against [\d.]+ µs\)\.")
        titles = [ax.get_title("left") for ax in made.figure.axes]
        self.assertEqual(titles[-1], "time per step")
        self.assertIn("leaves out what a method does beside", made.note)
        self.assertIn("The same method against itself differs", made.note, "its noise")
        self.assertIn("time per step [s]", made.table)
        alike = self.made()[0]
        self.assertIn("By time per step the methods are alike, within the noise.", alike.finding)
        self.assertNotIn("not so by", alike.finding)

    @undrawn.drawn
    def test_who_stopped_at_the_most_iterations_is_told_and_ringed(self):
        made = self.made({**EQUAL, "most": 8})[0]
        self.assertIn("Stopped by the largest value of iterations that is searched, 8, with budget left: catto at 400 (360 "
                      "spent), ", made.finding)
        rings = sum(line.get_markerfacecolor() == "none" and line.get_markersize() == 12
                    for ax in made.figure.axes for line in ax.lines)
        self.assertEqual(rings, 3 * len([ax for ax in made.figure.axes if ax.get_title("left")]), "three methods, in each panel")
        self.assertEqual(list(made.table["budget spent [1]"].dropna()), [0.9] * 5)
        self.assertEqual(overlap.overlaps(made.figure), ([], []))
        self.assertNotIn("Stopped", self.made({**EQUAL, "most": 64})[0].finding)

    def test_equal_error_ranks_costs(self):
        made = self.made({**EQUAL, "equal": "error", "metric": "max_penetration"})[0]
        self.assertIn("by time per step at equal error (largest penetration)", made.finding)


if __name__ == "__main__":
    unittest.main()
