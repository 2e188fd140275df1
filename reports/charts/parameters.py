# SPDX-License-Identifier: Zlib
"""What hangs on the parameters of methods: each with one of them changed, beside its defaults, on frozen boxes."""

import math

import pandas as pd

import metrics
import noise
from chart import Chart, Headline, Needs, dimension_of, holes, listing, of_sweeps
from load import family, one_machine
from style import ZeroLog, fallen, grid_of_axes, times
from table import quantity

SECTION = "Which broadphase for how many bodies?"
TIME = "ns_per_frame_median"


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
    return [_chart(context, cells, refused)] if (cells["method"] == cells["family"]).any() else []


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


def finding(rows, panels):
    said = []
    for name in sorted({row["family"] for row in rows}):
        told = [row for row in rows if row["family"] == name and row["told"]]
        if not told:
            said.append(f"no parameter of {name} changes its time beyond the noise")
            continue
        most, least = max(told, key=lambda row: row["ratio"]), min(told, key=lambda row: row["ratio"])
        words = []
        if least["ratio"] < 1:
            words.append(f"gains most by {least['method']} ({times(least['ratio'])} times the time of its defaults on "
                         f"{least['panel']}{_not_told(rows, least, -1)})")
        if most["ratio"] > 1:
            words.append(f"loses most by {most['method']} ({times(most['ratio'])} times on {most['panel']}"
                         f"{_not_told(rows, most, 1)})")
        both = [m for m in dict.fromkeys(row["method"] for row in told)
                if sum(row["method"] == m and row["ratio"] < 1 for row in told) == panels]
        tail = f"; {listing(both)} gain{'s' if len(both) == 1 else ''} everywhere" if both else ""
        said.append(f"{name} " + " and ".join(words) + tail)
    return "; ".join(said) + "."


def _not_told(rows, named, sign):
    """Who goes farther in the same panel by the medians alone, which a reader of the picture sees."""
    farther = [row["method"] for row in rows if row["family"] == named["family"] and row["panel"] == named["panel"] and
               not row["told"] and sign * row["ratio"] > sign * named["ratio"]]
    return f"; the median of {listing(farther)} is farther off, but within the noise" if farther else ""


def _chart(context, cells, refused):
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
            low, high = noise.interval(noise.runs(cell, TIME))
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
    return Chart(f"{sweep}_parameters", SECTION, f"What hangs on parameters: {n}", f"Of {n}, {finding(rows, len(panels))}", sweep,
                 figure, pd.DataFrame(table), refused + holes(cells, ["panel", "method"]),
                 "Filled marks and dotted lines are the defaults, hollow marks have one parameter changed; whiskers hold the "
                 f"median of the repeats. {noise.rule(least)}", headline=head)
