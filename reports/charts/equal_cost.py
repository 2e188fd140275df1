# SPDX-License-Identifier: Zlib
"""Methods at equal cost, or at equal error: each at the setting that meets a budget, ranked at every budget."""

import dataclasses
import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from load import one_machine, split, varying
from sentences import clauses, does, listing, methods, plural
from style import ZeroLog, fallen, grid_of_axes, legend_right, legend_room, letter, scale_of, si, times
from table import quantity

SECTION = "Which method is best at equal cost, and which is cheapest at equal error?"
PANELS = 3
NAMED = 3  # so many between first and last are named in a sentence; of more the table tells
SPARE = 0.5  # what spends less of the budget is told


@of_sweeps("equal_cost", 15, SECTION,
           Needs("world", methods=(2, math.inf), calibrated=True),
           "Equal cost", "No sweep that calibrates its methods is in this store.", "equal_cost")
def equal_cost(context, cells):
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, context.metrics("world", "error", "detail")))
    about = context.store.sweep(cells["sweep"].iloc[0]).calibrate
    groups = [c for c in ("scene", "dimension") if c in cells]
    made = []
    for part in split(cells, groups):
        inner = varying(context.store, part, (*groups, "budget", "seed", about["setting"], "precision"))
        for equal in split(part, inner, sort=True):
            made.append(_chart(context, equal, about, groups + inner, refused))
    return made


def ranked_metrics(context, cells, about):
    """What methods are ranked by: errors where the cost is equal, costs where the error is."""
    if about["equal"] == "cost":
        return metrics.errors_of(context, cells)[:PANELS]
    costs = context.metrics("world", "cost")
    return [name for name in costs if np.isfinite(metrics.column(cells, name)).any()][:2] or costs[:1]


def other_cost(context, cells, about):
    """The cost that was not made equal, where it was measured: a time beside counts, a count beside times. None where there is
    none, or where it is what ranks."""
    if about["equal"] != "cost":
        return None
    costs = [name for name in context.metrics("world", "cost") if name != about["metric"]]
    return next((name for name in costs if np.isfinite(metrics.column(cells, name)).any()), None)


def spread(part, name):
    """(median, lowest, highest) over the cells of one method: its seeds, and the repeats of a time."""
    ok = part[part["outcome"] == "ok"]
    values = metrics.column(ok, name)
    if not len(part) or len(ok) < len(part) or not np.isfinite(values).all():
        return math.nan, math.nan, math.nan
    every = [v for (_, cell), value in zip(ok.iterrows(), values)
             for v in (value, *measured.runs(cell, name), *measured.seeds(cell, name))]
    return float(np.median(values)), min(every), max(every)


def candidates(cells, name, excused=()):
    """The methods that may have a rank: they finished at the budget, and did what their names say."""
    return [method for method, part in cells.groupby("method", sort=True)
            if method not in excused and not math.isnan(spread(part, name)[0])]


def ranks(cells, name, floor=0.0, least=None, excused=()):
    """Rows (rank, method, median, lowest, highest), the best first. A rank counts what is better beyond doubt (ranking.py; of a
    time also beyond the noise, `least`); methods that no other beats share the first, a tie. What failed, met no budget or is
    `excused` has no rank."""
    parts = {method: part for method, part in cells.groupby("method", sort=True)}
    rows = [(method, *spread(part, name)) for method, part in parts.items()]
    known = candidates(cells, name, excused)
    many, made = ranking.comparisons(len(known)), []
    for method, median, low, high in rows:
        better = sum(ranking.better(parts[other], parts[method], name, floor, many) and
                     (least is None or noise.tells(parts[other].iloc[0], parts[method].iloc[0], name, least))
                     for other in known if other != method)
        made.append((1 + better if method in known else None, method, median, low, high))
    return sorted(made, key=lambda row: (row[0] is None, row[0] or 0, row[2]))


def ranked(context, here, name):
    """The ranks at one budget."""
    least = noise.floor_of(context, here["sweep"].iloc[0], name) if context.store.is_time(name) else None
    return ranks(here, name, context.floor(name), least, ranking.unranked(context, here))


def without(context, here, none):
    """Why these methods have no rank: `direct_lcp costs more; naive fails; admm is not ranked (60 % Gauss-Seidel)`."""
    why, found = ranking.excused(context, here), {}
    for method in none:
        part = here[here["method"] == method]
        bad, excuse = part[part["outcome"] != "ok"], [why[index] for index in part.index if index in why]
        reason = str(bad["reason"].iloc[0]) if len(bad) else ""
        if len(bad) and set(bad["outcome"]) == {"unsupported"} and "the budget is" in reason and " ends in " not in reason:
            found.setdefault("over", []).append(method)
        elif len(bad):
            found.setdefault("fails", []).append(method)
        else:
            found.setdefault(excuse[0] if excuse else "", []).append(method)
    everyone = list(dict.fromkeys(here["method"]))
    said = []
    for key, group in found.items():
        one = len(group) == 1
        words = {"over": "needs more" if one else "need more", "fails": "fails" if one else "fail",
                 "": "has no number" if one else "have no number"}.get(key, f"{'is' if one else 'are'} not ranked ({key})")
        said.append(f"{methods(group, everyone)} {words}")
    return said


