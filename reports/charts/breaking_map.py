# SPDX-License-Identifier: Zlib
"""Where each method breaks, by question: the value at which half of the seeds fail, with its interval, the last that holds, what
it costs there, and the ladder of all values that were tried. Methods tie where their intervals overlap. Where a closed form gives
the value, methods are told by how far they are from it, on either side. A method that left rows to Gauss-Seidel up to its
breaking point has no rank. `lpc break` and sweeps with `break` make the data; experiments/runner/breaking.cpp has the same
rules."""

import math
import textwrap
from dataclasses import dataclass

import pandas as pd
from matplotlib.patches import Patch, Rectangle

import measured
import noise
import ranking
import rest
from chart import Chart, Headline, Needs, identifier, of_sweeps
from load import split
from sentences import does, listing, methods, plural
from style import WIDTH, figures, plt, si
from table import quantity

SECTION = "When does each method fall?"
MOST_COLUMNS = 6
COLOURS = ["#8FC1E3", "#BBD9EE", "#DDEBF5", "#F3EFE6", "#F6D9B8", "#EDB48A"]  # by how many halves of the best: 0, 1/2, 1, ...
STEPS = (0.05, 0.5, 1, 2, 4)
HOLDS, SOME, FAILS = "#2E7D46", "#D9A400", "#C0392B"
COLUMN = ["question", "scene", "dimension", "precision", "budget"]


@dataclass
class Rung:
    value: float
    failed: int
    of: int
    outcome: str

    @property
    def holds(self):
        return 2 * self.failed < self.of


@dataclass
class Found:
    """What a search found for one method. "Before" is nearer to the end where all hold."""
    rungs: list  # in order of value
    held: object = None  # the last Rung before the first that fails
    fell: object = None  # that one
    half: float = math.nan  # where half of the seeds fail, between these two by their shares
    low: float = math.nan  # its interval, by those of the shares; NaN: open
    high: float = math.nan
    beyond: tuple = ()  # values that hold beyond one that fails
    laxer: dict = None  # {limit: where half of the seeds have sunk farther than that share of the smallest body}
    hole: str = ""  # why there is no rung
    dear: str = ""  # what a rung that is unsupported is
    cost: float = math.nan  # multiply-adds per step of what held, or of the first
    ms: float = math.nan
    excuse: str = ""  # why it has no rank


@of_sweeps("breaking_map", 39, SECTION,
           Needs("world", also="questions of breaking points", calibrated=None),
           "Breaking points, searched", "No search for breaking points is in this store.", "breaking_map")
def breaking_map(context, cells):
    questions = context.store.sweep(cells["sweep"].iloc[0]).questions
    if "question" not in cells or not questions:
        return []
    return [_chart(context, cells, questions)]


def failed_seeds(cell, limit):
    """Seeds of a rung that fail: by their outcome, or by what they measured."""
    if not limit:
        return int(cell["failed_seeds"])
    metric, below, bound = limited(limit)
    values = measured.of(cell, metric).seeds if len(cell["seeds"]) > 1 else [cell.get(metric)]
    if not values:  # every seed failed, so that none has a value
        return len(cell["seeds"])
    return max(int(cell["failed_seeds"]), sum(v is None or not (v < bound if below else v > bound) for v in values))


def limited(text):
    at = next(i for i, c in enumerate(text) if c in "<>")
    return text[:at], text[at] == "<", float(text[at + 1:])


def judged(rungs, falling):
    """As `judge` of experiments/runner/breaking.cpp."""
    found, sure, to_hold, to_fail, beyond = Found(sorted(rungs, key=lambda r: r.value)), True, math.nan, math.nan, []
    for rung in reversed(found.rungs) if falling else found.rungs:
        low, high = noise.wilson(rung.failed, rung.of)
        sure = sure and high < 0.5
        if sure:
            to_hold = rung.value
        if found.fell is None:
            if rung.holds:
                found.held = rung
            else:
                found.fell = rung
        elif rung.holds:
            beyond.append(rung.value)
        if found.fell is not None and math.isnan(to_fail) and low > 0.5:
            to_fail = rung.value
    found.low, found.high = (to_fail, to_hold) if falling else (to_hold, to_fail)
    found.beyond = tuple(beyond)
    if found.held and found.fell and not ended_by_cost(found):
        a, b = (rung.failed / rung.of for rung in (found.held, found.fell))
        found.half = found.held.value * (found.fell.value / found.held.value) ** ((0.5 - a) / (b - a))
    return found


def laxer(store, cells, about):
    """What would hold by the laxer limits, from the same runs: as near as the values that were tried for the strictest."""
    found = {}
    for limit in rest.LIMITS[1:]:
        rungs = []
        for _, cell in cells.iterrows():
            trials = [store.trials.loc[key] for key in cell["keys"]]
            far = [rest.sunk(trial["outcome"], trial["metrics"].get("sunk")) > limit or breaks(trial["metrics"], about["limit"])
                   for trial in trials]
            rungs.append(Rung(float(cell[about["parameter"]]), sum(far), len(far), cell["outcome"]))
        found[limit] = judged(rungs, about["falling"])
    return found


