# SPDX-License-Identifier: Zlib
"""What sleeping saves and what it costs: how far bodies end from their places in a run without sleeping, and how late bodies
wake that a script wakes. The 2009 report (9.4.3) names only a gain of 20 % "without harming verisimilitude"."""

import math
import re

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

import metrics
import noise
import sleep_scenes
import twins
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from finding import TIE, Finding, cut, ends, fits, told
from load import one_machine, split, varying
from sentences import some, verb
from style import ZeroLog, grid_of_axes, legend_right, legend_room, si, times
from table import quantity

SECTION = "What does sleeping save, and what does it cost?"
COST, WAVE = "work_multiply_adds", "wake_steps"
TOLD = ("awake_mean", "woken", WAVE)  # metrics of trials; older stores lack them
SAVED, FAR, MIDDLE = "multiply-adds saved", "largest distance", "median distance"  # columns of cells
TIME, TIME_RUNS = "time saved", "time saved by repeats"
FLOOR = 1e-12  # m


@of_sweeps("sleeping", 38, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=(COST,),
                 also="sleep policies that differ, and a baseline that keeps all bodies awake"),
           "Sleeping", "This store has no sweep of sleep policies with a baseline that keeps all bodies awake.", "sleeping")
def sleeping(context, cells):
    if not set(TOLD) <= set(cells) or len({_policy(context, key) for key in cells["key"]} - {None}) < 2:
        return []
    name, groups = context.baseline(cells), [c for c in ("scene", "dimension") if c in cells]
    made = sleep_scenes.of_sweep(context, cells)
    for part in split(cells, groups):
        inner = varying(context.store, part, groups)
        for equal in split(part, inner, sort=True):
            awake = equal[(equal["method"] == name) & equal["outcome"].eq("ok")]
            # A baseline that lets bodies sleep would hide the cost of sleeping.
            if len(awake) == 1 and awake[COST].iloc[0] > 0 and _sleeps_least(equal, awake):
                made.append(_sleeping_chart(context, equal.drop_duplicates("method").copy(), awake.iloc[0],
                                            describe(equal.iloc[0], groups + inner)))
    return made


def _policy(context, key):
    found = key and re.search(r"\bsleep=\S+", context.store.trials.loc[key, "canonical"].get("pipeline", ""))
    return found.group() if found else None


def _sleeps_least(cells, awake):
    return not (metrics.column(cells, "awake_mean") > float(awake["awake_mean"].iloc[0])).any()


def at_the_end(context, key, dimension):
    """{slot: position} after the last step with stored poses, and that step."""
    poses = context.store.poses(key, dimension)
    last = max(poses)
    return {row[0]: row[1:1 + dimension] for row in poses[last]}, last


def distances(mine, other):
    """(largest, median) distance over all bodies, in m; NaN where the runs have different bodies."""
    if set(mine) != set(other):
        return math.nan, math.nan
    far = [float(np.linalg.norm(mine[slot] - other[slot])) for slot in mine]
    return max(far), float(np.median(far))


def seconds(context, cell):
    """Mean time of a step (s) of each timed repeat that stored times. The median would show one half only of a run that sleeps in
    the other."""
    found = [context.store.series(key, "seconds") for key in cell["keys_timed"]]
    return [float(np.mean(values)) for values in found if values is not None and len(values)]


def with_time(context, cells, awake):
    """The cells with TIME (median) and TIME_RUNS (each repeat), as savings against the baseline's median; None where a finished
    cell has no times."""
    base, runs = seconds(context, awake), [seconds(context, cell) if cell["outcome"] == "ok" else [] for _, cell in
                                           cells.iterrows()]
    if not base or not all(found for found, outcome in zip(runs, cells["outcome"]) if outcome == "ok"):
        return None
    cells[TIME_RUNS] = [[1 - value / np.median(base) for value in found] for found in runs]
    cells[TIME] = [float(np.median(found)) if found else math.nan for found in cells[TIME_RUNS]]
    return cells


def measured(context, cells, awake):
    """The cells with SAVED, FAR and MIDDLE; NaN where a run did not finish."""
    dimension = int(metrics.Trial(context.store, awake["key"]).parameter("dimension"))
    reference, last = at_the_end(context, awake["key"], dimension)
    found = []
    for _, cell in cells.iterrows():
        if cell["outcome"] != "ok" or cell["key"] is None:
            found.append((math.nan,) * 3)
            continue
        mine, step = at_the_end(context, cell["key"], dimension)
        far = distances(mine, reference) if step == last else (math.nan, math.nan)
        found.append((1 - cell[COST] / awake[COST], *far))
    cells[[SAVED, FAR, MIDDLE]] = found
    return cells