def spare(context, here, about, ranks_of):
    """What has a rank and spends less than SPARE of the budget: it is not of equal cost."""
    if about["equal"] != "cost":
        return ""
    low = [(method, found) for rank, method, *_ in ranks_of if rank is not None and
           (found := spread(here[here["method"] == method], about["metric"])[0]) < SPARE * here["budget"].iloc[0]]
    return f" ({listing(f'{method} spends {said_of(context, about, found)}' for method, found in low)})" if low else ""


def finding(context, cells, about, where, name):
    everyone, what = sorted(cells["method"].unique()), context.title(name).removeprefix("largest ")
    said, firsts = [], []
    for budget, here in cells.groupby("budget", sort=True):
        table = ranked(context, here, name)
        firsts.append({row[1] for row in table if row[0] == 1})
        none = sorted(row[1] for row in table if row[0] is None)
        said += [f"At {said_of(context, about, budget)}{spare(context, here, about, table)} "
                 f"{_order([row for row in table if row[0] is not None], everyone, context.unit(name))}",
                 none and f"Without a rank: {'; '.join(without(context, here, none))}"]
    always = sorted(set.intersection(*firsts))
    if len(firsts) > 1:
        said.append(f"First at every budget: {listing(always)}" if always else "No method is first at every budget")
    return (f"On {where} methods are ranked by {what} at equal {about['equal']} ({context.title(about['metric'])}). "
            f"{clauses(*said, between='. ')}.")


def _order(placed, everyone, unit):
    """Those that have a rank: the first, a few between, the last."""
    best = [row for row in placed if row[0] == 1]
    if len(placed) == 1:
        return f"only {placed[0][1]} has a rank ({si(placed[0][2], unit)})"
    if not best:
        return "no method has a rank"
    first = f"{does([row[1] for row in best], 'tie', everyone, one='is')} first ({si(best[0][2], unit)})"
    last, between = placed[-1], [row for row in placed[:-1] if row[0] != 1]
    if last[0] == 1:
        return first
    then = [f"then {_tied([row for row in between if row[0] == place], unit)}" for place in sorted({row[0] for row in between})]
    return clauses(first, *(then if len(between) <= NAMED else ()), f"{last[1]} last ({si(last[2], unit)})", between=", ")


def _tied(rows, unit):
    """Those of one rank, and the median of the first."""
    return f"{listing(row[1] for row in rows)}{', tied' if len(rows) > 1 else ''} ({si(rows[0][2], unit)})"


def beside(context, cells, about, other):
    """What equal budgets of one cost hide of the other: the budget at which two methods are farthest apart in it."""
    if other is None:
        return ""
    unit, what = context.unit(other), context.title(other)
    least, found = noise.floor_of(context, cells["sweep"].iloc[0], other) if context.store.is_time(other) else 1.0, []
    for budget, here in cells.groupby("budget", sort=True):
        here = ranking.eligible(context, here)
        good = here[(here["outcome"] == "ok").to_numpy() & (metrics.column(here, other) > 0)]
        if good["method"].nunique() > 1:
            high, low = good.loc[good[other].idxmax()], good.loc[good[other].idxmin()]
            if noise.tells(low, high, other, least):
                found.append((noise.ratio(low, high, other), budget, high, low))
    if not found:
        return f" By {what} the methods are alike, {noise.IN_WORDS[noise.silence(least)]}." if least > 1 else ""
    ratio, budget, high, low = max(found, key=lambda row: row[0])
    return (f" What is equal by {context.title(about['metric'])} is not so by {what}: at {said_of(context, about, budget)} "
            f"{high['method']} has {times(ratio)} times that of {low['method']} ({si(high[other], unit)} against "
            f"{si(low[other], unit)}).")


def stopped(cells, about):
    """Cells whose method had the largest setting that is searched and still budget left."""
    if about["equal"] != "cost" or "most" not in about:
        return cells.iloc[:0]
    spent = metrics.column(cells, about["metric"])
    return cells[(cells[about["setting"]] == about["most"]).to_numpy() & (spent < cells["budget"].to_numpy(float))]


