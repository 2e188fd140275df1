# SPDX-License-Identifier: Zlib
"""Pair queries on drawn pairs and on the pairs that worlds ask about, cold and warm: times, work, and where ranks part."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import failure
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, holes, identifier, listing, of_sweeps
from load import one_machine, varying
from style import ZeroLog, grid_of_axes, legend_right, times
from table import quantity

SECTION = "Which pair query is fast and right?"
WAY, TIME = "stream", "ns_per_query"
WORK = ("support_calls", "axis_tests", "polytope_faces")
DRAWN, COLD, WARM = "drawn", "cold", "warm"
MARKS = {DRAWN: "o", COLD: "s", WARM: "^"}
ASIDE = {DRAWN: -0.2, COLD: 0.0, WARM: 0.2}  # of a row, so that what is alike does not hide the other
WORDS = {DRAWN: "drawn pairs", COLD: "a world's, each as if new", WARM: "a world's, with what is remembered"}


@of_sweeps("streams", 73, SECTION,
           Needs("pairs", varies=(WAY,), metrics=(TIME,)),
           "On the pairs of worlds", "No timed sweep of pair queries on streams is in this store.", "streams")
def streams(context, cells):
    cells, refused = one_machine(context.store, cells)
    cells = cells[cells[WAY].isin(MARKS)]
    # What a scene has one value of needs no word.
    others = ["scene", *(axis for axis in varying(context.store, cells, (WAY, "dimension", "scene"))
                         if (cells.groupby("scene")[axis].agg(lambda of: of.map(str).nunique()) > 1).any())]
    cells = cells.assign(scene=[describe(row, others) for _, row in cells.iterrows()])
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        mine = cells[dimension_of(cells) == dimension]
        part = _present(mine)
        absent = sorted(set(mine["method"]) - set(part["method"]))
        said = [f"{listing(absent)}: unsupported on every scene"] if absent else []
        made += [_chart(context, part, dimension, refused + said)] if len(part) else []
    return made


def _present(cells):
    """Scenes and methods that exist in this dimension."""
    for axis in ("scene", "method"):
        cells = cells.groupby(axis).filter(lambda mine: (mine["outcome"] != "unsupported").any())
    return cells


def usable(cell):
    return cell["outcome"] in ("ok", "wrong") and math.isfinite(float(cell[TIME]))


def fails(ways, method):
    return any(failure.in_pairs(pd.DataFrame([of[method]]))[0] > 0 for of in ways.values() if method in of)


def by_way(cells):
    """{way: {method: its cell}} of one scene."""
    return {way: {cell["method"]: cell for _, cell in cells[cells[WAY] == way].iterrows() if usable(cell)} for way in MARKS}


def in_world(ways):
    """{method: its cell on the stream}: with what it remembers, where it remembers something."""
    return {**ways[COLD], **ways[WARM]}


def parted(ways, least):
    """[(a, b, drawn ratio, ratio in the world)]: a is told to be faster than b on drawn pairs, and b than a in the world."""
    drawn, world = ways[DRAWN], in_world(ways)
    both = sorted(set(drawn) & set(world))
    found = [(a, b) for a in both for b in both if drawn[a][TIME] < drawn[b][TIME] and world[b][TIME] < world[a][TIME] and
             noise.tells(drawn[a], drawn[b], TIME, least) and noise.tells(world[a], world[b], TIME, least)]
    return [(a, b, noise.ratio(drawn[a], drawn[b], TIME), noise.ratio(world[b], world[a], TIME)) for a, b in found]


def remembered(scenes, least):
    """{method: {scene: (cold over warm, the ratio in words or why there is none)}}"""
    found = {}
    for scene, ways in scenes.items():
        for method in sorted(set(ways[COLD]) & set(ways[WARM])):
            pair = ways[WARM][method], ways[COLD][method]
            found.setdefault(method, {})[scene] = noise.ratio(*pair, TIME), noise.said(*pair, TIME, least)
    return found


def finding(scenes, least, dimension):
    said, apart = [], {scene: parted(ways, least) for scene, ways in scenes.items()}
    several = [scene for scene, ways in scenes.items() if len(set(ways[DRAWN]) & set(in_world(ways))) > 1]
    for scene, found in apart.items():
        for a, b, drawn, world in found:
            bad = [m for m in (a, b) if fails(scenes[scene], m)]
            said.append(f"on {scene} {b} takes {times(1 / world)} times the time of {a}, on drawn pairs {times(drawn)} times"
                        + (f" (but {listing(bad)} fail{'s' if len(bad) == 1 else ''} somewhere)" if bad else ""))
    silent = [scene for scene in several if not apart[scene]]
    text = f"In {dimension}D ranks part: {'; '.join(said)}" if said else ""
    if silent:
        text += ("; " if said else f"In {dimension}D ") + f"no rank parts beyond the noise on {listing(silent)}"
    text = text or f"In {dimension}D no scene has two methods with a time on drawn pairs and in its world"
    for method, of in remembered(scenes, least).items():
        told = [ratio for ratio, word in of.values() if word and word not in noise.IN_WORDS]
        if told:
            ends = dict.fromkeys((times(min(told)), times(max(told))))
            text += (f". Cold, {method} takes {' to '.join(ends)} times its time with what it remembers, on {len(told)} of "
                     f"{len(of)} scenes beyond the noise")
        else:
            text += f". What {method} remembers changes its time beyond the noise on none of {len(of)} scenes"
    return text + "."


def headline(scenes, least, dimension):
    """The pair of methods whose ranks part by most, of those that fail nowhere."""
    found = [(min(drawn, world), scene, a, b, drawn, world) for scene, ways in scenes.items()
             for a, b, drawn, world in parted(ways, least) if not fails(ways, a) and not fails(ways, b)]
    if not found:
        return None
    _, scene, a, b, drawn, world = max(found)
    cells = in_world(scenes[scene])
    return Headline(f"{scene}, {dimension}D: on drawn pairs {a} is {times(drawn)} times as fast as {b}, on the pairs of the "
                    "world "
                    f"{b} is {times(world)} times as fast as {a}.", {m: float(cell[TIME]) for m, cell in cells.items()}, "ns",
                    "time per query in the world")


def _chart(context, cells, dimension, refused):
    names, methods = sorted(cells["scene"].unique()), sorted(cells["method"].unique())
    sweep, looks = cells["sweep"].iloc[0], context.looks(cells)
    least = noise.floor_of(context, sweep, TIME)
    scenes = {scene: by_way(cells[cells["scene"] == scene]) for scene in names}
    shown = [TIME] + [name for name in WORK if name in cells and (metrics.column(cells, name) > 0).any()]
    room = 0.3 + 0.078 * max(map(len, map(context.name, methods)))
    figure, axes = grid_of_axes(len(shown), len(names), 0.35 + 0.26 * len(methods), 2.75, left=room, gap_x=0.3, gap_y=0.62)
    for row, metric in enumerate(shown):
        for column, scene in enumerate(names):
            _panel(axes[row][column], context, scenes[scene], metric, methods, looks)
            axes[row][column].tick_params(labelleft=column == 0)
            axes[row][column].set_xlabel(context.title(metric))
            if row == 0:
                axes[row][column].set_title(scene, fontsize=9)
    handles = [Line2D([], [], ls="none", marker=MARKS[way], color="#555555", ms=6, label=WORDS[way]) for way in MARKS]
    failing = cells["outcome"].isin(["ok", "wrong"]) & (failure.in_pairs(cells) > 0)
    if failing.any():
        handles.append(Line2D([], [], ls="none", marker="o", mfc="none", mec="#D62728", ms=11, label="fails somewhere"))
    legend_right(figure, handles, 2.75)
    bad = cells[~cells["outcome"].isin(["ok", "wrong"])]
    cold = {(row["scene"], row["method"]) for _, row in cells.iterrows() if row[WAY] == COLD and usable(row)}
    said = [(row["scene"], row["method"]) in cold and row[WAY] == WARM and row["outcome"] == "unsupported"
            for _, row in bad.iterrows()]  # it remembers nothing: no hole
    bad = bad[~np.array(said, bool)]
    return Chart(identifier(f"{sweep} {dimension}d"), SECTION, f"On drawn pairs and on those of worlds, {dimension}D",
                 finding(scenes, least, dimension), sweep, figure, _table(context, cells),
                 refused + holes(bad.assign(step=math.nan), ["scene", "method", WAY]),
                 "Drawn pairs are of the kinds that meet in the scene, as often as they do, each by itself. A world's are "
                 "asked in "
                 "its order, step by step; with what is remembered, the time to find it is in it; what remembers nothing has "
                 "none. A rank parts where both orders "
                 f"are told. {noise.rule(least)} {failure.DEFINITION}", headline=headline(scenes, least, dimension))


def _panel(ax, context, ways, metric, methods, looks):
    found = {(way, m): float(cell[metric]) for way, of in ways.items() for m, cell in of.items()
             if metric == TIME or float(cell[metric]) > 0}
    known = {key: value for key, value in found.items() if math.isfinite(value)}
    scale = ZeroLog(ax, "x", list(known.values()), context.unit(metric), failures=False)
    for y, method in enumerate(methods):
        mine = [(way, known[way, method]) for way in MARKS if (way, method) in known]
        colour = looks(method)["color"]
        if mine:
            ax.plot([scale.place(value) for _, value in mine], [y + ASIDE[way] for way, _ in mine], color=colour, lw=1, alpha=0.5)
        for way, value in mine:
            ax.plot([scale.place(value)], [y + ASIDE[way]], ls="none", marker=MARKS[way], color=colour, ms=6)
            if failure.in_pairs(pd.DataFrame([ways[way][method]]))[0] > 0:
                ax.plot([scale.place(value)], [y + ASIDE[way]], ls="none", marker="o", mfc="none", mec="#D62728", ms=11)
    ax.set_ylim(len(methods) - 0.5, -0.5)
    ax.set_yticks(range(len(methods)))
    ax.set_yticklabels(list(map(context.name, methods)))


def _table(context, cells):
    table = cells.sort_values(["scene", "method", WAY])
    numbers = {}
    for name in [TIME, *(n for n in WORK if n in cells), "max_error"]:
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    return table[["scene", "method", WAY, "outcome"]].assign(failures=failure.in_pairs(table), **numbers)
