# SPDX-License-Identifier: Zlib
"""Frozen velocity problems: residual over multiply-adds and over time, performance profiles (Dolan and More 2002), and the
measured rate of convergence against the rate that the matrix predicts."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import over_steps
import ranking
from chart import Chart, Needs, describe, holes, identifier, of_sweeps
from finding import Finding, cut, ends
from load import one_machine, split
from sentences import plural, some, verb
from style import ZeroLog, grid_of_axes, legend_right, legend_room, plain_log, si, times
from table import quantity

SOLVES = "Which method solves the velocity problem of a step?"
RESIDUAL, COST, TO = "problem_residual", "multiply_adds", "multiply_adds_to_thousandth"
TIME = "ns_per_solve"
RATE, PREDICTED = "rate", "predicted_rate"
FLOOR = 1e-12  # of g dt: smaller values are rounding
ROWS, COLUMNS = 3, 3  # of panels
FAR = 100.0  # where the axis of the profiles ends, as a multiple of the best cost
SOLVED = 1e-3  # of g dt: largest residual of a solved problem, as in the metric TO
ALIKE = 2.0  # times are measured once, so times within this ratio tie


@of_sweeps("problems", 36, SOLVES,
           Needs("problems", methods=(2, math.inf)),
           "Residual over multiply-adds", "This store has no sweep of frozen problems.", "problems")
def frozen_problems(context, cells):
    rates = _rates(context, cells)
    cells = cells[cells["outcome"] != "unsupported"]
    starts = split(cells, ["start"], sort=True) if "start" in cells else [cells]
    curves = [made(context, part) for part in starts for made in (_over_cost, _over_time)]
    return [chart for chart in (*curves, _profile(context, cells), rates) if chart]


def problems(context, cells):
    """[(name, cells)] of one problem each, with equal settings. Only problems that were given to the most methods: any other
    would count for some methods and against none."""
    names = [name for name in ("problems", "problem", "start", "friction", "order", "dimension")
             if name in cells and (name == "problems" or cells[name].nunique(dropna=False) > 1)]
    parts = [part.drop_duplicates("method") for part in split(cells, names)]
    most = max((len(part) for part in parts), default=0)
    kept = [part for part in parts if len(part) == most]
    shown = [name for name in names if len({str(part[name].iloc[0]) for part in kept}) > 1]
    return [(", ".join(str(part[name].iloc[0]) for name in shown) or str(part["problems"].iloc[0]), part) for part in kept]


def profile(costs):
    """{method: (ratios, share of problems solved within that many times the best cost)}. `costs`: method -> its cost of each
    problem, infinite where it did not solve it. Problems that no method solves count, too: else easy problems could be chosen."""
    table = np.array([costs[method] for method in costs], dtype=float)
    best = np.where(np.isfinite(table), table, math.inf).min(axis=0)
    found = {}
    for method, row in zip(costs, table):
        ratio = np.sort([math.inf if not math.isfinite(b) else 1.0 if a == b else a / b if b > 0 else math.inf
                         for a, b in zip(row, best)])
        solved = ratio[np.isfinite(ratio)]
        found[method] = solved, np.arange(1, len(solved) + 1) / len(row)
    return found


def costs_of(context, cells):
    found, parts = {}, problems(context, cells)
    for method in sorted(cells["method"].unique()):
        mine = [part[part["method"] == method] for _, part in parts]
        values = [float(row[TO].iloc[0]) if len(row) and row["outcome"].iloc[0] == "ok" and not len(ranking.excused(context, row))
                  else math.nan for row in mine]
        found[method] = [value if math.isfinite(value) else math.inf for value in values]
    return found


def _handles(methods, looks):
    """`methods`: {method: its name}."""
    return [Line2D([], [], label=methods[m], **{**looks(m), "marker": None}) for m in methods]


def _start(cells):
    return str(cells["start"].iloc[0]) if "start" in cells else "warm"


def _drawn(context, parts, key, cost):
    """(figure of the residual of each method and problem over a series of costs, {trial: (costs, residuals)}). `key`: the column
    of the trials."""
    everyone = pd.concat([part for _, part in parts])
    looks, called = context.looks(everyone), dict(sorted(ranking.names(context, everyone).items()))
    shown = parts[:ROWS * COLUMNS]
    rows, columns = -(-len(shown) // COLUMNS), min(COLUMNS, len(shown))
    width = legend_room(called.values(), 1.75)
    figure, axes = grid_of_axes(rows, columns, 2.3, width, left=0.9, gap_x=0.5)
    for ax in axes.flat[len(shown):]:
        ax.set_visible(False)
    tracks = {trial: (context.store.series(trial, cost), context.store.series(trial, RESIDUAL))
              for trial in everyone[key].dropna()}
    tracks = {trial: track for trial, track in tracks.items() if track[0] is not None and track[1] is not None}
    values = [v for _, part in shown for trial in part[key] if trial in tracks for v in tracks[trial][1] if math.isfinite(v)]
    described = context.store.described_series[cost]
    for ax, (where, part) in zip(axes.flat, shown):
        scale = ZeroLog(ax, "y", values, failures=False, floor=FLOOR)
        mine = [tracks[trial] for trial in part[key] if trial in tracks]
        plain_log(ax, "x", [x for track in mine for x in track[0] if x > 0] or [1.0], described.unit)
        for method, trial in zip(part["method"], part[key]):
            if trial not in tracks:
                continue
            x, y = tracks[trial]
            good = (x > 0) & np.isfinite(y)
            point = len(set(x[good])) == 1  # a direct method, or one without a number of iterations
            look = looks(method) if point else {**looks(method), "marker": None}
            ax.plot(x[good], [scale.place(v) for v in y[good]], **look)
        ax.set_title(where, size=9)
        ax.set_xlabel(described.title)
    for row in axes:
        row[0].set_ylabel("residual / (g dt)")
    legend_right(figure, _handles(called, looks), width)
    return figure, tracks


def _holes(parts, cells):
    return [f"{where}: not drawn; the figure has {ROWS * COLUMNS} panels" for where, _ in parts[ROWS * COLUMNS:]] + holes(
        cells, ["problems", "problem", "method"])


def _table(cells, numbers):
    return pd.DataFrame({"problem": [describe(row, ["problems", "problem", "start", "order", "friction"])
                                     for _, row in cells.iterrows()],
                         "method": cells["method"].to_numpy(), "outcome": cells["outcome"].to_numpy(), **numbers})


def _not_ranked(context, parts):
    """{method: on how many problems it has no rank, and why}."""
    unranked = [ranking.unranked(context, part) for _, part in parts]
    return {method: f"not ranked on {sum(method in why for why in unranked)} of {len(parts)}: "
            f"{ranking.largest(why[method] for why in unranked if method in why)}"
            for method in sorted({method for why in unranked for method in why})}


def _ranks(context, parts, best_of, values_of, title, unit, label):
    """A row per method: on how many problems it is best or ties with the best, and the median and range of its values. Methods
    without a rank stand last, with the reason. `best_of`: methods of each problem; `values_of`: {method: values}."""
    why, rows = _not_ranked(context, parts), []
    for method, values in values_of.items():
        known = np.array([value for value in values if math.isfinite(value)])
        missing = f"no result on {len(values) - len(known)} of {len(values)}" if len(known) < len(values) else ""
        outcome = why.get(method, "") or missing
        rows.append((method in why, -sum(method in found for found in best_of), method, known, outcome))
    rows.sort(key=lambda row: row[:3])
    middle = [float(np.median(known)) if len(known) else math.nan for *_, known, _ in rows]
    return cut(pd.DataFrame({"method": [row[2] for row in rows], f"{label} [1]": [-row[1] for row in rows],
                             **quantity(f"median {title}", unit, middle),
                             "range": [ends(min(known), max(known), unit) if len(known) else "" for *_, known, _ in rows],
                             "outcome": [outcome for *_, outcome in rows]}))


def _most(best_of):
    """(methods that are best on the most problems, that number)."""
    count = {}
    for method in (method for found in best_of for method in found):
        count[method] = count.get(method, 0) + 1
    most = max(count.values(), default=0)
    return sorted(method for method in count if count[method] == most), most


def _over_cost(context, cells):
    parts = problems(context, cells)
    figure, _ = _drawn(context, parts, "key", COST)
    least = []
    for _, part in parts:
        part = ranking.eligible(context, part)
        part = part[(part["outcome"] == "ok") & np.isfinite(metrics.column(part, RESIDUAL))]
        values = part[RESIDUAL].astype(float)
        least.append(list(part[values <= max(values.min(), FLOOR)]["method"]) if len(part) else [])
    numbers, (first, most) = {}, _most(least)
    everyone = pd.concat([part for _, part in parts])
    values = {method: list(mine[RESIDUAL].astype(float).where(mine["outcome"] == "ok"))
              for method, mine in everyone.groupby("method", sort=True)}
    for name in (name for name in context.metrics("problems", "cost", "error") if name in cells):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(cells, name))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {_start(cells)} curves"), SOLVES,
                 f"Residual over multiply-adds, {_start(cells)} start",
                 Finding(f"After all iterations {some(first)} {verb(len(first), 'have')} the smallest residual on {most} of "
                         f"{plural(len(parts), 'problem')}." if first else "No ranked method finished a problem.",
                         _ranks(context, parts, least, values, "residual", "1", "smallest or tied on")),
                 cells["sweep"].iloc[0], figure, _table(cells, numbers), _holes(parts, cells),
                 "Lower left is better. Each method solves the same problem with 1, 2, 3, ... iterations. The residual (natural "
                 "map) is the largest error of a row by Coulomb's law with De Saxcé's correction, over the speed g dt of one "
                 f"step of gravity. Residuals below {FLOOR:g} tie.")


def time_to(residual, nanoseconds, residuals):
    """The time of the least number of iterations from which on the residual stays at most `residual`; infinite where there is
    none. Methods that cannot run without iterations have no time for 0 iterations."""
    above = [i for i, left in enumerate(residuals) if not left <= residual]
    rest = nanoseconds[above[-1] + 1 if above else 0:]
    return next((float(time) for time in rest if math.isfinite(time)), math.inf)


def _over_time(context, cells):
    """The chart of residuals over time; None where no trial is timed."""
    if TIME not in cells:
        return None
    cells, said = one_machine(context.store, cells)
    cells = cells.assign(key_timed=cells["key_timed"].where(np.isfinite(metrics.column(cells, TIME))))
    parts = [(where, part) for where, part in problems(context, cells) if part["key_timed"].notna().any()]
    if not parts:
        return None
    figure, tracks = _drawn(context, parts, "key_timed", TIME)
    took = {trial: time_to(SOLVED, *track) for trial, track in tracks.items()}
    quickest = []
    for _, part in parts:
        part = ranking.eligible(context, part)
        mine = {method: took.get(trial, math.inf) for method, trial in zip(part["method"], part["key_timed"])}
        best = min(mine.values(), default=math.inf)
        quickest.append([method for method, time in mine.items() if math.isfinite(best) and time < ALIKE * best])
    (first, most), title = _most(quickest), f"{context.title(TIME)}, to {SOLVED:g} g dt"
    times_of = {method: [took.get(trial, math.inf) for trial in mine["key_timed"]]
                for method, mine in pd.concat([part for _, part in parts]).groupby("method", sort=True)}
    numbers = quantity(context.title(TIME), context.unit(TIME), metrics.column(cells, TIME)) | quantity(
        title, context.unit(TIME), [took.get(trial, math.nan) for trial in cells["key_timed"]])
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {_start(cells)} times"), SOLVES,
                 f"Residual over time, {_start(cells)} start",
                 Finding(f"{some(first)} {verb(len(first), 'solve')} {most} of {plural(len(parts), 'problem')} to "
                         f"{SOLVED:g} g dt within {ALIKE:g} times the fastest method's time." if first else
                         f"No method solves a problem to {SOLVED:g} g dt.",
                         _ranks(context, parts, quickest, times_of, "time to solve", "ns", "fastest or tied on")),
                 cells["sweep"].iloc[0], figure, _table(cells, numbers), said + _holes(parts, cells),
                 "Lower left is better. A time is the processor time of a solve with that number of iterations, each from the "
                 "same start; the median of ten. A line that goes back means that more iterations took less time. Methods within "
                 f"{ALIKE:g} times the fastest tie, because each time is measured once. A witness's time includes preparing the "
                 "problem for its library.")


def _profile(context, cells):
    costs, looks, called = costs_of(context, cells), context.looks(cells), ranking.names(context, cells)
    found = profile(costs)
    if not any(len(solved) for solved, _ in found.values()):
        return None
    called = {method: called[method] for method in costs}
    width = legend_room(called.values(), 1.75)
    figure, axes = grid_of_axes(1, 1, 3.0, width, left=0.9)
    ax, most = axes[0][0], 1.0
    for method, (solved, share) in found.items():
        if not len(solved):
            continue
        x, y = solved[solved <= FAR], share[solved <= FAR]
        if not len(x):
            continue
        # The step rises from 0 at the first solved problem; the last part is level, because problems beyond FAR are not drawn.
        ax.step(np.concatenate([x[:1], x, [FAR]]), np.concatenate([[0.0], y, y[-1:]]), where="post",
                **{**looks(method), "marker": None})
        most = max(most, min(FAR, solved[-1]))
    plain_log(ax, "x", [1.0, max(2.0, most)])
    ax.set_ylim(0, 1.03)
    ax.set_xlabel("multiply-adds, as a multiple of the best method's")
    ax.set_ylabel("share of problems solved")
    legend_right(figure, _handles(called, looks), width)
    shares = {method: (share[-1] if len(share) else 0.0) for method, (_, share) in found.items()}
    wins = {method: float(np.mean([c == min(all_) and math.isfinite(c) for c, all_ in zip(mine, zip(*costs.values()))]))
            for method, mine in costs.items()}
    most_wins = max(wins.values())
    firsts, surest = [m for m in wins if wins[m] == most_wins], [m for m in shares if shares[m] == max(shares.values())]
    count, why = len(next(iter(costs.values()))), _not_ranked(context, problems(context, cells))
    order = sorted(costs, key=lambda m: (m in why, -shares[m], -wins[m], m))
    table = pd.DataFrame([{"method": m, "share solved": shares[m], "share cheapest": wins[m], "median multiple": float(
        np.median(found[m][0])) if len(found[m][0]) else math.nan, "outcome": why.get(m, "")} for m in order])
    return Chart(identifier(f"{cells['sweep'].iloc[0]} profile"), SOLVES, "Performance profile of multiply-adds",
                 Finding(f"{some(surest)} {verb(len(surest), 'solve')} the largest share of {plural(count, 'problem')} "
                         f"({si(100 * max(shares.values()))} %)"
                         f"{' and' if firsts == surest else '; ' + some(firsts)} {verb(len(firsts), 'are')} cheapest most often "
                         f"({si(100 * most_wins)} %).", cut(table)),
                 cells["sweep"].iloc[0], figure, table,
                 [f"{method}: {text}, not drawn" for method, text in _beyond(found, count).items()],
                 "Upper left is better. A performance profile (Dolan and Moré) shows the share of problems that a method solves "
                 "within a multiple of the best method's multiply-adds. A problem is solved when its residual stays below "
                 f"{SOLVED:g} g dt and no row was left to Gauss-Seidel. Methods that need more than {FAR:g} times the best are "
                 "listed below.")


def _beyond(found, count):
    """{method: how many problems it solves at a cost beyond the axis}."""
    more = {method: solved[solved > FAR] for method, (solved, _) in found.items()}
    return {method: f"{len(far)} more of {count} problems at {times(far.min())} times the best"
            f"{f' to {times(far.max())}' if len(far) > 1 else ''}" for method, far in more.items() if len(far)}


def _rates(context, cells):
    good = cells[(cells["outcome"] == "ok") & np.isfinite(metrics.column(cells, RATE)) &
                 np.isfinite(metrics.column(cells, PREDICTED))]
    if not len(good):
        return None
    looks, methods = context.looks(cells), sorted(good["method"].unique())
    width = legend_room(map(context.name, methods), 1.75)
    figure, axes = grid_of_axes(1, 1, 3.0, width, left=0.9)
    ax = axes[0][0]
    for method, part in good.groupby("method", sort=True):
        for order, mine in part.groupby("order", sort=True) if "order" in part else [("recorded", part)]:
            look = {**looks(method), "ls": "none", "fillstyle": "full" if order == "recorded" else "none"}
            ax.plot(mine[PREDICTED].astype(float), mine[RATE].astype(float), **look)
    low = float(min(good[PREDICTED].astype(float).min(), good[RATE].astype(float).min()))
    high = float(max(good[PREDICTED].astype(float).max(), good[RATE].astype(float).max()))
    ax.plot([low, high], [low, high], color="#888888", lw=1, ls=":")
    ax.set_xlabel("predicted: spectral radius")
    ax.set_ylabel("measured, per iteration")
    legend_right(figure, _handles({m: context.name(m) for m in methods}, looks), width)
    # The distance of a rate from 1 matters: it is inverse to the number of iterations.
    plain = good[good["method"] == "catto"]  # Gauss-Seidel; the spectral radius predicts its rate
    if not len(plain):
        return None
    need = (1 - plain[PREDICTED].astype(float)) / (1 - plain[RATE].astype(float))
    off = max(need.max(), 1 / need[need > 0].min()) if (need > 0).any() else math.inf
    table = good[["problems", "method"]].assign(**{name: good[name] for name in ("problem", "order") if name in good},
                                                predicted=good[PREDICTED].astype(float), measured=good[RATE].astype(float))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} rates"), SOLVES, "Predicted and measured convergence",
                 Finding(f"On {plural(len(plain), 'frictionless cell')} the spectral radius predicts catto's number of "
                         f"iterations to within {times(off)} times.", _rate_table(good)),
                 cells["sweep"].iloc[0], figure, table, [],
                 "On the dotted line the prediction is exact. The prediction is the spectral radius of the Gauss-Seidel "
                 "iteration (catto's) on the active rows of the converged solution, in the order in which they are solved; "
                 "hollow marks: coloured order. Only problems without friction and joints.")


def _rate_table(good):
    rows = []
    for (method, order), part in good.assign(order=good["order"] if "order" in good else "recorded").groupby(
            ["method", "order"], sort=True):
        predicted, measured = part[PREDICTED].astype(float), part[RATE].astype(float)
        need = (1 - predicted) / (1 - measured)
        rows.append({"method": method, "order of rows": order, "cells [1]": len(part), "predicted rate": ends(
            predicted.min(), predicted.max(), "1"), "measured rate": ends(measured.min(), measured.max(), "1"),
            "iterations, measured over predicted": ends(need.min(), need.max(), "1")})
    return cut(pd.DataFrame(rows))


MORE_ITERATIONS = "Do more iterations solve the contacts?"
SERIES, NORMALISED = "residual", "residual_median"


@of_sweeps("residual", 35, MORE_ITERATIONS,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"),
                 also="one seed, contacts and several values of a setting"),
           "Residual", "This store has no sweep of several methods with residuals.", "resolvers")
def residual(context, cells):
    if NORMALISED not in context.store.metrics or (cells["seeds"].map(len) > 1).any():
        return []  # an older store; or an ensemble, where one run says little
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        if nothing(part):
            continue  # no contacts, no residual
        shown, left_out, setting = over_steps.scenes(context, part)
        if setting and metrics.column(part[part["outcome"] == "ok"], NORMALISED).size:
            made.append(_chart(context, part, shown, left_out, setting))
    return made


def slopes(cells, setting):
    """Per method: its residual at both ends of one span of the setting, the same for all methods. Of the spans with the most
    methods finished at both ends it is the widest. Empty where there is none."""
    good = cells[(cells["outcome"] == "ok") & np.isfinite(metrics.column(cells, NORMALISED))].drop_duplicates(["method", setting])
    table = good.pivot(index="method", columns=setting, values=NORMALISED).sort_index(axis=1)
    values = list(table.columns)
    spans = [(least, most) for i, least in enumerate(values) for most in values[i + 1:]]
    least, most = max(spans, key=lambda span: (len(table[list(span)].dropna()), span[1] / span[0] if span[0] > 0 else math.inf),
                      default=(None, None))
    rows = [] if least is None else [(method, least, row[least], most, row[most])
                                     for method, row in table[[least, most]].dropna().iterrows()]
    return pd.DataFrame(rows, columns=["method", "least", "before", "most", "after"])


def nothing(cells):
    """Whether every residual is 0, as in a scene without contacts."""
    return not (metrics.column(cells, NORMALISED) > 0).any()


def found(where, cells, setting):
    """The row of one scene: the methods with the largest fall of the residual over the span of the setting. Values up to FLOOR
    are rounding. All methods that reach it are named: their factors would depend on the start only."""
    table, values = slopes(cells, setting), cells[setting].dropna().unique()
    if nothing(cells):
        return {"scene": where, "outcome": "every residual is 0"}
    if len(values) == 1:
        return {"scene": where, "outcome": f"only {setting}={values[0]:g} was run"}
    if not len(table):
        return {"scene": where, "outcome": f"no method finished at two values of {setting}"}
    row = {"scene": where, setting: f"{table['least'].iloc[0]:g} to {table['most'].iloc[0]:g}"}
    before, after = (table[name].where(table[name] > FLOOR, 0.0) for name in ("before", "after"))
    falls = table.assign(before=before, after=after)[after < before]
    if not (before.any() or after.any()):
        return {**row, "outcome": f"every residual is below {si(FLOOR)} (rounding)"}
    if not len(falls):
        return {**row, "outcome": "no residual falls"}
    solved = falls[falls["after"] == 0]
    best = falls.loc[(falls["before"] / falls["after"]).idxmax()]
    best = solved if len(solved) else falls[(falls["before"] == best["before"]) & (falls["after"] == best["after"])]
    return {**row, "methods": sorted(best["method"]), "residual before": ends(best["before"].min(), best["before"].max(), "1"),
            "residual after": f"<{si(FLOOR)}" if len(solved) else si(float(best["after"].iloc[0])),
            "does not fall": f"{int(((after > 0) & (after >= before)).sum())} of {len(table)}",
            f"below {si(FLOOR)} throughout": f"{int(((before == 0) & (after == 0)).sum())} of {len(table)}",
            "outcome": "solved to rounding" if len(solved) else "falls most"}


def finding_of_residual(rows, setting, dimension, everyone, unranked):
    """`rows`: found() of each scene; `unranked`: {method: why it has no rank}."""
    falling = [row for row in rows if "methods" in row]
    table = [{**row, **({"methods": some(row["methods"], everyone)} if "methods" in row else {})} for row in rows]
    table += [{"scene": "all", "methods": method, "outcome": f"not ranked: {why}"} for method, why in unranked.items()]
    if not falling:
        head = f"In {dimension}D no residual falls with more {setting}."
    else:
        solved = next((row for row in falling if row["outcome"].startswith("solved")), falling[0])
        to = f"below {si(FLOOR)}" if solved["residual after"].startswith("<") else f"most, to {solved['residual after']}"
        scenes = f"; it falls on {len(falling)} of {len(rows)} scenes" if len(rows) > 1 else ""
        head = (f"In {dimension}D on {solved['scene']}, from {solved[setting]} {setting}, the residual of "
                f"{some(solved['methods'], everyone)} falls {to}{scenes}.")
    columns = dict.fromkeys(key for row in sorted(table, key=len, reverse=True) for key in row)
    return Finding(head, cut(pd.DataFrame(table, columns=list(columns))))


def _chart(context, cells, shown, left_out, setting):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, width = over_steps.grid(context, cells, 2, len(shown))
    looks, said, lines = context.looks(cells), [], set()
    for column, (where, part) in enumerate(shown):
        above, below = axes[0][column], axes[1][column]
        good = part[(part["outcome"] == "ok") & np.isfinite(part[NORMALISED].astype(float))]
        up = ZeroLog(above, "y", list(good[NORMALISED]), failures=False, floor=FLOOR)
        plain_log(above, "x", [float(v) for v in part[setting].dropna()] or [1.0])
        for method, mine in good.groupby("method", sort=True):
            mine = mine.sort_values(setting)
            above.plot(mine[setting].astype(float), [up.place(v) for v in mine[NORMALISED]], **looks(method))
        above.set_xlabel(setting)
        above.set_title(f"{where}, {dimension}D")
        middle = over_steps.at_middle(part, setting)
        tracks = {key: context.store.series(key, SERIES) for key in middle["key"] if key is not None}
        lines |= {*good["method"], *(m for m, key in zip(middle["method"], middle["key"])
                                     if tracks.get(key) is not None and np.isfinite(tracks[key]).any())}
        values = [v for track in tracks.values() if track is not None for v in over_steps.stretches(track)[1] if math.isfinite(v)]
        scale = ZeroLog(below, "y", values, failures=False, floor=FLOOR)
        over_steps.lines(context, below, middle, lambda cell, tracks=tracks: tracks[cell["key"]], scale.place)
        ranked_cells = ranking.eligible(context, part)
        said.append(found(where, ranked_cells, setting) if len(ranked_cells) else
                    {"scene": where, "outcome": "no method is ranked"})
    unranked = {method + (f" on {where}" if len(shown) > 1 else ""): why for where, part in shown
                for method, why in ranking.unranked(context, part).items()}
    axes[0][0].set_ylabel("residual, median of steps")
    axes[1][0].set_ylabel("residual")
    over_steps.legend(context, figure, cells[cells["method"].isin(lines)] if lines else cells, width)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    table = pd.DataFrame({"scene": drawn["where"], "method": drawn["method"], setting: drawn[setting],
                          "outcome": drawn["outcome"],
                          **quantity(context.title(NORMALISED), "1", metrics.column(drawn, NORMALISED))})
    return Chart(f"{cells['sweep'].iloc[0]}_residual_{dimension}d", MORE_ITERATIONS,
                 f"Residual over {setting} and over steps, {dimension}D",
                 finding_of_residual(said, setting, dimension, sorted(cells["method"].unique()), unranked),
                 cells["sweep"].iloc[0], figure, table,
                 left_out + holes(drawn, ["scene", "method", setting]),
                 "Lower is better. The residual is the largest product of a contact's normal impulse and closing speed (one of "
                 "which should be 0), over m (g dt)² of all bodies. Below: medians of stretches of the run at the middle value "
                 f"of {setting}; a letter marks a failure. Engines that do not report contacts have no residual.")
