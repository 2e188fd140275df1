# SPDX-License-Identifier: Zlib
"""Micro-benchmarks (Google Benchmark): one table of times per stage and dimension, coloured by distance from the best."""

import math
from collections import OrderedDict

import numpy as np
import pandas as pd

from chart import Chart, Headline, listing, of_store
from style import WIDTH, plt, si, times

SECTION = "What do single calls cost?"
PER_PANEL = 12  # columns, so that times stay readable
SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


@of_store("micro", 110, SECTION,
          "Micro-benchmarks", "No micro-benchmark was imported into this store.", made_by="import-benchmark bench.json")
def micro(context):
    """Of every import the newest result of a benchmark counts; names are stage/dimension/algorithm/case.../size."""
    groups, machines, found = OrderedDict(), [], {}
    for imported, data in context.store.benchmarks():
        machine = data.get("context", {})
        machines.append(f"{imported}: {machine.get('num_cpus', '?')} CPUs at {machine.get('mhz_per_cpu', '?')} MHz, load "
                        f"{', '.join(f'{x:.1f}' for x in machine.get('load_avg', [])) or 'not recorded'}")
        fresh = {}
        for run in data.get("benchmarks", []):
            if run.get("run_type", "iteration") == "iteration" or run.get("aggregate_name") == "median":
                fresh.setdefault(run.get("run_name", run["name"]), []).append(run)
        found.update(fresh)
    for name, runs in found.items():
        stage, algorithm, case = parts(name)
        groups.setdefault(stage, OrderedDict()).setdefault(algorithm, OrderedDict())[case] = runs
    return [_chart(context, stage, table, machines) for stage, table in groups.items()]


def parts(name):
    """(stage with dimension, algorithm, case) of a benchmark's name; what is not ours becomes stage and case."""
    words = [w for w in name.removeprefix("BM_").split("/") if w not in ("manual_time", "real_time")]
    if len(words) > 2 and words[1] in ("2D", "3D"):
        return f"{words[0]} {words[1]}", words[2], "/".join(words[3:]) or "call"
    return words[0], words[1] if len(words) > 1 else words[0], "/".join(words[2:]) or "call"


def seconds(runs):
    """(median time of one iteration, why it failed). Where the benchmark times itself its own clock counts."""
    medians = [run for run in runs if run.get("aggregate_name") == "median"] or runs
    errors = [run.get("error_message", "failed") for run in medians if run.get("error_occurred")]
    if errors:
        return math.nan, errors[0]
    clock = "real_time" if "manual_time" in medians[0]["name"] else "cpu_time"
    return float(np.median([run[clock] * SECONDS[run.get("time_unit", "ns")] for run in medians])), ""


def finding(stage, values):
    best = values.min(axis=0)
    wins = {name: int(sum(values.loc[name] == best)) for name in values.index}
    first = [name for name in wins if wins[name] == max(wins.values())]
    cases = int(best.notna().sum())
    if not cases:
        return f"No benchmark of {stage} finished."
    ratio = (values / best).max().max()
    case = (values / best).max().idxmax()
    worst = (values[case] / best[case]).idxmax()
    return (f"Of {stage} the fastest in most cases {'is' if len(first) == 1 else 'are'} {listing(first)} "
            f"({max(wins.values())} of {cases}); the widest gap is {times(ratio)} times, {worst} on {case}.")


def headline(stage, values):
    """The call on which the algorithms differ most."""
    gap = (values.max(axis=0) / values.min(axis=0)).dropna()
    if not len(gap):
        return None
    case = gap.idxmax()
    found = values[case].dropna().to_dict()
    first, last = min(found, key=found.get), max(found, key=found.get)
    return Headline(f"A single call of {stage} on {case} takes {first} {si(found[first], 's')} and {last} "
                    f"{si(found[last], 's')}.", found, "s", "time of one call")


def _chart(context, stage, table, machines):
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
    # As wide as its columns need: few of them in a wide picture would leave it half empty.
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
    return Chart("micro_" + stage.replace(" ", "_").lower(), SECTION, f"Micro-benchmark: {stage}", finding(stage, values),
                 "", figure, shown, [f"{name} on {case}: {error}" for (name, case), error in errors.items()],
                 "Median time of a call. White is the fastest of its column, dark ten times slower or more; grey was not "
                 "measured. Imported " + "; ".join(machines) + ".", headline=headline(stage, values))


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
