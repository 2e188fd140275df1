# SPDX-License-Identifier: Zlib
"""Where the time of a step goes over a director's script (2009 report, figures 7.1 and 7.2)."""

from collections import OrderedDict

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from chart import Chart, Headline, Needs, describe, holes, identifier, listing, of_sweeps
from load import split, varying
from style import PALETTE, grid_of_axes, legend_right, si

SECTION = "Where does the time of a step go?"
COST = "ms_per_step_median"
# A comparison of many methods is no place for timelines.
# From the bottom of a stack of stage times upwards, as World::step goes.
STAGES = {"boxes": 4, "broadphase": 0, "cache": 9, "contacts": 1, "listeners": 10, "sleep": 3, "solver": 2, "other": 11}
COUNTS = OrderedDict([("bodies", "#000000"), ("awake", "#D55E00"), ("points", "#0072B2")])
STRETCHES = 240


@of_sweeps("stages", 100, SECTION,
           Needs("world", methods=(1, 2), fixed=("model", "precision", "setting"), metrics=(COST,),
                 series=("seconds", "sec_solver", "bodies", "awake", "points")),
           "Stage timelines", "No timed sweep of at most two methods is in this store.", "stages")
def stages(context, cells):
    axes = context.store.method_axes(cells["sweep"].iloc[0])
    side = None if cells["method"].nunique() < 2 else axes[0] if len(axes) == 1 else "method"
    others = varying(context.store, cells)
    made = []
    for part in split(cells, others):
        made.append(_timeline(context, part, side, [c for c in ("scene", "dimension") if c in part] +
                              [c for c in others if c not in ("scene", "dimension")]))
    return made


def medians(values, edges):
    """Of each stretch. Not means: stage times are wall-clock times, and one pre-empted step would colour its stretch."""
    return np.array([np.median(values[a:b]) for a, b in zip(edges[:-1], edges[1:])])


def stretches(steps):
    return np.unique(np.linspace(0, steps, min(STRETCHES, steps) + 1).astype(int))


def stage_times(store, key):
    """(whole step, {stage: seconds per step}); phases inside a stage ("solver_iterate") belong to their stage."""
    total = store.series(key, "seconds")
    names = [name for name in store.series_names(key) if name.startswith("sec_")]
    order = {f"sec_{stage}": place for place, stage in enumerate(STAGES)}
    stages = OrderedDict()
    for name in sorted(names, key=lambda n: order.get(n, len(order))):
        if not any(name.startswith(other + mark) for other in names for mark in "._"):
            stages[name[4:]] = store.series(key, name)
    if total is None and stages:
        total = np.sum(list(stages.values()), axis=0)
    return total, stages


def stage_colour(name):
    if name in STAGES:
        return PALETTE[STAGES[name]]
    return PALETTE[(3, 4, 5, 6, 7)[sum(map(ord, name)) % 5]]


