# SPDX-License-Identifier: Zlib
"""Tolerances of pair queries: what a tighter one costs, and which share of the answers is right within which tolerance."""

import math
import re

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import failure
import metrics
import noise
from chart import Chart, Headline, Needs, dimension_of, holes, identifier, of_store, of_sweeps
from finding import Finding, cut
from finding import told as cell_of
from load import family, one_machine
from sentences import listing
from style import ZeroLog, grid_of_axes, legend_right, legend_room, times
from table import quantity

FAST = "Which pair query is fast and right?"
SETTING, TIME, ERROR = "tolerance", "ns_per_query", "max_error"
WORK = "support_calls"
FEWEST = 3  # values of the tolerance that make a curve


@of_sweeps("tolerance_cost", 74, FAST,
           Needs("pairs", metrics=(TIME, ERROR), also=f"a method with {FEWEST} values of its {SETTING}"),
           "Time over the tolerance", "This store has no timed sweep of pair queries over a tolerance.", "tolerance_cost")
def tolerance_cost(context, cells):
    if WORK not in cells:
        return []
    cells, refused = one_machine(context.store, cells)
    read = [parted(method) for method in cells["method"]]
    cells = cells.assign(who=[who for who, _ in read], at=[at for _, at in read])
    cells = cells[np.isfinite(cells["at"].astype(float))]
    cells = cells.groupby("who").filter(lambda mine: mine["at"].nunique() >= FEWEST) if len(cells) else cells
    if not len(cells):
        return []
    cells["pair"] = ["–".join(sorted((str(a), str(b)))) for a, b in zip(cells["kind_a"], cells["kind_b"])]
    return [_cost_chart(context, cells[dimension_of(cells) == dimension], dimension, refused)
            for dimension in sorted(set(dimension_of(cells)))]


def parted(method):
    """(the method without its tolerance, the tolerance); NaN where the label has no tolerance."""
    found = re.search(rf"\b{SETTING}=([0-9.eE+-]+),?", method)
    if not found:
        return method, math.nan
    return (method[:found.start()] + method[found.end():]).replace(",}", "}").replace("{}", ""), float(found[1])


def ends(cells):
    """(cell of the tightest tolerance, cell of the loosest) of one curve; None where fewer than two cells have a time."""
    good = cells[cells["outcome"].isin(["ok", "wrong"]) & np.isfinite(metrics.column(cells, TIME))].sort_values("at")
    return (good.iloc[0], good.iloc[-1]) if len(good) > 1 else None


def told(cells, least):
    """[(pair, method, tightest, loosest)] where both cells have a time."""
    found = [(pair, who, ends(part)) for (pair, who), part in cells.groupby(["pair", "who"], sort=True)]
    return [(pair, who, *both) for pair, who, both in found if both]


def finding_of_cost(cells, dimension, least):
    """A row per pair of shapes and method: the tightest tolerance against the loosest."""
    rows, found = [], told(cells, least)
    for pair, who, tight, loose in found:
        rows.append({"method": who, "pair": pair, "tolerance": f"{tight['at']:g} to {loose['at']:g}",
                     "time, loosest over tightest": cell_of(noise.said(tight, loose, TIME, least)),
                     "support points": f"{tight[WORK]:.3g} to {loose[WORK]:.3g}",
                     "worst error over the size": f"{tight[ERROR]:.2g} to {loose[ERROR]:.2g}"})
    saves = [row for row in found if noise.tells(row[2], row[3], TIME, least) and row[3][TIME] < row[2][TIME]]
    if saves:  # the largest saving, of a method without failures at the tightest tolerance where there is one
        pair, who, tight, loose = max(saves, key=lambda row: (row[2]["outcome"] == "ok", row[2][TIME] / row[3][TIME]))
        head = (f"On {pair} in {dimension}D a tolerance of {loose['at']:g} saves {who} "
                f"{100 * (1 - loose[TIME] / tight[TIME]):.0f} % of its time; its worst error is {loose[ERROR]:.2g} of the "
                f"size instead of {tight[ERROR]:.2g}.")
        values = {f"{SETTING} {cell['at']:g}": float(cell[TIME]) for cell in (tight, loose)}
        return Finding(head, cut(pd.DataFrame(rows))), Headline("", values, "ns", "time per query")
    head = (f"In {dimension}D a looser tolerance saves no time beyond the noise." if found else
            f"In {dimension}D no method has times at two tolerances.")
    return Finding(head, cut(pd.DataFrame(rows))), None


