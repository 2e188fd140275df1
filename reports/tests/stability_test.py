# SPDX-License-Identifier: Zlib
"""Tests of the outcome of scenes: which method holds which runs. Run by ctest, or
python3 reports/tests/stability_test.py [PICTURE.png]."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import standing  # noqa: E402
from charts.standing import stability  # noqa: E402

# (scene, sleeping, method): outcome, step; all others are ok
FALLS = {("preset_5", "none", "stupid"): ("exploded", 61), ("preset_5", "on", "stupid"): ("exploded", 61),
         ("preset_6", "none", "stupid"): ("collapsed", 52), ("preset_6", "on", "stupid"): ("collapsed", 52),
         ("preset_6", "on", "catto+baumgarte"): ("collapsed", 91)}
METHODS = ("stupid", "catto+baumgarte", "soft_step")


class Stability(with_store.WithStore):
    @staticmethod
    def presets(falls=None, report=("stability",)):
        def fill(maker):
            maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                             ("metric", "rest_since", "world", "time to rest", "s", "invented", "detail", "sooner", ""))
            maker.sweep("heritage_stability", "world", resolver="label", report=list(report))
            for scene in ("preset_5", "preset_6"):
                for sleeping in ("none", "on"):
                    for method in METHODS:
                        outcome, step = (FALLS if falls is None else falls).get((scene, sleeping, method), ("ok", None))
                        maker.trial("heritage_stability", {"kind": "world", "scene": scene, "dimension": 2, "sleeping": sleeping,
                                                           "resolver": method, "precision": "f64", "timed": False, "repeat": 0},
                                    {"rest_since": 1.25 if method == "soft_step" else float("nan")}, outcome,
                                    "" if step is None else "too far", step)
        return fill

    def one(self, **about):
        found = self.made(stability, self.presets(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_methods_have_the_runs_that_they_hold(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "In 2D soft_step holds 4 of 4 and stupid holds 0 of 4 runs.")
        self.assertEqual([tuple(row.values()) for row in made.finding.rows()], [
            ("soft_step", 4, 4, ""), ("catto+baumgarte", 3, 4, "preset_6, sleeping=on"), ("stupid", 0, 4, "all")])
        drawn = [text.get_text() for text in made.figure.axes[0].texts]
        for told, times in (("exploded, 61", 2), ("collapsed, 52", 2), ("collapsed, 91", 1), ("rests, 1.2 s", 4),
                            ("ok, moves", 3)):
            self.assertEqual(drawn.count(told), times, told)
        self.assertEqual(made.headline.values, {"catto+baumgarte": 3.0, "soft_step": 4.0, "stupid": 0.0})
        self.assertIn("preset_6, sleeping=on: collapsed at step 91 (too far)", " ".join(made.holes))

    def test_the_planted_bug_a_fall_that_counts_as_held(self):
        real, standing.finding_of_stability = standing.finding_of_stability, lambda rows, *more: real(
            [{**row, "outcome": "ok"} for row in rows], *more)
        try:
            self.assertEqual(with_store.row(self.one(), "stupid")["runs held"], "4")
        finally:
            standing.finding_of_stability = real
        self.assertEqual(with_store.row(self.one(), "stupid")["runs held"], "0")

    def test_if_all_hold_the_same_there_is_no_headline(self):
        self.assertIsNone(self.one(falls={}).headline)

    def test_only_where_a_sweep_asks(self):
        self.assertEqual(self.made(stability, synthetic_store.resolvers), [stability.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
