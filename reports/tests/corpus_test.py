# SPDX-License-Identifier: Zlib
"""Tests of the chart of published hard cases: each method has every case of the file, under what became of it. Run by ctest, or
python3 reports/tests/corpus_test.py."""

import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import corpus  # noqa: E402
from with_store import row  # noqa: E402

# Four cases: a pair in 2D, two in 3D, a hull, a time of impact. `solid` exists in 3D alone.
TABLE = """id,method,verdict,value,expected,error,reason
flat,referee,ok,1,1,0,""
flat,sat,ok,1,1,0,""
flat,closed_form,refused,,,,"unsupported_shape"
deep,referee,ok,1,1,0,""
deep,sat,wrong,1,1,0,""
deep,closed_form,refused,,,,"declared, yet status refused"
deep,solid,ok,1,1,0,""
thin,sat,ok,1,1,0,""
thin,closed_form,ok,1,1,0,""
thin,solid,hang,,,,"no answer in time"
hull,convex_hull,ok,1,1,0,""
impact,-,refused,,,,"unsupported_query"
"""


def check_accounts(rows, counts_of):
    """Every method has each case of the file once."""
    table, cases = counts_of(rows), rows["id"].nunique()
    for _, found in table.iterrows():
        if found[list(corpus.ENDS)].sum() != cases:
            return f"{found['method']}: {found[list(corpus.ENDS)].sum()} of {cases} cases"
    return ""


def asked_alone(rows):
    """Planted bug: what a method was not asked is in no column."""
    return corpus.counts(rows[~rows["end"].isin(("dimension", "query"))])


class Corpus(undrawn.Undrawn):
    def made(self, table=TABLE, theme=None):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        names = synthetic_store.registered("pair_query", ["closed_form", "sat"])
        names += synthetic_store.registered("pair_query", ["solid"], "witness")
        maker = synthetic_store.Maker(Path(folder.name) / "s.db", **({} if theme else {"algorithms": names}))
        if theme:
            theme(maker)
        else:
            for name, value in (("corpus", table), ("corpus_file", "cases.json")):
                maker.db.execute("INSERT INTO meta VALUES (?, ?)", (name, value))
        maker.close()
        store = load.Store(Path(folder.name) / "s.db")
        found = corpus.corpus.make(chart.Context(store))[0]
        if self.draws:
            self.assertEqual(overlap.overlaps(found.figure), ([], []))
        return store, found

    @undrawn.drawn
    def test_every_method_has_every_case_of_the_file(self):
        rows = corpus.read(self.made()[0])
        self.assertEqual(check_accounts(rows, corpus.counts), "")
        self.assertNotEqual(check_accounts(rows, asked_alone), "", "the planted bug was not seen")

    def test_what_was_not_asked_has_its_reason(self):
        store, made = self.made()
        told = made.table.set_index("id")
        self.assertEqual(told["sat"].to_dict(), {"deep": "wrong", "thin": "ok", "flat": "ok", "hull": "query", "impact": "query"})
        self.assertEqual(told["solid"]["flat"], "dimension")
        self.assertEqual(told["convex_hull"].to_dict(), {"deep": "query", "thin": "query", "flat": "query", "hull": "ok",
                                                         "impact": "query"})
        self.assertIn("adds up to the 5 cases of cases.json, which ask for 3 the distance of a pair", made.note)
        self.assertIn("1 a convex hull", made.note)
        self.assertIn("1 a query without a method", made.note)

    def test_refusing_a_shape_that_is_not_declared_is_no_failure_and_refusing_another_is(self):
        store, made = self.made()
        told = made.table.set_index("id")["closed_form"]
        self.assertEqual((told["flat"], told["deep"]), ("undeclared", "failed"))
        self.assertEqual(made.finding.headline, "Of 5 published cases closed_form and sat fail, closed_form on 1 of 2; solid "
                                                "fails on "
                         "1 of 2, the most of 1 witness.")
        declared = {name: row(made, name)["cases declared"] for name in ("closed_form", "sat", "solid", "convex_hull")}
        self.assertEqual({name: row(made, name)["role"] for name in ("sat", "solid")}, {"sat": "LPC", "solid": "witness"})
        self.assertEqual(declared, {"closed_form": "2", "sat": "3", "solid": "2", "convex_hull": "1"})
        self.assertEqual({name: row(made, name)["failed"] for name in declared}, {"closed_form": "1", "sat": "1", "solid": "1",
                                                                                  "convex_hull": "0"})
        self.assertIn("The last three columns are no failures. At the right undeclared shapes are blue, cases of another "
                      "dimension or query grey", made.note)
        self.assertEqual(made.headline.values, {"closed_form": 1, "convex_hull": 0, "sat": 1, "solid": 1})

    def test_of_many_witnesses_the_worst_is_named_with_what_it_declares(self):
        store, made = self.made(theme=synthetic_store.corpus)
        self.assertEqual(len(made.table), 60)
        self.assertEqual(made.finding.headline, "Of 60 published cases our methods fail on none that they declare; fcl_libccd "
                                                "fails "
                         "on 12 of 56, the most of 8 witnesses.")


if __name__ == "__main__":
    unittest.main()
