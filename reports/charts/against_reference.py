# SPDX-License-Identifier: Zlib
"""Distance of each method from a converged reference, for as long as the reference agrees with itself and with another solver.

The sweep's baseline is the reference: its cells have their own step, hundreds of times shorter. Beside them stand its
own runs, at half that step and started a nanometre away. Converged cells of another solver have the label "NAME by SOLVER". The
runs part where a scene forgets its start, where the reference has not converged, or where the solvers converge to different
motions. From then on no distance is compared or ranked; ensembles answer what can still be answered.
"""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import over_steps
import ranking
from budget import marks, within
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from finding import Finding, Line, fits, ranked
from load import split, varying
from sentences import listing, methods, some, verb
from style import HALO, ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, one_line, same, si, times
from table import quantity

SECTION = "How far is each method from a converged reference?"
APART = 5e-4  # m: a tenth of the slop that most methods leave
EVEN = 1e-6  # s: times that are closer count as one
BY = " by "  # in the label of the same reference by another solver
WORK = "work_multiply_adds"
COST, FAR, MIDDLE = "cost", "largest distance", "median distance"  # columns of cells


@of_sweeps("against_reference", 23, SECTION,
           Needs("world", methods=(2, math.inf),
                 also="a baseline with its own runs, at half its step, started beside itself and by an unlike solver"),
           "Against the reference", "No sweep with a converged reference is in this store.", "reference")
def against_reference(context, cells):
    cells = cells.assign(own_dt=[_dt(context, key) for key in cells["key"]])
    name, groups, made = context.baseline(cells), [c for c in ("scene", "dimension") if c in cells], []
    for part in split(cells, groups):
        inner = varying(context.store, part, (*groups, "dt", "steps", "perturb", "seed", *context.settings(part)))
        for equal in split(part, inner, sort=True):
            unlike = equal["method"].str.startswith(name + BY)
            own = equal["method"] == name
            runs = Runs(context, equal[own], equal[unlike])
            others = equal[~own & ~unlike & ~(perturb(equal) > 0)]
            if runs.compared and len(others):
                made.append(_chart(context, others.copy(), runs, equal[own | unlike],
                                   describe(equal.iloc[0], groups + inner)))
    return made


def several_steps(cells):
    """Whether methods run at several time steps: their work is then compared per second, not per step."""
    return cells["own_dt"].nunique() > 1


def cost_title(context, cells):
    return "multiply-adds per second of the scene" if several_steps(cells) else context.title(WORK)


def perturb(cells):
    return cells["perturb"].astype(float).fillna(0) if "perturb" in cells else pd.Series(0.0, index=cells.index)


def _dt(context, key):
    return math.nan if key is None else metrics.Trial(context.store, key).parameter("dt")


def tracks(context, key, dt, dimension):
    """{time (s): {slot: position}} of a run; times are rounded, so that runs with different steps have common times."""
    return {round(step * dt / EVEN) * EVEN: {row[0]: row[1:1 + dimension] for row in rows}
            for step, rows in context.store.poses(key, dimension).items()}


def distances(track, other, moving):
    """{time: (largest, median) distance of the moving bodies} at each common time; infinite where a run lacks a body."""
    found = {}
    for time in sorted(set(track) & set(other) - {0.0}):
        far = [float(np.linalg.norm(track[time][s] - other[time][s])) if s in track[time] and s in other[time] else math.inf
               for s in moving]
        found[time] = (max(far), float(np.median(far))) if np.isfinite(far).all() else (math.inf, math.inf)
    return found


