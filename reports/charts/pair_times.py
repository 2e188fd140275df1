# SPDX-License-Identifier: Zlib
"""Times of pair queries: over the vertices of hulls, and on the pairs of a world, cold, warm and drawn."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import failure
import measured
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, holes, identifier, of_sweeps
from load import one_machine, split, varying
from sentences import clauses, does, listing, span
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, plain_log, same,
                   times)
from table import quantity

SECTION = "Which pair query is fast and right?"
SIZE, TIME = "vertices", "ns_single"
WORK = ("support_calls", "axis_tests", "polytope_faces")  # counted per query; who does none of one is not drawn there
FEWEST = 4  # sizes from which an exponent is fitted
STUDENT = {2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306}  # 95 %, by degrees of freedom
LINEAR = "at most linear"
STEEPER = "steeper than linear"
OPEN = "not told from linear"


@of_sweeps("hull_sizes", 72, SECTION,
           Needs("pairs", varies=(SIZE,), metrics=(TIME,)),
           "Over the vertices of hulls", "No timed sweep of pair queries over the vertices of hulls is in this store.",
           "hull_sizes")
def hull_sizes(context, cells):
    if not set(WORK) <= set(cells):  # a store of before trials counted it
        return []
    cells, refused = one_machine(context.store, cells)
    cells = cells.assign(drawing=cells["drawing"] if "drawing" in cells else "pairs")
    others = varying(context.store, cells, (SIZE, "drawing", "dimension", "n"))  # how many are asked is no difference
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        part = cells[dimension_of(cells) == dimension]
        part = part.groupby("method").filter(lambda mine: (mine["outcome"] != "unsupported").any())
        made += [_sizes_chart(context, same_axes, dimension, describe(same_axes.iloc[0], others), refused)
                 for same_axes in split(part, others, sort=True) if len(same_axes)]
    return made


def curve(cells, metric):
    """(vertices, value) of one method, ascending; NaN where it has none. A wrong answer has its time, too."""
    part = cells.sort_values(SIZE)
    values = metrics.column(part, metric).copy()
    values[~part["outcome"].isin(["ok", "wrong"]).to_numpy()] = math.nan
    return part[SIZE].astype(float).to_numpy(), values


def exponent(n, values):
    """(exponent, half of its interval of 95 %) of the power of n that fits, by least squares of logarithms; NaN with few."""
    good = np.isfinite(values) & (values > 0)
    if good.sum() < FEWEST:
        return math.nan, math.nan
    x, y = np.log(n[good]), np.log(values[good])
    slope, level = np.polyfit(x, y, 1)
    free = int(good.sum()) - 2
    spread = float(np.sum((y - level - slope * x) ** 2) / free / np.sum((x - x.mean()) ** 2))
    return float(slope), STUDENT.get(free, 2.3) * math.sqrt(spread)


def last_step(n, values, least):
    """(lowest, highest) exponent from the middle to the largest size, as far as the noise of two times lets it be known."""
    good = np.flatnonzero(np.isfinite(values) & (values > 0))
    if len(good) < FEWEST:
        return math.nan, math.nan
    a, b = good[len(good) // 2 - 1], good[-1]
    doublings = math.log(n[b] / n[a])
    found, unsure = math.log(values[b] / values[a]) / doublings, math.log(least) / doublings
    return found - unsure, found + unsure


def judged(n, values, least):
    """Whether the data bear that a cost is at most linear in n, over the larger half of the sizes. Empty where those are few."""
    low, high = last_step(n, values, least)
    if math.isnan(low):
        return ""
    return STEEPER if low > 1 else LINEAR if high <= 1 else OPEN


def _fits(context, cells, metric, least):
    """One row per drawing and method that has enough sizes: exponents and what they say."""
    found = []
    for (drawing, method), part in cells.groupby(["drawing", "method"], sort=True):
        n, values = curve(part, metric)
        slope, half = exponent(n, values)
        if math.isfinite(slope):
            found.append({"drawing": drawing, "method": method, "ours": context.store.role(method) == "competitor",
                          "slope": slope, "half": half, "large": sum(last_step(n, values, least)) / 2,
                          "verdict": judged(n, values, least)})
    return pd.DataFrame(found, columns=["drawing", "method", "ours", "slope", "half", "large", "verdict"])


def finding_of_sizes(fits, cells, dimension):
    low, high = int(cells[SIZE].min()), int(cells[SIZE].max())
    if not len(fits):
        return f"In {dimension}D no method has a time at {FEWEST} numbers of vertices, so that no exponent is fitted."
    said = []
    for drawing, part in fits.groupby("drawing", sort=True):
        ours, others = part[part["ours"]], part[~part["ours"]]
        told = [f"{row.method} as V^{row.slope:.2f} ± {row.half:.2f}, from the middle on V^{row.large:.2f}"
                for row in ours.itertuples()]
        if len(others):
            told.append(f"witnesses as V^{others['slope'].min():.2f} ({others.loc[others['slope'].idxmin(), 'method']}) to "
                        f"V^{others['slope'].max():.2f} ({others.loc[others['slope'].idxmax(), 'method']})")
        said.append(f"on pairs {drawing} {'; '.join(told)}")
    verdicts = []
    for verdict in (LINEAR, STEEPER, OPEN):
        names = sorted(set(fits[fits["verdict"] == verdict]["method"]))
        whole = [m for m in names if set(fits[fits["method"] == m]["verdict"]) == {verdict}]
        part = [f"{m} ({listing(sorted(fits[(fits['method'] == m) & (fits['verdict'] == verdict)]['drawing']))})"
                for m in names if m not in whole]
        verdicts += [f"{verdict}: {listing(whole + part)}"] if names else []
    return (f"In {dimension}D, from {low} to {high} vertices of each hull, the time of a query grows {'; '.join(said)}. The "
            f"claim of 2009, O(E + V), is a slope of 1: {'; '.join(verdicts)}.")


def counted(context, cells):
    """How what is counted grows, in words: it has no noise of a clock."""
    said = []
    for name in WORK:
        for drawing, part in cells.groupby("drawing", sort=True):
            found = {m: exponent(*curve(of, name)) for m, of in part.groupby("method", sort=True)}
            told = [f"{m} V^{slope:.2f} ± {half:.2f}" for m, (slope, half) in found.items() if math.isfinite(slope)]
            said += [f"{context.title(name)} on pairs {drawing}, {listing(told)}"] if told else []
    return f" Counted work: {'; '.join(said)}." if said else ""


def headline_of_sizes(cells, dimension, least):
    """The fastest at the fewest and at the most vertices, where they differ by more than the noise."""
    for drawing, part in cells.groupby("drawing", sort=True):
        part = part[part["outcome"].isin(["ok"]) & np.isfinite(metrics.column(part, TIME))]
        ends = [noise.leaders(part[part[SIZE] == size], TIME, least) for size in (part[SIZE].min(), part[SIZE].max())]
        names = [{cell["method"] for cell in end} for end in ends]
        if len(part) and all(names) and not names[0] & names[1]:
            few, many = (int(end[0][SIZE]) for end in ends)
            last = part[part[SIZE] == part[SIZE].max()]
            return Headline(f"In {dimension}D, of pairs {drawing}, {listing([c['method'] for c in ends[0]])} is the fastest at "
                            f"{few} vertices of each hull and {listing([c['method'] for c in ends[1]])} at {many}, both beyond "
                            "the noise.", dict(zip(last["method"], metrics.column(last, TIME))), "ns",
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
            if not doers:  # of pairs apart nobody makes faces
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
    return Chart(identifier(f"{sweep} {dimension}d {where}"), SECTION, f"Over the vertices of hulls, {dimension}D"
                 + (f", {where}" if where else ""), finding_of_sizes(fits, cells, dimension) + counted(context, cells), sweep,
                 figure, _sizes_table(context, cells, least),
                 refused + holes(cells[bad].assign(step=math.nan), [*(["drawing"] if len(drawings) > 1 else []), "method", SIZE]),
                 "Both axes are logarithmic; the dashed line has the slope 1. All vertices of a hull lie on an ellipsoid. "
                 "Exponents "
                 "are fitted by least squares of logarithms over all sizes, with their interval of 95 %; “from the middle on” "
                 "is the "
                 "slope over the larger half, where what does not grow has faded, and it decides what is linear, within "
                 f"the noise of two times. What counts none of a work is not drawn there; witnesses count nothing. "
                 f"{noise.rule(least)}"
                 + caption_of_lines(lines), headline=headline_of_sizes(cells, dimension, least))


def _guide(ax, sizes, values):
    """A line of slope 1 through the middle of what is drawn."""
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
ASIDE = {DRAWN: -0.2, COLD: 0.0, WARM: 0.2}  # of a row, so that what is alike does not hide the other
WORDS = {DRAWN: "drawn pairs", COLD: "a world's, each as if new", WARM: "a world's, with what is remembered"}


@of_sweeps("streams", 73, SECTION,
           Needs("pairs", varies=(WAY,), metrics=(BATCHED,)),
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
        made += [_streams_chart(context, part, dimension, refused + said)] if len(part) else []
    return made


def _present(cells):
    """Scenes and methods that exist in this dimension."""
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
    """{method: its cell on the stream}: with what it remembers, where it remembers something."""
    return {**ways[COLD], **ways[WARM]}


def parted(ways, least):
    """[(a, b, drawn ratio, ratio in the world)]: a is told to be faster than b on drawn pairs, and b than a in the world."""
    drawn, world = ways[DRAWN], in_world(ways)
    both = sorted(set(drawn) & set(world))
    found = [(a, b) for a in both for b in both
             if drawn[a][BATCHED] < drawn[b][BATCHED] and world[b][BATCHED] < world[a][BATCHED] and
             noise.tells(drawn[a], drawn[b], BATCHED, least) and noise.tells(world[a], world[b], BATCHED, least)]
    return [(a, b, noise.ratio(drawn[a], drawn[b], BATCHED), noise.ratio(world[b], world[a], BATCHED)) for a, b in found]


def remembered(scenes, least):
    """{method: {scene: (cold over warm, the ratio in words or why there is none)}}"""
    found = {}
    for scene, ways in scenes.items():
        for method in sorted(set(ways[COLD]) & set(ways[WARM])):
            pair = ways[WARM][method], ways[COLD][method]
            found.setdefault(method, {})[scene] = noise.ratio(*pair, BATCHED), noise.said(*pair, BATCHED, least)
    return found


def finding_of_streams(scenes, least, dimension):
    said, apart = [], {scene: parted(ways, least) for scene, ways in scenes.items()}
    for scene, found in apart.items():
        for a, b, drawn, world in found:
            bad = [m for m in (a, b) if fails(scenes[scene], m)]
            said.append(f"on {scene} {b} takes {times(1 / world)} times the time of {a}, on drawn pairs {times(drawn)} times"
                        + (f" (but {does(bad, 'fail')} somewhere)" if bad else ""))
    silent = [scene for scene, ways in scenes.items() if len(set(ways[DRAWN]) & set(in_world(ways))) > 1 and not apart[scene]]
    told = clauses(said and f"ranks part: {'; '.join(said)}", silent and f"no rank parts beyond the noise on {listing(silent)}")
    text = [f"In {dimension}D {told or 'no scene has two methods with a time on drawn pairs and in its world'}"]
    for method, of in remembered(scenes, least).items():
        beyond = [ratio for ratio, word in of.values() if word and word not in noise.IN_WORDS]
        text.append(f"Cold, {method} takes {span(times(min(beyond)), times(max(beyond)))} times its time with what it remembers, "
                    f"on {len(beyond)} of {len(of)} scenes beyond the noise" if beyond else
                    f"What {method} remembers changes its time beyond the noise on none of {len(of)} scenes")
    return clauses(*text, between=". ") + "."


def headline_of_streams(scenes, least, dimension):
    """The pair of methods whose ranks part by most, of those that fail nowhere."""
    found = [(min(drawn, world), scene, a, b, drawn, world) for scene, ways in scenes.items()
             for a, b, drawn, world in parted(ways, least) if not fails(ways, a) and not fails(ways, b)]
    if not found:
        return None
    _, scene, a, b, drawn, world = max(found)
    cells = in_world(scenes[scene])
    return Headline(f"{scene}, {dimension}D: on drawn pairs {a} is {times(drawn)} times as fast as {b}, on the pairs of the "
                    "world "
                    f"{b} is {times(world)} times as fast as {a}.", {m: float(cell[BATCHED]) for m, cell in cells.items()}, "ns",
                    "time per query in the world")


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
        handles.append(Line2D([], [], ls="none", marker="o", mfc="none", mec="#D62728", ms=11, label="fails somewhere"))
    legend_right(figure, handles, 2.75)
    bad = cells[~cells["outcome"].isin(["ok", "wrong"])]
    cold = {(row["scene"], row["method"]) for _, row in cells.iterrows() if row[WAY] == COLD and usable(row)}
    said = [(row["scene"], row["method"]) in cold and row[WAY] == WARM and row["outcome"] == "unsupported"
            for _, row in bad.iterrows()]  # it remembers nothing: no hole
    bad = bad[~np.array(said, bool)]
    return Chart(identifier(f"{sweep} {dimension}d"), SECTION, f"On drawn pairs and on those of worlds, {dimension}D",
                 finding_of_streams(scenes, least, dimension), sweep, figure, _streams_table(context, cells),
                 refused + holes(bad.assign(step=math.nan), ["scene", "method", WAY]),
                 "Drawn pairs are of the kinds that meet in the scene, as often as they do, each by itself. A world's are "
                 "asked in "
                 "its order, step by step; with what is remembered, the time to find it is in it; what remembers nothing has "
                 "none. A rank parts where both orders "
                 f"are told. {noise.rule(least)} {failure.DEFINITION}", headline=headline_of_streams(scenes, least, dimension))


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
