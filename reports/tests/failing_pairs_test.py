# SPDX-License-Identifier: Zlib
"""Tests of the gallery of failing pairs: outlines are those of the shapes, and the simplest and the worst pair are kept."""

import json
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
import silhouette  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import corpus  # noqa: E402
from charts.corpus import failing_pairs  # noqa: E402

STILL = {2: {"t": [0, 0], "cos_sin": [1, 0]}, 3: {"t": [0, 0, 0], "q_wxyz": [1, 0, 0, 0]}}


class Names:  # the context of a chart that asks it for names alone
    name = staticmethod(str)


def case(method, failure, error, radius):
    """Two circles; the answer is off by this part of the size."""
    return {"id": f"{method}-{radius}", "dim": 2, "note": "ties",
            "shapeA": {"type": "sphere", "radius": radius}, "poseA": STILL[2],
            "shapeB": {"type": "sphere", "radius": radius}, "poseB": {"t": [3, 0], "cos_sin": [0, 1]},
            "found": {"stage": "pair_query", "precision": "f64", "method": method, "failure": failure, "value": 0.5,
                      "error": error},
            "expected": {"signed_distance": 3 - 2 * radius}}


def check_outlines(outline):
    """Known areas of shadows: a circle, a turned box, and in 3D a ball, whose shadow is the same from every side."""
    known = [({"type": "sphere", "radius": 2.0}, STILL[2], 2, math.pi * 4),
             ({"type": "box", "half_extents": [1.0, 2.0]}, {"t": [5, 5], "cos_sin": [0.8, 0.6]}, 2, 8.0),
             ({"type": "box", "half_extents": [1.0, 2.0], "radius": 1.0}, STILL[2], 2, 8 + 12 + math.pi),
             ({"type": "capsule", "half_length": 1.0, "radius": 1.0}, STILL[2], 2, 4 + math.pi),
             ({"type": "ellipsoid", "half_x": 3.0, "half_y": 1.0}, STILL[2], 2, 3 * math.pi),
             ({"type": "convex", "points": [[0, 0], [4, 0], [0, 2]]}, STILL[2], 2, 4.0),
             ({"type": "ellipsoid", "half_x": 1.0, "half_y": 1.0, "half_z": 1.0}, STILL[3], 3, math.pi)]
    for shape, pose, dimension, area in known:
        x, y = outline(shape, pose, dimension).T
        found = abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) / 2
        if abs(found - area) > 0.02 * area:
            return f"{shape}: area {found}, not {area}"
    return ""


def without_rounding(shape, pose, dimension):
    """Planted bug: the core alone is drawn."""
    return silhouette.outline({**shape, **({"radius": 0.0} if shape["type"] == "box" else {})}, pose, dimension)


