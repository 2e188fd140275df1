# SPDX-License-Identifier: Zlib
"""Pictures of twenty methods, as a real sweep has: no letters lie on one another. Run by ctest, or
python3 reports/tests/many_methods_test.py."""

import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import make  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts.standing import steadiness  # noqa: E402

LABELS = ["admm", "avbd", "catto+baumgarte", "catto+linear", "catto+ngs", "catto+none", "catto+nonlinear", "catto+split_impulse",
          "direct_lcp", "jacobi", "millington", "naive", "nncg", "pgs_soft", "proximal_newton", "shock_propagation", "soft_step",
          "tgs", "tgs_ngs", "xpbd"]


def sweep_of_twenty(maker):
    """Some do the same, some fail soon, many fail at about one step, one has hardly an error."""
    maker.sweep("mine", "world", "catto+linear", resolver="label", iterations="setting")
    random = maker.random
    for scene, dimension, falling in (("vertical_stack", 3, 12), ("pyramid", 3, 0), ("mass_ratio", 3, 9)):
        for place, label in enumerate(LABELS):
            ms, error, step = 0.12 * 60 ** random.random(), 1e-9 * 1e7 ** random.random(), int(290 * random.random()) + 5
            ms = 9.6 if label == "millington" else ms  # so that the axis ends at a tick, whose label is beside the legend
            points = [60 - place % 4] * 300  # from the first step on: an axis of its own would not begin at 0
            for iterations in (4, 10):
                axes = {"scene": scene, "dimension": dimension, "resolver": label, "iterations": iterations}
                failed = ("collapsed", "drift", step) if place < falling else ()
                alike = {"work": 4000, "restless": 1e-3} if place % 3 == 0 else {"restless": 1e3 * error}
                maker.world("mine", axes, ms, error, *failed, points=points, repeats=2, **alike)


def before_the_limits(ax, spots, **kwargs):
    """Planted bug: letters that are put together for other limits than those that the panel gets in the end."""
    style.fallen(ax, spots, **kwargs)
    if ax.get_yscale() == "linear":
        ax.set_xlim(0, 5 * ax.get_xlim()[1])


class ManyMethods(with_store.WithStore):
    @undrawn.drawn
    def test_no_letters_overlap_or_are_cut_off(self):
        for made in make.all_charts(self.context(sweep_of_twenty)):
            if made.figure is not None:
                self.assertEqual(overlap.overlaps(made.figure), ([], []), made.id)

    @undrawn.drawn
    def test_limits_that_change_after_the_letters_are_seen(self):
        with unittest.mock.patch("over_steps.fallen", before_the_limits):
            figures = [made.figure for made in chart.made(steadiness, self.context(sweep_of_twenty))]
        self.assertTrue(any(overlap.overlaps(figure)[0] for figure in figures), "the planted bug was not seen")


if __name__ == "__main__":
    unittest.main()
