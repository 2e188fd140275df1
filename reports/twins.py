# SPDX-License-Identifier: Zlib
"""Rows of two dots per metric: a run, and the same run with one change. Used by several charts."""

import math

import pandas as pd
from matplotlib.lines import Line2D

import measured
import noise
from chart import Chart, holes
from style import ZeroLog, grid_of_axes, legend_right, letter
from table import quantity

BEFORE, AFTER = "#0072B2", "#D55E00"


def measures(context):
    """The two main costs and the two main errors."""
    return context.metrics("world", "cost")[:2] + errors(context)


def errors(context):
    return [name for name in context.metrics("world", "error") if not context.metric(name).needs][:1] + [
        name for name in context.metrics("world", "error") if context.metric(name).compute][:1]


def grouped(rows):
    found = {}
    for place, name, base, row in rows:
        found.setdefault(place, []).append((name, base, row))
    return found.items()


def number(row, metric):
    if row is None or row["outcome"] != "ok" or metric not in row or row[metric] is None:
        return math.nan
    return float(row[metric])


def ratio_of(base, row, metric):
    a, b = number(base, metric), number(row, metric)
    return b / a if a > 0 and math.isfinite(b) else math.nan


def drawn(context, name, section, title, text, cells, rows, before, after, refused, note, headline=None):
    shown = measures(context)
    shown = [m for m in shown if any(math.isfinite(number(r, m)) for _, _, base, row in rows for r in (base, row))] or shown[:1]
    groups = list(grouped(rows))
    lines = sum(len(part) + 1 for _, part in groups)
    labels = max([len(n) for _, n, _, _ in rows] + [8])
    places = max(len(place) for place, _ in groups)
    left, legend_width = min(3.4, 0.3 + max(0.07 * labels, 0.082 * places)), 1.5
    figure, axes = grid_of_axes(1, len(shown), 0.24 * lines + 0.1, legend_width, left=left, gap_x=0.62, bottom=0.35)
    outcomes, least = set(), {metric: noise.floor_of(context, cells["sweep"].iloc[0], metric) for metric in shown
                           if context.store.is_time(metric)}
    for column, metric in enumerate(shown):
        ax = axes[0][column]
        pairs = [(number(base, metric), number(row, metric)) for _, _, base, row in rows]
        # A metric that a scene does not define has no mark; a failed run has a mark at the edge.
        failed = any(row is None or row["outcome"] != "ok" for _, _, *twins in rows for row in twins)
        scale = ZeroLog(ax, "x", [v for pair in pairs for v in pair], context.unit(metric), failed_name="none",
                        failures=failed, floor=context.floor(metric))
        y, ticks = 0, []
        for place, part in groups:
            if column == 0:
                ax.text(-0.04, y, place, transform=ax.get_yaxis_transform(), ha="right", va="center", fontsize=9,
                        fontweight="bold")
            y += 1
            for run, base, row in part:
                ends = []
                for which, colour, shift in ((base, BEFORE, -0.16), (row, AFTER, 0.16)):
                    value = number(which, metric)
                    outcome = "not run" if which is None else which["outcome"]
                    if outcome == "ok" and not math.isfinite(value):
                        continue
                    place_x = scale.place(value)
                    runs = measured.runs(which, metric) if which is not None else []
                    if len(runs) > 1 and math.isfinite(value):
                        low, high = noise.interval(runs)
                        ax.plot([scale.place(low), scale.place(high)], [y + shift] * 2, color=colour, lw=1, alpha=0.7, zorder=2.5)
                    ends.append((place_x, y + shift))
                    marker = "o" if math.isfinite(value) else letter(outcome)
                    if outcome != "ok":
                        outcomes.add(outcome)
                    ax.plot([place_x], [y + shift], marker=marker, color=colour, ms=6, ls="none", zorder=3,
                            mec="white" if marker == "o" else colour, mew=0.5)
                if len(ends) == 2:
                    ax.plot(*zip(*ends), color="#999999", lw=1.2, zorder=2)
                if column == 0:
                    ax.text(1.02, y, beside(base, row, metric, least), transform=ax.get_yaxis_transform(), va="center",
                            fontsize=8, color="#444444")
                ticks.append((y, run))
                y += 1
        ax.set_ylim(y - 0.3, -0.7)
        ax.set_yticks([t for t, _ in ticks])
        ax.set_yticklabels([n for _, n in ticks] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
        ax.set_title(context.title(metric))
    handles = [Line2D([], [], ls="none", marker="o", color=BEFORE, label=before),
               Line2D([], [], ls="none", marker="o", color=AFTER, label=after)]
    handles += [Line2D([], [], ls="none", marker=letter(o), color="#555555", ms=7, label=o) for o in sorted(outcomes)]
    legend_right(figure, handles, legend_width - 0.35)  # the last title is wider than its panel
    return Chart(name, section, title, text, cells["sweep"].iloc[0], figure, _table(context, rows, shown, before, after, least),
                 refused + noise.idle_seeds(cells) + holes(cells, ["scene", "dimension", "method", "model", "precision"]),
                 note + " Numbers beside the first panel are ratios of time; whiskers contain the median of the repeats. " +
                 noise.rule(next(iter(least.values()), noise.UNMEASURED)), headline=headline)


def beside(base, row, metric, least):
    """The text beside a row: the ratio, or why there is none."""
    if metric not in least:
        found = ratio_of(base, row, metric)
        return f"×{found:.2f}" if math.isfinite(found) else ""
    text = told(base, row, metric, least[metric])
    return {noise.SAME_WORK: "= work", noise.FEW: "too few"}.get(text, f"×{text}" if text[:1].isdigit() else text)


def told(base, row, metric, least):
    """noise.said of two runs if both finished, otherwise empty."""
    return noise.said(base, row, metric, least) if math.isfinite(ratio_of(base, row, metric)) else ""


def _table(context, rows, shown, before, after, least):
    table = []
    for place, name, base, row in rows:
        line = {"scene": place, "run": name,
                "outcome": " / ".join("not run" if r is None else r["outcome"] for r in (base, row))}
        for metric in shown:
            label, unit = context.title(metric), context.unit(metric)
            for which, side in ((base, before), (row, after)):
                line |= {name: values[0] for name, values in quantity(f"{label}, {side}", unit, [number(which, metric)]).items()}
            if metric in least:  # a number if the ratio counts, otherwise the reason
                text = told(base, row, metric, least[metric])
                line[f"ratio of {label} [1]"] = ratio_of(base, row, metric) if text[:1].isdigit() else math.nan
                line[f"{label}: why no ratio"] = "" if text[:1].isdigit() else text
            else:
                line[f"ratio of {label} [1]"] = ratio_of(base, row, metric)
        table.append(line)
    return pd.DataFrame(table)
