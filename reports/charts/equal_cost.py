# SPDX-License-Identifier: Zlib
"""Methods at equal cost or at equal error: each method at the setting that meets a budget, ranked at every budget."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from finding import TIE, Finding, cut, fits
from load import one_machine, split, varying
from sentences import listing, plural, some, verb
from style import ZeroLog, fallen, grid_of_axes, legend_right, legend_room, letter, scale_of, si, times
from table import quantity

SECTION = "Which method is best at equal cost, and which is cheapest at equal error?"
PANELS = 3
SPARE = 0.5  # the table marks methods that spend less than this share of the budget


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
    """The metrics that rank: errors at equal cost, costs at equal error."""
    if about["equal"] == "cost":
        return metrics.errors_of(context, cells)[:PANELS]
    costs = context.metrics("world", "cost")
    return [name for name in costs if np.isfinite(metrics.column(cells, name)).any()][:2] or costs[:1]


def other_cost(context, cells, about):
    """The measured cost that was not made equal: a time beside counts, a count beside times. None at equal error, where costs
    rank."""
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
    """The methods that are ranked: they finished at the budget, and no other method did their work."""
    return [method for method, part in cells.groupby("method", sort=True)
            if method not in excused and not math.isnan(spread(part, name)[0])]


def ranks(cells, name, floor=0.0, least=None, excused=()):
    """Rows (rank, method, median, lowest, highest), the best first. A method's rank is 1 plus the number of methods that are
    significantly better (ranking.py) and, for a time, beyond the noise floor `least`. Methods that none beats tie for the first
    rank. Methods that failed, met no budget or are `excused` have no rank."""
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


def without(context, here, method):
    """Why this method has no rank: `needs more`, `failed: collapsed` or `not ranked: 60 % Gauss-Seidel`."""
    part, why = here[here["method"] == method], ranking.excused(context, here)
    bad, excuse = part[part["outcome"] != "ok"], [why[index] for index in part.index if index in why]
    reason = str(bad["reason"].iloc[0]) if len(bad) else ""
    if len(bad) and set(bad["outcome"]) == {"unsupported"} and "the budget is" in reason and " ends in " not in reason:
        return "needs more"
    if len(bad):
        return f"failed: {listing(sorted(set(bad['outcome'])))}"
    return f"not ranked: {excuse[0]}" if excuse else "no number"


def found(context, cells, about, where, name, other):
    """(finding, entry of the first screen or None). The entry shows the budget at which ranked methods differ most."""
    everyone, unit, title = sorted(cells["method"].unique()), context.unit(name), context.title(name)
    what, winners, apart, columns, order = title.removeprefix("largest "), [], [], {"method": everyone}, {}
    most = farthest(context, cells, about, other)
    for budget, here in cells.groupby("budget", sort=True):
        rows = {row[1]: row for row in ranked(context, here, name)}
        firsts, at = sorted(m for m, row in rows.items() if row[0] == 1), said_of(context, about, budget)
        placed = [row for row in rows.values() if row[0] is not None]
        ties = [rank for rank in {row[0] for row in placed} if sum(row[0] == rank for row in placed) > 1]
        marks = _marks(context, here, about)
        columns |= quantity(f"{what} at {at}", unit, [rows[m][2] if m in rows and rows[m][0] else math.nan for m in everyone])
        columns[f"rank at {at}"] = [
            "not run" if m not in rows else without(context, here, m) if rows[m][0] is None else
            ", ".join([str(rows[m][0]), *[TIE] * (rows[m][0] in ties), *marks.get(m, ())]) for m in everyone]
        if other and most and most[1] == budget:
            by = {m: spread(part, other)[0] for m, part in here.groupby("method")}
            columns |= quantity(f"{context.title(other)} at {at}", context.unit(other), [by.get(m, math.nan) for m in everyone])
        order = {m: (rows.get(m, (None,))[0] or math.inf, rows[m][2] if m in rows and rows[m][0] else order.get(m, (0, 0))[1])
                 for m in everyone}
        if firsts:
            winners.append((at, firsts, rows[min(firsts, key=lambda m: rows[m][2])][2]))
        if firsts and placed[-1][0] != 1:
            best = rows[min(firsts, key=lambda m: rows[m][2])][2]
            values = {m: row[2] if row[0] else math.nan for m, row in rows.items()}
            apart.append((placed[-1][2] / best if best > 0 else math.inf, Headline(
                fits(*(f"On {where}, within {at} ({context.title(about['metric'])}), {some(firsts, rows)} "
                       f"{verb(len(firsts), 'tie for', 'has')} the smallest {what}, {si(best, unit)}{last}."
                       for last in (f"; {placed[-1][1]} has {si(placed[-1][2], unit)}", ""))),
                values, unit, title, ends=final_states(here))))
    table = pd.DataFrame(columns).iloc[sorted(range(len(everyone)), key=lambda i: order[everyone[i]])]
    entry = max(apart, key=lambda pair: pair[0], default=(0, None))[1]
    return Finding(_sentence(context, about, where, what, winners, everyone, cells["budget"].nunique()), cut(table)), entry


def _marks(context, here, about):
    """{method: what the table says beside its rank}: a budget that is not spent, or the largest setting that is searched."""
    marks = {}
    for method, part in here.groupby("method"):
        spent = spread(part, about["metric"])[0] if about["equal"] == "cost" else math.nan
        if spent < SPARE * here["budget"].iloc[0]:
            marks.setdefault(method, []).append(f"spends {said_of(context, about, spent)}")
    for method in stopped(here, about)["method"]:
        marks.setdefault(method, []).append(f"at the largest {about['setting']}, {about['most']:,}")
    return {method: list(dict.fromkeys(said)) for method, said in marks.items()}


def _sentence(context, about, where, what, winners, everyone, budgets):
    equal = f"equal {context.title(about['metric'])}"
    if not winners:
        return f"On {where} no method has a rank at {equal}."
    always, metric = sorted(set.intersection(*(set(firsts) for _, firsts, _ in winners))), context.title(about["metric"])
    if always:
        tie = verb(len(always), "tie for", "has" if all(len(firsts) == 1 for _, firsts, _ in winners) else "ties for")
        at = (f"at {winners[0][0]} ({metric})" if len(winners) == 1 else "at every budget") + (
            "; at the other budgets no method has a rank" if len(winners) < budgets else "")
        return fits(f"On {where}, at {equal}, {some(always, everyone)} {tie} the smallest {what} {at}.",
                    f"On {where} {some(always, everyone)} {tie} the smallest {what} {at}.",
                    f"On {where} {some(always, everyone, 1)} {tie} the smallest {what} {at}.")
    (low, first, _), (high, last, _) = winners[0], winners[-1]
    ends = (f"{some(first, everyone, 1)} {verb(len(first), 'have')} the smallest {what} at {low}, {some(last, everyone, 1)} at "
            f"{high}")
    return fits(f"On {where}, at {equal}, {ends}; no method is first at every budget.",
                f"On {where} {ends}; no method is first at every budget.", f"On {where}, at {equal}, {ends}.",
                f"On {where} {ends}.", f"On {where} no method is first at every budget of {equal}.")


def farthest(context, cells, about, other):
    """(ratio, budget, dearest cell, cheapest cell) where two methods differ most in the other cost; None where they do not."""
    if other is None:
        return None
    least = noise.floor_of(context, cells["sweep"].iloc[0], other) if context.store.is_time(other) else 1.0
    found = []
    for budget, here in cells.groupby("budget", sort=True):
        here = ranking.eligible(context, here)
        good = here[(here["outcome"] == "ok").to_numpy() & (metrics.column(here, other) > 0)]
        if good["method"].nunique() > 1:
            high, low = good.loc[good[other].idxmax()], good.loc[good[other].idxmin()]
            if noise.tells(low, high, other, least):
                found.append((noise.ratio(low, high, other), budget, high, low))
    return max(found, key=lambda row: row[0], default=None)


def beside(context, cells, about, other):
    """A sentence of the note: methods of equal cost differ in the other cost."""
    if other is None:
        return ""
    most, what = farthest(context, cells, about, other), context.title(other)
    if most is None:
        return f" The {what} of the methods differs by no more than noise." if context.store.is_time(other) else ""
    ratio, budget, high, low = most
    return (f" Equal {context.title(about['metric'])} can have different {what}: at {said_of(context, about, budget)} "
            f"{high['method']} has {times(ratio)} times that of {low['method']} ({si(high[other], context.unit(other))} against "
            f"{si(low[other], context.unit(other))}).")


def stopped(cells, about):
    """Cells at the largest setting that is searched, with budget left."""
    if about["equal"] != "cost" or "most" not in about:
        return cells.iloc[:0]
    spent = metrics.column(cells, about["metric"])
    return cells[(cells[about["setting"]] == about["most"]).to_numpy() & (spent < cells["budget"].to_numpy(float))]


def at_start(cells):
    """A warning where seeds make bodies overlap at the start: the ranked error may be that overlap."""
    deep = ranking.overlapping(cells)
    return [f"Bodies overlap by up to {si(deep, 'm')} at the start, before any method acts."] if deep else []


def _chart(context, cells, about, axes, refused):
    where = describe(cells.iloc[0], axes)
    names, looks, other = ranked_metrics(context, cells, about), context.looks(cells), other_cost(context, cells, about)
    shown, full = names + ([other] if other else []), stopped(cells, about)
    labels, budgets = sorted(cells["method"].unique()), sorted(cells["budget"].unique())
    called = ranking.names(context, cells)
    legend_width = legend_room(called.values(), 2.0)
    columns = 2 if len(shown) == 4 else len(shown)
    figure, panels = grid_of_axes(-(-len(shown) // columns), columns, 2.7, legend_width, left=0.95, gap_x=0.95)
    # Methods are drawn side by side at a budget, or equal values would hide one another.
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
    meets = "the largest within the budget" if about["equal"] == "cost" else "the smallest that errs no more than the budget"
    seeds = len({seed for of_cell in cells["seeds"] for seed in of_cell})
    about_it, entry = found(context, cells, about, where, names[0], other)
    compared = [len(candidates(here, names[0], ranking.unranked(context, here))) for _, here in cells.groupby("budget")]
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {where}"), SECTION, f"At equal {about['equal']}: {where}",
                 about_it, cells["sweep"].iloc[0], figure, _table(context, cells, about, shown),
                 refused + at_start(cells) + holes(cells, ["method", "budget"]),
                 f"Each method runs with its own value of {setting}, {meets} ({plural(seeds, 'seed')}). Methods are drawn up to "
                 f"{max(beside_at.values()) - 1:.0%} beside their budget. Bars are the range over seeds and repeats. A letter in "
                 f"the top band failed or met no budget; C×3 are three. "
                 f"{ranking.rule(seeds, *compared)}{ranking.raw(context, names[0])}"
                 + beside(context, cells, about, other) + counted(context, cells, about, other, full),
                 telling=True, headline=entry)


def counted(context, cells, about, other, full):
    """Sentences of the note: work that the equal cost does not count."""
    text = " A ring marks a method at the largest setting that is searched, with budget left." if len(full) else ""
    if about["metric"].startswith("work_"):
        text += (f" {context.title(about['metric'])[0].upper()}{context.title(about['metric'])[1:]} do not count other work of a "
                 "method: finding contacts, preparing rows, choosing the next row.")
    if other is not None and context.store.is_time(other):
        least = noise.floor_of(context, cells["sweep"].iloc[0], other)
        text += f" The {context.title(other)} includes it. {noise.rule(least)}"
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
    """(median, low, high) of the ratio to the best method, seed by seed; NaN without a rank."""
    placed = [found[1] for found in table if found[0] is not None]
    if row[1] not in placed:
        return math.nan, math.nan, math.nan
    first, mine = (here[here["method"] == method] for method in (placed[0], row[1]))
    return ranking.ratio(first, mine, name, context.floor(name), ranking.comparisons(len(placed)))


def _settings(values):
    """The setting, or over seeds its range, in words."""
    found = sorted(values.dropna().unique())
    return " to ".join(f"{value:g}" for value in dict.fromkeys((found[0], found[-1]))) if found else ""