class Runs:
    """A reference, and the distances of its own runs and of another solver's from it. `compared`: whether it has all of them;
    `spread`: {time: m}; `unlike`: {solver: {time: m}}; `horizon`: the first time at which one is farther than APART, None where
    there is none; `end`: its last time."""

    def __init__(self, context, own, by_others):
        self.context = context
        runs = [(dt, beside, key) for dt, beside, keys, outcome in
                zip(own["own_dt"], perturb(own), own["keys"], own["outcome"]) if outcome == "ok" for key in keys if key]
        still = [run for run in runs if run[1] == 0]
        self.dt = max((dt for dt, _, _ in still), default=math.nan)
        self.beside = max((beside for _, beside, _ in runs), default=0.0)
        # All three are needed: half a step does not show that a scene forgets its start, another start does not show that the
        # step is too long, and neither shows an error that all methods of one family share.
        others = {cell["method"].split(BY, 1)[1]: (cell["own_dt"], cell["key"]) for _, cell in by_others.iterrows()
                  if cell["own_dt"] <= self.dt * (1 + EVEN) and cell["key"] is not None}  # a failed run has parted
        self.compared = (min((dt for dt, _, _ in still), default=math.nan) < self.dt and self.beside > 0 and len(others) > 0)
        if not self.compared:
            return
        key = next(key for dt, _, key in still if dt == self.dt)
        self.dimension = int(metrics.Trial(context.store, key).parameter("dimension"))
        self.track = tracks(context, key, self.dt, self.dimension)
        first = self.track[0.0]
        went = [s for s in first if any(s in at and (at[s] != first[s]).any() for at in self.track.values())]
        self.moving = went or list(first)
        apart = [self.to(other, dt) for dt, _, other in runs if other != key]
        self.end = max(self.track)
        times_of_all = sorted(set(self.track) - {0.0})
        self.unlike = {solver: {time: far for time, (far, _) in self.to(key, dt).items()} for solver, (dt, key) in others.items()}
        self.itself = {time: max(far.get(time, (math.inf, 0))[0] for far in apart) for time in times_of_all}
        self.spread = {time: max(self.itself[time], *(far.get(time, math.inf) for far in self.unlike.values()))
                       for time in times_of_all}
        self.horizon = next((time for time in times_of_all if not self.spread[time] <= APART), None)

    def to(self, key, dt):
        return distances(tracks(self.context, key, dt, self.dimension), self.track, self.moving)

    def ended(self, key, dt):
        """Whether a run ended while the reference was valid."""
        last = max((time for time in self.spread if self.serves(time)), default=math.nan)
        return not max(self.context.store.poses(key, self.dimension), default=0) * dt > last - EVEN

    def serves(self, time):
        return self.horizon is None or time < self.horizon

    @property
    def doubt(self):
        """m: the uncertainty of the reference while it is valid."""
        return max([v for time, v in self.spread.items() if self.serves(time)], default=math.nan)


def measured(context, others, runs):
    """The cells with FAR and MIDDLE, the largest over the times at which the reference is valid, NaN for a run that ended
    before. Also {index: {time: (largest, median)}}."""
    courses = {i: {} if cell["key"] is None else {time: far for time, far in runs.to(cell["key"], cell["own_dt"]).items()
                                                   if runs.serves(time)} for i, cell in others.iterrows()}
    ended = {i: cell["key"] is None or runs.ended(cell["key"], cell["own_dt"]) for i, cell in others.iterrows()}
    for column, name in enumerate((FAR, MIDDLE)):
        others[name] = [max(far[column] for far in courses[i].values()) if courses[i] and not ended[i] else math.nan
                        for i in others.index]
        others.loc[~np.isfinite(others[name].astype(float)), name] = math.nan
    others[COST] = metrics.column(others, WORK) / (others["own_dt"] if several_steps(others) else 1)
    # A run that ended while the reference was valid has no error and no rank. Later failures belong to other charts.
    others["outcome"] = ["ok" if known == known else outcome for known, outcome in zip(others[FAR], others["outcome"])]
    return others, courses


