# SPDX-License-Identifier: Zlib
"""What it saves to leave the contacts of sleepers as they were, against making them anew in each step, and what it changes: the
2009 report (6.5.1) has a switch for it, and no number."""

import math

import pandas as pd
from matplotlib.lines import Line2D

import metrics
import noise
import twins
from chart import Chart, Headline, Needs, describe, holes, identifier, listing, of_sweeps, plural
from charts.sleeping import FLOOR, at_the_end, distances
from load import one_machine, split, varying
from style import ZeroLog, grid_of_axes, legend_right, legend_room, si, times
from table import quantity

SECTION = "What does sleeping save, and what does it cost?"
AXIS, QUERIES, TIME = "sleeping_contacts", "work_pair_queries", "ms_per_step_median"
TITLES = {QUERIES: "pair queries per step", "work_box_tests": "box tests per step", TIME: "time per step"}
WAVE = ("woken", "wake_steps")
KEPT, ANEW = "left as they were", "made anew"


class Pair:
    """One policy in one place, with contacts of sleepers left and made anew; `awake`: there when nobody sleeps, or None."""

    def __init__(self, context, place, policy, kept, anew, awake):
        self.place, self.policy, self.kept, self.anew = place, policy, kept, anew
        self.apart, self.same_bits = self._apart(context, kept, anew), kept["hashes"] == anew["hashes"]
        self.from_awake = [math.nan if awake is None else self._apart(context, cell, awake) for cell in (kept, anew)]
        before, after = (twins.number(cell, QUERIES) for cell in (anew, kept))
        self.saved = 1 - after / before if before > 0 else math.nan
        self.late = [tuple(twins.number(cell, name) for name in WAVE) for cell in (kept, anew)]

    @staticmethod
    def _apart(context, a, b):
        """Largest distance between the ends of two runs, m; NaN where one has none, or another last step."""
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
           Needs("world", varies=(AXIS,), metrics=(TIME,), also="pair queries of policies that let bodies sleep"),
           "Contacts of sleepers", "No sweep with and without contacts of sleepers is in this store.", "sleeping_contacts")
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
    return [_chart(context, cells, pairs, refused)] if pairs else []


def finding(pairs, least):
    known = [pair for pair in pairs if math.isfinite(pair.saved)]
    if not known:
        return "No policy that lets bodies sleep finishes with contacts of sleepers left as they were and made anew."
    most = max(known, key=lambda pair: pair.saved)
    if most.saved <= 0:
        return "No body falls asleep where contacts of sleepers were left as they were and made anew."
    text = (f"Contacts of sleepers that are left as they were save at most {si(100 * most.saved)} % of the pair queries "
            f"({most.name})")
    words = [(pair, twins.told(pair.kept, pair.anew, TIME, least)) for pair in known]
    told = [(float(word), pair) for pair, word in words if word[:1].isdigit()]
    if told:
        ratio, dear = max(told, key=lambda one: one[0])
        text += (f"; made anew they make a step at most {times(ratio)} times as dear ({dear.name}), and differ in time beyond "
                 f"the noise in {len(told)} of {plural(len(known), 'pair')}")
    elif words:
        silent = [word for _, word in words if word in noise.IN_WORDS]
        text += f"; in time they differ in none of {plural(len(known), 'pair')}" + (
            f" ({noise.IN_WORDS[silent[0]]})" if silent else "")
    exact = [pair for pair in known if pair.same_bits]
    share = "all" if len(exact) == len(known) else len(exact)
    text += f"; the end is the same to the bit in {share} of {plural(len(known), 'pair')}"
    moved = [pair for pair in known if math.isfinite(pair.apart) and pair.apart > FLOOR]
    if moved:
        far = max(moved, key=lambda pair: pair.apart)
        text += f", and a body elsewhere by {si(far.apart, 'm')} at the most ({far.name})"
    acted = [pair for pair in known if all(woken == woken for woken, _ in pair.late)]
    if acted:
        other = [pair.name for pair in acted if not pair.wakes_alike]
        text += "; which bodies wake, and when, is " + (f"not the same for {listing(other)}" if other else "the same everywhere")
    failed = [pair.name for pair in pairs if not math.isfinite(pair.saved)]
    return text + (f"; not both finish of {listing(failed)}" if failed else "") + "."


def headline(pairs, least):
    """Where contacts made anew cost most time, beyond the noise."""
    told = [(float(word), pair) for pair in pairs if (word := twins.told(pair.kept, pair.anew, TIME, least))[:1].isdigit()]
    if not told or max(told, key=lambda one: one[0])[0] <= 1:
        return None
    ratio, pair = max(told, key=lambda one: one[0])
    ends = "the same bits" if pair.same_bits else f"bodies that end {si(pair.apart, 'm')} elsewhere at the most"
    return Headline(f"On {pair.place} contacts of sleepers made anew in each step make a step by {pair.policy} {times(ratio)} "
                    f"times as dear, for {ends}.",
                    {KEPT: pair.kept[TIME] / 1e3, ANEW: pair.anew[TIME] / 1e3}, "s", "time per step")


