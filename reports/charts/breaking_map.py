# SPDX-License-Identifier: Zlib
"""The breaking point of each method, by question: the value of a parameter at which half of the seeds fail, with its interval,
the cost there and all values that were tried.

Methods tie if their intervals overlap. If a closed form gives the value, methods are judged by their distance from it, on either
side. A method that left rows to Gauss-Seidel up to its breaking point has no rank. `lpc break` and sweeps with `break` make the
data."""

import math
import textwrap
from collections import Counter

import pandas as pd
from matplotlib.patches import Patch, Rectangle

import ranking
import rest
from breaking import best_of, edge, ended_by_cost, found_of, ranked, right, ties
from chart import Chart, Headline, Needs, identifier, of_sweeps
from finding import AGAINST, TIE, Finding, Line, cut, ends
from finding import ranked as by_rank
from load import split
from sentences import clauses, listing, methods, plural, some, verb
from style import WIDTH, figures, plt, si
from table import quantity

SECTION = "When does each method fall?"
MOST_COLUMNS = 6
COLOURS = ["#8FC1E3", "#BBD9EE", "#DDEBF5", "#F3EFE6", "#F6D9B8", "#EDB48A"]  # by halvings of the best value: 0, 1/2, 1, ...
STEPS = (0.05, 0.5, 1, 2, 4)
HOLDS, SOME, FAILS = "#2E7D46", "#D9A400", "#C0392B"
COLUMN = ["question", "scene", "dimension", "precision", "budget"]


@of_sweeps("breaking_map", 39, SECTION,
           Needs("world", also="questions of breaking points", calibrated=None),
           "Breaking points, searched", "This store has no search for breaking points.", "breaking_map")
def breaking_map(context, cells):
    questions = context.store.sweep(cells["sweep"].iloc[0]).questions
    if "question" not in cells or not questions:
        return []
    return [_chart(context, cells, questions)]


def unit_of(name):
    return "s" if name == "dt" else "1"


def value_text(name, value):
    return "" if math.isnan(value) else si(value, "s") if name == "dt" else figures(value)


def far(found, best):
    """How many halvings a method is from the best, or from the closed form."""
    return math.inf if not found.held else abs(math.log2(edge(found) / best)) if best > 0 else math.nan


def lines_of(column, about):
    """Lines of the finding's table for one question; methods without a value or rank stand last."""
    falling, name = about["falling"], about["parameter"]
    why, found = {}, []
    for method, f in column.items():
        if f.hole or f.excuse or not f.held:
            why[method] = f.hole or (f"not ranked: {f.excuse}" if f.excuse else
                                     f"{f.dear} at every value tried" if ended_by_cost(f) else "failed: holds at no value tried")
            continue
        remark = [f"then {f.dear}"] if ended_by_cost(f) else [] if f.fell else [f"last value tried, {plural(f.held.of, 'seed')}"]
        remark += ["not monotone"] if f.beyond else []
        more = {"remark": ", ".join(remark)} if remark else {}
        outcome = ""
        if about["truth"]:
            off = (edge(f) - about["truth"]) * (1 if falling else -1)
            outcome = ("as the closed form" if method in right({method: f}, about["truth"]) else
                       f"{'fails before it' if off > 0 else 'holds beyond it'} by {value_text(name, abs(off))}")
        found.append(Line(method, edge(f), f.low, f.high, outcome, more))
    if about["truth"]:
        found.sort(key=lambda line: abs(line.value - about["truth"]))
    return found, ranking.lines(why)


def table_of_one(column, about):
    """The finding's table where the chart has one question: method, breaking point, interval, against the best."""
    name, best = about["parameter"], best_of(ranked(column), about["falling"])
    found, others = lines_of(column, about)
    tied = [] if about["truth"] else ties(ranked(column), best)
    made = by_rank(found + others, f"half of the seeds fail at {name}", unit_of(name), tied if len(tied) > 1 else (),
                   not about["falling"], range_title="95 % interval", keep=[line.name for line in others])
    return made.rename(columns={AGAINST: "against the closed form"}) if about["truth"] else made


def table_of_many(columns, labels):
    """The finding's table where the chart has several questions: the best and the worst of each."""
    rows = []
    for title, about, column in columns:
        name, (first, last) = about["parameter"], ends_of(column, about)
        at = lambda found: value_text(name, edge(ranked(column)[found[0]])) if found else ""  # noqa: B023, E731
        best = [ranked(column)[m] for m in first[:1]]
        rows.append({"question": _place(title), "best": methods(first, labels) if first else "none",
                     "best breaks at": f"{name} = {at(first)}" if first else "",
                     "95 % interval": ends(best[0].low, best[0].high, unit_of(name)) if best else "",
                     "worst": methods(last, labels) if last else "", "worst breaks at": at(last),
                     **({"closed form": value_text(name, about["truth"])} if about["truth"] else {}),
                     "no value or rank": "; ".join(f"{line.name} ({line.outcome})" for line in lines_of(column, about)[1])})
    return cut(pd.DataFrame(rows).fillna(""))


