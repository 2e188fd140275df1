# SPDX-License-Identifier: Zlib
"""Frozen velocity problems: what is left over multiply-adds and over time, performance profiles (Dolan and More 2002), and
the rate of convergence that the matrix predicts beside the measured one."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import over_steps
import ranking
from chart import Chart, Needs, describe, holes, identifier, of_sweeps
from load import one_machine, split
from sentences import clauses, does, listing, methods, span
from style import ZeroLog, grid_of_axes, legend_right, legend_room, plain_log, si, times
from table import quantity

SOLVES = "Which method solves a step's problem?"
RESIDUAL, COST, TO = "problem_residual", "multiply_adds", "multiply_adds_to_thousandth"
TIME = "ns_per_solve"
RATE, PREDICTED = "rate", "predicted_rate"
FLOOR = 1e-12  # of g dt: below it all is rounding
ROWS, COLUMNS = 3, 3  # of panels
FAR = 100.0  # the profiles end where a method takes so many times as much as the best
SOLVED = 1e-3  # of g dt: what may be left, as in the metric TO
ALIKE = 2.0  # times that were measured once, in less than such a ratio, are not told apart


@of_sweeps("problems", 36, SOLVES,
           Needs("problems", methods=(2, math.inf)),
           "Residual over multiply-adds", "No sweep of frozen problems is in this store.", "problems")
def frozen_problems(context, cells):
    rates = _rates(context, cells)
    cells = cells[cells["outcome"] != "unsupported"]
    starts = split(cells, ["start"], sort=True) if "start" in cells else [cells]
    curves = [made(context, part) for part in starts for made in (_over_cost, _over_time)]
    return [chart for chart in (*curves, _profile(context, cells), rates) if chart]


def problems(context, cells):
    """[(words, cells)] of one problem each, all settings equal; those that most methods were given, since a problem of a few
    would count for them and against no other."""
    names = [name for name in ("problems", "problem", "start", "friction", "order", "dimension")
             if name in cells and (name == "problems" or cells[name].nunique(dropna=False) > 1)]
    parts = [part.drop_duplicates("method") for part in split(cells, names)]
    most = max((len(part) for part in parts), default=0)
    kept = [part for part in parts if len(part) == most]
    shown = [name for name in names if len({str(part[name].iloc[0]) for part in kept}) > 1]
    return [(", ".join(str(part[name].iloc[0]) for name in shown) or str(part["problems"].iloc[0]), part) for part in kept]


def profile(costs):
    """{method: (ratios, share of problems solved within that many times the best cost)}. `costs`: method -> its cost of each
    problem, infinite where it did not solve it. A problem that no method solves counts for all, or one could choose easy ones."""
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
    """(figure of what each method leaves of each problem over a series of costs, {trial: (costs, residuals)} of all that have
    it). `key`: the column of the trials."""
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
            point = len(set(x[good])) == 1  # of a method that is done at once, or has no number of iterations
            look = looks(method) if point else {**looks(method), "marker": None}
            ax.plot(x[good], [scale.place(v) for v in y[good]], **look)
        ax.set_title(where, size=9)
        ax.set_xlabel(described.title)
    for row in axes:
        row[0].set_ylabel("natural map / (g dt)")
    legend_right(figure, _handles(called, looks), width)
    return figure, tracks


def _holes(parts, cells):
    return [f"{where}: not drawn, there is room for {ROWS * COLUMNS}" for where, _ in parts[ROWS * COLUMNS:]] + holes(
        cells, ["problems", "problem", "method"])


def _table(cells, numbers):
    return pd.DataFrame({"problem": [describe(row, ["problems", "problem", "start", "order", "friction"])
                                     for _, row in cells.iterrows()],
                         "method": cells["method"].to_numpy(), "outcome": cells["outcome"].to_numpy(), **numbers})


def _not_ranked(context, parts):
    """On how many problems a method has no rank, and why."""
    unranked = [ranking.unranked(context, part) for _, part in parts]
    return ranking.told({f"{method} on {sum(method in why for why in unranked)} of {len(parts)}":
                         ranking.largest(why[method] for why in unranked if method in why)
                         for method in sorted({method for why in unranked for method in why})})


def _counted(of_problems):
    """["a on 3", "b on 1"]: on how many problems a method is named; most first."""
    count = {}
    for method in (method for found in of_problems for method in found):
        count[method] = count.get(method, 0) + 1
    return [f"{method} on {n}" for method, n in sorted(count.items(), key=lambda item: (-item[1], item[0]))]


def _over_cost(context, cells):
    parts = problems(context, cells)
    figure, _ = _drawn(context, parts, "key", COST)
    least = []
    for _, part in parts:
        part = ranking.eligible(context, part)
        part = part[(part["outcome"] == "ok") & np.isfinite(metrics.column(part, RESIDUAL))]
        values = part[RESIDUAL].astype(float)
        least.append(list(part[values <= max(values.min(), FLOOR)]["method"]) if len(part) else [])
    said, numbers = _counted(least), {}
    for name in (name for name in context.metrics("problems", "cost", "error") if name in cells):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(cells, name))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {_start(cells)} curves"), SOLVES,
                 f"What is left over multiply-adds, {_start(cells)} start",
                 (f"Of {len(parts)} problems, with all iterations, the least is left by {listing(said)}." if said else
                  "No problem was solved.") + _not_ranked(context, parts),
                 cells["sweep"].iloc[0], figure, _table(cells, numbers), _holes(parts, cells),
                 "Each method solves the same problem with 1, 2, 3, ... iterations. The natural map is the largest error of a "
                 "row by Coulomb's law with De Saxcé's correction; 1 is what gravity gives in a step. Methods that leave less "
                 f"than {FLOOR:g} of it leave alike.")


def time_to(residual, nanoseconds, residuals):
    """The time of the first number of iterations from which on no more than `residual` is left; infinite where there is none.
    What cannot run with no iterations has no time for them, only for one."""
    above = [i for i, left in enumerate(residuals) if not left <= residual]
    rest = nanoseconds[above[-1] + 1 if above else 0:]
    return next((float(time) for time in rest if math.isfinite(time)), math.inf)


def _over_time(context, cells):
    """None where nothing was timed."""
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
    counted, title = _counted(quickest), f"{context.title(TIME)}, to {SOLVED:g} g dt"
    numbers = quantity(context.title(TIME), context.unit(TIME), metrics.column(cells, TIME)) | quantity(
        title, context.unit(TIME), [took.get(trial, math.nan) for trial in cells["key_timed"]])
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {_start(cells)} times"), SOLVES,
                 f"What is left over time, {_start(cells)} start",
                 (f"Of {len(parts)} problems, less than {SOLVED:g} g dt is left in less than {ALIKE:g} times the time of the "
                  f"first by {listing(counted)}." if counted else f"No method leaves less than {SOLVED:g} g dt of a problem.")
                 + _not_ranked(context, parts),
                 cells["sweep"].iloc[0], figure, _table(cells, numbers), said + _holes(parts, cells),
                 "The same curves over the processor time of a solve with so many iterations, which begins each time from the "
                 "start; the median of ten. Where a line goes back, more iterations took less time. A witness's time is that of "
                 "the library in its own process and of what is prepared for it here.")


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
        # Up from nothing where it first solves one; level to the end, where what takes longer must not be counted.
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
    count = len(next(iter(costs.values())))
    table = pd.DataFrame([{"method": m, "share solved": shares[m], "share cheapest": wins[m],
                           "median multiple": float(np.median(found[m][0])) if len(found[m][0]) else math.nan} for m in costs])
    return Chart(identifier(f"{cells['sweep'].iloc[0]} profile"), SOLVES, "Performance profile of multiply-adds",
                 f"Of {count} problems {does(surest, 'solve')} most, "
                 f"{si(100 * max(shares.values()))} %. {does(firsts, 'are each', one='is')} the cheapest "
                 f"for {si(100 * most_wins)} %." + _not_ranked(context, problems(context, cells)),
                 cells["sweep"].iloc[0], figure, table,
                 [f"{method}: {text}, not drawn" for method, text in _beyond(found, count).items()],
                 "Dolan and Moré: how many problems a method solves within so many times the multiply-adds of the best. Solved "
                 "is a natural map that stays below 0.001 g dt; what left rows to Gauss-Seidel has not solved it. What a line "
                 "does not reach takes more iterations than were run, "
                 f"or is named below: at more than {FAR:g} times.")


def _beyond(found, count):
    """{method: how many more problems it solves than are drawn}."""
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
    # What counts is how far from 1 it is: that many iterations more or fewer are needed.
    plain = good[good["method"] == "catto"]  # which is Gauss-Seidel; the others are held against it
    if not len(plain):
        return None
    need = (1 - plain[PREDICTED].astype(float)) / (1 - plain[RATE].astype(float))
    off = max(need.max(), 1 / need[need > 0].min()) if (need > 0).any() else math.inf
    table = good[["problems", "method"]].assign(**{name: good[name] for name in ("problem", "order") if name in good},
                                                predicted=good[PREDICTED].astype(float), measured=good[RATE].astype(float))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} rates"), SOLVES, "Predicted and measured convergence",
                 f"On {len(plain)} frictionless cells the matrix tells catto's number of iterations to within "
                 f"{times(off)} times.",
                 cells["sweep"].iloc[0], figure, table, [],
                 "The spectral radius of the Gauss-Seidel iteration, catto's, on the rows that push in the converged "
                 "answer, in the order in which they are solved; hollow: coloured order. Only without friction and joints.")


MORE_ITERATIONS = "Do more iterations solve the contacts?"
SERIES, NORMALISED = "residual", "residual_median"


@of_sweeps("residual", 35, MORE_ITERATIONS,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"),
                 also="one seed, contacts and several values of a setting"),
           "Residual", "No sweep of several methods with residuals is in this store.", "resolvers")
def residual(context, cells):
    if NORMALISED not in context.store.metrics or (cells["seeds"].map(len) > 1).any():
        return []  # a store of an earlier program; an ensemble, of which one run says little
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        if nothing(part):
            continue  # no contacts, no residual
        shown, left_out, setting = over_steps.scenes(context, part)
        if setting and metrics.column(part[part["outcome"] == "ok"], NORMALISED).size:
            made.append(_chart(context, part, shown, left_out, setting))
    return made


def slopes(cells, setting):
    """Per method: its residual at the least and at the most of the setting that most methods finished both at, so that all are
    compared over the same span; nothing where there is no such span."""
    good = cells[(cells["outcome"] == "ok") & np.isfinite(metrics.column(cells, NORMALISED))].drop_duplicates(["method", setting])
    table = good.pivot(index="method", columns=setting, values=NORMALISED).sort_index(axis=1)
    values = list(table.columns)
    spans = [(least, most) for i, least in enumerate(values) for most in values[i + 1:]]
    # Of spans that as many methods have, the widest.
    least, most = max(spans, key=lambda span: (len(table[list(span)].dropna()), span[1] / span[0] if span[0] > 0 else math.inf),
                      default=(None, None))
    rows = [] if least is None else [(method, least, row[least], most, row[most])
                                     for method, row in table[[least, most]].dropna().iterrows()]
    return pd.DataFrame(rows, columns=["method", "least", "before", "most", "after"])


def nothing(cells):
    """Whether no run of these has a residual above 0: a scene without contacts has none."""
    return not (metrics.column(cells, NORMALISED) > 0).any()


def finding(where, cells, setting):
    table, values = slopes(cells, setting), cells[setting].dropna().unique()
    if nothing(cells):
        return f"on {where} every residual is 0"
    if len(values) == 1:
        return f"on {where} only {setting}={values[0]:g} was run"
    if not len(table):
        return f"on {where} no method finished at two values of {setting}"
    over = f"from {table['least'].iloc[0]:g} to {table['most'].iloc[0]:g} {setting}"
    before, after = (table[name].where(table[name] > FLOOR, 0.0) for name in ("before", "after"))
    falls = table.assign(before=before, after=after)[after < before]
    if not (before.any() or after.any()):
        return f"on {where} every residual is below {si(FLOOR)}, which is rounding, {over}"
    if not len(falls):
        return f"on {where} no residual falls {over}"
    idle, small = int(((before > 0) & (after >= before)).sum()), int(((before == 0) & (after == 0)).sum())
    everyone, solved = sorted(cells["method"].unique()), falls[falls["after"] == 0]
    if len(solved):  # all of them: beyond that the one that falls most would be the one that starts worst
        starts = [si(v) for v in sorted(solved["before"])]
        told = (f"{methods(sorted(solved['method']), everyone)} falls {over} below {si(FLOOR)}, from "
                f"{span(starts[0], starts[-1])}")
    else:
        best = falls.loc[(falls["before"] / falls["after"]).idxmax()]
        equals = sorted(falls[(falls["before"] == best["before"]) & (falls["after"] == best["after"])]["method"])
        most = f" most of {len(table)} methods" if len(table) > len(equals) else ""
        told = f"{methods(equals, everyone)} falls{most} {over}, from {si(best['before'])} to {si(best['after'])}"
    return clauses(f"on {where} the residual of {told}", idle and f"that of {idle} of {len(table)} methods does not fall",
                   small and f"that of {small} of {len(table)} methods is below {si(FLOOR)} from the first")


def _chart(context, cells, shown, left_out, setting):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, width = over_steps.grid(context, cells, 2, len(shown))
    looks, said = context.looks(cells), []
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
        values = [v for track in tracks.values() if track is not None for v in over_steps.stretches(track)[1] if math.isfinite(v)]
        scale = ZeroLog(below, "y", values, failures=False, floor=FLOOR)
        over_steps.lines(context, below, middle, lambda cell, tracks=tracks: tracks[cell["key"]], scale.place)
        ranked = ranking.eligible(context, part)
        said.append(finding(where, ranked, setting) if len(ranked) else f"on {where} no method has a rank")
    axes[0][0].set_ylabel("residual, median of steps")
    axes[1][0].set_ylabel("residual")
    over_steps.legend(context, figure, cells, width)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    table = pd.DataFrame({"scene": drawn["where"], "method": drawn["method"], setting: drawn[setting],
                          "outcome": drawn["outcome"],
                          **quantity(context.title(NORMALISED), "1", metrics.column(drawn, NORMALISED))})
    return Chart(f"{cells['sweep'].iloc[0]}_residual_{dimension}d", MORE_ITERATIONS,
                 f"Residual over {setting} and over steps, {dimension}D",
                 f"In {dimension}D " + "; ".join(said) + "." + ranking.tail_of(context, shown),
                 cells["sweep"].iloc[0], figure, table,
                 left_out + holes(drawn, ["scene", "method", setting]),
                 "The residual is the worst product of a contact's normal impulse and closing speed, one of which should be 0, "
                 f"over m (g dt)² of all bodies. Below: medians of stretches at the middle value of {setting}; a letter marks "
                 "where a run failed. Engines that tell no contacts have none. Falls are compared over one span: the widest "
                 "whose two ends the most methods finished at.")
