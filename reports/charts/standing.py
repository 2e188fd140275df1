# SPDX-License-Identifier: Zlib
"""Scenes that should stand: their restlessness, their outcome under each method, and their height over time."""

import math

import numpy as np
import pandas as pd
from matplotlib.patches import Patch, Rectangle

import over_steps
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, of_sweeps
from finding import AGAINST, Finding, Line, cut
from load import NOT_RUN, split, varying
from sentences import listing, methods, some, verb
from style import OUTCOMES, ZeroLog, caption_of_lines, grid_of_axes, legend_right, one_line, same, si
from table import quantity

RESTLESS = "How restless is a scene that should be at rest?"
REST = 1e-9  # m/s: smaller speeds are rounding


@of_sweeps("steadiness", 30, RESTLESS,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("drift_limit", "restlessness"),
                 series=("max_speed", "points"),
                 also=f"{over_steps.ONE_COURSE}, on a scene with a limit of drift"),
           "The fastest body and the contacts over time",
           "This store has no sweep of several methods on a scene that should be at rest.", "resolvers")
def steadiness(context, cells):
    if over_steps.elsewhere(context, cells):
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        # Scenes with a limit of drift, each at the middle of its own setting. A scene without a finished run may have one.
        resting = [scene for scene in split(part, ["scene"])
                if scene["drift_limit"].notna().any() or not (scene["finished_trials"] > 0).any()]
        if resting:
            shown, left_out, setting = over_steps.scenes(context, pd.concat(resting))
            at_one = [(where, over_steps.at_middle(mine, setting)) for where, mine in shown]
            made.append(_steadiness_chart(context, at_one, left_out, setting))
    return made


def at_rest(speeds):
    """{method: speed}; speeds up to REST count as 0."""
    return {method: 0.0 if v <= REST else v for method, v in speeds.items()}


def lines_of_steadiness(speeds, why, everyone):
    """(lines of the finding's table, no ties); methods at rest share a line. `why`: {method: reason without a speed or rank}."""
    groups = {}
    for method, speed in at_rest(speeds).items():
        groups.setdefault(speed if speed == 0 else (speed, method), []).append(method)
    lines = [Line(methods(names, everyone), 0.0 if speed == 0 else speed[0]) for speed, names in groups.items()]
    return lines + ranking.lines(why), ()


def table_of_steadiness(found):
    table = over_steps.by_scene(found, "RMS speed of the fastest body", "m/s")
    if AGAINST in table:
        resting = [line.name for _, lines, _ in found for line in lines if line.value == 0]
        table[AGAINST] = ["at rest" if name in resting else text for name, text in zip(table["method"], table[AGAINST])]
    return table


def headline(where, speeds, failed=(), at=""):
    """The calmest and the most restless method; below REST all are equally calm. `at`: the setting, as text."""
    speeds = at_rest(speeds)
    everyone, worst = [*speeds, *failed], max(speeds, key=speeds.get)
    resting, calmest = [m for m in speeds if speeds[m] == 0], min(speeds, key=speeds.get)
    if resting:
        first = f"{some(resting, everyone)} {verb(len(resting), 'come')} to rest"
        last = f"; {worst} is most restless, {si(speeds[worst], 'm/s')}" if speeds[worst] else ""
    elif speeds[worst] == speeds[calmest]:
        first, last = f"{some(speeds, everyone)} are equally restless, {si(speeds[worst], 'm/s')}", ""
    else:
        first = f"{calmest} is calmest, {si(speeds[calmest], 'm/s')}"
        last = f", and {worst} most restless, {si(speeds[worst], 'm/s')}"
    fails = f"{', and' if ';' in last else ';'} {some(failed, everyone)} {verb(len(failed), 'fail')}" if failed else ""
    return Headline(f"On {where}{at} {first}{last}{fails}.", {**speeds, **dict.fromkeys(failed, math.nan)}, "m/s",
                    "RMS speed of the fastest body")


