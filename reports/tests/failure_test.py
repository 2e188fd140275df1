# SPDX-License-Identifier: Zlib
"""Tests of what a failure is: one definition, in the manual word for word, for ledgers and trials of pairs alike."""

import math
import sys
import tempfile
import unittest
import unittest.mock
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
import undrawn  # noqa: E402
from charts import measurements, tolerances  # noqa: E402
from charts.pair_queries import pair_queries  # noqa: E402

MANUAL = HERE.parent.parent / "docs" / "reference_results.md"


def check_front(front_of):
    """Of the cheapest, which is wrong, of one that nothing beats and of one that nobody counted, the second alone stands."""
    front = front_of(np.array([1.0, 2.0, 0.5]), np.array([1e-17, 1e-16, 0.0]), np.array([3.0, 0.0, math.nan]))
    return "" if front == [1] else f"front {front}"


def front_of_all(cost, error, _failures):
    """Planted bug: what is fast and wrong stands on the front."""
    return metrics.pareto(cost, error)


class Synthetic(undrawn.Undrawn):
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


class Failure(Synthetic):
    def test_a_method_has_one_role_in_the_ledger_and_in_legends(self):
        with unittest.mock.patch.object(self.store, "role", lambda label: "engine" if label == "fcl_libccd" else "competitor"):
            ledger = self.store.ledger()
        self.assertEqual(set(ledger["role"][ledger["method"] == "fcl_libccd"]), {"engine"})
        self.assertEqual(set(ledger["role"][ledger["method"] != "fcl_libccd"]), {"competitor", "witness"})

    def charts(self):
        return [c for c in chart.made(pair_queries, self.context)]

    def test_the_manual_defines_it_in_the_same_words(self):
        manual = " ".join(MANUAL.read_text(encoding="utf-8").split())
        self.assertTrue(failure.DEFINITION in manual, f"{MANUAL.name} lacks: {failure.DEFINITION}")

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

    @undrawn.drawn
    def test_a_method_with_a_wrong_answer_is_in_no_list_of_those_without_a_failure(self):
        charts = self.charts()
        for made in charts:
            style.plt.close(made.figure)
        rates = next(c for c in charts if "failures_3d" in c.id)
        found = rates.finding.table
        self.assertEqual(set(found["method"][found["failures there"] == "none"]), {"closed_form", "gjk_epa", "sat"})
        self.assertIn("3 of 5 methods never fail at 1e-12 of the size", rates.finding.headline)
        self.assertTrue(all(failure.DEFINITION in c.note for c in charts))
        self.assertEqual({"Pareto" in c.note for c in charts if "_error_" in c.id}, {True})
        self.assertEqual({"Pareto" in c.note for c in charts if "_failures_" in c.id}, {False}, "it has no front")
        wrong = rates.table[rates.table["method"] == "fcl"]
        self.assertTrue((wrong["wrong"] > 0).all() and (wrong["without an answer"] == 0).all())

    def test_a_store_that_does_not_count_wrong_answers_is_told(self):
        cells = self.store.cells("pair_queries").drop(columns="wrong")
        made = pair_queries.make(self.context, cells)
        self.assertEqual(len(made), 1)
        self.assertIn("do not count wrong answers", made[0].finding.headline)



def check_at_the_ledgers_tolerance(rows, outside):
    """At the referee's tolerance the failures are those of the ledger; a wider one never has more."""
    for _, row in rows.iterrows():
        part = rows.loc[[row.name]]
        found = [outside(part, decade) for decade in tolerances.DECADES]
        if outside(part, -12) != failure.in_ledger(part):
            return f"{row['method']}: {outside(part, -12)} at 1e-12, {failure.in_ledger(part)} in the ledger"
        if found != sorted(found, reverse=True):
            return f"{row['method']}: {found} is not falling"
    return ""


def answers_alone(rows, decade):
    """Planted bug: who crashes or refuses is right, because an answer that is none has no error."""
    return sum(n for h in rows["histogram"] for name, n in h.items() if name != "zero" and int(name) >= decade)


