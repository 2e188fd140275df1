# SPDX-License-Identifier: Zlib
"""Tests of the report: which charts a sweep gets, and by which colours and markers methods are told apart. Run by ctest, or
python3 reports/tests/choosing_test.py. Every check that guards a promise is seen to fail on a planted bug."""

import itertools
import random
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import cost_against_error  # noqa: E402


def check_looks(looks, labels):
    """No two methods look alike, and a family has one colour."""
    seen, families = {}, {}
    for label in labels:
        look = (looks(label)["color"], looks(label)["marker"])
        if look in seen:
            return f"{label} looks like {seen[look]}"
        seen[look] = label
        if families.setdefault(load.family(label), look[0]) != look[0]:
            return f"{label} has not the colour of its family"
    return ""


class MarkerOfTheMemberAlone(style.Looks):
    """Planted bug: colours by position in the palette, and the marker knows nothing of other families."""

    def __init__(self, store, registered, labels):
        super().__init__(store, registered, labels)
        places = sorted(self.families)
        self.looks = {label: (style.PALETTE[places.index(load.family(label)) % 6], style.MARKERS[self.shifts.get(
            self._member(label), 0) % len(style.MARKERS)]) for label in labels}


class LooksOfMethods(unittest.TestCase):
    def store(self, themes, **kwargs):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        synthetic_store.write(Path(folder.name) / "store.db", themes=themes, **kwargs)
        return load.Store(Path(folder.name) / "store.db")

    def test_forty_methods_are_told_apart(self):
        for algorithms in (synthetic_store.forty_algorithms(), []):  # also where the registry names none of them
            store = self.store((synthetic_store.forty,), algorithms=algorithms)
            looks = chart.Context(store).looks(store.cells("forty"))
            self.assertEqual(len(set(synthetic_store.FORTY)), 40)
            self.assertEqual(check_looks(looks, synthetic_store.FORTY), "")
            bad = MarkerOfTheMemberAlone(store, algorithms, synthetic_store.FORTY)
            self.assertNotEqual(check_looks(bad, synthetic_store.FORTY), "", "the planted bug was not seen")

    def test_forty_families_are_told_apart_too(self):
        labels = [f"method_{i}" for i in range(40)]
        self.assertEqual(check_looks(style.Looks(self.store(()), [], labels), labels), "")

    def test_more_members_than_markers(self):
        labels = [f"catto member {i}" for i in range(2 * len(style.MARKERS) - 1)]  # and the family itself
        looks = style.Looks(self.store(()), [], labels)
        self.assertEqual(len({(looks(label)["color"], looks(label)["marker"]) for label in labels}), len(labels))
        self.assertEqual(len({looks(label)["color"] for label in labels}), 2)

    def test_a_look_does_not_depend_on_the_others_in_the_store(self):
        algorithms = synthetic_store.forty_algorithms()
        everyone = style.Looks(self.store(()), algorithms, synthetic_store.FORTY)
        source = random.Random(3)
        for _ in range(20):
            some = source.sample(synthetic_store.FORTY, 7)
            alone = style.Looks(everyone.store, algorithms, some)
            self.assertEqual([alone(label) for label in some], [everyone(label) for label in some])
        # The planted bug counts places among those that are drawn.
        some = synthetic_store.FORTY[20:]
        bad, all_bad = (MarkerOfTheMemberAlone(everyone.store, [], labels) for labels in (some, synthetic_store.FORTY))
        self.assertNotEqual([bad(label) for label in some], [all_bad(label) for label in some], "the planted bug was not seen")

    def test_the_families_of_today_differ_in_colour(self):
        store = self.store(synthetic_store.THEMES)
        context = chart.Context(store)
        for sweep in ("broadphase_crossover", "resolvers", "pair_queries"):
            cells = store.cells(sweep)
            families = {load.family(label): context.looks(cells)(label)["color"] for label in cells["method"]}
            self.assertEqual(len(set(families.values())), len(families), sweep)
        witness = context.looks_of_stage("pair_query")("fcl_libccd")
        self.assertEqual(witness["markerfacecolor"], "white", "a witness is hollow")


FIRST_SWEEP = [{"scene": "leaning_stack", "n": n, "iterations": i, "resolver": label}
               for n in (5, 10, 20) for i in (4, 10, 30) for label in ("catto", "soft_step")]


