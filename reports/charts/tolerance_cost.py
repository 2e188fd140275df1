# SPDX-License-Identifier: Zlib
"""What a tolerance of a pair query buys and costs: time, counted work and worst error over it."""

import math
import re

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import noise
from chart import Chart, Headline, Needs, dimension_of, holes, identifier, of_sweeps
from load import one_machine
from style import ZeroLog, grid_of_axes, legend_right, legend_room, times
from table import quantity

SECTION = "Which pair query is fast and right?"
SETTING, TIME, ERROR = "tolerance", "ns_per_query", "max_error"
WORK = "support_calls"
FEWEST = 3  # values of the tolerance that make a curve


@of_sweeps("tolerance_cost", 74, SECTION,
           Needs("pairs", metrics=(TIME, ERROR), also=f"a method with {FEWEST} values of its {SETTING}"),
           "What a tolerance costs", "No timed sweep of pair queries over a tolerance is in this store.", "tolerance_cost")
def tolerance_cost(context, cells):
    if WORK not in cells:
        return []
    cells, refused = one_machine(context.store, cells)
    read = [parted(method) for method in cells["method"]]
    cells = cells.assign(who=[who for who, _ in read], at=[at for _, at in read])
    cells = cells[np.isfinite(cells["at"].astype(float))]
    cells = cells.groupby("who").filter(lambda mine: mine["at"].nunique() >= FEWEST) if len(cells) else cells
    if not len(cells):
        return []
    cells["pair"] = ["–".join(sorted((str(a), str(b)))) for a, b in zip(cells["kind_a"], cells["kind_b"])]
    return [_chart(context, cells[dimension_of(cells) == dimension], dimension, refused)
            for dimension in sorted(set(dimension_of(cells)))]


def parted(method):
    """(the method without its tolerance, the tolerance): NaN where its label says none."""
    found = re.search(rf"\b{SETTING}=([0-9.eE+-]+),?", method)
    if not found:
        return method, math.nan
    return (method[:found.start()] + method[found.end():]).replace(",}", "}").replace("{}", ""), float(found[1])


def ends(cells):
    """(the cell of the tightest tolerance, that of the loosest) of one curve; None where fewer than two have a time."""
    good = cells[cells["outcome"].isin(["ok", "wrong"]) & np.isfinite(metrics.column(cells, TIME))].sort_values("at")
    return (good.iloc[0], good.iloc[-1]) if len(good) > 1 else None


def told(cells, least):
    """[(pair, method, tightest, loosest)] where both have a time."""
    found = [(pair, who, ends(part)) for (pair, who), part in cells.groupby(["pair", "who"], sort=True)]
    return [(pair, who, *both) for pair, who, both in found if both]


def finding(cells, dimension, least):
    rows, said = told(cells, least), []
    for who in sorted({row[1] for row in rows}):
        parts = []
        for pair, _, tight, loose in (row for row in rows if row[1] == who):
            word = noise.said(tight, loose, TIME, least)
            time = noise.IN_WORDS.get(word) or f"{times(noise.ratio(tight, loose, TIME))} times the time"
            parts.append(f"on {pair} {time}, {tight[WORK]:.3g} support points become {loose[WORK]:.3g}, the worst error goes "
                         "from "
                         f"{tight[ERROR]:.2g} to {loose[ERROR]:.2g} of the size")
        first = next(row for row in rows if row[1] == who)
        said.append(f"{who} at {first[3]['at']:g} instead of {first[2]['at']:g}: {'; '.join(parts)}")
    return f"In {dimension}D " + (". ".join(said) if said else "no method has times at two tolerances") + "."


def headline(cells, dimension, least):
    """Where the loosest tolerance saves most time, beyond the noise."""
    rows = [row for row in told(cells, least) if noise.tells(row[2], row[3], TIME, least) and row[3][TIME] < row[2][TIME]]
    if not rows:
        return None
    pair, who, tight, loose = max(rows, key=lambda row: row[2][TIME] / row[3][TIME])
    return Headline(f"{pair}, {dimension}D: a tolerance of {loose['at']:g} saves {who} "
                    f"{100 * (1 - loose[TIME] / tight[TIME]):.0f} % "
                    f"of its time, for a worst error of {loose[ERROR]:.2g} of the size instead of {tight[ERROR]:.2g}.",
                    {f"{SETTING} {cell['at']:g}": float(cell[TIME]) for cell in (tight, loose)}, "ns", "time per query")


def _chart(context, cells, dimension, refused):
    pairs, methods, sweep = sorted(cells["pair"].unique()), sorted(cells["who"].unique()), cells["sweep"].iloc[0]
    looks, least = context.looks(cells), noise.floor_of(context, sweep, TIME)
    look_of = {who: looks(cells[cells["who"] == who]["method"].iloc[0]) for who in methods}
    legend_width = legend_room(methods, 1.5)
    figure, axes = grid_of_axes(3, len(pairs), 1.75, legend_width, left=0.85, gap_x=0.65, gap_y=0.3, bottom=0.6)
    bad = ~cells["outcome"].isin(["ok", "wrong"]).to_numpy()
    for column, pair in enumerate(pairs):
        for row, metric in enumerate((TIME, WORK, ERROR)):
            ax, part = axes[row][column], cells[(cells["pair"] == pair) & ~bad]
            across = ZeroLog(ax, "x", cells["at"].astype(float), "1", failures=False)
            values = metrics.column(part, metric)
            up = ZeroLog(ax, "y", values[np.isfinite(values)], context.unit(metric), failures=False,
                         floor=1e-17 if metric == ERROR else 0.0)
            for who in methods:
                mine = part[(part["who"] == who) & np.isfinite(values)].sort_values("at")
                ax.plot([across.place(v) for v in mine["at"]], [up.place(v) for v in metrics.column(mine, metric)],
                        **look_of[who])
            if metric == ERROR:
                known = sorted(v for v in set(cells["at"]) if v > 0)
                limits = ax.get_ylim()
                ax.plot(known, known, color="#999999", lw=1, ls=(0, (4, 3)), zorder=0.6)
                ax.set_ylim(limits)
                ax.set_xlabel(SETTING)
            else:
                ax.tick_params(labelbottom=False)
            if row == 0:
                ax.set_title(pair)
            if column == 0:
                ax.set_ylabel(context.title(metric))
    handles = [Line2D([], [], label=who, **look_of[who]) for who in methods]
    handles.append(Line2D([], [], color="#999999", lw=1, ls=(0, (4, 3)), label="error = tolerance"))
    legend_right(figure, handles, legend_width)
    return Chart(identifier(f"{sweep} {dimension}d"), SECTION, f"What a tolerance costs, {dimension}D",
                 finding(cells, dimension, least), sweep, figure, _table(context, cells),
                 refused + holes(cells[bad].assign(step=math.nan), ["pair", "method"]),
                 "What a tolerance is compared with is the method's own affair (`lpc list --stage pair_query`); errors are "
                 "over the "
                 "size of the query: largest extent + distance + largest coordinate. An outcome is judged by the tolerance that "
                 f"was asked for. {noise.rule(least)}",
                 headline=headline(cells, dimension, least))


def _table(context, cells):
    table = cells.sort_values(["pair", "who", "at"])
    numbers = quantity(SETTING, "1", table["at"])
    for name in (TIME, WORK, ERROR, "median_error"):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    return pd.DataFrame({"pair": table["pair"], "method": table["who"], "outcome": table["outcome"], **numbers})