def finding(cells, awake, where):
    """A row per policy, the largest saving first; failures last."""
    others = cells[cells["method"] != awake["method"]].sort_values([SAVED, "method"], ascending=[False, True])
    timed = TIME in others
    late = others["woken"].gt(0) & others[SAVED].gt(0)
    table = {"policy": others["method"], **quantity(SAVED, "1", others[SAVED])}
    if timed:
        table |= quantity(TIME, "1", others[TIME])
        table["range of repeats"] = [ends(min(runs), max(runs), "1") if runs else "" for runs in others[TIME_RUNS]]
    table |= quantity("largest distance from the end without sleep", "m", others[FAR])
    table |= quantity("steps until all are awake", "1", others[WAVE].where(late))
    good = others[np.isfinite(metrics.column(others, SAVED))]
    first = good[good[SAVED] == good[SAVED].max()]
    table["outcome"] = [_outcome(cell, list(first["method"])) for _, cell in others.iterrows()]
    table = pd.DataFrame(table).replace({"outcome": {"": None}}).dropna(axis=1, how="all")
    if not len(good):
        head = f"On {where} no policy that lets bodies sleep finishes."
    elif first[SAVED].iloc[0] <= 0:
        head = f"On {where} no body falls asleep."
    else:
        up_to, they = ("up to ", "they move") if len(first) > 1 else ("", "it moves")
        time = f" and {up_to}{si(100 * first[TIME].max())} % of the time" if timed and first[TIME].notna().any() else ""
        saved = (f"{some(list(first['method']))} {verb(len(first), 'save')} most, {si(100 * first[SAVED].iloc[0])} % of the "
                 "multiply-adds")
        far = f"; {they} bodies by up to {si(first[FAR].max(), 'm')}" if first[FAR].notna().any() else ""
        head = fits(*(f"On {where} {saved}{more}." for more in (time + far, far, "")))
    return Finding(head, cut(table))


def _outcome(cell, first):
    if cell["outcome"] != "ok":
        return f"failed: {cell['outcome']}"
    if cell[SAVED] <= 0:
        return "no body falls asleep"
    tie = f"{TIE} with the best" if len(first) > 1 and cell["method"] in first else ""
    return "; ".join(filter(None, (tie, "all bodies end in place" if cell[FAR] <= FLOOR else "")))


def headline(cells, awake, where):
    """Savings against displacements: of the policies with at least half of the best saving, those with the least and the largest
    distance."""
    good = cells[(cells["method"] != awake["method"]) & np.isfinite(metrics.column(cells, FAR))]
    good = good[good[SAVED] >= good[SAVED].max() / 2] if len(good) else good
    if len(good) < 2 or good[SAVED].max() <= 0:
        return None
    near, far = good.loc[good[FAR].idxmin()], good.loc[good[FAR].idxmax()]
    if far[FAR] < 2 * max(near[FAR], FLOOR):
        return None
    return Headline(f"On {where} {near['method']} saves {si(100 * near[SAVED])} % of the multiply-adds and moves bodies by up to "
                    f"{si(near[FAR], 'm')}; {far['method']} saves {si(100 * far[SAVED])} % and moves them {si(far[FAR], 'm')}.",
                    dict(zip(good["method"], good[FAR].astype(float))), "m", "largest distance from the end without sleep",
                    ends=final_states(good))


