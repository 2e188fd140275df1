# SPDX-License-Identifier: Zlib
"""What sleeping saves against what it costs: how far bodies end from where they do when nobody sleeps, and how late those wake
whom a script wakes. The 2009 report (9.4.3) tells a gain of 20 % "without harming verisimilitude", and no more."""

import math
import re

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

import metrics
import sleep_scenes
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, methods, of_sweeps
from load import split, varying
from style import ZeroLog, grid_of_axes, legend_right, legend_room, si
from table import quantity

SECTION = "What does sleeping save, and what does it cost?"
COST, WAVE = "work_multiply_adds", "wake_steps"
TOLD = ("awake_mean", "woken", WAVE)  # by trials; not in stores that are older
SAVED, FAR, MIDDLE = "multiply-adds saved", "largest distance", "median distance"  # columns of cells
TIME, TIME_RUNS = "time saved", "time saved by repeats"
FLOOR = 1e-12  # m
COUNTED = ", with the range of its repeats; the table has the multiply-adds, a count without noise"


@of_sweeps("sleeping", 38, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=(COST,),
                 also="sleep policies that differ, and a baseline that keeps everybody awake"),
           "Sleeping", "No sweep of sleep policies with one that keeps everybody awake is in this store.", "sleeping")
def sleeping(context, cells):
    if not set(TOLD) <= set(cells) or len({_policy(context, key) for key in cells["key"]} - {None}) < 2:
        return []
    name, groups = context.baseline(cells), [c for c in ("scene", "dimension") if c in cells]
    made = sleep_scenes.of_sweep(context, cells)
    for part in split(cells, groups):
        inner = varying(context.store, part, groups)
        for equal in split(part, inner, sort=True):
            awake = equal[(equal["method"] == name) & equal["outcome"].eq("ok")]
            # A baseline that lets somebody sleep shows no cost of sleeping.
            if len(awake) == 1 and awake[COST].iloc[0] > 0 and _sleeps_least(equal, awake):
                made.append(_chart(context, equal.drop_duplicates("method").copy(), awake.iloc[0],
                                   describe(equal.iloc[0], groups + inner)))
    return made


def _policy(context, key):
    found = key and re.search(r"\bsleep=\S+", context.store.trials.loc[key, "canonical"].get("pipeline", ""))
    return found.group() if found else None


def _sleeps_least(cells, awake):
    return not (metrics.column(cells, "awake_mean") > float(awake["awake_mean"].iloc[0])).any()


def at_the_end(context, key, dimension):
    """{slot: position} after the last step whose poses were kept; the step."""
    poses = context.store.poses(key, dimension)
    last = max(poses)
    return {row[0]: row[1:1 + dimension] for row in poses[last]}, last


def distances(mine, other):
    """(largest, median) over all bodies, m; NaN where one lacks a body."""
    if set(mine) != set(other):
        return math.nan, math.nan
    far = [float(np.linalg.norm(mine[slot] - other[slot])) for slot in mine]
    return max(far), float(np.median(far))


def seconds(context, cell):
    """Seconds of a step, mean over the run, of each timed repeat that stored them: of a run half of which sleeps the median step
    would tell one half alone."""
    found = [context.store.series(key, "seconds") for key in cell["keys_timed"]]
    return [float(np.mean(values)) for values in found if values is not None and len(values)]


def with_time(context, cells, awake):
    """The cells with TIME, the median, and TIME_RUNS, each repeat against the baseline's median; None where one that finished
    was not timed."""
    base, runs = seconds(context, awake), [seconds(context, cell) if cell["outcome"] == "ok" else [] for _, cell in
                                           cells.iterrows()]
    if not base or not all(found for found, outcome in zip(runs, cells["outcome"]) if outcome == "ok"):
        return None
    cells[TIME_RUNS] = [[1 - value / np.median(base) for value in found] for found in runs]
    cells[TIME] = [float(np.median(found)) if found else math.nan for found in cells[TIME_RUNS]]
    return cells


def measured(context, cells, awake):
    """The cells with SAVED, FAR and MIDDLE; what did not finish has none."""
    dimension = int(metrics.Trial(context.store, awake["key"]).parameter("dimension"))
    reference, last = at_the_end(context, awake["key"], dimension)
    found = []
    for _, cell in cells.iterrows():
        if cell["outcome"] != "ok" or cell["key"] is None:
            found.append((math.nan,) * 3)
            continue
        mine, step = at_the_end(context, cell["key"], dimension)
        far = distances(mine, reference) if step == last else (math.nan, math.nan)
        found.append((1 - cell[COST] / awake[COST], *far))
    cells[[SAVED, FAR, MIDDLE]] = found
    return cells


def _time_of(cell):
    if not math.isfinite(cell.get(TIME, math.nan)):
        return ""
    runs = [100 * value for value in cell[TIME_RUNS]]
    spread = f", {si(min(runs))} to {si(max(runs))} over {len(runs)} repeats" if len(runs) > 1 else ", of one repeat"
    return f" and {si(100 * cell[TIME])} % of the time{spread}"


