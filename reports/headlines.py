# SPDX-License-Identifier: Zlib
"""The first screen of the page: the choice of its findings, and a small chart of each."""

import math
import re
from dataclasses import dataclass

from load import family
from style import plt, si
from table import SI

MOST = 10  # on one screen
ROWS = 6  # of a small chart
WIDTH = 3.0  # inches of a small chart
INK, SOFT = "#0072B2", "#777777"


def chosen(charts, most=MOST):
    """The charts of the first screen: of each question, in the order of the page, the chart with the largest effect, then of each
    the one with the second largest, and so on. An effect of 1 is no finding."""
    questions = {}
    for chart in charts:
        if chart.headline is not None and chart.headline.effect > 1:
            questions.setdefault(chart.section, []).append(chart)
    ranked = [sorted(found, key=lambda chart: -chart.headline.effect) for found in questions.values()]
    rounds = max(map(len, ranked), default=0)
    return [found[place] for place in range(rounds) for found in ranked if place < len(found)][:most]


@dataclass(frozen=True)
class Row:
    """A row of a small chart: methods of one family with the same number share a row; the value of a gap is None."""
    name: str
    value: object
    under: str = ""  # smaller, below the name
    methods: tuple = ()


def rows_of(headline):
    """Rows from the best to the worst, failures last. Of many rows: the ends, the rows that the sentence names, then the best; a
    gap says how many rows it leaves out."""
    rows, sign = merged(headline), -1 if headline.larger else 1
    rows = sorted((row for row in rows if row.value == row.value), key=lambda row: sign * row.value) + [
        row for row in rows if row.value != row.value]
    wanted = sorted(range(len(rows)), key=lambda i: (i not in (0, len(rows) - 1), not named(headline.text, rows[i]), i))
    for count in range(len(rows), 1, -1):
        shown = _with_gaps(rows, set(wanted[:count]))
        if len(shown) <= ROWS:
            return shown
    return rows[:ROWS]


def _with_gaps(rows, kept):
    shown, left = [], []
    for i, row in enumerate(rows):
        if i not in kept:
            left += row.methods
        if i in kept or i == len(rows) - 1:
            shown += [Row(f"… {len(left)} between", None)] if left else []
            left = []
            shown += [row] if i in kept else []
    return shown


def merged(headline):
    """The rows: methods of a family with the same number share one, which says whether their runs end in the same bits."""
    groups = {}
    for name, value in headline.values.items():
        groups.setdefault((family(name), "failed" if value != value else value), []).append(name)
    rows = []
    for (stem, _), names in groups.items():
        value = headline.values[names[0]]
        if len(names) == 1:
            rows.append(Row(names[0], value, "", tuple(names)))
            continue
        everyone = sum(family(name) == stem for name in headline.values)
        ends = {headline.ends.get(name) for name in names}
        alike = "same bits" if len(ends) == 1 and None not in ends else "equal"
        count = f"{len(names)} variants" if len(names) == everyone else f"{len(names)} of {everyone} variants"
        rows.append(Row(stem, value, count if value != value else f"{count}, {alike}", tuple(names)))
    return rows


def named(text, row):
    """Whether a sentence names a method of the row, or its whole family."""
    return any(re.search(rf"(?<![\w+]){re.escape(name)}(?![\w+{{])", text) for name in row.methods) or (
        len(row.methods) > 1 and f" {row.name} variants" in text)


def caption(headline, wide):
    """The name of the numbers with their SI unit."""
    unit = SI.get(headline.unit, (1, headline.unit))[1]
    return f"{headline.quantity}{'' if unit == '1' else f' ({unit})'}{', logarithmic' if wide else ''}"


def drawn(headline):
    """One dot per row, on a linear scale from zero, or on a logarithmic one where the numbers span more than a decade. Failures
    are crosses at the worse end."""
    rows = rows_of(headline)
    tops, height = [], 0.03
    for row in rows:
        tops.append(height)
        height += 0.32 if row.under else 0.2
    height += 0.2 if headline.quantity else 0.03
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    left = 0.14 + max(max(0.066 * len(short(row.name)), 0.052 * len(row.under)) for row in rows)
    figure.subplots_adjust(left=left / WIDTH, right=1 - 0.72 / WIDTH, top=1, bottom=0)
    finite = [row.value for row in rows if row.value is not None and math.isfinite(row.value)]
    above = [value for value in finite if value > 0]
    wide = bool(above) and max(above) / min(above) > 10
    low, high = (min(above), max(above)) if above else (0.0, 1.0)
    failed = any(row.value is not None and row.value != row.value for row in rows)
    span = 0.84 if failed and not headline.larger else 1.0  # the rest is for failures
    for row, top in zip(rows, tops):
        y, value = top + (0.16 if row.under else 0.1), row.value
        place = 0.0
        if value is not None and value > 0:
            # A zero is drawn at the left edge, apart from the smallest number.
            place = span * (0.12 + 0.88 * math.log(value / low) / math.log(high / low) if wide else value / high)
        if value is not None and value == value:
            # A bar from zero has a length; on a logarithmic scale only the place has a meaning.
            ends, width, dots = [0, span if wide else place], 0.8 if wide else 3, ":" if wide else "-"
            ax.plot(ends, [y, y], color="#C9D6E2", lw=width, ls=dots, zorder=1)
            ax.plot([place], [y], marker="o", ms=5, color=INK, zorder=2, clip_on=False)
        elif value is not None:
            ax.plot([0.0 if headline.larger else 1.0], [y], marker="x", ms=5, mew=1.5, color=SOFT, zorder=2, clip_on=False)
        right = {"transform": ax.get_yaxis_transform(), "va": "center"}
        if value is not None:
            ax.text(1.09, y, "failed" if value != value else si(value, headline.unit), fontsize=8, **right)
        ax.text(-0.06, y - (0.06 if row.under else 0), short(row.name), ha="right", fontsize=8,
                color=SOFT if value is None else "black", **right)
        if row.under:
            ax.text(-0.06, y + 0.07, row.under, ha="right", fontsize=6.5, color=SOFT, **right)
    if headline.quantity:
        figure.text(1 - 0.04 / WIDTH, 0.09 / height, caption(headline, wide), ha="right", va="center", fontsize=7, color=SOFT)
    ax.set_xlim(0, 1)
    ax.set_ylim(height, 0)
    ax.axis("off")
    return figure


def short(name):
    return name if len(name) <= 22 else name[:21] + "…"
