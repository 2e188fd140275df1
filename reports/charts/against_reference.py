# SPDX-License-Identifier: Zlib
"""How far each method goes from a converged reference, for as long as it agrees with itself and with an unlike solver.

The sweep's baseline is the reference: a label whose cells have a step of their own, hundreds of times shorter, and beside them
its own runs, at half that step and started a nanometre beside itself. Of another solver, as converged, are the cells with the
label "NAME by SOLVER". They part where a scene forgets its start, where the reference has not converged, or where the solvers
converge to different motions: from there on no distance is compared or ranked, and ensembles say what can be said.
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
from load import split, varying
from sentences import does, listing, methods, verb
from style import HALO, ZeroLog, caption_of_lines, fallen, grid_of_axes, legend_right, legend_room, one_line, same, si, times
from table import quantity

SECTION = "How far does each method go from a converged reference?"
APART = 5e-4  # m: a tenth of the slop that most methods leave
NAMED = 4  # so many of those that are farthest are named in a sentence
EVEN = 1e-6  # s: moments that are nearer are one
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
    """Whether the methods are run at several time steps: their work is then that of a second, not of a step."""
    return cells["own_dt"].nunique() > 1


def cost_title(context, cells):
    return "multiply-adds per second of the scene" if several_steps(cells) else context.title(WORK)


def perturb(cells):
    return cells["perturb"].astype(float).fillna(0) if "perturb" in cells else pd.Series(0.0, index=cells.index)


def _dt(context, key):
    return math.nan if key is None else metrics.Trial(context.store, key).parameter("dt")


def tracks(context, key, dt, dimension):
    """{time (s): {slot: position}} of a run; times are rounded, so that steps of any length meet."""
    return {round(step * dt / EVEN) * EVEN: {row[0]: row[1:1 + dimension] for row in rows}
            for step, rows in context.store.poses(key, dimension).items()}


def distances(track, other, moving):
    """(largest, median) distance of the moving bodies at each time that both have; infinite where one lacks a body."""
    found = {}
    for time in sorted(set(track) & set(other) - {0.0}):
        far = [float(np.linalg.norm(track[time][s] - other[time][s])) if s in track[time] and s in other[time] else math.inf
               for s in moving]
        found[time] = (max(far), float(np.median(far))) if np.isfinite(far).all() else (math.inf, math.inf)
    return found


class Runs:
    """A reference and how far its own runs, and those of unlike solvers, are from it. `compared`: whether it has all of them;
    `spread`: {time: m}; `unlike`: {solver: {time: m}}; `horizon`: the first time at which one is farther away than APART, None
    where there is none; `end`: its last time."""

    def __init__(self, context, own, by_others):
        self.context = context
        runs = [(dt, beside, key) for dt, beside, keys, outcome in
                zip(own["own_dt"], perturb(own), own["keys"], own["outcome"]) if outcome == "ok" for key in keys if key]
        still = [run for run in runs if run[1] == 0]
        self.dt = max((dt for dt, _, _ in still), default=math.nan)
        self.beside = max((beside for _, beside, _ in runs), default=0.0)
        # Both are asked for: half a step does not see that a scene forgets its start, nor another start that a step is too long.
        # Nor does either see what all of one family do alike.
        others = {cell["method"].split(BY, 1)[1]: (cell["own_dt"], cell["key"]) for _, cell in by_others.iterrows()
                  if cell["own_dt"] <= self.dt * (1 + EVEN) and cell["key"] is not None}  # where one falls, they part
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
        """Whether a run ended while the reference served."""
        last = max((time for time in self.spread if self.serves(time)), default=math.nan)
        return not max(self.context.store.poses(key, self.dimension), default=0) * dt > last - EVEN

    def serves(self, time):
        return self.horizon is None or time < self.horizon

    @property
    def doubt(self):
        """m: how far the reference may be off while it serves."""
        return max([v for time, v in self.spread.items() if self.serves(time)], default=math.nan)


def measured(context, others, runs):
    """The cells with FAR and MIDDLE, the largest over the times at which the reference serves; a run that ended before has
    none. Also {index: {time: (largest, median)}}."""
    courses = {i: {} if cell["key"] is None else {time: far for time, far in runs.to(cell["key"], cell["own_dt"]).items()
                                                   if runs.serves(time)} for i, cell in others.iterrows()}
    ended = {i: cell["key"] is None or runs.ended(cell["key"], cell["own_dt"]) for i, cell in others.iterrows()}
    for column, name in enumerate((FAR, MIDDLE)):
        others[name] = [max(far[column] for far in courses[i].values()) if courses[i] and not ended[i] else math.nan
                        for i in others.index]
        others.loc[~np.isfinite(others[name].astype(float)), name] = math.nan
    others[COST] = metrics.column(others, WORK) / (others["own_dt"] if several_steps(others) else 1)
    # What ended while the reference served has no error, and no rank; that it fell later is another chart's affair.
    others["outcome"] = ["ok" if known == known else outcome for known, outcome in zip(others[FAR], others["outcome"])]
    return others, courses


def agreement(runs):
    """How long the reference serves, and which run parts from it first."""
    own, others = f"its runs at half the step and {si(runs.beside, 'm')} beside it", f"with {listing(sorted(runs.unlike))}"
    if runs.horizon is None:
        return f"the reference agrees with {own} and {others} to {si(runs.doubt, 'm')} for all {si(runs.end, 's')}"
    far = runs.spread[runs.horizon]
    apart = f"({si(far, 'm')} apart)" if math.isfinite(far) else "(one has ended)"
    if runs.itself[runs.horizon] > APART:
        return f"the reference and {own} part at {si(runs.horizon, 's')} {apart}"
    parted = [solver for solver, far in sorted(runs.unlike.items()) if not far.get(runs.horizon, math.inf) <= APART]
    return f"the reference and {listing(parted)}, as converged, part at {si(runs.horizon, 's')} {apart}"


def nearest(reached, doubt):
    """(methods that no other is nearer than, beyond what the reference is in doubt, the least distance, those that are farthest,
    theirs): the reference may be off by the doubt, so two distances are told apart when they differ by twice as much."""
    best, most = min(reached.values()), max(reached.values())
    firsts = [m for m in sorted(reached) if reached[m] - best <= 2 * doubt]
    return firsts, best, [m for m in sorted(reached) if most - reached[m] <= 2 * doubt and m not in firsts], most


def some(names, everyone):
    """Method labels in a sentence; of more than NAMED the first and how many others."""
    said = methods(names, everyone)
    return said if said.count(",") + said.count(" and ") < NAMED else f"{names[0]} and {len(names) - 1} others"


def finding(context, others, runs, where):
    text = f"On {where} {agreement(runs)}"
    everyone, finished = sorted(others["method"].unique()), others[others[FAR].notna()]
    if not any(runs.serves(time) for time in runs.spread):
        return f"{text}: there is nothing to compare, and no method is ranked."
    if not len(finished):
        return f"{text}; no method ran so far."
    known, said = ranking.eligible(context, finished), []
    if known["method"].nunique() == 1:
        said.append(f"Only {known['method'].iloc[0]} has a rank ({si(known[FAR].min(), 'm')})")
        known = known.iloc[:0]
    for budget in (marks(known, COST, FAR) or [math.inf]) if len(known) else []:
        reached = {m: float(cell[FAR]) for m, cell in within(known, COST, FAR, budget).items()} if budget < math.inf else (
            known.groupby("method")[FAR].min().astype(float).to_dict())
        firsts, best, lasts, most = nearest(reached, runs.doubt)
        cost = f"Within {budget:,.0f} {cost_title(context, others)} " if budget < math.inf else ""
        text_of = f"{cost}{does(firsts, 'are', everyone)} nearest ({si(best, 'm')})"
        said.append(text_of + (f", {some(lasts, everyone)} farthest ({si(most, 'm')})" if lasts else ""))
    none = sorted(set(everyone) - set(finished["method"]))
    # The cheapest and the dearest budget: what is between is in the table.
    said = [*dict.fromkeys((said[0], said[-1]))] if said else ["No method has a rank"]
    said = [*(["Beyond that no method is ranked"] if runs.horizon else []), *said]
    said += [f"{does(none, 'do', everyone)} not run so far"] if none else []
    return f"{text}. {'. '.join(said)}.{ranking.tail(context, finished)}"


def headline(context, others, runs, where):
    """The methods at the dearest budget that is named."""
    known = ranking.eligible(context, others[others[FAR].notna()])
    budgets = marks(known, COST, FAR) if len(known) else []
    if not budgets:
        return None
    cells = within(known, COST, FAR, budgets[-1])
    reached = {m: float(cell[FAR]) for m, cell in cells.items()}
    firsts, best, lasts, most = nearest(reached, runs.doubt)
    if not lasts or best <= 2 * runs.doubt:
        return None
    return Headline(f"On {where}, within {budgets[-1]:,.0f} {cost_title(context, others)}, "
                    f"{does(firsts, 'stay', list(reached))} nearest to the converged reference, {si(best, 'm')} at the most; "
                    f"{some(lasts, list(reached))} {verb(len(lasts), 'go')} {times(most / best)} times as far.",
                    reached, "m",
                    "largest distance from the reference", ends=final_states(pd.DataFrame(cells.values())))


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
                Line2D([], [], color="#777777", ls="-.", lw=1.5, label="unlike solver")]
    legend_right(figure, handles, width)
    at = over_steps.setting_of(shown, setting).strip().removeprefix("at ")
    return Chart(identifier(f"{others['sweep'].iloc[0]} against {where}"), SECTION, f"Against the reference: {where}",
                 finding(context, others, runs, where), others["sweep"].iloc[0], figure, _table(context, others, runs, setting),
                 holes(pd.concat([own, others]), list(dict.fromkeys(["method", *([setting] if setting else []), "dt"]))),
                 f"Left the largest distance of a body from its place in the reference{f', each at {at}' if at else ''}; the "
                 f"reference takes steps of {si(runs.dt, 's')}. Dotted is how far its own runs are from it, at half that step "
                 f"and started {si(runs.beside, 'm')} beside it, dash-dotted how far {listing(sorted(runs.unlike))} is, with "
                 f"steps as short or shorter: where one is farther away than {si(APART, 'm')}, a tenth of the slop that most "
                 "methods leave, it serves no more, and nothing is compared; two methods whose distances differ by no more than "
                 "twice that are not told apart. Right the largest of these distances against what it cost: methods compare at "
                 "equal cost." +
                 caption_of_lines([("Left", shared)]),
                 headline=headline(context, others, runs, where))


def _drawn_at(shown, setting):
    """At which of several steps, or values of a setting, the runs over time are: those at the right are all."""
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
    """At each budget what each method reaches; those that have no count, or do not come to the end, once."""
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
    table |= quantity("the reference serves until", "s", [runs.horizon or runs.end for _ in cells])
    table |= quantity("its own runs and the unlike solver are beside it by", "m", [runs.doubt for _ in cells])
    return pd.DataFrame(table)
