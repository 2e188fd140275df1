# SPDX-License-Identifier: Zlib
"""Boxes: the time of broadphases over the number of bodies, and what their parameters change of it."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, holes, identifier, of_sweeps
from load import family, one_machine, split, varying
from sentences import clauses, does, listing
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, plain_log, same,
                   times)
from table import quantity

SECTION = "Which broadphase for how many bodies?"
TIME, TESTS = "ns_per_frame_median", "box_tests_mean"
ASKED = {"heritage_broadphase": "region_tree"}  # by sweep: the tree of figure 7.3 of the 2009 report
UNTIMED = "not timed beside it"
WHY_UNTIMED = "the first ten frames are warm-up; the sweep has no more, or is not timed"


@of_sweeps("broadphase", 10, SECTION,
           Needs("boxes", varies=("n",), metrics=(TIME, TESTS)),
           "Time over body count", "No timed sweep of boxes over their number is in this store.", "broadphase_crossover")
def broadphase(context, cells):
    cells, refused = one_machine(context.store, cells)
    if "distribution" not in cells:
        cells["distribution"] = "boxes"
    others = varying(context.store, cells, ("dimension", "distribution", "n"))  # unequal cells never meet in one chart
    made = []
    for dimension in sorted(set(dimension_of(cells))):
        for part in split(cells[dimension_of(cells) == dimension], others, sort=True):
            made.append(_broadphase_chart(context, part, dimension, describe(part.iloc[0], others), refused))
    return made


def curve(cells, method, metric):
    """(n, value) of one method, ascending n; NaN where the cell failed or is missing."""
    part = cells[cells["method"] == method].sort_values("n")
    values = metrics.column(part, metric).copy()
    values[(part["outcome"] != "ok").to_numpy()] = math.nan
    return part["n"].astype(float).to_numpy(), values


def baseline_of(context, cells):
    """What the sweep names; else the method that is slowest at the largest size."""
    named = context.baseline(cells)
    if named in set(cells["method"]):
        return named
    largest = cells[cells["n"] == cells["n"].max()]
    values = metrics.column(largest, TIME)
    return largest["method"].iloc[int(np.nanargmax(values))] if np.isfinite(values).any() else cells["method"].iloc[0]


def crossings(cells, base, least=1.0):
    """Per distribution and method: where it starts to beat the baseline for good. Where the times of the two at the largest size
    are not told apart (noise.tells, with the floor `least`), there is no crossing."""
    rows = []
    for distribution, part in cells.groupby("distribution", sort=True):
        methods = sorted(part["method"].unique())
        n, slow = curve(part, base, TIME)
        for method in methods:
            if method == base:
                continue
            n_other, other = curve(part, method, TIME)
            shared, at_base, at_other = np.intersect1d(n, n_other, return_indices=True)
            a, b = slow[at_base], other[at_other]
            both = np.isfinite(a) & np.isfinite(b)
            if not both.any():
                done = [set(part[(part["method"] == name) & (part["outcome"] == "ok")]["n"]) for name in (base, method)]
                rows.append((distribution, method, UNTIMED if set.intersection(*done) else "unknown", *[math.nan] * 5))
                continue
            cross = metrics.crossover(shared, a, b)
            last = np.flatnonzero(both)[-1]
            kind = "crosses" if cross else ("always faster" if (b[both] < a[both]).all() else
                                            "never faster" if (b[both] >= a[both]).all() else "slower at the end")
            ends = [part[(part["method"] == name) & (part["n"] == shared[last])].iloc[0] for name in (base, method)]
            word = noise.said(*ends, TIME, least)
            if word in noise.IN_WORDS:
                kind, cross = f"as fast as it at the largest size, {noise.IN_WORDS[word]}", None
            sizes = shared[both]
            between = _bracket(part, base, method, sizes, cross, least) if cross else (math.nan, math.nan)
            rows.append((distribution, method, kind, cross or math.nan, *between, shared[last], a[last] / b[last]))
    return pd.DataFrame(rows, columns=["distribution", "method", "kind", "n", "below", "above", "largest", "ratio"])


def _bracket(part, base, method, sizes, cross, least):
    """The nearest sizes on both sides of a crossing that tell the two apart; where none does, the last that was measured."""
    at = {n: [part[(part["method"] == name) & (part["n"] == n)].iloc[0] for name in (base, method)] for n in sizes}
    apart = [n for n in sizes if noise.tells(*at[n], TIME, least)]
    return (max([n for n in apart if n <= cross], default=sizes.min()),
            min([n for n in apart if n > cross], default=sizes.max()))


def overtakes(row, base):
    """Where one method overtakes the baseline: between two sizes that were measured."""
    return f"overtakes {base} at about {row.n:,.0f} (between {row.below:,.0f} and {row.above:,.0f})"


def leaders(cells, base, least):
    """Per distribution (size, methods, ratios of the baseline's time to theirs) at the largest size: the fastest and all that
    are within the noise of it, the fastest first. None where they are not told from the baseline."""
    found = {}
    for distribution, part in cells.groupby("distribution", sort=True):
        part = part[(part["outcome"] == "ok") & (part["n"] == part["n"].max()) & np.isfinite(metrics.column(part, TIME))]
        first = noise.leaders(part, TIME, least)
        names, slow = [row["method"] for row in first], [row for _, row in part.iterrows() if row["method"] == base]
        if slow and base not in names:
            found[distribution] = float(slow[0]["n"]), names, [noise.ratio(row, slow[0], TIME) for row in first]
    return found


def speeds(ratios):
    return times(ratios[0]) if len(ratios) == 1 else f"{times(min(ratios))} to {times(max(ratios))}"


def crossing_methods(cross):
    """Per distribution the one that the chart marks: of those that cross the baseline, the fastest at the largest size."""
    rows = cross[cross["kind"] == "crosses"].dropna(subset=["ratio"])
    return rows.loc[rows.groupby("distribution")["ratio"].idxmax()] if len(rows) else rows


def hindmost(cross, first):
    """The two that gain least, of four and more: whom these boxes were made against is among them."""
    part = cross[cross["distribution"] == first.distribution].dropna(subset=["ratio"]).nsmallest(2, "ratio")
    if (cross["distribution"] == first.distribution).sum() < 4:
        return ""
    return ", the least have " + listing(f"{row['method']} ({times(row['ratio'])} times)" for _, row in part.iterrows())


def of_report(cross, base, asked):
    """Where the method of a report's own figure overtakes the baseline, on boxes where another one has been named."""
    rows = cross[(cross["method"] == asked) & ~cross.index.isin(crossing_methods(cross).index)]
    return [f"on {row.distribution} boxes {asked} {overtakes(row, base)}" if row.kind == "crosses" else
            f"on {row.distribution} boxes {asked} is {row.kind.replace('faster', f'faster than {base}')}" for row in
            rows.itertuples() if row.kind not in ("unknown", UNTIMED) and
            row.distribution in set(crossing_methods(cross)["distribution"])]


def finding(cross, base, dimension, ahead, least, asked=""):
    if not len(cross):
        return f"In {dimension}D {base} was not measured beside another method, so no crossing can be told."
    said = [f"on {row.distribution} boxes {row.method} {overtakes(row, base)} and has {times(row.ratio)} times its speed at "
            f"{row.largest:,.0f}{hindmost(cross, row)}" for row in crossing_methods(cross).itertuples()]
    said += of_report(cross, base, asked)
    crossed = set(crossing_methods(cross)["distribution"])
    for distribution, part in cross.groupby("distribution", sort=True):
        if distribution in crossed:
            continue
        if (part["kind"] == UNTIMED).all():
            said.append(f"on {distribution} boxes no time was taken ({WHY_UNTIMED})")
            continue
        kinds = [f"{does(rows['method'], 'are')} {kind}" if kind != "unknown" else
                 f"{listing(rows['method'])} and {base} have no size in common that both finished"
                 for kind, rows in part.groupby("kind", sort=True)]
        said.append(f"on {distribution} boxes nothing crosses {base}: {listing(kinds)}")
    alike = f", alike {noise.IN_WORDS[noise.silence(least)]},"
    fastest = [f"{listing(names)}{alike if len(names) > 1 else ''} on {distribution} ({speeds(ratios)} times the "
               f"speed of {base} at {n:,.0f})" for distribution, (n, names, ratios) in ahead.items()]
    return f"In {dimension}D " + "; ".join(said) + (f"; fastest at the largest size: {listing(fastest)}." if fastest else ".")


def headline(cells, cross, base, dimension, ahead, least):
    """Where the fastest leaves the baseline farthest behind, at the largest size."""
    if not ahead:
        return None
    distribution, (n, names, ratios) = max(ahead.items(), key=lambda item: item[1][2][0])
    part = cells[(cells["distribution"] == distribution) & (cells["n"] == n) & (cells["outcome"] == "ok")]
    crossed = cross[(cross["distribution"] == distribution) & (cross["method"] == names[0]) & (cross["kind"] == "crosses")]
    since = "".join(f"; {names[0]} {overtakes(row, base)}" for row in crossed.itertuples())
    find = "finds the pairs" if len(names) == 1 else f"alike {noise.IN_WORDS[noise.silence(least)]}, find the pairs"
    return Headline(f"Among {n:,.0f} {distribution} boxes in {dimension}D {listing(names)}{',' if len(names) > 1 else ''} {find} "
                    f"{speeds(ratios)} times as fast as {base}{since}.",
                    dict(zip(part["method"], metrics.column(part, TIME))), "ns", "time per frame")


def untimed(cells):
    """A sentence where runs finished without a time."""
    none = sorted(cells[(cells["outcome"] == "ok").to_numpy() & ~np.isfinite(metrics.column(cells, TIME))]["method"].unique())
    return [f"no time of {listing(none)}: {WHY_UNTIMED}"] if none else []


def n_share(cells, n):
    low, high = math.log(cells["n"].min()), math.log(cells["n"].max())
    return 0.0 if high == low else (math.log(n) - low) / (high - low)


def _broadphase_chart(context, cells, dimension, where, refused):
    distributions = sorted(cells["distribution"].unique())
    methods, lines = sorted(cells["method"].unique()), []
    base, looks = baseline_of(context, cells), context.looks(cells)
    least = noise.floor_of(context, cells["sweep"].iloc[0], TIME)
    cross = crossings(cells, base, least)
    marked, ahead = crossing_methods(cross), leaders(cells, base, least)
    legend_width = legend_room(map(context.name, methods), 1.75)
    figure, axes = grid_of_axes(2, len(distributions), 2.55, legend_width, left=0.9, gap_x=0.3, bottom=0.55, gap_y=0.5)
    for row, metric in enumerate((TIME, TESTS)):
        finished = cells["outcome"].to_numpy() == "ok"
        unit = context.unit(metric)
        values = metrics.column(cells, metric)[finished]
        values = values[np.isfinite(values)]
        for column, distribution in enumerate(distributions):
            ax, part = axes[row][column], cells[cells["distribution"] == distribution]
            plain_log(ax, "x", part["n"].astype(float))
            scale = ZeroLog(ax, "y", values, unit, failures=not finished.all())
            spots = []
            for method in methods:
                n, value = curve(part, method, metric)
                look = looks(method)
                good = np.isfinite(value)
                ax.plot(n[good], [scale.place(v) for v in value[good]], **look)
                mine = part[part["method"] == method].sort_values("n")
                for at, outcome in zip(n, mine["outcome"]):
                    if outcome != "ok":
                        spots.append((at, scale.failed, outcome, look["color"]))
                if metric == TIME:
                    ax.fill_between(n[good], mine["ns_per_frame_p25"].astype(float).to_numpy()[good],
                                    mine["ns_per_frame_p75"].astype(float).to_numpy()[good], color=look["color"],
                                    alpha=0.15, lw=0)
                    for at, (_, cell) in zip(n[good], mine[good].iterrows()):
                        low, high = noise.interval(measured.runs(cell, TIME))
                        if high > low:
                            ax.plot([at, at], [scale.place(low), scale.place(high)], color=look["color"], lw=1.2)
            fallen(ax, spots)
            hit = marked[marked["distribution"] == distribution]
            if metric == TIME and len(hit):
                at, winner = hit["n"].iloc[0], hit["method"].iloc[0]
                ax.axvline(at, color="#444444", lw=1, ls=":")
                right = n_share(part, at) > 0.6
                ax.annotate(f"{winner}\novertakes {base}\nat about {at:,.0f}\n({hit['below'].iloc[0]:,.0f} to "
                            f"{hit['above'].iloc[0]:,.0f})", (at, 0 if right else 1), xycoords=("data", "axes fraction"),
                            xytext=(-5, 5) if right else (5, -5), textcoords="offset points",  # curves rise to the right
                            ha="right" if right else "left", va="bottom" if right else "top", size=8.5)
            if row == 0:
                ax.set_title(f"{distribution} boxes, {dimension}D")
            else:
                ax.set_xlabel("bodies n")
            lines.append((f"On {distribution} boxes, {context.title(metric)}",
                          one_line(ax, same({m: curve(part, m, metric) for m in methods}), listing)))
            if column == 0:
                ax.set_ylabel(context.title(metric))
            else:
                ax.tick_params(labelleft=False)
    handles = [Line2D([], [], label=context.name(m), **looks(m)) for m in methods]
    handles += [Line2D([], [], ls="none", marker=letter(o), color="#555555", ms=7, label=o)
                for o in sorted({o for o in cells["outcome"] if o != "ok"})]
    legend_right(figure, handles, legend_width)
    table = cells.sort_values(["distribution", "method", "n"])
    numbers = {}
    for name in context.metrics("boxes", "cost", "error", "detail"):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    table = table[["distribution", "method", "n", "outcome"]].assign(**numbers)
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {dimension}d {where}"), SECTION, f"Time and box tests over body count, "
                 f"{dimension}D" + (f", {where}" if where else ""),
                 finding(cross, base, dimension, ahead, least, ASKED.get(cells["sweep"].iloc[0], "")),
                 cells["sweep"].iloc[0], figure, table,
                 refused + untimed(cells) + holes(cells, ["distribution", "method", "n"]),
                 "Both axes are logarithmic; a line of slope 2 is n². Bands are quartiles over "
                 f"frames. The dotted line is where the named method overtakes {base} for good, interpolated between the two "
                 f"sizes measured; others may be faster there. Whiskers hold the median of the repeats. {noise.rule(least)}"
                 + caption_of_lines(lines),
                 headline=headline(cells, cross, base, dimension, ahead, least))


