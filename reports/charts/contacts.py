# SPDX-License-Identifier: Zlib
"""Contacts: bounces without restitution, and the cost and benefit of contact rules."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, of_sweeps
from finding import NOISE, TIE, Finding, Line, cut, fits, ranked
from load import one_machine, split, varying
from sentences import listing, some, verb
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, plain_log, same,
                   si, times)
from table import quantity

BOUNCE = "Which methods bounce without restitution?"
ROUNDING = 1e-6  # m: a smaller rebound counts as 0
NEAR = 1.1  # ratio of two neighbouring speeds up to which a line joins their points
SUNK = 0.02  # m: four times the depth that most methods leave; the table shows bodies that are left deeper


@of_sweeps("rebound", 32, BOUNCE,
           Needs("world", varies=("height",), methods=(2, math.inf), series=("height",), also="`report` that lists it"),
           "Rebound after a fall",
           "No sweep that lists this chart is in this store; experiments/run heritage makes one.", "heritage_springs")
def rebound(context, cells):
    if "rebound" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    return [_rebound_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def thrown(heights):
    """(fall, rebound) in m of a body's height per step: its fall until it rests, and its rise after the lowest place. Both are
    measured from its height at the end."""
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
    # From the shallowest fall from that height: a body that sinks has not fallen faster.
    least = found.groupby("height")["fall"].transform("min")
    found["sunk"], found["speed"] = found["fall"] - least, np.sqrt(2 * found["speed"] * least.clip(lower=0))
    return found


def joined(track):
    """The line through these points, with a gap where no speed was tried between two of them."""
    xs, ys = [], []
    for i, (x, y) in enumerate(track):
        if i and x > NEAR * track[i - 1][0]:
            xs, ys = [*xs, math.nan], [*ys, math.nan]
        xs, ys = [*xs, x], [*ys, y]
    return xs, ys


def found_rebound(context, cells, rows, dimension):
    """(finding, entry of the first screen or None)"""
    why, lines = ranking.unranked(context, cells), []
    for method, mine in rows.groupby("method", sort=True):
        known = mine.dropna(subset=["rebound"])
        if method in why or not len(known):
            lines.append(Line(method, outcome=f"not ranked: {why[method]}" if method in why else "failed: every fall"))
            continue
        worst, up = known.loc[known["rebound"].idxmax()], known[known["rebound"] > 0]["speed"]
        more = quantity("at a speed of", "m/s", [worst["speed"] if worst["rebound"] > 0 else math.nan])
        more |= quantity("bounces from", "m/s", [up.min() if len(up) else math.nan]) | quantity(
            "tried up to", "m/s", [known["speed"].max()])
        deep = known["sunk"].max()
        more |= quantity("left deeper than by others", "m", [deep if deep > SUNK else math.nan])
        lines.append(Line(method, worst["rebound"], more={name: value[0] for name, value in more.items()}))
    table = ranked(lines, "rebound, at most", "m")
    back = {line.name: line.value for line in lines if not line.outcome}
    if not back:
        return Finding(f"In {dimension}D no ranked method finishes a fall.", table), None
    top, speed = max(back, key=back.get), si(rows["speed"].max(), "m/s")
    still = [m for m, value in back.items() if value == 0]
    if not back[top]:
        return Finding(f"In {dimension}D no method throws a body back by more than {si(ROUNDING, 'm')} at up to {speed}.",
                       table), None
    least = f"; {some(still)} {verb(len(still), 'do')} not" if still else ""
    head = f"In {dimension}D {top} throws a body without restitution back by up to {si(back[top], 'm')}"
    at = f" at {si(next(line.more['at a speed of [m/s]'] for line in lines if line.name == top), 'm/s')}"
    made = Finding(fits(f"{head}{at}{least}.", f"{head}{least}.", f"{head}."), table)
    entry = None if min(back.values()) == back[top] else Headline("", back, "m", "rebound")
    return made, entry


def _rebound_chart(context, cells):
    sweep, rows = cells["sweep"].iloc[0], rows_of(context, cells)
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    looks, methods, called = context.looks(cells), sorted(rows["method"].unique()), ranking.names(context, cells)
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
    ax.set_xlabel("speed of impact")
    ax.set_ylabel("rebound")
    legend_right(figure, [Line2D([], [], label=called[m], **looks(m)) for m in methods], room)
    table = {"method": rows["method"], **quantity("fall", "m", rows["fall"]), **quantity("speed", "m/s", rows["speed"]),
             **quantity("rebound", "m", rows["rebound"]),
             "share of the energy [1]": rows["rebound"] / rows["fall"], **quantity("deeper than others", "m", rows["sunk"])}
    about, entry = found_rebound(context, cells, rows, dimension)
    return Chart(f"{sweep}_rebound_{dimension}d", BOUNCE, f"Rebound after a fall, {dimension}D", about, sweep, figure,
                 pd.DataFrame(table), holes(cells, ["method", "height"]),
                 "The rebound is the largest height after the lowest place, above the height at the end. The speed is that of a "
                 f"fall without drag. A rebound up to {si(ROUNDING, 'm')} is drawn at 0. Lines join speeds less than a tenth "
                 "apart." + caption_of_lines([("Lines", words)]), headline=entry)


RULES = "What do contact rules cost, and do stacks stand better?"
TIME, POINTS = "ms_per_step_median", "contacts_end"
BOUGHT = ("sag_end", "lateral_max", "jitter")
TOLD = 1.1  # smallest ratio of two results that the table gives, where the difference is significant


@of_sweeps("contact_rules", 44, RULES,
           Needs("world", metrics=(TIME,), also="contact generators as its methods, and a scene that settles"),
           "Contact rules", "No timed sweep of contact generators on stacks is in this store.", "reduction_in_a_stack")
def contact_rules(context, cells):
    if context.store.method_axes(cells["sweep"].iloc[0]) != ["contacts"] or not {POINTS, *BOUGHT} <= set(cells):
        return []
    cells, refused = one_machine(context.store, cells)
    others = [axis for axis in ("scene", "dimension") if axis in cells]
    others += varying(context.store, cells, (*others, "seed"))
    return [_rules_chart(context, part, describe(part.iloc[0], others), refused) for part in split(cells, others, sort=True)]


def against(rows, base, name):
    """{method: (ratio, words)} by a result of the baseline; the ratio is NaN where it is not significant. `rows`: cells that
    finished, by method."""
    found = {}
    for method, row in rows.items():
        a, b = float(row[name]), float(rows[base][name])
        better = b >= TOLD * a and b > 0 and ranking.better(row, rows[base], name, many=len(rows) - 1)
        worse = a >= TOLD * b and a > 0 and ranking.better(rows[base], row, name, many=len(rows) - 1)
        sure = better or worse
        ratio = a / b if sure and b > 0 else math.inf if sure else math.nan
        found[method] = ratio, (TIE if not sure else f"more than 0 ({si(a)})" if math.isinf(ratio) else f"{times(ratio)} times"
                                if ratio else "0")
    return found


def found_rules(context, cells, base, where, least):
    """(finding, entry of the first screen or None): each method against the baseline."""
    everything = {row["method"]: row for _, row in cells.iterrows()}
    rows = {method: row for method, row in everything.items() if row["outcome"] == "ok"}
    order = sorted(everything, key=lambda m: (m != base, m not in rows, m))
    table = pd.DataFrame({"method": order, "outcome": [everything[m]["outcome"] for m in order]})
    if base not in rows:
        return Finding(f"{where}: the baseline {base} has no result.", cut(table)), None
    words = {m: noise.said(rows[base], row, TIME, least) for m, row in rows.items()}
    words = {m: {noise.NOISE: NOISE}.get(word, word) if word in (noise.NOISE, noise.FEW, noise.SAME_WORK) else
             f"{times(noise.ratio(rows[base], rows[m], TIME))} times" for m, word in words.items()}
    columns = {TIME: words} | {name: {m: said for m, (_, said) in against(rows, base, name).items()} for name in BOUGHT}
    for name, said in columns.items():
        own = f"{si(float(rows[base][name]), context.unit(name))} ({base})"
        table[f"{context.title(name)}, against {base}"] = [own if m == base else said.get(m, "") for m in order]
    sure = [(abs(math.log(ratio)) if 0 < ratio < math.inf else math.inf, name, m, said) for name in BOUGHT
            for m, (ratio, said) in against(rows, base, name).items() if m != base and ratio == ratio]
    if not sure:
        return Finding(f"{where}: no contact rule changes a result of {base} significantly.", cut(table)), None
    finite = [entry for entry in sure if math.isfinite(entry[0])]
    _, name, method, said = max(finite or sure)
    time = f"; a step takes {words[method]} the time" if words[method].endswith("times") else ""
    head = f"{where}: {context.title(name)} with {method} is {said} that with {base}" if said.endswith("times") else (
        f"{where}: {context.title(name)} with {method} is {said}, against {si(float(rows[base][name]), context.unit(name))} with "
        f"{base}")
    entry = Headline("", {m: float(row[name]) for m, row in rows.items()}, context.unit(name), context.title(name))
    return Finding(fits(f"{head}{time}.", f"{head}."), cut(table)), entry if finite else None


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
    about, entry = found_rules(context, cells, base, where, least)
    numbers = {}
    table = cells.sort_values("method")
    for name in shown:
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    return Chart(identifier(f"{sweep} contact_rules {where}"), RULES, f"Contact rules: {where}",
                 about, sweep, figure, table[["method", "outcome"]].assign(**numbers),
                 refused + holes(cells, ["method"]) + noise.idle_seeds(cells),
                 "Bars are the range over all seeds, of times over the repeats. The table gives a result's ratio where it "
                 "differs "
                 f"significantly, by at least {100 * (TOLD - 1):.0f} %; else the two tie. "
                 f"{ranking.rule_of_pairs(max(map(len, cells['seeds'])), max(1, finished - 1))} {noise.rule(least)}",
                 headline=entry)


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
