# SPDX-License-Identifier: Zlib
"""Tests of the charts of pair queries: no lead inside the noise, shares with their numbers, every cell explained. Run by ctest,
or python3 reports/tests/pair_queries_test.py."""

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
# ns a query on each of PAIRS; None: the method does not declare the pair
QUICK = {"closed_form": (None, 100, 50), "sat": (200, 104, 51), "gjk_epa": (400, 300, 120)}


def queries(maker, failing=(), asked=600, missing=(), batch={}):
    """Three methods on three pairs in 2D, five repeats with a spread of 5 %; `failing`: witnesses with 8 failures of 96; `batch`:
    other times in batches."""
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

    @staticmethod
    def wins(made, *columns):
        """{method: its counts}"""
        table = made.finding.table.set_index("method")
        return {method: tuple(int(table.at[method, column]) for column in columns or ("fastest on", "ties for fastest on"))
                for method in table.index}

    def test_methods_inside_the_noise_tie(self):
        first = self.made()[0]
        self.assertEqual(self.wins(first), {"sat": (1, 2), "closed_form": (0, 2), "gjk_epa": (0, 0)})
        self.assertEqual(first.finding.headline, "In 2D 3 of 3 methods never fail at 1e-12 of the size; of these, sat is "
                         "fastest or tied on 3 of 3 pairs of shapes.")
        self.assertIn(" 5 % ", first.note)
        with unittest.mock.patch.object(noise, "tells", lambda a, b, metric, least: a[metric] != b[metric]):
            bad = self.made()[0]
        self.assertEqual(self.wins(bad)["closed_form"], (2, 0), "the planted bug: every difference counts")

    def test_the_only_method_of_a_pair_is_not_the_fastest(self):
        first = self.made(missing=(("gjk_epa", "box", "box"),))[0]
        self.assertEqual(self.wins(first, "fastest on", "ties for fastest on", "only method on")["sat"], (0, 2, 1))
        self.assertIn("fastest or tied on 2 of 2 pairs of shapes", first.finding.headline)

    def test_times_in_batches_have_no_rank(self):
        first = self.made(batch={"gjk_epa": 1})[0]
        self.assertEqual(self.wins(first), {"sat": (1, 2), "closed_form": (0, 2), "gjk_epa": (0, 0)})
        self.assertEqual(set(first.table.query("method == 'gjk_epa'")["time per query in batches [s]"].round(11)), {1e-9})
        with unittest.mock.patch.object(pair_queries, "TIME", pair_queries.BATCH):
            self.assertEqual(self.wins(self.made(batch={"gjk_epa": 1})[0])["gjk_epa"], (3, 0),
                             "the planted bug: SIMD lanes beside single calls")

    def test_a_method_in_single_precision_is_judged_by_it(self):
        judged = lambda made: made.finding.table.set_index("method")["judged at"].to_dict()  # noqa: E731
        self.assertEqual(set(judged(self.made(failing=("box2d",))[0]).values()), {"1e-12 of the size"})
        for made in self.made(failing=("box2d",), in_float=("box2d",)):
            self.assertIn("at 1e-12 of the size", made.finding.headline)
            self.assertEqual({m for m, at in judged(made).items() if at == "1e-5 of the size"}, {"box2d"})

    def test_without_failures_the_headline_tells_times_beyond_the_noise(self):
        first = self.made()[0]
        self.assertEqual(set(first.finding.table["outcome"]), {"never fails"})
        self.assertAlmostEqual(first.finding.table["worst error over the size [1]"].max(), 3e-16)
        self.assertEqual(first.headline.text, "In 2D no method fails; times differ most on box–sphere, where gjk_epa takes 3.0 "
                         "times the 100 ns of closed_form and sat (tie).")
        with unittest.mock.patch.object(noise, "floor", lambda cells, metric: 10.0):
            self.assertIsNone(self.made()[0].headline, "no difference is beyond the noise")

    def test_failing_methods_stand_in_the_headline_and_in_the_table(self):
        first = self.made(failing=("fcl_libccd", "libccd_mpr", "fcl_indep"))[0]
        table = first.finding.table.set_index("method")
        failing = ["fcl_indep", "fcl_libccd", "libccd_mpr"]
        self.assertEqual(list(table.index[-3:]), failing, "they stand last, though they are fast")
        self.assertEqual(set(table.loc[failing, "outcome"]), {"fails on 3 of 3 pairs"})
        self.assertEqual(set(table.loc[failing, "worst error over the size [1]"]), {0.5})
        self.assertIn("3 of 6 methods never fail at 1e-12 of the size", first.finding.headline)
        self.assertEqual(first.headline.text, "On sphere–sphere in 2D 3 of 6 methods fail, on 8.3% of the queries; fastest "
                                              "without "
                         "a failure are closed_form and sat (50 ns).")
        self.assertTrue(all(math.isnan(first.headline.values[m]) for m in failing))

    @undrawn.drawn
    def test_shares_have_the_number_of_queries_beside_them(self):
        rates = self.made(failing=("fcl_libccd",))[1]
        self.assertEqual(rates.finding.headline, "In 2D 3 of 4 methods never fail at 1e-12 of the size; fcl_libccd fails most "
                         "often, on box–box, box–sphere and 1 more: 8 of 96 (8.3%).")
        both = self.made(failing=("fcl_libccd", "libccd_mpr"), missing=[
            ("fcl_libccd", "sphere", "sphere"), ("libccd_mpr", "box", "sphere"), ("libccd_mpr", "sphere", "sphere")])[1]
        self.assertIn("fcl_libccd and libccd_mpr fail most often, on box–box and box–sphere: 8 of 96", both.finding.headline)
        table = rates.finding.table.set_index("method")
        self.assertEqual(list(table["queries of a pair"]), ["600", "600", "600", "96"])
        self.assertEqual(list(table["unseen share, at most"]), ["0.5%", "0.5%", "0.5%", ""])
        self.assertEqual(table.at["fcl_libccd", "failures there"], "8 of 96")
        labels = [label.get_text() for label in rates.figure.axes[0].get_yticklabels()]
        self.assertEqual(labels, ["closed_form, 600", "fcl_libccd (witness), 96", "gjk_epa, 600", "sat, 600"])

    @undrawn.drawn
    def test_what_is_not_asked_or_not_declared_has_its_word_in_the_legend(self):
        legend = lambda made: [text.get_text() for text in made.figure.legends[0].get_texts()]  # noqa: E731
        asked, blank = self.made()[1], self.made(missing=(("sat", "box", "box"),))[1]
        self.assertIn("no: not declared", legend(asked))
        self.assertNotIn("blank: not asked", legend(asked))
        self.assertIn("blank: not asked", legend(blank))

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
    """Times of the ledger have no repeats, so no noise floor is measured."""

    def rows(self, *of_methods):
        """`of_methods`: for each pair of shapes [(method, role, ns per question, share that failed)]."""
        return pd.DataFrame([{"pair": pair, "method": method, "role": role, "time": ns, "share": share, "max_error": 1e-16}
                             for pair, found in zip("abcdefg", of_methods) for method, role, ns, share in found])

    def finding(self, *of_methods):
        return ledger._cost_finding(self.rows(*of_methods), 3, "f64")

    def test_only_a_ratio_beyond_two_makes_a_method_the_fastest(self):
        ours = lambda sat, gjk: [("sat", "competitor", sat, 0.0), ("gjk_epa", "competitor", gjk, 0.0)]  # noqa: E731
        four = (ours(100, 150), ours(100, 250), ours(180, 100), ours(300, 100))
        found = self.finding(*four)
        self.assertEqual(found.headline, "In 3D, f64, of 4 pairs of shapes, gjk_epa is the fastest without a failure on 1 and "
                         "gjk_epa and sat are within 2 times the fastest on 2.")
        counts = lambda found: {row["method"]: row["fastest on"] for row in found.rows()}  # noqa: E731
        self.assertEqual(counts(found), {"gjk_epa": 1, "sat": 1})
        self.assertEqual([row["within 2 times the fastest on"] for row in found.rows()], [2, 2])
        with unittest.mock.patch.object(noise, "UNMEASURED", 1.0):
            self.assertEqual(counts(self.finding(*four)), {"gjk_epa": 2, "sat": 2}, "the planted bug: every difference counts")

    def test_without_a_single_fastest_the_methods_near_it_are_counted(self):
        three = lambda *ns: [(m, "competitor", n, 0.0) for m, n in zip(("by_kind", "sat", "gjk_epa"), ns)]  # noqa: E731
        self.assertEqual(self.finding(three(10, 11, 30), three(10, 12, 30), three(10, 30, 15)).headline,
                         "In 3D, f64, of 3 pairs of shapes, by_kind is within 2 times the fastest without a failure on 3 and sat "
                         "on 2.")

    def test_witnesses_compete_only_where_they_do_not_fail(self):
        fast = lambda share: [("sat", "competitor", 100, 0.0), ("gjk_epa", "competitor", 300, 0.0),  # noqa: E731
                              ("bullet", "witness", 20, share)]
        self.assertIn("bullet is the fastest without a failure on 1", self.finding(fast(0.0)).headline)
        found = self.finding(fast(0.1))
        self.assertIn("sat is the fastest without a failure on 1", found.headline)
        self.assertEqual([row["fails on some questions of"] for row in found.rows() if row["method"] == "bullet"], [1])

    def test_a_method_without_a_rival_is_not_called_the_fastest(self):
        self.assertEqual(self.finding([("gjk_epa", "competitor", 1, 0.0)]).headline,
                         "In 3D, f64, of 1 pair of shapes, gjk_epa alone has no failure on 1.")


if __name__ == "__main__":
    unittest.main()
