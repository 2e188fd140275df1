# SPDX-License-Identifier: Zlib
"""How many bodies keep sixty steps a second: on a ladder of sizes, where the time of a step passes a sixtieth of one."""

import math

import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import metrics
import ranking
from chart import Chart, Headline, Needs, dimension_of, holes, listing, of_sweeps
from load import one_machine
from style import figures, grid_of_axes, legend_right
from table import quantity

SECTION = "How many bodies keep sixty steps a second?"
SLOW, MEDIAN = "ms_per_step_p99", "ms_per_step_median"
LIMIT = 1000 / 60  # ms
WITHIN, TOP, BELOW, UNKNOWN = "within the ladder", "the ladder ended", "below the ladder", "unknown"


@of_sweeps("bodies_at_rate", 39, SECTION,
           Needs("world", methods=(1, math.inf), metrics=(MEDIAN,), also="`report` that names it"),
           "Bodies at sixty steps a second",
           "No timed sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_bodies")
def bodies_at_rate(context, cells):
    if "bodies_at_rate" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    cells, refused = one_machine(context.store, cells)
    return [_chart(context, cells.assign(dimension=dimension_of(cells)), refused)]


def largest(rungs, limit=LIMIT):
    """(number of bodies, how it is known) of a ladder [(bodies, ms or NaN)]: interpolated on log-log axes between the last rung
    that stays within the limit before the first that does not, and that one. A rung without a time is one that does not: then the
    number is that of the rung before."""
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
                # A run that failed may have no number of bodies: its rung is beyond those that have.
                top = max([b for b in bodies if math.isfinite(b)], default=0) + 1
                row[name], row[name + " known"] = largest([(b if math.isfinite(b) else top, ms) for b, ms in zip(bodies, times)])
            found.append(row)
    return found


def words(number, known):
    sign = {TOP: "≥ ", BELOW: "< "}.get(known, "")
    return "unknown" if known == UNKNOWN else f"{sign}{figures(float(f'{number:.1e}'))}"  # rungs are far apart


def finding(rows):
    said = []
    for place in dict.fromkeys((row["scene"], row["dimension"]) for row in rows):
        mine = [row for row in rows if (row["scene"], row["dimension"]) == place]
        told = [f"{row['method']} {words(row['slow'], row['slow known'])} (by the median "
                f"{words(row['median'], row['median known'])})"
                for row in mine]
        said.append(f"on {place[0]} in {place[1]}D {listing(told)}")
    return ("Bodies whose slow steps, the 99th percentile, stay within a sixtieth of a second: " + "; ".join(said) + "."
            if said else "No ladder was run.")


def _bar(ax, y, row, name, colour, height, alpha):
    number, known = row[name], row[name + " known"]
    if known in (WITHIN, TOP):
        ax.barh(y, number, height=height, color=colour, alpha=alpha, hatch="///" if known == TOP else None, edgecolor="white",
                lw=0)
    at = number if known in (WITHIN, TOP) else 0
    ax.annotate(words(number, known), (at, y), xytext=(4, 0), textcoords="offset points", va="center", fontsize=8)
    return at


def _chart(context, cells, refused):
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
                          label="median"), Patch(facecolor="#555555", hatch="///", edgecolor="white", label="ladder ended"),
                          Line2D([], [], ls="none", label="<: the first rung\nwas too slow")], 1.9)
    table = {**{name: [r[name] for r in rows] for name in ("scene", "dimension", "method")},
             **quantity("bodies by the 99th percentile", "1", [r["slow"] for r in rows]),
             "how known": [r["slow known"] for r in rows],
             **quantity("bodies by the median", "1", [r["median"] for r in rows]),
             "how known of the median": [r["median known"] for r in rows]}
    return Chart(f"{sweep}_bodies_at_rate", SECTION, "Bodies at sixty steps a second",
                 finding(ranked) + ranking.tail(context, cells), sweep, figure, pd.DataFrame(table),
                 refused + holes(cells, ["scene", "dimension", "method", *_ladders(cells)]),
                 "Processor time of a step; between two rungs of a ladder interpolated on logarithmic axes. Bodies are counted "
                 "with the ground. Hatched bars, ≥: the largest size of the ladder, or the last before one that failed, is still "
                 "within a sixtieth of a second.", headline=_headline(ranked))


def _ladders(cells):
    return [name for name in ("n", "base") if name in cells]


def _headline(rows):
    """Where the most and the fewest bodies of one place are farthest apart, of ladders that have an end."""
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