class Choosing(undrawn.Undrawn):
    def made(self, fill):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        fill(maker)
        maker.close()
        made = make.all_charts(chart.Context(load.Store(Path(folder.name) / "store.db")))
        self.addCleanup(style.plt.close, "all")
        return {c.id: c for c in made if c.figure is not None}

    def test_the_first_sweep_of_the_manual_has_its_charts(self):
        def fill(maker):
            maker.sweep("friction", "world", "", resolver="label", iterations="setting", n="parameter")
            for axes in FIRST_SWEEP:
                maker.world("friction", {"dimension": 2, **axes}, axes["iterations"] / 10, 1e-3 / axes["iterations"])
        made = self.made(fill)
        of_each = [f"friction_{kind}leaning_stack__2d__n_{n}" for kind in ("", "budgets_") for n in (5, 10, 20)]
        self.assertEqual(sorted(made), sorted(["coverage", "friction_energy_2d", "friction_raised_2d", "friction_residual_2d",
                                               "friction_steadiness_2d", "friction_step_times_2d", "noise", *of_each]))

    def test_a_method_is_named_by_every_stage_that_varies(self):
        def fill(maker, cache=("by_feature",)):
            maker.sweep("mine", "world", "naive", broadphase="stage", cache="stage", contacts="stage", sleep="stage")
            broadphases = ("naive", "region_tree", "uniform_grid")
            for contacts, broadphase, kept in itertools.product(("query_clip", "sat_clip"), broadphases, cache):
                maker.world("mine", {"scene": "vertical_stack", "dimension": 2, "contacts": contacts, "broadphase": broadphase,
                                     "cache": kept, "sleep": "none"}, 1, 1e-3 if contacts == "sat_clip" else 2e-3)
        made = self.made(fill)
        self.assertEqual(sorted(made), ["coverage", "mine_energy_2d", "mine_steadiness_2d", "mine_step_times_2d",
                                        "mine_vertical_stack__2d", "noise"], "one chart, not six")
        self.assertEqual(list(made["mine_vertical_stack__2d"].table["method"]), [
            f"{b} / {c}" for b in ("naive", "region_tree", "uniform_grid") for c in ("query_clip", "sat_clip")])
        self.assertIn("identical work", made["mine_vertical_stack__2d"].finding.text())
        three = self.made(lambda maker: fill(maker, ("by_feature", "none")))["mine_vertical_stack__2d"].table
        self.assertIn("region_tree / by_feature / sat_clip", list(three["method"]), "what has most values comes first")

    def test_a_sweep_may_say_which_charts_it_is_for(self):
        def fill(maker, **what):
            maker.sweep("mine", "world", "", resolver="label", iterations="setting", **what)
            for i, label in itertools.product((4, 10), ("catto", "naive", "soft_step")):
                maker.world("mine", {"scene": "pyramid", "dimension": 2, "resolver": label, "iterations": i}, i, 1e-3)
        self.assertEqual(sorted(self.made(fill)), ["coverage", "mine_budgets_pyramid__2d", "mine_energy_2d", "mine_pyramid__2d",
                                                   "mine_residual_2d", "mine_steadiness_2d", "mine_step_times_2d", "noise"])
        only = self.made(lambda maker: fill(maker, report=["steadiness"]))
        self.assertEqual(sorted(only), ["coverage", "mine_steadiness_2d", "noise"])
        with tempfile.TemporaryDirectory() as folder:
            maker = synthetic_store.Maker(Path(folder) / "store.db")
            fill(maker, report=["cost_against_error", "broadphase"])
            maker.close()
            told = {c.id: c for c in make.all_charts(chart.Context(load.Store(Path(folder) / "store.db")))}
        self.assertIn("mine_pyramid__2d", told)
        self.assertEqual(told["mine_broadphase"].finding.headline,
                         "The `report` of mine lists this chart, but the sweep lacks its data.")
        self.assertEqual(told["mine_broadphase"].holes, ["The chart needs trials of kind boxes, several values of n and "
                                                         "ns_per_frame_median and box_tests_mean in a finished cell."])

    def test_names_of_sweeps_and_scenes_choose_nothing(self):
        def fill(maker):
            maker.sweep("resolvers_of_pair_queries", "world", resolver="label")  # not timed, one method
            maker.world("resolvers_of_pair_queries", {"scene": "slope_of_stages", "dimension": 2, "resolver": "catto"}, 1, 1e-3,
                        repeats=0)
        self.assertEqual(list(self.made(fill)), ["coverage"])

    def test_a_scene_of_another_name_that_measures_a_slope_has_its_error(self):
        def fill(maker):
            maker.sweep("mine", "world", "soft_step", resolver="label")
            for label in ("catto", "soft_step"):
                maker.world("mine", {"scene": "my_hill", "dimension": 2, "resolver": label}, 1, 1e-3, extra={"slope": True})
        made = self.made(fill)["mine_my_hill__2d"]
        self.assertIn("error of the distance slid", made.finding.headline)
        self.assertIn("soft_step", made.finding.text())

    def test_methods_are_compared_by_an_error_that_all_of_them_have(self):
        def fill(maker, without=("max_penetration",)):
            maker.sweep("mine", "world", "", resolver="label")
            axes = {"scene": "vertical_stack", "dimension": 2}
            maker.world("mine", {**axes, "resolver": "catto"}, 1, 1e-3)
            # A whole engine tells no contacts and exists in one precision.
            maker.world("mine", {**axes, "resolver": "box2d", "precision": "f32"}, 1, 1e-3, without=without,
                        extra={"precision": "f32", "engine": {"name": "box2d", "differs": "its slop is 5 mm"}})
        told = self.made(lambda maker: fill(maker, ()))["mine_vertical_stack__2d"].table
        made = self.made(fill)
        self.assertNotIn("mine_precision", made, "no method has both")
        self.assertIn("box2d is a whole engine, here in f32: its slop is 5 mm.", made["mine_vertical_stack__2d"].note)
        untold = made["mine_vertical_stack__2d"].table
        self.assertIn("largest penetration [m]", told)
        self.assertNotIn("largest penetration of shapes [m]", told, "one error of one meaning")
        self.assertIn("largest penetration of shapes [m]", untold)
        self.assertNotIn("largest penetration [m]", untold)

    def test_an_error_that_nobody_makes_is_no_panel(self):
        def fill(maker, zero=("max_penetration", "mean_penetration", "penetration_poses")):
            maker.sweep("mine", "world", "", joint="stage")
            for label in ("pivot", "weld"):
                maker.world("mine", {"scene": "bridge", "dimension": 2, "joint": label}, 1, 1e-3, zero=zero)
        touching = self.made(lambda maker: fill(maker, ()))["mine_bridge__2d"].table
        hanging = self.made(fill)["mine_bridge__2d"].table
        self.assertIn("largest penetration [m]", touching)
        self.assertFalse([name for name in hanging if "largest penetration" in name])
        self.assertIn("restlessness", " ".join(map(str, hanging)))

    def test_a_chart_that_needs_what_nobody_has_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            synthetic_store.write(Path(folder) / "empty.db", themes=())
            context = chart.Context(load.Store(Path(folder) / "empty.db"))
        for needs in (chart.Needs("world", metrics=("ms_per_setp_median",)), chart.Needs("world", series=("max_sped",))):
            bad = chart.of_sweeps("planted", 1, "", needs, "", "", "")(self.test_a_chart_that_needs_what_nobody_has_is_refused)
            with self.assertRaisesRegex(load.UserError, "choosing_test.py: no (metric|series) .*; valid: .*max_"):
                chart.made(bad, context)


