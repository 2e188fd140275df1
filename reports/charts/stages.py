# SPDX-License-Identifier: Zlib
"""The time of each stage of a step over the run of a script (2009 report, figures 7.1 and 7.2), and micro-benchmarks."""

import math
from collections import OrderedDict

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import metrics
import noise
from chart import Chart, Headline, Needs, describe, holes, identifier, of_store, of_sweeps
from finding import Finding, cut, ends, fits, told
from load import one_machine, split, varying
from over_steps import stretches
from sentences import plural, some, verb
from style import PALETTE, WIDTH, grid_of_axes, legend_right, plt, si, times

WHERE = "Where does the time of a step go?"
COST = "ms_per_step_median"
# Stage times are stacked from the bottom in the order of World::step; the numbers are colours.
STAGES = {"boxes": 4, "broadphase": 0, "cache": 9, "contacts": 1, "listeners": 10, "sleep": 3, "solver": 2, "other": 11}
COUNTS = OrderedDict([("bodies", "#000000"), ("awake", "#D55E00"), ("points", "#0072B2")])
STRETCHES = 240


@of_sweeps("stages", 100, WHERE,
           Needs("world", methods=(1, 2), fixed=("model", "precision", "setting"), metrics=(COST,),
                 series=("seconds", "sec_solver", "bodies", "awake", "points")),
           "Time of each stage", "This store has no timed sweep of at most two methods.", "stages")
def stages(context, cells):
    axes = context.store.method_axes(cells["sweep"].iloc[0])
    side = None if cells["method"].nunique() < 2 else axes[0] if len(axes) == 1 else "method"
    others = varying(context.store, cells)
    made = []
    for part in split(cells, others):
        made.append(_timeline(context, part, side, [c for c in ("scene", "dimension") if c in part] +
                              [c for c in others if c not in ("scene", "dimension")]))
    return made


def medians(values, edges):
    """The median of each stretch. Stage times are wall-clock times: one pre-empted step would spoil a mean."""
    return np.array([np.median(values[a:b]) for a, b in zip(edges[:-1], edges[1:])])


def edges_of(steps):
    return np.unique(np.linspace(0, steps, min(STRETCHES, steps) + 1).astype(int))


def stage_times(store, key):
    """(whole step, {stage: seconds per step}); phases inside a stage ("solver_iterate") belong to their stage."""
    total = store.series(key, "seconds")
    names = [name for name in store.series_names(key) if name.startswith("sec_")]
    order = {f"sec_{stage}": place for place, stage in enumerate(STAGES)}
    stages = OrderedDict()
    for name in sorted(names, key=lambda n: order.get(n, len(order))):
        if not any(name.startswith(other + mark) for other in names for mark in "._"):
            stages[name[4:]] = store.series(key, name)
    if total is None and stages:
        total = np.sum(list(stages.values()), axis=0)
    return total, stages


def stage_colour(name):
    if name in STAGES:
        return PALETTE[STAGES[name]]
    return PALETTE[(3, 4, 5, 6, 7)[sum(map(ord, name)) % 5]]


