# SPDX-License-Identifier: Zlib
"""The page of `lpc needs`: what each switch of a scene's model costs and changes. Rows and rules are those of the table that
`lpc needs` prints (experiments/runner/needs.cpp). Each model is compared with the scene's own, seed by seed."""

import math
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import noise
from chart import Chart, Headline, of_store
from finding import Finding, cut, ends
from sentences import listing, plural
from style import ZeroLog, grid_of_axes, legend_right, letter, si
from table import quantity

SECTION = "What does this scene need of its model?"
OWN, AGAIN, SEED = "minimal", "minimal, again", "another seed"
SWITCHED = {"cache": "cache", "continuous": "continuous", "sleeping": "sleep"}  # features that are one stage each
COST, ROWS = "ms_per_step_median", "work_multiply_adds"
WITHIN, UNKNOWN, EQUAL = "time within the noise", "too few seeds to measure the noise", "equal work counts"
IDLE = "nothing to measure"
TIME, FARTHEST = "time over that of minimal [1]", "distance of final positions, farthest [m]"  # columns
INK, FAR = "#0072B2", "#D55E00"


@dataclass
class Model:
    """The results of one model, seed by seed against the scene's own model with the same seed."""
    name: str
    time: list = field(default_factory=list)  # time and multiply-adds per step, over those of the scene's own model
    rows: list = field(default_factory=list)
    same_work: bool = True
    idle: str = ""  # "sleep=none": the stage that its switch changes does nothing
    median: list = field(default_factory=list)  # over the bodies: distance of final positions from the own model's (m)
    largest: list = field(default_factory=list)
    trials: int = 0
    failures: list = field(default_factory=list)  # (outcome, reason)


@dataclass
class Seen:
    models: list  # the scene's own first
    seeds: int = 0
    failures: list = field(default_factory=list)  # of the scene's own model; seeds that fail are not compared
    median: list = field(default_factory=list)  # distance of final positions under another seed (m)
    largest: list = field(default_factory=list)
    cost: float = math.nan  # of the scene's own model (ms per step)


@of_store("needs", 49, SECTION,
          "Needs of a model", "This store has no result of lpc needs.", made_by="needs pyramid")
def needs(context):
    return [_chart(context, name) for name in context.store.sweeps() if "needs" in context.store.sweep(name).report]


def read(store, sweep):
    found, seen, own, first, costs = {}, Seen([]), None, None, []
    for entry in store.planned[store.planned["sweep"] == sweep].itertuples():
        trial = store.trials.loc[entry.key] if entry.key in store.trials.index else None
        again = entry.axes["repeat"] == 1
        if entry.axes["model"] == OWN and not again:
            own, seen.seeds = trial, seen.seeds + 1
            if own is not None and own["outcome"] != "ok":
                seen.failures.append((own["outcome"], own["reason"]))
                own = None
            if own is not None:
                cost = own["metrics"].get(COST)  # a run of one step has no median
                costs.append(math.nan if cost is None else cost)
                if first is not None:
                    _compare(store, first, own, seen)
                else:
                    first = own
            continue
        name = AGAIN if again else entry.axes["model"]
        model = found.setdefault(name, Model(name))
        if own is None or trial is None:
            continue  # the sweep stopped before this run
        model.trials += 1
        model.idle = "" if again else _idle(name, trial["canonical"].get("pipeline", ""))
        if trial["outcome"] != "ok":
            model.failures.append((trial["outcome"], trial["reason"]))
            continue
        _compare_work(own, trial, model)
        _compare(store, own, trial, model)
    seen.models, seen.cost = list(found.values()), float(np.median(costs)) if costs else math.nan
    return seen


def _idle(model, pipeline):
    stage = SWITCHED.get(model[1:]) if model[:1] in "+-" else None
    return f"{stage}=none" if f"{stage}=none" in pipeline.split() else ""


def _places(store, trial):
    """{slot: final position of the body (m)}."""
    dimension = trial["canonical"]["dimension"]
    poses = store.poses(trial.name, dimension)
    rows = poses[max(poses)] if poses else []
    return {int(row[0]): np.array([*row[1:1 + dimension], *([0.0] * (3 - dimension))]) for row in rows}


def _compare(store, a, b, into):
    mine, other = _places(store, a), _places(store, b)
    ways = [float(np.linalg.norm(mine[slot] - other[slot])) for slot in mine if slot in other]
    if ways:
        into.median.append(float(np.median(ways)))
        into.largest.append(max(ways))