class Gallery(undrawn.Undrawn):
    def test_outlines_are_those_of_the_shapes(self):
        self.assertEqual(check_outlines(silhouette.outline), "")
        self.assertNotEqual(check_outlines(without_rounding), "", "the planted bug was not seen")

    def test_every_panel_says_what_is_wrong(self):
        told = lambda failure, error=1e-9: corpus.told(case("m", failure, error, 1.0))[2:]  # noqa: E731
        self.assertEqual(told("wrong_distance"), ["wrong distance", "500 mm for 1 m", "off by 1.0e-09"])
        self.assertEqual(told("wrong_normal"), ["wrong normal", "off by 1.0e-09 along it"], "its distance is right")
        self.assertEqual(told("wrong_side"), ["wrong side", "500 mm for 1 m", "off by 1.0e-09"])
        self.assertEqual(told("wrong_side", None), ["wrong side", "true: 1 m"], "a witness that knows the side alone")
        self.assertEqual(told("not_finite", None), ["no answer: not finite", "true: 1 m"])
        wrong = {name: {"worst": (0, case(name, name, 0.1 * i, 1.0))} for i, name in enumerate(corpus.WRONG)}
        made = corpus.found_pairs(wrong, 2, "f64")
        self.assertEqual(made.headline, "In 2D, f64, wrong_side has the largest error of 3 methods, 0.2 of the size, on "
                                        "sphere–sphere (ties): wrong side.")
        self.assertEqual(made.table["failure"].tolist(), ["wrong side", "wrong normal", "wrong distance"])
        twice = {**wrong, "wrong_side{frame=world}": wrong["wrong_normal"]}
        self.assertIn("largest error of 3 methods in 4 settings", corpus.found_pairs(twice, 2, "f64").headline)
        del wrong["wrong_side"]
        self.assertIn("0.1 of the size, on sphere–sphere (ties): along its normal alone",
                      corpus.found_pairs(wrong, 2, "f64").headline)

    def test_an_outline_that_is_given_is_drawn_and_one_that_is_missing_is_told(self):
        known = case("m", "wrong_distance", 0.1, 1.0)
        given = {**known, "shapeA": {"type": "half_space"},
                 "outlineA": [[0, 0], [1, 0], [1, 1]], "outlineB": [[0, 0], [2, 0], [0, 2]]}
        self.assertEqual(silhouette.of_case(given, "A").tolist(), [[0, 0], [1, 0], [1, 1], [0, 0]])
        self.assertEqual(silhouette.of_case(given, "B")[1].tolist(), [2, 0], "not the circle of its radius")
        self.assertEqual(len(silhouette.of_case(known, "B")), 181, "of an older store")
        for kind in ("half_space", "custom"):
            older = {**known, "shapeA": {"type": kind}}
            self.assertIsNone(silhouette.of_case(older, "A"))
            made = corpus._pairs_chart(Names, {"m": {"simplest": (0, older), "worst": (0, given)}}, 2, "f64")
            self.assertEqual(made.holes, [f"m, simplest: the store, written by an older program, has no outline of {kind}"])
            self.assertNotIn("outline", made.table["input"].iloc[1])
            style.plt.close(made.figure)

    @undrawn.drawn
    def test_a_shape_that_is_too_small_to_be_seen_has_a_ring(self):
        for radius, rings in ((0.5, []), (0.001, [(3.0, 0.0)])):
            figure, ax = style.plt.subplots()
            pair = case("m", "wrong_distance", 0.1, 1.0)
            corpus._draw(ax, {**pair, "shapeB": {"type": "sphere", "radius": radius}})
            found = [tuple(line.get_xydata()[0].round(3)) for line in ax.lines if line.get_marker() == "o"]
            self.assertEqual(found, rings)
            style.plt.close(figure)

    @undrawn.drawn
    def test_the_simplest_and_the_worst_pair_stand_beside_each_other(self):
        with tempfile.TemporaryDirectory() as folder:
            made = synthetic_store.Maker(Path(folder) / "s.db")
            synthetic_store.ledger(made)
            made.db.execute("CREATE TABLE found_case(name TEXT PRIMARY KEY, vertices INTEGER, size REAL, data TEXT)")
            for name, failure, vertices, radius in (("a", "wrong_normal", 9, 1.0), ("b", "wrong_distance", 2, 0.25)):
                made.db.execute("INSERT INTO found_case VALUES (?,?,?,?)",
                                (name, vertices, radius, json.dumps(case("fcl_libccd", failure, 1e-9, radius))))
            for kinds, error in (("box", 0.1), ("capsule", 0.7)):
                made.db.execute("UPDATE ledger SET wrong=1, max_error=?, worst=? WHERE method='fcl_libccd' AND axis='all' AND "
                                "kind_a=?",
                                (error, json.dumps(case("fcl_libccd", "wrong_distance", error, 0.5 + error)), kinds))
            made.close()
            context = chart.Context(load.Store(Path(folder) / "s.db"))
            charts = failing_pairs.make(context)
            self.assertEqual([c.id for c in charts], ["failing_pairs_2d_f64"])
            shown = charts[0].table.set_index("which")
            self.assertEqual(shown.loc["simplest", "case"], "fcl_libccd-0.25")
            self.assertEqual(shown.loc["worst", "case"], "fcl_libccd-1.2")
            self.assertEqual(charts[0].finding.headline, "In 2D, f64, fcl_libccd has the largest error of 1 method, 0.7 of the "
                                                         "size, on "
                             "sphere–sphere (ties): wrong distance.")
            self.assertIn("distance, or along the normal", charts[0].finding.text())
            drawn = [ax.get_xlabel() for ax in charts[0].figure.axes if ax.get_visible()]
            self.assertEqual(["wrong distance" in words for words in drawn], [True, True])
            self.assertEqual(overlap.overlaps(charts[0].figure), ([], []))
            style.plt.close(charts[0].figure)
            context.store.db.close()


if __name__ == "__main__":
    unittest.main()