def _cost_chart(context, cells, dimension, refused):
    pairs, methods, sweep = sorted(cells["pair"].unique()), sorted(cells["who"].unique()), cells["sweep"].iloc[0]
    looks, least = context.looks(cells), noise.floor_of(context, sweep, TIME)
    look_of = {who: looks(cells[cells["who"] == who]["method"].iloc[0]) for who in methods}
    legend_width = legend_room(methods, 1.5)
    figure, axes = grid_of_axes(3, len(pairs), 1.75, legend_width, left=0.85, gap_x=0.65, gap_y=0.3, bottom=0.6)
    bad = ~cells["outcome"].isin(["ok", "wrong"]).to_numpy()
    for column, pair in enumerate(pairs):
        for row, metric in enumerate((TIME, WORK, ERROR)):
            ax, part = axes[row][column], cells[(cells["pair"] == pair) & ~bad]
            across = ZeroLog(ax, "x", cells["at"].astype(float), "1", failures=False)
            values = metrics.column(part, metric)
            up = ZeroLog(ax, "y", values[np.isfinite(values)], context.unit(metric), failures=False,
                         floor=1e-17 if metric == ERROR else 0.0)
            for who in methods:
                mine = part[(part["who"] == who) & np.isfinite(values)].sort_values("at")
                ax.plot([across.place(v) for v in mine["at"]], [up.place(v) for v in metrics.column(mine, metric)],
                        **look_of[who])
            if metric == ERROR:
                known = sorted(v for v in set(cells["at"]) if v > 0)
                limits = ax.get_ylim()
                ax.plot(known, known, color="#999999", lw=1, ls=(0, (4, 3)), zorder=0.6)
                ax.set_ylim(limits)
                ax.set_xlabel(SETTING)
            else:
                ax.tick_params(labelbottom=False)
            if row == 0:
                ax.set_title(pair)
            if column == 0:
                ax.set_ylabel(context.title(metric))
    handles = [Line2D([], [], label=who, **look_of[who]) for who in methods]
    handles.append(Line2D([], [], color="#999999", lw=1, ls=(0, (4, 3)), label="error = tolerance"))
    legend_right(figure, handles, legend_width)
    finding, headline = finding_of_cost(cells, dimension, least)
    return Chart(identifier(f"{sweep} {dimension}d"), FAST, f"Time over the tolerance, {dimension}D", finding, sweep, figure,
                 _table(context, cells), refused + holes(cells[bad].assign(step=math.nan), ["pair", "method"]),
                 "Lower is better. `lpc list --stage pair_query` tells what each method compares its tolerance with. Errors are "
                 "over the size of the query (largest extent + distance + largest coordinate). An answer is wrong when its error "
                 f"exceeds the tolerance that was asked for. {noise.rule(least)}", headline=headline)


def _table(context, cells):
    table = cells.sort_values(["pair", "who", "at"])
    numbers = quantity(SETTING, "1", table["at"])
    for name in (TIME, WORK, ERROR, "median_error"):
        numbers |= quantity(context.title(name), context.unit(name), metrics.column(table, name))
    return pd.DataFrame({"pair": table["pair"], "method": table["who"], "outcome": table["outcome"], **numbers})


FAILS_WHERE = "Which method is right, and which fails where?"
DECADES = range(-16, 1)  # tolerances: from a rounding to the size itself
LOOSE = -3  # a thousandth of the size, which is invisible in a game
EVERYTHING = "all queries"
DASHES = (":", "-.", (0, (6, 2)))  # of settings that are not the defaults


@of_store("within_tolerance", 75, FAILS_WHERE,
          "Right within which tolerance?", "This store has no pair query with a failure.",
          made_by="verify --stage pair_query --pairs 200")
