# SPDX-License-Identifier: Zlib
"""The quality of a store: planned and finished trials, noise of times, and methods with equal results."""

import math
from itertools import combinations

import numpy as np
import pandas as pd
from matplotlib.patches import Patch

import coverage
import load
import measured
import noise
import ranking
from chart import Chart, of_store
from finding import Finding, cut
from load import NOT_RUN, SEVERITY
from sentences import listing, plural, some, span, verb
from style import OUTCOMES, WIDTH, grid_of_axes, plt

DIFFERENT = "Are these methods different?"
MOST = 0.5  # two methods are one path if more than this share of their runs ends in the same bits
LEAST = 2  # common runs that two methods need to be compared
SHOWN = 24  # bars at most


@of_store("distinctness", 65, DIFFERENT,
          "Runs that end in the same bits", "This store has no two methods that ran on the same worlds.", "resolvers")
def distinctness(context):
    found = [agreements(context.store, context.cells(sweep)) for sweep in context.store.sweeps()
             if context.store.sweep(sweep).kind == "world"]
    found = [table for table in found if len(table)]
    return [_chart(pd.concat(found, ignore_index=True), swept(context))] if found else []


def swept(context):
    """{(sweep, method): the share of rows that it left to Gauss-Seidel, as text}: a reason why two methods are one path."""
    found = {}
    for sweep in (sweep for sweep in context.store.sweeps() if context.store.sweep(sweep).kind == "world"):
        for _, cell in context.cells(sweep).iterrows():
            share = ranking.share_of_fallbacks(context, cell)
            if share != 0:
                key = sweep, cell["method"]
                found[key] = ranking.largest([found.get(key, ""), ranking.said_of_share(share)])
    return found


def agreements(store, cells):
    """One row per pair of methods of a sweep: the number of finished runs (a cell under one seed) that both have, and how many of
    these end in equal hashes."""
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
    """Groups of methods of one sweep that are one path: each agrees in most cells with another of its group."""
    groups = []
    for row in table[table["equal"] > MOST * table["cells"]].itertuples():
        joined = [g for g in groups if row.a in g or row.b in g]
        groups = [g for g in groups if g not in joined] + [set().union({row.a, row.b}, *joined)]
    return [sorted(g) for g in groups]


def finding_of_alike(table, swept):
    rows = []
    for sweep, part in table.groupby("sweep", sort=True):
        for group in paths(part):
            inside = part[part["a"].isin(group) & part["b"].isin(group)]
            named = [ranking.beside(method, swept.get((sweep, method), "")) for method in group]
            rows.append((sweep, listing(named), int(inside["equal"].sum()), int(inside["cells"].sum()), group))
        if not paths(part):
            rows.append((sweep, "none", int(part["equal"].sum()), int(part["cells"].sum()), []))
    sweeps = table["sweep"].nunique()
    same = [row for row in rows if row[4]]
    if not same:
        text = f"No two methods end in the same bits in most of their common runs, in {plural(sweeps, 'sweep')}."
    else:
        sweep, _, equal, cells, group = max(same, key=lambda row: (len(row[4]), row[2]))
        ends = (f"they end in the same bits in {equal} of {cells} common runs" if len(group) == 2 else
                "each ends in the same bits as another of them in most of the runs that both finished")
        text = f"In {sweep} {some(group)} are one path: {ends}."
    columns = ["sweep", "one path", "pairs of runs with equal bits", "pairs of runs"]
    return Finding(text, cut(pd.DataFrame([row[:4] for row in rows], columns=columns)))


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
    return Chart("distinctness", DIFFERENT, "Runs that end in the same bits", finding_of_alike(table, swept), "", figure,
                 table.rename(columns={"share": "share [1]"}),
                 [f"{plural(more, 'further pair')} with equal runs: only in the numbers"] if more > 0 else [],
                 "Runs are equal if the hashes of their final poses and velocities are. Dark bars beyond the dashed line (half "
                 "of the runs that both finished): one path under two names, whose times measure the same thing twice. Exact "
                 "broadphases agree by design, because the world sorts their pairs.")


NOISY = "How noisy are these times?"
WIDEST = 50.0  # percent: the range of the first panel


@of_store("noise", 115, NOISY, "Noise of times", "This store has no timed trial.")
def noise_floor(context):
    rows = [row for sweep in context.store.sweeps() for row in _rows(context, sweep)]
    if not rows:
        return []
    figure = _drawn(rows) if any(row["ratios"] or row["loads"] for row in rows) else None  # old stores have neither
    table = pd.DataFrame([{"sweep": row["sweep"], "cells": row["cells"], "cells with enough repeats": len(row["ratios"]),
                           "noise floor [1]": row["floor"] - 1 if row["ratios"] else math.nan,
                           "load average, median": float(np.median(row["loads"])) if row["loads"] else math.nan,
                           "load average, largest": max(row["loads"], default=math.nan)} for row in rows])
    return [Chart("noise", NOISY, "The same method against itself", finding_of_noise(rows), "", figure, table,
                  [], "A dash in the first panel is one cell: the median of its even repeats over that of its odd ones, "
                  f"from the same rounds. The bar is the noise floor: of up to 20 cells all are inside, of more {noise.LIKELY} "
                  "of 100. A ratio counts in charts if it exceeds the floor and the two whiskers do not overlap. Other libraries "
                  "and engines have their own floors." + beyond(rows) + " Load is the mean of a minute.")]


