# SPDX-License-Identifier: Zlib
"""How high a pile stands and how far its bodies are from their places, over the steps (2009 report, 9.1.5)."""

import math

import numpy as np
import pandas as pd

import over_steps
import ranking
from chart import Chart, Headline, Needs, holes, listing, of_sweeps
from load import split
from style import ZeroLog, caption_of_lines, one_line, si
from table import quantity

SECTION = "What stands, and under whom?"
TURNS_NONE = "linear"  # the report's first position method
SEEN = 0.004  # of a panel's height: lines that are nearer everywhere are one to the eye
LOST = 0.5  # of the height at the start: what has less has fallen


@of_sweeps("over_time", 33, SECTION,
           Needs("world", methods=(2, math.inf), series=("height", "drift"), also="`report` that names it"),
           "Height and drift over time",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_positions")
def over_time(context, cells):
    if "over_time" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        made.append(_chart(context, [(where, over_steps.at_middle(mine, setting)) for where, mine in shown], left_out))
    return made


def fallen_at(heights):
    """The step from which on less than LOST of the height at the start is left; None where it is never so."""
    heights = np.asarray(heights, float)
    below = np.flatnonzero(heights < LOST * heights[0])
    return int(below[0]) if len(below) else None


def drawn_alike(ax, curves, place, of):
    """{method: the first whose curve is nowhere farther from it than SEEN of the panel}: such lines are drawn once."""
    firsts, there = {}, {}
    share = lambda v: ax.transAxes.inverted().transform(ax.transData.transform((0, place(v))))[1]  # noqa: E731
    for method, points in curves.items():
        at = np.array([share(v) for v in over_steps.stretches(points, of)[1]])
        firsts[method] = next((other for other, line in there.items() if len(line) == len(at) and
                               np.max(np.abs(line - at)) <= SEEN), method)
        if firsts[method] == method:
            there[method] = at
    return firsts


def verdict(rows):
    """What the report says of the position method that turns no body, tried under each velocity resolver beside those that turn
    them: borne where it falls and they stand, or it falls first."""
    said, borne = [], []
    for velocity in dict.fromkeys(row["method"].partition("+")[0] for row in rows):
        fell = {row["method"].partition("+")[2]: row["fell"] for row in rows if row["method"].startswith(f"{velocity}+")}
        if TURNS_NONE not in fell or len(fell) < 2:
            continue
        mine, stand = fell[TURNS_NONE], [name for name, at in fell.items() if at is None]
        borne.append(mine is not None and all(at is None or at >= mine for at in fell.values()))
        words = [f"{name} falls at step {at}" for name, at in fell.items() if at is not None] + (
            [f"{listing(stand)} {'stands' if len(stand) == 1 else 'stand'}"] if stand else [])
        said.append(f"under {velocity} {listing(words)}")
    if not said:
        return ""
    word = "borne" if all(borne) else "borne in part" if any(borne) else "not borne"
    return (f" That a position method which turns no body ({TURNS_NONE}) makes piles fall is {word} by this scene: "
            f"{'; '.join(said)}.")


def finding(where, rows):
    fell = [row for row in rows if row["fell"] is not None]
    stand = [row for row in rows if row["fell"] is None]
    said = [f"with {row['method']} half of the height is lost at step {row['fell']}" for row in
            sorted(fell, key=lambda row: row["fell"])]
    if stand:
        tilts = [row["tilt"] for row in stand if math.isfinite(row["tilt"])]
        turn = (f", and no body is turned by more than {si(max(tilts), 'rad')} in the end" if tilts else "")
        said.append(f"with {listing(row['method'] for row in stand)} it stands{turn}")
    return f"on {where} " + "; ".join(said)


def _chart(context, shown, left_out):
    shown = [(where, part.drop_duplicates("method").sort_values("method")) for where, part in shown]
    cells = pd.concat([part for _, part in shown])
    sweep = cells["sweep"].iloc[0]
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, room = over_steps.grid(context, cells, 2, len(shown))
    rows, lines, said, judged = [], [], [], []
    for column, (where, part) in enumerate(shown):
        tracks = {name: {cell["method"]: np.asarray(found, float) for _, cell in part.iterrows() if cell["key"] is not None
                         for found in [context.store.series(cell["key"], name)] if found is not None and len(found)}
                  for name in ("height", "drift")}
        ranked = ranking.eligible(context, part).index
        mine = [{"where": where, "method": cell["method"], "outcome": cell["outcome"],
                 "tilt": float(cell.get("tilt_end", math.nan)),
                 "height": tracks["height"][cell["method"]][-1], "drift": tracks["drift"][cell["method"]][-1],
                 "fell": fallen_at(tracks["height"][cell["method"]]), "ranked": index in ranked}
                for index, cell in part.iterrows() if cell["method"] in tracks["height"]]
        axes[0][column].set_title(f"{where}, {dimension}D")
        axes[0][column].set_ylim(0, 1.05 * max([1.0, *(float(np.max(v)) for v in tracks["height"].values())]))
        drifts = [v for track in tracks["drift"].values() for v in over_steps.stretches(track, np.max)[1]]
        scale = ZeroLog(axes[1][column], "y", drifts, "m", failures=False, floor=1e-6)
        for ax, name, place, of in ((axes[0][column], "height", float, np.median),
                                    (axes[1][column], "drift", scale.place, np.max)):
            firsts = drawn_alike(ax, tracks[name], place, of)
            over_steps.lines(context, ax, part, lambda cell, of=tracks[name]: of.get(cell["method"], np.array([])), place, of,
                             drawn=set(firsts.values()))
            lines.append((f"On {where}, {name}", one_line(ax, firsts, listing)))
        axes[0][column].set_xlabel("")
        rows += mine
        told = [row for row in mine if row["ranked"]]
        judged.append(told)
        said.append(finding(where, told) if told else f"on {where} {'no method has a rank' if mine else 'nothing was run'}")
    axes[0][0].set_ylabel("highest body (m)")
    axes[1][0].set_ylabel("farthest from its place")
    over_steps.legend(context, figure, cells, room)
    table = {"scene": [r["where"] for r in rows], "method": [r["method"] for r in rows], "outcome": [r["outcome"] for r in rows],
             "half of the height lost at step": [r["fell"] for r in rows],
             **quantity("height at the end", "m", [r["height"] for r in rows]),
             **quantity("largest turn at the end", "rad", [r["tilt"] for r in rows]),
             **quantity("drift at the end", "m", [r["drift"] for r in rows])}
    ranked = [r for r in rows if r["ranked"]]
    fell, stand = ([r for r in ranked if (r["fell"] is None) == up] for up in (False, True))
    head = Headline(f"On {shown[0][0]} in {dimension}D a pile falls with {listing(r['method'] for r in fell)} and stands with "
                    f"{listing(r['method'] for r in stand)}.", {r["method"]: r["height"] for r in ranked}, "m",
                    "height at the end", larger=True) if len(shown) == 1 and fell and stand else None
    return Chart(f"{sweep}_over_time_{dimension}d", SECTION, f"Height and drift over time, {dimension}D",
                 f"In {dimension}D " + "; ".join(said) + "." + "".join(map(verdict, judged))
                 + ranking.tail_of(context, shown), sweep, figure, pd.DataFrame(table),
                 left_out + holes(cells, ["scene", "method"]),
                 f"Of {over_steps.STRETCHES} stretches of the run the median height of the highest body and the largest "
                 "distance of a body from where it came." + caption_of_lines(lines), headline=head)
