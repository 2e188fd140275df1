# SPDX-License-Identifier: Zlib
"""How runs fall: the last stored poses of some of them, with energy and penetration beneath."""

import math

import numpy as np
import pandas as pd
from matplotlib.gridspec import GridSpecFromSubplotSpec

from chart import Chart, Needs, describe
from load import varying
from style import WIDTH, plt, si

PLACE = 45
SECTION = "When does each method fall?"
NEEDS = Needs("world", series=("kinetic", "potential", "max_penetration"))
FALLEN = ("collapsed", "exploded", "diverged")
ABSENT = Chart("falls", SECTION, "How runs fall", "No run of this store fell: nothing collapsed, exploded or diverged.",
               "breaking_points_stack")
FALLS = 3  # in one chart
MOMENTS = 5


def of_sweep(context, cells):
    chosen = chosen_falls(context, cells)
    return [_chart(context, cells, chosen)] if chosen else []


def chosen_falls(context, cells):
    """Of the cells that fell and kept poses: of each method the one that fell last, of these the first, the middle one and the
    last to fall. Whoever falls late is watched longest."""
    fallen = cells[cells["outcome"].isin(FALLEN) & cells["key"].notna()].sort_values("step", kind="stable")
    last = fallen.drop_duplicates("method", keep="last")
    rows = [(row, context.store.poses(row["key"], dimension_of(row))) for _, row in last.iterrows()]
    rows = [(row, poses) for row, poses in rows if len(poses) > 1]
    if len(rows) > FALLS:
        rows = [rows[round(i * (len(rows) - 1) / (FALLS - 1))] for i in range(FALLS)]
    return rows


def dimension_of(row):
    dimension = row.get("dimension")
    return int(dimension) if dimension == dimension and dimension is not None else 2


def moments(poses, count=MOMENTS):
    """The steps of the strip: the first, and the last ones, where it falls."""
    steps = sorted(poses)
    return steps if len(steps) <= count else [steps[0], *steps[-(count - 1):]]


def moving(poses):
    """Without bodies that are never elsewhere, and without numbers that are none."""
    steps = sorted(poses)
    first, last = ({row[0]: tuple(row) for row in poses[step]} for step in (steps[0], steps[-1]))
    still = {slot for slot, pose in first.items() if last.get(slot) == pose}
    return {step: np.array([row for row in rows if row[0] not in still and np.isfinite(row).all()]).reshape(-1, rows.shape[1])
            for step, rows in poses.items()}