def at_start(cells):
    """A warning where seeds put one body into another: what is ranked may be that."""
    deep = ranking.overlapping(cells)
    return f" Bodies overlap by up to {si(deep, 'm')} at the start, which no method has made." if deep else ""


def not_used(context, cells, about):
    """What could not spend the budget, and what was spent."""
    said = [f"{row['method']} at {said_of(context, about, row['budget'])} ({said_of(context, about, row[about['metric']])} spent)"
            for _, row in stopped(cells, about).drop_duplicates(["budget", "method"]).iterrows()]
    return (f" Stopped by the largest value of {about['setting']} that is searched, {about['most']:,}, with budget left: "
            f"{listing(said)}." if said else "")


def headline(context, cells, about, where, name):
    """The budget at which those that have a rank are farthest apart."""
    unit, found, firsts = context.unit(name), [], []
    for budget, here in cells.groupby("budget", sort=True):
        table = ranked(context, here, name)
        best, placed = [row[1] for row in table if row[0] == 1], [row for row in table if row[0] is not None]
        firsts += [set(best)] if best else []
        if best and placed[-1][0] != 1:
            none = without(context, here, [row[1] for row in table if row[0] is None])
            fail = f"; {', '.join(none)}" if none else ""
            apart = placed[-1][2] / placed[0][2] if placed[0][2] > 0 else math.inf
            found.append((apart, Headline(
                f"On {where}, within {said_of(context, about, budget)} ({context.title(about['metric'])})"
                f"{spare(context, here, about, table)}, "
                f"{does(best, 'tie for', [row[1] for row in table], one='has')} the smallest "
                f"{context.title(name).removeprefix('largest ')}, {si(placed[0][2], unit)}; {placed[-1][1]} has "
                f"{si(placed[-1][2], unit)}{fail}.", {row[1]: row[2] if row[0] else math.nan for row in table}, unit,
                context.title(name), ends=final_states(here))))
    most = max(found, key=lambda pair: pair[0], default=(0, None))[1]
    if most and not set.intersection(*firsts):  # the sentence stands for one budget
        most = dataclasses.replace(most, text=f"{most.text[:-1]}; no method is first at every budget.")
    return most