def within_tolerance(context):
    ledger = context.store.ledger()
    rows = ledger[(ledger["stage"] == "pair_query") & (ledger["axis"] == "all") & (ledger["asked"] > 0)]
    groups = rows.groupby(["dimension", "precision"], sort=True)
    # Other groups are right within all of these tolerances.
    return [_right_chart(context, part, *of) for of, part in groups if failure.in_ledger(part)]


def outside(rows, decade):
    """The number of failures of these rows at a tolerance of 10^decade: no answer, a larger error, or the wrong side without a
    value. At the referee's tolerance these are the failures of the ledger."""
    return sum(by[decade] for by in _outside(rows))


def _outside(rows):
    """{decade: failures} of each row."""
    for histogram, wrong, judged, *unanswered in zip(*(rows[name] for name in ("histogram", "wrong", "judged",
                                                                              *failure.UNANSWERED))):
        counts = [(int(name), n) for name, n in histogram.items() if name != "zero"]
        beyond = lambda at: sum(n for error, n in counts if error >= at)  # noqa: E731,B023
        always = sum(map(int, unanswered)) + max(0, int(wrong) - beyond(round(math.log10(failure.TOLERANCE[judged]))))
        yield {decade: always + beyond(decade) for decade in DECADES}


def shares(rows):
    """One row per method and pair of kinds, and one for all pairs: the share of failures, by decade."""
    found = []
    for method, part in rows.assign(failed=list(_outside(rows))).groupby("method", sort=True):
        pairs = [("–".join(pair), of) for pair, of in part.groupby(["kind_a", "kind_b"], sort=True)]
        for pair, of in [(EVERYTHING, part), *pairs]:
            asked = int(of["asked"].sum())
            found.append({"pair": pair, "method": method, "role": of["role"].iloc[0], "asked": asked,
                          "own": (of["judged"] == of["precision"]).all(),
                          **{decade: sum(by[decade] for by in of["failed"]) / asked for decade in DECADES}})
    return pd.DataFrame(found)


def turned(whole, tight, loose, kinds):
    """The two methods that reverse ranks most: the first fails more at the tight tolerance, and less at the loose one. Only
    methods with queries of the same kinds of shapes are compared."""
    best, found = 0.0, None
    for a in whole.index:
        for b in (b for b in whole.index if kinds[a] == kinds[b]):
            by = min(whole[tight][a] - whole[tight][b], whole[loose][b] - whole[loose][a])
            if by > best:
                best, found = by, (a, b)
    return found


def finding_of_right(rows, dimension, precision):
    """(finding, entry on the first screen or None): a row per method. Two witnesses that reverse ranks make the headline."""
    table = shares(rows)
    whole = table[table["pair"] == EVERYTHING].set_index("method")
    kinds = {method: set(part["pair"]) for method, part in table.groupby("method")}
    tight = round(math.log10(failure.TOLERANCE[precision]))
    others = whole[whole["role"] != "competitor"]
    plain = others[others["own"] & [family(m) == m for m in others.index]]  # judged at this tolerance, with default settings
    pair, say = turned(plain, tight, LOOSE, kinds), lambda m, decade: failure.share(whole[decade][m])  # noqa: E731
    entry = None
    if pair:
        a, b = pair
        head = (f"In {dimension}D, {precision}, {a} fails more often than {b} at 1e{tight} of the size ({say(a, tight)} against "
                f"{say(b, tight)}), but less at 1e{LOOSE} ({say(a, LOOSE)} against {say(b, LOOSE)}).")
        entry = Headline("", {f"{m}, 1e{decade}": float(whole[decade][m]) for decade in (tight, LOOSE) for m in pair},
                         quantity="share of failures")
    else:
        first = whole[tight].idxmax()
        head = (f"In {dimension}D, {precision}, {first} fails most often: on {say(first, tight)} of its queries at 1e{tight} of "
                f"the size, on {say(first, LOOSE)} at 1e{LOOSE}.")
    order = sorted(whole.index, key=lambda m: (whole[tight][m], m))
    gains = {m: whole[tight][family(m)] - whole[tight][m] for m in others.index if family(m) != m and family(m) in whole.index}
    helped = max(gains, key=gains.get) if gains and max(gains.values()) > 0 else None  # by settings that are not the defaults
    found = pd.DataFrame({
        "method": [m if whole["role"][m] == "competitor" else f"{m} ({whole['role'][m]})" for m in order],
        f"fails at 1e{tight} [1]": [whole[tight][m] for m in order], f"fails at 1e{LOOSE} [1]": [whole[LOOSE][m] for m in order],
        "outcome": ["rank reverses" if pair and m in pair else
                    f"{say(family(m), tight)} with default settings" if m == helped else
                    "" if whole["own"][m] else f"judged at {failure.tolerance('f32')}: computes in f32" for m in order]})
    kept = [order.index(m) for m in (*(pair or ()), *((helped, family(helped)) if helped else ()))]
    kept += [i for i, m in enumerate(order) if whole["role"][m] == "competitor" and whole[tight][m]]
    return Finding(head, cut(found, kept)), entry


