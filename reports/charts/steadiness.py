# SPDX-License-Identifier: Zlib
"""Contact points and the fastest body over time, where a scene says how far its bodies may drift, so that they should rest
(2009 report, figures 7.4 and 7.5)."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import over_steps
from chart import Chart, Headline, Needs, describe, holes, listing, methods
from load import NOT_RUN, split, varying
from style import HALO, ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, one_line, same, si

PLACE = 30
SECTION = "How restless is a scene that should be at rest?"
NEEDS = Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("drift_limit", "jitter"),
              series=("max_speed", "points"), also=f"{over_steps.ONE_COURSE}, on a scene that says how far its bodies may drift")
ABSENT = Chart("steadiness", SECTION, "The fastest body and the contacts over time",
               "No sweep of several methods on a scene that should be at rest is in this store.", "resolvers")
PANELS = 3  # side by side
MARKS = 4  # on a line
REST = 1e-9  # m/s: rounding, not motion


def of_sweep(context, cells):
    if over_steps.elsewhere(context, cells):
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        setting = next(iter(context.settings(part)), None)
        if setting:  # methods are compared at one setting, the middle one
            part = over_steps.at_middle(part, setting)
        at = over_steps.setting_of(part, setting)
        resting = []
        for scene in split(part, ["scene"]):
            names = ["scene", *varying(context.store, scene, ("dimension", setting))]
            resting += [(describe(equal.iloc[0], names), equal) for equal in split(scene, names)
                        if equal["drift_limit"].notna().any() or not (equal["finished_trials"] > 0).any()]
        if resting:
            made.append(_steady_chart(context, resting, at))
    return made


def envelope(values, count=150):
    """The largest value of each of `count` stretches, and the step at which each begins."""
    edges = np.unique(np.linspace(0, len(values), min(count, len(values)) + 1).astype(int))
    return edges[:-1], np.array([np.max(values[a:b]) for a, b in zip(edges[:-1], edges[1:])])


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


def _steady_chart(context, resting, at):
    left_out = [where for where, _ in resting[PANELS:]]
    resting = resting[:PANELS]
    cells = pd.concat([part for _, part in resting])
    looks, dimension = context.looks(cells), int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    legend_width = legend_room(map(context.name, cells["method"].unique()), 2.0)
    figure, axes = grid_of_axes(2, len(resting), 2.2, legend_width, left=1.0, gap_x=0.8, gap_y=0.45)
    labels = sorted(cells["method"].unique())
    rows, shared = [], []
    for column, (scene, part) in enumerate(resting):
        part = part.drop_duplicates("method")
        tracks = {}
        for _, cell in part.iterrows():
            if cell["key"] is None:
                rows.append({"scene": scene, "method": cell["method"], "outcome": cell["outcome"], "restlessness": math.nan,
                             "contact points at the end": math.nan})
            else:
                tracks[cell["method"]] = (cell, context.store.series(cell["key"], "max_speed"),
                                          context.store.series(cell["key"], "points"))
        speeds = [v for _, s, _ in tracks.values() if s is not None for v in envelope(s)[1] if math.isfinite(v)]
        scale = ZeroLog(axes[0][column], "y", speeds, "m/s", failures=False, floor=REST)
        firsts = [same({m: [] if tracks[m][which] is None else tracks[m][which] for m in sorted(tracks)}) for which in (1, 2)]
        spots = [], []
        for order, (method, (cell, speed, points)) in enumerate(sorted(tracks.items())):
            look = {**looks(method), "lw": 1.2}
            for row, values, place in ((0, speed, scale.place), (1, points, float)):
                if values is None or not len(values) or firsts[row][method] != method:
                    continue
                step, high = envelope(np.where(np.isfinite(values), values, np.nan))
                # Few markers, and not all at the same steps: members of a family have one colour.
                every = max(1, len(step) // MARKS)
                axes[row][column].plot(step, [place(v) if math.isfinite(v) else math.nan for v in high], **look,
                                       markevery=(order * every // max(1, len(tracks)), every))
                if cell["outcome"] != "ok":
                    last = [v for v in high if math.isfinite(v)]
                    spots[row].append((len(values), place(last[-1] if last else 0), cell["outcome"], look["color"]))
            rows.append({"scene": scene, "method": method, "outcome": cell["outcome"], "restlessness": cell.get("jitter"),
                         "contact points at the end": math.nan if points is None or not len(points) else points[-1]})
        axes[0][column].set_title(f"{scene}, {dimension}D")
        axes[1][column].set_xlabel("step")
        axes[1][column].set_ylim(bottom=0)
        for row in (0, 1):
            fallen(axes[row][column], spots[row], clip_on=False, path_effects=HALO)
            shared.append((f"On {scene}, {('fastest body', 'contact points')[row]}",
                           one_line(axes[row][column], firsts[row], lambda group: methods(group, labels))))
    axes[0][0].set_ylabel("fastest body")
    axes[1][0].set_ylabel("contact points")
    legend_right(figure, [Line2D([], [], label=context.name(m), **looks(m)) for m in labels], legend_width)
    table = pd.DataFrame(rows)
    said, told = [], []
    for scene, part in table.groupby("scene", sort=False):
        failed = sorted(part[~part["outcome"].isin(("ok", NOT_RUN))]["method"])
        part = part[(part["outcome"] == "ok") & np.isfinite(part["restlessness"].astype(float))]
        if len(part) > 1:
            speeds = dict(zip(part["method"], part["restlessness"].astype(float)))
            said.append(finding(scene, speeds, failed, labels))
            told.append(headline(f"{scene} in {dimension}D", speeds, failed, at))
    text = f"In {dimension}D{at} " + "; ".join(said) + "." if said else f"In {dimension}D too few runs finished to compare."
    table = table.rename(columns={"restlessness": "restlessness [m/s]"})
    gaps = [f"{where}: not drawn, there is room for {PANELS}" for where in left_out]
    return Chart(f"{cells['sweep'].iloc[0]}_steadiness_{dimension}d", SECTION,
                 f"The fastest body and the contacts over time, {dimension}D", text, cells["sweep"].iloc[0], figure, table,
                 gaps + holes(cells, ["scene", "method"]),
                 "Lines are the largest value of each of 150 stretches; a letter marks where a run failed. The speeds of the "
                 f"finding are the RMS of the fastest body's over the last quarter of the steps; "
                 f"below {si(REST, 'm/s')} is rounding, and at rest." + caption_of_lines(shared),
                 headline=max(filter(None, told), key=lambda found: (found.effect, -sum(map(math.isnan, found.values.values()))),
                              default=None))
