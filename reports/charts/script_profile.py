# SPDX-License-Identifier: Zlib
"""A director's script step by step, with the phases of a step under the names of the 2009 report (figures 7.1, 7.2, 7.4, 7.5)."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import metrics
import noise
from chart import Chart, Headline, Needs, holes, listing, of_sweeps
from load import one_machine, split
from over_steps import stretches
from style import PALETTE, figures, grid_of_axes, legend_right, si

SECTION = "Where does the time of a step go?"
COST = "ms_per_step_median"
# The report's name of a phase, and the scope of ours that does the same.
PHASES = {"findPairs": "sec_broadphase", "findContacts": "sec_contacts", "applyForces": "sec_solver_integrate",
          "resolveVelocities": "sec_solver_velocity", "moveApart": "sec_solver_position",
          "cache": "sec_cache", "sleep": "sec_sleep"}  # the last two are ours: the report has no name for them
OTHER = "other"
COUNTS = {"bodies": "#000000", "awake": "#D55E00", "points": "#0072B2"}
# What the report says of its own runs of director script 1, on its machine.
REPORTED = {"heritage_sleeping": "The report has a peak just over 7 ms and 6.5 ms at the end without sleeping, 5.5 and 4 ms with "
            "it, and calls that about 20 %; its own numbers are 21 % at the peak and 38 % at the end.",
            "heritage_resolvers": "The report has 16 ms a step at the firework under its first resolver, against 3 ms under "
            "Catto's, and about 50 against 4 ms at the end, with bodies that never fall asleep."}


@of_sweeps("script_profile", 99, SECTION,
           Needs("world", methods=(1, 4), fixed=("model", "precision", "setting"), metrics=(COST,),
                 series=("seconds", "sec_*", "bodies", "awake", "points"), also="`report` that names it"),
           "A script under the names of 2009",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_sleeping")
def script_profile(context, cells):
    if "script_profile" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    cells, refused = one_machine(context.store, cells)
    made = []
    for part in split(cells, [name for name in ("scene", "script", "dimension") if name in cells]):
        made.append(_chart(context, part.drop_duplicates("method").sort_values("method"), refused))
    return made


def wholes(store, cell):
    """Seconds of each step, a row per timed repeat that stored them and ran as far as the first that did."""
    found = [store.series(key, "seconds") for key in cell["keys_timed"]]
    found = [values for values in found if values is not None and len(values)]
    return np.array([values for values in found if len(values) == len(found[0])])


def phases(store, cell):
    """({phase: seconds of each step}, seconds of whole steps); what is no phase of the report's is OTHER. A whole step is the
    median of the repeats. Phases are of one repeat, which stored them, and are scaled to it: what the machine did to that repeat
    alone is in none of them."""
    key, whole = cell["key_timed"], np.median(wholes(store, cell), axis=0)
    own = store.series(key, "seconds")
    found = {name: store.series(key, scope) for name, scope in PHASES.items()}
    found = {name: values for name, values in found.items() if values is not None}
    found[OTHER] = np.maximum(0, own - sum(found.values()))
    scale = np.divide(whole, own, out=np.ones_like(whole), where=own > 0)
    return {name: values * scale for name, values in found.items()}, whole


def times_of(whole, half):
    """{what: s}: before step `half`, at the peak, in the last tenth."""
    tenth = max(1, len(whole) // 10)
    return {"before": float(np.median(whole[max(0, half - tenth // 5):half])), "peak": float(np.max(stretches(whole)[1])),
            "end": float(np.median(whole[-tenth:]))}


def course(store, cell, half):
    """What is told of one run: times_of the medians, (least, most) of a repeat of each, contact points a body before step `half`,
    and who is awake."""
    runs = wholes(store, cell)
    each = [times_of(run, half) for run in runs]
    bodies, awake = (store.series(cell["key_timed"], name) for name in ("bodies", "awake"))
    points = store.series(cell["key_timed"], "points")
    before = slice(max(0, half - max(1, len(points) // 10) // 5), half)
    return {"method": cell["method"], **times_of(np.median(runs, axis=0), half), "repeats": len(runs),
            "spread": {what: (min(found[what] for found in each), max(found[what] for found in each)) for what in each[0]},
            "bodies": int(bodies[-1]), "awake": int(awake[-1]), "least": int(np.min(awake[half:])),
            "touching": float(np.median(points[before] / bodies[before]))}


def _time(run, what):
    low, high = run["spread"][what]
    return si(run[what], "s") + (f" ({si(low, 's')} to {si(high, 's')})" if run["repeats"] > 1 else "")


def finding(runs, cells, floor):
    """Numbers of each run, then the ratios of whole runs, which have repeats."""
    if not runs:
        return "no run finished with times of its phases."
    said = [f"{r['method']}: {_time(r, 'before')} a step and {figures(r['touching'], 2)} contact points a body before the "
            f"half, {_time(r, 'peak')} at the peak, {_time(r, 'end')} in the last tenth, {r['awake']} of {r['bodies']} "
            f"bodies awake in the end and at least {r['least']} in each step of the second half" for r in runs]
    by, first, told = cells.set_index("method", drop=False), runs[0]["method"], []
    for run in runs[1:]:
        ratio = noise.said(by.loc[first], by.loc[run["method"]], COST, floor)
        told.append(f"{run['method']} {ratio + ' times' if ratio[:1].isdigit() else noise.IN_WORDS.get(ratio, ratio)}")
    tail = f". By the median step of the whole run, and {first} as 1: {listing(told)}" if told else ""
    least, most = (of(run["repeats"] for run in runs) for of in (min, max))
    of = (" These times are of one repeat, where whatever else the machine did shows." if most == 1 else
          f" Each step's time is the median of {least if least == most else f'{least} to {most}'} repeats; in brackets the least "
          "and the most of one.")
    return "; ".join(said) + tail + "." + of


def _half(store, key):
    """The step at which the rain stops."""
    half = metrics.Trial(store, key).parameter("rain_until")
    return len(store.series(key, "seconds")) // 2 if math.isnan(half) else int(half)


def _chart(context, cells, refused):
    store, sweep = context.store, cells["sweep"].iloc[0]
    where = cells["scene"].iloc[0] + (f" with {cells['script'].iloc[0]}" if "script" in cells else "")
    where += f", {int(cells['dimension'].iloc[0])}D" if "dimension" in cells else ""
    figure, panels = grid_of_axes(2, len(cells), 2.3, 1.75, left=0.75, gap_x=0.35, gap_y=0.5)
    runs, rows, top, high, seen = [], [], 0.0, 1.0, {}
    for column, (_, cell) in enumerate(cells.iterrows()):
        above, below, key = panels[0][column], panels[1][column], cell["key_timed"]
        above.set_title(cell["method"] if cell["outcome"] == "ok" else f"{cell['method']} ({cell['outcome']})")
        below.set_xlabel("step")
        whole = None if key is None else store.series(key, "seconds")
        if whole is None or not len(whole):
            above.text(0.5, 0.5, f"no times: {cell['outcome']}", ha="center", va="center", transform=above.transAxes)
            continue
        (parts, whole), half = phases(store, cell), _half(store, key)
        shown = {name: stretches(values)[1] * 1e3 for name, values in parts.items()}
        above.stackplot(stretches(whole)[0], list(shown.values()), colors=[PALETTE[i] for i in map(_colour, shown)], lw=0,
                        alpha=0.85)
        seen.update(dict.fromkeys(shown))
        top = max(top, float(np.max(sum(shown.values()))))
        for name, colour in COUNTS.items():
            values = store.series(key, name)
            below.plot(*stretches(values), color=colour, lw=1.3)
            high = max(high, float(np.max(values)))
        if cell["outcome"] == "ok":  # what failed has no end to compare
            runs.append(course(store, cell, half))
            for ax in (above, below):
                ax.axvline(half, color="#777777", lw=0.8, ls=":")
        rows += [{"run": cell["method"], "phase": name, "median [s]": float(np.median(values)),
                  "median of the last tenth [s]": float(np.median(values[-max(1, len(values) // 10):])),
                  "share of the time [1]": float(np.sum(values) / max(1e-300, np.sum(whole)))}
                 for name, values in [*parts.items(), ("whole step", whole)]]
    for row, limit in zip(panels, (top, high)):
        for ax in row:
            ax.set_ylim(0, limit * 1.08 or 1)
        for ax in row[1:]:
            ax.tick_params(labelleft=False)
    panels[0][0].set_ylabel("time of a step (ms)")
    panels[1][0].set_ylabel("count")
    handles = [Patch(color=PALETTE[_colour(name)], alpha=0.85, label=name) for name in reversed(seen)]
    handles += [Line2D([], [], color=colour, label={"points": "contact points"}.get(name, name)) for name, colour in
                COUNTS.items()]
    legend_right(figure, handles, 1.75)
    floor = noise.floor_of(context, sweep, COST)
    ends = {run["method"]: run["end"] for run in runs}
    told = None
    if len(ends) > 1:
        slow, fast = max(ends, key=ends.get), min(ends, key=ends.get)
        awake = {run["method"]: run["awake"] for run in runs}
        told = Headline(f"At the end of {where} a step takes {si(ends[slow], 's')} with {slow} ({awake[slow]} bodies awake) and "
                        f"{si(ends[fast], 's')} with {fast} ({awake[fast]}).", ends, "s", "time per step at the end")
    return Chart(f"{sweep}_script_profile", SECTION, f"A script under the names of 2009: {sweep}, {where}",
                 f"On {where} " + finding(runs, cells, floor), sweep, figure, pd.DataFrame(rows),
                 refused + holes(cells, ["scene", "method"]),
                 "Medians of stretches of the run. Their height is the median of the repeats, what is stacked in it the shares "
                 "of the one that stored its phases; dotted is the half, where the rain stops and the firework goes off. "
                 f"{', '.join(f'{name} is {scope[4:]}' for name, scope in PHASES.items())} of ours; {OTHER} is the "
                 f"rest. Bodies are counted with ground and walls. {REPORTED.get(sweep, '')} " + noise.rule(floor), headline=told)


def _colour(phase):
    return [*PHASES, OTHER].index(phase) if phase != OTHER else 11
