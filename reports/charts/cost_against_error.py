# SPDX-License-Identifier: Zlib
"""What a step costs against how wrong it is, method by method, on one scene; and whose error is smallest within a budget."""

import itertools
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
from load import one_machine, split, varying
from sentences import does, listing, methods, verb
from style import (ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, letter, one_line, same, scale_of,
                   si, times)
from table import quantity

RIGHT_FOR_COST = "Which method is right for its cost?"
# Which errors a scene can show, its trials say; features and precisions are compared by charts of their own.
WHOSE = 6  # so many methods that failed are named in the legend


@of_sweeps("cost_against_error", 20, RIGHT_FOR_COST,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("ms_per_step_median",)),
           "Cost against error", "No timed sweep of several methods is in this store.", "resolvers")
def cost_against_error(context, cells):
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, context.metrics("world", "error", "detail")))
    groups = [c for c in ("scene", "dimension") if c in cells]
    made = []
    for part in split(cells, groups):
        # Whatever else varies inside a scene (a mass ratio, an angle) makes a chart of its own: unequal cells never meet.
        inner = varying(context.store, part, (*groups, *context.settings(part)[:1]))
        for equal in split(part, inner, sort=True):
            made.append(_cost_chart(context, equal, groups + inner, refused))
    return made


def engine_notes(context, cells):
    """What whole engines do otherwise whatever is set; it stands where they are ranked."""
    said = {}
    for method, key in zip(cells["method"], cells["key"]):
        if key is not None and context.store.role(method) == "engine":
            trial = context.store.trials.loc[key, "canonical"]
            if "engine" in trial:
                said[method] = f" {method} is a whole engine, here in {trial['precision']}: {trial['engine']['differs']}."
    return "".join(said[method] for method in sorted(said))


def at_equal_cost(cells, cost_name, error_name):
    """What each method reaches at equal cost (`at`: in which cell), and pays at equal error; the budgets are those that every
    method meets."""
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


def not_ok(cells):
    """Which methods failed, in how many of their cells."""
    failed, planned = cells[cells["outcome"] != "ok"], cells.groupby("method").size()
    fails = [f"{method} {len(part)} of {planned[method]}" for method, part in failed.groupby("method", sort=True)]
    return (f" Not ok ({listing(sorted(set(failed['outcome'])))}): {listing(fails)} {'cell' if planned.max() == 1 else 'cells'}."
            if fails else " Every cell finished.")


def finding(context, cells, where, cost_name, error_name):
    unit, floor, title = context.unit(error_name), context.floor(error_name), context.title(error_name)
    tail = not_ok(cells) + ranking.tail(context, cells)
    everyone, cells = sorted(cells["method"].unique()), ranking.eligible(context, cells)
    result = at_equal_cost(cells, cost_name, error_name)
    if result is None:
        return f"On {where} no method finished with a cost and an error.{tail}"
    cost_budget, _, table = result
    table["error"] = table["error"].where(~(table["error"] <= floor), 0.0)
    shown = table.dropna(subset=["error"])
    best, worst = shown.loc[shown["error"].idxmin()], shown.loc[shown["error"].idxmax()]
    what, least, most = title.removeprefix("largest "), si(best["error"], unit), si(worst["error"], unit)
    if len(shown) == 1:
        return f"On {where} only {best['method']} finishes, with {title} {least}.{tail}"
    within = f"within {si(cost_budget, context.unit(cost_name))} per step"
    if worst["error"] == best["error"]:
        return f"On {where} {methods(shown['method'], everyone)} have the same {what} ({least}) {within}.{tail}"
    cell = {method: cells.loc[at] for method, at in zip(shown["method"], shown["at"])}
    seeds, many = max(map(len, cells["seeds"])), ranking.comparisons(len(shown))
    # Whom the best does not beat beyond doubt is as good.
    firsts = [m for m in shown["method"] if not ranking.better(cell[best["method"]], cell[m], error_name, floor, many)]
    if len(firsts) == len(shown):
        return (f"On {where}, {within}, the order by {what} of {methods(shown['method'], everyone)} is not told from chance: "
                f"a tie ({least} to {most} in the median of {seeds}).{tail}")
    # What reads alike is one: no method is the worst of eight that err the same.
    lasts = [m for m, e in zip(shown["method"], shown["error"]) if si(e, unit) == most and m not in firsts]
    setting = next(iter(context.settings(cells)), None)
    head = (f"On {where}, {within} (every method that finishes has a setting below it), {does(firsts, 'have', everyone)}"
            f"{f', over {seeds} seeds,' if seeds > 1 else ''} the smallest {what} ({least}{at_setting(cell, firsts, setting)})")
    tail = against_baseline(context, cells, cost_name, error_name) + tail
    if not lasts:  # the smallest and the largest read alike
        return f"{head}; the others {verb(len(shown) - 1, 'differ')} by less than three digits show.{tail}"
    who = f"{methods(lasts, everyone)} the largest" if len(lasts) == 1 else (
        f"{len(lasts)} of {len(shown)}, {methods(lasts, everyone)}, the same largest")
    ratio = times(worst["error"] / best["error"]) if best["error"] > 0 else "1.0"
    much = f", {ratio} times as much" if ratio != "1.0" else ""
    return f"{head} and {who} ({most}{at_setting(cell, lasts, setting)}{much}).{tail}"


