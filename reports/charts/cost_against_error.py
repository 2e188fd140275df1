# SPDX-License-Identifier: Zlib
"""Cost of a step against the error of each method on one scene, and the method with the smallest error within each budget."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import over_steps
import ranking
from budget import marks, within
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from finding import NOISE, Finding, Line, cut, fits, ranked
from load import one_machine, split, varying
from sentences import listing, methods, some, verb
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, same, scale_of,
                   si, times)
from table import quantity

RIGHT_FOR_COST = "Which method is most accurate for its cost?"
# The trials say which errors a scene can show; other charts compare models and precisions.
NAMED = 6  # most methods that failed and are named in the legend


@of_sweeps("cost_against_error", 20, RIGHT_FOR_COST,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("ms_per_step_median",)),
           "Cost against error", "No timed sweep of several methods is in this store.", "resolvers")
def cost_against_error(context, cells):
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, context.metrics("world", "error", "detail")))
    groups = [c for c in ("scene", "dimension") if c in cells]
    made = []
    for part in split(cells, groups):
        # Each value of another axis (a mass ratio, an angle) makes a separate chart: unequal cells are never compared.
        inner = varying(context.store, part, (*groups, *context.settings(part)[:1]))
        for equal in split(part, inner, sort=True):
            made.append(_cost_chart(context, equal, groups + inner, refused))
    return made


def engine_notes(context, cells):
    """Fixed differences of whole engines from the asked settings, for charts that rank engines."""
    said = {}
    for method, key in zip(cells["method"], cells["key"]):
        if key is not None and context.store.role(method) == "engine":
            trial = context.store.trials.loc[key, "canonical"]
            if "engine" in trial:
                said[method] = f" {method} is a whole engine, here in {trial['precision']}: {trial['engine']['differs']}."
    return "".join(said[method] for method in sorted(said))


def at_equal_cost(cells, cost_name, error_name):
    """Each method's least error at equal cost (`at`: the index of its cell) and least cost at equal error. The budgets are the
    smallest that every finished method meets."""
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
        at = within[error_name].idxmin() if len(within) else None
        rows.append((method, math.nan if at is None else within[error_name][at],
                     reach[cost_name].min() if len(reach) else math.nan, len(part), int((part["outcome"] != "ok").sum()), at))
    table = pd.DataFrame(rows, columns=["method", "error", "cost", "cells", "failed", "at"])
    return cost_budget, error_budget, table


def per_step(context, cost, budget):
    """A budget in words: "801 µs per step", "28,800 multiply-adds per step"."""
    unit = context.unit(cost)
    return f"{si(budget, unit)} {'per step' if unit != '1' else context.title(cost)}"


def found(context, cells, where, cost, error):
    """(finding, entry of the first screen or None): the errors that methods reach at equal cost."""
    everyone, unit, floor = sorted(cells["method"].unique()), context.unit(error), context.floor(error)
    eligible, setting = ranking.eligible(context, cells), next(iter(context.settings(cells)), None)
    what, result = context.title(error).removeprefix("largest "), at_equal_cost(eligible, cost, error)
    lines = _lines(context, cells, result, setting, cost, error)
    ranks = lambda ties=(): ranked(lines, context.title(error), unit, ties, floor=floor,  # noqa: E731
                                   keep=[context.baseline(cells)])
    if result is None:
        return Finding(f"On {where} no ranked method finished with a cost and an error.", ranks()), None
    budget, _, table = result
    errors = {m: 0.0 if e <= floor else e for m, e in zip(table["method"], table["error"])}
    known, failed = {m: e for m, e in errors.items() if e == e}, [m for m, e in errors.items() if e != e]
    cell = {m: eligible.loc[at] for m, at in zip(table["method"], table["at"]) if m in known}
    best, worst = min(known, key=known.get), max(known, key=known.get)
    least, most = si(known[best], unit), si(known[worst], unit)
    many, head = ranking.comparisons(len(known)), f"On {where}, within {per_step(context, cost, budget)}, "
    # A method that the best does not beat significantly ties with it.
    firsts = [m for m in known if not ranking.better(cell[best], cell[m], error, floor, many)]
    if len(known) == 1:
        return Finding(f"On {where} only {best} finishes; its {what} is {least}.", ranks()), None
    fail = f"; {some(failed, everyone)} {verb(len(failed), 'fail')}" if failed else ""
    if len(firsts) == len(known):
        alike = f"the same {what} ({least})" if known[best] == known[worst] else f"a tie for the smallest {what}"
        verb_of = "have" if known[best] == known[worst] else "end in"
        text = fits(f"{head}{some(known, everyone)} {verb_of} {alike}{fail}.", f"{head}{some(known, everyone)} {verb_of} "
                                                                               f"{alike}.")
    else:
        # Values that read alike share the last place.
        lasts = [m for m in known if si(known[m], unit) == most and m not in firsts]
        ats = [_at_setting(cell, group, setting) for group in (firsts, lasts)]
        first = lambda at="": (f"{head}{some(firsts, everyone)} {verb(len(firsts), 'have')} the smallest {what} "  # noqa: E731
                               f"({least}{at})")
        last = lambda at="": f", {some(lasts, everyone, 1)} the largest ({most}{at})" if lasts else ""  # noqa: E731
        text = fits(*(f"{a}{b}{c}." for a, b, c in ((first(ats[0]), last(ats[1]), fail), (first(), last(), fail),
                                                    (first(ats[0]), last(ats[1]), ""), (first(), last(), ""),
                                                    (first(), "", fail), (first(), "", ""))))
    table = ranks([m for m in firsts if m != best])
    if not failed and not ranking.better(cell[best], cell[worst], error, floor, many):
        return Finding(text, table), None
    ends = final_states(eligible.loc[[row.name for row in cell.values()]])
    return Finding(text, table), Headline("", errors, unit, context.title(error), ends=ends)


def _at_setting(cell, named, setting):
    """The values of the setting at which these methods reach their errors: at equal cost the values may differ."""
    values = sorted({cell[m][setting] for m in named if cell[m][setting] == cell[m][setting]}) if setting else []
    return f" at {setting}={listing(f'{v:g}' for v in values)}" if values else ""


def _lines(context, cells, result, setting, cost, error):
    """One line per method: its error at equal cost, or why it has none."""
    why, (title, against) = ranking.unranked(context, cells), _against_baseline(context, cells, setting, cost)
    at = {} if result is None else dict(zip(result[2]["method"], result[2]["at"]))
    made, any_failed = [], (cells["outcome"] != "ok").any()
    for method, part in cells.groupby("method", sort=True):
        bad, more = part[part["outcome"] != "ok"], {}
        index = at.get(method)
        cell = None if index is None or index != index else cells.loc[index]
        if setting:
            more[setting] = None if cell is None or cell[setting] != cell[setting] else cell[setting]
        if any_failed:
            more["failed cells"] = f"{len(bad)} of {len(part)}{f' ({listing(sorted(set(bad.outcome)))})' if len(bad) else ''}"
        if title:
            more[title] = against.get(method, "")
        outcome = f"not ranked: {why[method]}" if cell is None and method in why else "" if cell is not None else (
            f"failed: {bad['outcome'].iloc[0]}" if len(bad) else f"no {context.title(cost)}")
        low, high = (math.nan, math.nan) if cell is None else noise.interval(measured.seeds(cell, error))
        made.append(Line(method, math.nan if cell is None else float(cell[error]), low, high, outcome, more))
    return made


def _against_baseline(context, cells, setting, cost):
    """(title, {method: its cost over that of the sweep's baseline, or why there is no ratio}), both at the largest setting."""
    base, eligible = context.baseline(cells), ranking.eligible(context, cells)
    most = eligible[setting].max() if setting else math.nan
    last = eligible[(eligible[setting] == most) | eligible[setting].isna()] if setting else eligible
    rows = {row["method"]: row for _, row in last[last["outcome"] == "ok"].iterrows() if math.isfinite(float(row[cost]))}
    if base not in rows:
        return "", {}
    least, said = noise.floor_of(context, cells["sweep"].iloc[0], cost), {}
    for method, row in rows.items():
        ratio = noise.ratio(rows[base], row, cost)
        text = noise.said(rows[base], row, cost, least) if context.store.is_time(cost) else ""
        said[method] = "" if method == base else {noise.NOISE: NOISE}.get(text, text) if text in (
            noise.NOISE, noise.FEW, noise.SAME_WORK) else f"{times(ratio)} times" if math.isfinite(ratio) else ""
        if setting and row[setting] != row[setting] and said[method]:
            said[method] += f" (no {setting})"
    at = f", {setting}={most:g}" if most == most else ""
    return f"{context.title(cost)} against {base}{at}", said


def _cost_chart(context, cells, groups, refused):
    where = describe(cells.iloc[0], groups)
    errors, looks = metrics.errors_of(context, cells), context.looks(cells)
    costs = context.metrics("world", "cost")
    costs = [name for name in costs if np.isfinite(metrics.column(cells, name)).any()][:2] or costs[:1]
    labels = sorted(cells["method"].unique())
    setting = next(iter(context.settings(cells)), None)
    cells, names = over_steps.own_setting(cells, setting), ranking.names(context, cells)
    legend_width = legend_room(names.values(), 2.0)
    figure, axes = grid_of_axes(len(costs), len(errors), 2.45, legend_width, left=0.8, gap_x=0.85, gap_y=0.65)
    failed, shared = (cells["outcome"] != "ok").to_numpy(), []
    ranked = cells.index.isin(ranking.eligible(context, cells).index)
    for row, cost_name in enumerate(costs):
        cost = metrics.column(cells, cost_name)
        for column, error_name in enumerate(errors):
            ax, error = axes[row][column], metrics.column(cells, error_name).copy()
            error[failed] = math.nan
            across = ZeroLog(ax, "x", [*cost, *ends_of_whiskers(cells, cost_name, measured.runs)], context.unit(cost_name),
                             failed_name="none")
            up = ZeroLog(ax, "y", [*error, *ends_of_whiskers(cells, error_name, measured.seeds)], context.unit(error_name),
                         floor=context.floor(error_name))
            spots = []
            for method in labels:
                mine = np.flatnonzero((cells["method"] == method).to_numpy())
                if setting:
                    mine = mine[np.argsort(cells[setting].to_numpy()[mine].astype(float), kind="stable")]
                look = looks(method)
                good = [i for i in mine if math.isfinite(error[i])]
                ax.plot([across.place(cost[i]) for i in good], [up.place(error[i]) for i in good], lw=1, alpha=0.6,
                        **{**look, "marker": None})
                for rank, i in enumerate(mine):
                    size = 5 + 4 * rank / max(1, len(mine) - 1) if setting else 6.5
                    x, y = across.place(cost[i]), up.place(error[i])
                    whiskers(ax, cells.iloc[i], cost_name, error_name, across, up, look["color"])
                    if math.isfinite(error[i]):
                        hollow = "markerfacecolor" in look
                        ax.plot([x], [y], ls="none", ms=size * scale_of(look["marker"]), marker=look["marker"],
                                color=look["color"], mfc="white" if hollow else look["color"],
                                mec=look["color"] if hollow else "white", mew=1.2 if hollow else 0.5, zorder=3)
                    else:
                        spots.append((x, y, cells["outcome"].iloc[i], look["color"]))
            fallen(ax, spots)
            front = metrics.pareto(cost, np.where(ranked, error, math.nan))
            ax.step([across.place(cost[i]) for i in front], [up.place(error[i]) for i in front], where="post",
                    color="#222222", lw=2.6, alpha=0.35, zorder=1)
            ax.set_xlabel(context.title(cost_name))
            if row == 0:
                ax.set_title(context.title(error_name))
            curves = {m: [values[(cells["method"] == m).to_numpy()] for values in (cost, error)] for m in labels}
            shared.append((f"By {context.title(error_name)} over {context.title(cost_name)}",
                           one_line(ax, same(curves), lambda group: methods(group, labels))))
    handles = [Line2D([], [], label=names[m], **looks(m)) for m in labels]
    handles.append(Line2D([], [], color="#222222", lw=2.6, alpha=0.35, label="Pareto front"))
    handles += [Line2D([], [], ls="none", color="#555555", marker=letter(o), ms=7, label=o + _failed(cells, o))
                for o in sorted({o for o in cells["outcome"] if o != "ok"})]
    legend_right(figure, handles, legend_width)
    table = _table(context, cells, setting, costs, errors)
    reached = at_equal_cost(ranking.eligible(context, cells), costs[0], errors[0])
    compared = 0 if reached is None else int(reached[2]["error"].notna().sum())
    order = f"Markers grow with {setting}. " if setting else ""
    what, entry = found(context, cells, where, costs[0], errors[0])
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {where}"), RIGHT_FOR_COST, f"Cost against error: {where}",
                 what, cells["sweep"].iloc[0], figure, table, refused + noise.idle_seeds(cells) +
                 holes(cells, ["method", setting] if setting else ["method"]),
                 order + "A letter in the top band marks a failed run. The Pareto front joins the ranked runs that no other run "
                 "beats in both cost and error. Whiskers hold the median of repeats and seeds. " +
                 ranking.rule(max(map(len, cells["seeds"])), compared) +
                 ranking.raw(context, errors[0]) + " "
                 + noise.rule(noise.floor_of(context, cells["sweep"].iloc[0], "ms_per_step_median"))
                 + engine_notes(context, cells) + caption_of_lines(shared),
                 telling=True, headline=entry)


def _failed(cells, outcome):
    """The methods behind a letter of the top band: letters at one place are drawn as one letter with their number."""
    found = cells[cells["outcome"] == outcome].groupby("method", sort=True).size()
    return ":" + "".join(f"\n{method} {count}" for method, count in found.items()) if len(found) <= NAMED else ""


def ends_of_whiskers(cells, name, values):
    """The ends of the intervals that `whiskers` draws, for the limits of an axis."""
    found = [values(cell, name) for _, cell in cells[cells["outcome"] == "ok"].iterrows()]
    return [end for numbers in found if len(numbers) > 1 for end in noise.interval(numbers)]


def whiskers(ax, cell, cost_name, error_name, across, up, colour):
    """The interval of the median of the repeats in time, and of the seeds in error."""
    cost, error = cell[cost_name], cell[error_name]
    if cell["outcome"] != "ok" or not (math.isfinite(cost) and math.isfinite(error)):
        return
    for numbers, scale, along_x in ((measured.runs(cell, cost_name), across, True),
                                    (measured.seeds(cell, error_name), up, False)):
        if len(numbers) > 1:
            ends = [scale.place(v) for v in noise.interval(numbers)]
            x, y = (ends, [up.place(error)] * 2) if along_x else ([across.place(cost)] * 2, ends)
            ax.plot(x, y, color=colour, lw=0.9, alpha=0.7, zorder=2)


def _table(context, cells, setting, costs, errors):
    columns = {"method": cells["method"]}
    if setting:
        columns[setting] = cells[setting]
    columns["outcome"] = cells["outcome"]
    if max(map(len, cells["seeds"])) > 1:
        columns["seeds"], columns["seeds that failed"] = cells["seeds"].map(len), cells["failed_seeds"]
    columns["step"] = cells["step"]
    details = [name for name in context.metrics("world", "detail") if context.metric(name).compute]
    for name in [*costs, *errors, *(n for n in details if np.isfinite(metrics.column(cells, n)).any())]:
        columns |= quantity(context.title(name), context.unit(name), metrics.column(cells, name))
        for over, values in (("runs", measured.runs), ("seeds", measured.seeds)):
            found = [values(cell, name) for _, cell in cells.iterrows()]
            if any(len(mine) > 1 for mine in found):
                for end, place in (("low", 0), ("high", 1)):
                    columns |= quantity(f"{context.title(name)}, {end} end over {over}", context.unit(name),
                                        [noise.interval(mine)[place] for mine in found])
    first, second = costs[0], errors[0]
    result = at_equal_cost(cells, first, second)
    if result is not None:
        cost_budget, error_budget, table = result
        by = table.set_index("method")
        columns |= quantity(f"best {context.title(second)} within {si(cost_budget, context.unit(first))}", context.unit(second),
                          by["error"][cells["method"]])
        columns |= quantity(f"least {context.title(first)} for {si(error_budget, context.unit(second))}", context.unit(first),
                          by["cost"][cells["method"]])
    return pd.DataFrame(columns).sort_values(list(columns)[:2] if setting else ["method"])


WITHIN_BUDGET = "Which method is most accurate within a budget?"
TIME = "ms_per_step_median"


@of_sweeps("budgets", 21, WITHIN_BUDGET,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=(TIME,),
                 also="several values of a setting at several costs"),
           "Error within a budget", "No timed sweep of several methods at several costs is in this store.", "resolvers")
