# SPDX-License-Identifier: Zlib
"""Figures that are not drawn, for tests of what charts say: to draw takes most of the time of a chart. Axes take every call, and
know where they stand and how far they reach, since sentences depend on the room. A test that looks at a picture is marked with
`@drawn`. With LPC_DRAW_ALL in the environment all are drawn, as they are with tests/run --deep."""

import contextlib
import os
import unittest
import unittest.mock

import numpy as np
from matplotlib.transforms import Bbox, IdentityTransform

import overlap
import style

ALL = bool(os.environ.get("LPC_DRAW_ALL"))


class Taken:
    """What takes every call, and gives the like of itself."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return Taken()

    def __call__(self, *_, **__):
        return Taken()

    def __iter__(self):
        return iter((Taken(),))

    def __getitem__(self, _):
        return Taken()

    def __setitem__(self, *_):
        pass


class Axes(Taken):
    transData = transAxes = IdentityTransform()

    def __init__(self, figure):
        self.figure, self.title = figure, ""

    def get_position(self):
        return Bbox.from_bounds(0.1, 0.1, 0.3, 0.8)

    def get_window_extent(self, *_):
        return Bbox.from_bounds(100, 100, 300, 300)

    def get_xlim(self):
        return (0.0, 1.0)

    get_ylim = get_xlim

    def set_title(self, title, **_):
        self.title = title

    def get_title(self, *_):
        return self.title


class Figure(Taken):
    dpi = 100

    def __init__(self, figsize=(style.WIDTH, 4.0), **_):
        self.size = list(figsize)

    def get_figwidth(self):
        return self.size[0]

    def get_figheight(self):
        return self.size[1]

    def get_size_inches(self):
        return self.size

    def set_figheight(self, height):
        self.size[1] = height

    def add_axes(self, *_, **__):
        return Axes(self)

    def refuse(self, *_, **__):
        raise AssertionError("the picture is not drawn: mark the test with @drawn")

    axes = texts = legends = property(refuse)  # what a test would look at
    findobj = savefig = draw = refuse


def subplots(rows=1, columns=1, squeeze=True, figsize=(style.WIDTH, 4.0), **_):
    figure = Figure(figsize)
    axes = np.empty((rows, columns), dtype=object)
    for place in np.ndindex(rows, columns):
        axes[place] = Axes(figure)
    return figure, axes[0, 0] if squeeze and axes.size == 1 else axes


@contextlib.contextmanager
def undrawn():
    with unittest.mock.patch.multiple(style.plt, subplots=subplots, figure=Figure, close=lambda *_: None), (
            unittest.mock.patch.object(overlap, "overlaps", Figure.refuse)):
        yield


def drawn(test):
    """Marks a test, or all of a class, as one that looks at pictures."""
    test.drawn = True
    return test


class Undrawn(unittest.TestCase):
    """Its tests draw nothing, but for those that are marked."""

    def setUp(self):
        super().setUp()
        self.draws = ALL or getattr(self, "drawn", False) or getattr(getattr(self, self._testMethodName), "drawn", False)
        if not self.draws:
            context = undrawn()
            context.__enter__()
            self.addCleanup(context.__exit__, None, None, None)
