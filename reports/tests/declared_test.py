# SPDX-License-Identifier: Zlib
"""Tests of the links from failed trials to the failures that their methods declare. Run by ctest, or
python3 reports/tests/declared_test.py."""

import json
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import coverage  # noqa: E402
import declared  # noqa: E402
import pages  # noqa: E402
import with_store  # noqa: E402

HEAVY = "a heavy body on a light one"


def entry(stage, name, *failures):
    return {"stage": stage, "group": "solver", "name": name, "role": "competitor", "dimensions": [2, 3], "failures": [
        {"when": when, "symptom": "one & all", "test": test, "dimensions": dimensions} for when, test, dimensions in failures]}


REGISTRY = [entry("velocity", "naive", (HEAVY, "Impulse.Carries", [2, 3]), (HEAVY, "Rest.Stays", [2, 3]),
                  ("cubes", "Rest.StackStays", [3])),
            entry("velocity", "catto", ("friction=box: a slide", "Symmetry.Moves", [2, 3])),
            entry("velocity", "nncg", (HEAVY, "Impulse.Carries", [2, 3])), entry("velocity", "direct_lcp")]


class Declared(with_store.WithStore):
    def fill(self, maker):
        maker.sweep("mine", resolver="label")
        maker.db.execute("UPDATE meta SET value=? WHERE key='registry'", (json.dumps({"algorithms": REGISTRY}),))
        for name, outcome in {"naive": "collapsed", "catto": "collapsed", "nncg": "ok", "direct_lcp": "collapsed"}.items():
            maker.trial("mine", {"kind": "world", "precision": "f64", "scene": "pair", "dimension": 2, "resolver": name}, {},
                        outcome, "drift" if outcome != "ok" else "", 7,
                        extra={"pipeline": f"solver=split_solver{{velocity={name}{{friction=cone}}}}"})

    def test_a_failed_trial_names_its_methods_that_declare_failures(self):
        bad = coverage.not_ok(coverage.trials(self.context(self.fill).store))
        self.assertEqual(list(bad[declared.COLUMN]), ["velocity naive", "", ""], "catto declares for friction=box only")

    def test_the_section_has_each_failure_once_with_all_its_tests(self):
        store = self.context(self.fill).store
        found = declared.section(store, coverage.not_ok(coverage.trials(store)))
        self.assertEqual([method["name"] for method in found], ["velocity naive"])
        self.assertEqual(found[0]["failures"], [
            {"when": HEAVY, "symptom": "one & all", "where": "", "tests": "Impulse.Carries, Rest.Stays"},
            {"when": "cubes", "symptom": "one & all", "where": "3D", "tests": "Rest.StackStays"}])

    def test_the_page_links_a_failed_trial_to_them(self):
        context = self.context(self.fill)
        with tempfile.TemporaryDirectory() as folder:
            page = pages.write(context, [], Path(folder), "store.db", folder).read_text(encoding="utf-8")
            self.assertIn("velocity naive", (Path(folder) / "tables" / "not_ok.csv").read_text(encoding="utf-8"))
        self.assertEqual(page.count('<a href="#declared-velocity-naive">velocity naive</a>'), 1)
        self.assertEqual(page.count('<h3 id="declared-velocity-naive">'), 1)
        self.assertIn("one &amp; all", page)
        self.assertNotIn("nncg", page, "it has not failed")


if __name__ == "__main__":
    unittest.main()