def ends_of(column, about):
    """(the best methods and all that tie with them, the worst likewise); the second is empty if there is no other."""
    known = {m: f for m, f in ranked(column).items() if f.held}
    if not known:
        return [], []
    if about["truth"]:
        off = {m: abs(edge(f) - about["truth"]) for m, f in known.items()}
        first = right(known, about["truth"]) or [min(off, key=off.get)]
        return first, [max(off, key=off.get)] if len(first) < len(known) else []
    first = ties(known, best_of(known, about["falling"]))
    others = {m: f for m, f in known.items() if m not in first}
    return first, ties(others, best_of(others, not about["falling"])) if others else []


def words(title, column, about, labels):
    """One question in one sentence."""
    name, known, place = about["parameter"], ranked(column), _place(title)
    first, last = ends_of(column, about)
    if not known:
        return f"{place}: {'no method has a rank' if any(f.excuse for f in column.values()) else 'nothing was run'}."
    if not first:
        return f"{place}: no method holds at any {name} that was tried."
    value = lambda m: value_text(name, edge(known[m]))  # noqa: E731
    if about["truth"]:
        at = right(known, about["truth"])
        breaks = f"{some(at, labels)} {verb(len(at), 'break')}" if at else "no method breaks"
        return (f"{place}: the closed form gives {name} = {value_text(name, about['truth'])}; {breaks} there"
                + (f", {last[0]} at {value(last[0])}." if last else "."))
    return f"{place}: {holds_to(known, first, labels, name)}."


def holds_to(known, first, labels, name):
    """`catto and naive hold to n = 8.49 and tie`; a value that never failed has its number of seeds."""
    best = [f for f in (known[m] for m in first) if edge(f) == edge(known[first[0]])]
    text = f"{some(first, labels)} {verb(len(first), 'hold')} to {name} = {value_text(name, edge(best[0]))}"
    if all(ended_by_cost(f) for f in best):
        text += f" (then {best[0].dear})"
    elif any(f.fell is None for f in best):
        text += f" (the last value tried, {seeds_of(f.held.of for f in best if f.fell is None)})"
    return text + (f" and {TIE}" if len(first) > 1 else "")


def seeds_of(counts):
    counts = sorted(set(counts))
    return plural(counts[0], "seed") if len(counts) == 1 else f"{counts[0]} to {counts[-1]} seeds"


def finding(columns, labels):
    """For one question its best and all methods; for several the methods that are best and worst most often."""
    if len(columns) == 1:
        (title, about, column), = columns
        return Finding(words(title, column, about, labels), table_of_one(column, about))
    found = [ends_of(column, about) for _, about, column in columns]
    best, worst = (Counter(m for question in found for m in question[end]) for end in (0, 1))
    top = lambda count: [m for m in labels if count[m] and count[m] == max(count.values())]  # noqa: E731
    first, last = top(best), top(worst)
    said = clauses(f"{some(first, labels)} {verb(len(first), 'are')} best or {verb(len(first), 'tie')} for the best in "
                   f"{best[first[0]]} of {len(columns)} questions" if first else
                   f"no method holds in any of {len(columns)} questions",
                   last and f"{some(last, labels)} {verb(len(last), 'are')} worst in {worst[last[0]]}")
    return Finding(f"{said[:1].upper()}{said[1:]}." if not first else f"{said}.", table_of_many(columns, labels))


