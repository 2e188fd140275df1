# SPDX-License-Identifier: Zlib
"""Boxes: time of broadphases over the number of bodies, and the effect of their parameters on it."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, holes, identifier, of_sweeps
from finding import TIE, Finding, cut, fits
from load import family, one_machine, split, varying
from sentences import listing, plural, some, verb
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, plain_log, same,
                   times)
from table import quantity

SECTION = "Which broadphase is fastest, and from how many bodies on?"
TIME, TESTS = "ns_per_frame_median", "box_tests_mean"
ASKED = {"heritage_broadphase": "region_tree"}  # by sweep, a method with a row of its own: the tree of figure 7.3 of 2009
UNTIMED = "not timed beside it"
WHY_UNTIMED = "the sweep has only the ten frames of warm-up, or is not timed"


@of_sweeps("broadphase", 10, SECTION,
           Needs("boxes", varies=("n",), metrics=(TIME, TESTS)),
           "Time over body count", "No timed sweep of boxes over their number is in this store.", "broadphase_crossover")
def broadphase(context, cells):
    cells, refused = one_machine(context.store, cells)
    if "distribution" not in cells:
        cells["distribution"] = "boxes"
    others = varying(context.store, cells, ("dimension", "distribution", "n"))  # unequal cells are never in one chart
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
    """The sweep's baseline; else the slowest method at the largest size."""
    named = context.baseline(cells)
    if named in set(cells["method"]):
        return named
    largest = cells[cells["n"] == cells["n"].max()]
    values = metrics.column(largest, TIME)
    return largest["method"].iloc[int(np.nanargmax(values))] if np.isfinite(values).any() else cells["method"].iloc[0]


def crossings(cells, base, least=1.0):
    """Per distribution and method: the size from which it is faster than the baseline. There is no crossing where the two times
    at the largest size differ by no more than noise (noise.tells, with the floor `least`)."""
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
                kind, cross = f"{TIE} at the largest size, {noise.IN_WORDS[word]}", None
            sizes = shared[both]
            between = _bracket(part, base, method, sizes, cross, least) if cross else (math.nan, math.nan)
            rows.append((distribution, method, kind, cross or math.nan, *between, shared[last], a[last] / b[last]))
    return pd.DataFrame(rows, columns=["distribution", "method", "kind", "n", "below", "above", "largest", "ratio"])


def _bracket(part, base, method, sizes, cross, least):
    """The nearest sizes on both sides of a crossing at which the two differ beyond noise; else the first or last size."""
    at = {n: [part[(part["method"] == name) & (part["n"] == n)].iloc[0] for name in (base, method)] for n in sizes}
    apart = [n for n in sizes if noise.tells(*at[n], TIME, least)]
    return (max([n for n in apart if n <= cross], default=sizes.min()),
            min([n for n in apart if n > cross], default=sizes.max()))


def leaders(cells, base, least):
    """{distribution: (size, methods, ratios of the baseline's time to theirs)} at the largest size: the fastest and all methods
    within the noise of it, the fastest first. Without the distributions in which the baseline is among them."""
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
    """Per distribution the method that the chart marks: the fastest at the largest size of those that cross the baseline."""
    rows = cross[cross["kind"] == "crosses"].dropna(subset=["ratio"])
    return rows.loc[rows.groupby("distribution")["ratio"].idxmax()] if len(rows) else rows


