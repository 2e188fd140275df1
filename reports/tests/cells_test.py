# SPDX-License-Identifier: Zlib
"""Tests of what a cell is made of: whose a method is, which seeds and repeats its time is of. Run by ctest, or
python3 reports/tests/cells_test.py. Every check that guards a promise is seen to fail on a planted bug."""

import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import measured  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import with_store  # noqa: E402
from charts import cost_against_error  # noqa: E402
from charts.step_times import step_times  # noqa: E402

COST = "ms_per_step_median"
ENGINE = {"precision": "f32", "engine": {"name": "box2d", "differs": "a skin of 1 cm"}, "pipeline": "engine=box2d{iterations=10}"}


def by_label(store, label):
    """Planted bug: the beginning of a label, which is free text, says whose the method is."""
    return next((entry["role"] for entry in store.algorithms if entry["name"] == load.family(label)), "competitor")


class Cells(unittest.TestCase):
    def context(self, fill, **kwargs):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        maker = synthetic_store.Maker(Path(folder.name) / "store.db", **kwargs)
        fill(maker)
        maker.close()
        return chart.Context(load.Store(Path(folder.name) / "store.db"))

    def test_a_method_is_whose_its_pipeline_is_whatever_it_is_called(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label")
            for label, ms, extra in (("catto", 1.0, {"pipeline": "solver=split_solver{velocity=catto}"}), ("erin", 0.3, ENGINE),
                                     ("mine", 2.0, {"pipeline": "broadphase=fcl_tree{leaf=1} solver=soft_step"})):
                maker.world("costs", {"scene": "stack", "dimension": 2, "resolver": label}, ms, 1e-3, extra=extra)
        context = self.context(fill, algorithms=synthetic_store.registered("broadphase", ["fcl_tree"], "witness") +
                               synthetic_store.registered("velocity", ["catto"]) +
                               synthetic_store.registered("engine", ["box2d"], "engine"))
        self.assertEqual([context.store.role(label) for label in ("catto", "erin", "mine")], ["competitor", "engine", "witness"])
        self.assertIn("erin is a whole engine, here in f32: a skin of 1 cm", 
                      chart.made(cost_against_error.cost_against_error, context)[0].note)
        erin = lambda: with_store.row(chart.made(step_times, context)[0], "erin")["against the best"]  # noqa: E731
        self.assertRegex(erin(), r"^engine in f32: median 30\d µs$")
        with unittest.mock.patch.object(cost_against_error.metrics, "pareto", wraps=cost_against_error.metrics.pareto) as front:
            chart.made(cost_against_error.cost_against_error, context)
        ranked = [sum(error == error for error in call.args[1]) for call in front.call_args_list]
        self.assertEqual(set(ranked), {2}, "the front is of catto and mine; erin is f32 among f64")
        with unittest.mock.patch.object(load.Store, "role", by_label):
            self.assertNotIn("engine", erin(), "the planted bug was not seen")

    def test_a_label_of_several_stages_has_all_their_roles(self):
        context = self.context(lambda maker: None)
        for label, role in (("catto+linear / box2d", "engine"), ("sat / fcl", "witness"), ("fcl / sat", "witness"),
                            ("sat / naive", "competitor"), ("unheard of", "competitor")):
            self.assertEqual(context.store.role(label), role, label)

    def test_times_are_of_the_seeds_that_are_ok_as_errors_are(self):
        def fill(maker):
            for seed, ms, outcome in ((1, 1.0, "ok"), (2, 50.0, "exploded"), (3, 50.0, "exploded")):
                for timed in (False, True):
                    axes = {"kind": "world", "scene": "s", "resolver": "a", "seed": seed, "timed": timed, "repeat": 0}
                    maker.trial("seeds", axes, {COST: ms, "max_penetration": ms / 1000}, outcome)
        cell = self.context(fill).store.cells("seeds").iloc[0]
        self.assertEqual((cell[COST], cell["max_penetration"], cell["failed_seeds"]), (1.0, 1e-3, 2))
        with unittest.mock.patch.object(load, "over_seeds", lambda repeats, bad: load_over_all(repeats)):
            self.assertEqual(self.context(fill).store.cells("seeds").iloc[0][COST], 50.0, "the planted bug was not seen")

    def test_all_runs_of_a_cell_are_of_the_same_seeds(self):
        repeats = {repeat: {1: 1.0, 2: 10.0} if repeat < 3 else {2: 10.0} for repeat in range(5)}
        self.assertEqual(load.over_seeds(repeats, set()), [5.5] * 3, "whiskers would measure seeds, not noise")
        self.assertEqual(load.over_seeds(repeats, {1}), [10.0] * 5)
        self.assertEqual(load.over_seeds(repeats, {1, 2}), [5.5] * 3, "where all fail their times stand")
        self.assertEqual(load.over_seeds({0: {1: 1.0}, 1: {2: 9.0}, 2: {1: 1.1}}, set()), [1.0, 1.1])
        self.assertEqual(load.over_seeds({}, set()), [])

    def test_repeats_on_a_second_machine_are_told(self):
        def fill(maker):
            maker.second_machine()
            maker.sweep("costs", "world", resolver="label")
            for repeat in range(5):
                axes = {"kind": "world", "scene": "s", "resolver": "a", "timed": True, "repeat": repeat}
                maker.trial("costs", axes, {COST: 1.0}, machine=1 if repeat < 3 else 2)
        context = self.context(fill)
        cells, said = load.one_machine(context.store, context.store.cells("costs"))
        self.assertEqual(len(measured.runs(cells.iloc[0], COST)), 3)
        self.assertEqual(said, ["a: 2 timed trials on another machine are left out"])


def load_over_all(repeats):
    """Planted bug: times of seeds that failed stand beside errors of those that did not."""
    return [sorted(of_seed.values())[len(of_seed) // 2] for of_seed in repeats.values()]


if __name__ == "__main__":
    unittest.main()