def _steadiness_chart(context, resting, left_out, setting):
    resting = [(scene, part.drop_duplicates("method").sort_values("method")) for scene, part in resting]
    cells = pd.concat([part for _, part in resting])
    dimension, at = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2, over_steps.setting_of(cells, setting)
    figure, axes, legend_width = over_steps.grid(context, cells, 2, len(resting))
    labels, rows, shared = sorted(cells["method"].unique()), [], []
    for column, (scene, part) in enumerate(resting):
        speeds, points = ({cell["method"]: [] if found is None else found for _, cell in part.iterrows()
                           if cell["key"] is not None for found in [context.store.series(cell["key"], name)]}
                          for name in ("max_speed", "points"))
        high = [v for track in speeds.values() for v in over_steps.stretches(np.asarray(track, float), np.max)[1]
                if math.isfinite(v)]
        axes[0][column].set_title(f"{scene}, {dimension}D")
        axes[1][column].set_ylim(0, 1.05 * max([1, *(v for track in points.values() for v in track if math.isfinite(v))]))
        scale = ZeroLog(axes[0][column], "y", high, "m/s", failures=False, floor=REST)
        for ax, tracks, place, what in ((axes[0][column], speeds, scale.place, "fastest body"),
                                        (axes[1][column], points, float, "contact points")):
            firsts = same(tracks)
            over_steps.lines(context, ax, part, lambda cell, of=tracks: np.asarray(of[cell["method"]], float), place,
                             np.max, drawn=set(firsts.values()))
            shared.append((f"On {scene}, {what}", one_line(ax, firsts, lambda group: methods(group, labels))))
        axes[0][column].set_xlabel("")
        excused = ranking.excused(context, part)
        rows += [{"scene": scene, "method": cell["method"], "outcome": cell["outcome"], "excused": excused.get(index, ""),
                  "restlessness": math.nan if cell["key"] is None else cell.get("restlessness"),
                  "contact points at the end": points[cell["method"]][-1] if len(points.get(cell["method"], [])) else math.nan}
                 for index, cell in part.iterrows()]
    axes[0][0].set_ylabel("fastest body")
    axes[1][0].set_ylabel("contact points")
    over_steps.legend(context, figure, cells, legend_width)
    table = pd.DataFrame(rows)
    found, told = [], []
    for scene, part in table.groupby("scene", sort=False):
        failed = part[~part["outcome"].isin(("ok", NOT_RUN)) & (part["excused"] == "")]
        why = {row["method"]: f"not ranked: {row['excused']}" if row["excused"] else
               row["outcome"] if row["outcome"] == NOT_RUN else f"failed: {row['outcome']}"
               for _, row in part.iterrows() if row["excused"] or row["outcome"] != "ok"}
        part = part[(part["outcome"] == "ok") & np.isfinite(part["restlessness"].astype(float)) & (part["excused"] == "")]
        speeds = dict(zip(part["method"], part["restlessness"].astype(float)))
        found.append((scene, *lines_of_steadiness(speeds, why, labels)))
        if len(part) > 1:
            told.append(headline(f"{scene} in {dimension}D", speeds, sorted(failed["method"]), at))
    first = max(told, key=lambda head: (head.effect, -sum(map(math.isnan, head.values.values()))), default=None)
    text = first.text if first else f"In {dimension}D{at} too few runs finished to compare."
    table = table.drop(columns="excused").rename(columns={"restlessness": "restlessness [m/s]"})
    moving = first and any(value > 0 for value in first.values.values())
    return Chart(f"{cells['sweep'].iloc[0]}_steadiness_{dimension}d", RESTLESS,
                 f"The fastest body and the contacts over time, {dimension}D", Finding(text, table_of_steadiness(found)),
                 cells["sweep"].iloc[0], figure, table, left_out + holes(cells, ["scene", "method"]),
                 f"Lines are the largest value of each of {over_steps.STRETCHES} intervals of steps; a letter marks a failed "
                 "run. The finding has the RMS of the fastest body's speed over the last quarter of the steps; up to "
                 f"{si(REST, 'm/s')} it is at rest." + over_steps.without_setting(cells, setting) + caption_of_lines(shared),
                 headline=first if moving else None)


STANDS = "Which scenes stand under which method?"
RESTS = "rest_since"


@of_sweeps("stability", 31, STANDS,
           Needs("world", methods=(2, math.inf), also="a `report` that lists it"),
           "Outcome of scenes under each method",
           "This store has no sweep whose `report` lists this chart; experiments/run heritage makes one.", "heritage_stability")
