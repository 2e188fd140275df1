# SPDX-License-Identifier: Zlib
"""The finding of a chart: one headline sentence that answers the chart's question, and a small table.

Failures, ties and differences inside the noise are values in the table.
"""

import math
import re
from dataclasses import dataclass, field

import pandas as pd

import noise
import table as tables
from style import si, times

WORDS = 30  # of a headline, at most
ROWS = 12  # of the small table, at most
BEST, TIE, NOISE = "best", "tie", "inside the noise"
AGAINST = "against the best"  # title of a column

strict = False  # tests set it: chart.made then refuses a headline with a fault


@dataclass(frozen=True, eq=False)
class Finding:
    headline: str
    table: pd.DataFrame = field(default_factory=pd.DataFrame)  # a column of numbers is titled "what it is [unit]" (table.py)

    def rows(self):
        """For JSON: one {title of the column: value} per row."""
        return tables.records(self.table)

    def text(self):
        """Headline and table as plain text, one line per row."""
        return text(self.headline, self.rows())


def text(headline, rows):
    """`rows`: as Finding.rows gives them, or as JSON gives them back."""
    titles = ["; ".join(tables.heading(name)[0] for name in rows[0])] if rows else []
    return "\n".join([headline, *titles, *("; ".join(part or "–" for part in tables.texts(row)) for row in rows)])


def fault(headline):
    """What is wrong with the wording of a headline; empty where nothing is."""
    if len(headline.split()) > WORDS:
        return f"{len(headline.split())} words, at most {WORDS}: {headline}"
    if not re.search(r"\w", headline) or not headline.endswith(".") or re.search(r"[.!?]\s", headline):
        return f"not one sentence with a full stop: {headline}"
    return f"more than one semicolon: {headline}" if headline.count(";") > 1 else ""


def fits(*headlines):
    """The first of these wordings, the fullest first, that has no fault; the last where all have one."""
    return next((text for text in headlines if not fault(text)), headlines[-1])


def cut(table, keep=(), most=ROWS):
    """A long table, sorted from best to worst, cut to `most` rows: the first, the last, those at the places `keep` (such as the
    ties with the best), then the best of the others. A row "… n more" stands for each gap."""
    count = len(table)
    if count <= most:
        return table
    wanted = list(dict.fromkeys((0, count - 1, *keep, *range(count))))
    for size in range(most, 0, -1):
        rows = _with_gaps(table, set(wanted[:size]))
        if len(rows) <= most:
            break
    return pd.DataFrame(rows, columns=table.columns, dtype=object)


def _with_gaps(table, kept):
    rows, left = [], 0
    for place, row in enumerate([*table.itertuples(index=False, name=None), None]):
        if row is not None and place not in kept:
            left += 1
            continue
        if left:
            rows.append((f"… {left} more", *[None] * (len(table.columns) - 1)))
            left = 0
        rows += [row] if row is not None else []
    return rows


@dataclass(frozen=True)
class Line:
    """A line of the table that `ranked` makes."""
    name: str
    value: float = math.nan
    low: float = math.nan  # of the range: an interval, or the least and the most of several seeds
    high: float = math.nan
    outcome: str = ""  # why it has no value, or no rank: "failed: collapsed", "not ranked: f32 among f64"
    more: dict = field(default_factory=dict)  # more columns; a line may lack some


def ranked(lines, title, unit, ties=(), larger=False, floor=0.0, name="method", range_title="range", keep=(), most=ROWS):
    """The table from best to worst, cut: name, value, range, ratio or word against the best; lines with an outcome stand last.
    `ties`: names that tie with the best, or {name: the word that says it}. Values up to `floor` count as 0. `keep`: names that
    are not cut, nor are methods that failed or have no rank."""
    words = ties if isinstance(ties, dict) else {tied: TIE for tied in ties}
    known = sorted((line for line in lines if not line.outcome and math.isfinite(line.value)),
                   key=lambda line: (-line.value if larger else line.value, line.name))
    first = known[0] if known else None
    order = known + [line for line in lines if line.outcome or not math.isfinite(line.value)]
    columns = {name: [line.name for line in order], **tables.quantity(title, unit, [
        0.0 if abs(line.value) <= floor else line.value for line in order])}
    if any(math.isfinite(line.low) and math.isfinite(line.high) and line.high > line.low for line in order):
        columns[range_title] = [ends(line.low, line.high, unit) for line in order]
    columns[AGAINST] = [line.outcome or against(line, first, words, floor, unit) for line in order]
    for key in dict.fromkeys(key for line in order for key in line.more):
        columns[key] = [line.more.get(key) for line in order]
    kept = [i for i, line in enumerate(order) if line.name in words or line.name in keep or
            line.outcome.startswith(("failed", "not ranked"))]
    kept = [len(known) - 1] * bool(known) + sorted(kept, key=lambda i: not order[i].outcome)  # the worst, failures, then ties
    return cut(pd.DataFrame(columns), kept, most)


def ends(low, high, unit):
    """A range in words: "1 mm to 3 mm"; empty where it is unknown."""
    if not (math.isfinite(low) or math.isfinite(high)):
        return ""
    return " to ".join(dict.fromkeys(si(v, unit) if math.isfinite(v) else "?" for v in (low, high)))


def told(said):
    """A cell for what noise.said gives: the ratio as a number, or the words for why there is none."""
    words = {noise.NOISE: f"{TIE}: {NOISE}", noise.FEW: f"{TIE}: {noise.FEW}"}
    return float(said) if said[:1].isdigit() else words.get(said, said)


def against(line, first, words, floor, unit):
    """"best", "tie", "1.4 times", or the difference where the best is 0."""
    if first is None or not math.isfinite(line.value):
        return ""
    if line.name in words and line is not first:
        return words[line.name]
    if line is first:
        return f"{BEST}, {TIE}" if TIE in words.values() else BEST
    return ratio(line.value, first.value, floor, unit)


def ratio(value, best, floor=0.0, unit="1"):
    """"1.4 times"; the difference where the best is 0, empty where the two read alike."""
    value, best = (0.0 if abs(v) <= floor else v for v in (value, best))
    if value == best:
        return "equal"
    if best > 0 and value > 0:
        much = times(value / best)
        return f"{much} times" if much not in ("1.00", "1.0") else "equal in three digits"
    return f"+{si(value - best, unit)}" if value > best else si(value - best, unit)
