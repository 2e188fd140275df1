# SPDX-License-Identifier: Zlib
"""What to take for a given scene: every stage's methods in whole steps of it, and the cheapest of those that are right."""

import math

import pandas as pd
from matplotlib.lines import Line2D

import metrics
from chart import Chart, Headline, describe, holes, identifier, listing
from charts.cost_against_error import errors_of
from charts.equal_cost import ranks, spread
from load import axes_of, one_machine, split
from style import HALO, ZeroLog, grid_of_axes, legend_right, legend_room, letter, scale_of, si, times
from table import quantity

PLACE = 5
SECTION = "What should one take for this scene?"
COST = "ms_per_step_median"
KIND = "world"
# A method errs as little as the others when it errs at most so many times the least: half as wrong is worth no time.
AS_RIGHT = 2.0
ABSENT = Chart("choose", SECTION, "What to take", "No sweep that chooses is in this store; experiments/run choose makes one.",
               "choose")


def of_store(context):
    """One chart per scene, of all sweeps that name this chart."""
    sweeps = [name for name in context.store.sweeps() if "choose" in context.store.sweep(name).report]
    parts = {}
    for sweep in sweeps:
        for cells, refused in of_sweep(context, context.cells(sweep)):
            where = describe(cells.iloc[0], _place(context, cells))
            parts.setdefault(where, []).append((sweep, cells, refused))
    return [_chart(context, where, found) for where, found in parts.items()]


def of_sweep(context, cells):
    """(cells that may be compared, refused): one for each scene and size."""
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, context.metrics(KIND, "error")))
    return [(part, refused) for part in split(cells, _place(context, cells))]


def _place(context, cells):
    """The scene and all that makes it larger or harder."""
    about = context.store.sweep(cells["sweep"].iloc[0])
    axes = [axis for axis in cells.columns if axis in axes_of(context.store, cells) and
            (axis in ("scene", "dimension", "steps") or about.roles.get(axis) == "parameter")]
    return sorted(axes, key=lambda axis: (axis != "scene", axis != "dimension", axis))


def question(context, sweep):
    """`broadphase`, `contacts`, `resolver`: the axis along which the methods compete."""
    return context.store.method_axes(sweep)[0]


def chosen(context, cells, error):
    """(rows, method to take or None, those that tie with it). Rows are (rank, method, time, lowest, highest); ranks are by
    time among the competitors that finished and err as little as the best of them."""
    mine = cells[[context.store.role(method) == "competitor" for method in cells["method"]]]
    errors = {method: spread(part, error)[0] for method, part in mine.groupby("method")}
    finite = [value for value in errors.values() if math.isfinite(value)]
    least = max(min(finite), context.floor(error)) if finite else math.nan
    right = [method for method, value in errors.items() if value <= AS_RIGHT * least]
    rows = ranks(mine[mine["method"].isin(right)], COST)
    first = [row[1] for row in rows if row[0] == 1]
    return rows, (first[0] if first else None), first[1:]


def _sentence(context, sweep, cells, error):
    rows, take, ties = chosen(context, cells, error)
    what = question(context, sweep)
    if take is None:
        return f"{what}: nobody finished with a time", None
    text = f"{what} {take} ({si(rows[0][2], 'ms')} a step"
    behind = [row for row in rows if row[0] not in (1, None)]
    text += f"; as fast within the noise: {listing(ties)}" if ties else ""
    text += f"; next {behind[0][1]}, {times(behind[0][2] / rows[0][2])} times as long" if behind else ""
    others = cells[[context.store.role(method) != "competitor" for method in cells["method"]]]
    peers = [(*spread(part, COST), method) for method, part in others.groupby("method")]
    peers = sorted(peer for peer in peers if math.isfinite(peer[0]))
    if peers:  # no ratio where the ranges of the repeats meet
        median, low, high, peer = peers[0]
        _, _, mine, lowest, highest = rows[0]
        ratio = f"{times(median / mine)} times" if low > highest or high < lowest else "as fast within the noise"
        text += f"; of other libraries {peer}, {ratio}"
    return text + ")", take


