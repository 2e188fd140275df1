# SPDX-License-Identifier: Zlib
"""How far times are from themselves: the same method entered twice, per sweep, and how busy the machine was."""

import math

import numpy as np
import pandas as pd

import noise
from chart import Chart, listing, of_store, plural
from style import grid_of_axes

SECTION = "How noisy are these times?"
WIDEST = 50.0  # percent that are drawn


@of_store("noise", 115, SECTION, "Noise of times", "No timed trial is in this store.")
def noise_floor(context):
    rows = [row for sweep in context.store.sweeps() for row in _rows(context, sweep)]
    if not rows:
        return []
    figure = _drawn(rows) if any(row["ratios"] or row["loads"] for row in rows) else None  # stores of old hold neither
    table = pd.DataFrame([{"sweep": row["sweep"], "cells": row["cells"], "cells of the bar": len(row["ratios"]),
                           "noise floor [1]": row["floor"] - 1 if row["ratios"] else math.nan,
                           "load average, median": float(np.median(row["loads"])) if row["loads"] else math.nan,
                           "load average, largest": max(row["loads"], default=math.nan)} for row in rows])
    return [Chart("noise", SECTION, "The same method against itself", finding(rows), "", figure, table,
                  [f"{row['sweep']}: too few repeats to measure its noise, so only ratios beyond {noise.UNMEASURED:g} are told"
                   for row in rows if not row["ratios"]],
                  "A dash in the first panel is one cell: the median of its even repeats over that of its odd ones, which were "
                  f"made in the same rounds. The bar is the floor: {noise.LIKELY} of 100 of the cells that the "
                  "label counts are inside. A ratio is told in a chart when it is beyond the floor and the whiskers of the two "
                  "are apart; else it is noise. Other libraries' methods and engines have floors of their own." + beyond(rows) +
                  " Load is the mean of a minute.")]


def beyond(rows):
    """What stands at the edge of the first panel because it is farther off."""
    said = []
    for row in rows:
        most = max([row["floor"], *(max(ratio, 1 / ratio) for ratio in row["ratios"])]) if row["ratios"] else 1.0
        if 100 * (most - 1) > WIDEST:
            said.append(f"marks of {row['sweep']} (a factor of up to {most:.2g})")
    return f" Beyond the edge of the first panel, and drawn at it: {listing(said)}." if said else ""


def _drawn(rows):
    names = [f"{row['sweep']}, {plural(len(row['ratios']), 'cell')}" for row in rows]
    left_room = max(2.6, 0.3 + 0.075 * max(map(len, names)))
    figure, axes = grid_of_axes(1, 2, 0.3 * len(rows) + 0.2, 0.2, left=left_room, gap_x=0.4, bottom=0.6)
    left, right = axes[0]
    for y, row in enumerate(rows):
        shares = [min(WIDEST, max(-WIDEST, 100 * (ratio - 1))) for ratio in row["ratios"]]
        left.plot(shares, [y] * len(shares), ls="none", marker="|", ms=9, color="#0072B2", alpha=0.5)
        if row["ratios"]:
            ends = [max(-WIDEST, 100 * (1 / row["floor"] - 1)), min(WIDEST, 100 * (row["floor"] - 1))]
            left.plot(ends, [y, y], color="#D55E00", lw=1.6, zorder=3)
        right.plot(row["loads"], [y] * len(row["loads"]), ls="none", marker="|", ms=9, color="#0072B2", alpha=0.3)
    for ax in (left, right):
        ax.set_ylim(len(rows) - 0.4, -0.6)
        ax.set_yticks(range(len(rows)))
        ax.set_yticklabels(names if ax is left else [])
        ax.tick_params(axis="y", length=0)
    left.set_xlabel("even repeats over odd ones, less 1 (%)")
    right.set_xlabel("load average when a timed trial started")
    right.set_xlim(left=0)
    return figure


def finding(rows):
    known = sorted((row for row in rows if row["ratios"]), key=lambda row: row["floor"])
    if not known:
        return "No cell was repeated often enough to measure its noise."
    loads = [load for row in rows for load in row["loads"]]
    said = [f"{noise.percent(row['floor'])} % in {row['sweep']}" for row in known]
    busy = f"; the load average was {np.median(loads):.2g} in the median, {max(loads):.2g} at most" if loads else ""
    return f"Timed against itself, a method differs by at most {listing(said)} ({noise.LIKELY} of 100 cells of each){busy}."


def _rows(context, sweep):
    """One for each role: each has a floor of its own (noise.Floor)."""
    kind, found = context.store.sweep(sweep).kind, []
    time = next((name for name in context.metrics(kind, "cost") if context.store.is_time(name)), None)
    for role, cells in noise.by_role(context, sweep) if time else ():
        timed = cells[cells["key_timed"].notna()]
        if len(timed):
            found.append({"sweep": sweep if role == "competitor" else f"{sweep} ({role})", "cells": len(timed),
                          "ratios": noise.with_itself(timed, time), "floor": noise.floor(timed, time),
                          "loads": [v for _, cell in timed.iterrows() for v in noise.runs(cell, "load")]})
    return found