def _compare_work(own, other, into):
    mine, theirs = own["metrics"], other["metrics"]
    for name, ratios in ((COST, into.time), (ROWS, into.rows)):
        if mine.get(name) and theirs.get(name) is not None and mine[name] > 0:
            ratios.append(theirs[name] / mine[name])
    counts = [name for name, value in mine.items() if name.startswith("work_") and value is not None]
    into.same_work &= (own["canonical"]["dimension"] == other["canonical"]["dimension"] and
                       all(theirs.get(name) == mine[name] for name in counts))


def remark(model, again):
    """What qualifies a model's numbers: it failed, its switch changes nothing, its work is equal, or its time is noise."""
    if model.failures:
        outcome, reason = model.failures[0]
        return f"{len(model.failures)} of {model.trials} {outcome}: {reason}"
    if model.name == AGAIN:
        return "the noise"
    if model.idle:
        return f"{IDLE}: {model.idle}"
    if not model.time:
        return ""
    return ", ".join([EQUAL] * model.same_work + [why for why in [why_no_time(model.time, again.time)] if why])


def why_no_time(ratios, again):
    """Why a time does not count: its ratios over seeds overlap those of the own model run again, or 1; or there are few seeds
    and the ratio is below noise.UNMEASURED."""
    low, high = span([1.0, *again])
    if min(ratios) <= high and max(ratios) >= low:
        return WITHIN
    ratio = float(np.median(ratios))
    return UNKNOWN if len(ratios) < noise.FEWEST and max(ratio, 1 / ratio) <= noise.UNMEASURED else ""


def span(found):
    return (min(found), max(found)) if len(found) else (math.nan, math.nan)


def middle(found):
    return float(np.median(found)) if len(found) else math.nan


def table_of(seen):
    """The rows that `lpc needs` prints, unrounded."""
    again = next((model for model in seen.models if model.name == AGAIN), Model(AGAIN))
    rows = [Model(SEED, median=seen.median, largest=seen.largest)] if seen.largest else []
    rows += seen.models
    remarks = ["seeds move nothing in this scene" * (max(row.largest) == 0) if row.name == SEED else remark(row, again)
               for row in rows]
    return pd.DataFrame({
        "model": [row.name for row in rows],
        **quantity("time over that of minimal", "1", [middle(row.time) for row in rows]),
        **quantity("least over seeds", "1", [span(row.time)[0] for row in rows]),
        **quantity("most over seeds", "1", [span(row.time)[1] for row in rows]),
        **quantity("multiply-adds over those of minimal", "1", [middle(row.rows) for row in rows]),
        **quantity("distance of final positions, median", "m", [middle(row.median) for row in rows]),
        **quantity("distance of final positions, farthest", "m", [span(row.largest)[1] for row in rows]),
        "remark": remarks})


def _chart(context, sweep):
    seen, canonical = read(context.store, sweep), _canonical(context.store, sweep)
    table = table_of(seen)
    scene = f"{canonical.get('scene', sweep)} in {canonical.get('dimension', '?')}D"
    holes = [f"{OWN} fails with {len(seen.failures)} of {plural(seen.seeds, 'seed')}, which are left out: "
             f"{seen.failures[0][0]}: {seen.failures[0][1]}"] if seen.failures else []
    holes += [f"{row['model']}: {row['remark']}" for _, row in table.iterrows() if " of " in row["remark"]]
    left = [model.name for model in seen.models if model.trials < seen.seeds - len(seen.failures)]
    holes += [f"not run with every seed: {listing(left)}"] if left else []
    if not any(model.time or model.largest for model in seen.models):
        text = f"No run of {scene} with its own model and with another one finished."
        return Chart(sweep, SECTION, f"What {scene} needs", text, sweep, holes=holes)
    return Chart(sweep, SECTION, f"What {scene} needs", _finding(seen, table, scene), sweep, _figure(context, seen, table), table,
                 holes, "A row is the scene with one switch of its model changed, against its own model (minimal): dots are "
                 f"medians over {plural(seen.seeds, 'seed')}, whiskers all seeds. The band is minimal run again: ratios that "
                 "overlap it are noise. Right: distance of final positions from those under minimal; another seed starts each "
                 "body a little elsewhere (dotted: its farthest body).",
                 headline=_headline(seen, table, scene))


def _canonical(store, sweep):
    keys = [key for key in store.planned[store.planned["sweep"] == sweep]["key"] if key in store.trials.index]
    return store.trials.loc[keys[0]]["canonical"] if keys else {}


def _told(table):
    """[(model, ratio of times)] where the time differs beyond the noise and the work differs."""
    return [(row["model"], row[TIME]) for _, row in table.iterrows()
            if math.isfinite(row[TIME]) and row["model"] not in (AGAIN, SEED) and not row["remark"]]