def _chart(context, cells, questions):
    labels = sorted(cells["method"].unique())
    columns = []  # (title, about, {method: Found})
    axes = [axis for axis in COLUMN if axis in cells and cells[axis].notna().any()]
    for part in split(cells, axes):
        first = part.iloc[0]
        about = {"truth": 0, **questions[first["question"]]}
        excused = ranking.excused(context, part)
        column = {method: found_of(context.store, own, about, excused) for method, own in part.groupby("method", sort=True)}
        columns.append((_title(cells, first, axes), about, column))
    figure = _figure(context, columns, labels)
    told = [found for found in (headline(title, column, about, labels) for title, about, column in columns) if found]
    sweep = cells["sweep"].iloc[0]
    limits = [f"{name}: {about['limit']}" for name, about in questions.items() if about["limit"]]
    seeds, few, starts = (listing(dict.fromkeys(figures(about.get(key, about["seeds"])) for about in questions.values()))
                          for key in ("seeds", "few", "perturb"))
    note = ("A cell: the value at which half of the seeds fail, its 95 % interval (Wilson; “?”: open end), the cost there, and "
            f"a dot for each value tried. {seeds} seeds ran at the last value that holds and the first that fails, {few} at the "
            f"others, with start positions perturbed by up to {starts} m and rad.")
    if any(found.laxer for _, _, column in columns for found in column.values()):
        note += f" {rest.WORDS}; their breaking points are grey."
    if any(about["truth"] for _, about, _ in columns):
        note += " Where a closed form gives the breaking point, colours show the distance from it."
    if any(found.excuse for _, _, column in columns for found in column.values()):
        note += " A white cell has no rank: its method left rows to Gauss-Seidel, or its precision differs."
    if any(ended_by_cost(found) for _, _, column in columns for found in column.values()):
        note += " Over budget: even one iteration costs more than the budget allows."
    if limits:
        note += f" A run fails by its outcome or by a limit ({'; '.join(limits)})."
    return Chart(identifier(f"{sweep} breaking map"), SECTION, "Breaking point of each method", finding(columns, labels),
                 sweep, figure, _table(columns), _holes(columns), note,
                 headline=max(told, key=lambda h: h.effect, default=None))


def _holes(columns):
    said = []
    for title, about, column in columns:
        for method, found in column.items():
            where = f"{_place(title)}, {method}"
            if found.hole:
                said.append(f"{where}: {found.hole}")
            if found.beyond:
                values = listing(value_text(about["parameter"], value) for value in found.beyond)
                said.append(f"{where}: not monotone, holds again at {values}")
    return said


def _title(cells, first, axes):
    parts = []
    for axis in axes:
        value = first[axis]
        if axis == "question":
            parts.append(str(value))
        elif value == value and value is not None and (axis == "scene" or cells[axis].nunique() > 1):
            parts.append(f"{int(value)}D" if axis == "dimension" else
                         f"{figures(float(value))} multiply-adds" if axis == "budget" else
                         str(value))
    return "\n".join(parts)


def _place(title):
    return title[:1].upper() + title[1:].replace("\n", ", ")


def headline(title, column, about, labels):
    """For the first screen: one question, if its methods differ."""
    held = {m: edge(f) for m, f in ranked(column).items()}
    if len(held) < 2 or not any(value == value for value in held.values()) or len(set(held.values())) < 2:
        return None
    name, text = about["parameter"], words(title, column, about, labels)
    if about["truth"]:
        off = {m: abs(value - about["truth"]) if value == value else math.nan for m, value in held.items()}
        return Headline(text, off, unit_of(name), f"distance of {name} from the closed form")
    return Headline(text, held, unit_of(name), f"{name} at which half of the seeds fail", larger=not about["falling"])


def _figure(context, columns, labels):
    called = ["\n".join(textwrap.wrap(context.name(m), 34)) for m in labels]
    left = min(3.0, 0.3 + 0.075 * max(len(line) for label in called for line in label.split("\n")))
    blocks = [columns[i:i + MOST_COLUMNS] for i in range(0, len(columns), MOST_COLUMNS)]
    row, above, below = 0.88, 0.75, 0.55  # inches
    height = sum(above + row * len(labels) for _ in blocks) + below
    figure = plt.figure(figsize=(WIDTH, height))
    y = height
    for block in blocks:
        y -= above + row * len(labels)
        wide = (WIDTH - left - 0.15) * len(block) / min(MOST_COLUMNS, max(3, len(columns)))
        ax = figure.add_axes((left / WIDTH, y / height, wide / WIDTH, row * len(labels) / height))
        _block(ax, block, labels, called)
    shares = ["as the best", "0.7 of it", "a half", "a quarter", "a sixteenth", "less, or none"]
    handles = [Patch(facecolor=colour, label=word) for colour, word in zip(COLOURS, shares)]
    handles += [plt.Line2D([], [], ls="none", marker="s", ms=5, color=colour, label=word) for colour, word in (
        (HOLDS, "no seed fails"), (SOME, "some fail"), (FAILS, "all fail"))]
    figure.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.01, 0.0), ncol=9, columnspacing=1.0, handlelength=1.0,
                  handletextpad=0.4)
    return figure


def _block(ax, block, labels, called):
    ax.set_xlim(0, len(block))
    ax.set_ylim(len(labels), 0)
    for x, (title, about, column) in enumerate(block):
        best = about["truth"] or best_of(ranked(column), about["falling"])
        values = [r.value for f in column.values() for r in f.rungs]
        ends = (min(values), max(values)) if values else (1.0, 2.0)
        for y, method in enumerate(labels):
            found = column.get(method)
            if found is None:
                continue
            _cell(ax, x, y, found, about, best, ends)
    ax.set_xticks([x + 0.5 for x in range(len(block))])
    ax.set_xticklabels([title for title, _, _ in block], fontsize=8.5)
    ax.xaxis.tick_top()
    ax.set_yticks([y + 0.5 for y in range(len(labels))])
    ax.set_yticklabels(called)
    ax.tick_params(length=0)
    ax.grid(False)
    for side in ax.spines.values():
        side.set_visible(False)