class Engines(undrawn.Undrawn):
    def charts(self, engine):
        with tempfile.TemporaryDirectory() as folder:
            made = synthetic_store.Maker(Path(folder) / "engines.db")
            axes = {"scene": "pyramid", "dimension": 2, "iterations": 10}
            for label, extra in (("catto+none", None), ("box2d", engine)):
                made.world("resolvers", {**axes, "resolver": label, "precision": "f32" if extra else "f64"}, 1.0, 1e-3,
                           extra=extra)
            made.close()
            store = load.Store(Path(folder) / "engines.db")
            context = chart.Context(store)
            return next(c for c in make.all_charts(context)
                        if c.figure is not None and c.section == cost_against_error.RIGHT_FOR_COST)

    @undrawn.drawn
    def test_an_engine_is_marked_kept_in_its_precision_and_told_apart(self):
        made = self.charts({"precision": "f32", "engine": {"name": "box2d", "differs": "a skin of 1 cm"}})
        self.assertIn("box2d", set(made.table["method"]))
        self.assertIn("box2d is a whole engine, here in f32: a skin of 1 cm.", made.note)
        self.assertIn("box2d (engine, f32 among f64)", [text.get_text() for text in made.figure.legends[0].get_texts()])
        self.assertNotIn("whole engine", self.charts(None).note, "the planted bug was not seen")


if __name__ == "__main__":
    unittest.main()
