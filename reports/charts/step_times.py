# SPDX-License-Identifier: Zlib
"""Times of whole steps: median, 99th percentile and slowest, of methods and of whole engines."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import measured
import metrics
import noise
import over_steps
import ranking
from chart import Chart, Headline, Needs, dimension_of, holes, of_sweeps
from finding import NOISE, Finding, Line, cut
from load import one_machine, split
from style import ZeroLog, figures, grid_of_axes, legend_right, letter, si, times
from table import quantity

SLOWEST = "How long does the slowest step take?"
MEDIAN, SLOW, WORST = "ms_per_step_median", "ms_per_step_p99", "ms_per_step_worst"
MARKS = ((MEDIAN, "o", 5), (SLOW, "|", 9), (WORST, "x", 5))


@of_sweeps("step_times", 38, SLOWEST,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=(MEDIAN,)),
           "Times of whole steps", "This store has no timed sweep of several methods.", "resolvers")
def step_times(context, cells):
    if not {SLOW, WORST} <= set(context.store.metrics):  # an old store
        return []
    cells, refused = one_machine(context.store, cells)
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        shown = [(where, over_steps.at_middle(mine, setting)) for where, mine in shown]
        every = pd.concat([mine for _, mine in shown])
        at, without = over_steps.setting_of(every, setting), over_steps.without_setting(every, setting)
        shown = [(where, mine.drop_duplicates("method")) for where, mine in shown]
        made.append(_step_times_chart(context, part, shown, left_out + refused, at, without))
    return made


def timed(cells):
    return cells[(cells["outcome"] == "ok") & cells[MEDIAN].notna() & cells[WORST].notna()]


RATIO = "slowest step over the median"


def lines_of(context, cells):
    """(lines of the finding's table, names that tie with the smallest ratio of the slowest step to the median). Engines, and
    methods without a rank or time, stand last."""
    good = timed(cells)
    engines = good[good["method"].map(context.store.role) == "engine"]
    good = ranking.eligible(context, good).drop(index=engines.index, errors="ignore")
    order = good.assign(ratio=good[WORST] / good[MEDIAN]).sort_values(["ratio", "method"])
    ties = [cell["method"] for _, cell in order.iloc[1:].iterrows() if _spread(cell)[0] <= _spread(order.iloc[0])[1]]
    floor, first = noise.floor_of(context, cells["sweep"].iloc[0], MEDIAN), good.loc[good[MEDIAN].idxmin()] if len(good) else None
    lines = [Line(cell["method"], cell[WORST] / cell[MEDIAN], *_spread(cell), outcome,
                  over_steps.one("slowest step", "ms", cell[WORST]))
             for part, of in ((order, lambda _: ""), (engines, lambda engine: _beside(first, engine, floor)))
             for _, cell in part.iterrows() for outcome in [of(cell)]]
    excused = ranking.excused(context, cells)
    why = {cell["method"]: f"failed: {cell['outcome']}" if cell["outcome"] != "ok" else
           f"not ranked: {excused[i]}" if i in excused else "no time"
           for i, cell in cells.iterrows() if i not in good.index and i not in engines.index}
    return lines + ranking.lines(why), ties


def words(context, where, at, cells):
    """One scene in one sentence: the largest and the smallest ratio of the slowest step to the median."""
    good = timed(cells)
    good = ranking.eligible(context, good[good["method"].map(context.store.role) != "engine"])
    if not len(good):
        return f"On {where}{at} no timed run finished."
    ratios = good[WORST] / good[MEDIAN]
    most, least = good.loc[ratios.idxmax()], good.loc[ratios.idxmin()]
    if len(good) == 1 or _spread(most)[0] <= _spread(least)[1]:  # the order of slowest steps is noise
        ends = " to ".join(dict.fromkeys((times(ratios.min()), times(ratios.max()))))
        return (f"On {where}{at} the slowest step takes {ends} times the median; "
                f"{'all methods tie' if len(good) > 1 else 'only ' + most['method'] + ' finished'}.")
    return (f"On {where}{at} the slowest step takes {times(ratios.max())} times the median with {most['method']} "
            f"({si(most[WORST], 'ms')}), {times(ratios.min())} times with {least['method']} ({si(least[WORST], 'ms')}).")


def _beside(first, engine, floor):
    """The median of an engine over that of the fastest method; no ratio between precisions."""
    if first is None:
        return "engine"
    mine, ratio = ranking.precision(engine), noise.said(first, engine, MEDIAN, floor)
    if mine != ranking.precision(first):
        return f"engine in {mine}: median {si(engine[MEDIAN], 'ms')}"
    if ratio[:1].isdigit():
        return f"engine: {ratio} times the median of {first['method']}"
    if ratio == noise.FEW:
        return f"engine: {ratio} to tell its median from that of {first['method']}"
    return f"engine: median as {first['method']}, {NOISE if ratio == noise.NOISE else ratio}"


def _largest_ratio(context, cells):
    """For the scene of the headline: the one with the largest ratio of the slowest step to the median."""
    good = ranking.eligible(context, timed(cells))
    return float((good[WORST] / good[MEDIAN]).max()) if len(good) else 0.0


def _spread(cell):
    """The interval of the slowest step over the repeats, in multiples of the median."""
    low, high = noise.interval(measured.runs(cell, WORST) or [cell[WORST]])
    return low / cell[MEDIAN], high / cell[MEDIAN]


def _step_times_chart(context, cells, shown, gaps, at, without):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    looks, labels, called = context.looks(cells), sorted(cells["method"].unique()), ranking.names(context, cells)
    left = 0.3 + 0.078 * max(map(len, called.values()))
    figure, axes = grid_of_axes(1, len(shown), 0.24 * len(labels) + 0.1, 1.3, left=left, gap_x=0.35, bottom=0.55)
    for column, (where, part) in enumerate(shown):
        ax, by = axes[0][column], part.set_index("method")
        failed = (part["outcome"] != "ok").any()
        scale = ZeroLog(ax, "x", [v for name, _, _ in MARKS for v in metrics.column(part, name)], "ms", failed_name="failed",
                        failures=failed)
        if not failed and not np.isfinite([v for name, _, _ in MARKS for v in metrics.column(part, name)]).any():
            ax.text(0.5, 0.5, "no timed run finished", ha="center", va="center", transform=ax.transAxes)
        for y, method in enumerate(labels):
            if method not in by.index:
                continue
            cell, look = by.loc[method], looks(method)
            if cell["outcome"] != "ok":
                ax.plot([scale.failed], [y], ls="none", marker=letter(cell["outcome"]), color=look["color"], ms=7, mew=0.3)
                continue
            known = [cell[name] for name, _, _ in MARKS if math.isfinite(cell[name])]
            ax.plot([scale.place(min(known)), scale.place(max(known))] if known else [], [y] * min(2, 2 * len(known)),
                    color=look["color"], lw=0.8, alpha=0.6)
            for name, marker, size in MARKS:
                if math.isfinite(cell[name]):
                    ax.plot([scale.place(cell[name])], [y], ls="none", marker=marker, ms=size, color=look["color"],
                            mfc=look.get("markerfacecolor", look["color"]), zorder=3)
        ax.set_ylim(len(labels) - 0.4, -0.6)
        ax.set_yticks(range(len(labels)))
        ax.set_yticklabels([called[m] for m in labels] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
        ax.set_title(f"{where}, {dimension}D")
        ax.set_xlabel("time of a step")
    legend_right(figure, [Line2D([], [], ls="none", marker=marker, ms=size, color="#555555", label=label)
                          for (_, marker, size), label in zip(MARKS, ("median", "99th percentile", "slowest"))], 1.3)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    columns = {"scene": drawn["where"], "method": drawn["method"], "outcome": drawn["outcome"]}
    for name, _, _ in MARKS:
        columns |= quantity(context.title(name), context.unit(name), metrics.column(drawn, name))
    told = [(_largest_ratio(context, part), words(context, f"{where} in {dimension}D", at, part)) for where, part in shown]
    return Chart(f"{cells['sweep'].iloc[0]}_step_times_{dimension}d", SLOWEST, f"Times of whole steps, {dimension}D",
                 Finding(max(told, key=lambda pair: pair[0])[1], over_steps.by_scene(
                     [(where, *lines_of(context, part)) for where, part in shown], RATIO, "1")),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(columns), gaps + holes(drawn, ["scene", "method"]),
                 "Processor time of a step, from broadphase to integration; medians over repeats, without the first ten steps of "
                 "a run." + without + " " + noise.rule(noise.floor_of(context, cells["sweep"].iloc[0], MEDIAN)))


SIXTY = "How many bodies keep sixty steps a second?"
LIMIT = 1000 / 60  # ms
WITHIN, TOP, BELOW, UNKNOWN = "within the sizes run", "at least the largest size", "below the smallest size", "unknown"


@of_sweeps("bodies_at_rate", 39, SIXTY,
           Needs("world", methods=(1, math.inf), metrics=(MEDIAN,), also="a `report` that lists it"),
           "Bodies at sixty steps a second",
           "This store has no timed sweep whose `report` lists this chart; experiments/run heritage makes one.",
           "heritage_bodies")
def bodies_at_rate(context, cells):
    if "bodies_at_rate" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    cells, refused = one_machine(context.store, cells)
    return [_rate_chart(context, cells.assign(dimension=dimension_of(cells)), refused)]


def largest(rungs, limit=LIMIT):
    """(number of bodies, how it is known) from the sizes that were run [(bodies, ms or NaN)]: interpolated on log-log axes
    between the last size within the limit and the first size beyond it. A size without a time is beyond it: then the number is
    that of the size before."""
    rungs = sorted(rungs)
    if not any(math.isfinite(ms) for _, ms in rungs):
        return math.nan, UNKNOWN
    before = None
    for bodies, ms in rungs:
        if not math.isfinite(ms):
            return (math.nan, UNKNOWN) if before is None else (before[0], TOP)
        if ms > limit:
            if before is None:
                return bodies, BELOW
            share = math.log(limit / before[1]) / math.log(ms / before[1])
            return math.exp(math.log(before[0]) + share * math.log(bodies / before[0])), WITHIN
        before = (bodies, ms)
    return before[0], TOP


def rows_of(cells):
    found = []
    for (scene, dimension), part in cells.groupby(["scene", "dimension"], sort=True):
        for method in dict.fromkeys(cells["method"]):
            mine = part[part["method"] == method]
            if not len(mine) or (mine["outcome"] == "unsupported").all():
                continue
            bodies = [float(b) for b in mine["bodies"]]
            row = {"scene": scene, "dimension": dimension, "method": method, "rungs": len(mine)}
            for name, metric in (("slow", SLOW), ("median", MEDIAN)):
                good = (mine["outcome"] == "ok").to_numpy()
                times = [ms if fine else math.nan for ms, fine in zip(metrics.column(mine, metric), good)]
                # A failed run may have no number of bodies: it counts as larger than all that have.
                top = max([b for b in bodies if math.isfinite(b)], default=0) + 1
                row[name], row[name + " known"] = largest([(b if math.isfinite(b) else top, ms) for b, ms in zip(bodies, times)])
            found.append(row)
    return found


def words_of_rate(number, known):
    sign = {TOP: "≥ ", BELOW: "< "}.get(known, "")
    return "unknown" if known == UNKNOWN else f"{sign}{figures(float(f'{number:.1e}'))}"  # two digits: the sizes are far apart


def finding_of_rate(rows, why):
    """The number of bodies that each method keeps at sixty steps a second, by scene. `why`: {method: why it has no rank}."""
    found = []
    for row in sorted(rows, key=lambda row: (row["scene"], row["dimension"], -row["slow"])):
        found.append({"scene": f"{row['scene']}, {row['dimension']}D", "method": row["method"],
                      "bodies by the 99th percentile": words_of_rate(row["slow"], row["slow known"]),
                      "bodies by the median": words_of_rate(row["median"], row["median known"])})
    others = [{"method": line.name, "remark": line.outcome} for line in ranking.lines(ranking.not_ranked(why))]
    table = cut(pd.DataFrame(found + others), range(len(found), len(found) + len(others)))
    head = _headline(rows)
    if head:
        return Finding(head.text, table)
    known = [row for row in rows if row["slow known"] != UNKNOWN]
    if not known:
        return Finding("No size was run." if not rows else "No timed run finished.", table)
    best = max(known, key=lambda row: row["slow"])
    return Finding(f"On {best['scene']} in {best['dimension']}D {best['method']} keeps sixty steps a second with "
                   f"{words_of_rate(best['slow'], best['slow known'])} bodies.", table)


def _bar(ax, y, row, name, colour, height, alpha):
    number, known = row[name], row[name + " known"]
    if known in (WITHIN, TOP):
        ax.barh(y, number, height=height, color=colour, alpha=alpha, hatch="///" if known == TOP else None, edgecolor="white",
                lw=0)
    at = number if known in (WITHIN, TOP) else 0
    ax.annotate(words_of_rate(number, known), (at, y), xytext=(4, 0), textcoords="offset points", va="center", fontsize=8)
    return at


def _rate_chart(context, cells, refused):
    sweep, rows, looks = cells["sweep"].iloc[0], rows_of(cells), context.looks(cells)
    places = list(dict.fromkeys((row["scene"], row["dimension"]) for row in rows))
    methods = [m for m in dict.fromkeys(cells["method"]) if any(row["method"] == m for row in rows)]
    called, kept = ranking.names(context, cells), set(ranking.whole(context, cells)["method"])
    left, ranked = 0.3 + 0.078 * max(len(called[m]) for m in methods), [row for row in rows if row["method"] in kept]
    figure, axes = grid_of_axes(1, max(1, len(places)), 0.5 * len(methods) + 0.1, 1.9, left=left, gap_x=0.3, bottom=0.55)
    for ax, place in zip(axes[0], places):
        mine, most = [row for row in rows if (row["scene"], row["dimension"]) == place], 1.0
        for row in mine:
            y, colour = methods.index(row["method"]), looks(row["method"])["color"]
            most = max(most, _bar(ax, y - 0.2, row, "slow", colour, 0.36, 0.95),
                       _bar(ax, y + 0.2, row, "median", colour, 0.36, 0.45))
        ax.set_xlim(0, 1.42 * most)
        ax.set_ylim(len(methods) - 0.4, -0.6)
        ax.set_yticks(range(len(methods)), [called[m] for m in methods] if ax is axes[0][0] else [])
        ax.tick_params(axis="y", length=0)
        ax.locator_params(axis="x", nbins=3)
        ax.xaxis.set_major_formatter("{x:,.0f}")
        ax.set_title(f"{place[0]}, {place[1]}D")
        ax.set_xlabel("bodies")
    legend_right(figure, [Patch(color="#555555", alpha=0.95, label="99th percentile"), Patch(color="#555555", alpha=0.45,
                          label="median"), Patch(facecolor="#555555", hatch="///", edgecolor="white", label="largest size run"),
                          Line2D([], [], ls="none", label="<: the smallest\nsize is too slow")], 1.9)
    table = {**{name: [r[name] for r in rows] for name in ("scene", "dimension", "method")},
             **quantity("bodies by the 99th percentile", "1", [r["slow"] for r in rows]),
             "how known": [r["slow known"] for r in rows],
             **quantity("bodies by the median", "1", [r["median"] for r in rows]),
             "how known of the median": [r["median known"] for r in rows]}
    return Chart(f"{sweep}_bodies_at_rate", SIXTY, "Bodies at sixty steps a second",
                 finding_of_rate(ranked, ranking.unranked(context, cells)), sweep, figure, pd.DataFrame(table),
                 refused + holes(cells, ["scene", "dimension", "method", *_ladders(cells)]),
                 "The number of bodies, with the ground, at which a step takes 1/60 s of processor time; interpolated between "
                 "two sizes on logarithmic axes. Hatched bars, ≥: the largest size run, or the last before a failure, is still "
                 "faster.",
                 headline=_headline(ranked))


def _ladders(cells):
    return [name for name in ("n", "base") if name in cells]


def _headline(rows):
    """For the first screen: the scene with the largest ratio between methods with a known number of bodies."""
    best = None
    for place in dict.fromkeys((row["scene"], row["dimension"]) for row in rows):
        known = {row["method"]: row["slow"] for row in rows if (row["scene"], row["dimension"]) == place and
                 row["slow known"] == WITHIN}
        if len(known) > 1:
            most, least = max(known, key=known.get), min(known, key=known.get)
            told = Headline(f"On {place[0]} in {place[1]}D {most} keeps sixty steps a second with {figures(known[most])} bodies, "
                            f"{least} with {figures(known[least])}.", known, quantity="bodies", larger=True)
            best = told if best is None or told.effect > best.effect else best
    return best