def found(cells, cross, base, dimension, ahead, least, asked=""):
    """(finding, entry of the first screen or None): a row per distribution, and one for the method `asked`."""
    rows, marked, alike = [], crossing_methods(cross), f" ({noise.IN_WORDS[noise.silence(least)]})"
    for distribution, part in cross.groupby("distribution", sort=True):
        hit = marked[marked["distribution"] == distribution]
        shown = [*hit.itertuples(), *(row for row in part[part["method"] == asked].itertuples()
                                      if row.Index not in hit.index and row.kind not in ("unknown", UNTIMED))]
        rows += [_row(row, base) for row in shown] or [_without(distribution, part, base)]
        n, names, ratios = ahead.get(distribution, (part["largest"].max(), [], []))
        known = part.dropna(subset=["ratio"])
        last = known.nsmallest(2, "ratio") if len(part) >= 4 else known[:0]
        rows[-max(1, len(shown))] |= {
            "bodies [1]": n, "fastest there": listing(names) + alike * (len(names) > 1) if names else "",
            f"speed, over {base}": speeds(ratios) + " times" if names else f"{TIE} with {base}, or slower" if len(known) else "",
            "slowest there": listing(f"{row['method']} ({times(row['ratio'])} times)" for _, row in last.iterrows())
            if len(last) else ""}
    table = cut(pd.DataFrame(rows))
    head = f"In {dimension}D"
    if not len(cross):
        return Finding(f"{head} {base} was not measured beside another method, so no crossing is known."), None
    if (cross["kind"] == UNTIMED).all():
        return Finding(f"{head} no time was taken: {WHY_UNTIMED}.", table), None
    if not ahead:
        return Finding(f"{head} no broadphase is faster than {base} beyond the noise at the largest size.", table), None
    distribution, (n, names, ratios) = max(ahead.items(), key=lambda item: item[1][2][0])
    part = cells[(cells["distribution"] == distribution) & (cells["n"] == n) & (cells["outcome"] == "ok")]
    crossed = cross[(cross["distribution"] == distribution) & (cross["method"] == names[0]) & (cross["kind"] == "crosses")]
    alike *= len(names) > 1
    text = (f"Among {n:,.0f} {distribution} boxes in {dimension}D {some(names)}{alike} {verb(len(names), 'are')} "
            f"{speeds(ratios)} "
            f"times as fast as {base}")
    since = "".join(f"; {row.method} is faster from about {row.n:,.0f} bodies on" for row in crossed.itertuples())
    text = fits(f"{text}{since}.", f"{text}.")
    return Finding(text, table), Headline("", dict(zip(part["method"], metrics.column(part, TIME))), "ns", "time per frame")


def _row(row, base):
    """The table's row of a method on one distribution."""
    made = {"boxes": row.distribution, f"method against {base}": row.method, "result": row.kind}
    if row.kind == "crosses":
        made |= {"result": "faster from", "about [1]": row.n, "between": f"{row.below:,.0f} and {row.above:,.0f} bodies"}
    return made


def _without(distribution, part, base):
    """The table's row of a distribution on which no method crosses the baseline."""
    kinds = {kind: listing(rows["method"]) for kind, rows in part.groupby("kind", sort=True)}
    if list(kinds) == [UNTIMED]:
        return {"boxes": distribution, f"method against {base}": "all", "result": "no time was taken"}
    words = {"unknown": f"no size that {base} also finished"}
    return {"boxes": distribution, f"method against {base}": "; ".join(f"{names}: {words.get(kind, kind)}"
                                                                      for kind, names in kinds.items()), "result": "no crossing"}


def untimed(cells):
    """A sentence about finished runs without a time."""
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
                ax.annotate(f"{winner}\nfaster than {base}\nfrom about {at:,.0f}\n({hit['below'].iloc[0]:,.0f} to "
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
    about, entry = found(cells, cross, base, dimension, ahead, least, ASKED.get(cells["sweep"].iloc[0], ""))
    table = cells.sort_values(["distribution", "method", "n"])
    numbers = {}
    for name in context.metrics("boxes", "cost", "error", "detail"):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    table = table[["distribution", "method", "n", "outcome"]].assign(**numbers)
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {dimension}d {where}"), SECTION, f"Time and box tests over body count, "
                 f"{dimension}D" + (f", {where}" if where else ""),
                 about, cells["sweep"].iloc[0], figure, table,
                 refused + untimed(cells) + holes(cells, ["distribution", "method", "n"]),
                 "Both axes are logarithmic; a line of slope 2 is n². Bands are quartiles over frames. The dotted line is where "
                 "the "
                 f"named method becomes faster than {base}, interpolated between two measured sizes; other methods may be faster "
                 f"there. Whiskers hold the median of the repeats. {noise.rule(least)}" + caption_of_lines(lines),
                 headline=entry)