def stability(context, cells):
    if "stability" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    return [_stability_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def told(cell):
    """The text of a cell: the time since which all bodies rest, or the outcome with the step of the end."""
    if cell["outcome"] == "ok":
        rest = cell.get(RESTS)
        return f"rests, {rest:.1f} s" if rest is not None and math.isfinite(rest) else "ok, moves"
    return cell["outcome"] + ("" if cell["step"] != cell["step"] else f", {int(cell['step'])}")


def finding_of_stability(rows, ranked, why, dimension):
    """Runs that each method holds, the best first. `why`: {method: why it has no rank}."""
    found = []
    for method in ranked:
        mine = [row for row in rows if row["method"] == method]
        fell = [row for row in mine if row["outcome"] != "ok"]
        found.append({"method": method, "runs held": len(mine) - len(fell), "runs": len(mine),
                      "not held": ", ".join(_fallen(fell, mine)) if len(fell) < len(mine) else "all" if fell else ""})
    found.sort(key=lambda row: -row["runs held"] / max(1, row["runs"]))
    others = [{"method": line.name, "not held": line.outcome} for line in ranking.lines(ranking.not_ranked(why))]
    table = cut(pd.DataFrame(found + others), range(len(found), len(found) + len(others)))
    if not found:
        return Finding(f"In {dimension}D no method has a rank.", table)
    ends = [[row for row in found if row["runs held"] == found[i]["runs held"]] for i in (0, -1)]
    text = " and ".join(f"{some(row['method'] for row in end)} {verb(len(end), 'hold')} {end[0]['runs held']} of "
                        f"{end[0]['runs']}" for end in (ends if ends[0] != ends[1] else ends[:1]))
    return Finding(f"In {dimension}D {text} runs.", table)


def _fallen(fell, mine):
    """The runs that are not held by name; if more than two of a scene, their number."""
    for scene in dict.fromkeys(row["scene"] for row in fell):
        there, of = [row["where"] for row in fell if row["scene"] == scene], sum(row["scene"] == scene for row in mine)
        yield from [scene] if len(there) == of else there if len(there) < 3 else [f"{scene} in {len(there)} of {of}"]


def _stability_chart(context, cells):
    sweep = cells["sweep"].iloc[0]
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    axes = ["scene", *(name for name in varying(context.store, cells) if name not in ("scene", "dimension"))]
    methods, rows, places = list(dict.fromkeys(cells["method"])), [], {}
    called, kept = ranking.names(context, cells), set(ranking.whole(context, cells)["method"])
    ranked = [method for method in methods if method in kept]
    for _, cell in cells.iterrows():
        where = describe(cell, axes)
        places.setdefault(where, len(places))
        rows.append({"where": where, "scene": cell["scene"], "method": cell["method"], "outcome": cell["outcome"],
                     "step": cell["step"],
                     "told": told(cell), "reason": cell["reason"]})
    left = 0.35 + 0.075 * max(map(len, places))
    figure, panels = grid_of_axes(1, 1, 0.34 * len(places) + 0.1, 1.5, left=left, top=0.6, bottom=0.15)
    ax = panels[0][0]
    for row in rows:
        x, y = methods.index(row["method"]), places[row["where"]]
        colour = OUTCOMES.get(row["outcome"], ("#FFFFFF", ""))[0]
        ax.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=colour, edgecolor="white", lw=2))
        dark = sum(int(colour[i:i + 2], 16) for i in (1, 3, 5)) < 330
        ax.text(x, y, row["told"], ha="center", va="center", fontsize=8, color="white" if dark else "black")
    ax.set_xlim(-0.5, len(methods) - 0.5)
    ax.set_ylim(len(places) - 0.5, -0.5)
    ax.set_xticks(range(len(methods)), [called[m].replace(" (", "\n(").replace("+", "\n+") for m in methods])
    ax.set_yticks(range(len(places)), list(places))
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    ax.grid(False)
    for spine in ax.spines.values():
        spine.set_visible(False)
    legend_right(figure, [Patch(facecolor=OUTCOMES.get(o, ("#FFFFFF", ""))[0], edgecolor="#999999",
                                label=o if o == "ok" else f"{o}, at step")
                          for o in sorted({row["outcome"] for row in rows}, key=list(OUTCOMES).index)], 1.5)
    held = {method: sum(row["outcome"] == "ok" for row in rows if row["method"] == method) for method in ranked}
    finding = finding_of_stability(rows, ranked, ranking.unranked(context, cells), dimension)
    head = Headline("", {m: float(v) for m, v in held.items()}, quantity="runs held", larger=True) if len(
        set(held.values())) > 1 else None
    return Chart(identifier(f"{sweep} stability {dimension}d"), STANDS, f"Outcome of scenes under each method, {dimension}D",
                 finding, sweep, figure, pd.DataFrame(rows).drop(columns=["told", "scene"]).rename(columns={"where": "scene"}),
                 holes(cells, ["method", *axes]),
                 "A cell is one run: the time since which all bodies rest until the end, or its outcome with the step of the "
                 "end. “moves”: the scene stands, but a body is not at rest.", headline=head)