def _sleeping_chart(context, cells, awake, where):
    cells = measured(context, cells, awake).sort_values("method")
    timed = with_time(context, cells, awake) is not None
    across = TIME if timed else SAVED
    labels, looks = list(cells["method"]), context.looks(cells)
    others = cells[cells["method"] != awake["method"]]
    waves = others[np.isfinite(metrics.column(others, WAVE)) & np.isfinite(metrics.column(others, SAVED))]
    width = legend_room(map(context.name, others["method"]), 2.0)
    figure, axes = grid_of_axes(1, 2 if len(waves) else 1, 2.8, width, left=0.95, gap_x=0.8)
    ax, bad = axes[0][0], bool(others[FAR].isna().any())
    up = ZeroLog(ax, "y", list(others[FAR].dropna()), "m", failures=bad, floor=FLOOR)
    for _, cell in others.iterrows():
        x = 100 * cell[across] if math.isfinite(cell[across]) else 0.0
        if timed and len(cell[TIME_RUNS]) > 1:
            ax.plot([100 * min(cell[TIME_RUNS]), 100 * max(cell[TIME_RUNS])], [up.place(float(cell[FAR]))] * 2, lw=0.9,
                    color=looks(cell["method"])["color"])
        ax.plot([x], [up.place(float(cell[FAR]))], **{**looks(cell["method"]), "linestyle": "none"}, zorder=3)
    ax.set_title("largest distance from the end without sleep\n(lower is better)")
    if len(waves):
        late = axes[0][1]
        for _, cell in waves.iterrows():
            late.plot([100 * cell[across]], [cell[WAVE]], **{**looks(cell["method"]), "linestyle": "none"}, zorder=3)
        late.set_ylim(-0.05 * max(1.0, waves[WAVE].max()), 1.08 * max(1.0, waves[WAVE].max()))
        late.yaxis.set_major_locator(MaxNLocator(integer=True))
        late.set_title("steps until all woken bodies are awake\n(lower is better)")
    for each in axes[0]:
        each.set_xlabel(f"{across} (%)")
    handles = [Line2D([], [], label=context.name(m), **{**looks(m), "linestyle": "none"}) for m in others["method"]]
    legend_right(figure, handles, width)
    table = {"policy": labels, "outcome": list(cells["outcome"])} | (quantity(TIME, "1", cells[TIME]) if timed else {})
    for title, unit, name in ((SAVED, "1", SAVED), ("largest distance from the end without sleep", "m", FAR),
                              ("median over bodies", "m", MIDDLE), ("bodies awake, mean", "1", "awake_mean"),
                              ("woken by the last action", "1", "woken"), ("steps until all are awake", "1", WAVE)):
        table |= quantity(title, unit, metrics.column(cells, name))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} {where}"), SECTION, f"What sleeping costs: {where}",
                 finding(cells, awake, where), cells["sweep"].iloc[0], figure, pd.DataFrame(table), holes(cells, ["method"]),
                 f"Lower right is best. Across: the {'time' if timed else 'multiply-adds'} that a policy saves against policy "
                 f"{context.name(awake['method'])}{', with the range of the repeats' if timed else ' (a count, without noise)'}. "
                 "Up: how far a body ends from its place in the run without sleep. In chaotic scenes this distance is another "
                 "course of events, not an error. Right: how many steps after the script's last action most of the woken bodies "
                 "are awake.",
                 headline=headline(cells, awake, where))


AXIS, QUERIES, STEP = "sleeping_contacts", "work_pair_queries", "ms_per_step_median"
TITLES = {QUERIES: "pair queries per step", "work_box_tests": "box tests per step", STEP: "time per step"}
WOKEN = ("woken", "wake_steps")
KEPT, ANEW = "kept", "renewed"


class Pair:
    """One policy in one scene, with contacts of sleeping bodies kept and renewed. `awake`: the cell without sleep, or None."""

    def __init__(self, context, place, policy, kept, anew, awake):
        self.place, self.policy, self.kept, self.anew = place, policy, kept, anew
        self.apart, self.same_bits = self._apart(context, kept, anew), kept["hashes"] == anew["hashes"]
        self.from_awake = [math.nan if awake is None else self._apart(context, cell, awake) for cell in (kept, anew)]
        before, after = (twins.number(cell, QUERIES) for cell in (anew, kept))
        self.saved = 1 - after / before if before > 0 else math.nan
        self.late = [tuple(twins.number(cell, name) for name in WOKEN) for cell in (kept, anew)]

    @staticmethod
    def _apart(context, a, b):
        """Largest distance (m) between the ends of two runs; NaN where a run failed or the last steps differ."""
        if any(cell["outcome"] != "ok" or cell["key"] is None for cell in (a, b)):
            return math.nan
        dimension = int(metrics.Trial(context.store, a["key"]).parameter("dimension"))
        (mine, last), (other, step) = (at_the_end(context, cell["key"], dimension) for cell in (a, b))
        return distances(mine, other)[0] if last == step else math.nan

    @property
    def name(self):
        return f"{self.policy} on {self.place}"

    @property
    def wakes_alike(self):
        return all(a == b or (a != a and b != b) for a, b in zip(*self.late))


