# SPDX-License-Identifier: Zlib
"""How far a body that hits the ground is thrown back, where nothing is to bounce (2009 report, 9.1.5)."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import ranking
from chart import Chart, Headline, Needs, holes, listing, of_sweeps
from load import split
from style import ZeroLog, caption_of_lines, grid_of_axes, legend_right, legend_room, one_line, plain_log, same, si
from table import quantity

SECTION = "Do contacts bounce that should not?"
ROUNDING = 1e-6  # m: below it nothing is thrown back
NEAR = 1.1  # times the speed before: what a line joins
SUNK = 0.02  # m: four times the depth that most methods leave


@of_sweeps("rebound", 32, SECTION,
           Needs("world", varies=("height",), methods=(2, math.inf), series=("height",), also="`report` that names it"),
           "What is thrown back after a fall",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_springs")
def rebound(context, cells):
    if "rebound" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    return [_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def thrown(heights):
    """(fall, rebound) in m of a body's height per step: how far it fell until it rested, and how far it rose again after its
    lowest place. Both are measured from where it is in the end."""
    heights = np.asarray(heights, float)
    low = int(np.argmin(heights))
    return float(heights[0] - heights[-1]), max(0.0, float(np.max(heights[low:]) - heights[-1]))


def rows_of(context, cells):
    found = []
    for _, cell in cells.sort_values(["method", "height"]).iterrows():
        track = context.store.series(cell["key"], "height") if cell["key"] is not None and cell["outcome"] == "ok" else None
        fall, back = thrown(track) if track is not None and len(track) else (math.nan, math.nan)
        back = back if back > ROUNDING or math.isnan(back) else 0.0
        gravity = cell.get("gravity")
        found.append({"method": cell["method"], "height": cell["height"], "fall": fall, "rebound": back,
                      "speed": math.nan if gravity is None else float(gravity)})
    found = pd.DataFrame(found)
    # By the shallowest fall from that height: who sinks has not fallen faster.
    least = found.groupby("height")["fall"].transform("min")
    found["sunk"], found["speed"] = found["fall"] - least, np.sqrt(2 * found["speed"] * least.clip(lower=0))
    return found


def joined(track):
    """The line through these points, with a gap where the next speed is far: nothing was tried between."""
    xs, ys = [], []
    for i, (x, y) in enumerate(track):
        if i and x > NEAR * track[i - 1][0]:
            xs, ys = [*xs, math.nan], [*ys, math.nan]
        xs, ys = [*xs, x], [*ys, y]
    return xs, ys


def finding(rows):
    known = rows.dropna(subset=["rebound"])
    if not len(known):
        return "no fall that has a rank was finished."
    up, still, said = [], [], []
    for method, mine in known.groupby("method", sort=True):
        worst, thrown_by = mine.loc[mine["rebound"].idxmax()], mine[mine["rebound"] > 0]["speed"]
        (up if worst["rebound"] > 0 else still).append(
            (method, worst, thrown_by.min() if len(thrown_by) else mine["speed"].max()))
    for method, worst, least in sorted(up, key=lambda entry: -entry[1]["rebound"]):
        said.append(f"{method} throws the body back by up to {si(worst['rebound'], 'm')} (at {si(worst['speed'], 'm/s')}), "
                    f"at all from {si(least, 'm/s')} on")
    if still:
        said.append(f"{listing(m for m, _, _ in still)} {'throws' if len(still) == 1 else 'throw'} it back by no more than "
                    f"{si(ROUNDING, 'm')} at any speed up to {si(min(most for _, _, most in still), 'm/s')}")
    deep = known[known["sunk"] > SUNK].groupby("method")["sunk"].max()
    said += [f"{method} leaves it up to {si(most, 'm')} deeper than others do" for method, most in deep.items()]
    return "; ".join(said) + "."


def _chart(context, cells):
    sweep, rows = cells["sweep"].iloc[0], rows_of(context, cells)
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    looks, methods, called = context.looks(cells), sorted(rows["method"].unique()), ranking.names(context, cells)
    ranked = rows[rows["method"].isin(ranking.whole(context, cells)["method"])]
    room = legend_room(called.values(), 1.75)
    figure, panels = grid_of_axes(1, 1, 3.2, room, left=0.9)
    ax = panels[0][0]
    plain_log(ax, "x", rows["speed"].dropna(), "m/s")
    scale = ZeroLog(ax, "y", rows["rebound"], "m")
    tracks = {}
    for method in methods:
        mine = rows[rows["method"] == method].dropna(subset=["speed"])
        tracks[method] = list(zip(mine["speed"], mine["rebound"]))
    firsts = same({m: [v for _, v in track] for m, track in tracks.items()})
    for method in dict.fromkeys(firsts.values()):
        ax.plot(*joined([(x, scale.place(v)) for x, v in tracks[method]]), **looks(method))
    words = one_line(ax, firsts, listing)
    ax.set_xlabel("speed at which the ground is hit")
    ax.set_ylabel("thrown back")
    legend_right(figure, [Line2D([], [], label=called[m], **looks(m)) for m in methods], room)
    table = {"method": rows["method"], **quantity("fall", "m", rows["fall"]), **quantity("speed", "m/s", rows["speed"]),
             **quantity("thrown back", "m", rows["rebound"]),
             "share of the energy [1]": rows["rebound"] / rows["fall"], **quantity("deeper than others", "m", rows["sunk"])}
    back = ranked.dropna(subset=["rebound"]).groupby("method")["rebound"].max().to_dict()
    most = max(back, key=back.get, default=None)
    head = None if most is None or not back[most] or min(back.values()) == back[most] else Headline(
        f"A box that hits the ground at up to {si(rows['speed'].max(), 'm/s')} and is not to bounce is thrown back by up to "
        f"{si(back[most], 'm')} with {most}; with {listing(m for m in back if back[m] == min(back.values()))} by "
        f"{si(min(back.values()), 'm')}.", back, "m", "thrown back")
    return Chart(f"{sweep}_rebound_{dimension}d", SECTION, f"What is thrown back after a fall, {dimension}D",
                 f"In {dimension}D, {finding(ranked)}{ranking.tail(context, cells)}", sweep, figure, pd.DataFrame(table),
                 holes(cells, ["method", "height"]),
                 "The highest place after the lowest, above that in the end, over the speed that the fall has without drag; what "
                 f"is at most {si(ROUNDING, 'm')} is 0. "
                 "Lines join speeds less than a tenth apart." + caption_of_lines([("Lines", words)]), headline=head)
