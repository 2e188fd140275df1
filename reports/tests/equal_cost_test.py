# SPDX-License-Identifier: Zlib
"""Tests of the chart of methods at equal cost: ranks at each budget, ties, and methods that meet no budget. Run by ctest, or
python3 reports/tests/equal_cost_test.py."""

import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import pandas as pd  # noqa: E402

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import measured  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import equal_cost  # noqa: E402
from measured import Measured  # noqa: E402
from with_store import row  # noqa: E402

EQUAL = {"equal": "cost", "metric": "work_row_updates", "setting": "iterations"}


def cells(rows):
    """Rows of (method, outcome, error or errors of seeds) of one budget."""
    made = []
    for method, outcome, found in rows:
        seeds = list(found) if isinstance(found, (list, tuple)) else [found]
        made.append({"method": method, "outcome": outcome, "error": seeds[len(seeds) // 2], "seeds": list(range(len(seeds))),
                     measured.MEASURED: {"error": Measured(seeds=tuple(seeds if len(seeds) > 1 else ()))}})
    return pd.DataFrame(made)


def around(middle, turned=()):
    """Errors under twenty seeds, a little apart from each other; under some of them far more."""
    return [middle * (1 + seed / 100) * (9 if seed in turned else 1) for seed in range(20)]


def check_ranks(ranks_of):
    apart = cells([("a", "ok", 1.0), ("b", "ok", 2.0), ("c", "collapsed", 0.5), ("d", "unsupported", float("nan"))])
    found = {row[1]: row[0] for row in ranks_of(apart, "error")}
    if found != {"a": 1, "b": 2, "c": None, "d": None}:
        return f"apart: {found}"
    # a is better than b under thirteen of twenty seeds, which chance is in one of eight; c is behind both under each.
    seeds = cells([("a", "ok", around(1.0, turned=range(7))), ("b", "ok", around(1.1)), ("c", "ok", around(20.0))])
    found = {row[1]: row[0] for row in ranks_of(seeds, "error")}
    if found != {"a": 1, "b": 1, "c": 3}:
        return f"over seeds: {found}"
    # b is not told from either of its neighbours, which are told apart: it is as good as the first.
    chain = cells([("a", "ok", around(1.0)), ("b", "ok", [v * (0.99 if i % 2 else 1.03) for i, v in enumerate(around(1.0))]),
                   ("c", "ok", around(1.02))])
    found = {row[1]: row[0] for row in ranks_of(chain, "error")}
    if found != {"a": 1, "b": 1, "c": 2}:
        return f"in a chain: {found}"
    once = cells([("a", "collapsed", [1.0, float("nan"), 1.0]), ("b", "ok", [2.0, 2.0, 2.0])])
    found = {row[1]: row[0] for row in ranks_of(once, "error")}
    return "" if found == {"a": None, "b": 1} else f"one seed fell: {found}"


def ranks_without_ties(part, name):
    """Planted bug: a difference is a rank, however small beside what another seed changes."""
    return [(None if row[0] is None else place, *row[1:]) for place, row in enumerate(equal_cost.ranks(part, name), 1)]


def ranks_of_those_that_stood(part, name):
    """Planted bug: what fell under one seed is ranked by the seeds under which it stood."""
    return equal_cost.ranks(part.assign(outcome=["ok" if found == found else bad for found, bad in
                                                 zip(part[name], part["outcome"])]), name)


class EqualCost(undrawn.Undrawn):
    def test_ranks(self):
        self.assertEqual(check_ranks(equal_cost.ranks), "")
        for bug in (ranks_without_ties, ranks_of_those_that_stood):
            self.assertNotEqual(check_ranks(bug), "", "the planted bug was not seen")

    def made(self, about=EQUAL, slow=1.0, frugal=None, **more):
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
                    maker.world("mine", {**axes, "iterations": 4 * (i + 1)}, dear * budget / 4000, found[i],
                                work=(frugal or {}).get(label, 0.9 * budget))
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
        self.assertEqual(made.finding.headline, "On pyramid, 2D, at equal row updates per step, catto has the smallest "
                                                "penetration at "
                         "100, soft_step at 400; no method is first at every budget.")
        self.assertEqual([list(row(made, name).values())[1:] for name in ("soft_step", "catto", "naive")],
                         [["4 mm", "2", "500 µm", "1"], ["3 mm", "1", "1 mm", "2"], ["", "needs more", "4 mm", "3"]])
        self.assertTrue(made.headline.text.startswith("On pyramid, 2D, within 400 (row updates per step), soft_step has the "
                                                      "smallest "
                                                      "penetration, 500 µm; naive has 4 mm."), made.headline.text)
        self.assertIn("iterations=1 costs 120", " ".join(made.holes))
        self.assertNotIn("fail", made.finding.text() + made.headline.text, "what costs more than there is does not fail")
        self.assertEqual(list(made.table["rank"]), [1, 2, "", 1, 2, 3])
        self.assertEqual(list(made.table["iterations"]), ["4", "4", "", "8", "8", "8"])

    def test_who_spends_far_less_than_the_budget_is_not_said_to_spend_it(self):
        made = self.made(frugal={"catto": 35.4})[0]
        self.assertEqual(row(made, "catto")["rank at 400"], "2, spends 35.4")
        self.assertNotIn("spends", self.made()[0].finding.text())

    def test_a_tie_stands_beside_the_rank(self):
        with unittest.mock.patch.object(equal_cost, "ranked", lambda *_: [(1, "a", 1e-3, 0, 1), (2, "b", 1e-3, 0, 1),
                                                                          (2, "c", 2e-3, 0, 1)]):
            context = unittest.mock.Mock(unit=lambda name: "m", title=lambda name: "error")
            rows = pd.DataFrame({"method": list("abc"), "budget": 4, "outcome": "ok", "hashes": [[]] * 3})
            with unittest.mock.patch.multiple(equal_cost, _marks=lambda *_: {}, farthest=lambda *_: None,
                                              final_states=lambda _: {}, said_of=lambda *_: "4"):
                made, _ = equal_cost.found(context, rows, EQUAL, "here", "error", None)
        self.assertEqual(made.table["rank at 4"].tolist(), ["1", "2, tie", "2, tie"])

    @undrawn.drawn
    def test_what_equal_row_updates_hide_in_time_is_said_and_drawn(self):
        made = self.made(slow=5)[0]
        self.assertRegex(made.note, r"Equal row updates per step can have different time per step: at (100|400) "
                         r"soft_step has [45]\.\d times that of (catto|naive) \(\d+ µs against [\d.]+ µs\)\.")
        self.assertIn("time per step at ", made.finding.text())
        titles = [ax.get_title("left") for ax in made.figure.axes]
        self.assertEqual(titles[-1], "time per step")
        self.assertIn("do not count other work of a method", made.note)
        self.assertIn("itself", made.note, "its noise")
        self.assertIn("time per step [s]", made.table)
        alike = self.made()[0]
        self.assertIn("The time per step of the methods differs by no more than noise.", alike.note)
        self.assertNotIn("can have different", alike.note)

    @undrawn.drawn
    def test_who_stopped_at_the_most_iterations_is_told_and_ringed(self):
        made = self.made({**EQUAL, "most": 8})[0]
        self.assertEqual(row(made, "catto")["rank at 400"], "2, at the largest iterations, 8")
        rings = sum(line.get_markerfacecolor() == "none" and line.get_markersize() == 12
                    for ax in made.figure.axes for line in ax.lines)
        self.assertEqual(rings, 3 * len([ax for ax in made.figure.axes if ax.get_title("left")]), "three methods, in each panel")
        self.assertEqual(list(made.table["budget spent [1]"].dropna()), [0.9] * 5)
        self.assertEqual(overlap.overlaps(made.figure), ([], []))
        self.assertNotIn("largest iterations", self.made({**EQUAL, "most": 64})[0].finding.text())

    def test_equal_error_ranks_costs(self):
        made = self.made({**EQUAL, "equal": "error", "metric": "max_penetration"})[0]
        self.assertIn("at equal largest penetration", made.finding.headline)
        self.assertIn("the smallest time per step", made.finding.headline)


if __name__ == "__main__":
    unittest.main()