@of_sweeps("parameters", 11, SECTION,
           Needs("boxes", methods=(2, math.inf), metrics=(TIME,), also="`report` that names it, and methods with their defaults"),
           "What hangs on parameters",
           "No timed sweep that asks for this chart is in this store; experiments/run heritage makes one.",
           "broadphase_parameters")
def parameters(context, cells):
    if "parameters" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    cells, refused = one_machine(context.store, cells)
    cells = cells.assign(family=[family(m) for m in cells["method"]], panel=[
        f"{distribution} boxes, {dimension}D" for distribution, dimension in zip(cells["distribution"], dimension_of(cells))])
    return [_parameters_chart(context, cells, refused)] if (cells["method"] == cells["family"]).any() else []


def against_default(cells, least):
    """One row per panel and method that is not plain: its time over that with the defaults, and whether that is told."""
    rows = []
    for panel, part in cells.groupby("panel", sort=False):
        plain = {cell["method"]: cell for _, cell in part.iterrows()
                 if cell["method"] == cell["family"] and cell["outcome"] == "ok"}
        for _, cell in part.iterrows():
            base = plain.get(cell["family"])
            if base is None or cell["method"] == cell["family"] or cell["outcome"] != "ok":
                continue
            ratio = noise.ratio(base, cell, TIME)
            rows.append({"panel": panel, "family": cell["family"], "method": cell["method"], "ratio": ratio,
                         "told": noise.tells(base, cell, TIME, least)})
    return rows