def error_within_budgets(context, cells):
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
    """The noise floor of a cost: 1 for counts, which have no noise."""
    return noise.floor_of(context, cells["sweep"].iloc[0], cost) if context.store.is_time(cost) else 1.0


def compared(context, cells, cost, error):
    """The number of ranked methods at each budget."""
    cells, least = ranking.eligible(context, cells), least_of(context, cells, cost)
    return [len(within(cells, cost, error, budget, least)) for budget in marks(cells, cost, error)]


def found_within(context, cells, where, costs, error):
    """The finding: per budget the methods with the smallest error."""
    unit, everyone, rows = context.unit(error), sorted(cells["method"].unique()), []
    what, why = context.title(error).removeprefix("largest "), ranking.unranked(context, cells)
    cells = ranking.eligible(context, cells)
    for cost in costs:
        for budget in marks(cells, cost, error):
            reached = within(cells, cost, error, budget, least_of(context, cells, cost))
            best, many = min(reached.values(), key=lambda cell: cell[error]), ranking.comparisons(len(reached))
            firsts = [m for m, cell in reached.items() if not ranking.better(best, cell, error, context.floor(error), many)]
            value = best[error] if best[error] > context.floor(error) else 0.0
            rows.append((cost, per_step(context, cost, budget), firsts, value))
    columns = {"within": [text for _, text, _, _ in rows] + [f"not ranked: {reason}" for reason in why.values()],
               "best": [methods(firsts, everyone) for _, _, firsts, _ in rows] + list(why),
               "ties": [len(firsts) if len(firsts) > 1 else None for _, _, firsts, _ in rows] + [None] * len(why),
               **quantity(f"smallest {what}", unit, [value for *_, value in rows] + [math.nan] * len(why))}
    table = cut(pd.DataFrame(columns), range(len(rows)))
    mine = [(text, firsts) for cost, text, firsts, _ in rows if cost == costs[0]]
    if not mine:
        return Finding(f"On {where} fewer than two ranked methods have a cost and an error.", table)
    always = sorted(set.intersection(*(set(firsts) for _, firsts in mine)))
    (low, first), (high, last) = mine[0], mine[-1]
    if always:
        tie = "ties for" if len(always) == 1 and any(len(firsts) > 1 for _, firsts in mine) else (
            "tie for" if len(always) > 1 else "has")
        at = f"at every budget from {low} to {high}" if high != low else f"within {low}"
        return Finding(f"On {where} {some(always, everyone)} {tie} the smallest {what} {at}.", table)
    return Finding(fits(f"On {where} {some(first, everyone)} {verb(len(first), 'have')} the smallest {what} within {low}, "
                        f"{some(last, everyone)} within {high}; no method is best at every budget.",
                        f"On {where} no method has the smallest {what} at every budget."), table)


