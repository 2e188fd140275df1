# SPDX-License-Identifier: Zlib
"""Finds texts of a figure that overlap or are cut off."""

import io
import math

import matplotlib.text
import numpy as np
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.legend import Legend

SLACK = 0.75  # points by which the boxes of two texts may overlap, because a box is a little larger than its letters


def overlaps(figure):
    """(pairs of texts that overlap, texts cut off by the edge), measured in the layout of the SVG. The letters of failed runs,
    which the edge of their axes cuts off, and the handles of legends count as texts."""
    dpi = figure.dpi
    figure.set_dpi(72)  # as SVG: one dot is one point
    wide, high = figure.bbox.width, figure.bbox.height
    renderer = Measuring(wide, high, io.StringIO(), image_dpi=72)
    figure.draw(renderer)
    hidden = _hidden(figure)
    boxes = [_box(text, renderer) for text in figure.findobj(matplotlib.text.Text)
             if text.get_text().strip() and text.get_visible() and id(text) not in hidden]
    marks = [(box, line) for ax in figure.axes if ax.get_visible() for line in ax.lines for box in _letters(line)]
    boxes += [box for box, _ in marks]
    cut = [box.words for box, line in marks if line.get_clip_on() and not _within(box, line.axes.bbox)]
    boxes += [_handle(handle, renderer) for legend in figure.findobj(Legend) if legend.get_visible()
              # legendHandles: as matplotlib before 3.7 calls them
              for handle in getattr(legend, "legend_handles", None) or legend.legendHandles]
    figure.set_dpi(dpi)
    together = [(a.words, b.words) for a, b in near(boxes) if a.meets(b) and b.meets(a)]
    outside = [box.words for box in boxes if box.corners.min() < -SLACK or box.corners[:, 0].max() > wide + SLACK or
               box.corners[:, 1].max() > high + SLACK]
    return together, list(dict.fromkeys(outside + cut))


class Measuring(RendererSVG):
    """An SVG renderer that measures texts and draws nothing."""

    def draw_path(self, *arguments, **options):
        pass

    draw_markers = draw_path_collection = draw_quad_mesh = draw_gouraud_triangles = draw_image = draw_text = draw_tex = draw_path


def near(boxes):
    """The pairs of boxes, in order, with overlapping axis-aligned bounds: the few of hundreds that need the exact test."""
    if not boxes:
        return []
    corners = np.array([box.corners for box in boxes])
    low, high = corners.min(axis=1), corners.max(axis=1)
    apart = ((low[:, None] >= high[None]) | (low[None] >= high[:, None])).any(axis=2)
    return [(boxes[i], boxes[j]) for i, j in np.argwhere(np.triu(~apart, 1))]


class Box:
    """An oriented rectangle around words."""

    def __init__(self, words, centre, wide, high, angle=0.0):
        self.words = words
        along = np.array([math.cos(angle), math.sin(angle)])
        self.sides = np.array([along, [-along[1], along[0]]])
        half = self.sides * [[wide / 2], [high / 2]]
        self.corners = np.array([centre + a * half[0] + b * half[1] for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))])

    def meets(self, other):
        """Whether no axis of this box separates the two."""
        mine, theirs = self.corners @ self.sides.T, other.corners @ self.sides.T
        deep = np.minimum(mine.max(axis=0), theirs.max(axis=0)) - np.maximum(mine.min(axis=0), theirs.min(axis=0))
        return bool((deep > SLACK).all())


def _box(text, renderer):
    """The oriented box of a text: the centre of its bounds, with the size of the unrotated text."""
    around, angle = text.get_window_extent(renderer), text.get_rotation()
    centre = np.array([(around.x0 + around.x1) / 2, (around.y0 + around.y1) / 2])
    text.set_rotation(0)
    flat = text.get_window_extent(renderer)
    text.set_rotation(angle)
    return Box(text.get_text(), centre, flat.width, flat.height, math.radians(angle))


def _letters(line):
    """Boxes of the markers that are letters."""
    marker = line.get_marker()
    if not isinstance(marker, str) or not marker.startswith("$") or not line.get_visible():
        return []
    size = 0.8 * line.get_markersize()
    data = np.column_stack([line.get_xdata(orig=False), line.get_ydata(orig=False)]).astype(float)
    spots = line.get_transform().transform(data)
    return [Box(marker, spot, size, size) for spot in spots if np.isfinite(spot).all()]


def _within(box, area):
    return (box.corners >= (area.x0 - SLACK, area.y0 - SLACK)).all() and (box.corners <= (area.x1 + SLACK, area.y1 + SLACK)).all()


def _handle(handle, renderer):
    """The box of a legend's symbol, as wide as it is drawn."""
    around = handle.get_window_extent(renderer)
    return Box("a handle", np.array([around.x0 + around.x1, around.y0 + around.y1]) / 2, around.width, around.height)


def _hidden(figure):
    """Ids of texts that are not drawn: matplotlib keeps the labels of ticks outside the limits."""
    hidden = set()
    for ax in figure.axes:
        for axis, limits in ((ax.xaxis, sorted(ax.get_xlim())), (ax.yaxis, sorted(ax.get_ylim()))):
            for tick in axis.get_major_ticks() + axis.get_minor_ticks():
                if not (ax.get_visible() and ax.axison) or not limits[0] <= tick.get_loc() <= limits[1]:
                    hidden |= {id(tick.label1), id(tick.label2)}
        if not ax.get_visible():
            hidden |= {id(text) for text in ax.findobj(matplotlib.text.Text)}
    return hidden
