# SPDX-License-Identifier: Zlib
"""Times of pair queries over the vertices of hulls, and on drawn pairs and the pairs of a world with and without cached data."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import failure
import measured
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, holes, identifier, of_sweeps
from finding import Finding, cut
from load import one_machine, split, varying
from sentences import listing, plural, some, span, verb
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, plain_log, same,
                   times)
from table import quantity

SECTION = "Which pair query is fast and right?"
SIZE, TIME = "vertices", "ns_single"
WORK = ("support_calls", "axis_tests", "polytope_faces")  # counted per query; methods without a kind of work have no line for it
FEWEST = 4  # sizes from which an exponent is fitted
STUDENT = {2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306}  # 95 %, by degrees of freedom
LINEAR = "at most linear"
STEEPER = "steeper than linear"
OPEN = "inside the noise of linear"


@of_sweeps("hull_sizes", 72, SECTION,
           Needs("pairs", varies=(SIZE,), metrics=(TIME,)),
           "Time over the vertices of hulls", "This store has no timed sweep of pair queries over the vertices of hulls.",
           "hull_sizes")
def hull_sizes(context, cells):
    if not set(WORK) <= set(cells):  # an older store, without these counts
        return []
    cells, refused = one_machine(context.store, cells)
    cells = cells.assign(drawing=cells["drawing"] if "drawing" in cells else "pairs")
    others = varying(context.store, cells, (SIZE, "drawing", "dimension", "n"))  # the number of queries does not part charts
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        part = cells[dimension_of(cells) == dimension]
        part = part.groupby("method").filter(lambda mine: (mine["outcome"] != "unsupported").any())
        made += [_sizes_chart(context, same_axes, dimension, describe(same_axes.iloc[0], others), refused)
                 for same_axes in split(part, others, sort=True) if len(same_axes)]
    return made


def curve(cells, metric):
    """(vertices, value) of one method, ascending; NaN where it has none. Wrong answers keep their time."""
    part = cells.sort_values(SIZE)
    values = metrics.column(part, metric).copy()
    values[~part["outcome"].isin(["ok", "wrong"]).to_numpy()] = math.nan
    return part[SIZE].astype(float).to_numpy(), values


def exponent(n, values):
    """(exponent of the fitted power of n, half of its 95 % interval), by least squares of logarithms; NaN with few sizes."""
    good = np.isfinite(values) & (values > 0)
    if good.sum() < FEWEST:
        return math.nan, math.nan
    x, y = np.log(n[good]), np.log(values[good])
    slope, level = np.polyfit(x, y, 1)
    free = int(good.sum()) - 2
    spread = float(np.sum((y - level - slope * x) ** 2) / free / np.sum((x - x.mean()) ** 2))
    return float(slope), STUDENT.get(free, 2.3) * math.sqrt(spread)


def last_step(n, values, least):
    """(lowest, highest) exponent from the middle to the largest size, within the noise of two times."""
    good = np.flatnonzero(np.isfinite(values) & (values > 0))
    if len(good) < FEWEST:
        return math.nan, math.nan
    a, b = good[len(good) // 2 - 1], good[-1]
    doublings = math.log(n[b] / n[a])
    found, unsure = math.log(values[b] / values[a]) / doublings, math.log(least) / doublings
    return found - unsure, found + unsure


def judged(n, values, least):
    """Whether the cost is at most linear in n over the larger half of the sizes. Empty with few sizes."""
    low, high = last_step(n, values, least)
    if math.isnan(low):
        return ""
    return STEEPER if low > 1 else LINEAR if high <= 1 else OPEN


def _fits(context, cells, metric, least):
    """One row per drawing and method with enough sizes: exponents and verdict."""
    found = []
    for (drawing, method), part in cells.groupby(["drawing", "method"], sort=True):
        n, values = curve(part, metric)
        slope, half = exponent(n, values)
        if math.isfinite(slope):
            found.append({"drawing": drawing, "method": method, "own": context.store.role(method) == "competitor",
                          "slope": slope, "half": half, "large": sum(last_step(n, values, least)) / 2,
                          "verdict": judged(n, values, least)})
    return pd.DataFrame(found, columns=["drawing", "method", "own", "slope", "half", "large", "verdict"])


def finding_of_sizes(context, fits, dimension):
    """A row per method of LPC, and per drawing the witnesses with the least and the largest exponent."""
    if not len(fits):
        return Finding(f"In {dimension}D no method has times at {FEWEST} sizes of hulls, so no exponent is fitted.")
    own = fits[fits["own"]] if fits["own"].any() else fits
    steep = sorted(set(own["method"][own["verdict"] == STEEPER]))
    linear = [method for method, part in own.groupby("method") if set(part["verdict"]) == {LINEAR}]
    faster = f", faster with {some(steep)}" if steep else ""
    head = (f"In {dimension}D time grows at most linearly in the vertices with {some(linear)}{faster}" if linear else
            f"In {dimension}D time grows faster than linearly in the vertices with {some(steep) if steep else 'no method'}; "
            f"no other "
            "exponent is told from linear") + " (2009 claim: O(E + V))."
    ends = {i for _, part in fits[~fits["own"]].groupby("drawing") for i in (part["slope"].idxmin(), part["slope"].idxmax())}
    shown = fits[fits["own"] | fits.index.isin(ends)]
    order = list(shown.groupby("method")["slope"].mean().sort_values(kind="stable").index)
    table = {"method": list(map(context.name, order))}
    for drawing, part in shown.groupby("drawing", sort=True):
        of = {row.method: row for row in part.itertuples()}
        table |= {f"exponent, {drawing}": [f"{of[m].slope:.2f} ± {of[m].half:.2f}" if m in of else "" for m in order],
                  f"larger half, {drawing} [1]": [of[m].large if m in of else math.nan for m in order],
                  f"verdict, {drawing}": [of[m].verdict if m in of else "" for m in order]}
    return Finding(head, cut(pd.DataFrame(table)))


def headline_of_sizes(cells, dimension, least):
    """The fastest methods at the fewest and at the most vertices, where they differ by more than the noise."""
    for drawing, part in cells.groupby("drawing", sort=True):
        part = part[part["outcome"].isin(["ok"]) & np.isfinite(metrics.column(part, TIME))]
        ends = [noise.leaders(part[part[SIZE] == size], TIME, least) for size in (part[SIZE].min(), part[SIZE].max())]
        names = [{cell["method"] for cell in end} for end in ends]
        if len(part) and all(names) and not names[0] & names[1]:
            few, many = (int(end[0][SIZE]) for end in ends)
            last = part[part[SIZE] == part[SIZE].max()]
            first, second = (some([cell["method"] for cell in end]) for end in ends)
            return Headline(f"In {dimension}D, on pairs {drawing}, {first} {verb(len(ends[0]), 'are')} fastest at {few} vertices "
                            f"of each hull, but {second} at {many}.", dict(zip(last["method"], metrics.column(last, TIME))), "ns",
                            f"time per query at {many} vertices")
    return None


def _sizes_chart(context, cells, dimension, where, refused):
    drawings, methods = sorted(cells["drawing"].unique()), sorted(cells["method"].unique())
    looks, sweep = context.looks(cells), cells["sweep"].iloc[0]
    least = noise.floor_of(context, sweep, TIME)
    shown = [TIME] + [name for name in WORK if (metrics.column(cells, name) > 0).any()]
    legend_width = legend_room(map(context.name, methods), 1.75)
    figure, axes = grid_of_axes(len(drawings), len(shown), 2.3, legend_width, left=0.8, gap_x=0.75, gap_y=0.95, bottom=0.55,
                                top=0.75)
    lines, bad = [], ~cells["outcome"].isin(["ok", "wrong"]).to_numpy()
    for column, metric in enumerate(shown):
        for row, drawing in enumerate(drawings):
            ax, part = axes[row][column], cells[cells["drawing"] == drawing]
            doers = [m for m in methods if metric == TIME or (metrics.column(part[part["method"] == m], metric) > 0).any()]
            if not doers:  # no method makes polytope faces for separated pairs
                ax.set_visible(False)
                continue
            curves = {m: curve(part[part["method"] == m], metric) for m in doers}
            everything = np.concatenate([values for _, values in curves.values()] or [np.array([])])
            everything = everything[np.isfinite(everything)]
            plain_log(ax, "x", part[SIZE].astype(float))
            scale = ZeroLog(ax, "y", everything, context.unit(metric), failures=metric == TIME and bool(bad.any()))
            _guide(ax, part[SIZE].astype(float), everything)
            for method, (n, values) in curves.items():
                good = np.isfinite(values)
                ax.plot(n[good], [scale.place(v) for v in values[good]], **looks(method))
                for at, (_, cell) in zip(n, part[part["method"] == method].sort_values(SIZE).iterrows()):
                    low, high = noise.interval(measured.runs(cell, metric))
                    if high > low:
                        ax.plot([at, at], [scale.place(low), scale.place(high)], color=looks(method)["color"], lw=1.2)
            if metric == TIME:
                fallen(ax, [(float(cell[SIZE]), scale.failed, cell["outcome"], looks(cell["method"])["color"])
                            for _, cell in part.iterrows() if cell["outcome"] not in ("ok", "wrong")])
            ax.set_title(context.title(metric))
            if column == 0:
                ax.set_ylabel(f"pairs {drawing}")
            if row == len(drawings) - 1:
                ax.set_xlabel("vertices of each hull")
            lines.append((f"{drawing}, {context.title(metric)}", one_line(ax, same({m: v for m, (_, v) in curves.items()}),
                                                                         listing)))
    handles = [Line2D([], [], label=context.name(m), **looks(m)) for m in methods]
    handles.append(Line2D([], [], color="#999999", lw=1, ls=(0, (4, 3)), label="slope 1: O(E + V)"))
    handles += [Line2D([], [], ls="none", marker=letter(o), color="#555555", ms=7, label=o)
                for o in sorted(set(cells["outcome"]) - {"ok", "wrong"})]
    legend_right(figure, handles, legend_width)
    fits = _fits(context, cells, TIME, least)
    return Chart(identifier(f"{sweep} {dimension}d {where}"), SECTION, f"Time over the vertices of hulls, {dimension}D"
                 + (f", {where}" if where else ""), finding_of_sizes(context, fits, dimension), sweep,
                 figure, _sizes_table(context, cells, least),
                 refused + holes(cells[bad].assign(step=math.nan), [*(["drawing"] if len(drawings) > 1 else []), "method", SIZE]),
                 "Lower is better; the dashed line is linear growth. All vertices of a hull lie on an ellipsoid. Exponents are "
                 f"fitted over all sizes ({int(cells[SIZE].min())} to {int(cells[SIZE].max())} vertices), with their 95 % "
                 "interval. The verdict is by the larger half of the sizes, where constant costs have faded. A method has a line "
                 f"for the work that it counts; witnesses count none. {noise.rule(least)}"
                 + caption_of_lines(lines), headline=headline_of_sizes(cells, dimension, least))


def _guide(ax, sizes, values):
    """A line of slope 1 through the middle of the values."""
    if len(values) and values.max() > 0:
        low, high = float(sizes.min()), float(sizes.max())
        middle = float(np.exp(np.mean(np.log(values[values > 0]))))
        limits = ax.get_ylim()
        ax.plot([low, high], [middle * low / math.sqrt(low * high), middle * high / math.sqrt(low * high)], color="#999999", lw=1,
                ls=(0, (4, 3)), zorder=0.6)
        ax.set_ylim(limits)


def _sizes_table(context, cells, least):
    table = cells.sort_values(["drawing", "method", SIZE])
    numbers = {}
    for name in (TIME, *WORK, "max_error"):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
        if name in (TIME, *WORK):
            fits = {(d, m): exponent(*curve(part, name))[0] for (d, m), part in table.groupby(["drawing", "method"])}
            numbers[f"exponent of {context.title(name)} [1]"] = [fits[key] for key in zip(table["drawing"], table["method"])]
    return table[["drawing", "method", SIZE, "outcome"]].assign(**numbers)


WAY, BATCHED = "stream", "ns_per_query"
DRAWN, COLD, WARM = "drawn", "cold", "warm"
MARKS = {DRAWN: "o", COLD: "s", WARM: "^"}
ASIDE = {DRAWN: -0.2, COLD: 0.0, WARM: 0.2}  # offset in a row, so that equal values do not hide each other
WORDS = {DRAWN: "drawn pairs", COLD: "pairs of a world, no cache", WARM: "pairs of a world, cached data"}


@of_sweeps("streams", 73, SECTION,
           Needs("pairs", varies=(WAY,), metrics=(BATCHED,)),
           "Time on the pairs of worlds", "This store has no timed sweep of pair queries on streams.", "streams")
def streams(context, cells):
    cells, refused = one_machine(context.store, cells)
    cells = cells[cells[WAY].isin(MARKS)]
    # An axis is named only where a scene has several values of it.
    others = ["scene", *(axis for axis in varying(context.store, cells, (WAY, "dimension", "scene"))
                         if (cells.groupby("scene")[axis].agg(lambda of: of.map(str).nunique()) > 1).any())]
    cells = cells.assign(scene=[describe(row, others) for _, row in cells.iterrows()])
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        mine = cells[dimension_of(cells) == dimension]
        part = _present(mine)
        absent = sorted(set(mine["method"]) - set(part["method"]))
        said = [f"{listing(absent)}: unsupported on every scene"] if absent else []
        made += [_streams_chart(context, part, dimension, refused + said)] if len(part) else []
    return made


def _present(cells):
    """The cells of the scenes and methods that exist in this dimension."""
    for axis in ("scene", "method"):
        cells = cells.groupby(axis).filter(lambda mine: (mine["outcome"] != "unsupported").any())
    return cells


def usable(cell):
    return cell["outcome"] in ("ok", "wrong") and math.isfinite(float(cell[BATCHED]))


def fails(ways, method):
    return any(failure.in_pairs(pd.DataFrame([of[method]]))[0] > 0 for of in ways.values() if method in of)


def by_way(cells):
    """{way: {method: its cell}} of one scene."""
    return {way: {cell["method"]: cell for _, cell in cells[cells[WAY] == way].iterrows() if usable(cell)} for way in MARKS}


def in_world(ways):
    """{method: its cell on the world's pairs}: with cached data, where the method caches any."""
    return {**ways[COLD], **ways[WARM]}


def parted(ways, least):
    """[(a, b, ratio on drawn pairs, ratio in the world)]: beyond the noise, a is faster than b on drawn pairs and slower in the
    world."""
    drawn, world = ways[DRAWN], in_world(ways)
    both = sorted(set(drawn) & set(world))
    found = [(a, b) for a in both for b in both
             if drawn[a][BATCHED] < drawn[b][BATCHED] and world[b][BATCHED] < world[a][BATCHED] and
             noise.tells(drawn[a], drawn[b], BATCHED, least) and noise.tells(world[a], world[b], BATCHED, least)]
    return [(a, b, noise.ratio(drawn[a], drawn[b], BATCHED), noise.ratio(world[b], world[a], BATCHED)) for a, b in found]


def cache_gains(scenes, least):
    """{method: [time without over time with cached data, of each scene where they differ beyond the noise], number of scenes}"""
    found = {}
    for ways in scenes.values():
        for method in sorted(set(ways[COLD]) & set(ways[WARM])):
            pair = ways[WARM][method], ways[COLD][method]
            gains, count = found.get(method, ([], 0))
            told = noise.said(*pair, BATCHED, least)
            found[method] = (gains + [noise.ratio(*pair, BATCHED)] if told[:1].isdigit() else gains), count + 1
    return found


def finding_of_streams(scenes, least, dimension):
    """A row per pair of methods that change ranks, per scene where none does, and per method with cached data."""
    rows, silent = [], 0
    for scene, ways in scenes.items():
        found = parted(ways, least)
        for a, b, drawn, world in found:
            bad = [m for m in (a, b) if fails(ways, m)]
            rows.append({"comparison": f"{b} over {a}", "scene": scene, "ratio of times, drawn pairs": drawn,
                         "ratio of times, pairs of the world": 1 / world,
                         "outcome": f"rank changes; {listing(bad)} {verb(len(bad), 'fail')}" if bad else "rank changes"})
        if not found and len(set(ways[DRAWN]) & set(in_world(ways))) > 1:
            silent += 1
            rows.append({"comparison": "all methods", "scene": scene, "outcome": "no rank changes beyond the noise"})
    changed = len({row["scene"] for row in rows}) - silent
    for method, (gains, count) in cache_gains(scenes, least).items():
        rows.append({"comparison": f"{method}: no cache over cached data", "scene": f"{len(gains)} of {plural(count, 'scene')}",
                     "ratio of times, pairs of the world": span(times(min(gains)), times(max(gains))) if gains else None,
                     "outcome": "" if gains else "inside the noise"})
    compared = changed + silent
    head = (f"In {dimension}D methods change ranks between drawn pairs and a world's pairs on {changed} of "
            f"{plural(compared, 'scene')}, beyond the noise." if compared else
            f"In {dimension}D no scene has two methods with times on drawn pairs and in its world.")
    return Finding(head, cut(pd.DataFrame(rows)))


def headline_of_streams(scenes, least, dimension):
    """The two methods without failures that change ranks most."""
    found = [(min(drawn, world), scene, a, b, drawn, world) for scene, ways in scenes.items()
             for a, b, drawn, world in parted(ways, least) if not fails(ways, a) and not fails(ways, b)]
    if not found:
        return None
    _, scene, a, b, drawn, world = max(found)
    cells = in_world(scenes[scene])
    return Headline(f"On {scene} in {dimension}D {a} is {times(drawn)} times as fast as {b} on drawn pairs, but {b} is "
                    f"{times(world)} times as fast on the pairs of the world.",
                    {m: float(cell[BATCHED]) for m, cell in cells.items()}, "ns", "time per query in the world")


def _streams_chart(context, cells, dimension, refused):
    names, methods = sorted(cells["scene"].unique()), sorted(cells["method"].unique())
    sweep, looks = cells["sweep"].iloc[0], context.looks(cells)
    least = noise.floor_of(context, sweep, BATCHED)
    scenes = {scene: by_way(cells[cells["scene"] == scene]) for scene in names}
    shown = [BATCHED] + [name for name in WORK if name in cells and (metrics.column(cells, name) > 0).any()]
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
        handles.append(Line2D([], [], ls="none", marker="o", mfc="none", mec="#D62728", ms=11, label="fails"))
    legend_right(figure, handles, 2.75)
    bad = cells[~cells["outcome"].isin(["ok", "wrong"])]
    cold = {(row["scene"], row["method"]) for _, row in cells.iterrows() if row[WAY] == COLD and usable(row)}
    said = [(row["scene"], row["method"]) in cold and row[WAY] == WARM and row["outcome"] == "unsupported"
            for _, row in bad.iterrows()]  # without cached data: not a hole
    bad = bad[~np.array(said, bool)]
    return Chart(identifier(f"{sweep} {dimension}d"), SECTION, f"Time on drawn pairs and on the pairs of worlds, {dimension}D",
                 finding_of_streams(scenes, least, dimension), sweep, figure, _streams_table(context, cells),
                 refused + holes(bad.assign(step=math.nan), ["scene", "method", WAY]),
                 "Left is better. Drawn pairs have the kinds of shapes of the scene, with the same shares. The world's pairs are "
                 "asked step by step, in the order of the world; with cached data the time includes the look-up. "
                 f"{noise.rule(least)} {failure.DEFINITION}", headline=headline_of_streams(scenes, least, dimension))


def _panel(ax, context, ways, metric, methods, looks):
    found = {(way, m): float(cell[metric]) for way, of in ways.items() for m, cell in of.items()
             if metric == BATCHED or float(cell[metric]) > 0}
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


def _streams_table(context, cells):
    table = cells.sort_values(["scene", "method", WAY])
    numbers = {}
    for name in [BATCHED, *(n for n in WORK if n in cells), "max_error"]:
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    return table[["scene", "method", WAY, "outcome"]].assign(failures=failure.in_pairs(table), **numbers)
