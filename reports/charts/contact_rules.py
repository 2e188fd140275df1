# SPDX-License-Identifier: Zlib
"""What contact generators and their rules cost and buy where things should stand: time, contacts, sag, drift and jitter."""

import math

import numpy as np
from matplotlib.lines import Line2D

import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, methods, of_sweeps
from load import one_machine, split, varying
from style import ZeroLog, fallen, grid_of_axes, letter, times
from table import quantity

SECTION = "What do contacts cost, and what stands better for them?"
TIME, POINTS = "ms_per_step_median", "contacts_end"
BOUGHT = ("sag_end", "lateral_max", "jitter")
TOLD = 1.1  # ratio of two results from which it is told, when it holds beyond doubt


@of_sweeps("contact_rules", 44, SECTION,
           Needs("world", metrics=(TIME,), also="contact generators as its methods, and what settles"),
           "Rules of contacts", "No timed sweep of contact generators on stacks is in this store.", "reduction_in_a_stack")
def contact_rules(context, cells):
    if context.store.method_axes(cells["sweep"].iloc[0]) != ["contacts"] or not {POINTS, *BOUGHT} <= set(cells):
        return []
    cells, refused = one_machine(context.store, cells)
    others = [axis for axis in ("scene", "dimension") if axis in cells]
    others += varying(context.store, cells, (*others, "seed"))
    return [_chart(context, part, describe(part.iloc[0], others), refused) for part in split(cells, others, sort=True)]


def against(cells, base, name):
    """({ratio: methods that are better than the baseline beyond doubt}, {...worse}), by `name`; ratios in words."""
    rows = {row["method"]: row for _, row in cells.iterrows() if row["outcome"] == "ok"}
    found = ({}, {})
    for method, row in rows.items():
        if base not in rows or method == base:
            continue
        for side, (first, second) in enumerate(((row, rows[base]), (rows[base], row))):
            a, b = float(first[name]), float(second[name])
            if b >= TOLD * a and b > 0 and ranking.better(first, second, name, many=len(rows) - 1):
                found[side].setdefault(times(a / b if side == 0 else b / a) if a > 0 else "0" if side == 0 else "beyond count",
                                       []).append(method)
    return found


def finding(context, cells, base, where, least):
    everyone, rows = sorted(cells["method"].unique()), {row["method"]: row for _, row in cells.iterrows()}
    text = f"{where}, against {base}:"
    fell = {}
    for method, row in rows.items():
        if row["outcome"] != "ok":
            fell.setdefault(row["outcome"], []).append(method)
    parts = [f"{outcome}: {methods(names, everyone)}" for outcome, names in sorted(fell.items())]
    if base not in rows or rows[base]["outcome"] != "ok":
        return f"{text} it has no result; {'; '.join(parts)}."
    ratios = {m: noise.ratio(rows[base], row, TIME) for m, row in rows.items()
              if m != base and row["outcome"] == "ok" and noise.tells(rows[base], row, TIME, least)}
    alike = [m for m, row in rows.items() if m not in (base, *ratios) and row["outcome"] == "ok"]
    told = [f"{m} {times(ratio)} times" for m, ratio in sorted(ratios.items(), key=lambda item: item[1])]
    parts.append("time of a step: " + ", ".join([*told, *([f"not told apart {methods(alike, everyone)}"] if alike else [])]))
    for name in BOUGHT:
        better, worse = against(cells, base, name)
        said = [f"{ratio} times with {methods(names, everyone)}" for side in (better, worse) for ratio, names in
                sorted(side.items(), key=lambda item: item[1])]
        parts.append(f"{context.title(name)}: {', '.join(said) if said else 'no method differs beyond doubt'}")
    return f"{text} {'; '.join(parts)}."