def finding_of_parameters(rows, panels):
    said = []
    for name in sorted({row["family"] for row in rows}):
        told = sorted((row for row in rows if row["family"] == name and row["told"]), key=lambda row: row["ratio"])
        if not told:
            said.append(f"no parameter of {name} changes its time beyond the noise")
            continue
        (least, *_), most = told, max(told, key=lambda row: row["ratio"])
        ways = clauses(
            least["ratio"] < 1 and f"gains most by {least['method']} ({times(least['ratio'])} times the time of its defaults on "
                                   f"{least['panel']}{_not_told(rows, least, -1)})",
            most["ratio"] > 1 and f"loses most by {most['method']} ({times(most['ratio'])} times on {most['panel']}"
                                  f"{_not_told(rows, most, 1)})", between=" and ")
        gains = [row["method"] for row in rows if row["family"] == name and row["told"] and row["ratio"] < 1]
        both = [m for m in dict.fromkeys(row["method"] for row in rows) if gains.count(m) == panels]
        said.append(clauses(f"{name} {ways}", both and f"{does(both, 'gain')} everywhere"))
    return "; ".join(said) + "."


def _not_told(rows, named, sign):
    """Who goes farther in the same panel by the medians alone, which a reader of the picture sees."""
    farther = [row["method"] for row in rows if row["family"] == named["family"] and row["panel"] == named["panel"] and
               not row["told"] and sign * row["ratio"] > sign * named["ratio"]]
    return f"; the median of {listing(farther)} is farther off, but within the noise" if farther else ""