def breaks(measured, limit):
    if not limit:
        return False
    metric, below, bound = limited(limit)
    value = measured.get(metric)
    return value is None or not (value < bound if below else value > bound)


def found_of(store, cells, about, excused):
    """The search of one method on one question, from the cells of its rungs. `excused`: {index: why a cell has no rank}."""
    name, rungs, known = about["parameter"], [], []
    for _, cell in cells.iterrows():
        if any(key is None for key in cell["keys"]) or not cell["keys"]:
            continue  # stopped before all its seeds were run
        rungs.append(Rung(float(cell[name]), failed_seeds(cell, about["limit"]), len(cell["seeds"]), cell["outcome"]))
        known.append((float(cell[name]), cell))
    if not rungs:
        return Found([], hole="not run")
    found = judged(rungs, about["falling"])
    found.excuse = ranking.largest(excused[cell.name] for value, cell in known
                                   if cell.name in excused and reached(found, value, about["falling"]))
    if len(rungs) == 1 and rungs[0].outcome == "unsupported":
        found.hole = "unsupported"
    shown = found.held or found.fell
    cell = next(cell for value, cell in known if value == shown.value)
    found.dear = "over budget" if cell.get("budget", math.nan) == cell.get("budget", math.nan) else "unsupported"
    whole = cells[[bool(keys) and None not in keys for keys in cells["keys"]]]
    if any(store.trials.loc[key]["metrics"].get("sunk") is not None for keys in whole["keys"] for key in keys):
        found.laxer = laxer(store, whole, about)
    found.cost, found.ms = (float(cell.get(metric, math.nan)) for metric in ("work_multiply_adds", "ms_per_step_median"))
    return found


def reached(found, value, falling):
    """Whether a value is no farther than the first that fails: what lies beyond decides nothing."""
    return found.fell is None or (value >= found.fell.value if falling else value <= found.fell.value)


def ended_by_cost(found):
    """Was the first value that fails not run, since it costs more than the budget?"""
    return found.fell is not None and found.fell.outcome == "unsupported"


def unit_of(name):
    return "s" if name == "dt" else "1"


def value_text(name, value):
    return "" if math.isnan(value) else si(value, "s") if name == "dt" else figures(value)


def edge(found):
    """Where half of the seeds fail, or the last that was tried where nothing fails; NaN: nothing holds."""
    return math.nan if not found.held else found.half if found.half == found.half else found.held.value


def ranked(column):
    """What was run and has a rank."""
    return {method: found for method, found in column.items() if not found.hole and not found.excuse}


def best_of(column, falling):
    values = [edge(f) for f in column.values() if f.held]
    return (min(values) if falling else max(values)) if values else math.nan


def far(found, best):
    """How many halves a method is from the best, or from the closed form."""
    return math.inf if not found.held else abs(math.log2(edge(found) / best)) if best > 0 else math.nan


def span(found):
    """The interval of where half of the seeds fail; what is open has no end."""
    return (found.low if found.low == found.low else -math.inf, found.high if found.high == found.high else math.inf)


def ties(known, value):
    """Methods that are not told from those with this breaking point: their intervals overlap, in more than an end."""
    held = {m: f for m, f in known.items() if f.held}
    there = [span(f) for f in held.values() if edge(f) == value]
    return [m for m, f in held.items() if edge(f) == value or any(span(f)[0] < high and low < span(f)[1] for low, high in there)]


def right(known, truth):
    """Methods that break where the closed form says, as far as the intervals tell."""
    return [m for m, f in known.items() if f.held and span(f)[0] <= truth <= span(f)[1]]


def finding(title, column, about, labels):
    name, known = about["parameter"], ranked(column)
    out = ranking.told({m: f.excuse for m, f in column.items() if f.excuse})
    if not known:
        return f"{title}: {'No method has a rank' if out else 'Nothing was run'}.{out}"
    best = best_of(known, about["falling"])
    said = [f"No method holds at any {name} that was tried"] if math.isnan(best) else (
        _by_closed_form(known, about, labels) if about["truth"] else _by_rank(known, best, about, labels))
    left = {m: f for m, f in known.items() if not f.held}
    none = [m for m, f in left.items() if not ended_by_cost(f)]
    if none and len(none) < len(known):
        said.append(f"{_doing(none, 'holds', labels)} at no value that was tried")
    for word in sorted({f.dear for m, f in left.items() if m not in none}):
        dear = [m for m, f in left.items() if m not in none and f.dear == word]
        said.append(f"{does(dear, 'are', labels)} {word} from the first")
    odd = [m for m, f in known.items() if f.beyond]
    said += [plural(len(odd), "ladder is", "ladders are") + " not monotone"] if odd else []
    return f"{title}: {'. '.join(said)}.{out}"