def agreement(runs):
    """A sentence: how long the reference is valid, and which run parts from it first."""
    own, others = f"its runs at half the step and {si(runs.beside, 'm')} beside it", f"with {listing(sorted(runs.unlike))}"
    if runs.horizon is None:
        return f"The reference agrees with {own} and {others} to {si(runs.doubt, 'm')} for all {si(runs.end, 's')}."
    far = runs.spread[runs.horizon]
    apart = f"({si(far, 'm')} apart)" if math.isfinite(far) else "(one has ended)"
    parted = own if runs.itself[runs.horizon] > APART else listing(
        solver for solver, far in sorted(runs.unlike.items()) if not far.get(runs.horizon, math.inf) <= APART) + ", as converged,"
    return f"The reference and {parted} part at {si(runs.horizon, 's')} {apart}; later distances are not compared."


def nearest(reached, doubt):
    """(methods nearest to the reference, the least distance, the farthest methods, the largest distance). Distances that differ
    by at most twice the doubt of the reference are equal."""
    best, most = min(reached.values()), max(reached.values())
    firsts = [m for m in sorted(reached) if reached[m] - best <= 2 * doubt]
    return firsts, best, [m for m in sorted(reached) if most - reached[m] <= 2 * doubt and m not in firsts], most


def found(context, others, runs, where):
    """(finding, entry of the first screen or None): distances at the largest budget, and beside them at the smallest."""
    why, finished = ranking.unranked(context, others[others[FAR].notna()]), others[others[FAR].notna()]
    known, everyone = ranking.eligible(context, finished), sorted(others["method"].unique())
    budgets = (marks(known, COST, FAR) or [math.inf]) if known["method"].nunique() > 1 else [math.inf] * (len(known) > 0)
    ends, reached = list(dict.fromkeys([*budgets[:1], *budgets[-1:]])), {}
    for budget in ends:
        cells = within(known, COST, FAR, budget).items() if budget < math.inf else (
            (m, part.loc[part[FAR].astype(float).idxmin()]) for m, part in known.groupby("method"))
        reached[budget] = dict(cells)
    last = reached[ends[-1]] if ends else {}
    cost = lambda budget: f"{budget:,.0f} {cost_title(context, others)}"  # noqa: E731
    far = {m: float(cell[FAR]) for m, cell in last.items()}
    firsts, best, lasts, most = nearest(far, runs.doubt) if far else ([], math.nan, [], math.nan)
    lines = []
    for method in everyone:
        ended = others[(others["method"] == method) & others[FAR].isna()]["outcome"]
        outcome = "not compared"
        if method in far:
            outcome = ""
        elif method in why:
            outcome = f"not ranked: {why[method]}"
        elif len(ended) and ended.iloc[0] != "ok":
            outcome = f"ended before: {ended.iloc[0]}"
        elif not len(ended) and ends:
            outcome = f"costs more than {cost(ends[-1])}"
        lines.append(Line(method, far.get(method, math.nan), outcome=outcome, more={} if len(ends) < 2 else quantity(
            f"within {cost(ends[0])}", "m", [float(reached[ends[0]][method][FAR]) if method in reached[ends[0]] else math.nan])))
    lines = [Line(line.name, line.value, outcome=line.outcome, more={k: v[0] for k, v in line.more.items()}) for line in lines]
    at = f"within {cost(ends[-1])}" if ends and ends[-1] < math.inf else "at any cost"
    table = ranked(lines, f"distance from the reference, {at}", "m", [m for m in firsts if far[m] > best] + [
        m for m in firsts if far[m] == best][1:], keep=[context.baseline(others)])
    until = f" until {si(runs.horizon, 's')}" if runs.horizon is not None else ""
    if not any(runs.serves(time) for time in runs.spread):
        return Finding(f"On {where} no method is ranked: {_parted(runs)} at {si(runs.horizon, 's')}."), None
    if not far:
        return Finding(f"On {where} no ranked method runs as long as the reference is valid.", table), None
    if len(far) == 1:
        return Finding(f"On {where}{until} only {firsts[0]} has a rank, {si(best, 'm')} from the reference.", table), None
    budget = f", {at}," if ends[-1] < math.inf else ""
    head = (f"On {where}{until}{budget} {some(firsts, everyone)} {verb(len(firsts), 'stay')} nearest to the reference "
            f"({si(best, 'm')})")
    ratio = f", {times(most / best)} times as far" if lasts and best > 2 * runs.doubt else ""
    goes = f"; {some(lasts, everyone, 1)} {verb(len(lasts), 'are')} {si(most, 'm')} away" if lasts else ""
    made = Finding(fits(f"{head}{goes}{ratio}.", f"{head}{goes}.", f"{head}."), table)
    if not lasts or best <= 2 * runs.doubt or budgets == [math.inf]:
        return made, None
    return made, Headline("", far, "m", "largest distance from the reference", ends=final_states(pd.DataFrame(last.values())))