def _timeline(context, cells, side, axes):
    where = describe(cells.iloc[0], axes)
    cells = cells.sort_values(side) if side else cells
    legend_width = 1.6
    figure, panels = grid_of_axes(2, len(cells), 2.3, legend_width, left=0.75, gap_x=0.35, gap_y=0.5)
    rows, seen, top, high, peaks, finished = [], OrderedDict(), 0.0, 1.0, [], set()
    for column, (_, cell) in enumerate(cells.iterrows()):
        above, below = panels[0][column], panels[1][column]
        name = f"{side}: {cell[side]}" if side else where
        above.set_title(name if cell["outcome"] == "ok" else f"{name} ({cell['outcome']})")
        below.set_xlabel("step")
        total, stages = (None, {}) if cell["key_timed"] is None else stage_times(context.store, cell["key_timed"])
        if total is None or not len(total):
            above.text(0.5, 0.5, f"no stage times: {cell['outcome']}\n{cell['reason']}", ha="center", va="center",
                       transform=above.transAxes, color="#8A3B12")
        else:
            edges = edges_of(len(total))
            at = edges[:-1]
            shown = {k: medians(v, edges) * 1e3 for k, v in stages.items()}
            staged = np.sum(list(shown.values()), axis=0) if shown else 0
            whole = np.maximum(medians(total, edges) * 1e3, staged)
            shown["other"] = whole - staged
            above.stackplot(at, list(shown.values()), colors=[stage_colour(k) for k in shown], lw=0, alpha=0.85)
            seen.update(dict.fromkeys(shown))
            top = max(top, float(np.max(whole)))
            last = len(whole) - max(1, len(whole) // 10)
            if cell["outcome"] == "ok":  # a failed run has no end to compare
                finished.add(name)
                peaks.append((str(cell[side]) if side else where, float(np.max(whole)), float(np.mean(whole[last:]))))
            for k, v in list(shown.items()) + [("whole step", whole)]:
                rows.append({"run": name, "stage": k, "mean [s]": float(np.mean(v)) / 1e3, "largest [s]": float(np.max(v)) / 1e3,
                             "mean of the last tenth [s]": float(np.mean(v[last:])) / 1e3,
                             "share of the time [1]": float(np.sum(v)) / max(1e-300, float(np.sum(whole)))})
        for count, colour in COUNTS.items():
            values = None
            for key in (cell["key"], cell["key_timed"]):
                if values is None and key is not None:
                    values = context.store.series(key, count)
            if values is not None and len(values):
                edges = edges_of(len(values))
                below.plot(edges[:-1], medians(values, edges), color=colour, lw=1.3)
                high = max(high, float(np.max(values)))
    for ax in panels[0]:
        ax.set_ylim(0, top * 1.08 or 1)
    for ax in panels[1]:
        ax.set_ylim(0, high * 1.08)
    for row in panels:
        for ax in row[1:]:
            ax.tick_params(labelleft=False)
    panels[0][0].set_ylabel("time of a step (ms)")
    panels[1][0].set_ylabel("count")
    handles = [Patch(color=stage_colour(k), alpha=0.85, label=k) for k in reversed(seen)]
    handles += [Line2D([], [], color=colour, label={"points": "contact points"}.get(count, count))
                for count, colour in COUNTS.items()]
    legend_right(figure, handles, legend_width)
    return Chart(identifier(f"{cells['sweep'].iloc[0]} timeline {where}"), WHERE,
                 f"Time of each stage and counts over the script: {where}", _finding(where, side, peaks, rows),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(rows), holes(cells, [*axes, side] if side else axes),
                 f"Lower is better. Times are medians of {STRETCHES} stretches of the run, stacked; a single slow step does not "
                 "show. Each panel is one run. The store does not tell how far its repeats differ, so no ratio of two runs "
                 "is given.",
                 headline=_headline(where, [r for r in rows if r["run"] in finished]))


def _headline(where, rows):
    """The stages of the first finished run."""
    parts = {r["stage"]: r["mean [s]"] for r in rows if r["run"] == rows[0]["run"] and r["stage"] != "whole step"}
    if len(parts) < 2:
        return None
    most = max(parts, key=parts.get)
    share = 100 * parts[most] / sum(parts.values())
    run = "" if rows[0]["run"] == where else f" ({rows[0]['run']})"
    return Headline(f"On {where}{run} the stage {most} takes {share:.0f} % of the time of a step.", parts, "s",
                    "time per step")


def _finding(where, side, peaks, rows):
    """A row per run. No ratio of two runs: the store does not tell how far the end of a run is from that of its repeats."""
    if not peaks:
        return Finding(f"No run of {where} finished with stage times.")
    shares, table = [r for r in rows if r["stage"] not in ("whole step", "other")], []
    for name, peak, end in peaks:
        mine = [r for r in shares if r["run"] in (name, f"{side}: {name}")]
        most = max(mine, key=lambda r: r["share of the time [1]"], default={})
        table.append({side or "run": name, "largest step [s]": peak / 1e3, "step of the last tenth [s]": end / 1e3,
                      "slowest stage": most.get("stage", ""),
                      "share of the time [1]": most.get("share of the time [1]", math.nan)})
    most = max(shares, key=lambda r: r["share of the time [1]"], default=None)
    head = (f"On {where} the slowest stage is {most['stage']}, with {100 * most['share of the time [1]']:.1f} % of the time"
            f"{' (' + most['run'] + ')' if side else ''}." if most else f"On {where} no stage has a time.")
    return Finding(head, cut(pd.DataFrame(table)))


# The 2009 report's name of a phase, and LPC's timing scope of the same work.
PHASES = {"findPairs": "sec_broadphase", "findContacts": "sec_contacts", "applyForces": "sec_solver_integrate",
          "resolveVelocities": "sec_solver_velocity", "moveApart": "sec_solver_position",
          "cache": "sec_cache", "sleep": "sec_sleep"}  # the report has no name for the last two
OTHER = "other"
# What the 2009 report says of its own runs of director script 1, on its machine.
REPORTED = {"heritage_sleeping": "The 2009 report: just over 7 ms at the peak and 6.5 ms at the end without sleeping, 5.5 and 4 "
            "ms with it. It calls this about 20 %; its numbers give 21 % at the peak and 38 % at the end.",
            "heritage_resolvers": "The 2009 report: 16 ms a step at the firework with its first resolver against 3 ms with "
            "Catto's; about 50 against 4 ms at the end, with bodies that never fall asleep."}


@of_sweeps("script_profile", 99, WHERE,
           Needs("world", methods=(1, 4), fixed=("model", "precision", "setting"), metrics=(COST,),
                 series=("seconds", "sec_*", "bodies", "awake", "points"), also="`report` that names it"),
           "Phases of the 2009 report",
           "This store has no sweep that lists this chart; experiments/run heritage makes one.", "heritage_sleeping")
def script_profile(context, cells):
    if "script_profile" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    cells, refused = one_machine(context.store, cells)
    made = []
    for part in split(cells, [name for name in ("scene", "script", "dimension") if name in cells]):
        made.append(_profile_chart(context, part.drop_duplicates("method").sort_values("method"), refused))
    return made


def wholes(store, cell):
    """Seconds of each step, a row per timed repeat that stored times and has as many steps as the first of these."""
    found = [store.series(key, "seconds") for key in cell["keys_timed"]]
    found = [values for values in found if values is not None and len(values)]
    return np.array([values for values in found if len(values) == len(found[0])])


def phases(store, cell):
    """({phase: seconds of each step}, seconds of whole steps); the rest of a step is OTHER. A whole step is the median of the
    repeats. One repeat stored the phases: they are scaled to the median, so that a disturbance of that repeat does not show."""
    key, whole = cell["key_timed"], np.median(wholes(store, cell), axis=0)
    own = store.series(key, "seconds")
    found = {name: store.series(key, scope) for name, scope in PHASES.items()}
    found = {name: values for name, values in found.items() if values is not None}
    found[OTHER] = np.maximum(0, own - sum(found.values()))
    scale = np.divide(whole, own, out=np.ones_like(whole), where=own > 0)
    return {name: values * scale for name, values in found.items()}, whole


def times_of(whole, half):
    """{place: seconds}: before step `half`, at the peak, in the last tenth."""
    tenth = max(1, len(whole) // 10)
    return {"before": float(np.median(whole[max(0, half - tenth // 5):half])), "peak": float(np.max(stretches(whole)[1])),
            "end": float(np.median(whole[-tenth:]))}


def course(store, cell, half):
    """The numbers of one run: times_of its medians and their range over the repeats, contact points per body before step `half`,
    and the number of awake bodies."""
    runs = wholes(store, cell)
    each = [times_of(run, half) for run in runs]
    bodies, awake = (store.series(cell["key_timed"], name) for name in ("bodies", "awake"))
    points = store.series(cell["key_timed"], "points")
    before = slice(max(0, half - max(1, len(points) // 10) // 5), half)
    return {"method": cell["method"], **times_of(np.median(runs, axis=0), half), "repeats": len(runs),
            "spread": {what: (min(found[what] for found in each), max(found[what] for found in each)) for what in each[0]},
            "bodies": int(bodies[-1]), "awake": int(awake[-1]), "least": int(np.min(awake[half:])),
            "touching": float(np.median(points[before] / bodies[before]))}


def finding_of_profile(where, runs, cells, floor):
    """A row per run; its ratio is that of the median step of the whole run against the first run, which has repeats."""
    if not runs:
        return Finding(f"On {where} no run finished with times of its phases.")
    by, rows = cells.set_index("method", drop=False), []
    for run in runs:
        word = noise.said(by.loc[runs[0]["method"]], by.loc[run["method"]], COST, floor)
        row = {"run": run["method"]}
        for what, title in (("before", "before the half"), ("peak", "peak"), ("end", "last tenth")):
            row[f"{title} [s]"] = run[what]
            if run["repeats"] > 1:
                row[f"range, {title}"] = ends(*run["spread"][what], "s")
        row |= {"median step over the first run's": 1.0 if run is runs[0] else told(word), "contact points per body "
                                                                                           "[1]": run["touching"],
                "awake at the end": f"{run['awake']} of {run['bodies']}", "awake in the second half, least [1]": run["least"],
                "repeats [1]": run["repeats"]}
        rows.append(row)
    slow, fast = (of(runs, key=lambda run: run["end"]) for of in (max, min))
    head = f"At the end of {where} a step takes {si(slow['end'], 's')}"
    long, short = (f"{head} with {slow['method']} ({slow['awake']} bodies awake)", f"{head} with {slow['awake']} bodies awake")
    if len(runs) > 1:
        long += f" and {si(fast['end'], 's')} with {fast['method']} ({fast['awake']})"
        short += f", and {si(fast['end'], 's')} with {fast['awake']}"
    return Finding(fits(f"{long}.", f"{short}."), cut(pd.DataFrame(rows)))


def _half(store, key):
    """The step at which the script's rain stops."""
    half = metrics.Trial(store, key).parameter("rain_until")
    return len(store.series(key, "seconds")) // 2 if math.isnan(half) else int(half)


def _profile_chart(context, cells, refused):
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
        if cell["outcome"] == "ok":  # a failed run has no end to compare
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
    last = {run["method"]: run["end"] for run in runs}
    finding = finding_of_profile(where, runs, cells, floor)
    return Chart(f"{sweep}_script_profile", WHERE, f"Phases of the 2009 report: {sweep}, {where}", finding, sweep, figure,
                 pd.DataFrame(rows), refused + holes(cells, ["scene", "method"]),
                 "Lower is better. Times are medians of stretches of the run; the height is the median of the repeats, and one "
                 "repeat gives the shares of the phases. At the dotted half the rain stops and the firework goes off. In LPC "
                 f"{', '.join(f'{name} is {scope[4:]}' for name, scope in PHASES.items())}; {OTHER} is the rest. Bodies include "
                 f"ground and walls. {REPORTED.get(sweep, '')} {noise.rule(floor)}",
                 headline=Headline("", last, "s", "time per step at the end") if len(last) > 1 else None)


def _colour(phase):
    return [*PHASES, OTHER].index(phase) if phase != OTHER else 11


SINGLE = "What does a single call cost?"
PER_PANEL = 12  # columns, so that times stay readable
SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


@of_store("micro", 110, SINGLE,
          "Micro-benchmarks", "This store has no imported micro-benchmark.", made_by="import-benchmark bench.json")
def micro(context):
    """One chart per stage. The newest result of each benchmark counts. Names are stage/dimension/algorithm/case.../size."""
    groups, machines, found, faults = OrderedDict(), [], {}, []
    for imported, data in context.store.benchmarks():
        machine, faults = data["context"], faults + data["faults"]
        machines.append(f"{imported}: {machine.get('num_cpus', '?')} CPUs at {machine.get('mhz_per_cpu', '?')} MHz, load "
                        f"{', '.join(f'{x:.1f}' for x in machine.get('load_avg', [])) or 'not recorded'}")
        fresh = {}
        for run in data["benchmarks"]:
            if run.get("run_type", "iteration") == "iteration" or run.get("aggregate_name") == "median":
                fresh.setdefault(run.get("run_name", run["name"]), []).append(run)
        found.update(fresh)
    for name, runs in found.items():
        stage, algorithm, case = parts(name)
        groups.setdefault(stage, OrderedDict()).setdefault(algorithm, OrderedDict())[case] = runs
    charts = [_micro_chart(context, stage, table, machines) for stage, table in groups.items()]
    if faults and not charts:
        charts = [Chart("micro", SINGLE, "Micro-benchmarks", "No imported benchmark can be drawn.", "")]
    for chart in charts:
        chart.holes += faults
    return charts


def parts(name):
    """(stage with dimension, algorithm, case) of a benchmark's name; other names become stage and case."""
    words = [w for w in name.removeprefix("BM_").split("/") if w not in ("manual_time", "real_time")]
    if len(words) > 2 and words[1] in ("2D", "3D"):
        return f"{words[0]} {words[1]}", words[2], "/".join(words[3:]) or "call"
    return words[0], words[1] if len(words) > 1 else words[0], "/".join(words[2:]) or "call"


def seconds(runs):
    """(median time of one iteration, error). A benchmark with manual times counts by these."""
    medians = [run for run in runs if run.get("aggregate_name") == "median"] or runs
    errors = [run.get("error_message", "failed") for run in medians if run.get("error_occurred")]
    if errors:
        return math.nan, errors[0]
    clock = "real_time" if "manual_time" in medians[0]["name"] else "cpu_time"
    return float(np.median([run[clock] * SECONDS[run.get("time_unit", "ns")] for run in medians])), ""


def finding_of_micro(stage, values):
    """A row per algorithm: on how many calls it is the fastest, and the largest ratio to the fastest."""
    best = values.min(axis=0)
    cases, ratios = int(best.notna().sum()), values / best
    if not cases:
        return Finding(f"No benchmark of {stage} finished.")
    wins = {name: int(sum(values.loc[name] == best)) for name in values.index}
    first = [name for name in wins if wins[name] == max(wins.values())]
    rows = [{"algorithm": name, "fastest on": f"{wins[name]} of {cases}",
             "largest time over the fastest [1]": ratios.loc[name].max(),
             "on": ratios.loc[name].idxmax() if ratios.loc[name].notna().any() else "",
             "outcome": f"no time on {missing}" if (missing := int(values.loc[name].isna().sum())) else ""}
            for name in sorted(wins, key=lambda name: (-wins[name], name))]
    return Finding(f"{some(first)} {verb(len(first), 'are')} the fastest {stage} on {max(wins.values())} of "
                   f"{plural(cases, 'call')}; the largest ratio is {times(ratios.max().max())}.", cut(pd.DataFrame(rows)))


def headline(stage, values):
    """The call with the largest ratio between two algorithms."""
    gap = (values.max(axis=0) / values.min(axis=0)).dropna()
    if not len(gap):
        return None
    case = gap.idxmax()
    found = values[case].dropna().to_dict()
    first, last = min(found, key=found.get), max(found, key=found.get)
    return Headline(f"A single call of {stage} on {case} takes {si(found[first], 's')} with {first}, {si(found[last], 's')} with "
                    f"{last}.", found, "s", "time of one call")


def _micro_chart(context, stage, table, machines):
    cases = list(OrderedDict.fromkeys(case for runs in table.values() for case in runs))
    names = sorted(table)
    values = pd.DataFrame(math.nan, index=names, columns=cases)
    errors = {}
    for name in names:
        for case, runs in table[name].items():
            values.loc[name, case], error = seconds(runs)
            if error:
                errors[(name, case)] = error
    panels = math.ceil(len(cases) / PER_PANEL)
    columns = math.ceil(len(cases) / panels)
    row, head, foot = 0.25, 0.1, 0.35 + 0.045 * max(map(len, cases))
    height = panels * (len(names) * row + head + foot)
    # The width follows the number of columns, so that the picture has no empty half.
    left = max(min(4.2, 0.4 + 0.072 * max(len(context.name(name)) for name in names)),
               0.1 + 0.065 * max(map(len, cases[::columns])))
    width = min(WIDTH, left + 0.78 * columns + 0.2)
    figure, axes = plt.subplots(panels, 1, figsize=(width, height), squeeze=False)
    figure.subplots_adjust(left=left / width, right=1 - 0.2 / width, top=1 - head / height, bottom=foot / height,
                           hspace=(head + foot) / (len(names) * row))
    best = values.min(axis=0)
    for panel in range(panels):
        _panel(context, axes[panel][0], values, best, errors, cases[panel * columns:(panel + 1) * columns], columns)
    shown = values.add_suffix(" [s]").rename_axis("algorithm").reset_index()
    return Chart("micro_" + stage.replace(" ", "_").lower(), SINGLE, f"Micro-benchmark: {stage}", finding_of_micro(stage, values),
                 "", figure, shown, [f"{name} on {case}: {error}" for (name, case), error in errors.items()],
                 "Median time of a call. White: fastest of its column; dark: ten times slower or more; grey: not measured. "
                 "Imported "
                 + "; ".join(machines) + ".", headline=headline(stage, values))


def _panel(context, ax, values, best, errors, cases, columns):
    for y, name in enumerate(values.index):
        for x, case in enumerate(cases):
            value = values.loc[name, case]
            if math.isfinite(value):
                share = min(1.0, math.log10(value / best[case])) if value > 0 and best[case] > 0 else 0.0
                colour, ink, text = plt.cm.Blues(0.75 * share), "white" if share > 0.75 else "black", si(value, "s")
            elif (name, case) in errors:
                colour, ink, text = "#D55E00", "white", "failed"
            else:
                colour, ink, text = "#EEEEEE", "black", ""
            ax.add_patch(plt.Rectangle((x - 0.49, y - 0.46), 0.98, 0.92, facecolor=colour, lw=0))
            ax.text(x, y, text, ha="center", va="center", fontsize=7.5, color=ink)
    ax.set_xlim(-0.5, columns - 0.5)
    ax.set_ylim(len(values) - 0.5, -0.5)
    ax.set_xticks(range(len(cases)))
    ax.set_xticklabels(cases, rotation=25, ha="right", fontsize=8)
    ax.set_yticks(range(len(values)))
    ax.set_yticklabels([context.name(name) for name in values.index])
    ax.grid(False)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
