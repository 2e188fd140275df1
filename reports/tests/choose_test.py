# SPDX-License-Identifier: Zlib
"""Tests of the chart that says what to take: the fastest of those that are right, ties, and other libraries never. Run by ctest,
or python3 reports/tests/choose_test.py."""

import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
from charts import choose  # noqa: E402

# method: ms per step, error (m), outcome
RESOLVERS = {"naive": (0.3, 0.05, "ok"), "millington": (0.2, 0.001, "collapsed"), "catto+none": (1.0, 0.0011, "ok"),
             "catto+linear": (2.0, 0.001, "ok"), "soft_step": (4.0, 0.002, "ok"), "box2d": (0.5, 0.001, "ok")}
BROADPHASES = {"naive": 3.0, "sort_and_sweep": 1.0, "region_tree": 1.01}
NEAR = {**RESOLVERS, "box2d": (1.01, 0.001, "ok")}


class Choose(unittest.TestCase):
    def made(self, resolvers=RESOLVERS):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        place = {"scene": "mixed_pile", "dimension": 2, "n": 50}
        maker.sweep("choose_broadphase", "world", "", broadphase="stage", n="parameter", report=["choose"])
        for label, ms in BROADPHASES.items():
            maker.world("choose_broadphase", {**place, "broadphase": label}, ms, 1e-3, repeats=9)
        maker.sweep("choose_resolver", "world", "", resolver="label", n="parameter", report=["choose"])
        for label, (ms, error, outcome) in resolvers.items():
            maker.world("choose_resolver", {**place, "resolver": label}, ms, error, outcome, "it fell" if outcome != "ok" else "",
                        repeats=9)
        maker.close()
        context = chart.Context(load.Store(Path(folder.name) / "store.db"))
        made = [c for c in make.all_charts(context) if c.section == choose.SECTION]
        self.addCleanup(style.plt.close, "all")
        return context, made

    def verdicts(self, table, stage):
        return {row["method"]: row["verdict"] for _, row in table[table["stage"] == stage].iterrows() if row["verdict"]}

    def test_one_chart_takes_the_fastest_of_those_that_are_right(self):
        _, made = self.made()
        self.assertEqual([c.id for c in made], ["choose_mixed_pile__2d__n_50"])
        self.assertEqual(self.verdicts(made[0].table, "resolver"), {"catto+none": "take"})
        self.assertIn("resolver catto+none (", made[0].finding)
        self.assertIn("of other libraries box2d, 0.5 times", made[0].finding)
        self.assertIn("millington: collapsed (it fell)", " ".join(made[0].holes))
        self.assertEqual(overlap.overlaps(made[0].figure), ([], []))
        # The planted bug would take whoever is fastest, however wrong.
        _, wrong = self.made({**RESOLVERS, "naive": (0.3, 0.001, "ok")})
        self.assertEqual(self.verdicts(wrong[0].table, "resolver"), {"naive": "take"}, "the planted bug was not seen")

    def test_ranges_of_repeats_that_meet_are_ties(self):
        _, made = self.made()
        found = self.verdicts(made[0].table, "broadphase")
        self.assertEqual(sorted(found.values()), ["take", "tie"])
        self.assertEqual(set(found), {"sort_and_sweep", "region_tree"})
        self.assertIn("as fast within the noise", made[0].finding)

    def test_no_ratio_is_told_within_the_noise(self):
        _, made = self.made(NEAR)
        self.assertIn("of other libraries box2d, as fast within the noise", made[0].finding)

    def test_nobody_who_finished_is_no_error(self):
        _, made = self.made({"catto+none": (1.0, 1e-3, "collapsed"), "soft_step": (1.0, 1e-3, "collapsed")})
        self.assertIn("resolver: nobody finished with a time", made[0].finding)


if __name__ == "__main__":
    unittest.main()
