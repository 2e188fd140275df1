# SPDX-License-Identifier: Zlib
"""Tests of the charts over the steps of a run (energy, residual, steadiness). Run by ctest, or
python3 reports/tests/over_steps_test.py."""

import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import over_steps  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts.broadphase import broadphase  # noqa: E402
from charts.conserved import energy, momenta  # noqa: E402
from charts.cost_against_error import cost_against_error, error_within_budgets  # noqa: E402
from charts.ensembles import ensembles  # noqa: E402
from charts.problems import residual  # noqa: E402
from charts.standing import over_time, steadiness  # noqa: E402
from charts.step_times import step_times  # noqa: E402


def letters_one_by_one(ax, spots, **kwargs):
    """Planted bug: letters of runs that fail at one place overlap."""
    for x, y, outcome, colour in spots:
        ax.plot([x], [y], marker=style.letter(outcome), ls="none", color=colour)


class OverSteps(with_store.WithStore):
    def made(self, kind, fill):  # planted bugs overlap
        return chart.made(kind, self.context(fill))

    @staticmethod
    def two_that_fail_alike(maker):
        maker.sweep("mine", "world", resolver="label", iterations="setting")
        for iterations in (4, 10, 30):
            for label, failed in (("catto", ()), ("naive", ("exploded", "far", 60)), ("soft_step", ("exploded", "far", 60))):
                axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                maker.world("mine", axes, 1.0, 1e-3, *failed)

    @undrawn.drawn
    def test_runs_that_fail_at_one_place_share_a_letter_with_their_number(self):
        for kind in (energy, residual, steadiness):
            figure = self.made(kind, self.two_that_fail_alike)[0].figure
            self.assertEqual(overlap.overlaps(figure), ([], []), kind.name)
        figure = self.made(energy, self.two_that_fail_alike)[0].figure
        self.assertIn("E×2", [text.get_text() for ax in figure.axes for text in ax.texts])
        with unittest.mock.patch.object(over_steps, "fallen", letters_one_by_one):
            figure = self.made(energy, self.two_that_fail_alike)[0].figure
        self.assertNotEqual(overlap.overlaps(figure)[0], [], "the planted bug was not seen")

    def test_a_listed_chart_names_only_what_is_missing(self):
        def fill(maker):
            maker.sweep("mine", "world", resolver="label", iterations="setting",
                        report=["steadiness", "residual", "energy", "ensembles", "broadphase"])
            for seed in (1, 2):
                for label in ("catto", "naive"):
                    for iterations in (4, 10):
                        axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations, "seed": seed}
                        maker.world("mine", axes, 1.0, 1e-3)
        for kind in (steadiness, residual, energy):
            found = self.made(kind, fill)
            self.assertEqual([c.figure for c in found], [None])
            self.assertEqual(found[0].finding.headline, "The `report` of mine lists this chart, but the sweep lacks its data.")
            self.assertTrue(found[0].holes[0].startswith("The chart needs one seed"), found[0].holes)
            self.assertNotIn("trials of kind world", found[0].holes[0], "the sweep has these")
        self.assertIn("trials of kind boxes", self.made(broadphase, fill)[0].holes[0])
        self.assertIsNotNone(self.made(ensembles, fill)[0].figure)

    @undrawn.drawn
    def test_each_scene_is_drawn_at_the_middle_of_its_own_setting(self):
        def fill(maker):
            maker.sweep("mine", "world", resolver="label", iterations="setting")
            for label in ("catto", "naive"):
                for scene, settings in (("A", (4, 10, 30, 100)), ("B", (4, 10))):
                    for iterations in settings:
                        axes = {"scene": scene, "dimension": 2, "resolver": label, "iterations": iterations}
                        maker.world("mine", axes, 1.0, 1e-3, restless={"catto": 0.1, "naive": 0.2}[label])
        found = self.made(steadiness, fill)[0]
        self.assertEqual(set(found.table["scene"]), {"A", "B"}, "B has no 30 iterations and vanished")
        self.assertEqual({row["scene"] for row in found.finding.rows()}, {"A", "B"})
        self.assertEqual(overlap.overlaps(found.figure), ([], []))
        self.assertEqual([len(ax.lines) for ax in found.figure.axes], [2, 2, 1, 1], "equal contacts are one line")

    def test_a_method_without_the_setting_is_drawn_beside_the_others(self):
        def fill(maker):
            maker.sweep("mine", "world", resolver="label", iterations="setting")
            for label, settings in (("catto", (4, 10, 30)), ("naive", (4, 10, 30)), ("direct_lcp", (4,))):  # planned once
                for iterations in settings:
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("mine", axes, 1.0, 1e-3, restless={"catto": 0.1, "naive": 0.2, "direct_lcp": 0.05}[label])
        for kind in (steadiness, energy, step_times):
            found = self.made(kind, fill)[0]
            self.assertEqual(set(found.table["method"]), {"catto", "direct_lcp", "naive"}, kind.name)
            self.assertIn("at iterations=10", found.finding.headline)
        self.assertIn("direct_lcp is calmest", self.made(steadiness, fill)[0].finding.headline)

    def test_a_store_with_settings_needs_no_guess(self):
        """naive has one value of its setting; direct_lcp has no setting, and so no axis."""
        def fill(maker, told=True):
            maker.sweep("mine", "world", resolver="label", iterations="setting", **({"settings_told": True} if told else {}))
            for label, settings in (("catto", (4, 10, 30)), ("naive", (10,)), ("direct_lcp", (None,) if told else (4,))):
                for iterations in settings:
                    axes = {"scene": "stack", "dimension": 2, "resolver": label}
                    axes |= {} if iterations is None else {"iterations": iterations}
                    maker.world("mine", axes, 1.0, 1e-3, restless={"catto": 0.1, "naive": 0.2, "direct_lcp": 0.05}[label])
        for kind in (steadiness, step_times):
            self.assertIn("Without iterations: direct_lcp.", self.made(kind, fill)[0].note)
            older = self.made(kind, lambda maker: fill(maker, False))[0]
            self.assertIn("Without iterations: direct_lcp and naive.", older.note, "the planted guess was not seen")
        for kind in (residual, error_within_budgets, cost_against_error, over_time, momenta):
            for made in self.made(kind, fill):
                self.assertNotIn("nan", f"{made.finding.text()} {made.note}", kind.name)


if __name__ == "__main__":
    unittest.main()