def headline(context, cells, base, where):
    """The largest gain or loss of a result, beyond doubt."""
    rows, found = {row["method"]: row for _, row in cells.iterrows() if row["outcome"] == "ok"}, []
    for name in BOUGHT:
        for side in against(cells, base, name):
            for names in side.values():
                found += [(abs(math.log(float(rows[m][name]) / float(rows[base][name]))), name, m) for m in names
                          if min(float(rows[m][name]), float(rows[base][name])) > 0]
    if not found:
        return None
    _, name, method = max(found)
    ratio = float(rows[method][name]) / float(rows[base][name])
    return Headline(f"{where}: {context.title(name)} with {method} is {times(ratio)} times that with {base}.",
                    {m: float(row[name]) for m, row in rows.items()}, context.unit(name), context.title(name))


def _chart(context, cells, where, refused):
    base, sweep, looks = context.baseline(cells), cells["sweep"].iloc[0], context.looks(cells)
    finished = cells[cells["outcome"] == "ok"]["method"].nunique()
    least = noise.floor_of(context, sweep, TIME)
    names = sorted(cells["method"].unique(), key=lambda method: (method != base, method))
    shown, room = (TIME, POINTS, *BOUGHT), 0.35 + 0.078 * max(map(len, map(context.name, names)))
    figure, axes = grid_of_axes(1, len(shown), 0.35 + 0.24 * len(names), left=room, gap_x=0.3, bottom=0.75)
    for ax, name in zip(axes[0], shown):
        _panel(ax, context, cells, name, names, looks)
        ax.tick_params(labelleft=ax is axes[0][0])
    bad = sorted(set(cells["outcome"]) - {"ok"})
    if bad:
        figure.legend(handles=[Line2D([], [], ls="none", marker=letter(o), color="#555555", ms=7, label=o) for o in bad],
                      loc="lower left", bbox_to_anchor=(0.005, 0.0), ncol=len(bad))
    numbers = {}
    table = cells.sort_values("method")
    for name in shown:
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    return Chart(identifier(f"{sweep} contact_rules {where}"), SECTION, f"Rules of contacts: {where}",
                 finding(context, cells, base, where, least), sweep, figure, table[["method", "outcome"]].assign(**numbers),
                 refused + holes(cells, ["method"]) + noise.idle_seeds(cells),
                 f"Bars go from the least to the most of all seeds, of times over the repeats. A result is told when it "
                 "differs by "
                 f"{100 * (TOLD - 1):.0f} % and beyond doubt. "
                 f"{ranking.rule_of_pairs(max(map(len, cells['seeds'])), max(1, finished - 1))} {noise.rule(least)}",
                 headline=headline(context, cells, base, where))


def _panel(ax, context, cells, name, names, looks):
    rows = {row["method"]: row for _, row in cells.iterrows()}
    good = {m: row for m, row in rows.items() if row["outcome"] == "ok" and math.isfinite(float(row[name]))}
    spans = {m: noise.interval(noise.runs(row, name)) if name == TIME else _span(noise.values(row, f"{name} seeds"))
             for m, row in good.items()}
    values = [v for m, row in good.items() for v in (float(row[name]), *spans[m]) if math.isfinite(v)]
    scale = ZeroLog(ax, "x", np.array(values), context.unit(name), failures=len(good) < len(rows))
    ax.set_ylim(len(names) - 0.5, -0.5)
    spots = []
    for y, method in enumerate(names):
        if method not in good:
            spots += [(scale.failed, y, rows[method]["outcome"], looks(method)["color"])] if method in rows else []
            continue
        low, high = spans[method]
        if high > low:
            ax.plot([scale.place(low), scale.place(high)], [y, y], color=looks(method)["color"], lw=1.3, alpha=0.6)
        ax.plot([scale.place(float(good[method][name]))], [y], **{**looks(method), "linestyle": "none"})
    ax.set_yticks(range(len(names)))
    ax.set_yticklabels(list(map(context.name, names)))
    ax.set_xlabel("\n".join(_wrapped(context.title(name))), fontsize=8.5)
    ax.tick_params(axis="x", labelsize=7.5)
    fallen(ax, spots)


def _span(values):
    return (min(values), max(values)) if values else (math.nan, math.nan)


def _wrapped(title):
    words = title.split()
    half = (len(words) + 1) // 2
    return [title] if len(title) < 18 else [" ".join(words[:half]), " ".join(words[half:])]
