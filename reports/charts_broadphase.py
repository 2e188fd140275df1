# SPDX-License-Identifier: Zlib
"""Broadphases alone on frozen boxes: time and box tests over the body count (2009 report, figure 7.3)."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
from chart import Chart, dimension_of, holes, listing
from load import one_machine
from style import ZeroLog, grid_of_axes, legend_right, letter, plain_log, si, times

SECTION = "Which broadphase for how many bodies?"
TIME, TESTS = "ns_per_frame_median", "box_tests_mean"


def charts(context):
    cells = context.store.cells("broadphase")
    if not len(cells) or "n" not in cells:
        return [Chart("broadphase", SECTION, "Time over body count", "No broadphase sweep is in this store.",
                      "broadphase_crossover")]
    cells, refused = one_machine(cells)
    if "distribution" not in cells:
        cells["distribution"] = "boxes"
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        for precision, part in _by_precision(cells[dimension_of(cells) == dimension]):
            made.append(_chart(context, part, dimension, precision, refused))
    return made


def _by_precision(cells):
    if "precision" not in cells or cells["precision"].nunique() < 2:
        return [("", cells)]
    return [(" " + name, part) for name, part in cells.groupby("precision", sort=True)]


def curve(cells, method, metric):
    """(n, value) of one method, ascending n; NaN where the cell failed or is missing."""
    part = cells[cells["method"] == method].sort_values("n")
    values = metrics.column(part, metric).copy()
    values[(part["outcome"] != "ok").to_numpy()] = math.nan
    return part["n"].astype(float).to_numpy(), values


def tree_of(methods):
    for wanted in ("region_tree", "dynamic_tree", "rebuilt_bvh", "tree", "bvh"):
        for method in methods:
            if wanted in method:
                return method
    return None


def crossings(cells):
    """Per distribution and method: where it starts to beat naive for good."""
    rows = []
    for distribution, part in cells.groupby("distribution", sort=True):
        methods = sorted(part["method"].unique())
        if "naive" not in methods:
            continue
        n, naive = curve(part, "naive", TIME)
        for method in methods:
            if method == "naive":
                continue
            n_other, other = curve(part, method, TIME)
            shared, at_naive, at_other = np.intersect1d(n, n_other, return_indices=True)
            a, b = naive[at_naive], other[at_other]
            both = np.isfinite(a) & np.isfinite(b)
            if not both.any():
                rows.append((distribution, method, "unknown", math.nan, math.nan, math.nan))
                continue
            cross = metrics.crossover(shared, a, b)
            last = np.flatnonzero(both)[-1]
            kind = "crosses" if cross else ("always faster" if (b[both] < a[both]).all() else
                                            "never faster" if (b[both] >= a[both]).all() else "slower at the end")
            rows.append((distribution, method, kind, cross or math.nan, shared[last], a[last] / b[last]))
    return pd.DataFrame(rows, columns=["distribution", "method", "kind", "n", "largest n", "ratio"])


def finding(cross, tree, dimension):
    if not len(cross):
        return f"In {dimension}D naive was not measured beside another method, so no crossing can be told."
    said = []
    for row in cross[cross["method"] == tree].itertuples():
        where = f"on {row.distribution} boxes"
        if row.kind == "crosses":
            said.append(f"{where} {tree} beats naive from {row.n:,.0f} bodies on and is {times(row.ratio)} times faster "
                        f"at {row._5:,.0f}")
        elif row.kind == "unknown":
            said.append(f"{where} {tree} and naive have no size in common that both finished")
        else:
            said.append(f"{where} {tree} is {row.kind} ({times(max(row.ratio, 1 / row.ratio))} times "
                        f"{'faster' if row.ratio > 1 else 'slower'} at {row._5:,.0f} bodies)")
    fastest = []
    for distribution, part in cross.groupby("distribution", sort=True):
        best = part.loc[part["ratio"].idxmax()] if part["ratio"].notna().any() else None
        if best is not None and best["ratio"] > 1:
            fastest.append(f"{best['method']} on {distribution} ({times(best['ratio'])} times naive's speed at "
                           f"{best['largest n']:,.0f})")
    sentence = f"In {dimension}D " + "; ".join(said) if said else f"In {dimension}D no tree was measured"
    return sentence + (f"; fastest at the largest size: {listing(fastest)}." if fastest else ".")


def n_share(cells, n):
    low, high = math.log(cells["n"].min()), math.log(cells["n"].max())
    return 0.0 if high == low else (math.log(n) - low) / (high - low)


def _chart(context, cells, dimension, precision, refused):
    distributions = sorted(cells["distribution"].unique())
    methods = sorted(cells["method"].unique())
    cross, tree = crossings(cells), tree_of(methods)
    legend_width = 1.75
    figure, axes = grid_of_axes(2, len(distributions), 2.55, legend_width, left=0.9, gap_x=0.3, bottom=0.55, gap_y=0.5)
    for row, metric in enumerate((TIME, TESTS)):
        finished = cells["outcome"].to_numpy() == "ok"
        unit = metrics.METRICS[metric].unit
        values = metrics.column(cells, metric)[finished]
        values = values[np.isfinite(values)]
        for column, distribution in enumerate(distributions):
            ax, part = axes[row][column], cells[cells["distribution"] == distribution]
            plain_log(ax, "x", part["n"].astype(float))
            scale = ZeroLog(ax, "y", values, unit, failures=not finished.all())
            for method in methods:
                n, value = curve(part, method, metric)
                look = context.looks(method)
                good = np.isfinite(value)
                ax.plot(n[good], [scale.place(v) for v in value[good]], **look)
                mine = part[part["method"] == method].sort_values("n")
                for at, outcome in zip(n, mine["outcome"]):
                    if outcome != "ok":
                        ax.plot([at], [scale.failed], ls="none", marker=letter(outcome), color=look["color"], ms=7, mew=0.3)
                if metric == TIME and "ns_per_frame_p25" in mine:
                    ax.fill_between(n[good], mine["ns_per_frame_p25"].astype(float).to_numpy()[good],
                                    mine["ns_per_frame_p75"].astype(float).to_numpy()[good], color=look["color"],
                                    alpha=0.15, lw=0)
            hit = cross[(cross["method"] == tree) & (cross["distribution"] == distribution)]
            if metric == TIME and len(hit) and math.isfinite(hit["n"].iloc[0]):
                at = hit["n"].iloc[0]
                ax.axvline(at, color="#444444", lw=1, ls=":")
                right = n_share(part, at) > 0.6
                ax.annotate(f"from n = {at:,.0f}\n{tree} wins", (at, 0), xycoords=("data", "axes fraction"),
                            xytext=(-5 if right else 5, 5), textcoords="offset points", ha="right" if right else "left",
                            va="bottom", size=8.5)
            if row == 0:
                ax.set_title(f"{distribution} boxes, {dimension}D")
            else:
                ax.set_xlabel("bodies n")
            if column == 0:
                ax.set_ylabel("time per frame" if metric == TIME else "box tests per frame")
            else:
                ax.tick_params(labelleft=False)
    handles = [Line2D([], [], label=context.looks.name(m), **context.looks(m)) for m in methods]
    handles += [Line2D([], [], ls="none", marker=letter(o), color="#555555", ms=7, label=o)
                for o in sorted({o for o in cells["outcome"] if o != "ok"})]
    legend_right(figure, handles, legend_width)
    table = cells.assign(**{"time per frame": [si(v, "ns") for v in metrics.column(cells, TIME)],
                            "quartiles": [f"{si(a, 'ns')} to {si(b, 'ns')}" for a, b in
                                          zip(metrics.column(cells, "ns_per_frame_p25"),
                                              metrics.column(cells, "ns_per_frame_p75"))]})
    shown = ["distribution", "method", "n", "outcome", "time per frame", "quartiles"]
    for name in (TESTS, "node_visits_mean", "pairs_mean", "wrong_pairs"):
        if name in table:
            shown.append(name)
    table = table.sort_values(["distribution", "method", "n"])[shown]
    return Chart(f"broadphase_{dimension}d{precision.strip()}", SECTION, f"Time and box tests over body count, "
                 f"{dimension}D{precision}", finding(cross, tree, dimension), cells["sweep"].iloc[0], figure, table,
                 refused + holes(cells, ["distribution", "method", "n"]),
                 "Both axes are logarithmic; a line of slope 2 is n². Bands are quartiles over "
                 "frames. The dotted line is where the tree begins to beat naive for good.")