def at_setting(cell, named, setting):
    """At which values of the setting these methods reach what is told: at equal cost they need not be the same."""
    values = sorted({cell[m][setting] for m in named if cell[m][setting] == cell[m][setting]}) if setting else []
    return f" at {setting}={listing(f'{v:g}' for v in values)}" if values else ""


def headline(context, cells, where, cost_name, error_name):
    """The errors that methods reach at equal cost."""
    cells = ranking.eligible(context, cells)
    result = at_equal_cost(cells, cost_name, error_name)
    if result is None:
        return None
    cost_budget, _, table = result
    floor, unit = context.floor(error_name), context.unit(error_name)
    errors = {m: 0.0 if e <= floor else e for m, e in zip(table["method"], table["error"])}
    known = {m: e for m, e in errors.items() if e == e}
    if len(known) < 2:
        return None
    least, most = si(min(known.values()), unit), si(max(known.values()), unit)
    best, worst = ([m for m in known if si(known[m], unit) == text] for text in (least, most))  # what reads alike is a tie
    failed = [m for m in errors if m not in known]
    ends = [cells.loc[table.set_index("method")["at"][group[0]]] for group in (best, worst)]
    # A tie, or one between seeds.
    if not failed and (best == worst or not ranking.better(*ends, error_name, floor, ranking.comparisons(len(known)))):
        return None
    what, setting = context.title(error_name).removeprefix("largest "), next(iter(context.settings(cells)), None)
    cell = {method: cells.loc[at] for method, at in zip(table["method"], table["at"]) if method in known}
    ats = [at_setting(cell, group, setting) for group in (best, worst)]
    ats = ats if ats[0] != ats[1] else ["", ""]  # like with like needs no word
    return Headline(f"On {where}, within {si(cost_budget, context.unit(cost_name))} per step, "
                    f"{does(best, 'have', list(errors))} the smallest {what}, {least}{ats[0]}"
                    + (f"; {does(worst, 'have', list(errors))} {most}{ats[1]}" if worst != best
                       else "")
                    + (f"; {does(failed, 'fail', list(errors))}." if failed else "."),
                    errors, unit, context.title(error_name),
                    ends=final_states(cells.loc[[at for at in table["at"] if at is not None and at == at]]))