TURNS_NONE = "linear"  # the first position method of the 2009 report, which rotates no body
SEEN = 0.004  # share of a panel's height: closer lines are drawn once
LOST = 0.5  # share of the height at the start: a pile below it has fallen


@of_sweeps("over_time", 33, STANDS,
           Needs("world", methods=(2, math.inf), series=("height", "drift"), also="a `report` that lists it"),
           "Height and drift over time",
           "This store has no sweep whose `report` lists this chart; experiments/run heritage makes one.", "heritage_positions")
def over_time(context, cells):
    if "over_time" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        made.append(_over_time_chart(context, [(where, over_steps.at_middle(mine, setting)) for where, mine in shown], left_out))
    return made


def fallen_at(heights):
    """The first step with less than LOST of the height at the start; None if there is none."""
    heights = np.asarray(heights, float)
    below = np.flatnonzero(heights < LOST * heights[0])
    return int(below[0]) if len(below) else None


def drawn_alike(ax, curves, place, of):
    """{method: the first method with a curve that is everywhere within SEEN of the panel's height}: such lines are drawn once."""
    firsts, there = {}, {}
    share = lambda v: ax.transAxes.inverted().transform(ax.transData.transform((0, place(v))))[1]  # noqa: E731
    for method, points in curves.items():
        at = np.array([share(v) for v in over_steps.stretches(points, of)[1]])
        firsts[method] = next((other for other, line in there.items() if len(line) == len(at) and
                               np.max(np.abs(line - at)) <= SEEN), method)
        if firsts[method] == method:
            there[method] = at
    return firsts


def verdict(rows):
    """Whether a claim of the 2009 report holds, that `linear` makes piles fall, under each velocity resolver. It is confirmed if
    the pile falls and stands longer under all other position methods; empty if nothing compares."""
    confirmed = []
    for velocity in dict.fromkeys(row["method"].partition("+")[0] for row in rows):
        fell = {row["method"].partition("+")[2]: row["fell"] for row in rows if row["method"].startswith(f"{velocity}+")}
        if TURNS_NONE in fell and len(fell) > 1:
            mine = fell[TURNS_NONE]
            confirmed.append((velocity, mine is not None and all(at is None or at >= mine for at in fell.values())))
    if not confirmed:
        return ""
    good = [velocity for velocity, found in confirmed if found]
    word = "confirmed" if len(good) == len(confirmed) else f"confirmed under {listing(good)} only" if good else "not confirmed"
    return f" The claim of 2009 that piles fall because {TURNS_NONE} rotates no body is {word} by this scene."


def table_of_over_time(found):
    """Piles that stand first, then those that fall, the last first. `found`: [(scene, rows)]."""
    made = []
    for where, rows in found:
        order = sorted((row for row in rows if not row["why"]), key=lambda row: (-(row["fell"] or math.inf), row["method"]))
        made += [{"scene": where, "method": row["method"], "remark": "",
                  "half of the height lost at step": "never" if row["fell"] is None else str(row["fell"]),
                  "largest turn at the end [rad]": row["tilt"]} for row in order]
        made += [{"scene": where, "method": line.name, "remark": line.outcome}
                 for line in ranking.lines({row["method"]: f"not ranked: {row['why']}" for row in rows if row["why"]})]
    names = ["scene"] * (len(found) > 1) + ["method", "half of the height lost at step", "largest turn at the end [rad]"]
    names += ["remark"] * any(row["remark"] for row in made)
    return cut(pd.DataFrame(made, columns=None if made else names)[names], [i for i, row in enumerate(made) if row["remark"]])


