# SPDX-License-Identifier: Zlib
"""The same scene twice, one thing changed: an unneeded feature (what it costs), or the precision."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
from chart import Chart, describe, holes, listing
from load import axes_of, one_machine, split, varying
from style import ZeroLog, grid_of_axes, legend_right, letter, si, times

UNNEEDED = "What does a feature cost that a scene does not need?"
PRECISION = "What does single precision change?"
BEFORE, AFTER = "#0072B2", "#D55E00"
MEASURES = [("ms_per_step_median", "time per step"), ("work_row_updates", "row updates per step"),
            ("max_penetration", "largest penetration"), ("end_drift_max", "largest drift at the end")]


def unneeded(context):
    cells = context.store.cells("unneeded")
    if not len(cells) or "model" not in cells:
        return [Chart("unneeded", UNNEEDED, "Unneeded features", "No sweep of unneeded features is in this store.",
                      "unneeded")]
    cells, refused = one_machine(cells)
    same = [c for c in varying(cells, ("model", "dimension")) if c in axes_of(context.store, cells)]
    base_name = next((m for m in cells["model"] if "minimal" in str(m)), cells["model"].iloc[0])
    rows = []
    for part in split(cells, same):
        base = part[part["model"] == base_name]
        for _, row in part[part["model"] != base_name].iterrows():
            rows.append((describe(row, same) or "scene", str(row["model"]), base.iloc[0] if len(base) else None, row))
    said = []
    for place, part in _grouped(rows):
        ratios = [(model, _ratio(base, row, MEASURES[0][0])) for model, base, row in part]
        ratios = [(m, r) for m, r in ratios if math.isfinite(r)]
        if ratios:
            flat = [f"{model} {ratio:.2f}" for model, ratio in sorted(ratios, key=lambda r: -r[1])]
            said.append(f"on {place} {listing(flat)}")
    text = f"Times the time of {base_name}: " + "; ".join(said) + "." if said else f"No timed pair of {base_name} and one more feature finished."
    return [_chart("unneeded", UNNEEDED, "One unneeded feature at a time", text, cells, rows, base_name, "with it",
                   refused, "Each row is one scene with one feature that it does not need; the ratio is to the blue dot, "
                   f"the same scene with the {base_name} model.")]


def precision(context):
    cells = context.store.cells("precision")
    if not len(cells) or "precision" not in cells:
        return [Chart("precision", PRECISION, "f32 against f64", "No precision sweep is in this store.", "precision")]
    cells, refused = one_machine(cells)
    same = [c for c in varying(cells, ("precision",)) if c in axes_of(context.store, cells)]
    place_axes = [c for c in ("scene", "dimension") if c in same]
    rows = []
    for part in split(cells, same):
        f64, f32 = part[part["precision"] == "f64"], part[part["precision"] == "f32"]
        row = f32.iloc[0] if len(f32) else None
        first = part.iloc[0]
        rows.append((describe(first, place_axes) or "scene",
                     describe(first, [c for c in same if c not in place_axes]).replace("resolver=", "") or first["method"],
                     f64.iloc[0] if len(f64) else None, row))
    ratios = [_ratio(base, row, MEASURES[0][0]) for _, _, base, row in rows if base is not None and row is not None]
    ratios = [r for r in ratios if math.isfinite(r)]
    worse = [(place, name, _ratio(base, row, "max_penetration")) for place, name, base, row in rows
             if base is not None and row is not None]
    worse = [w for w in worse if math.isfinite(w[2])]
    said = []
    if ratios:
        said.append(f"f32 takes {np.median(ratios):.2f} times the time of f64 (median of {len(ratios)} pairs, "
                    f"{min(ratios):.2f} to {max(ratios):.2f})")
    if worse:
        most = max(worse, key=lambda w: w[2])
        said.append(f"its penetration differs most on {most[0]} with {most[1]} ({most[2]:.3g} times)")
    differ = [f"{place} with {name} ({base['outcome']} in f64, {row['outcome']} in f32)" for place, name, base, row in rows
              if base is not None and row is not None and base["outcome"] != row["outcome"]]
    said.append(f"the outcome differs on {listing(differ)}" if differ else "no outcome differs")
    return [_chart("precision", PRECISION, "f32 against f64", _capital("; ".join(said)) + ".", cells, rows, "f64", "f32",
                   refused, "Each row is one run in both precisions.")]


def _capital(text):
    return text if text.startswith("f32") else text[:1].upper() + text[1:]


def _grouped(rows):
    found = {}
    for place, name, base, row in rows:
        found.setdefault(place, []).append((name, base, row))
    return found.items()


def _number(row, metric):
    if row is None or row["outcome"] != "ok" or metric not in row or row[metric] is None:
        return math.nan
    return float(row[metric])


def _ratio(base, row, metric):
    a, b = _number(base, metric), _number(row, metric)
    return b / a if a > 0 and math.isfinite(b) else math.nan


def _chart(name, section, title, text, cells, rows, before, after, refused, note):
    measures = [(m, label) for m, label in MEASURES
                if any(math.isfinite(_number(r, m)) for _, _, base, row in rows for r in (base, row))] or MEASURES[:1]
    groups = list(_grouped(rows))
    lines = sum(len(part) + 1 for _, part in groups)
    labels = max([len(n) for _, n, _, _ in rows] + [8])
    places = max(len(place) for place, _ in groups)
    left, legend_width = min(3.4, 0.3 + max(0.07 * labels, 0.082 * places)), 1.25
    figure, axes = grid_of_axes(1, len(measures), 0.24 * lines + 0.1, legend_width, left=left, gap_x=0.62, bottom=0.35)
    outcomes = set()
    for column, (metric, label) in enumerate(measures):
        ax = axes[0][column]
        pairs = [(_number(base, metric), _number(row, metric)) for _, _, base, row in rows]
        scale = ZeroLog(ax, "x", [v for pair in pairs for v in pair], metrics.METRICS[metric].unit, failed_name="none",
                        floor=metrics.METRICS[metric].floor)
        y, ticks = 0, []
        for place, part in groups:
            if column == 0:
                ax.text(-0.04, y, place, transform=ax.get_yaxis_transform(), ha="right", va="center", fontsize=9,
                        fontweight="bold")
            y += 1
            for run, base, row in part:
                ends = []
                for which, colour, shift in ((base, BEFORE, -0.16), (row, AFTER, 0.16)):
                    value = _number(which, metric)
                    place_x = scale.place(value)
                    ends.append((place_x, y + shift))
                    outcome = "not run" if which is None else which["outcome"]
                    marker = "o" if math.isfinite(value) else letter(outcome)
                    if outcome != "ok":
                        outcomes.add(outcome)
                    ax.plot([place_x], [y + shift], marker=marker, color=colour, ms=6, ls="none", zorder=3,
                            mec="white" if marker == "o" else colour, mew=0.5)
                ax.plot(*zip(*ends), color="#999999", lw=1.2, zorder=2)
                ratio = _ratio(base, row, metric)
                if column == 0 and math.isfinite(ratio):
                    ax.text(1.02, y, f"×{ratio:.2f}", transform=ax.get_yaxis_transform(), va="center", fontsize=8,
                            color="#444444")
                ticks.append((y, run))
                y += 1
        ax.set_ylim(y - 0.3, -0.7)
        ax.set_yticks([t for t, _ in ticks])
        ax.set_yticklabels([n for _, n in ticks] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
        ax.set_title(label)
    handles = [Line2D([], [], ls="none", marker="o", color=BEFORE, label=before),
               Line2D([], [], ls="none", marker="o", color=AFTER, label=after)]
    handles += [Line2D([], [], ls="none", marker=letter(o), color="#555555", ms=7, label=o) for o in sorted(outcomes)]
    legend_right(figure, handles, legend_width)
    return Chart(name, section, title, text, cells["sweep"].iloc[0], figure, _table(rows, measures, before, after),
                 refused + holes(cells, ["scene", "dimension", "method", "model", "precision"]),
                 note + " Numbers beside the first panel are ratios of time.")


def _table(rows, measures, before, after):
    table = []
    for place, name, base, row in rows:
        line = {"scene": place, "run": name,
                "outcome": " / ".join("not run" if r is None else r["outcome"] for r in (base, row))}
        for metric, label in measures:
            unit = metrics.METRICS[metric].unit
            line[f"{label}, {before}"] = si(_number(base, metric), unit)
            line[f"{label}, {after}"] = si(_number(row, metric), unit)
            ratio = _ratio(base, row, metric)
            line[f"ratio of {label}"] = "" if math.isnan(ratio) else f"{ratio:.3g}"
        table.append(line)
    return pd.DataFrame(table)