def _chart(context, cells, about, axes, refused):
    where = describe(cells.iloc[0], axes)
    names, looks, other = ranked_metrics(context, cells, about), context.looks(cells), other_cost(context, cells, about)
    shown, full = names + ([other] if other else []), stopped(cells, about)
    labels, budgets = sorted(cells["method"].unique()), sorted(cells["budget"].unique())
    called = ranking.names(context, cells)
    legend_width = legend_room(called.values(), 2.0)
    columns = 2 if len(shown) == 4 else len(shown)
    figure, panels = grid_of_axes(-(-len(shown) // columns), columns, 2.7, legend_width, left=0.95, gap_x=0.95)
    # Methods stand side by side at a budget, or equal values would hide one another.
    gap = min([math.log(b / a) for a, b in zip(budgets, budgets[1:])] or [1.0])
    beside_at = {label: math.exp(0.2 * gap * ((i + 0.5) / len(labels) - 0.5)) for i, label in enumerate(labels)}
    for ax, name in zip(panels.flat, shown):
        values = {label: [spread(cells[(cells["method"] == label) & (cells["budget"] == b)], name) for b in budgets]
                  for label in labels}
        ZeroLog(ax, "x", [b * s for b in budgets for s in beside_at.values()], context.unit(about["metric"]), failures=False)
        ax.set_xticks(budgets, [said_of(context, about, b) for b in budgets])
        up = ZeroLog(ax, "y", [v for row in values.values() for v in np.ravel(row)], context.unit(name), failed_name="none",
                     floor=context.floor(name))
        for label in labels:
            look, x = looks(label), [b * beside_at[label] for b in budgets]
            good = [(at, v) for at, v in zip(x, values[label]) if math.isfinite(v[0])]
            ax.plot([at for at, _ in good], [up.place(v[0]) for _, v in good], lw=1, alpha=0.6, **{**look, "marker": None})
            for at, (median, low, high) in good:
                ax.plot([at, at], [up.place(low), up.place(high)], color=look["color"], lw=1.2)
                ax.plot([at], [up.place(median)], **{**look, "linestyle": "none", "markersize": 6 * scale_of(look["marker"])})
        for _, row in full.drop_duplicates(["budget", "method"]).iterrows():
            middle = values[row["method"]][budgets.index(row["budget"])][0]
            ax.plot([row["budget"] * beside_at[row["method"]]], [up.place(middle)], ls="none", marker="o", ms=12, mfc="none",
                    mec="#444444", mew=1)
        bad = cells[cells["outcome"] != "ok"].drop_duplicates(["budget", "method"])
        fallen(ax, [(row["budget"], up.failed, row["outcome"], looks(row["method"])["color"]) for _, row in bad.iterrows()])
        ax.set_title(context.title(name))
        ax.set_xlabel(f"budget: {context.title(about['metric'])}")
    handles = [Line2D([], [], label=called[label], **looks(label)) for label in labels]
    handles += [Line2D([], [], ls="none", marker="o", ms=10, mfc="none", mec="#444444", label=f"at {about['most']:,}, the most")
                ] if len(full) else []
    handles += [Line2D([], [], ls="none", color="#555555", marker=letter(o), ms=7, label=o)
                for o in sorted({o for o in cells["outcome"] if o != "ok"})]
    legend_right(figure, handles, legend_width)
    setting = about["setting"]
    found = "the most that stays within the budget" if about["equal"] == "cost" else "the fewest that err no more than that"
    seeds = len({seed for of_cell in cells["seeds"] for seed in of_cell})
    compared = [len(candidates(here, names[0], ranking.unranked(context, here))) for _, here in cells.groupby("budget")]
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {where}"), SECTION, f"At equal {about['equal']}: {where}",
                 finding(context, cells, about, where, names[0]) + beside(context, cells, about, other)
                 + not_used(context, cells, about) + at_start(cells), cells["sweep"].iloc[0], figure,
                 _table(context, cells, about, shown), refused + holes(cells, ["method", "budget"]),
                 f"Each method runs with {found} ({setting}, found by the runner; the table has them), "
                 f"{plural(seeds, 'seed')}. Methods stand side by side at a budget, up to {max(beside_at.values()) - 1:.0%} "
                 "beside it, so that each is seen; bars are the range over seeds and repeats. A letter in the top band failed or "
                 f"met no budget; C×3 are three. {ranking.rule(seeds, *compared)}{ranking.raw(context, names[0])}"
                 + counted(context, cells, about, other, full),
                 telling=True,
                 headline=headline(context, cells, about, where, names[0]))


def counted(context, cells, about, other, full):
    """What the cost that was made equal leaves out, for the note."""
    text = " A ring is a method at the largest setting that is searched, with budget left." if len(full) else ""
    if about["metric"].startswith("work_"):
        text += (f" What is counted ({context.title(about['metric'])}) leaves out what a method does beside: contacts found, "
                 "rows prepared, the next row sought.")
    if other is not None and context.store.is_time(other):
        least = noise.floor_of(context, cells["sweep"].iloc[0], other)
        text += f" The {context.title(other)} has it all. {noise.rule(least)}"
    return text


def said_of(context, about, budget):
    unit = context.unit(about["metric"])
    return f"{budget:,.6g}" if unit == "1" and budget < 100 else f"{budget:,.0f}" if unit == "1" else si(budget, unit)


def _table(context, cells, about, names):
    rows = [(budget, *row[:2], here[here["method"] == row[1]], _over_best(context, here, names[0], table, row))
            for budget, here in cells.groupby("budget", sort=True) for table in [ranked(context, here, names[0])]
            for row in table]
    budgets, places, labels, parts, over = zip(*rows)
    table = {**quantity("budget", context.unit(about["metric"]), budgets), "rank": ["" if p is None else p for p in places],
             "method": labels, about["setting"]: [_settings(part[about["setting"]]) for part in parts],
             "outcome": [listing(sorted(set(part["outcome"]))) for part in parts]}
    if about["equal"] == "cost":
        table["budget spent [1]"] = [spread(part, about["metric"])[0] / budget for budget, part in zip(budgets, parts)]
    for title, values in zip(("", ", low end", ", high end"), zip(*over)):
        table |= quantity(f"{context.title(names[0])} over that of the first{title}", "1", values)
    beyond = [metrics.BEYOND_SLOP[name] for name in names[:1] if name in metrics.BEYOND_SLOP]
    for name in dict.fromkeys((about["metric"], *names, *beyond)):
        table.update(quantity(context.title(name), context.unit(name), [spread(part, name)[0] for part in parts]))
    return pd.DataFrame(table)


def _over_best(context, here, name, table, row):
    """(median, low, high) of the ratio to the first in the table, seed by seed; unknown without a rank."""
    placed = [found[1] for found in table if found[0] is not None]
    if row[1] not in placed:
        return math.nan, math.nan, math.nan
    first, mine = (here[here["method"] == method] for method in (placed[0], row[1]))
    return ranking.ratio(first, mine, name, context.floor(name), ranking.comparisons(len(placed)))


def _settings(values):
    """What was found; over seeds, from the smallest to the largest."""
    found = sorted(values.dropna().unique())
    return " to ".join(f"{value:g}" for value in dict.fromkeys((found[0], found[-1]))) if found else ""