def _finding(seen, table, scene):
    """The switch that changes the time most; all models from the most to the least expensive."""
    told = _told(table)
    if told:
        model, ratio = max(told, key=lambda pair: abs(math.log(pair[1])))
        way = table.set_index("model").loc[model, FARTHEST]
        text = f"{scene} takes {ratio:.2f} times the time with {model}" + (
            f", and its bodies end up to {si(way, 'm')} from their places with the own model." if math.isfinite(way) else ".")
    else:
        text = f"No switch changes the time of {scene} beyond the noise."
    counted, rows = dict(told), []
    least = max(seen.largest, default=0.0)
    for model, row in table.set_index("model").iterrows():
        low, high = (row[f"{end} over seeds [1]"] if model in counted else math.nan for end in ("least", "most"))
        moved = "bodies end farther away than under another seed" if model != SEED and row[FARTHEST] > least else ""
        rows.append({"model": model, TIME: counted.get(model, math.nan), "range over seeds": ends(low, high, "1"),
                     "farthest body [m]": row[FARTHEST], "remark": ", ".join(filter(None, (row["remark"], moved)))})
    return Finding(text, cut(pd.DataFrame(rows).sort_values(TIME, ascending=False, kind="stable")))


def _headline(seen, table, scene):
    """For the first screen: the switch that changes the time most."""
    told = _told(table)
    if not told or not math.isfinite(seen.cost):
        return None
    model, ratio = max(told, key=lambda pair: abs(math.log(pair[1])))
    return Headline("", {OWN: seen.cost / 1e3, model: seen.cost * ratio / 1e3}, "s", "time per step")


def _figure(context, seen, table):
    rows = list(table["model"])
    models = {model.name: model for model in seen.models}
    left = 0.3 + 0.075 * max(map(len, rows))
    figure, axes = grid_of_axes(1, 3, 0.26 * len(rows) + 0.1, 1.75, left=left, gap_x=0.35, bottom=0.45)
    failed = any(model.failures for model in seen.models)
    handles = [Line2D([], [], color=INK, marker="o", lw=1.2, label="median, all seeds"),
               Patch(color="#E8E8E8", label=AGAIN),
               Line2D([], [], ls="none", color=INK, marker="o", label="median body"),
               Line2D([], [], ls="none", color=FAR, marker="D", label="farthest body")]
    for ax, name, label in ((axes[0][0], "time", "time per step / minimal"),
                            (axes[0][1], "rows", "multiply-adds / minimal")):
        values = [value for model in seen.models for value in getattr(model, name)] + [1.0]
        scale = ZeroLog(ax, "x", values, "1", failures=failed, failed_name="none")
        if name == "time" and AGAIN in models and models[AGAIN].time:
            ax.axvspan(*span([1.0, *models[AGAIN].time]), color="#E8E8E8", zorder=0.3)
        ax.axvline(1, color="#999999", lw=0.8, zorder=0.5)
        for y, row in enumerate(rows):
            ratios = getattr(models[row], name) if row in models else []
            if ratios:
                ax.plot([scale.place(end) for end in span(ratios)], [y, y], color=INK, lw=1.2)
                ax.plot([scale.place(middle(ratios))], [y], color=INK, marker="o", ms=4)
        ax.set_xlabel(label)
        _letters(ax, scale, rows, models)
    ways = [value for found in (seen, *seen.models) for value in (*found.median, *found.largest)]
    scale = ZeroLog(axes[0][2], "x", ways, "m", failures=failed, failed_name="none")
    for y, row in enumerate(rows):
        found = seen if row == SEED else models[row]
        if found.largest:
            axes[0][2].plot([scale.place(middle(found.median))], [y], ls="none", color=INK, marker="o")
            axes[0][2].plot([scale.place(max(found.largest))], [y], ls="none", color=FAR, marker="D", ms=4.5)
    if seen.largest:
        axes[0][2].axvline(scale.place(max(seen.largest)), color="#999999", lw=0.8, ls=":", zorder=0.5)
    axes[0][2].set_xlabel("distance of final positions")
    _letters(axes[0][2], scale, rows, models)
    for column, ax in enumerate(axes[0]):
        ax.set_ylim(len(rows) - 0.5, -0.5)
        ax.set_yticks(range(len(rows)), rows if column == 0 else [""] * len(rows))
        ax.tick_params(axis="y", length=0)
    outcomes = sorted({outcome for model in seen.models for outcome, _ in model.failures})
    handles += [Line2D([], [], ls="none", marker=letter(outcome), color="#555555", ms=7, label=outcome) for outcome in outcomes]
    legend_right(figure, handles, 1.6)
    return figure


def _letters(ax, scale, rows, models):
    for y, row in enumerate(rows):
        if row in models and models[row].failures:
            ax.plot([scale.failed], [y], ls="none", color="#555555", marker=letter(models[row].failures[0][0]), ms=7, mew=0.3)
