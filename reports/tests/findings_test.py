# SPDX-License-Identifier: Zlib
"""Tests of findings: no rank by noise, by rounding, by one seed or by the start of a run. Run by ctest, or
python3 reports/tests/findings_test.py. Each check is seen to fail on a planted bug."""

import ast
import math
import re
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402

import budget  # noqa: E402
import chart  # noqa: E402
import noise  # noqa: E402
import over_steps  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import broadphase, standing  # noqa: E402
from charts.conserved import energy  # noqa: E402
from charts.cost_against_error import cost_against_error, error_within_budgets  # noqa: E402
from charts.ensembles import ensembles  # noqa: E402
from charts.measurements import distinctness  # noqa: E402
from charts.problems import residual  # noqa: E402
from charts.stages import stages  # noqa: E402
from charts.standing import steadiness  # noqa: E402
from with_store import row  # noqa: E402

COST = "ms_per_step_median"


PEOPLE = re.compile(r"\b(nobody|somebody|whoever|everyone|who)\b", re.IGNORECASE)


def of_people(source):
    """Strings of a file, except docstrings, that speak of code as of people."""
    tree = ast.parse(source)
    said = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str) and
            id(node) not in said and " " in node.value and PEOPLE.search(node.value)]


class Findings(with_store.WithStore):
    def test_a_method_is_not_somebody(self):
        for file in sorted((HERE.parent / "charts").glob("*.py")):
            self.assertEqual(of_people(file.read_text(encoding="utf-8")), [], file.name)
        self.assertEqual(of_people('"""Who ranks."""\nx = f"at {y} nobody has a rank"'), [" nobody has a rank"])

    def test_a_method_without_the_setting_is_at_no_value_of_it(self):
        """It is the same at each value, and was planned at the first alone."""
        def fill(maker):
            maker.sweep("costs", "world", "catto", resolver="label", iterations="setting")
            for label, error in (("catto", 4e-3), ("naive", 6e-3), ("box2d", 1e-4)):
                for iterations in (4, 10, 30) if label != "box2d" else (4,):
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("costs", axes, 0.1 * iterations, error * 4 / iterations)
        def told():
            return self.made(cost_against_error, fill)[0]
        made = told()
        self.assertRegex(made.headline.text, r"box2d has the smallest penetration \(100 µm\), naive the largest \(6 mm at "
                         r"iterations=4\)\.$")
        self.assertRegex(row(made, "box2d")["time per step against catto, iterations=30"], r"^0\.\d+ times \(no iterations\)$")
        self.assertEqual(list(made.table["iterations"][made.table["method"] == "box2d"].isna()), [True])
        with unittest.mock.patch.object(over_steps, "own_setting", lambda cells, setting: cells):
            self.assertNotIn("no iterations", told().finding.text(), "the planted bug was not seen")

    def test_the_ends_of_two_runs_of_a_script_are_numbers_and_no_ratio(self):
        """The last tenth of a run has no repeats, so the floor of whole runs cannot judge it."""
        found = self.made(stages, synthetic_store.stages)[0]
        self.assertEqual(list(found.finding.table.columns), ["sleep", "largest step [s]", "step of the last tenth [s]",
                                                             "slowest stage", "share of the time [1]"])
        self.assertEqual(list(found.finding.table["sleep"]), ["none", "split_average"])
        self.assertIn("the slowest stage is solver", found.finding.headline)
        self.assertIn("no ratio of two runs is given", found.note)

    def test_of_equal_medians_the_one_that_is_never_worse_is_the_best(self):
        def fill(maker):
            maker.sweep("ensemble", "world", resolver="label")
            for label, errors in (("catto", (1e-3, 2e-3, 3e-3)), ("naive", (0.5e-3, 2e-3, 3e-3))):
                for seed, error in enumerate(errors):
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "seed": seed}
                    maker.world("ensemble", axes, 1.0, error, repeats=0)
        found = self.made(ensembles, fill)[0]  # in the order of names catto would be the first
        self.assertEqual(found.finding.headline, "On stack, 2D, over 3 seeds, naive and catto tie for the smallest penetration "
                                                 "(median 2 mm).")
        self.assertEqual(list(row(found, "naive").values())[1:4], ["2 mm", "3 mm", "best, tie"])

    def test_each_seed_is_a_run_of_its_own_where_methods_are_one_path(self):
        def fill(maker, alike=(1,)):
            maker.sweep("ensemble", "world", resolver="label", perturb="parameter")
            for perturb in (1e-6, 1e-3):
                for seed in range(1, 11):
                    for label in ("catto", "naive"):
                        axes = {"scene": "stack", "dimension": 2, "perturb": perturb, "resolver": label, "seed": seed}
                        maker.world("ensemble", axes, 1.0, 1e-3, repeats=0,
                                    hash=f"{perturb} {seed}" + ("" if seed in alike else label))
        found = chart.made(distinctness, self.context(fill))[0]
        self.assertIn("No two methods end in the same bits in most of their common runs", found.finding.headline)
        self.assertEqual(found.table[["cells", "equal"]].to_numpy().tolist(), [[20, 2]])
        found = chart.made(distinctness, self.context(lambda maker: fill(maker, range(1, 9))))[0]
        self.assertEqual(found.finding.headline, "In ensemble catto and naive are one path: they end in the same bits in 16 "
                         "of 20 common runs.")
        self.assertEqual([tuple(row.values()) for row in found.finding.rows()], [("ensemble", "catto and naive", 16, 20)])

    @staticmethod
    def cut(runs):
        """catto costs 1 ms, or a little more or less, and errs less than naive; both have a dearer setting."""
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for iterations, of in ((4, {"naive": [1.0, 1.01, 1.02, 1.03, 1.04], "catto": runs}),
                                   (40, {"naive": [4.0, 4.01, 4.02, 4.03, 4.04], "catto": [4.0, 4.01, 4.02, 4.03, 4.04]})):
                for label, ms in of.items():
                    for repeat, one in enumerate(ms):
                        axes = {"kind": "world", "scene": "s", "dimension": 2, "resolver": label, "iterations": iterations,
                                "timed": True, "repeat": repeat, "precision": "f64"}
                        maker.trial("costs", axes, {COST: one, "penetration_poses": 1e-3 if label == "catto" else 2e-3})
        return fill

    def test_a_budget_is_not_cut_through_noise(self):
        """catto+linear, 0.2 % above the budget, was said to err more or to have no run that cheap."""
        context = self.context(self.cut([1.022, 1.023, 1.024, 1.025, 1.026]))
        cells = context.store.cells("costs")
        least = 1.028
        self.assertEqual(sorted(budget.within(cells, COST, "penetration_poses", 1.02, least)), ["catto", "naive"])
        self.assertEqual(sorted(budget.within(cells, COST, "penetration_poses", 1.02)), ["naive"], "the bug was not seen")
        cells = self.context(self.cut([1.2, 1.21, 1.22, 1.23, 1.24])).store.cells("costs")
        self.assertEqual(sorted(budget.within(cells, COST, "penetration_poses", 1.02, least)), ["naive"])
        cells = self.context(self.cut([1.01, 1.2, 1.21, 1.23, 1.24])).store.cells("costs")
        self.assertEqual(sorted(budget.within(cells, COST, "penetration_poses", 1.02, least)), ["catto", "naive"], "whiskers")
        found = chart.made(error_within_budgets, context)[0]
        self.assertEqual((row(found, "1.02 ms per step")["best"], row(found, "1.02 ms per step")["smallest penetration of "
                                                                                                 "shapes"]),
                         ("catto", "1 mm"))
        self.assertIn("A time above a budget by no more than the noise is within it", found.note)
        few = self.context(self.cut([1.5, 1.51])).store.cells("costs")
        self.assertEqual(sorted(budget.within(few, COST, "penetration_poses", 1.02, least)), ["naive"], "two repeats")
        self.assertEqual(sorted(budget.within(few, COST, "penetration_poses", 1.02, noise.UNMEASURED)), ["naive"])

    @undrawn.drawn
    def test_a_cost_of_0_is_drawn_and_within_every_budget(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for iterations, works in ((4, (0, 0)), (10, (1000, 2000)), (40, (4000, 5000))):
                for label, work in zip(("catto", "naive"), works):
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("costs", axes, iterations / 10, 1e-2 / iterations, work=work)
        found = self.made(error_within_budgets, fill)[0]
        self.assertEqual(len(found.figure.axes), 2, "a panel for each cost")
        drawn = found.figure.axes[1].lines
        self.assertTrue(all(x > 0 for line in drawn for x in line.get_xdata()), "0 has no place on a log axis")
        self.assertIn("0", [label.get_text() for label in found.figure.axes[1].get_xticklabels()])

    def test_budgets_name_who_is_best_at_each(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for iterations, errors in ((4, (4e-3, 8e-3)), (10, (3e-3, 2e-3)), (40, (3e-3, 1e-3))):
                for label, error in zip(("catto", "naive"), errors):
                    maker.world("costs", {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations},
                                iterations / 10, error)
        found = self.made(error_within_budgets, fill)[0]
        self.assertRegex(found.finding.headline, r"^On stack, 2D catto has the smallest penetration within 4\d\d µs per step, "
                                                 r"naive "
                         r"within 4[.\d]* ms per step; no method is best at every budget\.$")
        told = [list(entry.values()) for entry in found.finding.rows()]
        self.assertEqual([entry[1] for entry in told], ["catto", "catto", "naive", "naive"] * 2)
        self.assertEqual([entry[-1] for entry in told[:4]], [4e-3, 4e-3, 2e-3, 1e-3])
        self.assertRegex(told[4][0], r"^[\d,]+ multiply-adds per step$")

    def test_speeds_below_rounding_are_at_rest(self):
        speeds = {"catto": 6.6e-13, "soft_step": 2.7e-13, "millington": 0.1}
        self.assertEqual(standing.headline("pyramid", speeds, ["naive"]).text, "On pyramid catto and soft_step come to rest; "
                         "millington is most restless, 100 mm/s, and naive fails.")
        lines = standing.lines_of_steadiness(speeds, {"naive": "failed: collapsed"}, [*speeds, "naive"])
        rows = standing.table_of_steadiness([("pyramid", *lines)]).values.tolist()
        self.assertEqual([(row[0], row[2]) for row in rows], [("catto and soft_step", "at rest"), ("millington", "+100 mm/s"),
                                                              ("naive", "failed: collapsed")])
        speeds = {"catto": 6.6e-13, "soft_step": 0.0}
        self.assertEqual(standing.headline("pyramid", speeds).text, "On pyramid catto and soft_step come to rest.")
        with unittest.mock.patch.object(standing, "at_rest", lambda speeds: speeds):
            bad = standing.headline("pyramid", {"catto": 6.6e-13, "soft_step": 2.7e-13}).text
        self.assertIn("soft_step is calmest", bad, "the planted bug was not seen")

    def test_failed_methods_are_named_beside_the_speeds_of_the_others(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for label, restless in (("catto", 1e-2), ("naive", 9.0), ("soft_step", 1e-3)):
                for iterations in (4, 10, 30):
                    failed = ("collapsed", "far", 50) if label == "naive" else ()
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("costs", axes, 1.0, 1e-3, *failed, restless=restless)
        found = self.made(steadiness, fill)[0]
        self.assertRegex(found.finding.headline, r"^On stack in 2D at iterations=10 soft_step is calmest, .*m/s, and catto most "
                         r"restless, .*m/s; naive fails\.$")
        self.assertEqual(found.headline.text, found.finding.headline)
        self.assertTrue(math.isnan(found.headline.values["naive"]))
        self.assertEqual([(row["method"], row["against the best"]) for row in found.finding.rows()][::2],
                         [("soft_step", "best"), ("naive", "failed: collapsed")])

    def test_who_solves_the_contacts_is_not_ranked_by_the_start(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for label, errors in (("catto", (1e-5, 1e-16)), ("naive", (4e-6, 1e-16)), ("millington", (1e-5, 1e-8)),
                                  ("soft_step", (3e-13, 1e-13)), ("catto+linear", (3e-13, 1e-10))):
                for iterations, error in zip((4, 30), errors):
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("costs", axes, 1.0, error)
        found = self.made(residual, fill)[0]
        self.assertEqual(found.finding.headline, "In 2D on stack, from 4 to 30 iterations, the residual of catto and naive falls "
                         "below 1e-12.")
        row = found.finding.table.iloc[0]
        self.assertEqual((row["residual before"], row["residual after"]), ("4e-07 to 1e-06", "<1e-12"))
        self.assertEqual((row["does not fall"], row["below 1e-12 throughout"]), ("1 of 5", "1 of 5"),
                         "catto+linear rises from rounding")

    def test_residuals_are_compared_over_one_span(self):
        def fill(contacts):
            def into(maker):
                maker.sweep("costs", "world", resolver="label", iterations="setting")
                for label, errors in (("catto", {4: 8e-1, 10: 4e-3, 30: 2e-3}), ("soft_step", {10: 4e-3, 30: 1e-3}),
                                      ("millington", {10: 2e-3, 30: 2e-3})):
                    for scene in ("stack", "pyramid"):
                        for iterations in errors if scene == "stack" else (10,):
                            axes = {"scene": scene, "dimension": 2, "resolver": label, "iterations": iterations}
                            maker.world("costs", axes, 1.0, errors[iterations] * contacts)
            return into
        found = self.made(residual, fill(1))[0]
        self.assertEqual(found.finding.headline, "In 2D on stack, from 10 to 30 iterations, the residual of soft_step falls "
                                                 "most, to 0.0001; it falls on 1 of 2 scenes.")
        stack, pyramid = found.finding.table.iloc[0], found.finding.table.iloc[1]
        self.assertEqual((stack["residual before"], stack["residual after"], stack["does not fall"]),
                         ("0.0004", "0.0001", "1 of 3"))
        self.assertEqual((pyramid["scene"], pyramid["outcome"]), ("pyramid", "only iterations=10 was run"))
        self.assertIsNone(self.made(residual, fill(0))[0].figure, "no contacts, no residual, no chart")

    @staticmethod
    def boxes(runs_of, sizes=(64, 128, 256, 512), frames=(40,)):
        """`runs_of(method, n, frames)`: five times of one cell, in ns."""
        def fill(maker):
            maker.sweep("boxes", "boxes", "naive", broadphase="stage")
            for method in ("naive", "other"):
                for n in sizes:
                    for count in frames:
                        for repeat, ns in enumerate(runs_of(method, n, count)):
                            axes = {"kind": "boxes", "dimension": 2, "distribution": "uniform", "broadphase": method, "n": n,
                                    "frames": count, "precision": "f64", "timed": True, "repeat": repeat}
                            maker.trial("boxes", axes, {"ns_per_frame_median": ns, "ns_per_frame_p25": ns, "ns_per_frame_p75": ns,
                                                        "box_tests_mean": 5.0, "load": 0.1})
        return fill

    def test_a_crossing_whose_whiskers_meet_is_none(self):
        steady = (1.0, 1.001, 1.002, 1.003, 1.004)
        runs = lambda last: lambda method, n, _: [n * (n if method == "naive" else 100) * v  # noqa: E731
                                                  for v in (steady if method == "naive" else (*steady[:4], last))]
        found = self.made(broadphase.broadphase, self.boxes(runs(8.0)))[0]
        self.assertIn("other: tie at the largest size, within the noise; no crossing", found.finding.text())
        found = self.made(broadphase.broadphase, self.boxes(runs(1.004)))[0]
        self.assertEqual([row(found, "other")[name] for name in ("result", "about")], ["faster from", "100"])
        with unittest.mock.patch.object(noise, "interval", lambda values: (math.nan, math.nan)):
            bad = chart.made(broadphase.broadphase, self.context(self.boxes(runs(8.0))))[0]
        self.assertEqual(row(bad, "other")["result"], "faster from", "a rule without whiskers was not seen")

    def test_boxes_over_another_axis_are_two_charts(self):
        runs = lambda method, n, frames: [n * frames * (1 + 0.01 * i) for i in range(5)]  # noqa: E731
        found = self.made(broadphase.broadphase, self.boxes(runs, frames=(10, 40)))
        self.assertEqual([c.id for c in found], ["boxes_2d_frames_10", "boxes_2d_frames_40"])
        for c in found:
            self.assertEqual(len(c.table), 8)

    def test_no_explosion_silences_a_share_and_no_gain_is_its_own_measure(self):
        def fill(exploded, potential):
            def into(maker):
                maker.sweep("costs", "world", resolver="label")
                for label, gain, outcome in (("catto", 0.0, "ok"), ("box2d", 0.5, "ok"), ("naive", exploded, "exploded")):
                    rise = gain if label == "box2d" else 0.0
                    series = {"kinetic": 100 * np.array([0.0, 1.0, gain] if potential else [0.0, 0.1, 0.0]),
                              "potential": 100 * np.array([1.0, 0.0, 1.0] if potential else [1.0, 0.9, 1.0 + rise])}
                    axes = {"kind": "world", "scene": "fall", "dimension": 2, "resolver": label, "timed": False, "repeat": 0}
                    maker.trial("costs", axes, {}, outcome, step=3 if outcome != "ok" else None, series=series)
            return into
        found = self.made(energy, fill(1e9, True))[0]
        self.assertEqual(found.finding.headline, "In 2D box2d gains energy on fall, 50 % of the energy exchanged.")
        found = self.made(energy, fill(0.0, False))[0]
        self.assertEqual(found.finding.headline, "In 2D box2d gains energy on fall, 50 J.")
        self.assertEqual(row(found, "fall")["remark"], "more than is exchanged")

    def test_the_method_that_gains_most_joules_is_not_that_with_the_largest_share(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label")
            for label, exchanged, gain in (("catto", 10.0, 2.0), ("box2d", 0.1, 0.2), ("naive", 10.0, 0.0)):
                series = {"kinetic": np.array([0.0, exchanged, 0.0]),
                          "potential": 20 + np.array([exchanged, 0.0, exchanged + gain])}
                axes = {"kind": "world", "scene": "fall", "dimension": 2, "resolver": label, "timed": False, "repeat": 0}
                maker.trial("costs", axes, {}, series=series)
        found = self.made(energy, fill)[0]
        self.assertEqual(found.finding.headline, "In 2D 2 of 3 methods gain energy on fall, catto most (2 J).")

    @undrawn.drawn
    def test_rounding_of_the_energy_is_drawn_at_zero_and_a_gain_is_not(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label")
            for label, gain in (("catto", 0.0), ("naive", 5.0)):
                series = {"kinetic": np.array([0.0, 2e-13, 0.0]), "potential": np.array([2000.0, 2000.0, 2000.0 - 2e-13 + gain])}
                axes = {"kind": "world", "scene": "rest", "dimension": 2, "resolver": label, "timed": False, "repeat": 0}
                maker.trial("costs", axes, {}, series=series)
        ax = self.made(energy, fill)[0].figure.axes[0]
        drawn = sorted(max(abs(y) for y in line.get_ydata()) for line in ax.lines if line.get_linewidth() == 1.2)
        self.assertEqual(drawn, [0.0, 1.1])

    @undrawn.drawn
    def test_whiskers_lie_inside_the_panel(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label")
            for label, ms in (("catto", 1.0), ("naive", 2.0)):
                for repeat in range(5):
                    axes = {"kind": "world", "scene": "s", "dimension": 2, "resolver": label, "timed": True, "repeat": repeat,
                            "precision": "f64"}
                    maker.trial("costs", axes, {COST: ms * (9.0 if repeat == 4 else 1.0), "penetration_poses": 1e-3 / ms})
        ax = self.made(cost_against_error, fill)[0].figure.axes[0]
        drawn = [x for line in ax.lines if line.get_linewidth() == 0.9 for x in line.get_xdata()]
        self.assertAlmostEqual(max(drawn), 18.0)
        self.assertGreater(ax.get_xlim()[1], 18.0)

    @undrawn.drawn
    def test_the_budgets_that_are_drawn_are_those_of_the_table(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for iterations in (4, 40):
                for label, ms in (("catto", 1.0), ("soft_step", 2.0), ("naive", 0.2)):
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("costs", axes, ms * iterations / 4, 1e-3 / ms, repeats=1)
                maker.world("costs", {**axes, "resolver": "sank"}, 1.0, 1.0, "sank", "all", 5)
            maker.leave_rows(50, "naive")  # not ranked
        found = self.made(error_within_budgets, fill)[0]
        self.assertNotIn("sank", [text.get_text() for text in found.figure.legends[0].get_texts()])
        drawn = [f"{style.si(line.get_xdata()[0], 'ms')} per step" for line in found.figure.axes[0].lines
                 if line.get_linestyle() == ":"]
        self.assertGreaterEqual(len(drawn), 2)
        within = [told["within"] for told in found.finding.rows()]
        self.assertEqual(drawn, [text for text in within if text.endswith(" ms per step")])

    def test_energy_tells_the_setting_and_no_gain_of_a_script(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for scene, scale, bodies in (("fall", 100.0, 2), ("rest", 1e-3, 2), ("script", 100.0, 9)):
                for label, gain in (("catto", 0.0), ("box2d", 0.5)):
                    for iterations in (4, 10, 30):
                        series = {"kinetic": scale * np.array([0.0, 1.0, gain]), "potential": scale * np.array([1.0, 0.0, 1.0]),
                                  "bodies": np.array([2.0, 2.0, bodies])}
                        axes = {"kind": "world", "scene": scene, "dimension": 2, "resolver": label, "iterations": iterations}
                        maker.trial("costs", {**axes, "timed": False, "repeat": 0}, {}, series=series)
        found = self.made(energy, fill)[0]
        self.assertEqual(found.finding.headline, "In 2D at iterations=10 methods gain energy on 2 of 2 scenes, box2d most on "
                                                 "fall (50 "
                         "% of the energy exchanged).")
        self.assertEqual([list(row(found, name).values())[1:] for name in ("fall", "rest", "script")], [
            ["box2d", "box2d", "50 J", "0.5", ""], ["box2d", "box2d", "0.0005 J", "0.5", "little energy is exchanged"],
            ["", "", "", "", "not compared: the script adds bodies and with them energy"]])


if __name__ == "__main__":
    unittest.main()
