# SPDX-License-Identifier: Zlib
"""Tests of the charts of pair queries: no lead within the noise, shares with their numbers, every cell explained. Run by
ctest, or python3 reports/tests/pair_queries_test.py."""

import math
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
import noise  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import ledger, pair_queries  # noqa: E402

PAIRS = (("box", "box"), ("box", "sphere"), ("sphere", "sphere"))
# ns a query on each of PAIRS; None is what a method does not declare
QUICK = {"closed_form": (None, 100, 50), "sat": (200, 104, 51), "gjk_epa": (400, 300, 120)}


def queries(maker, failing=(), asked=600, missing=(), batch={}):
    """Three of ours on three pairs in 2D, five repeats with a spread of 5 %; `failing`: witnesses with 8 failures of 96;
    `batch`: other times in batches."""
    maker.sweep("pair_queries", "pairs", pair_query="stage")
    times = {**QUICK, **dict.fromkeys(failing, (90, 90, 90))}
    for method, of_pairs in times.items():
        for (a, b), ns in zip(PAIRS, of_pairs):
            if (method, a, b) in missing:
                continue
            for repeat in range(5):
                axes = {"kind": "pairs", "dimension": 2, "pair_query": method, "kind_a": a, "kind_b": b, "precision": "f64",
                        "timed": True, "repeat": repeat}
                if ns is None:
                    maker.trial("pair_queries", axes, {}, "unsupported", f"{a} against {b}", 0)
                    continue
                wrong, n = (8, 96) if method in failing else (0, asked)
                spread = 1 + 0.05 * (repeat % 2)
                maker.trial("pair_queries", axes, {"ns_single": ns * spread, "ns_per_query": batch.get(method, ns) * spread,
                                                   "median_error": 0.0, "p99_error": 1e-16, "max_error": 0.5 if wrong else 3e-16,
                                                   "failed": 0,
                                                   "refused": 0, "wrong_boolean": 0, "wrong": wrong, "asked": n},
                            "wrong" if wrong else "ok")


class PairQueries(undrawn.Undrawn):
    def made(self, in_float=(), **kwargs):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        ours, theirs = ("closed_form", "gjk_epa", "sat"), ("fcl_libccd", "libccd_mpr", "fcl_indep", "box2d")
        algorithms = synthetic_store.registered("pair_query", ours) + synthetic_store.registered("pair_query", theirs, "witness")
        maker = synthetic_store.Maker(Path(folder.name) / "store.db", algorithms=[
            {**entry, "in_float": entry["name"] in in_float} for entry in algorithms])
        queries(maker, **kwargs)
        maker.close()
        found = chart.made(pair_queries.pair_queries, chart.Context(load.Store(Path(folder.name) / "store.db")))
        for made in found:
            if self.draws:
                self.assertEqual(overlap.overlaps(made.figure), ([], []), made.id)
        return found

    def test_leaders_within_the_noise_are_named_together(self):
        first = self.made()[0]
        self.assertIn("of 3 pairs of shapes, the fastest without a failure is sat on 1; within the noise of each other, "
                      "closed_form or sat on 2", first.finding)
        self.assertIn("differs by up to 5 %", first.note)
        with unittest.mock.patch.object(noise, "tells", lambda a, b, metric, least: a[metric] != b[metric]):
            bad = self.made()[0]
        self.assertIn("closed_form on 2 and sat on 1", bad.finding, "the planted bug: every difference counts")

    def test_who_has_no_rival_is_not_called_the_fastest(self):
        first = self.made(missing=(("gjk_epa", "box", "box"),))[0]
        self.assertIn("within the noise of each other, closed_form or sat on 2; without a rival, sat on 1", first.finding)
        self.assertNotIn("the fastest", first.finding)

    def test_times_in_batches_have_no_rank(self):
        first = self.made(batch={"gjk_epa": 1})[0]
        self.assertIn("sat on 1; within the noise of each other, closed_form or sat on 2", first.finding)
        self.assertEqual(set(first.table.query("method == 'gjk_epa'")["time per query in batches [s]"].round(11)), {1e-9})
        with unittest.mock.patch.object(pair_queries, "TIME", pair_queries.BATCH):
            self.assertIn("gjk_epa on 3", self.made(batch={"gjk_epa": 1})[0].finding,
                          "the planted bug: lanes beside single calls")

    def test_who_computes_in_single_precision_is_judged_by_it_and_named(self):
        self.assertIn("At 1e-12 of the size, box2d fails somewhere", self.made(failing=("box2d",))[0].finding)
        made = self.made(failing=("box2d",), in_float=("box2d",))
        for text in (made[0].finding, made[0].headline.text, made[1].finding):
            self.assertIn("t 1e-12 of the size (box2d, in single precision, at 1e-5 of the size), ", text)

    def test_where_nobody_fails_the_headline_tells_times_beyond_the_noise(self):
        first = self.made()[0]
        self.assertIn("No method fails at 1e-12 of the size, and no error is above 3e-16", first.finding)
        self.assertIn("In 2D no method fails, in 4,800 queries; times differ most on box–sphere, where gjk_epa takes 3.0 times "
                      "the 100 ns", first.headline.text)
        self.assertIn("of closed_form or sat, which are within the noise", first.headline.text)
        with unittest.mock.patch.object(noise, "floor", lambda cells, metric: 10.0):
            self.assertIsNone(self.made()[0].headline, "no difference is beyond the noise")

    def test_where_somebody_fails_the_headline_tells_who_and_how_often(self):
        first = self.made(failing=("fcl_libccd", "libccd_mpr", "fcl_indep"))[0]
        self.assertIn("At 1e-12 of the size, fcl_indep, fcl_libccd and libccd_mpr fail somewhere; the worst error "
                      "is 0.5 of the size", first.finding)
        self.assertIn("closed_form (50 ns a query), sat (51 ns a query) and gjk_epa (120 ns a query) never fail, in 600 queries "
                      "each; the 3 others fail on 8.3% of 96", first.headline.text)
        self.assertTrue(all(math.isnan(first.headline.values[m]) for m in ("fcl_libccd", "libccd_mpr", "fcl_indep")))

    @undrawn.drawn
    def test_shares_have_the_number_of_queries_beside_them(self):
        rates = self.made(failing=("fcl_libccd",))[1]
        self.assertIn("fcl_libccd fails most often, on sphere–sphere: 8 of 96 (8.3%)", rates.finding)
        self.assertIn("queries of each pair of shapes: 96 to fcl_libccd, 600 to closed_form, gjk_epa and sat", rates.finding)
        self.assertIn("up to 0.5% at 600 queries may have stayed unseen", rates.note)
        labels = [label.get_text() for label in rates.figure.axes[0].get_yticklabels()]
        self.assertEqual(labels, ["closed_form, 600", "fcl_libccd (witness), 96", "gjk_epa, 600", "sat, 600"])

    @undrawn.drawn
    def test_what_is_not_asked_or_not_declared_has_its_word_in_the_legend(self):
        legend = lambda made: [text.get_text() for text in made.figure.legends[0].get_texts()]  # noqa: E731
        asked, blank = self.made()[1], self.made(missing=(("sat", "box", "box"),))[1]
        self.assertIn("no: does not declare it", legend(asked))
        self.assertNotIn("blank: was not asked", legend(asked))
        self.assertIn("blank: was not asked", legend(blank))

    @undrawn.drawn
    def test_a_pair_that_is_not_declared_takes_no_room_on_the_axes(self):
        first = self.made()[0]
        for ax in (ax for ax in first.figure.axes if ax.get_visible()):
            for axis in (ax.xaxis, ax.yaxis):
                self.assertGreater(len(axis.get_majorticklocs()), 1, "a single tick is no axis")
                self.assertFalse({"none", "not timed", "failed"} & {label.get_text() for label in axis.get_ticklabels()})
        self.assertNotIn("at step 0", " ".join(first.holes), "a query has no steps")

    @undrawn.drawn
    def test_no_tick_stands_below_what_is_shown_as_zero(self):
        figure, ax = style.plt.subplots()
        scale = style.ZeroLog(ax, "y", [0.0, 1.0001e-17, 10.0], "1", floor=1e-17)
        ticks = [t for t in ax.yaxis.get_majorticklocs() if t != scale.zero]
        self.assertGreaterEqual(min(ticks), 1e-17)
        style.plt.close(figure)