def finding(cells, awake, where):
    others = cells[cells["method"] != awake["method"]]
    good = others[np.isfinite(metrics.column(others, SAVED))]
    if not len(good):
        return f"On {where} no policy that lets bodies sleep finishes."
    most = good.loc[good[SAVED].idxmax()]
    if most[SAVED] <= 0:
        return f"On {where} no body falls asleep."
    farthest = good.loc[good[FAR].idxmax()] if good[FAR].notna().any() else None
    text = f"On {where} {most['method']} saves most, {si(100 * most[SAVED])} % of the multiply-adds{_time_of(most)}"
    if farthest is not None and math.isfinite(most[FAR]):
        free = [m for m, far in zip(good["method"], good[FAR]) if far <= FLOOR]
        text += f"; its bodies end at most {si(most[FAR], 'm')} from where they end awake"
        if farthest["method"] != most["method"]:
            text += f", those of {farthest['method']} {si(farthest[FAR], 'm')}"
        text += f"; {methods(free, sorted(good['method']))} {'moves' if len(free) == 1 else 'move'} no body" if free else ""
    late = good[good[WAVE].notna() & (good["woken"] > 0) & (good[SAVED] > 0)]
    if len(late):
        slow, quick = late.loc[late[WAVE].idxmax()], late.loc[late[WAVE].idxmin()]
        text += (f"; those that wake do so within {si(quick[WAVE])} steps by {quick['method']}" +
                 (f" and {si(slow[WAVE])} by {slow['method']}" if slow[WAVE] > quick[WAVE] else ""))
    failed = sorted(others[others["outcome"] != "ok"]["method"])
    if failed:
        text += f"; {methods(failed, sorted(cells['method']))} {'fails' if len(failed) == 1 else 'fail'}"
    return f"{text}."


def headline(cells, awake, where):
    """What is saved for how much: of those that save half of what the best saves, who goes least far and who farthest."""
    good = cells[(cells["method"] != awake["method"]) & np.isfinite(metrics.column(cells, FAR))]
    good = good[good[SAVED] >= good[SAVED].max() / 2] if len(good) else good
    if len(good) < 2 or good[SAVED].max() <= 0:
        return None
    near, far = good.loc[good[FAR].idxmin()], good.loc[good[FAR].idxmax()]
    if far[FAR] < 2 * max(near[FAR], FLOOR):
        return None
    return Headline(f"On {where} sleeping by {near['method']} saves {si(100 * near[SAVED])} % of the multiply-adds and moves "
                    f"bodies by {si(near[FAR], 'm')} at the most, by {far['method']} {si(100 * far[SAVED])} % and "
                    f"{si(far[FAR], 'm')}.",
                    dict(zip(good["method"], good[FAR].astype(float))), "m", "farthest from its end awake",
                    ends=final_states(good))


def _chart(context, cells, awake, where):
    cells = measured(context, cells, awake).sort_values("method")
    timed = with_time(context, cells, awake) is not None
    across = TIME if timed else SAVED
    labels, looks = list(cells["method"]), context.looks(cells)
    others = cells[cells["method"] != awake["method"]]
    waves = others[np.isfinite(metrics.column(others, WAVE)) & np.isfinite(metrics.column(others, SAVED))]
    width = legend_room(map(context.name, others["method"]), 2.0)
    figure, axes = grid_of_axes(1, 2 if len(waves) else 1, 2.8, width, left=0.95, gap_x=0.8)
    ax, bad = axes[0][0], bool(others[FAR].isna().any())
    up = ZeroLog(ax, "y", list(others[FAR].dropna()), "m", failures=bad, floor=FLOOR)
    for _, cell in others.iterrows():
        x = 100 * cell[across] if math.isfinite(cell[across]) else 0.0
        if timed and len(cell[TIME_RUNS]) > 1:
            ax.plot([100 * min(cell[TIME_RUNS]), 100 * max(cell[TIME_RUNS])], [up.place(float(cell[FAR]))] * 2, lw=0.9,
                    color=looks(cell["method"])["color"])
        ax.plot([x], [up.place(float(cell[FAR]))], **{**looks(cell["method"]), "linestyle": "none"}, zorder=3)
    ax.set_title("largest distance from the end without sleep")
    if len(waves):
        late = axes[0][1]
        for _, cell in waves.iterrows():
            late.plot([100 * cell[across]], [cell[WAVE]], **{**looks(cell["method"]), "linestyle": "none"}, zorder=3)
        late.set_ylim(-0.05 * max(1.0, waves[WAVE].max()), 1.08 * max(1.0, waves[WAVE].max()))
        late.yaxis.set_major_locator(MaxNLocator(integer=True))
        late.set_title("steps until those woken are awake")
    for each in axes[0]:
        each.set_xlabel(f"{across} (%)")
    handles = [Line2D([], [], label=context.name(m), **{**looks(m), "linestyle": "none"}) for m in others["method"]]
    legend_right(figure, handles, width)
    table = {"policy": labels, "outcome": list(cells["outcome"])} | (quantity(TIME, "1", cells[TIME]) if timed else {})
    for title, unit, name in ((SAVED, "1", SAVED), ("largest distance from the end without sleep", "m", FAR),
                              ("median over bodies", "m", MIDDLE), ("bodies awake, mean", "1", "awake_mean"),
                              ("woken by the last act", "1", "woken"), ("steps until all are woken", "1", WAVE)):
        table |= quantity(title, unit, metrics.column(cells, name))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {where}"), SECTION, f"What sleeping costs: {where}",
                 finding(cells, awake, where), cells["sweep"].iloc[0], figure, pd.DataFrame(table), holes(cells, ["method"]),
                 f"Across what a policy saves of the {'time' if timed else 'multiply-adds'} of {context.name(awake['method'])}"
                 f"{COUNTED if timed else ': a count without noise'}. Up "
                 "how far a body ends at the most from where it ends when no body sleeps; in scenes that forget their start it "
                 "is another history, and no error. Where a script acts, how many steps later most bodies are awake: sleepers "
                 "that wait for a gap wake one after the other.", headline=headline(cells, awake, where))