def _timeline(context, cells, side, axes):
    where = describe(cells.iloc[0], axes)
    cells = cells.sort_values(side) if side else cells
    legend_width = 1.6
    figure, panels = grid_of_axes(2, len(cells), 2.3, legend_width, left=0.75, gap_x=0.35, gap_y=0.5)
    rows, seen, top, high, peaks, finished = [], OrderedDict(), 0.0, 1.0, [], set()
    for column, (_, cell) in enumerate(cells.iterrows()):
        above, below = panels[0][column], panels[1][column]
        name = f"{side}: {cell[side]}" if side else where
        above.set_title(name if cell["outcome"] == "ok" else f"{name} ({cell['outcome']})")
        below.set_xlabel("step")
        total, stages = (None, {}) if cell["key_timed"] is None else stage_times(context.store, cell["key_timed"])
        if total is None or not len(total):
            above.text(0.5, 0.5, f"no stage times: {cell['outcome']}\n{cell['reason']}", ha="center", va="center",
                       transform=above.transAxes, color="#8A3B12")
        else:
            edges = stretches(len(total))
            at = edges[:-1]
            shown = {k: medians(v, edges) * 1e3 for k, v in stages.items()}
            staged = np.sum(list(shown.values()), axis=0) if shown else 0
            whole = np.maximum(medians(total, edges) * 1e3, staged)
            shown["other"] = whole - staged
            above.stackplot(at, list(shown.values()), colors=[stage_colour(k) for k in shown], lw=0, alpha=0.85)
            seen.update(dict.fromkeys(shown))
            top = max(top, float(np.max(whole)))
            last = len(whole) - max(1, len(whole) // 10)
            if cell["outcome"] == "ok":  # what failed has no end that could be compared
                finished.add(name)
                peaks.append((str(cell[side]) if side else where, float(np.max(whole)), float(np.mean(whole[last:]))))
            for k, v in list(shown.items()) + [("whole step", whole)]:
                rows.append({"run": name, "stage": k, "mean [s]": float(np.mean(v)) / 1e3, "largest [s]": float(np.max(v)) / 1e3,
                             "mean of the last tenth [s]": float(np.mean(v[last:])) / 1e3,
                             "share of the time [1]": float(np.sum(v)) / max(1e-300, float(np.sum(whole)))})
        for count, colour in COUNTS.items():
            values = None
            for key in (cell["key"], cell["key_timed"]):
                if values is None and key is not None:
                    values = context.store.series(key, count)
            if values is not None and len(values):
                edges = stretches(len(values))
                below.plot(edges[:-1], medians(values, edges), color=colour, lw=1.3)
                high = max(high, float(np.max(values)))
    for ax in panels[0]:
        ax.set_ylim(0, top * 1.08 or 1)
    for ax in panels[1]:
        ax.set_ylim(0, high * 1.08)
    for row in panels:
        for ax in row[1:]:
            ax.tick_params(labelleft=False)
    panels[0][0].set_ylabel("time of a step (ms)")
    panels[1][0].set_ylabel("count")
    handles = [Patch(color=stage_colour(k), alpha=0.85, label=k) for k in reversed(seen)]
    handles += [Line2D([], [], color=colour, label={"points": "contact points"}.get(count, count))
                for count, colour in COUNTS.items()]
    legend_right(figure, handles, legend_width)
    return Chart(identifier(f"{cells['sweep'].iloc[0]} timeline {where}"), SECTION,
                 f"Time per stage and counts over the script: {where}", _finding(where, side, peaks, rows),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(rows), holes(cells, [*axes, side] if side else axes),
                 f"Medians of {STRETCHES} stretches of the run, stacked; one pre-empted step does not show. Each is one run: "
                 "how far its repeats are from it is not stored, so no ratio of two runs is told.",
                 headline=_headline(where, [r for r in rows if r["run"] in finished]))


def _headline(where, rows):
    """The stages of the first run that finished."""
    parts = {r["stage"]: r["mean [s]"] for r in rows if r["run"] == rows[0]["run"] and r["stage"] != "whole step"}
    if len(parts) < 2:
        return None
    most = max(parts, key=parts.get)
    share = 100 * parts[most] / sum(parts.values())
    return Headline(f"On {where} ({rows[0]['run']}) {most} takes {share:.0f} % of the time of a step.", parts, "s",
                    "time per step")


def _finding(where, side, peaks, rows):
    if not peaks:
        return f"No run of {where} finished with stage times."
    # Numbers and no ratio of two runs: how far the last tenth of a run is from that of its repeats is not in the store.
    said = [f"{name}: peak {si(peak, 'ms')}, last tenth {si(end, 'ms')} a step" for name, peak, end in peaks]
    shares = [r for r in rows if r["stage"] not in ("whole step", "other")]
    most = max(shares, key=lambda r: r["share of the time [1]"]) if shares else None
    tail = (f"; the dearest stage is {most['stage']} ({100 * most['share of the time [1]']:.1f} % of the time, {most['run']})"
            if most else "")
    return f"On {where}, {side + ' ' if side else ''}{listing(said)}{tail}."