def _parted(runs):
    return ("the reference and its own runs part" if runs.itself[runs.horizon] > APART else "the reference and another solver "
                                                                                            "part")


def _chart(context, others, runs, own, where):
    others, courses = measured(context, others, runs)
    setting = next(iter(context.settings(others)), "dt" if several_steps(others) else None)
    others = over_steps.own_setting(others, setting if setting != "dt" else None)
    looks = context.looks(others)
    labels, called = sorted(others["method"].unique()), ranking.names(context, others)
    shown = over_steps.at_middle(others, setting).drop_duplicates("method").sort_values("method")
    width = legend_room([*called.values(), "its own runs beside it"], 2.0)
    figure, axes = grid_of_axes(1, 2, 3.0, width, left=0.95, gap_x=1.0)
    shared = _over_time(axes[0][0], shown, courses, runs, looks, labels, _drawn_at(shown, setting))
    _against_cost(context, axes[0][1], others, looks, runs)
    handles = [Line2D([], [], label=called[m], **looks(m)) for m in labels]
    handles += [Line2D([], [], color="#777777", ls=":", lw=2, label="its own runs beside it"),
                Line2D([], [], color="#777777", ls="-.", lw=1.5, label="another solver")]
    legend_right(figure, handles, width)
    about, entry = found(context, others, runs, where)
    at = over_steps.setting_of(shown, setting).strip().removeprefix("at ")
    return Chart(identifier(f"{others['sweep'].iloc[0]} against {where}"), SECTION, f"Against the reference: {where}",
                 about, others["sweep"].iloc[0], figure, _table(context, others, runs, setting),
                 holes(pd.concat([own, others]), list(dict.fromkeys(["method", *([setting] if setting else []), "dt"]))),
                 f"{agreement(runs)} Left: the largest distance of a body from its place in the reference"
                 f"{f', at {at}' if at else ''}; the reference takes steps of {si(runs.dt, 's')}. Dotted: its own runs, at half "
                 f"that step and started {si(runs.beside, 'm')} beside it. Dash-dotted: {listing(sorted(runs.unlike))}, with "
                 f"steps as short or shorter. The reference is valid until one of them is farther than {si(APART, 'm')} from it, "
                 "a tenth of the slop of most methods. Two methods tie if their distances differ by at most twice the largest of "
                 "these distances until then. Right: each method's largest distance against its cost." +
                 caption_of_lines([("Left", shared)]),
                 headline=entry)


def _drawn_at(shown, setting):
    """The step or setting of the runs drawn over time; the right panel has all values."""
    values = sorted(shown[setting].dropna().unique()) if setting else []
    if not values:
        return ""
    return (f", steps of {listing(si(v, 's') for v in values)}" if setting == "dt" else
            f", {setting} = {listing(f'{v:g}' for v in values)}")


