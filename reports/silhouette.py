# SPDX-License-Identifier: Zlib
"""Outlines of the shapes of a case. `lpc verify` writes them (oracles/corpus/case_text.cpp). Older stores lack them: then they
are computed here from support points, for the kinds of shapes of that time.

Shapes and poses follow the schema of tests/regressions/hard_cases.json. 3D is seen from one fixed side, in parallel projection.
"""

import numpy as np

TURN = np.linspace(0, 2 * np.pi, 180, endpoint=False) + 1e-3  # off the axes, where a support point is not unique
# Right and up axes of the picture in 3D: slightly from the side and from above.
CAMERA = np.array([[0.87, 0.0, -0.49], [-0.19, 0.92, -0.34]])


KNOWN = ("sphere", "capsule", "cylinder", "cone", "ellipsoid", "box", "segment", "convex", "polygon", "triangle")


def of_case(case, side):
    """Points of the closed outline of shape A or B, one per row; None where the outline is unknown."""
    given = case.get(f"outline{side}")
    if given:
        return np.array([*given, given[0]], dtype=float)
    shape = case[f"shape{side}"]
    return outline(shape, case[f"pose{side}"], case["dim"]) if shape["type"] in KNOWN else None


def outline(shape, pose, dimension):
    """Points of the closed outline in the picture's plane (m), one per row."""
    camera = CAMERA if dimension == 3 else np.eye(2)
    camera = camera / np.linalg.norm(camera, axis=1, keepdims=True)
    turn, at = _turn(pose), np.asarray(pose["t"], dtype=float)
    points = [camera @ (turn @ _support(shape, turn.T @ d) + at) for d in
              (camera.T @ np.array([np.cos(a), np.sin(a)]) for a in TURN)]
    return np.array([*points, points[0]])  # closes the outline


def _turn(pose):
    if "cos_sin" in pose:
        c, s = pose["cos_sin"]
        return np.array([[c, -s], [s, c]])
    w, x, y, z = np.asarray(pose["q_wxyz"], dtype=float) / np.linalg.norm(pose["q_wxyz"])
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def _support(shape, d):
    """The support point along d, in the shape's frame."""
    kind, d = shape["type"], d / np.linalg.norm(d)
    if kind == "sphere":
        return shape["radius"] * d
    if kind == "capsule":
        return np.eye(len(d))[0] * np.copysign(shape["half_length"], d[0]) + shape["radius"] * d
    if kind == "cylinder":
        across = np.array([0, *d[1:]])
        length = np.linalg.norm(across)
        side = across * (shape["radius"] / length) if length > 0 else across
        return np.eye(3)[0] * np.copysign(shape["half_length"], d[0]) + side + shape.get("rounding", 0) * d
    if kind == "cone":  # its tip, or the rim of its base
        tip, base = np.array([shape["half_height"], 0, 0]), np.array([0, *d[1:]])
        length = np.linalg.norm(base)
        rim = base * (shape["radius"] / length if length > 0 else 0) - tip
        return (tip if tip @ d > rim @ d else rim) + shape.get("rounding", 0) * d
    if kind == "ellipsoid":
        half = np.array([shape[f"half_{axis}"] for axis in "xyz"[:len(d)]])
        return half * half * d / np.linalg.norm(half * d) + shape.get("rounding", 0) * d
    if kind == "box":
        return np.copysign(np.asarray(shape["half_extents"], dtype=float), d) + shape.get("radius", 0) * d
    points = np.asarray(shape["points"], dtype=float)  # a segment or a polytope
    return points[np.argmax(points @ d)] + shape.get("radius", 0) * d