def _chart(context, cells, where, setting, refused):
    error = metrics.errors_of(context, cells)[0]
    costs = [name for name in context.metrics("world", "cost") if marks(cells, name, error)][:2]
    if not costs:
        return None
    labels, looks = sorted(cells["method"].unique()), context.looks(cells)
    names = ranking.names(context, cells)
    width = legend_room(names.values(), 2.0)
    figure, axes = grid_of_axes(1, len(costs), 2.6, width, left=0.9, gap_x=0.9)
    rows, ranked, lines = [], [], set()
    for column, cost in enumerate(costs):
        ax = axes[0][column]
        ranked += compared(context, cells, cost, error)
        good = cells[(cells["outcome"] == "ok").to_numpy() & np.isfinite(metrics.column(cells, cost)) &
                     np.isfinite(metrics.column(cells, error))]
        across = ZeroLog(ax, "x", list(good[cost]), context.unit(cost), failures=False)
        up = ZeroLog(ax, "y", list(good[error]), context.unit(error), failures=False, floor=context.floor(error))
        lines |= set(good["method"])
        for method, part in good.groupby("method", sort=True):
            part = part.sort_values(cost)
            reached = np.minimum.accumulate(part[error].to_numpy(dtype=float))
            ends = [*part[cost], max(good[cost])]
            ax.step([across.place(v) for v in ends], [up.place(v) for v in (*reached, reached[-1])], where="post",
                    **{**looks(method), "lw": 1.3}, markevery=list(range(len(part))))
        for budget in marks(ranking.eligible(context, cells), cost, error):
            ax.axvline(budget, color="#999999", lw=0.8, ls=":", zorder=0.5)
            for method, cell in within(cells, cost, error, budget, least_of(context, cells, cost)).items():
                numbers = quantity(f"{context.title(cost)}, at most", context.unit(cost), [budget])
                numbers |= quantity(context.title(error), context.unit(error), [cell[error]])
                rows.append({"method": method, setting: cell[setting], **{name: v[0] for name, v in numbers.items()}})
        ax.set_xlabel(context.title(cost))
        ax.set_ylabel(f"least {context.title(error).removeprefix('largest ')}" if column == 0 else "")
    legend_right(figure, [Line2D([], [], label=names[m], **looks(m)) for m in labels if m in lines], width)
    return Chart(identifier(f"{cells['sweep'].iloc[0]} budgets {where}"), WITHIN_BUDGET, f"Least error within a budget: {where}",
                 found_within(context, cells, where, costs, error),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(rows), refused + holes(cells, ["method", setting]),
                 f"Each line is a method's least error over its values of {setting} that cost at most as much. Dotted lines are "
                 f"the "
                 "budgets of the table above. A time above a budget by no more than the noise is within it. "
                 + ranking.rule(max(map(len, cells["seeds"])), *ranked) + " " + noise.rule(
                     noise.floor_of(context, cells["sweep"].iloc[0], TIME)))