@of_sweeps("sleeping_contacts", 39, SECTION,
           Needs("world", varies=(AXIS,), metrics=(STEP,), also="pair queries of policies that let bodies sleep"),
           "Contacts of sleeping bodies", "This store has no sweep with contacts of sleeping bodies kept and renewed.",
           "sleeping_contacts")
def sleeping_contacts(context, cells):
    if QUERIES not in cells:
        return []
    cells, refused = one_machine(context.store, cells)
    base, same = context.baseline(cells), varying(context.store, cells, (AXIS,))
    pairs = []
    for part in split(cells, same):
        awake = part[(part["method"] == base) & (part[AXIS] == 0)]
        for policy, both in part[part["method"] != base].groupby("method", sort=True):
            kept, anew = (both[both[AXIS] == value] for value in (0, 1))
            if len(kept) and len(anew):
                pairs.append(Pair(context, describe(part.iloc[0], ["scene", *(c for c in same if c != "scene")]), policy,
                                  kept.iloc[0], anew.iloc[0], awake.iloc[0] if len(awake) else None))
    return [_contacts_chart(context, cells, pairs, refused)] if pairs else []


def finding_of_contacts(pairs, least):
    """A row per policy and scene, the largest saving first; failures last."""
    rows = []
    for pair in sorted(pairs, key=lambda pair: (not math.isfinite(pair.saved), -pair.saved)):
        failed = [f"{name}: {cell['outcome']}" for name, cell in ((KEPT, pair.kept), (ANEW, pair.anew))
                  if cell["outcome"] != "ok"]
        rows.append({"scene": pair.place, "policy": pair.policy, "pair queries saved by keeping [1]": pair.saved,
                     "time of a step, renewed over kept": told(twins.told(pair.kept, pair.anew, STEP, least)),
                     "largest distance of the ends [m]": pair.apart, "same bits": "yes" if pair.same_bits else "no",
                     "wakes": "the same" if pair.wakes_alike else "not the same",
                     "outcome": f"failed: {', '.join(failed)}" if failed else "ok"})
    known = [pair for pair in pairs if math.isfinite(pair.saved)]
    if not known:
        head = "No policy that lets bodies sleep finishes with contacts of sleeping bodies both kept and renewed."
    elif (most := max(known, key=lambda pair: pair.saved)).saved <= 0:
        head = "No body falls asleep in the sweep of kept and renewed contacts of sleeping bodies."
    else:
        exact = sum(pair.same_bits for pair in known)
        head = f"Keeping contacts of sleeping bodies saves up to {si(100 * most.saved)} % of the pair queries"
        bits = f"{exact} of {len(known)} runs end in the same bits."
        head = fits(f"{head} ({most.name}); {bits}", f"{head}; {bits}")
    return Finding(head, cut(pd.DataFrame(rows)))


def headline_of_contacts(pairs, least):
    """The pair where renewed contacts cost most time, beyond the noise."""
    told = [(float(word), pair) for pair in pairs if (word := twins.told(pair.kept, pair.anew, STEP, least))[:1].isdigit()]
    if not told or max(told, key=lambda one: one[0])[0] <= 1:
        return None
    ratio, pair = max(told, key=lambda one: one[0])
    end = "the final state is the same" if pair.same_bits else f"bodies end up to {si(pair.apart, 'm')} elsewhere"
    return Headline(f"On {pair.place} a step of {pair.policy} takes {times(ratio)} times as long where contacts of sleeping "
                    f"bodies are renewed; {end}.",
                    {KEPT: pair.kept[STEP] / 1e3, ANEW: pair.anew[STEP] / 1e3}, "s", "time per step")


