# SPDX-License-Identifier: Zlib
"""Pair queries alone on random pairs of shapes: time against error, and how often they fail."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import failure
import metrics
from chart import Chart, Headline, Needs, dimension_of, holes, listing, plural
from load import one_machine
from style import OUTCOMES, WIDTH, ZeroLog, fallen, grid_of_axes, legend_right, legend_room, letter, plt, si
from table import quantity

PLACE = 70
SECTION = "Which pair query is fast and right?"
FLOOR = 1e-17  # a tenth of the rounding of one operation in double precision: as good as exact
ERRORS = ("median_error", "p99_error", "max_error")
NEEDS = Needs("pairs", metrics=("ns_per_query", *ERRORS))
ABSENT = Chart("pair_queries", SECTION, "Time against error", "No timed sweep of pair queries is in this store.", "pair_queries")


def of_sweep(context, cells):
    if "wrong" not in cells:
        return [Chart(f"{cells['sweep'].iloc[0]}_uncounted", SECTION, "Time against error",
                      "These trials of pairs do not count wrong answers: they are older than the definition of a failure. The "
                      "sweep runs them again.", cells["sweep"].iloc[0])]
    cells, refused = one_machine(context.store, cells)
    if "precision" in cells and cells["precision"].nunique() > 1:
        cells["method"] = cells["method"] + " " + cells["precision"].map({"f64": "", "f32": "f32"}).fillna("")
        cells["method"] = cells["method"].str.strip()
    cells["pair"] = ["–".join(sorted((str(a), str(b)))) for a, b in zip(cells["kind_a"], cells["kind_b"])]
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        part = cells[dimension_of(cells) == dimension]
        part, absent = _present(part, dimension)
        made += [_scatter(context, part, dimension, refused + absent), _failures(context, part, dimension)]
    return made


def _present(cells, dimension):
    """Methods that exist in this dimension; the others are named once, not drawn in every panel."""
    supported = cells.groupby("method")["outcome"].apply(lambda o: (o != "unsupported").any())
    absent = sorted(supported[~supported].index)
    if len(absent) == len(supported):
        return cells, []
    said = [f"{listing(absent)}: unsupported in {dimension}D for every pair of shapes"] if absent else []
    return cells[~cells["method"].isin(absent)], said


def _usable(cells):
    return cells["outcome"].isin(["ok", "wrong"]).to_numpy()


def _holes(cells):
    """Who has no number; wrong answers are counted in the chart."""
    return holes(cells[~_usable(cells)], ["pair", "method"])


def finding(cells, dimension):
    good = cells[_usable(cells) & np.isfinite(metrics.column(cells, "ns_per_query"))]
    if not len(good):
        return f"In {dimension}D no pair query has both a time and an error."
    passed = good[failure.in_pairs(good) == 0]
    if not len(passed):
        return f"In {dimension}D every pair query that was timed fails somewhere."
    fastest = passed.loc[passed.groupby("pair")["ns_per_query"].idxmin()]
    wins = fastest.groupby("method").size().sort_values(ascending=False, kind="stable")
    errors = metrics.column(good, "max_error")
    worst = good.iloc[int(np.nanargmax(errors))] if np.isfinite(errors).any() else None
    text = (f"In {dimension}D {wins.index[0]} is the fastest of those without a failure on {wins.iloc[0]} of "
            f"{plural(len(fastest), 'pair of shapes', 'pairs of shapes')} (down to "
            f"{si(fastest['ns_per_query'].min(), 'ns')} a query)")
    if worst is not None:
        zero = int((errors == 0).sum())
        text += (f"; the worst error of all is {worst['method']}'s {worst['max_error']:.1e} of the size on {worst['pair']}"
                 + (f", and {plural(zero, 'cell has', 'cells have')} no error at all" if zero else ""))
    return text + "."


def headline(cells, dimension):
    """The pair of kinds that most methods answer without a failure; of these the one on which their times differ most."""
    good = cells[_usable(cells) & np.isfinite(metrics.column(cells, "ns_per_query")) & (failure.in_pairs(cells) == 0)]
    found = [(part["method"].nunique(), part["ns_per_query"].max() / part["ns_per_query"].min(), pair)
             for pair, part in good.groupby("pair", sort=True) if part["method"].nunique() > 1]
    if not found:
        return None
    part = good[good["pair"] == max(found)[2]].sort_values("ns_per_query", kind="stable")
    first, last = part.iloc[0], part.iloc[-1]
    return Headline(f"On {first['pair']} in {dimension}D {first['method']} is the fastest of those that never fail, "
                    f"{si(first['ns_per_query'], 'ns')} a query; {last['method']} takes {si(last['ns_per_query'], 'ns')}.",
                    dict(zip(part["method"], part["ns_per_query"])), "ns")


def _scatter(context, cells, dimension, refused):
    pairs = sorted(cells["pair"].unique())
    methods = sorted(cells["method"].unique())
    columns = min(4, len(pairs))
    rows = math.ceil(len(pairs) / columns)
    legend_width = legend_room(map(context.name, methods), 2.2)
    figure, axes = grid_of_axes(rows, columns, 1.95, legend_width, left=0.75, gap_x=0.55, gap_y=0.5)
    usable, looks = _usable(cells), context.looks(cells)
    errors = {name: np.where(usable, metrics.column(cells, name), math.nan) for name in ERRORS}
    time, failed = metrics.column(cells, "ns_per_query"), failure.in_pairs(cells)
    all_errors = np.concatenate(list(errors.values()))
    for index, ax in enumerate(axes.flat):
        if index >= len(pairs):
            ax.set_visible(False)
            continue
        mine = np.flatnonzero((cells["pair"] == pairs[index]).to_numpy())
        across = ZeroLog(ax, "x", time, "ns", failed_name="not timed")
        up = ZeroLog(ax, "y", list(all_errors[np.isfinite(all_errors)]), "1", floor=FLOOR,
                     failures=not usable.all() or bool(np.isnan(errors["max_error"]).any()))
        spots = []
        for i in mine:
            look = looks(cells["method"].iloc[i])
            x = across.place(time[i])
            spread = [errors[name][i] for name in ERRORS if math.isfinite(errors[name][i])]
            if spread:
                ax.plot([x, x], [up.place(min(spread)), up.place(max(spread))], color=look["color"], lw=1.3, alpha=0.6)
                middle = errors["p99_error"][i] if math.isfinite(errors["p99_error"][i]) else max(spread)
                ax.plot([x], [up.place(middle)], **{**look, "linestyle": "none"})
            else:
                spots.append((x, up.failed, cells["outcome"].iloc[i], look["color"]))
        fallen(ax, spots)
        p99 = np.where(np.isfinite(errors["p99_error"]), errors["p99_error"], errors["max_error"])
        front = [mine[i] for i in failure.front(time[mine], p99[mine], failed[mine])]
        ax.step([time[i] for i in front], [up.place(p99[i]) for i in front], where="post", color="#222222", lw=2.4,
                alpha=0.3, zorder=1)
        ax.set_title(pairs[index])
        if index % columns == 0:
            ax.set_ylabel("error / size")
        else:
            ax.tick_params(labelleft=False)
        if index + columns >= len(pairs):
            ax.set_xlabel("time per query")
    handles = [Line2D([], [], label=context.name(m), **looks(m)) for m in methods]
    handles.append(Line2D([], [], color="#222222", lw=2.4, alpha=0.3, label="front, no failures"))
    handles += [Line2D([], [], ls="none", color="#555555", marker=letter(o), ms=7, label=o)
                for o in sorted({o for o in cells["outcome"] if o not in ("ok", "wrong")})]
    legend_right(figure, handles, legend_width)
    table = pd.DataFrame({"pair": cells["pair"], "method": cells["method"], "outcome": cells["outcome"],
                          **quantity("time per query", "ns", time),
                          **{k: v for name in ERRORS for k, v in quantity(name.replace("_", " "), "1", errors[name]).items()}})
    return Chart(f"{cells['sweep'].iloc[0]}_error_{dimension}d", SECTION, f"Time against error by pair of shapes, {dimension}D",
                 finding(cells, dimension), cells["sweep"].iloc[0], figure, table.sort_values(["pair", "method"]),
                 refused + _holes(cells),
                 "A mark is the error that 99 of 100 queries stay below; its bar goes from the median to the worst. "
                 "Errors are over the size of the query: largest extent + distance + largest coordinate. "
                 "Hollow marks are witnesses. " + failure.DEFINITION, headline=headline(cells, dimension))


def _failures(context, cells, dimension):
    pairs, methods = sorted(cells["pair"].unique()), sorted(cells["method"].unique())
    height = 1.5 + 0.3 * len(methods)
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    figure.subplots_adjust(left=2.1 / WIDTH, right=1 - 0.2 / WIDTH, top=1 - 0.2 / height, bottom=1.05 / height)
    rows, bad = [], []
    for y, method in enumerate(methods):
        for x, pair in enumerate(pairs):
            part = cells[(cells["method"] == method) & (cells["pair"] == pair)]
            colour, text, ink = "#F4F4F4", "", "#666666"
            if len(part):
                row = part.iloc[0]
                asked = float(row.get("asked", math.nan))
                counts = [metrics.column(part, name)[0] for name in failure.OF_PAIRS]
                bad_answers = failure.in_pairs(part)[0]
                if row["outcome"] not in ("ok", "wrong"):
                    colour, text = OUTCOMES.get(row["outcome"], ("#FFFFFF", "?"))
                    ink = "black" if row["outcome"] in ("unsupported", "not run", "collapsed") else "white"
                    text = {"unsupported": "no", "not run": "?"}.get(row["outcome"], text)
                    rate = math.nan
                elif math.isfinite(bad_answers) and asked > 0:
                    rate = bad_answers / asked
                    share = 0 if rate == 0 else min(1.0, max(0.1, 1 + math.log10(rate) / 3))
                    colour = "#E3F0E8" if rate == 0 else plt.cm.Oranges(0.25 + 0.6 * share)
                    text, ink = ("0", "#4C7A5E") if rate == 0 else (failure.share(rate), "white" if rate > 0.05 else "black")
                    if rate > 0:
                        bad.append((rate, method, pair))
                else:
                    text, rate = "?", math.nan
                rows.append({"method": method, "pair": pair, "outcome": row["outcome"], "asked": asked,
                             "without an answer": counts[0], "refused": counts[1], "wrong": counts[2], "rate [1]": rate})
            ax.add_patch(plt.Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, facecolor=colour, lw=0))
            ax.text(x, y, text, ha="center", va="center", fontsize=7.5 if len(pairs) > 10 else 8.5, color=ink)
    ax.set_xlim(-0.5, len(pairs) - 0.5)
    ax.set_ylim(len(methods) - 0.5, -0.5)
    ax.set_xticks(range(len(pairs)))
    ax.set_xticklabels(pairs, rotation=30 if len(pairs) > 7 else 0, ha="right" if len(pairs) > 7 else "center")
    ax.set_yticks(range(len(methods)))
    ax.set_yticklabels([context.name(m) for m in methods])
    ax.grid(False)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
    answered = cells[_usable(cells)]
    asked = metrics.column(answered, "asked")
    total = np.nansum(asked)
    if bad:
        rate, method, pair = max(bad)
        clean = [m for m in methods if m not in {b[1] for b in bad} and (answered["method"] == m).any()]
        text = (f"In {dimension}D, at {_tolerance(cells)}, {method} fails most often, on {pair}: {failure.share(rate)} of its "
                f"queries; without any failure: {listing(clean)} ({total:,.0f} queries in all).")
    else:
        text = f"In {dimension}D no query of {total:,.0f} failed, at {_tolerance(cells)}."
    return Chart(f"{cells['sweep'].iloc[0]}_failures_{dimension}d", SECTION, f"Rate of failures by pair of shapes, {dimension}D", text,
                 cells["sweep"].iloc[0], figure, pd.DataFrame(rows), _holes(cells),
                 f"Failures over the queries asked; “no” is a pair that the method does not declare. {failure.DEFINITION}")


def _tolerance(cells):
    precisions = sorted(set(cells["precision"]), reverse=True) if "precision" in cells else ["f64"]
    return listing([failure.tolerance(p) + (f" ({p})" if len(precisions) > 1 else "") for p in precisions])