class OneTiming(undrawn.Undrawn):
    """Of the ledger: a time has no repeats, so that no floor can be measured."""

    def rows(self, *of_methods):
        """Of one pair of shapes: (method, role, ns a question, share that failed)."""
        return pd.DataFrame([{"pair": pair, "method": method, "role": role, "time": ns, "share": share, "max_error": 1e-16}
                             for pair, found in zip("abcdefg", of_methods) for method, role, ns, share in found])

    def finding(self, *of_methods):
        return ledger._cost_finding(self.rows(*of_methods), 3, "f64")

    def test_only_what_is_beyond_a_factor_of_two_is_told(self):
        ours = lambda sat, gjk: [("sat", "competitor", sat, 0.0), ("gjk_epa", "competitor", gjk, 0.0)]  # noqa: E731
        said = self.finding(ours(100, 150), ours(100, 250), ours(180, 100), ours(300, 100))
        self.assertIn("by one timing of each, so that only ratios beyond 2 are told: of 4 pairs of shapes, on 2 the fastest "
                      "without one is gjk_epa (1) and sat (1) and on 2 several are within 2 times the fastest", said)
        with unittest.mock.patch.object(noise, "UNMEASURED", 1.0):
            self.assertIn("gjk_epa (2) and sat (2)", self.finding(ours(100, 150), ours(100, 250), ours(180, 100), ours(300, 100)),
                          "the planted bug: every difference counts")

    def test_rivals_count_where_they_do_not_fail(self):
        fast = lambda share: [("sat", "competitor", 100, 0.0), ("gjk_epa", "competitor", 300, 0.0),  # noqa: E731
                              ("bullet", "witness", 20, share)]
        self.assertIn("the fastest without one is bullet; a witness is among the fastest on 1", self.finding(fast(0.0)))
        self.assertIn("the fastest without one is sat; no witness is among the fastest", self.finding(fast(0.1)))

    def test_who_has_no_rival_is_not_called_the_fastest(self):
        self.assertIn("of 1 pair of shapes, on 1 gjk_epa alone has no failure", self.finding([("gjk_epa", "competitor", 1, 0.0)]))


if __name__ == "__main__":
    unittest.main()
