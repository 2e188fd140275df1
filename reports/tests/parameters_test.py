# SPDX-License-Identifier: Zlib
"""Tests of what hangs on parameters: ratios over the defaults that are known. Run by ctest, or
python3 reports/tests/parameters_test.py [PICTURE.png]."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import broadphase  # noqa: E402
from charts.broadphase import parameters  # noqa: E402
from with_store import row  # noqa: E402

TIMES = {"grid": 100, "grid{cell=1}": 50, "grid{cell=8}": 400, "tree": 200, "tree{depth=4}": 204}


class Parameters(with_store.WithStore):
    @staticmethod
    def boxes(of=None, repeats=4, noisy=0.02, hung=(), report=("parameters",)):
        def fill(maker):
            maker.sweep("broadphase_parameters", "boxes", broadphase="stage", report=list(report))
            for distribution in ("uniform", "cluster"):
                for method, ns in (of or TIMES).items():
                    for repeat in range(repeats):
                        axes = {"kind": "boxes", "dimension": 2, "distribution": distribution, "broadphase": method, "n": 1000,
                                "precision": "f64", "timed": True, "repeat": repeat}
                        failed = method in hung
                        maker.trial("broadphase_parameters", axes, {} if failed else {
                            "ns_per_frame_median": ns * 1e3 * (1 + noisy * (repeat % 2))},
                            *(("timeout", "long") if failed else ("ok",)))
        return fill

    def one(self, **about):
        found = self.made(parameters, self.boxes(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_gains_and_losses(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "On uniform boxes, 2D grid{cell=8} takes 4.0 times the time of grid with its "
                                                "defaults, the largest effect of a parameter.")
        self.assertEqual(made.headline.text, made.finding.headline)
        found = row(made, "grid")
        self.assertEqual((found["fastest"], found["times the defaults"], found["on"]), ("grid{cell=1}", "0.5", "uniform boxes, "
                                                                                                               "2D"))
        self.assertEqual((found["slowest"], found["times the defaults, slowest"]), ("grid{cell=8}", "4"))
        self.assertEqual(found["faster on all boxes"], "grid{cell=1}")
        self.assertEqual(row(made, "tree")["fastest"], "all within the noise")
        self.assertEqual(list(made.table["over its defaults [1]"].dropna())[:2], [0.5, 4.0])

    def test_the_planted_bug_noise_is_no_gain(self):
        about = {"of": {"grid": 100, "grid{cell=1}": 90}, "noisy": 0.4}
        self.assertEqual(row(self.one(**about), "grid")["fastest"], "all within the noise")
        self.assertIn("no parameter changes the time", self.one(**about).finding.headline)
        real, broadphase.noise.tells = broadphase.noise.tells, lambda a, b, metric, least: True
        try:
            self.assertEqual(row(self.one(**about), "grid")["fastest"], "grid{cell=1}")
        finally:
            broadphase.noise.tells = real

    def test_a_lower_median_within_the_noise_is_told_where_the_picture_shows_it(self):
        rows = [{"panel": "here", "family": "tree", "method": f"tree{{{m}}}", "ratio": ratio, "told": told} for m, ratio, told in
                (("a", 0.7, True), ("b", 0.6, False), ("c", 0.5, True), ("d", 1.2, False))]
        self.assertEqual(broadphase._noise(rows, rows[0], -1), ["tree{b}"])
        self.assertEqual(broadphase._noise(rows, rows[2], -1), [])
        made = broadphase.found_parameters(rows[:2], 1, "boxes", 1.1)
        self.assertEqual(made.table["farther off, but noise"].tolist(), ["tree{b}"])

    def test_what_failed_is_told(self):
        made = self.one(hung=("grid{cell=8}",))
        self.assertIn("timeout (long)", " ".join(made.holes))
        self.assertNotIn("cell=8", made.finding.text())

    def test_only_where_a_sweep_asks(self):
        self.assertEqual(self.made(parameters, synthetic_store.broadphase), [parameters.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