class WithinTolerance(Synthetic):
    def rows(self):
        rows = self.store.ledger()
        return rows[(rows["stage"] == "pair_query") & (rows["axis"] == "all")]

    def test_at_the_ledgers_tolerance_it_is_the_ledger(self):
        self.assertEqual(check_at_the_ledgers_tolerance(self.rows(), tolerances.outside), "")
        self.assertNotEqual(check_at_the_ledgers_tolerance(self.rows(), answers_alone), "", "the planted bug was not seen")

    def test_a_wrong_side_without_a_value_is_outside_at_every_tolerance(self):
        rows = self.rows().head(1).copy()
        rows["wrong"] = rows["wrong"] + 3
        self.assertEqual(tolerances.outside(rows, 0), tolerances.outside(self.rows().head(1), 0) + 3)

    def test_ranks_that_reverse_are_named(self):
        """One is always off by 1e-7; the other seldom, but by the whole size."""
        rows = self.rows().query("method in ('fcl_libccd', 'libccd_mpr') and dimension == 3").copy()
        for name in failure.UNANSWERED:
            rows[name] = 0
        often = rows["method"] == "fcl_libccd"
        rows["wrong"] = np.where(often, rows["asked"] * 7 // 10, rows["asked"] * 32 // 100)
        rows["histogram"] = [{"-14": n - w, "-7" if o else "-1": w} for n, w, o in zip(rows["asked"], rows["wrong"], often)]
        found, entry = tolerances.finding_of_right(rows, 3, "f64")
        self.assertEqual(found.headline, "In 3D, f64, fcl_libccd fails more often than libccd_mpr at 1e-12 of the size (70% "
                                         "against "
                         "32%), but less at 1e-3 (0 against 32%).")
        self.assertEqual(list(entry.values.values()), [0.7, 0.32, 0.0, 0.32])
        self.assertEqual(list(found.table["outcome"]), ["rank reverses"] * 2)
        apart = rows[often | (rows["kind_a"] == "box")]
        found, entry = tolerances.finding_of_right(apart, 3, "f64")
        self.assertIsNone(entry, "asked of other kinds")
        self.assertNotIn("rank reverses", list(found.table["outcome"]))
        self.assertIn("fcl_libccd fails most often", found.headline)
        tight = rows[often].assign(method="fcl_libccd{tolerance=1e-14}", wrong=0,
                                   histogram=[{"-15": n} for n in rows[often]["asked"]])
        found, _ = tolerances.finding_of_right(load.pd.concat([rows, tight], ignore_index=True), 3, "f64")
        row = found.table.set_index("method").loc["fcl_libccd{tolerance=1e-14} (witness)"]
        self.assertEqual((row["fails at 1e-12 [1]"], row["outcome"]), (0.0, "70% with default settings"))


def check_paths(agreements):
    """Two methods that end alike in three of four cells are one path; one that ends alike in one of four is another, and so
    is one that fell in all but one of the cells."""
    with tempfile.TemporaryDirectory() as folder:
        made = synthetic_store.Maker(Path(folder) / "s.db")
        ends = {"catto+none": "abcd", "catto+linear": "abce", "naive": "axyz", "millington": "a"}
        for label, letters in ends.items():
            for iterations, end in zip((4, 10, 40, 80), letters + "----"):
                axes = {"scene": "pyramid", "dimension": 2, "resolver": label, "iterations": iterations}
                key = made.trial("resolvers", {**axes, "timed": False, "repeat": 0}, {}, "diverged" if end == "-" else "ok")
                made.db.execute("UPDATE trial SET hash=? WHERE key=?", (end, key))
        made.close()
        store = load.Store(Path(folder) / "s.db")
        table = agreements(store, store.cells("resolvers"))
        store.db.close()
    found = measurements.paths(table)
    return "" if found == [["catto+linear", "catto+none"]] else f"paths {found}\n{table}", (
        measurements.finding_of_alike(table, {}))


def any_iterations(store, cells):
    """Planted bug: cells are not told apart by their setting, so the last one stands for all."""
    return measurements.agreements(store, cells.drop(columns="iterations").assign(outcome="ok"))


class Distinctness(undrawn.Undrawn):
    def test_methods_that_end_in_the_same_bits_are_one_path(self):
        wrong, text = check_paths(measurements.agreements)
        self.assertEqual(wrong, "")
        self.assertEqual(text.headline, "In resolvers catto+linear and catto+none are one path: they end in the same bits in 3 "
                         "of 4 common runs.")
        self.assertNotEqual(check_paths(any_iterations)[0], "", "the planted bug was not seen")


if __name__ == "__main__":
    unittest.main()