@of_sweeps("parameters", 11, SECTION,
           Needs("boxes", methods=(2, math.inf), metrics=(TIME,), also="`report` that lists it, and methods with their defaults"),
           "Effect of parameters",
           "No timed sweep that lists this chart is in this store; experiments/run heritage makes one.",
           "broadphase_parameters")
def parameters(context, cells):
    if "parameters" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    cells, refused = one_machine(context.store, cells)
    cells = cells.assign(family=[family(m) for m in cells["method"]], panel=[
        f"{distribution} boxes, {dimension}D" for distribution, dimension in zip(cells["distribution"], dimension_of(cells))])
    return [_parameters_chart(context, cells, refused)] if (cells["method"] == cells["family"]).any() else []


def against_default(cells, least):
    """One row per panel and method with a changed parameter: its time over that with the defaults, and whether the ratio is
    beyond noise (`told`)."""
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


def found_parameters(rows, panels, n, least):
    """The finding: per family the parameter that gains most and the one that loses most."""
    lines = []
    for name in sorted({row["family"] for row in rows}):
        told = sorted((row for row in rows if row["family"] == name and row["told"]), key=lambda row: row["ratio"])
        line = {"family": name}
        if not told:
            lines.append(line | {"fastest": f"all {noise.IN_WORDS[noise.silence(least)]}"})
            continue
        first, last = told[0], told[-1]
        gains = [row["method"] for row in told if row["ratio"] < 1]
        both = [m for m in dict.fromkeys(gains) if gains.count(m) == panels]
        if first["ratio"] < 1:
            line |= {"fastest": first["method"], "times the defaults [1]": first["ratio"], "on": first["panel"]}
        if last["ratio"] > 1:
            line |= {"slowest": last["method"], "times the defaults, slowest [1]": last["ratio"], "slowest on": last["panel"]}
        line |= {"faster on all boxes": listing(both) if both else "",
                 "farther off, but noise": listing(sorted(set(_noise(rows, first, -1) + _noise(rows, last, 1)))) if
                 _noise(rows, first, -1) + _noise(rows, last, 1) else ""}
        lines.append(line)
    table = pd.DataFrame(lines)
    table = cut(table.drop(columns=[c for c in table if table[c].isin(["", None]).all()]))
    told = [row for row in rows if row["told"]]
    if not told:
        why = noise.silence(least)
        return Finding(f"Of {n} no parameter changes the time of {plural(len(lines), 'broadphase')} beyond the noise." if
                       why == noise.NOISE else f"Of {n} there are too few repeats to measure the effect of a parameter.", table)
    worst = max(told, key=lambda row: abs(math.log(row["ratio"])))
    return Finding(f"On {worst['panel']} {worst['method']} takes {times(worst['ratio'])} times the time of {worst['family']} "
                   f"with its "
                   "defaults, the largest effect of a parameter.", table)


def _noise(rows, named, sign):
    """Methods with a median farther off in the same panel, by no more than noise: a reader sees them in the picture."""
    return [row["method"] for row in rows if row["family"] == named["family"] and row["panel"] == named["panel"] and
            not row["told"] and sign * row["ratio"] > sign * named["ratio"] and sign * (named["ratio"] - 1) > 0]


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
        head = Headline("", dict(zip(pair["method"], metrics.column(pair, TIME))), "ns", "time per frame")
    ratios = {(row["panel"], row["method"]): row["ratio"] for row in rows}
    table = {"boxes": cells["panel"], "method": cells["method"], "outcome": cells["outcome"],
             **quantity(context.title(TIME), context.unit(TIME), metrics.column(cells, TIME)),
             "over its defaults [1]": [ratios.get(key, math.nan) for key in zip(cells["panel"], cells["method"])]}
    n = f"{cells['n'].iloc[0]:,.0f} boxes" if "n" in cells and cells["n"].nunique() == 1 else "boxes"
    return Chart(f"{sweep}_parameters", SECTION, f"Effect of parameters: {n}",
                 found_parameters(rows, len(panels), n, least), sweep, figure, pd.DataFrame(table),
                 refused + holes(cells, ["panel", "method"]),
                 "Filled marks and dotted lines are the defaults. Hollow marks have one changed parameter. Whiskers hold the "
                 f"median of the repeats. {noise.rule(least)}", headline=head)
