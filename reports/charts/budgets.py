# SPDX-License-Identifier: Zlib
"""What each method reaches within a budget of time, and of work: at every budget, not at the dearest method's alone."""

import itertools
import math

import numpy as np
import pandas as pd

import metrics
import noise
import over_steps
import ranking
from budget import marks, within
from chart import Chart, Needs, describe, holes, identifier, listing, methods, of_sweeps
from load import one_machine, split, varying
from matplotlib.lines import Line2D
from style import ZeroLog, grid_of_axes, legend_right, legend_room, si
from table import quantity

SECTION = "Which method is right within a budget?"
TIME = "ms_per_step_median"


@of_sweeps("budgets", 21, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=(TIME,),
                 also="several values of a setting at several costs"),
           "Error within a budget", "No timed sweep of several methods at several costs is in this store.", "resolvers")
def budgets(context, cells):
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, context.metrics("world", "error")))
    groups = [c for c in ("scene", "dimension") if c in cells]
    made = []
    for part in split(cells, groups):
        setting = next(iter(context.settings(part)), None)
        if not setting:
            continue
        part = over_steps.own_setting(part, setting)
        inner = varying(context.store, part, (*groups, setting))
        for equal in split(part, inner, sort=True):
            chart = _chart(context, equal, describe(equal.iloc[0], groups + inner), setting, refused)
            made += [chart] if chart else []
    return made


def least_of(context, cells, cost):
    """The noise of a cost: counts have none."""
    return noise.floor_of(context, cells["sweep"].iloc[0], cost) if context.store.is_time(cost) else 1.0


def compared(context, cells, cost, error):
    """How many methods have a rank at each budget."""
    cells, least = ranking.eligible(context, cells), least_of(context, cells, cost)
    return [len(within(cells, cost, error, budget, least)) for budget in marks(cells, cost, error)]


def finding(context, cells, cost, error):
    """Whose error is smallest within each budget: `within 1 ms and 2 ms per step that of a (4 mm), within 4 ms that of ...`."""
    unit, everyone, said = context.unit(error), sorted(cells["method"].unique()), []
    cells = ranking.eligible(context, cells)
    for budget in marks(cells, cost, error):
        reached = within(cells, cost, error, budget, least_of(context, cells, cost))
        best, many = min(reached.values(), key=lambda cell: cell[error]), ranking.comparisons(len(reached))
        equals = [m for m, cell in reached.items() if not ranking.better(best, cell, error, context.floor(error), many)]
        value = best[error] if best[error] > context.floor(error) else 0.0
        unit_of_cost = context.unit(cost)
        text = f"{budget:,.0f}" if unit_of_cost == "1" and budget >= 100 else si(budget, unit_of_cost)
        said.append((text, f"that of {methods(equals, everyone)} ({si(value, unit)})"))
    # Budgets one after another with one answer are told together: they are lines drawn beforehand, not where ranks change.
    told = [(listing(budget for budget, _ in group), text) for text, group in itertools.groupby(said, lambda one: one[1])]
    of = "per step" if context.unit(cost) != "1" else context.title(cost)
    return ", ".join(f"within {budgets} {of + ' ' if i == 0 else ''}{text}" for i, (budgets, text) in enumerate(told))


def _chart(context, cells, where, setting, refused):
    error = metrics.errors_of(context, cells)[0]
    costs = [name for name in context.metrics("world", "cost") if marks(cells, name, error)][:2]
    if not costs:
        return None
    labels, looks = sorted(cells["method"].unique()), context.looks(cells)
    names = ranking.names(context, cells)
    width = legend_room(names.values(), 2.0)
    figure, axes = grid_of_axes(1, len(costs), 2.6, width, left=0.9, gap_x=0.9)
    rows, ranked = [], []
    for column, cost in enumerate(costs):
        ax = axes[0][column]
        ranked += compared(context, cells, cost, error)
        good = cells[(cells["outcome"] == "ok").to_numpy() & np.isfinite(metrics.column(cells, cost)) &
                     np.isfinite(metrics.column(cells, error))]
        across = ZeroLog(ax, "x", list(good[cost]), context.unit(cost), failures=False)
        up = ZeroLog(ax, "y", list(good[error]), context.unit(error), failures=False, floor=context.floor(error))
        for method, part in good.groupby("method", sort=True):
            part = part.sort_values(cost)
            reached = np.minimum.accumulate(part[error].to_numpy(dtype=float))
            ends = [*part[cost], max(good[cost])]
            ax.step([across.place(v) for v in ends], [up.place(v) for v in (*reached, reached[-1])], where="post",
                    **{**looks(method), "lw": 1.3}, markevery=list(range(len(part))))
        for budget in marks(cells, cost, error):
            ax.axvline(budget, color="#999999", lw=0.8, ls=":", zorder=0.5)
            for method, cell in within(cells, cost, error, budget, least_of(context, cells, cost)).items():
                numbers = quantity(f"{context.title(cost)}, at most", context.unit(cost), [budget])
                numbers |= quantity(context.title(error), context.unit(error), [cell[error]])
                rows.append({"method": method, setting: cell[setting], **{name: v[0] for name, v in numbers.items()}})
        ax.set_xlabel(context.title(cost))
        ax.set_ylabel(f"least {context.title(error).removeprefix('largest ')}" if column == 0 else "")
    legend_right(figure, [Line2D([], [], label=names[m], **looks(m)) for m in labels], width)
    said = [finding(context, cells, cost, error) for cost in costs]
    return Chart(identifier(f"{cells['sweep'].iloc[0]} budgets {where}"), SECTION, f"Least error within a budget: {where}",
                 f"On {where} the smallest {context.title(error).removeprefix('largest ')} is, " + "; ".join(said) + "."
                 + ranking.tail(context, cells),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(rows), refused + holes(cells, ["method", setting]),
                 f"Each line is the least error of a method over its values of {setting} that cost at most as much; dotted lines "
                 "are the budgets that the finding compares. What is not named at a budget errs more, or has no run that "
                 "cheap: a time above the budget by no more than the noise is within it. "
                 + ranking.rule(max(map(len, cells["seeds"])), *ranked) + " " + noise.rule(
                     noise.floor_of(context, cells["sweep"].iloc[0], TIME)))
