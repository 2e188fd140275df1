# SPDX-License-Identifier: Zlib
"""Tests of the chart of LPC and packaged libraries: a failing library is never the comparison, and no lead inside the noise. Run
by ctest, or python3 reports/tests/peers_test.py."""

import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import noise  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import pair_queries  # noqa: E402
from charts.pair_queries import peers  # noqa: E402

# Of each pair: {method: (ns a query, failures of 96)}.
CALLS = {("box", "box"): {"sat": (100, 0), "closed_form": (50, 3), "libccd_mpr": (210, 0), "fcl": (40, 5)},
         ("box", "sphere"): {"sat": (100, 0), "fcl": (101, 0)},
         ("sphere", "sphere"): {"sat": (100, 0), "fcl": (20, 96)},
         ("capsule", "box"): {"libccd_mpr": (10, 0)}}


def fill(maker, precisions=("f64",), asked=96):
    maker.sweep("pair_queries", "pairs", pair_query="stage")
    cells = [(pair, method, call, precision) for pair, calls in CALLS.items() for method, call in calls.items()
             for precision in precisions if precision == "f64" or method == "sat"]
    for (a, b), method, (ns, wrong), precision in cells:
        ns = ns / 10 if precision == "f32" else ns
        for repeat in range(5):
            axes = {"kind": "pairs", "dimension": 3, "pair_query": method, "kind_a": a, "kind_b": b, "precision": precision,
                    "timed": True, "repeat": repeat}
            maker.trial("pair_queries", axes, {"ns_single": ns * (1 + 0.02 * (repeat % 2)), "median_error": 0.0,
                                               "p99_error": 0.0, "max_error": 0.5 if wrong else 1e-16, "failed": 0,
                                               "refused": 0, "wrong_boolean": 0, "wrong": wrong, "asked": asked},
                        "wrong" if wrong else "ok")


class Peers(with_store.WithStore):
    def one(self, **kwargs):
        found = self.made(peers, lambda maker: fill(maker, **kwargs))
        self.assertEqual(len(found), 1)
        return found[0]

    @staticmethod
    def counts(made):
        return dict(zip(made.finding.table["outcome"], made.finding.table["questions"]))

    @undrawn.drawn
    def test_a_failing_library_is_not_the_comparison(self):
        made = self.one()
        self.assertEqual(made.finding.headline, "Against the fastest library without failures LPC is faster on 1 of 3 questions, "
                         "slower on 0, tied on 1; on 1 every library fails.")
        self.assertEqual(self.counts(made), {"LPC faster": 1, "tie: inside the noise": 1, "every library fails, one is "
                                                                                          "faster": 1})
        ahead = made.finding.table.set_index("outcome").loc["LPC faster"]
        self.assertAlmostEqual(ahead["most [1]"], 2.1)
        self.assertEqual((ahead["largest difference on"], ahead["LPC's method"], ahead["library"]),
                         ("box–box, 3D", "sat", "libccd_mpr"))
        self.assertEqual(made.headline.text, "On box–box, 3D, libccd_mpr takes 2.1 times as long as sat; neither fails.")
        row = made.table[(made.table["question"] == "box–box, 3D") & (made.table["library"] == "fcl")].iloc[0]
        self.assertEqual((row["LPC's method"], row["failures [1]"]), ("sat", 5))  # closed_form is faster, and fails
        self.assertAlmostEqual(row["ratio [1]"], 0.4, places=1)
        hollow = [line for line in made.figure.axes[0].lines if line.get_markerfacecolor() == "none"]
        self.assertEqual(len(hollow), 2)
        with unittest.mock.patch.object(pair_queries, "right", lambda row: row["peers"][0]):
            self.assertEqual(self.counts(self.one())["LPC slower"], 2, "the planted bug: the fastest library counts as right")

    def test_no_lead_inside_the_noise(self):
        with unittest.mock.patch.object(noise, "tells", lambda a, b, metric, least: True):
            self.assertEqual(self.counts(self.one())["LPC faster"], 2, "the planted bug: every difference counts")

    def test_another_precision_is_another_question(self):
        self.assertEqual(self.counts(self.one(precisions=("f64", "f32"))), self.counts(self.one()),
                         "a fast f32 method would count as LPC's, and libraries answer in f64")

    def test_a_cell_without_queries_is_no_row(self):
        self.assertEqual([chart.figure for chart in self.made(peers, lambda maker: fill(maker, asked=0))], [None])


if __name__ == "__main__":
    unittest.main()
