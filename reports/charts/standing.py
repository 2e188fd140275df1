# SPDX-License-Identifier: Zlib
"""Scenes that should stand: how restless they are, what becomes of them under each method, and their height over time."""

import math

import numpy as np
import pandas as pd
from matplotlib.patches import Patch, Rectangle

import over_steps
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, of_sweeps
from load import NOT_RUN, split, varying
from sentences import clauses, does, listing, methods, plural, verb
from style import OUTCOMES, ZeroLog, caption_of_lines, grid_of_axes, legend_right, one_line, same, si
from table import quantity

RESTLESS = "How restless is a scene that should be at rest?"
REST = 1e-9  # m/s: rounding, not motion


@of_sweeps("steadiness", 30, RESTLESS,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("drift_limit", "restlessness"),
                 series=("max_speed", "points"),
                 also=f"{over_steps.ONE_COURSE}, on a scene that says how far its bodies may drift"),
           "The fastest body and the contacts over time",
           "No sweep of several methods on a scene that should be at rest is in this store.", "resolvers")
def steadiness(context, cells):
    if over_steps.elsewhere(context, cells):
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        # Scenes, each at the middle of its own setting, that say how far their bodies may drift; where none finished none said.
        said = [scene for scene in split(part, ["scene"])
                if scene["drift_limit"].notna().any() or not (scene["finished_trials"] > 0).any()]
        if said:
            shown, left_out, setting = over_steps.scenes(context, pd.concat(said))
            at_one = [(where, over_steps.at_middle(mine, setting)) for where, mine in shown]
            made.append(_steadiness_chart(context, at_one, left_out, setting))
    return made


def at_rest(speeds):
    """{method: speed}; what is below REST rests."""
    return {method: 0.0 if v <= REST else v for method, v in speeds.items()}


def finding_of_steadiness(where, speeds, failed, everyone):
    """Who is calmest and who most restless. Below REST all are equally calm: a rank of rounding is none."""
    speeds = at_rest(speeds)
    least, most = min(speeds.values()), max(speeds.values())
    first, last = ([m for m, v in speeds.items() if v == value] for value in (least, most))
    if least and least == most:
        told = f"{methods(first, everyone)} are equally restless in the last quarter ({si(most, 'm/s')})"
    elif least:
        told = (f"the last quarter is calmest with {methods(first, everyone)} ({si(least, 'm/s')}) and most restless with "
                f"{methods(last, everyone)} ({si(most, 'm/s')})")
    else:
        come = does(first, "come", everyone) if most else f"{methods(first, everyone)} come"
        told = clauses(f"{come} to rest (below {si(REST, 'm/s')} in the last quarter)",
                       most and f"it is most restless with {methods(last, everyone)} ({si(most, 'm/s')})")
    return f"on {where} {clauses(told, failed and does(failed, 'fail'))}"


def headline(where, speeds, failed=(), at=""):
    """How fast bodies go that should rest; below REST they do. Who failed is told: it has no place among the speeds. `at`: the
    setting, in words."""
    speeds = at_rest(speeds)
    resting, moving = [m for m in speeds if speeds[m] == 0], {m: v for m, v in speeds.items() if v > 0}
    if not moving:
        return None
    calmest, worst = min(moving, key=moving.get), max(moving, key=moving.get)
    everyone = [*speeds, *failed]
    still = methods(resting, everyone) if resting else ""
    first = (f"{still} {verb(len(resting), 'come')} to rest (below {si(REST, 'm/s')})" if resting else
             f"bodies go at {si(moving[calmest], 'm/s')} with {calmest}")
    who = "of those that finish, the fastest goes" if failed else "the fastest goes"
    last = f"; {does(failed, 'fail', everyone)}" if failed else ""
    return Headline(f"On {where}{at}, by the RMS of the fastest body's speed in the last quarter, {first}; {who} at "
                    f"{si(moving[worst], 'm/s')} with {worst}{last}.",
                    {**speeds, **dict.fromkeys(failed, math.nan)}, "m/s", "RMS speed of the fastest body")


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
        rows += [{"scene": scene, "method": cell["method"], "outcome": cell["outcome"], "excused": index in excused,
                  "restlessness": math.nan if cell["key"] is None else cell.get("restlessness"),
                  "contact points at the end": points[cell["method"]][-1] if len(points.get(cell["method"], [])) else math.nan}
                 for index, cell in part.iterrows()]
    axes[0][0].set_ylabel("fastest body")
    axes[1][0].set_ylabel("contact points")
    over_steps.legend(context, figure, cells, legend_width)
    table = pd.DataFrame(rows)
    said, told = [], []
    for scene, part in table.groupby("scene", sort=False):
        failed = sorted(part[~part["outcome"].isin(("ok", NOT_RUN)) & ~part["excused"]]["method"])
        part = part[(part["outcome"] == "ok") & np.isfinite(part["restlessness"].astype(float)) & ~part["excused"]]
        if len(part) > 1:
            speeds = dict(zip(part["method"], part["restlessness"].astype(float)))
            said.append(finding_of_steadiness(scene, speeds, failed, labels))
            told.append(headline(f"{scene} in {dimension}D", speeds, failed, at))
    text = f"In {dimension}D{at} " + "; ".join(said) + "." if said else f"In {dimension}D too few runs finished to compare."
    text += ranking.tail_of(context, resting)
    table = table.drop(columns="excused").rename(columns={"restlessness": "restlessness [m/s]"})
    return Chart(f"{cells['sweep'].iloc[0]}_steadiness_{dimension}d", RESTLESS,
                 f"The fastest body and the contacts over time, {dimension}D", text, cells["sweep"].iloc[0], figure, table,
                 left_out + holes(cells, ["scene", "method"]),
                 f"Lines are the largest value of each of {over_steps.STRETCHES} stretches; a letter marks where a run failed. "
                 "The speeds of the "
                 f"finding are the RMS of the fastest body's over the last quarter of the steps; "
                 f"below {si(REST, 'm/s')} is rounding, and at rest." + caption_of_lines(shared),
                 headline=max(filter(None, told), key=lambda found: (found.effect, -sum(map(math.isnan, found.values.values()))),
                              default=None))


