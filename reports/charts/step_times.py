# SPDX-License-Identifier: Zlib
"""Whole steps: the usual one, the slow ones and the slowest, of methods and of whole engines beside them."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import noise
import over_steps
import ranking
from chart import Chart, Needs, holes, of_sweeps
from load import one_machine, split
from style import ZeroLog, grid_of_axes, legend_right, letter, si, times
from table import quantity

SECTION = "How long does the slowest step take?"
MEDIAN, SLOW, WORST = "ms_per_step_median", "ms_per_step_p99", "ms_per_step_worst"
MARKS = ((MEDIAN, "o", 5), (SLOW, "|", 9), (WORST, "x", 5))


@of_sweeps("step_times", 38, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=(MEDIAN,)),
           "Times of whole steps", "No timed sweep of several methods is in this store.", "resolvers")
def step_times(context, cells):
    if not {SLOW, WORST} <= set(context.store.metrics):  # a store of an earlier program
        return []
    cells, refused = one_machine(context.store, cells)
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        shown = [(where, over_steps.at_middle(mine, setting)) for where, mine in shown]
        at = over_steps.setting_of(pd.concat([mine for _, mine in shown]), setting)
        shown = [(where, mine.drop_duplicates("method")) for where, mine in shown]
        made.append(_chart(context, part, shown, left_out + refused, at))
    return made


def finding(context, where, cells):
    good = cells[(cells["outcome"] == "ok") & cells[MEDIAN].notna() & cells[WORST].notna()]
    engines = good[good["method"].map(context.store.role) == "engine"]
    good = ranking.eligible(context, good)
    if not len(good):
        return f"on {where} no timed run finished"
    ratios = good[WORST] / good[MEDIAN]
    most, least = good.loc[ratios.idxmax()], good.loc[ratios.idxmin()]
    text = f"on {where} the slowest step takes "
    if len(good) == 1 or _spread(most)[0] <= _spread(least)[1]:  # the order of slowest steps is noise
        ends = [times(float(ratios.min())), times(float(ratios.max()))]
        text += f"{' to '.join(dict.fromkeys(ends))} times the median"
    else:
        # Whose ranges meet that of the one at the end are not told from it.
        slow = [cell["method"] for _, cell in good.iterrows() if _spread(cell)[1] >= _spread(most)[0]]
        calm = [cell["method"] for _, cell in good.iterrows() if _spread(cell)[0] <= _spread(least)[1]]
        text += (f"{times(float(ratios.max()))} times the median with {_named(most, slow, good)} and "
                 f"{times(float(ratios.min()))} times with {_named(least, calm, good)}")
    ours = good[good["method"].map(context.store.role) != "engine"]
    floor = noise.floor_of(context, cells["sweep"].iloc[0], MEDIAN)
    for _, engine in engines.iterrows():
        if not len(ours):
            break
        best = ours.loc[ours[MEDIAN].idxmin()]
        ratio = noise.said(best, engine, MEDIAN, floor)
        told = f"{ratio} times the time of our fastest, {best['method']}" if ratio[:1].isdigit() else (
            f"the time of our fastest, {best['method']}, {noise.IN_WORDS.get(ratio, 'for ' + ratio)}")
        mine, other = ranking.precision(engine), ranking.precision(best)
        if mine != other:  # of two precisions no ratio is told
            told = f"{si(engine[MEDIAN], 'ms')} in {mine}"
        text += f"; a step of {engine['method']} takes {told}"
    return text


def _named(cell, alike, good):
    """The method of a cell with its slowest step, and how many are not told from it over the repeats."""
    others = f", {len(alike)} of {len(good)} alike over their repeats" if len(alike) > 1 else ""
    return f"{cell['method']} ({si(cell[WORST], 'ms')}{others})"


def _spread(cell):
    """The interval of the slowest step over the repeats, as a multiple of the median."""
    low, high = noise.interval(noise.runs(cell, WORST) or [cell[WORST]])
    return low / cell[MEDIAN], high / cell[MEDIAN]


def _chart(context, cells, shown, gaps, at):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    looks, labels, called = context.looks(cells), sorted(cells["method"].unique()), ranking.names(context, cells)
    left = 0.3 + 0.078 * max(map(len, called.values()))
    figure, axes = grid_of_axes(1, len(shown), 0.24 * len(labels) + 0.1, 1.3, left=left, gap_x=0.35, bottom=0.55)
    for column, (where, part) in enumerate(shown):
        ax, by = axes[0][column], part.set_index("method")
        failed = (part["outcome"] != "ok").any()
        scale = ZeroLog(ax, "x", [v for name, _, _ in MARKS for v in metrics.column(part, name)], "ms", failed_name="failed",
                        failures=failed)
        if not failed and not np.isfinite([v for name, _, _ in MARKS for v in metrics.column(part, name)]).any():
            ax.text(0.5, 0.5, "no timed run finished", ha="center", va="center", transform=ax.transAxes)
        for y, method in enumerate(labels):
            if method not in by.index:
                continue
            cell, look = by.loc[method], looks(method)
            if cell["outcome"] != "ok":
                ax.plot([scale.failed], [y], ls="none", marker=letter(cell["outcome"]), color=look["color"], ms=7, mew=0.3)
                continue
            known = [cell[name] for name, _, _ in MARKS if math.isfinite(cell[name])]
            ax.plot([scale.place(min(known)), scale.place(max(known))] if known else [], [y] * min(2, 2 * len(known)),
                    color=look["color"], lw=0.8, alpha=0.6)
            for name, marker, size in MARKS:
                if math.isfinite(cell[name]):
                    ax.plot([scale.place(cell[name])], [y], ls="none", marker=marker, ms=size, color=look["color"],
                            mfc=look.get("markerfacecolor", look["color"]), zorder=3)
        ax.set_ylim(len(labels) - 0.4, -0.6)
        ax.set_yticks(range(len(labels)))
        ax.set_yticklabels([called[m] for m in labels] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
        ax.set_title(f"{where}, {dimension}D")
        ax.set_xlabel("time of a step")
    legend_right(figure, [Line2D([], [], ls="none", marker=marker, ms=size, color="#555555", label=label)
                          for (_, marker, size), label in zip(MARKS, ("median", "99th percentile", "slowest"))], 1.3)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    columns = {"scene": drawn["where"], "method": drawn["method"], "outcome": drawn["outcome"]}
    for name, _, _ in MARKS:
        columns |= quantity(context.title(name), context.unit(name), metrics.column(drawn, name))
    return Chart(f"{cells['sweep'].iloc[0]}_step_times_{dimension}d", SECTION, f"Times of whole steps, {dimension}D",
                 f"In {dimension}D{at} " + "; ".join(finding(context, where, part) for where, part in shown) + "."
                 + ranking.tail_of(context, [(where, part[part["method"].map(context.store.role) != "engine"])
                                             for where, part in shown]),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(columns), gaps + holes(drawn, ["scene", "method"]),
                 "Processor time of a step, broadphase to integration; medians over repeats, without each run's first ten steps. "
                 "Engines stand beside our methods. " + noise.rule(noise.floor_of(context, cells["sweep"].iloc[0], MEDIAN)))