def _over_time(ax, shown, courses, runs, looks, labels, at=""):
    spread = [(time, far) for time, far in runs.itself.items() if math.isfinite(far)]
    unlike = [[(time, far) for time, far in course.items() if math.isfinite(far)] for course in runs.unlike.values()]
    curves = {cell["method"]: [(time, far) for time, (far, _) in courses[i].items() if math.isfinite(far)]
              for i, cell in shown.iterrows()}
    scale = ZeroLog(ax, "y", [far for curve in (*curves.values(), spread, *unlike) for _, far in curve], "m", failures=False,
                    floor=1e-12)
    ax.plot([time for time, _ in spread], [scale.place(far) for _, far in spread], color="#777777", ls=":", lw=2)
    for course in unlike:
        ax.plot([time for time, _ in course], [scale.place(far) for _, far in course], color="#777777", ls="-.", lw=1.5)
    firsts, spots = same(curves), []
    for order, (method, curve) in enumerate(curves.items()):
        if firsts[method] != method or not curve:
            continue
        every = max(1, len(curve) // over_steps.MARKS)
        ax.plot([time for time, _ in curve], [scale.place(far) for _, far in curve],
                **{**looks(method), "lw": 1.2}, markevery=(order % every, every))
        outcome = shown[shown["method"] == method]["outcome"].iloc[0]
        if outcome != "ok":
            spots.append((curve[-1][0], scale.place(curve[-1][1]), outcome, looks(method)["color"]))
    if runs.horizon is not None:
        ax.axvline(runs.horizon, color="#444444", lw=1, ls="--")
        ax.axvspan(runs.horizon, runs.end, color="#EEEEEE", zorder=0, lw=0)
    ax.set_xlim(0, runs.end)
    ax.set_xlabel("time (s)")
    ax.set_title(f"largest distance{at}" if at else "largest distance of a body")
    unnamed = one_line(ax, firsts, lambda group: methods(group, labels))
    fallen(ax, spots, clip_on=False, path_effects=HALO)
    return unnamed


def _against_cost(context, ax, others, looks, runs):
    good = others[others[FAR].notna() & np.isfinite(others[COST])]
    across = ZeroLog(ax, "x", list(good[COST]), "1", failures=False)
    up = ZeroLog(ax, "y", [*good[FAR], *([runs.doubt] if runs.doubt > 0 else [])], "m", failures=False, floor=1e-12)
    for method, part in good.groupby("method", sort=True):
        part = part.sort_values(COST)
        ax.plot([across.place(v) for v in part[COST]], [up.place(v) for v in part[FAR]], **{**looks(method), "lw": 0.9})
    for budget in marks(good, COST, FAR):
        ax.axvline(budget, color="#999999", lw=0.8, ls=":", zorder=0.5)
    if math.isfinite(runs.doubt):
        ax.axhline(up.place(runs.doubt), color="#777777", ls=":", lw=2)
    ax.set_xlabel(cost_title(context, others))
    ax.set_title("largest of all times")


def _table(context, others, runs, setting):
    """Each method's distance at each budget. Methods without a count, or that end early, have one row."""
    known, rows = others[others[FAR].notna()], []
    for budget in marks(known, COST, FAR):
        rows += [(budget, cell) for cell in within(known, COST, FAR, budget).values()]
    named = {cell["method"] for _, cell in rows}
    rows += [(math.nan, cell) for _, cell in others[~others["method"].isin(named)].drop_duplicates("method").iterrows()]
    cells = [cell for _, cell in rows]
    each = "second of the scene" if several_steps(others) else "step"
    table = {**quantity(f"multiply-adds per {each}, at most", "1", [budget for budget, _ in rows]),
             "method": [cell["method"] for cell in cells]}
    table |= {setting: [cell[setting] for cell in cells]} if setting else {}
    table["outcome"] = [cell["outcome"] for cell in cells]
    for title, name in (("largest distance of a body from the reference", FAR), ("median over bodies", MIDDLE)):
        table |= quantity(title, "m", [cell[name] for cell in cells])
    table |= quantity("the reference is valid until", "s", [runs.horizon or runs.end for _ in cells])
    table |= quantity("largest distance of its own runs and the other solver", "m", [runs.doubt for _ in cells])
    return pd.DataFrame(table)