def _chart(context, where, found):
    figure, axes = grid_of_axes(1, 1, 0.75 * len(found) + 0.3, legend_room(_names(context, found), 2.0), left=1.3)
    ax, taken, said, handles = axes[0][0], {}, [], {}
    ends = [end for _, cells, _ in found for _, part in cells.groupby("method") for end in spread(part, COST)[1:]]
    failed = any((cells["outcome"] != "ok").any() for _, cells, _ in found)
    room = [0.8 * min(end for end in ends if math.isfinite(end))] if any(map(math.isfinite, ends)) else []  # for a word
    across = ZeroLog(ax, "x", ends + room, "ms", failures=failed, failed_name="none")
    for y, (sweep, cells, _) in enumerate(found):
        error, looks = errors_of(context, cells)[0], context.looks(cells)
        text, taken[sweep] = _sentence(context, sweep, cells, error)
        said.append(text)
        methods = sorted(cells["method"].unique())
        for place, method in enumerate(methods):
            # Each on a line of its own, so that whiskers and letters are read.
            at = y + 0.7 * ((place + 0.5) / len(methods) - 0.5)
            look, part = looks(method), cells[cells["method"] == method]
            median, low, high = spread(part, COST)
            handles[method] = Line2D([], [], label=context.name(method), **look)
            if math.isfinite(median):
                ax.plot([low, high], [at, at], color=look["color"], lw=1.2)
                ax.plot([median], [at], **{**look, "linestyle": "none", "markersize": 6 * scale_of(look["marker"])})
            else:
                ax.plot([across.failed], [at], ls="none", ms=5, mew=0.3, color=look["color"],
                        marker=letter(part["outcome"].iloc[0]))
            if method == taken[sweep]:
                ax.text(low, at, "take ", ha="right", va="center", fontsize=8.5, weight="bold", path_effects=HALO)
    ax.set_yticks(range(len(found)), [question(context, sweep) for sweep, *_ in found])
    ax.set_ylim(len(found) - 0.5, -0.5)
    ax.set_xlabel(context.title(COST))
    legend_right(figure, list(handles.values()), legend_room(_names(context, found), 2.0))
    refused = [sentence for *_, part in found for sentence in part]
    bad = [hole for _, cells, _ in found for hole in holes(cells, ["method"])]
    return Chart(identifier(f"choose {where}"), SECTION, f"What to take: {where}", f"For {where} take {'; '.join(said)}.",
                 found[0][0], figure, _table(context, found, taken), refused + bad,
                 "Times of whole steps, with the range of the repeats. What is taken is the fastest of our methods that finished "
                 f"and err at most {AS_RIGHT:g} times the least; the table has the errors. Other libraries are hollow.",
                 telling=True, headline=_headline(context, where, found))


def _headline(context, where, found):
    """The stage where the choice weighs most."""
    made = []
    for sweep, cells, _ in found:
        rows, take, _ = chosen(context, cells, errors_of(context, cells)[0])
        last = [row for row in rows if row[0] not in (1, None)]
        if take and last:
            made.append(Headline(f"For {where} take {question(context, sweep)} {take}: of our methods that err as little "
                                 f"{last[-1][1]} takes {times(last[-1][2] / rows[0][2])} times as long a step.",
                                 {row[1]: row[2] for row in rows}, "ms"))
    return max(made, key=lambda headline: headline.effect, default=None)


def _names(context, found):
    return [context.name(method) for _, cells, _ in found for method in cells["method"].unique()]


def _table(context, found, taken):
    tables = []
    for sweep, cells, _ in found:
        what, error = question(context, sweep), errors_of(context, cells)[0]
        rows, _, ties = chosen(context, cells, error)
        ranked = {row[1]: row[0] for row in rows}
        times_of = {label: spread(part, COST)[0] for label, part in cells.groupby("method")}
        labels = sorted(times_of, key=lambda label: (not math.isfinite(times_of[label]), times_of[label]))
        parts = [cells[cells["method"] == label] for label in labels]
        # A broadphase is told of moved boxes where these are made.
        stages = [name for name in (f"us_{what}", *(["us_boxes"] if what == "broadphase" else [])) if name in cells]
        columns = {"stage": what, "method": labels, "role": [context.store.role(label) for label in labels],
                   "verdict": ["take" if label == taken[sweep] else "tie" if label in ties else "" for label in labels],
                   "rank": [ranked.get(label) or "" for label in labels], "outcome": [part["outcome"].iloc[0] for part in parts]}
        for end, name in enumerate(("time per step", "lowest of the repeats", "highest of the repeats")):
            columns.update(quantity(name, "ms", [spread(part, COST)[end] for part in parts]))
        own = [sum(spread(part, name)[0] for name in stages) if stages else math.nan for part in parts]
        columns.update(quantity("time of the stage", "us", own))
        columns.update(quantity(context.title(error), context.unit(error), [spread(part, error)[0] for part in parts]))
        columns["reason"] = [part["reason"].iloc[0] for part in parts]
        tables.append(pd.DataFrame(columns))
    return pd.concat(tables, ignore_index=True)