def _chart(context, cells, pairs, refused):
    sweep, least = cells["sweep"].iloc[0], noise.floor_of(context, cells["sweep"].iloc[0], TIME)
    places = list(dict.fromkeys(pair.place for pair in pairs))
    lines = len(pairs) + len(places)
    left = min(3.4, 0.3 + max([0.085 * len(name) for name in places] + [0.07 * len(pair.policy) for pair in pairs]))
    room, apart = legend_room([KEPT, ANEW], 1.5), [pair.apart for pair in pairs]
    shows = any(not far <= FLOOR for far in apart)  # where all ends are one the finding says so
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
    for ax, metric in zip(axes[0], (QUERIES, TIME)):
        values = [twins.number(cell, metric) for pair in pairs for cell in (pair.kept, pair.anew)]
        scale = ZeroLog(ax, "x", values, context.unit(metric), failed_name="none")
        for pair in pairs:
            ends = [scale.place(twins.number(cell, metric)) for cell in (pair.kept, pair.anew)]
            ax.plot(ends, [at[id(pair)]] * 2, color="#999999", lw=1.2, zorder=2)
            for x, colour, shift in zip(ends, (twins.BEFORE, twins.AFTER), (-0.14, 0.14)):
                ax.plot([x], [at[id(pair)] + shift], "o", color=colour, ms=6, mec="white", mew=0.5, zorder=3)
            if metric == TIME:
                ax.text(1.02, at[id(pair)], twins.beside(pair.kept, pair.anew, TIME, {TIME: least}),
                        transform=ax.get_yaxis_transform(), va="center", fontsize=8, color="#444444")
        ax.set_title(TITLES[metric])
    if shows:
        scale = ZeroLog(axes[0][2], "x", apart, "m", failed_name="none", floor=FLOOR)
        for pair in pairs:
            axes[0][2].plot([scale.place(pair.apart)], [at[id(pair)]], "o", color="#444444", ms=6, mec="white", mew=0.5, zorder=3)
        axes[0][2].set_title("ends apart, largest")
    for column, ax in enumerate(axes[0]):
        ax.set_ylim(y - 0.3, -0.7)
        ax.set_yticks([place for place, _ in ticks])
        ax.set_yticklabels([name for _, name in ticks] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
    legend_right(figure, [Line2D([], [], ls="none", marker="o", color=colour, label=label)
                          for colour, label in ((twins.BEFORE, KEPT), (twins.AFTER, ANEW))], room)
    return Chart(identifier(f"{sweep}_kept_and_anew"), SECTION, "Contacts of sleepers, left as they were and made anew",
                 finding(pairs, least), sweep, figure, _table(context, pairs, least),
                 refused + holes(cells, ["scene", "dimension", "method", AXIS]),
                 "Each row is one policy with `sleeping_contacts` off and on. Pair queries are a count without noise; numbers "
                 "beside the times are their ratios; a third panel, where ends differ, is how far a body ends from where it ends "
                 f"with the other setting. {noise.rule(least)}", headline=headline(pairs, least))


def _table(context, pairs, least):
    table = {"scene": [pair.place for pair in pairs], "policy": [pair.policy for pair in pairs],
             "outcome": [f"{pair.kept['outcome']} / {pair.anew['outcome']}" for pair in pairs]}
    table |= quantity("pair queries saved", "1", [pair.saved for pair in pairs])
    for metric, title in TITLES.items():
        for side, cell in ((KEPT, "kept"), (ANEW, "anew")):
            table |= quantity(f"{title}, {side}", context.unit(metric),
                              [twins.number(getattr(pair, cell), metric) for pair in pairs])
    words = [twins.told(pair.kept, pair.anew, TIME, least) for pair in pairs]
    table |= quantity("ratio of times", "1", [float(word) if word[:1].isdigit() else math.nan for word in words])
    table["why no ratio"] = ["" if word[:1].isdigit() else word for word in words]
    table |= quantity("ends apart, largest", "m", [pair.apart for pair in pairs])
    table["same bits"] = ["yes" if pair.same_bits else "no" for pair in pairs]
    for i, side in enumerate((KEPT, ANEW)):
        table |= quantity(f"from the end without sleep, {side}", "m", [pair.from_awake[i] for pair in pairs])
        table |= quantity(f"woken by the last act, {side}", "1", [pair.late[i][0] for pair in pairs])
        table |= quantity(f"steps until all are woken, {side}", "1", [pair.late[i][1] for pair in pairs])
    return pd.DataFrame(table)
