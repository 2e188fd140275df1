# SPDX-License-Identifier: Zlib
"""The findings that stand on the first screen of the page: which of them, and the small chart of each."""

import math

from style import plt, si

MOST = 10  # on one screen
ROWS = 5  # of a small chart
WIDTH = 3.0  # inches of a small chart
INK, SOFT = "#0072B2", "#777777"


def chosen(charts, most=MOST):
    """The charts whose headlines stand first: of each question, in the order of the page, the one with the largest effect, then
    of each the one with the second largest, and so on. What is the same for all is no finding."""
    questions = {}
    for chart in charts:
        if chart.headline is not None and chart.headline.effect > 1:
            questions.setdefault(chart.section, []).append(chart)
    ranked = [sorted(found, key=lambda chart: -chart.headline.effect) for found in questions.values()]
    rounds = max(map(len, ranked), default=0)
    return [found[place] for place in range(rounds) for found in ranked if place < len(found)][:most]


def rows_of(headline):
    """(name, number) from the smallest to the largest, what failed at the end; of many the least, a gap (None), the largest."""
    known = sorted((item for item in headline.values.items() if item[1] == item[1]), key=lambda item: item[1])
    rows = known + [item for item in headline.values.items() if item[1] != item[1]]
    if len(rows) <= ROWS:
        return rows
    return rows[:ROWS - 2] + [(f"… {len(rows) - ROWS + 1} between", None)] + rows[-1:]


def drawn(headline):
    """One line per name: its number as a dot, from zero on, or on a logarithmic scale where the numbers span a decade."""
    rows = rows_of(headline)
    height = 0.2 * len(rows) + 0.06
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    left = 0.14 + 0.066 * max(len(short(name)) for name, _ in rows)
    figure.subplots_adjust(left=left / WIDTH, right=1 - 0.72 / WIDTH, top=1, bottom=0)
    finite = [value for _, value in rows if value is not None and math.isfinite(value)]
    above = [value for value in finite if value > 0]
    wide = bool(above) and max(above) / min(above) > 10
    low, high = (min(above), max(above)) if above else (0.0, 1.0)
    for y, (name, value) in enumerate(rows):
        place = 0.0
        if value is not None and math.isfinite(value) and value > 0:
            # A zero stands at the left edge, apart from the smallest number.
            place = 0.12 + 0.88 * math.log(value / low) / math.log(high / low) if wide else value / high
        if value is not None:
            # A bar from zero has a length; on a logarithmic scale a place is all that there is.
            ax.plot([0, 1 if wide else place], [y, y], color="#C9D6E2", lw=0.8 if wide else 3, ls=":" if wide else "-", zorder=1)
            ax.plot([place], [y], marker="o", ms=5, color=INK if value == value else SOFT, zorder=2, clip_on=False)
            text = "failed" if value != value else si(value, headline.unit)
            ax.text(1.09, y, text, transform=ax.get_yaxis_transform(), va="center", fontsize=8)
        ax.text(-0.06, y, short(name), transform=ax.get_yaxis_transform(), va="center", ha="right", fontsize=8,
                color=SOFT if value is None else "black")
    ax.set_xlim(0, 1)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.axis("off")
    return figure


def short(name):
    return name if len(name) <= 22 else name[:21] + "…"