def corners(rows, dimension, size):
    """A square for each body where it is, turned as it is: in 3D as seen from the front, along -z."""
    middle = rows[:, 1:3]
    if dimension == 2:
        along = np.stack([np.cos(rows[:, 3]), np.sin(rows[:, 3])], axis=1)
        aside = np.stack([-along[:, 1], along[:, 0]], axis=1)
    else:
        w, x, y, z = rows[:, 4:8].T
        along = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z)], axis=1)
        aside = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z)], axis=1)
    turns = [(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]
    return np.stack([middle + size / 2 * (u * along + v * aside) for u, v in turns], axis=1)


def size_of(rows):
    """How far the nearest body is, at the median (m): bodies that touch are about as large."""
    middle = rows[:, 1:3]
    if len(middle) < 2:
        return 1.0
    ways = np.hypot(*(middle[:, None, :] - middle[None, :, :]).T)
    np.fill_diagonal(ways, math.inf)
    return float(np.median(ways.min(axis=1))) or 1.0


def _chart(context, cells, chosen):
    height = 3.5 * len(chosen) + 0.2
    figure = plt.figure(figsize=(WIDTH, height))
    outer = figure.add_gridspec(len(chosen), 1, left=0.07, right=0.985, top=1 - 0.42 / height, bottom=0.5 / height, hspace=0.42)
    axes = ["scene", "method", *varying(context.store, cells, ("scene", "method"))]
    said, table = [], []
    for place, (row, poses) in zip(outer, chosen):
        names = [axis for axis in axes if axis in row]
        where = describe(row, names)
        energy, depth = _series(context, row)
        grid = GridSpecFromSubplotSpec(2, 1, place, height_ratios=[1.45, 1], hspace=0.35)
        _strip(figure, GridSpecFromSubplotSpec(1, MOMENTS, grid[0], wspace=0.05), row, poses, f"{where}: {row['reason']}")
        _lines(figure, GridSpecFromSubplotSpec(1, 2, grid[1], wspace=0.22), energy, depth, row["step"])
        said.append(f"{where} {row['outcome']} at step {row['step']:.0f}, its deepest overlap {si(_largest(depth), 'm')}")
        table.append({"run": where, "outcome": row["outcome"], "step": row["step"], "reason": row["reason"],
                      "energy at the start [J]": _first(energy), "largest energy [J]": _largest(energy),
                      "largest penetration [m]": _largest(depth)})
    sweep = cells["sweep"].iloc[0]
    fallen = int(cells["outcome"].isin(FALLEN).sum())
    text = f"{fallen} of {len(cells)} cells fell; of those drawn, " + "; ".join(said) + "."
    return Chart(f"{sweep}_falls", SECTION, "How runs fall", text, sweep, figure, pd.DataFrame(table),
                 note="From stored poses: the start and the last moments. The store holds no shapes: each body that moves is a "
                      "square as wide as bodies were apart at the start, in 3D seen from the front. lpc run --film draws the "
                      "shapes.")


def _series(context, row):
    kinetic, potential, depth = (context.store.series(row["key"], name) for name in NEEDS.series)
    energy = None if kinetic is None or potential is None else kinetic + potential
    return energy, depth


def _finite(values):
    return np.array([]) if values is None else values[np.isfinite(values)]


def _first(values):
    values = _finite(values)
    return float(values[0]) if len(values) else math.nan


def _largest(values):
    values = _finite(values)
    return float(values.max()) if len(values) else math.nan


def _strip(figure, grid, row, poses, title):
    dimension, steps = dimension_of(row), moments(poses)
    poses = moving(poses)
    size = size_of(poses[steps[0]])
    drawn = {step: corners(poses[step], dimension, size) for step in steps}
    first = drawn[steps[0]].reshape(-1, 2) if len(drawn[steps[0]]) else np.zeros((1, 2))
    low, high = first.min(axis=0), first.max(axis=0)
    room = max(*(high - low), 4 * size) * 0.35
    for index, step in enumerate(steps):
        ax = figure.add_subplot(grid[index])
        for square in drawn[step]:
            ax.plot(square[:, 0], square[:, 1], color="#0072B2", lw=0.8)
        ax.set_xlim(low[0] - room, high[0] + room)
        ax.set_ylim(low[1] - room / 4, high[1] + room / 2)
        ax.set_aspect("equal", adjustable="box")
        ax.set_axis_off()
        ax.text(0.03, 0.95, f"step {step}", transform=ax.transAxes, va="top", fontsize=8)
        if index == 0:
            box = ax.get_position()
            figure.text(0.012, box.y1 + 0.1 / figure.get_figheight(), title, fontsize=9, weight="bold", va="bottom")


def _lines(figure, grid, energy, depth, step):
    for index, (values, title, unit) in enumerate([(energy, "energy", "J"), (depth, "penetration", "m")]):
        ax = figure.add_subplot(grid[index])
        if values is not None and len(values):
            ax.plot(np.arange(1, len(values) + 1), np.where(np.isfinite(values), values, np.nan), color="#0072B2", lw=1.2)
        ax.axvline(step, color="#D55E00", lw=1, ls="--")
        ax.set_ylabel(f"{title} [{unit}]", fontsize=8)
        ax.set_xlabel("step", fontsize=8)
        ax.tick_params(labelsize=7.5)