def against_baseline(context, cells, cost_name, error_name):
    """The best of the others against what the sweep compares with, at the largest setting of both."""
    setting, base, everything = next(iter(context.settings(cells)), None), context.baseline(cells), cells
    cells = ranking.eligible(context, cells)
    if setting:
        cells = cells[(cells[setting] == cells[setting].max()) | cells[setting].isna()]
    named = cells[cells["method"] == base]
    others = cells[(cells["method"] != base) & (cells["outcome"] == "ok")]
    if not len(named) or not np.isfinite(metrics.column(others, error_name)).any():
        return ""
    row, best = named.iloc[0], others.iloc[int(np.nanargmin(metrics.column(others, error_name)))]
    most = cells[setting].max() if setting else math.nan
    at = f"At {setting} = {most:g} " if best.get(setting) == most else (
        f"Beside {base} at {setting} = {most:g}, and without {setting}, " if most == most else "Here ")
    named = f'"{base}"' if " " in base else base  # a label may be words, which would run on in a sentence
    if row["outcome"] != "ok":
        step = "" if row["step"] != row["step"] else f" at step {int(row['step'])}"
        return f" {at}{best['method']} stands where {named} fails ({row['outcome']}{step})."
    costs, errors = (best[cost_name], row[cost_name]), (best[error_name], row[error_name])
    if not all(map(math.isfinite, costs + errors)) or not costs[1] or max(errors) <= context.floor(error_name):
        return ""
    ratio = errors[0] / errors[1] if errors[1] > 0 else math.inf
    how = "with the same error" if abs(ratio - 1) < 0.005 else f"with {times(ratio)} times its error"
    how = f"with an error where {named} has none" if math.isinf(ratio) else how if ratio else "without error"
    if not context.store.is_time(cost_name):
        return f" {at}{best['method']} takes {times(costs[0] / costs[1])} times the {context.title(cost_name)} of {named} {how}."
    text = noise.said(row, best, cost_name, noise.floor_of(context, everything["sweep"].iloc[0], cost_name))
    time = f"takes {times(costs[0] / costs[1])} times the time of {named}"
    if text == noise.SAME_WORK:
        time = f"does the same work as {named}, by all counts,"
    elif text in noise.IN_WORDS:
        time = f"takes the time of {named}, {noise.IN_WORDS[text]},"
    return f" {at}{best['method']} {time} {how}."


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
            across = ZeroLog(ax, "x", cost, context.unit(cost_name), failed_name="none")
            up = ZeroLog(ax, "y", error, context.unit(error_name), floor=context.floor(error_name))
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
    handles += [Line2D([], [], ls="none", color="#555555", marker=letter(o), ms=7, label=o + _whose(cells, o))
                for o in sorted({o for o in cells["outcome"] if o != "ok"})]
    legend_right(figure, handles, legend_width)
    table = _table(context, cells, setting, costs, errors)
    reached = at_equal_cost(ranking.eligible(context, cells), costs[0], errors[0])
    compared = 0 if reached is None else int(reached[2]["error"].notna().sum())
    order = f"Along a line {setting} grows with the marker. " if setting else ""
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {where}"), RIGHT_FOR_COST, f"Cost against error: {where}",
                 finding(context, cells, where, costs[0], errors[0]), cells["sweep"].iloc[0], figure, table,
                 refused + noise.idle_seeds(cells) + holes(cells, ["method", setting] if setting else ["method"]),
                 order + "A letter in the top band is a run that failed. The front joins the ranked runs that no other "
                 "beats in both. Whiskers hold the median of repeats and seeds. " +
                 ranking.rule(max(map(len, cells["seeds"])), compared) +
                 ranking.raw(context, errors[0]) + " "
                 + noise.rule(noise.floor_of(context, cells["sweep"].iloc[0], "ms_per_step_median"))
                 + engine_notes(context, cells) + caption_of_lines(shared),
                 telling=True, headline=headline(context, cells, where, costs[0], errors[0]))


def _whose(cells, outcome):
    """Whose letters stand in the top band, where letters that would lie on one another are one with a number."""
    found = cells[cells["outcome"] == outcome].groupby("method", sort=True).size()
    return ":" + "".join(f"\n{method} {count}" for method, count in found.items()) if len(found) <= WHOSE else ""


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


WITHIN_BUDGET = "Which method is right within a budget?"
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
    """The noise of a cost: counts have none."""
    return noise.floor_of(context, cells["sweep"].iloc[0], cost) if context.store.is_time(cost) else 1.0


def compared(context, cells, cost, error):
    """How many methods have a rank at each budget."""
    cells, least = ranking.eligible(context, cells), least_of(context, cells, cost)
    return [len(within(cells, cost, error, budget, least)) for budget in marks(cells, cost, error)]


def finding_of_budgets(context, cells, cost, error):
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
    said = [finding_of_budgets(context, cells, cost, error) for cost in costs]
    return Chart(identifier(f"{cells['sweep'].iloc[0]} budgets {where}"), WITHIN_BUDGET, f"Least error within a budget: {where}",
                 f"On {where} the smallest {context.title(error).removeprefix('largest ')} is, " + "; ".join(said) + "."
                 + ranking.tail(context, cells),
                 cells["sweep"].iloc[0], figure, pd.DataFrame(rows), refused + holes(cells, ["method", setting]),
                 f"Each line is the least error of a method over its values of {setting} that cost at most as much; dotted lines "
                 "are the budgets that the finding compares. What is not named at a budget errs more, or has no run that "
                 "cheap: a time above the budget by no more than the noise is within it. "
                 + ranking.rule(max(map(len, cells["seeds"])), *ranked) + " " + noise.rule(
                     noise.floor_of(context, cells["sweep"].iloc[0], TIME)))