def words_of_over_time(where, rows):
    """One scene in one sentence."""
    ranked = [row for row in rows if not row["why"]]
    fell, stand = ([row["method"] for row in ranked if (row["fell"] is None) == up] for up in (False, True))
    if not ranked:
        return f"On {where} {'no method has a rank' if rows else 'nothing was run'}."
    parts = [f"{word} with {some(names)}" for word, names in (("falls", fell), ("stands", stand)) if names]
    return f"On {where} the pile {'; it '.join(parts)}."


def _over_time_chart(context, shown, left_out):
    shown = [(where, part.drop_duplicates("method").sort_values("method")) for where, part in shown]
    cells = pd.concat([part for _, part in shown])
    sweep = cells["sweep"].iloc[0]
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, room = over_steps.grid(context, cells, 2, len(shown))
    rows, lines, found, judged = [], [], [], []
    for column, (where, part) in enumerate(shown):
        tracks = {name: {cell["method"]: np.asarray(found, float) for _, cell in part.iterrows() if cell["key"] is not None
                         for found in [context.store.series(cell["key"], name)] if found is not None and len(found)}
                  for name in ("height", "drift")}
        excused = ranking.excused(context, part)
        mine = [{"where": where, "method": cell["method"], "outcome": cell["outcome"],
                 "tilt": float(cell.get("tilt_end", math.nan)),
                 "height": tracks["height"][cell["method"]][-1], "drift": tracks["drift"][cell["method"]][-1],
                 "fell": fallen_at(tracks["height"][cell["method"]]), "why": excused.get(index, "")}
                for index, cell in part.iterrows() if cell["method"] in tracks["height"]]
        axes[0][column].set_title(f"{where}, {dimension}D")
        axes[0][column].set_ylim(0, 1.05 * max([1.0, *(float(np.max(v)) for v in tracks["height"].values())]))
        drifts = [v for track in tracks["drift"].values() for v in over_steps.stretches(track, np.max)[1]]
        scale = ZeroLog(axes[1][column], "y", drifts, "m", failures=False, floor=1e-6)
        for ax, name, place, of in ((axes[0][column], "height", float, np.median),
                                    (axes[1][column], "drift", scale.place, np.max)):
            firsts = drawn_alike(ax, tracks[name], place, of)
            over_steps.lines(context, ax, part, lambda cell, of=tracks[name]: of.get(cell["method"], np.array([])), place, of,
                             drawn=set(firsts.values()))
            lines.append((f"On {where}, {name}", one_line(ax, firsts, listing)))
        axes[0][column].set_xlabel("")
        rows += mine
        judged.append([row for row in mine if not row["why"]])
        found.append((where, mine))
    axes[0][0].set_ylabel("highest body (m)")
    axes[1][0].set_ylabel("largest drift")
    over_steps.legend(context, figure, cells, room)
    table = {"scene": [r["where"] for r in rows], "method": [r["method"] for r in rows], "outcome": [r["outcome"] for r in rows],
             "half of the height lost at step": [r["fell"] for r in rows],
             **quantity("height at the end", "m", [r["height"] for r in rows]),
             **quantity("largest turn at the end", "rad", [r["tilt"] for r in rows]),
             **quantity("drift at the end", "m", [r["drift"] for r in rows])}
    text = words_of_over_time(f"{shown[0][0]} in {dimension}D", [row for row in rows if row["where"] == shown[0][0]])
    ranked = [r for r in rows if not r["why"]]
    both = len({r["fell"] is None for r in ranked}) == 2 and len(shown) == 1
    head = Headline(text, {r["method"]: r["height"] for r in ranked}, "m", "height at the end", larger=True) if both else None
    return Chart(f"{sweep}_over_time_{dimension}d", STANDS, f"Height and drift over time, {dimension}D",
                 Finding(text, table_of_over_time(found)), sweep, figure, pd.DataFrame(table),
                 left_out + holes(cells, ["scene", "method"]),
                 f"Lines: in each of {over_steps.STRETCHES} intervals of steps the median height of the highest body, and the "
                 "largest distance of a body from its start." + "".join(map(verdict, judged)) + caption_of_lines(lines),
                 headline=head)
