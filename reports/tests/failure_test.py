# SPDX-License-Identifier: Zlib
"""Tests of what a failure is: one definition, in the manual word for word, for ledgers and trials of pairs alike."""

import math
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402

import chart  # noqa: E402
import failure  # noqa: E402
import load  # noqa: E402
import metrics  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
from charts import pair_queries  # noqa: E402

MANUAL = HERE.parent.parent / "docs" / "manual.md"


def check_front(front_of):
    """Of the cheapest, which is wrong, of one that nothing beats and of one that nobody counted, the second alone stands."""
    front = front_of(np.array([1.0, 2.0, 0.5]), np.array([1e-17, 1e-16, 0.0]), np.array([3.0, 0.0, math.nan]))
    return "" if front == [1] else f"front {front}"


def front_of_all(cost, error, _failures):
    """Planted bug: what is fast and wrong stands on the front."""
    return metrics.pareto(cost, error)


class Failure(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = Path(cls.folder.name) / "store.db"
        synthetic_store.write(path, themes=(synthetic_store.queries, synthetic_store.ledger))
        cls.store = load.Store(path)
        cls.context = chart.Context(cls.store)

    @classmethod
    def tearDownClass(cls):
        cls.store.db.close()
        cls.folder.cleanup()

    def charts(self):
        return [c for c in chart.made(pair_queries, self.context)]

    def test_the_manual_defines_it_in_the_same_words(self):
        manual = " ".join(MANUAL.read_text(encoding="utf-8").split())
        self.assertTrue(failure.DEFINITION in manual, f"docs/manual.md lacks: {failure.DEFINITION}")

    def test_what_is_wrong_is_on_no_front(self):
        self.assertEqual(check_front(failure.front), "")
        self.assertNotEqual(check_front(front_of_all), "", "the planted bug was not seen")

    def test_ledgers_and_trials_count_the_same_ends(self):
        rows = self.store.ledger()
        part = rows[(rows["method"] == "fcl_indep") & (rows["axis"] == "all") & (rows["kind_a"] == "box")]
        ends = ("agree", "tie", "undecided")
        self.assertEqual(failure.in_ledger(part), int(part["asked"].sum() - sum(part[e].sum() for e in ends)))
        cells = self.store.cells("pair_queries").head(1).copy()
        for name in failure.OF_PAIRS:
            cells[[*failure.OF_PAIRS]] = 0.0
            self.assertEqual(failure.in_pairs(cells)[0], 0)
            cells[name] = 5.0
            self.assertEqual(failure.in_pairs(cells)[0], 5, name)

    def test_a_method_with_a_wrong_answer_is_in_no_list_of_those_without_a_failure(self):
        charts = self.charts()
        for made in charts:
            style.plt.close(made.figure)
        rates = next(c for c in charts if "failures_3d" in c.id)
        self.assertIn("without any failure: closed_form, gjk_epa and sat (", rates.finding)
        self.assertIn("at 1e-12 of the size", rates.finding)
        self.assertTrue(all(failure.DEFINITION in c.note for c in charts))
        wrong = rates.table[rates.table["method"] == "fcl"]
        self.assertTrue((wrong["wrong"] > 0).all() and (wrong["without an answer"] == 0).all())

    def test_a_store_that_does_not_count_wrong_answers_is_told(self):
        cells = self.store.cells("pair_queries").drop(columns="wrong")
        made = pair_queries.of_sweep(self.context, cells)
        self.assertEqual(len(made), 1)
        self.assertIn("do not count wrong answers", made[0].finding)


if __name__ == "__main__":
    unittest.main()