def _right_chart(context, rows, dimension, precision):
    table = shares(rows)
    methods = list(dict.fromkeys(table.sort_values(["role", "method"], kind="stable")["method"]))
    tight = round(math.log10(failure.TOLERANCE[precision]))
    everyones = table.groupby("pair")[tight].max()
    easy = sorted(everyones[everyones == 0].index)
    pairs = [EVERYTHING, *sorted(set(table["pair"]) - {EVERYTHING, *easy})]
    looks = context.looks_of_stage("pair_query")
    columns = min(5, len(pairs))
    legend_width = legend_room(map(context.name, methods), 2.2)
    figure, axes = grid_of_axes(math.ceil(len(pairs) / columns), columns, 1.0, legend_width, left=0.75, gap_x=0.2, gap_y=0.42)
    for index, ax in enumerate(axes.flat):
        if index >= len(pairs):
            ax.set_visible(False)
            continue
        part = table[table["pair"] == pairs[index]].set_index("method")
        ax.axvline(tight, color="#999999", lw=0.8, ls=(0, (4, 3)))
        for method in methods:
            if method in part.index:
                ax.plot(list(DECADES), [100 * (1 - part[d][method]) for d in DECADES], **_line(looks, methods, method))
        ax.set_title(pairs[index], fontsize=8.5)
        ax.set_xlim(min(DECADES), max(DECADES))
        ax.set_ylim(-4, 104)
        ax.set_yticks([0, 50, 100])
        ax.set_xticks([-15, -10, -5, 0])
        ax.set_xticklabels([f"$10^{{{d}}}$" for d in (-15, -10, -5)] + ["1"] if index + columns >= len(pairs) else [])
        ax.tick_params(labelleft=index % columns == 0)
        if index % columns == 0:
            ax.set_ylabel("right, %", fontsize=8.5)
        if index + columns >= len(pairs):
            ax.set_xlabel("tolerance / size", fontsize=8.5)
    handles = [Line2D([], [], label=context.name(m), **_line(looks, methods, m)) for m in methods]
    handles.append(Line2D([], [], color="#999999", lw=0.8, ls=(0, (4, 3)), label="tolerance of the ledger"))
    legend_right(figure, handles, legend_width)
    numbers = table.drop(columns=["role", "own"]).rename(columns={d: f"fails at 1e{d} of the size [1]" for d in DECADES})
    finding, entry = finding_of_right(rows, dimension, precision)
    return Chart(f"within_tolerance_{dimension}d_{precision}", FAILS_WHERE,
                 f"Right within which tolerance, {dimension}D, {precision}", finding, "", figure, numbers,
                 [f"No method fails on {listing(easy)}: not drawn"] if easy else [],
                 "Higher is better: the share of the queries that would be right if the referee allowed that tolerance. The "
                 "dashed line is the ledger's tolerance. A right side without a value (some witnesses give depths only) is never "
                 f"a failure. Braces hold settings that are not the defaults. {failure.DEFINITION}", headline=entry,
                 made_by=f"verify --stage pair_query --dimension {dimension} --precision {precision} --pairs 200")


def _line(looks, methods, method):
    """A colour for each family: solid with default settings, a dash for each other setting; LPC's methods are thicker."""
    look, alike = looks(method), [m for m in methods if family(m) == family(method) != m]
    dash = DASHES[alike.index(method) % len(DASHES)] if method in alike else "-"
    return {"color": look["color"], "lw": 1.2 if "markerfacecolor" in look else 2.2, "ls": dash}
