# SPDX-License-Identifier: Zlib
"""Which methods are one path: runs whose final states have the same bits, cell by cell and seed by seed."""

from itertools import combinations

import numpy as np
import pandas as pd

import load
import ranking
from chart import Chart, listing, of_store, plural
from style import WIDTH, plt

SECTION = "Are these methods different?"
MOST = 0.5  # part of the runs of two methods that must end in the same bits; larger: fewer methods are called one
LEAST = 2  # runs that two methods must share, or nothing is said of them
SHOWN = 24  # bars at most


@of_store("distinctness", 65, SECTION,
          "Runs that end in the same bits", "No two methods were run on the same worlds in this store.", "resolvers")
def distinctness(context):
    found = [agreements(context.store, context.cells(sweep)) for sweep in context.store.sweeps()
             if context.store.sweep(sweep).kind == "world"]
    found = [table for table in found if len(table)]
    return [_chart(pd.concat(found, ignore_index=True), swept(context))] if found else []


def swept(context):
    """{(sweep, method): the share of rows that it left to Gauss-Seidel, in words}: why two may be one path."""
    found = {}
    for sweep in (sweep for sweep in context.store.sweeps() if context.store.sweep(sweep).kind == "world"):
        for _, cell in context.cells(sweep).iterrows():
            share = ranking.share_of_fallbacks(context, cell)
            if share != 0:
                key = sweep, cell["method"]
                found[key] = ranking.largest([found.get(key, ""), ranking.said_of_share(share)])
    return found


def agreements(store, cells):
    """One row for each two methods of a sweep: how many finished runs (a cell under one seed) they share, and how many of them
    end in equal hashes."""
    columns = ["sweep", "a", "b", "cells", "equal"]
    if not len(cells):
        return pd.DataFrame(columns=columns)
    others = sorted(load.axes_of(store, cells) - {axis for name in cells["sweep"].unique() for axis in store.method_axes(name)})
    others = [name for name in others if name in cells]
    ends = {}
    for _, cell in cells.iterrows():
        place = tuple(str(cell[name]) for name in others)
        for seed, key in zip(cell["seeds"], cell["keys"]):
            if key is not None and store.trials.at[key, "outcome"] == "ok" and store.trials.at[key, "hash"]:
                ends.setdefault(cell["method"], {})[(*place, seed)] = store.trials.at[key, "hash"]
    rows = []
    for a, b in combinations(sorted(ends), 2):
        common = ends[a].keys() & ends[b].keys()
        if len(common) >= LEAST:
            rows.append((cells["sweep"].iloc[0], a, b, len(common), sum(ends[a][at] == ends[b][at] for at in common)))
    return pd.DataFrame(rows, columns=columns)


def paths(table):
    """Methods of one sweep that are one path: each agrees in most cells with another of them."""
    groups = []
    for row in table[table["equal"] > MOST * table["cells"]].itertuples():
        joined = [g for g in groups if row.a in g or row.b in g]
        groups = [g for g in groups if g not in joined] + [set().union({row.a, row.b}, *joined)]
    return [sorted(g) for g in groups]


def finding(table, swept):
    said, different = [], []
    for sweep, part in table.groupby("sweep", sort=True):
        for group in paths(part):
            inside = part[part["a"].isin(group) & part["b"].isin(group)]
            named = [ranking.beside(method, swept.get((sweep, method), "")) for method in group]
            said.append(f"in {sweep} {listing(named)} are one path ({int(inside['equal'].sum())} of {int(inside['cells'].sum())} "
                        "comparisons end in the same bits)")
        if not paths(part):
            different.append(sweep)
    if not said:
        return f"No two methods end in the same bits in most of the runs that they share, in {listing(different)}."
    text = "; ".join(said)
    text = text[0].upper() + text[1:]
    return text + (f"; no two methods of {listing(different)} agree in most of their runs." if different else ".")


def _chart(table, swept):
    table = table.assign(share=table["equal"] / table["cells"])
    shown = table[table["equal"] > 0].sort_values("share", ascending=False, kind="stable").head(SHOWN)
    figure = None
    if len(shown):
        call = lambda sweep, method: ranking.beside(method, swept.get((sweep, method), ""))  # noqa: E731
        names = [f"{call(row.sweep, row.a)} = {call(row.sweep, row.b)}, {row.sweep}" for row in shown.itertuples()]
        height, left = 0.9 + 0.24 * len(shown), 0.4 + 0.075 * max(map(len, names))
        figure, ax = plt.subplots(figsize=(WIDTH, height))
        figure.subplots_adjust(left=left / WIDTH, right=1 - 0.9 / WIDTH, top=1 - 0.15 / height, bottom=0.6 / height)
        at = np.arange(len(shown))
        ax.barh(at, 100 * shown["share"], color=["#0072B2" if s > MOST else "#B9CFE4" for s in shown["share"]], height=0.65)
        for y, row in enumerate(shown.itertuples()):
            ax.text(100 * row.share + 0.8, y, f"{row.equal} of {row.cells}", va="center", fontsize=8)
        ax.axvline(100 * MOST, color="#999999", lw=0.8, ls=(0, (4, 3)))
        ax.set_yticks(at)
        ax.set_yticklabels(names)
        ax.set_ylim(len(shown) - 0.5, -0.5)
        ax.set_xlim(0, 100)
        ax.grid(False, axis="y")
        ax.set_xlabel("runs that end in the same bits, %")
    more = int((table["equal"] > 0).sum()) - len(shown)
    return Chart("distinctness", SECTION, "Runs that end in the same bits", finding(table, swept), "", figure,
                 table.rename(columns={"share": "share [1]"}),
                 [f"{plural(more, 'further pair')} that agree somewhere are in the numbers alone"] if more > 0 else [],
                 "Two runs are equal when the hash of their final poses and velocities is: to the last bit, not nearly. Beyond "
                 "the dashed line (half of the runs that both finished) a bar is dark: one path under two names, whose times are "
                 "two measurements of the same thing. Exact broadphases agree by design, because the world sorts their pairs.")
