# SPDX-License-Identifier: Zlib
"""Contacts: what is thrown back that should not, and what rules of contacts cost."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, of_sweeps
from load import one_machine, split, varying
from sentences import does, listing, methods
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, plain_log, same,
                   si, times)
from table import quantity

BOUNCE = "Do contacts bounce that should not?"
ROUNDING = 1e-6  # m: below it nothing is thrown back
NEAR = 1.1  # times the speed before: what a line joins
SUNK = 0.02  # m: four times the depth that most methods leave


@of_sweeps("rebound", 32, BOUNCE,
           Needs("world", varies=("height",), methods=(2, math.inf), series=("height",), also="`report` that names it"),
           "What is thrown back after a fall",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_springs")
def rebound(context, cells):
    if "rebound" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    return [_rebound_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def thrown(heights):
    """(fall, rebound) in m of a body's height per step: how far it fell until it rested, and how far it rose again after its
    lowest place. Both are measured from where it is in the end."""
    heights = np.asarray(heights, float)
    low = int(np.argmin(heights))
    return float(heights[0] - heights[-1]), max(0.0, float(np.max(heights[low:]) - heights[-1]))


def rows_of(context, cells):
    found = []
    for _, cell in cells.sort_values(["method", "height"]).iterrows():
        track = context.store.series(cell["key"], "height") if cell["key"] is not None and cell["outcome"] == "ok" else None
        fall, back = thrown(track) if track is not None and len(track) else (math.nan, math.nan)
        back = back if back > ROUNDING or math.isnan(back) else 0.0
        gravity = cell.get("gravity")
        found.append({"method": cell["method"], "height": cell["height"], "fall": fall, "rebound": back,
                      "speed": math.nan if gravity is None else float(gravity)})
    found = pd.DataFrame(found)
    # By the shallowest fall from that height: who sinks has not fallen faster.
    least = found.groupby("height")["fall"].transform("min")
    found["sunk"], found["speed"] = found["fall"] - least, np.sqrt(2 * found["speed"] * least.clip(lower=0))
    return found


def joined(track):
    """The line through these points, with a gap where the next speed is far: nothing was tried between."""
    xs, ys = [], []
    for i, (x, y) in enumerate(track):
        if i and x > NEAR * track[i - 1][0]:
            xs, ys = [*xs, math.nan], [*ys, math.nan]
        xs, ys = [*xs, x], [*ys, y]
    return xs, ys


def finding_of_rebound(rows):
    known = rows.dropna(subset=["rebound"])
    if not len(known):
        return "no fall that has a rank was finished."
    up, still, said = [], [], []
    for method, mine in known.groupby("method", sort=True):
        worst, thrown_by = mine.loc[mine["rebound"].idxmax()], mine[mine["rebound"] > 0]["speed"]
        (up if worst["rebound"] > 0 else still).append(
            (method, worst, thrown_by.min() if len(thrown_by) else mine["speed"].max()))
    for method, worst, least in sorted(up, key=lambda entry: -entry[1]["rebound"]):
        said.append(f"{method} throws the body back by up to {si(worst['rebound'], 'm')} (at {si(worst['speed'], 'm/s')}), "
                    f"at all from {si(least, 'm/s')} on")
    if still:
        said.append(f"{does((m for m, _, _ in still), 'throw')} it back by no more than "
                    f"{si(ROUNDING, 'm')} at any speed up to {si(min(most for _, _, most in still), 'm/s')}")
    deep = known[known["sunk"] > SUNK].groupby("method")["sunk"].max()
    said += [f"{method} leaves it up to {si(most, 'm')} deeper than others do" for method, most in deep.items()]
    return "; ".join(said) + "."


def _rebound_chart(context, cells):
    sweep, rows = cells["sweep"].iloc[0], rows_of(context, cells)
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    looks, methods, called = context.looks(cells), sorted(rows["method"].unique()), ranking.names(context, cells)
    ranked = rows[rows["method"].isin(ranking.whole(context, cells)["method"])]
    room = legend_room(called.values(), 1.75)
    figure, panels = grid_of_axes(1, 1, 3.2, room, left=0.9)
    ax = panels[0][0]
    plain_log(ax, "x", rows["speed"].dropna(), "m/s")
    scale = ZeroLog(ax, "y", rows["rebound"], "m")
    tracks = {}
    for method in methods:
        mine = rows[rows["method"] == method].dropna(subset=["speed"])
        tracks[method] = list(zip(mine["speed"], mine["rebound"]))
    firsts = same({m: [v for _, v in track] for m, track in tracks.items()})
    for method in dict.fromkeys(firsts.values()):
        ax.plot(*joined([(x, scale.place(v)) for x, v in tracks[method]]), **looks(method))
    words = one_line(ax, firsts, listing)
    ax.set_xlabel("speed at which the ground is hit")
    ax.set_ylabel("thrown back")
    legend_right(figure, [Line2D([], [], label=called[m], **looks(m)) for m in methods], room)
    table = {"method": rows["method"], **quantity("fall", "m", rows["fall"]), **quantity("speed", "m/s", rows["speed"]),
             **quantity("thrown back", "m", rows["rebound"]),
             "share of the energy [1]": rows["rebound"] / rows["fall"], **quantity("deeper than others", "m", rows["sunk"])}
    back = ranked.dropna(subset=["rebound"]).groupby("method")["rebound"].max().to_dict()
    most = max(back, key=back.get, default=None)
    head = None if most is None or not back[most] or min(back.values()) == back[most] else Headline(
        f"A box that hits the ground at up to {si(rows['speed'].max(), 'm/s')} and is not to bounce is thrown back by up to "
        f"{si(back[most], 'm')} with {most}; with {listing(m for m in back if back[m] == min(back.values()))} by "
        f"{si(min(back.values()), 'm')}.", back, "m", "thrown back")
    return Chart(f"{sweep}_rebound_{dimension}d", BOUNCE, f"What is thrown back after a fall, {dimension}D",
                 f"In {dimension}D, {finding_of_rebound(ranked)}{ranking.tail(context, cells)}", sweep, figure,
                 pd.DataFrame(table), holes(cells, ["method", "height"]),
                 "The highest place after the lowest, above that in the end, over the speed that the fall has without drag; what "
                 f"is at most {si(ROUNDING, 'm')} is 0. "
                 "Lines join speeds less than a tenth apart." + caption_of_lines([("Lines", words)]), headline=head)


RULES = "What do contacts cost, and what stands better for them?"
TIME, POINTS = "ms_per_step_median", "contacts_end"
BOUGHT = ("sag_end", "lateral_max", "jitter")
TOLD = 1.1  # ratio of two results from which it is told, when it holds beyond doubt


@of_sweeps("contact_rules", 44, RULES,
           Needs("world", metrics=(TIME,), also="contact generators as its methods, and what settles"),
           "Rules of contacts", "No timed sweep of contact generators on stacks is in this store.", "reduction_in_a_stack")
def contact_rules(context, cells):
    if context.store.method_axes(cells["sweep"].iloc[0]) != ["contacts"] or not {POINTS, *BOUGHT} <= set(cells):
        return []
    cells, refused = one_machine(context.store, cells)
    others = [axis for axis in ("scene", "dimension") if axis in cells]
    others += varying(context.store, cells, (*others, "seed"))
    return [_rules_chart(context, part, describe(part.iloc[0], others), refused) for part in split(cells, others, sort=True)]


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


def finding_of_rules(context, cells, base, where, least):
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


def _rules_chart(context, cells, where, refused):
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
    return Chart(identifier(f"{sweep} contact_rules {where}"), RULES, f"Rules of contacts: {where}",
                 finding_of_rules(context, cells, base, where, least), sweep, figure,
                 table[["method", "outcome"]].assign(**numbers), refused + holes(cells, ["method"]) + noise.idle_seeds(cells),
                 f"Bars go from the least to the most of all seeds, of times over the repeats. A result is told when it "
                 "differs by "
                 f"{100 * (TOLD - 1):.0f} % and beyond doubt. "
                 f"{ranking.rule_of_pairs(max(map(len, cells['seeds'])), max(1, finished - 1))} {noise.rule(least)}",
                 headline=headline(context, cells, base, where))


def _panel(ax, context, cells, name, names, looks):
    rows = {row["method"]: row for _, row in cells.iterrows()}
    good = {m: row for m, row in rows.items() if row["outcome"] == "ok" and math.isfinite(float(row[name]))}
    spans = {m: noise.interval(measured.runs(row, name)) if name == TIME else _span(measured.seeds(row, name))
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