STANDS = "What stands, and under whom?"
RESTS = "rest_since"


def _with(held, most):
    """The methods that hold as many as this one, and the verb."""
    alike = [method for method in held if held[method] == held[most]]
    return does(alike, "hold")


@of_sweeps("stability", 31, STANDS,
           Needs("world", methods=(2, math.inf), also="`report` that names it"),
           "What becomes of scenes under each method",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_stability")
def stability(context, cells):
    if "stability" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    return [_stability_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def told(cell):
    """What stands in a cell: since when all rests, or the step of the end."""
    if cell["outcome"] == "ok":
        rest = cell.get(RESTS)
        return f"rests, {rest:.1f} s" if rest is not None and math.isfinite(rest) else "ok, moves"
    return cell["outcome"] + ("" if cell["step"] != cell["step"] else f", {int(cell['step'])}")


def finding_of_stability(rows, methods):
    """Per method how much of what it was asked stands, then what each fall was."""
    said = []
    for method in methods:
        mine = [row for row in rows if row["method"] == method]
        fell = [row for row in mine if row["outcome"] != "ok"]
        said.append(f"{method} holds {len(mine) - len(fell)} of {len(mine)}" +
                    (f" (not {listing(_fallen(fell, mine))})" if 0 < len(fell) < len(mine) else ""))
    return "; ".join(said or ["no method has a rank"]) + "."


def _fallen(fell, mine):
    """Where, each as it is called; of more than two of a scene how many."""
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
    least, most = min(held, key=held.get, default=None), max(held, key=held.get, default=None)
    head = None if not held or held[least] == held[most] else Headline(
        f"Of {plural(len(places), 'scene')} in {dimension}D, each with and without what varies, {_with(held, most)} {held[most]} "
        f"and {listing([m for m in held if held[m] == held[least]])} {held[least]}.", {m: float(v) for m, v in held.items()},
        quantity="scenes that stand", larger=True)
    return Chart(identifier(f"{sweep} stability {dimension}d"), STANDS,
                 f"What becomes of scenes under each method, {dimension}D",
                 f"In {dimension}D {finding_of_stability(rows, ranked)}{ranking.tail(context, cells)}", sweep, figure,
                 pd.DataFrame(rows).drop(columns=["told", "scene"]).rename(columns={"where": "scene"}),
                 holes(cells, ["method", *axes]),
                 "Each cell is one run: since when all bodies rest, where they do until the end, or the step at which the run "
                 "ended, with its outcome. “moves”: it stands, and something is not at rest.", headline=head)


TURNS_NONE = "linear"  # the report's first position method
SEEN = 0.004  # of a panel's height: lines that are nearer everywhere are one to the eye
LOST = 0.5  # of the height at the start: what has less has fallen


@of_sweeps("over_time", 33, STANDS,
           Needs("world", methods=(2, math.inf), series=("height", "drift"), also="`report` that names it"),
           "Height and drift over time",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_positions")
def over_time(context, cells):
    if "over_time" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        made.append(_over_time_chart(context, [(where, over_steps.at_middle(mine, setting)) for where, mine in shown], left_out))
    return made


def fallen_at(heights):
    """The step from which on less than LOST of the height at the start is left; None where it is never so."""
    heights = np.asarray(heights, float)
    below = np.flatnonzero(heights < LOST * heights[0])
    return int(below[0]) if len(below) else None


def drawn_alike(ax, curves, place, of):
    """{method: the first whose curve is nowhere farther from it than SEEN of the panel}: such lines are drawn once."""
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
    """What the report says of the position method that turns no body, tried under each velocity resolver beside those that turn
    them: borne where it falls and they stand, or it falls first."""
    said, borne = [], []
    for velocity in dict.fromkeys(row["method"].partition("+")[0] for row in rows):
        fell = {row["method"].partition("+")[2]: row["fell"] for row in rows if row["method"].startswith(f"{velocity}+")}
        if TURNS_NONE not in fell or len(fell) < 2:
            continue
        mine, stand = fell[TURNS_NONE], [name for name, at in fell.items() if at is None]
        borne.append(mine is not None and all(at is None or at >= mine for at in fell.values()))
        words = [f"{name} falls at step {at}" for name, at in fell.items() if at is not None] + (
            [f"{does(stand, 'stand')}"] if stand else [])
        said.append(f"under {velocity} {listing(words)}")
    if not said:
        return ""
    word = "borne" if all(borne) else "borne in part" if any(borne) else "not borne"
    return (f" That a position method which turns no body ({TURNS_NONE}) makes piles fall is {word} by this scene: "
            f"{'; '.join(said)}.")


def finding_of_over_time(where, rows):
    fell = [row for row in rows if row["fell"] is not None]
    stand = [row for row in rows if row["fell"] is None]
    said = [f"with {row['method']} half of the height is lost at step {row['fell']}" for row in
            sorted(fell, key=lambda row: row["fell"])]
    if stand:
        tilts = [row["tilt"] for row in stand if math.isfinite(row["tilt"])]
        turn = (f", and no body is turned by more than {si(max(tilts), 'rad')} in the end" if tilts else "")
        said.append(f"with {listing(row['method'] for row in stand)} it stands{turn}")
    return f"on {where} " + "; ".join(said)


def _over_time_chart(context, shown, left_out):
    shown = [(where, part.drop_duplicates("method").sort_values("method")) for where, part in shown]
    cells = pd.concat([part for _, part in shown])
    sweep = cells["sweep"].iloc[0]
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, room = over_steps.grid(context, cells, 2, len(shown))
    rows, lines, said, judged = [], [], [], []
    for column, (where, part) in enumerate(shown):
        tracks = {name: {cell["method"]: np.asarray(found, float) for _, cell in part.iterrows() if cell["key"] is not None
                         for found in [context.store.series(cell["key"], name)] if found is not None and len(found)}
                  for name in ("height", "drift")}
        ranked = ranking.eligible(context, part).index
        mine = [{"where": where, "method": cell["method"], "outcome": cell["outcome"],
                 "tilt": float(cell.get("tilt_end", math.nan)),
                 "height": tracks["height"][cell["method"]][-1], "drift": tracks["drift"][cell["method"]][-1],
                 "fell": fallen_at(tracks["height"][cell["method"]]), "ranked": index in ranked}
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
        told = [row for row in mine if row["ranked"]]
        judged.append(told)
        none = f"on {where} {'no method has a rank' if mine else 'nothing was run'}"
        said.append(finding_of_over_time(where, told) if told else none)
    axes[0][0].set_ylabel("highest body (m)")
    axes[1][0].set_ylabel("farthest from its place")
    over_steps.legend(context, figure, cells, room)
    table = {"scene": [r["where"] for r in rows], "method": [r["method"] for r in rows], "outcome": [r["outcome"] for r in rows],
             "half of the height lost at step": [r["fell"] for r in rows],
             **quantity("height at the end", "m", [r["height"] for r in rows]),
             **quantity("largest turn at the end", "rad", [r["tilt"] for r in rows]),
             **quantity("drift at the end", "m", [r["drift"] for r in rows])}
    ranked = [r for r in rows if r["ranked"]]
    fell, stand = ([r for r in ranked if (r["fell"] is None) == up] for up in (False, True))
    head = Headline(f"On {shown[0][0]} in {dimension}D a pile falls with {listing(r['method'] for r in fell)} and stands with "
                    f"{listing(r['method'] for r in stand)}.", {r["method"]: r["height"] for r in ranked}, "m",
                    "height at the end", larger=True) if len(shown) == 1 and fell and stand else None
    return Chart(f"{sweep}_over_time_{dimension}d", STANDS, f"Height and drift over time, {dimension}D",
                 f"In {dimension}D " + "; ".join(said) + "." + "".join(map(verdict, judged))
                 + ranking.tail_of(context, shown), sweep, figure, pd.DataFrame(table),
                 left_out + holes(cells, ["scene", "method"]),
                 f"Of {over_steps.STRETCHES} stretches of the run the median height of the highest body and the largest "
                 "distance of a body from where it came." + caption_of_lines(lines), headline=head)