def _cell(ax, x, y, found, about, best, ends):
    name = about["parameter"]
    halves = far(found, best)
    colour = "#F2F2F2" if found.hole else "white" if found.excuse else COLOURS[sum(halves > step for step in STEPS)]
    ax.add_patch(Rectangle((x + 0.02, y + 0.04), 0.96, 0.92, facecolor=colour, lw=0.8 if found.excuse else 0,
                           edgecolor="#BBBBBB"))
    if found.hole:
        ax.text(x + 0.5, y + 0.5, found.hole, ha="center", va="center", fontsize=8, color="#777777")
        return
    sign = "≤ " if about["falling"] else "≥ "
    dear = found.dear if ended_by_cost(found) else ""
    main = dear or "none" if not found.held else ("" if found.fell else sign) + value_text(name, edge(found))
    bracket = f"[{value_text(name, found.low) or '?'}, {value_text(name, found.high) or '?'}]"
    lines = iter((0.36, 0.53, 0.70))  # heights below the number: interval, other limits, cost

    def line(words, size=7.5, colour="#444444"):
        ax.text(x + 0.06, y + next(lines), words, ha="left", va="center", fontsize=size, color=colour)
    ax.text(x + 0.06, y + 0.18, main, ha="left", va="center", fontsize=9.5, fontweight="bold")
    aside = [f"then {dear}"] if dear and found.held else []
    aside += [f"+{len(found.beyond)} beyond"] if found.beyond else []
    for number, words in enumerate(aside):
        ax.text(x + 0.94, y + 0.18 + 0.18 * number, words, ha="right", va="center", fontsize=7.5, color=FAILS)
    if found.held and not found.fell:
        ax.text(x + 0.94, y + 0.18, seeds_of([found.held.of]), ha="right", va="center", fontsize=7.5, color="#444444")
    line(bracket)
    if found.laxer:
        told = {}  # breaking point -> its limits
        for limit, f in found.laxer.items():
            told.setdefault(("" if f.fell else sign) + (value_text(name, edge(f)) or "none"), []).append(rest.percent(limit))
        line(", ".join(f"{listing(limits)}: {'the same' if value == main else value}" for value, limits in told.items()), 7,
             "#777777")
    cost = "" if math.isnan(found.cost) else f"{figures(found.cost)}"
    cost += "" if math.isnan(found.ms) else f"{', ' if cost else ''}{si(found.ms, 'ms')}"
    if found.excuse:
        ax.text(x + 0.94, y + 0.70, found.excuse, ha="right", va="center", fontsize=7.5, color=FAILS)
    line(cost)
    low, high = math.log(ends[0]), math.log(ends[1])
    for rung in found.rungs:
        at = (math.log(rung.value) - low) / (high - low) if high > low else 0.5
        shade = HOLDS if not rung.failed else FAILS if rung.failed == rung.of else SOME
        ax.plot([x + 0.07 + 0.86 * at], [y + 0.88], ls="none", marker="s", ms=3.2, color=shade, mew=0)


def _table(columns):
    parts = []
    for title, about, column in columns:
        name, unit = about["parameter"], unit_of(about["parameter"])
        found = list(column.values())
        rung = lambda which: [getattr(f, which).value if getattr(f, which) else math.nan for f in found]  # noqa: E731
        part = {"question": _place(title), "method": list(column), "parameter": name}
        for words, values in (("half of the seeds fail at", [f.half for f in found]),
                              ("last that holds", rung("held")), ("first that fails", rung("fell")),
                              ("half fail from", [f.low for f in found]), ("half fail to", [f.high for f in found])):
            part |= quantity(words, unit, values)
        for limit in rest.LIMITS[1:]:
            part |= quantity(f"half have sunk by more than {rest.percent(limit)} at", unit,
                             [edge(f.laxer[limit]) if f.laxer else math.nan for f in found])
        part |= {"not ranked": [f.excuse for f in found],
                 "seeds at the last that holds": [f.held.of if f.held else 0 for f in found],
                 "seeds that fail at the first that fails": [f.fell.failed if f.fell else 0 for f in found],
                 "outcome there": [f.fell.outcome if f.fell else f.hole for f in found],
                 "values tried": [len(f.rungs) for f in found], "hold beyond": [len(f.beyond) for f in found]}
        part |= quantity("multiply-adds per step", "1", [f.cost for f in found])
        part |= quantity("time per step", "ms", [f.ms for f in found])
        parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True)
