# SPDX-License-Identifier: Zlib
"""Tests of the pictures of falls: which run is drawn, how, and with which curves."""

import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402

import chart  # noqa: E402
import load  # noqa: E402
import overlap  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import falls  # noqa: E402

FLOOR = ["#cdcdc8", "#787873", [-10, 90, 110, 90, 110, 130, -10, 130]]


def film(steps, gone=()):
    """A square that moves sideways with the steps; at the steps in `gone` it is out of the picture."""
    def picture(step):
        square = [[40 + step / 20 + x, 80 + y] for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
        body = [] if step in gone else [["#6699cc", "#385470", [v for corner in square for v in corner]]]
        return {"step": step, "time": step / 60, "patches": [FLOOR, *body]}
    return {"width": 100, "top": 22, "height": 122, "pictures": [picture(step) for step in steps]}


def made_of(falling, contacts=True, gone=(), steps=300):
    """The charts of a sweep of runs (scene, dimension, method, outcome, step of the fall, whether it has pictures) of `steps`
    steps."""
    with tempfile.TemporaryDirectory() as folder:
        maker = synthetic_store.Maker(Path(folder) / "store.db")
        for scene, dimension, method, outcome, step, drawn in [*falling, ("tower", 2, "catto", "ok", None, False)]:
            axes = {"kind": "world", "scene": scene, "dimension": dimension, "resolver": method, "timed": False, "repeat": 0}
            count = step or 300
            shapes = np.full(count, np.nan)
            shapes[9::10] = np.linspace(0, 0.03, len(shapes[9::10]))
            series = {"kinetic": np.linspace(0, 5, count), "potential": np.linspace(100, 60, count),
                      "max_penetration": np.linspace(0, 0.02, count) if contacts else np.full(count, np.nan),
                      "penetration_poses": shapes}
            key = maker.trial("tower", axes, {}, outcome, "body 2 is 1.2 m away" if step else "", step, series,
                                extra={"steps": steps})
            if drawn:
                maker.film(key, film([0, step - 40, step - 20, step - 5, step], gone))
        maker.close()
        store = load.Store(Path(folder) / "store.db")
        try:
            return chart.made(falls.falls, chart.Context(store))
        finally:
            store.db.close()


def words(figure):
    return [text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text"))]


THREE = [("tower", 2, "naive", "collapsed", 90, True), ("tower", 2, "millington", "collapsed", 250, True),
         ("tower", 3, "naive", "collapsed", 120, True), ("bridge", 2, "naive", "exploded", 200, True)]


class Falls(undrawn.Undrawn):
    @undrawn.drawn
    def test_one_run_of_each_scene_dimension_and_outcome_is_drawn_and_the_others_counted(self):
        made, = made_of(THREE)
        self.assertEqual(sorted(made.table["step"]), [120, 200, 250])
        self.assertEqual(list(made.table.set_index("step")["runs of this kind"][[120, 200, 250]]), [1, 1, 2])
        self.assertEqual(made.finding.headline, "4 of 5 runs fell: 3 collapsed and 1 exploded.")
        self.assertEqual([tuple(row.values()) for row in made.finding.rows()], [
            ("tower, 2D, millington", "collapsed", 250, "the last of 2", 0.03),
            ("tower, 3D, naive", "collapsed", 120, "the only one", 0.03),
            ("bridge, 2D, naive", "exploded", 200, "the only one", 0.03)])
        self.assertIn("the last run of a scene and dimension that fell, at most six of a sweep (collapsed: ", made.note)
        for outcome in ("collapsed", "exploded"):
            self.assertIn(f"{outcome}: {falls.FALLEN[outcome]}", made.note)
        self.assertNotIn("diverged", made.note)
        self.assertIn("collapsed at step 250: body 2 is 1.2 m away", words(made.figure))
        self.assertEqual(made.holes, [])
        self.assertEqual(overlap.overlaps(made.figure), ([], []))

    def test_a_picture_of_an_earlier_fall_is_not_called_the_last(self):
        made, = made_of([("tower", 2, "naive", "collapsed", 90, True), ("tower", 2, "millington", "collapsed", 250, False)])
        self.assertEqual([(row["step"], row["of the runs alike"]) for row in made.finding.rows()], [(90, "one of 2")])

    def test_a_run_that_creeps_to_its_last_step_has_not_fallen(self):
        creeps = [*THREE, ("tower", 2, "soft_step", "collapsed", 300, True)]
        made, = made_of(creeps)
        self.assertEqual(sorted(made.table["step"]), [120, 200, 250])
        self.assertEqual(made.finding.headline, "4 of 6 runs fell: 3 collapsed and 1 exploded; 1 more failed at its last step by "
                         "creeping.")
        with unittest.mock.patch.object(falls, "stood", lambda store, run: False):
            made, = made_of(creeps)
        self.assertIn(300, list(made.table["step"]), "the planted bug was not seen")
        made, = made_of(creeps[-1:])
        self.assertIsNone(made.figure)

    def test_runs_without_pictures_are_listed(self):
        made, = made_of([("tower", 2, "naive", "collapsed", 90, True), ("bridge", 3, "naive", "diverged", 70, False)])
        self.assertEqual(made.holes, ["bridge, 3D, diverged: 1 run, not drawn"])
        made, = made_of([("tower", 2, "naive", "collapsed", 90, False)])
        self.assertIsNone(made.figure)
        self.assertEqual(made.finding.headline, "1 of 2 runs collapsed.")
        self.assertIn("The store has no pictures of these runs.", " ".join(made.holes))

    def test_where_nothing_falls_the_page_says_so(self):
        made, = made_of([])
        self.assertIsNone(made.figure)
        self.assertIn("nothing collapsed", made.finding.headline)

    @undrawn.drawn
    def test_pictures_show_each_body_where_the_film_has_it(self):
        made, = made_of(THREE[1:2])
        pictures = [ax for ax in made.figure.axes if ax.findobj(PolyCollection)]
        self.assertEqual([ax.get_title("left") for ax in pictures],
                         ["step 0, 0.00 s", "step 210, 3.50 s", "step 230, 3.83 s", "step 245, 4.08 s", "step 250, 4.17 s"])
        for ax, step in zip(pictures, (0, 210, 230, 245, 250)):
            floor, square = (path.vertices for path in ax.findobj(PolyCollection)[0].get_paths())
            np.testing.assert_allclose(square[0], [40 + step / 20, 80])
            self.assertEqual((ax.get_xlim(), ax.get_ylim()), ((0, 100), (122, 22)))  # upright, without the band of words
            self.assertAlmostEqual(ax.bbox.width, ax.bbox.height)  # as wide as high: not stretched

    @undrawn.drawn
    def test_energy_and_depth_are_drawn_over_the_same_steps_with_the_fall_marked(self):
        made, = made_of(THREE[1:2])
        energy, depth = [ax for ax in made.figure.axes if ax.get_ylabel()]
        self.assertEqual(energy.get_xlim(), depth.get_xlim())
        self.assertEqual(falls.window([0, 210, 230, 245, 250]), (170, 250))
        for ax in (energy, depth):
            marks = [line.get_xdata()[0] for line in ax.lines if line.get_linestyle() == "--"]
            self.assertEqual(marks, [250])
        change, motion = energy.lines[:2]
        at = {step: i for i, step in enumerate(change.get_xdata())}
        self.assertEqual(min(at), 170)
        self.assertAlmostEqual(change.get_ydata()[at[170]], 0)
        self.assertAlmostEqual(change.get_ydata()[at[250]], -35 * 80 / 249)  # from 100 J to 65 J in 249 steps
        self.assertAlmostEqual(motion.get_ydata()[at[250]], 5)
        # Each line from a picture ends at its step.
        ends = made.figure.transFigure.transform([[line.get_xdata()[1], line.get_ydata()[1]] for line in made.figure.artists])
        steps = energy.transData.inverted().transform(ends)[:, 0]
        np.testing.assert_allclose(steps, [210, 230, 245, 250], atol=1e-6)

    @undrawn.drawn
    def test_a_run_without_contacts_says_so_and_shows_the_depth_of_its_shapes(self):
        for contacts in (True, False):
            made, = made_of(THREE[1:2], contacts)
            self.assertEqual("contacts: not reported" in words(made.figure), not contacts)
            self.assertIn("shapes, every 10 steps", words(made.figure))
            depth = [ax for ax in made.figure.axes if ax.get_ylabel()][1]
            np.testing.assert_allclose(depth.lines[1].get_xdata(), range(170, 251, 10))
            self.assertEqual(len(depth.lines[0].get_xdata()), 81 if contacts else 0)
            top = depth.transData.inverted().transform(depth.transAxes.transform((0, 1)) - (0, 4))[1]
            self.assertLess(max(depth.lines[1].get_ydata()), top)  # no dot is cut
            self.assertAlmostEqual(made.table["largest penetration of shapes [m]"][0], 0.03)

    @undrawn.drawn
    def test_a_body_that_left_the_picture_is_marked(self):
        made, = made_of(THREE[1:2], gone=(250,))
        self.assertEqual(words(made.figure).count("out of sight"), 1)

    def test_a_sweep_for_other_charts_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            maker = synthetic_store.Maker(Path(folder) / "store.db")
            maker.sweep("equal", "world", "naive", resolver="stage", report=["equal_cost"])
            maker.trial("equal", {"kind": "world", "scene": "tower", "resolver": "naive", "timed": False, "repeat": 0}, {},
                        "collapsed", "body 2 is 1.2 m away", 90)
            maker.close()
            store = load.Store(Path(folder) / "store.db")
            found = chart.made(falls.falls, chart.Context(store))
            store.db.close()
        self.assertEqual([c.id for c in found], ["falls"])
        self.assertEqual(found[0].holes, ["Not used for this chart: equal. The `report` of this sweep lists other charts."])


if __name__ == "__main__":
    unittest.main()