def _parameters_chart(context, cells, refused):
    sweep = cells["sweep"].iloc[0]
    looks, methods = context.looks(cells), list(dict.fromkeys(cells.sort_values("family", kind="stable")["method"]))
    panels, least = list(dict.fromkeys(cells["panel"])), noise.floor_of(context, sweep, TIME)
    left = 0.3 + 0.075 * max(map(len, methods))
    figure, axes = grid_of_axes(1, len(panels), 0.24 * len(methods) + 0.1, left=left, gap_x=0.3, bottom=0.55)
    for ax, panel in zip(axes[0], panels):
        part = cells[cells["panel"] == panel].set_index("method", drop=False)
        scale = ZeroLog(ax, "x", metrics.column(part, TIME), "ns", failures=(part["outcome"] != "ok").any())
        spots = []
        for y, method in enumerate(methods):
            if method not in part.index:
                continue
            cell, colour = part.loc[method], looks(family(method))["color"]
            if cell["outcome"] != "ok" or not math.isfinite(cell[TIME]):
                spots.append((scale.failed, y, cell["outcome"], colour))
                continue
            plain = method == family(method)
            low, high = noise.interval(measured.runs(cell, TIME))
            ax.plot([low, high], [y, y], color=colour, lw=1.2)
            ax.plot([cell[TIME]], [y], ls="none", marker="o", ms=6, color=colour, mfc=colour if plain else "white")
            if plain:
                ax.axvline(cell[TIME], color=colour, lw=0.8, ls=":")
        fallen(ax, spots)
        ax.set_ylim(len(methods) - 0.4, -0.6)
        ax.set_yticks(range(len(methods)), methods if ax is axes[0][0] else [])
        ax.tick_params(axis="y", length=0)
        ax.set_title(panel)
        ax.set_xlabel(context.title(TIME))
    rows = against_default(cells, least)
    told = [row for row in rows if row["told"]]
    worst = max(told, key=lambda row: abs(math.log(row["ratio"])), default=None)
    head = None
    if worst:
        pair = cells[(cells["panel"] == worst["panel"]) & cells["method"].isin([worst["method"], worst["family"]])]
        head = Headline(f"On {worst['panel']} {worst['method']} takes {times(worst['ratio'])} times the time of "
                        f"{worst['family']} with its defaults.", dict(zip(pair["method"], metrics.column(pair, TIME))), "ns",
                        "time per frame")
    ratios = {(row["panel"], row["method"]): row["ratio"] for row in rows}
    table = {"boxes": cells["panel"], "method": cells["method"], "outcome": cells["outcome"],
             **quantity(context.title(TIME), context.unit(TIME), metrics.column(cells, TIME)),
             "over its defaults [1]": [ratios.get(key, math.nan) for key in zip(cells["panel"], cells["method"])]}
    n = f"{cells['n'].iloc[0]:,.0f} boxes" if "n" in cells and cells["n"].nunique() == 1 else "boxes"
    return Chart(f"{sweep}_parameters", SECTION, f"What hangs on parameters: {n}",
                 f"Of {n}, {finding_of_parameters(rows, len(panels))}", sweep, figure, pd.DataFrame(table),
                 refused + holes(cells, ["panel", "method"]),
                 "Filled marks and dotted lines are the defaults, hollow marks have one parameter changed; whiskers hold the "
                 f"median of the repeats. {noise.rule(least)}", headline=head)