def _by_rank(known, best, about, labels):
    """Which methods hold longest and which shortest; of either those that tie."""
    name = about["parameter"]
    first = ties(known, best)
    said, held = [holds_to(known, first, best, name, labels)], {m: f for m, f in known.items() if f.held and m not in first}
    if held:
        worst = best_of(held, not about["falling"])
        last = ties(held, worst)
        said.append(f"{_doing(last, 'holds', labels)} least, to {value_text(name, worst)}" + _tied(last))
    return said


def holds_to(known, first, best, name, labels):
    """`catto and naive hold to n = 8.49 and tie: their intervals overlap`; of what never failed under how many seeds."""
    at = [known[m] for m in first if edge(known[m]) == best]
    text = f"{_doing(first, 'holds', labels)} to {name} = {value_text(name, best)}"
    if all(ended_by_cost(f) for f in at):
        text += f" (then {at[0].dear})"
    elif any(f.fell is None for f in at):
        text += f" (the last that was tried, under {seeds_of(f.held.of for f in at if f.fell is None)})"
    return text + _tied(first)


def seeds_of(counts):
    counts = sorted(set(counts))
    return plural(counts[0], "seed") if len(counts) == 1 else f"{counts[0]} to {counts[-1]} seeds"


def _tied(names):
    return " and tie: their intervals overlap" if len(names) > 1 else ""


def _by_closed_form(known, about, labels):
    name, truth = about["parameter"], about["truth"]
    at = right(known, truth)
    said = [f"The closed form gives {name} = {value_text(name, truth)}", f"{_doing(at, 'breaks', labels)} there"]
    for verb, word, off in (("fails", "before that, at", 1), ("holds", "beyond that, to", -1)):
        some = [m for m, f in known.items() if f.held and m not in at and
                (edge(f) - truth) * off * (1 if about["falling"] else -1) > 0]
        worst = max(some, key=lambda m: far(known[m], truth), default=None)
        said += [f"{_doing(some, verb, labels)} {word} {value_text(name, edge(known[worst]))}"] if some else []
    return said


def _doing(names, verb, labels):
    return f"{methods(names, labels)} {verb if len(names) == 1 else verb[:-1]}" if names else f"No method {verb}"


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
    note = ("A cell is one search. Its number is the value at which half of the seeds fail, between the last that holds and the "
            f"first that fails ({seeds} seeds at this edge, {few} elsewhere, started up to {starts} m and rad beside their "
            "places). In brackets its interval: up to the first all shares of failures are below a half, by their 95 % intervals "
            "(Wilson), that of the second is above; “?” where no value that was tried is so sure. Methods tie where their "
            "intervals overlap in more than an end. The dots are the values that were tried, the smallest on the left.")
    if any(found.laxer for _, _, column in columns for found in column.values()):
        note += f" {rest.WORDS}; in grey what these two alone would hold to, by the values that were tried."
    if any(about["truth"] for _, about, _ in columns):
        note += " Where a closed form says where it breaks, colours are by the distance from that, on either side."
    if any(found.excuse for _, _, column in columns for found in column.values()):
        note += (" A white cell has no rank: up to its number so many rows were left to Gauss-Seidel, or its precision is "
                 "another.")
    if any(ended_by_cost(found) for _, _, column in columns for found in column.values()):
        note += " Over budget: with a single iteration the method costs more than the budget allows."
    if limits:
        note += f" A run fails by its outcome, or by what it measures ({'; '.join(limits)})."
    return Chart(identifier(f"{sweep} breaking map"), SECTION, "Where each method breaks",
                 " ".join(finding(_place(title), column, about, labels) for title, about, column in columns),
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
    held = {m: edge(f) for m, f in ranked(column).items()}
    known = {m: f for m, f in ranked(column).items() if f.held}
    if len(held) < 2 or not known or len(set(held.values())) < 2:
        return None
    name, place = about["parameter"], _place(title)
    if about["truth"]:
        off = {m: abs(value - about["truth"]) if value == value else math.nan for m, value in held.items()}
        last = max(known, key=lambda m: off[m])
        words = (f"The closed form gives {name} = {value_text(name, about['truth'])}. "
                 f"{_doing(right(known, about['truth']), 'breaks', labels)} there, {last} at {value_text(name, held[last])}.")
        return Headline(f"{place}: {words}", off, unit_of(name), f"distance of {name} from the closed form")
    best = best_of(known, about["falling"])
    return Headline(f"{place}: {holds_to(known, ties(known, best), best, name, labels)}.", held, unit_of(name),
                    f"{name} at which half of the seeds fail", larger=not about["falling"])


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
    words = ["as far as the best", "down to 0.7 of it", "a half", "a quarter", "a sixteenth", "less, or none"]
    handles = [Patch(facecolor=colour, label=word) for colour, word in zip(COLOURS, words)]
    handles += [plt.Line2D([], [], ls="none", marker="s", ms=5, color=colour, label=word) for colour, word in (
        (HOLDS, "no seed fails"), (SOME, "some do"), (FAILS, "all do"))]
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
    lines = iter((0.36, 0.53, 0.70))  # below the number: the interval, other limits, the cost

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
        told = {}  # value -> the limits at which it is the breaking point
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
