# SPDX-License-Identifier: Zlib
"""Contact points and the fastest body over time, where a scene says how far its bodies may drift, so that they should rest
(2009 report, figures 7.4 and 7.5)."""

import math

import numpy as np
import pandas as pd

import over_steps
import ranking
from chart import Chart, Headline, Needs, holes, listing, methods, of_sweeps
from load import NOT_RUN, split
from style import ZeroLog, caption_of_lines, one_line, same, si

SECTION = "How restless is a scene that should be at rest?"
REST = 1e-9  # m/s: rounding, not motion


@of_sweeps("steadiness", 30, SECTION,
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
            made.append(_chart(context, [(where, over_steps.at_middle(mine, setting)) for where, mine in shown], left_out,
                               setting))
    return made


def at_rest(speeds):
    """{method: speed}; what is below REST rests."""
    return {method: 0.0 if v <= REST else v for method, v in speeds.items()}


def finding(where, speeds, failed, everyone):
    """Who is calmest and who most restless. Below REST all are equally calm: a rank of rounding is none."""
    speeds = at_rest(speeds)
    least, most = min(speeds.values()), max(speeds.values())
    first, last = ([m for m, v in speeds.items() if v == value] for value in (least, most))
    tail = f"; {listing(failed)} {'fails' if len(failed) == 1 else 'fail'}" if failed else ""
    if not most:
        return f"on {where} {methods(first, everyone)} come to rest (below {si(REST, 'm/s')} in the last quarter){tail}"
    if least == most:
        return f"on {where} {methods(first, everyone)} are equally restless in the last quarter ({si(most, 'm/s')}){tail}"
    calm = (f"{methods(first, everyone)} {'comes' if len(first) == 1 else 'come'} to rest (below {si(REST, 'm/s')} in the last "
            "quarter)" if not least else f"the last quarter is calmest with {methods(first, everyone)} ({si(least, 'm/s')})")
    loud = f"{methods(last, everyone)} ({si(most, 'm/s')}){tail}"
    return f"on {where} {calm}{' and' if least else '; it is'} most restless with {loud}"


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
    first = (f"{still} {'comes' if len(resting) == 1 else 'come'} to rest (below {si(REST, 'm/s')})" if resting else
             f"bodies go at {si(moving[calmest], 'm/s')} with {calmest}")
    who = "of those that finish, the fastest goes" if failed else "the fastest goes"
    last = f"; {methods(failed, everyone)} {'fails' if len(failed) == 1 else 'fail'}" if failed else ""
    return Headline(f"On {where}{at}, by the RMS of the fastest body's speed in the last quarter, {first}; {who} at "
                    f"{si(moving[worst], 'm/s')} with {worst}{last}.",
                    {**speeds, **dict.fromkeys(failed, math.nan)}, "m/s", "RMS speed of the fastest body")


def _chart(context, resting, left_out, setting):
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
            said.append(finding(scene, speeds, failed, labels))
            told.append(headline(f"{scene} in {dimension}D", speeds, failed, at))
    text = f"In {dimension}D{at} " + "; ".join(said) + "." if said else f"In {dimension}D too few runs finished to compare."
    text += ranking.tail_of(context, resting)
    table = table.drop(columns="excused").rename(columns={"restlessness": "restlessness [m/s]"})
    return Chart(f"{cells['sweep'].iloc[0]}_steadiness_{dimension}d", SECTION,
                 f"The fastest body and the contacts over time, {dimension}D", text, cells["sweep"].iloc[0], figure, table,
                 left_out + holes(cells, ["scene", "method"]),
                 f"Lines are the largest value of each of {over_steps.STRETCHES} stretches; a letter marks where a run failed. "
                 "The speeds of the "
                 f"finding are the RMS of the fastest body's over the last quarter of the steps; "
                 f"below {si(REST, 'm/s')} is rounding, and at rest." + caption_of_lines(shared),
                 headline=max(filter(None, told), key=lambda found: (found.effect, -sum(map(math.isnan, found.values.values()))),
                              default=None))