def _contacts_chart(context, cells, pairs, refused):
    sweep, least = cells["sweep"].iloc[0], noise.floor_of(context, cells["sweep"].iloc[0], STEP)
    places = list(dict.fromkeys(pair.place for pair in pairs))
    lines = len(pairs) + len(places)
    left = min(3.4, 0.3 + max([0.085 * len(name) for name in places] + [0.07 * len(pair.policy) for pair in pairs]))
    room, apart = legend_room([KEPT, ANEW], 1.5), [pair.apart for pair in pairs]
    shows = any(not far <= FLOOR for far in apart)  # no panel where all ends are equal
    figure, axes = grid_of_axes(1, 3 if shows else 2, 0.24 * lines + 0.1, room + 0.35, left=left, gap_x=0.62, bottom=0.35)
    at, ticks, y = {}, [], 0
    for place in places:
        axes[0][0].text(-0.04, y, place, transform=axes[0][0].get_yaxis_transform(), ha="right", va="center", fontsize=9,
                        fontweight="bold")
        for pair in (pair for pair in pairs if pair.place == place):
            y += 1
            at[id(pair)] = y
            ticks.append((y, pair.policy))
        y += 1
    for ax, metric in zip(axes[0], (QUERIES, STEP)):
        values = [twins.number(cell, metric) for pair in pairs for cell in (pair.kept, pair.anew)]
        scale = ZeroLog(ax, "x", values, context.unit(metric), failed_name="none")
        for pair in pairs:
            ends = [scale.place(twins.number(cell, metric)) for cell in (pair.kept, pair.anew)]
            ax.plot(ends, [at[id(pair)]] * 2, color="#999999", lw=1.2, zorder=2)
            for x, colour, shift in zip(ends, (twins.BEFORE, twins.AFTER), (-0.14, 0.14)):
                ax.plot([x], [at[id(pair)] + shift], "o", color=colour, ms=6, mec="white", mew=0.5, zorder=3)
            if metric == STEP:
                ax.text(1.02, at[id(pair)], twins.beside(pair.kept, pair.anew, STEP, {STEP: least}),
                        transform=ax.get_yaxis_transform(), va="center", fontsize=8, color="#444444")
        ax.set_title(TITLES[metric])
    if shows:
        scale = ZeroLog(axes[0][2], "x", apart, "m", failed_name="none", floor=FLOOR)
        for pair in pairs:
            axes[0][2].plot([scale.place(pair.apart)], [at[id(pair)]], "o", color="#444444", ms=6, mec="white", mew=0.5, zorder=3)
        axes[0][2].set_title("largest distance of the ends")
    for column, ax in enumerate(axes[0]):
        ax.set_ylim(y - 0.3, -0.7)
        ax.set_yticks([place for place, _ in ticks])
        ax.set_yticklabels([name for _, name in ticks] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
    legend_right(figure, [Line2D([], [], ls="none", marker="o", color=colour, label=label)
                          for colour, label in ((twins.BEFORE, KEPT), (twins.AFTER, ANEW))], room)
    return Chart(identifier(f"{sweep}_kept_and_anew"), SECTION, "Contacts of sleeping bodies, kept and renewed",
                 finding_of_contacts(pairs, least), sweep, figure, _table(context, pairs, least),
                 refused + holes(cells, ["scene", "dimension", "method", AXIS]),
                 "Left is better. Each row is one policy with `sleeping_contacts` off (contacts of sleeping bodies kept) and on "
                 "(renewed in each step). Pair queries are a count without noise; numbers beside the times are their ratios. The "
                 f"third panel, where ends differ, shows how far a body ends from its end with the other setting. "
                 f"{noise.rule(least)}",
                 headline=headline_of_contacts(pairs, least))


def _table(context, pairs, least):
    table = {"scene": [pair.place for pair in pairs], "policy": [pair.policy for pair in pairs],
             "outcome": [f"{pair.kept['outcome']} / {pair.anew['outcome']}" for pair in pairs]}
    table |= quantity("pair queries saved", "1", [pair.saved for pair in pairs])
    for metric, title in TITLES.items():
        for side, cell in ((KEPT, "kept"), (ANEW, "anew")):
            table |= quantity(f"{title}, {side}", context.unit(metric),
                              [twins.number(getattr(pair, cell), metric) for pair in pairs])
    words = [twins.told(pair.kept, pair.anew, STEP, least) for pair in pairs]
    table |= quantity("ratio of times", "1", [float(word) if word[:1].isdigit() else math.nan for word in words])
    table["why no ratio"] = ["" if word[:1].isdigit() else word for word in words]
    table |= quantity("largest distance of the ends", "m", [pair.apart for pair in pairs])
    table["same bits"] = ["yes" if pair.same_bits else "no" for pair in pairs]
    for i, side in enumerate((KEPT, ANEW)):
        table |= quantity(f"from the end without sleep, {side}", "m", [pair.from_awake[i] for pair in pairs])
        table |= quantity(f"woken by the last action, {side}", "1", [pair.late[i][0] for pair in pairs])
        table |= quantity(f"steps until all are awake, {side}", "1", [pair.late[i][1] for pair in pairs])
    return pd.DataFrame(table)
