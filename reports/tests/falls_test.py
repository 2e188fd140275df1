# SPDX-License-Identifier: Zlib
"""Tests of the pictures of falls: who is drawn, when, and as what."""

import math
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402

import chart  # noqa: E402
import load  # noqa: E402
import overlap  # noqa: E402
import synthetic_store  # noqa: E402
from charts import falls  # noqa: E402


def made_of(falling):
    """The charts of a sweep whose methods fall at these steps; one stands."""
    with tempfile.TemporaryDirectory() as folder:
        maker = synthetic_store.Maker(Path(folder) / "store.db")
        for method, step in {**falling, "catto": None}.items():
            axes = {"kind": "world", "scene": "tower", "resolver": method, "timed": False, "repeat": 0}
            count = step or 300
            series = {"kinetic": np.linspace(0, 5, count), "potential": np.linspace(100, 60, count),
                      "max_penetration": np.linspace(0, 0.02, count)}
            key = maker.trial("tower", axes, {}, "collapsed" if step else "ok", "body 2 is 1.2 m away" if step else "", step,
                              series)
            for at in [*range(0, count, 60), count]:
                lean = 0.002 * at if step else 0.0
                maker.poses(key, at, [[0, 0, -1, 0], [1, 0, 0.5, 0], [2, lean, 1.5, lean]])
        maker.close()
        store = load.Store(Path(folder) / "store.db")
        try:
            return chart.made(falls, chart.Context(store))
        finally:
            store.db.close()


class Falls(unittest.TestCase):
    def test_the_first_the_middle_and_the_last_to_fall_are_drawn(self):
        made, = made_of({"naive": 90, "millington": 250, "soft_step": 130, "catto+none": 100})
        self.assertEqual(list(made.table["step"]), [90, 130, 250])
        self.assertTrue(made.finding.startswith("4 of 5 cells fell; "), made.finding)
        self.assertIn("millington collapsed at step 250, its deepest overlap 20 mm", made.finding)
        self.assertEqual(list(made.table["largest energy [J]"]), [100.0] * 3)
        steps = [text.get_text() for text in made.figure.findobj(lambda artist: hasattr(artist, "get_text"))]
        for step in ("step 0", "step 60", "step 90", "step 120", "step 180", "step 240", "step 250"):
            self.assertIn(step, steps)
        self.assertEqual(overlap.overlaps(made.figure), ([], []))

    def test_where_nothing_falls_the_page_says_so(self):
        made, = made_of({})
        self.assertIsNone(made.figure)
        self.assertIn("nothing collapsed", made.finding)

    def test_a_body_is_where_it_is_and_turned_as_it_is(self):
        flat = falls.corners(np.array([[3, 1.0, 2.0, math.pi / 2]]), 2, 2.0)[0]
        deep = falls.corners(np.array([[3, 1.0, 2.0, 7.0, math.cos(math.pi / 4), 0, 0, math.sin(math.pi / 4)]]), 3, 2.0)[0]
        np.testing.assert_allclose(flat[0], [2.0, 1.0], atol=1e-12)  # its lower left corner, a quarter of a turn later
        np.testing.assert_allclose(flat[1], [2.0, 3.0], atol=1e-12)
        np.testing.assert_allclose(flat, deep, atol=1e-12)

    def test_who_never_moves_is_left_out(self):
        poses = {0: np.array([[0, 0, 0, 0], [1, 0, 1, 0.0]]), 60: np.array([[0, 0, 0, 0], [1, 0.5, 1, math.nan]]),
                 90: np.array([[0, 0, 0, 0], [1, 1.0, 1, 0.0]])}
        left = falls.moving(poses)
        self.assertEqual([list(rows[:, 0]) for rows in left.values()], [[1.0], [], [1.0]])


if __name__ == "__main__":
    unittest.main()
