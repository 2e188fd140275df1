# SPDX-License-Identifier: Zlib
"""Resolvers: what a step costs against how wrong it is, and how restless a scene at rest stays."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
from chart import Chart, describe, holes, listing, methods
from load import axes_of, one_machine, split, varying
from style import HALO, ZeroLog, grid_of_axes, legend_right, letter, si, times

SECTION = "Which resolver is right for its cost?"
STEADY = "How restless is a scene that should be at rest?"
COSTS = ("ms_per_step_median", "work_row_updates")
NAMES = {"ms_per_step_median": "time per step", "work_row_updates": "row updates per step",
         "max_penetration": "largest penetration", "penetration_poses": "largest penetration", "end_drift_max": "largest drift at the end",
         "slope_error": "error of the distance slid", "jitter": "restlessness (speed)",
         "joint_error_max": "largest joint error", "mean_penetration_end": "mean penetration at the end",
         "max_drift": "largest drift", "lean": "sideways drift at the end"}


def charts(context):
    cells = context.store.cells("resolvers")
    if not len(cells):
        return [Chart("resolvers", SECTION, "Cost against error", "No resolver sweep is in this store.", "resolvers")]
    cells, refused = one_machine(cells)
    metrics.add(context.store, cells, ["jitter", "slope_error", "lean", "creep", "energy_gain", "contact_flicker", "settle_time", "tilt_end"])
    if "precision" in cells and cells["precision"].nunique() > 1:
        kept = "f64" if (cells["precision"] == "f64").any() else cells["precision"].iloc[0]
        engine = np.array([context.store.role(method) == "engine" for method in cells["method"]])  # of one precision by nature
        cells = cells[(cells["precision"] == kept) | engine]
    groups = [c for c in ("scene", "dimension") if c in cells]
    made = []
    for part in split(cells, groups):
        # Whatever else varies inside a scene (a mass ratio, an angle) makes a chart of its own: unequal cells never meet.
        inner = [c for c in varying(part, METHOD_LIKE) if c in axes_of(context.store, part)]
        for equal in split(part, inner, sort=True):
            made.append(_cost_chart(context, equal, groups + inner, refused))
    return made + steadiness(context, cells)


METHOD_LIKE = ("resolver", "solver", "pipeline", "velocity", "position", "iterations", "scene", "dimension", "precision")


def identifier(text):
    return "".join(c if c.isalnum() else "_" for c in text.lower()).strip("_")


def errors_of(cells):
    """The errors that this scene can show, at most three."""
    finished = cells[cells["outcome"] == "ok"]
    wanted = []
    # Measured on poses alike for all, where the store has it: an engine tells no contacts.
    depth = "penetration_poses" if np.isfinite(metrics.column(finished, "penetration_poses")).any() else "max_penetration"
    for name in ("slope_error", "joint_error_max", depth, "lean", "jitter"):
        values = metrics.column(finished, name)
        meaningless = name == "joint_error_max" and not (values > 0).any()
        if np.isfinite(values).any() and not meaningless:
            wanted.append(name)
    if "slope_error" in wanted:  # a block that slides as it should goes sideways and does not rest
        wanted = [name for name in wanted if name not in ("lean", "jitter")]
    return wanted[:3] or [depth]


def engine_notes(context, cells):
    """What engines do otherwise whatever is set; it stands where they are ranked."""
    said = {}
    for method, precision, key in zip(cells["method"], cells.get("precision", ""), cells["key"]):
        if context.store.role(method) == "engine" and key in context.store.trials.index:
            differs = context.store.trials.loc[key, "canonical"].get("engine", {}).get("differs")
            if differs:
                said[method] = f" {method} is a whole engine, here in {precision}: {differs}."
    return "".join(said[method] for method in sorted(said))


def budgets(cells, cost_name, error_name):
    """What each method reaches at equal cost, and pays at equal error; the budgets are those that every method meets."""
    good = cells[(cells["outcome"] == "ok").to_numpy() & np.isfinite(metrics.column(cells, cost_name)) &
                 np.isfinite(metrics.column(cells, error_name))]
    if not len(good):
        return None
    cost_budget = good.groupby("method")[cost_name].min().max()
    error_budget = good.groupby("method")[error_name].min().max()
    rows = []
    for method, part in cells.groupby("method", sort=True):
        mine = good[good["method"] == method]
        within = mine[mine[cost_name] <= cost_budget]
        reach = mine[mine[error_name] <= error_budget]
        rows.append((method, within[error_name].min() if len(within) else math.nan,
                     reach[cost_name].min() if len(reach) else math.nan, len(part), int((part["outcome"] != "ok").sum())))
    table = pd.DataFrame(rows, columns=["method", "error", "cost", "cells", "failed"])
    return cost_budget, error_budget, table


def finding(cells, where, cost_name, error_name):
    unit = metrics.METRICS[error_name].unit
    failed = cells[cells["outcome"] != "ok"]
    planned = cells.groupby("method").size()
    fails = [f"{method} {len(part)} of {planned[method]}" for method, part in failed.groupby("method", sort=True)]
    kinds = listing(sorted(set(failed["outcome"])))
    tail = f" Not ok ({kinds}): {listing(fails)} cells." if fails else " Every cell finished."
    result = budgets(cells, cost_name, error_name)
    if result is None:
        return f"On {where} no resolver finished with a cost and an error.{tail}"
    cost_budget, _, table = result
    floor = metrics.METRICS[error_name].floor
    table["error"] = table["error"].where(~(table["error"] <= floor), 0.0)
    shown = table.dropna(subset=["error"])
    best, worst = shown.loc[shown["error"].idxmin()], shown.loc[shown["error"].idxmax()]
    what = NAMES.get(error_name, error_name)
    everyone = sorted(cells["method"].unique())
    if len(shown) == 1:
        return f"On {where} only {best['method']} finishes, with {what} {si(best['error'], unit)}.{tail}"
    if worst["error"] == best["error"]:
        return (f"On {where} {methods(shown['method'], everyone)} have the same {what.removeprefix('largest ')} "
                f"({si(best['error'], unit)}) within {si(cost_budget, metrics.METRICS[cost_name].unit)} per step.{tail}")
    firsts = shown[shown["error"] == best["error"]]["method"]
    head = (f"On {where}, within {si(cost_budget, metrics.METRICS[cost_name].unit)} per step (every method that finishes "
            f"has a setting below it), {methods(firsts, everyone)} {'has' if len(firsts) == 1 else 'have'} the "
            f"smallest {what.removeprefix('largest ')} ({si(best['error'], unit)})")
    tail = against_naive(cells, cost_name, error_name) + tail
    if best["error"] > 0:
        return head + (f" and {worst['method']} the largest ({si(worst['error'], unit)}, "
                       f"{times(worst['error'] / best['error'])} times as much).{tail}")
    return head + f" and {worst['method']} the largest ({si(worst['error'], unit)}).{tail}"


def against_naive(cells, cost_name, error_name):
    """The question of 2009 in a sentence: the best catto against naive at the largest number of iterations of both."""
    if "iterations" in cells:
        cells = cells[cells["iterations"] == cells["iterations"].max()]
    naive = cells[cells["method"] == "naive"]
    catto = cells[cells["method"].str.startswith("catto") & (cells["outcome"] == "ok")]
    if not len(naive) or not len(catto) or not np.isfinite(metrics.column(catto, error_name)).any():
        return ""
    row, best = naive.iloc[0], catto.iloc[int(np.nanargmin(metrics.column(catto, error_name)))]
    at = f"At {best['iterations']:g} iterations " if "iterations" in cells else "Here "
    if row["outcome"] != "ok":
        step = "" if row["step"] != row["step"] else f" at step {int(row['step'])}"
        return f" {at}{best['method']} stands where naive fails ({row['outcome']}{step})."
    costs, errors = (best[cost_name], row[cost_name]), (best[error_name], row[error_name])
    if not all(map(math.isfinite, costs + errors)) or not costs[1] or max(errors) <= metrics.METRICS[error_name].floor:
        return ""
    ratio = errors[0] / errors[1] if errors[1] > 0 else math.inf
    how = "with the same error" if abs(ratio - 1) < 0.005 else f"with {ratio:.2g} times its error"
    how = "with an error where naive has none" if math.isinf(ratio) else how
    return f" {at}{best['method']} takes {costs[0] / costs[1]:.2g} times naive's time {how}."


def _cost_chart(context, cells, groups, refused):
    where = describe(cells.iloc[0], groups)
    errors = errors_of(cells)
    costs = [name for name in COSTS if np.isfinite(metrics.column(cells, name)).any()] or [COSTS[1]]
    labels = sorted(cells["method"].unique())
    has_iterations = "iterations" in cells and cells["iterations"].nunique() > 1
    legend_width = 2.0
    figure, axes = grid_of_axes(len(costs), len(errors), 2.45, legend_width, left=0.8, gap_x=0.85, gap_y=0.65)
    failed = (cells["outcome"] != "ok").to_numpy()
    for row, cost_name in enumerate(costs):
        cost = metrics.column(cells, cost_name)
        for column, error_name in enumerate(errors):
            ax, error = axes[row][column], metrics.column(cells, error_name).copy()
            error[failed] = math.nan
            across = ZeroLog(ax, "x", cost, metrics.METRICS[cost_name].unit, failed_name="none")
            up = ZeroLog(ax, "y", error, metrics.METRICS[error_name].unit, floor=metrics.METRICS[error_name].floor)
            for method in labels:
                mine = np.flatnonzero((cells["method"] == method).to_numpy())
                if has_iterations:
                    mine = mine[np.argsort(cells["iterations"].to_numpy()[mine].astype(float), kind="stable")]
                look = context.looks(method)
                good = [i for i in mine if math.isfinite(error[i])]
                ax.plot([across.place(cost[i]) for i in good], [up.place(error[i]) for i in good], lw=1, alpha=0.6,
                        **{**look, "marker": None})
                for rank, i in enumerate(mine):
                    size = 4 + 5 * rank / max(1, len(mine) - 1) if has_iterations else 6.5
                    x, y = across.place(cost[i]), up.place(error[i])
                    if math.isfinite(error[i]):
                        hollow = "markerfacecolor" in look  # not one of ours
                        ax.plot([x], [y], ls="none", ms=size, marker=look["marker"], color=look["color"], zorder=3,
                                **({"mfc": "white", "mew": 1.2} if hollow else {"mec": "white", "mew": 0.5}))
                    else:
                        ax.plot([x], [y], ls="none", ms=7, marker=letter(cells["outcome"].iloc[i]), color=look["color"],
                                mew=0.3, zorder=3)
            front = metrics.pareto(cost, error)
            ax.step([across.place(cost[i]) for i in front], [up.place(error[i]) for i in front], where="post",
                    color="#222222", lw=2.6, alpha=0.35, zorder=1)
            ax.set_xlabel(NAMES.get(cost_name, cost_name))
            if row == 0:
                ax.set_title(NAMES.get(error_name, error_name))
    handles = [Line2D([], [], label=context.looks.name(m), **context.looks(m)) for m in labels]
    handles.append(Line2D([], [], color="#222222", lw=2.6, alpha=0.35, label="Pareto front"))
    handles += [Line2D([], [], ls="none", color="#555555", marker=letter(o), ms=7, label=o)
                for o in sorted({o for o in cells["outcome"] if o != "ok"})]
    legend_right(figure, handles, legend_width)
    table = _table(cells, has_iterations, costs, errors)
    order = "Along a line the iterations grow with the marker. " if has_iterations else ""
    return Chart(identifier(f"resolvers {where}"), SECTION, f"Cost against error: {where}",
                 finding(cells, where, costs[0], errors[0]), cells["sweep"].iloc[0], figure, table,
                 refused + holes(cells, ["method", "iterations"]),
                 order + "A letter in the top band is a run that failed; the front joins what no other beats in both." + engine_notes(context, cells))


def _table(cells, has_iterations, costs, errors):
    columns = {"method": cells["method"]}
    if has_iterations:
        columns["iterations"] = cells["iterations"]
    columns["outcome"] = cells["outcome"]
    columns["step"] = ["" if s != s else int(s) for s in cells["step"]]
    for name in list(costs) + list(errors):
        columns[NAMES.get(name, name)] = [si(v, metrics.METRICS[name].unit) for v in metrics.column(cells, name)]
    for name in ("creep", "energy_gain", "contact_flicker", "settle_time", "tilt_end"):
        if np.isfinite(metrics.column(cells, name)).any():
            columns[name] = [si(v, metrics.METRICS[name].unit) for v in metrics.column(cells, name)]
    first, second = costs[0], errors[0]
    result = budgets(cells, first, second)
    if result is not None:
        cost_budget, error_budget, table = result
        by = table.set_index("method")
        columns[f"best {NAMES[second]} within {si(cost_budget, metrics.METRICS[first].unit)}"] = [
            si(by["error"][m], metrics.METRICS[second].unit) for m in cells["method"]]
        columns[f"least {NAMES[first]} for {si(error_budget, metrics.METRICS[second].unit)}"] = [
            si(by["cost"][m], metrics.METRICS[first].unit) for m in cells["method"]]
    return pd.DataFrame(columns).sort_values(list(columns)[:2] if has_iterations else ["method"])


def usual_iterations(cells):
    """The one number of iterations at which methods are compared over time: 10 where it was run, else the middle."""
    if "iterations" not in cells:
        return cells
    values = sorted(cells["iterations"].dropna().unique())
    if len(values) < 2:
        return cells
    kept = 10 if 10 in values else values[len(values) // 2]
    return cells[cells["iterations"].isna() | (cells["iterations"] == kept)]


def steadiness(context, cells):
    """Contact points and the fastest body over time, per scene (2009 report, figures 7.4 and 7.5)."""
    made = []
    resting = [s for s in dict.fromkeys(cells.get("scene", [])) if not any(w in s for w in ("slope", "ball", "pend"))][:3]
    cells = usual_iterations(cells[cells["scene"].isin(resting)]) if resting else cells[:0]
    for dimension, part in cells.groupby("dimension", sort=True) if "dimension" in cells else [(2, cells)]:
        if len(part):
            made.append(_steady_chart(context, part, int(dimension), [s for s in resting if s in set(part["scene"])]))
    return made


def envelope(values, count=150):
    """The largest value of each of `count` stretches, and the step at which each begins."""
    edges = np.unique(np.linspace(0, len(values), min(count, len(values)) + 1).astype(int))
    return edges[:-1], np.array([np.max(values[a:b]) for a, b in zip(edges[:-1], edges[1:])])


def _steady_chart(context, cells, dimension, scenes):
    legend_width = 2.0
    figure, axes = grid_of_axes(2, len(scenes), 2.2, legend_width, left=1.0, gap_x=0.8, gap_y=0.45)
    labels = sorted(cells["method"].unique())
    rows = []
    for column, scene in enumerate(scenes):
        part = cells[cells["scene"] == scene].drop_duplicates("method")
        tracks = {}
        for _, cell in part.iterrows():
            if cell["key"] is None:
                rows.append({"scene": scene, "method": cell["method"], "outcome": cell["outcome"], "restlessness": math.nan,
                             "contact points at the end": math.nan})
            else:
                tracks[cell["method"]] = (cell, context.store.series(cell["key"], "max_speed"),
                                          context.store.series(cell["key"], "points"))
        speeds = [v for _, s, _ in tracks.values() if s is not None for v in envelope(s)[1] if math.isfinite(v)]
        scale = ZeroLog(axes[0][column], "y", speeds, "m/s", failures=False, floor=1e-9)
        for method, (cell, speed, points) in sorted(tracks.items()):
            look = {**context.looks(method), "marker": None, "lw": 1.2}
            for ax, values, place in ((axes[0][column], speed, scale.place), (axes[1][column], points, float)):
                if values is None or not len(values):
                    continue
                step, high = envelope(np.where(np.isfinite(values), values, np.nan))
                ax.plot(step, [place(v) if math.isfinite(v) else math.nan for v in high], **look)
                if cell["outcome"] != "ok":
                    last = [v for v in high if math.isfinite(v)]
                    ax.plot([len(values)], [place(last[-1] if last else 0)], marker=letter(cell["outcome"]), ms=8,
                            ls="none", color=look["color"], clip_on=False, path_effects=HALO, zorder=4)
            rows.append({"scene": scene, "method": method, "outcome": cell["outcome"], "restlessness": cell.get("jitter"),
                         "contact points at the end": math.nan if points is None or not len(points) else points[-1]})
        axes[0][column].set_title(f"{scene}, {dimension}D")
        axes[1][column].set_xlabel("step")
        axes[1][column].set_ylim(bottom=0)
    axes[0][0].set_ylabel("fastest body")
    axes[1][0].set_ylabel("contact points")
    legend_right(figure, [Line2D([], [], label=context.looks.name(m), **{**context.looks(m), "marker": None})
                          for m in labels], legend_width)
    table = pd.DataFrame(rows)
    said = []
    for scene, part in table.groupby("scene", sort=False):
        part = part[(part["outcome"] == "ok") & np.isfinite(part["restlessness"].astype(float))]
        if len(part) > 1:
            best, worst = part.loc[part["restlessness"].idxmin()], part.loc[part["restlessness"].idxmax()]
            said.append(f"on {scene} the last quarter is calmest with {best['method']} "
                        f"({si(best['restlessness'], 'm/s')}) and most restless with {worst['method']} "
                        f"({si(worst['restlessness'], 'm/s')})")
    text = f"In {dimension}D " + "; ".join(said) + "." if said else f"In {dimension}D too few runs finished to compare."
    table["restlessness"] = [si(v, "m/s") for v in table["restlessness"].astype(float)]
    return Chart(f"steadiness_{dimension}d", STEADY, f"The fastest body and the contacts over time, {dimension}D", text,
                 cells["sweep"].iloc[0], figure, table, holes(cells, ["scene", "method"]),
                 "Lines are the largest value of each of 150 stretches; a letter marks where a run failed.")