def beyond(rows):
    """For the note: sweeps with marks outside the first panel, which are drawn at its edge."""
    said = []
    for row in rows:
        marks = [*row["ratios"], row["floor"], 1 / row["floor"]] if row["ratios"] else []
        outside = [max(ratio, 1 / ratio) for ratio in marks if abs(100 * (ratio - 1)) > WIDEST]
        if outside:
            said.append(f"{row['sweep']} (a factor of up to {max(outside):.2g})")
    return f" Drawn at the edge of the first panel: marks of {listing(said)}." if said else ""


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
    left.set_xlabel("even over odd repeats, less 1 (%)")
    right.set_xlabel("load average at the start of timed trials")
    right.set_xlim(left=0)
    return figure


def finding_of_noise(rows):
    known = sorted((row for row in rows if row["ratios"]), key=lambda row: row["floor"])
    few = f"too few repeats: only ratios beyond {noise.UNMEASURED:g} count"
    found = [{"sweep": row["sweep"], "noise floor": f"{noise.percent(row['floor'])} %" if row["ratios"] else few,
              "cells with enough repeats": len(row["ratios"])}
             for row in [*known, *(row for row in rows if not row["ratios"])]]
    loads = {row["sweep"]: row["loads"] for row in rows if row["loads"]}
    for row in found if loads else ():
        mine = loads.get(row["sweep"], [])
        row["load average, median to most"] = f"{np.median(mine):.2g} to {max(mine):.2g}" if mine else ""
    if not known:
        return Finding("No cell has enough repeats to measure the noise.", cut(pd.DataFrame(found)))
    ends = span(*(f"{noise.percent(row['floor'])} % ({row['sweep']}, {noise.inside(len(row['ratios']))})"
                  for row in (known[0], known[-1])))
    return Finding(f"A method differs from itself by at most {ends}.", cut(pd.DataFrame(found)))


def _rows(context, sweep):
    """One row per role, because each role has its own floor (noise.Floor)."""
    kind, found = context.store.sweep(sweep).kind, []
    time = next((name for name in context.metrics(kind, "cost") if context.store.is_time(name)), None)
    for role, cells in noise.by_role(context, sweep) if time else ():
        timed = cells[cells["key_timed"].notna()]
        if len(timed):
            found.append({"sweep": sweep if role == "competitor" else f"{sweep} ({role})", "cells": len(timed),
                          "ratios": noise.with_itself(timed, time), "floor": noise.floor(timed, time),
                          "loads": [v for _, cell in timed.iterrows() for v in measured.runs(cell, "load")]})
    return found


PLANNED = "Coverage: which planned trials have a result?"


@of_store("coverage", 120, PLANNED, "Outcomes of the planned trials", "This store has no planned trial.")
def coverage_of_plan(context):
    table = coverage.trials(context.store)
    if not len(table):
        return []
    outcomes = [o for o in SEVERITY + [NOT_RUN] if (table["outcome"] == o).any()]
    outcomes += sorted(set(table["outcome"]) - set(outcomes))
    sweeps = list(dict.fromkeys(table["sweep"]))
    height = 0.75 + 0.36 * len(sweeps)
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    figure.subplots_adjust(left=2.1 / WIDTH, right=1 - 2.6 / WIDTH, top=1 - 0.15 / height, bottom=0.55 / height)
    for y, sweep in enumerate(sweeps):
        part = table[table["sweep"] == sweep]
        at = 0.0
        for outcome in outcomes:
            share = 100 * float((part["outcome"] == outcome).sum()) / len(part)
            if share:
                ax.barh(y, share, left=at, color=OUTCOMES.get(outcome, ("#FF00FF", ""))[0], edgecolor="#888888", lw=0.5,
                        hatch="///" if outcome == NOT_RUN else None, height=0.7)
            at += share
        ax.text(101, y, f"{int(_ran(part).sum())} of {len(part)}", va="center", fontsize=8.5)
    ax.set_xlim(0, 100)
    ax.set_ylim(len(sweeps) - 0.5, -0.5)
    ax.set_yticks(range(len(sweeps)))
    ax.set_yticklabels(sweeps)
    ax.set_xlabel("share of the planned trials (%); right: trials that ran of those planned")
    ax.grid(False)
    handles = [Patch(facecolor=OUTCOMES.get(o, ("#FF00FF", ""))[0], edgecolor="#888888", label=o,
                     hatch="///" if o == NOT_RUN else None) for o in outcomes]
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(1 - 1.65 / WIDTH, 1 - 0.1 / height), borderaxespad=0,
                  labelspacing=0.35)
    ran = int(_ran(table).sum())
    ok = int((table["outcome"] == "ok").sum())
    found = pd.DataFrame([(o, int((table["outcome"] == o).sum())) for o in outcomes], columns=["outcome", "trials"])
    found["share"] = [f"{100 * count / len(table):.2g} %" for count in found["trials"]]
    text = f"{ran:,} of {len(table):,} planned {verb(len(table), 'trials', 'trial')} ran, {ok:,} of them ok."
    older = context.store.superseded
    note = f" {plural(older, 'older plan')} of the same cells, made with other code: not counted." if older else ""
    counts = table.groupby(["sweep", "outcome"], sort=False).size().unstack(fill_value=0).reindex(columns=outcomes)
    counts.insert(0, "planned", counts.sum(axis=1))
    return [Chart("coverage", PLANNED, "Outcomes of the planned trials", Finding(text, cut(found)), "", figure,
                  counts.reset_index(),
                  note="Trials that ended early, such as by collapsing, ran; unsupported trials did not. The list of outcomes on "
                       "this page explains each." + note)]


def _ran(table):
    return ~table["outcome"].isin((NOT_RUN, "unsupported"))
