# SPDX-License-Identifier: Zlib
"""Panels over the steps of a run, one column per scene and one line per method, for several charts."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import ranking
from chart import describe
from finding import cut
from finding import ranked as by_rank
from load import split, varying
from sentences import listing, some
from style import HALO, fallen, grid_of_axes, legend_right, legend_room
from table import quantity

COLUMNS = 3  # scenes side by side
STRETCHES = 150
MARKS = 4  # on a line
LADDER = 4  # a sweep with as many values of a parameter belongs to the charts of breaking points
ONE_COURSE = f"one seed and fewer than {LADDER} values of each parameter"  # what a chart needs unless `elsewhere`


def elsewhere(context, cells):
    """Whether a sweep belongs to other charts: many values of a parameter ask for the breaking point, and one run says little
    about an ensemble of seeds."""
    return any(cells[axis].nunique() >= LADDER for axis in context.parameters(cells)) or (cells["seeds"].map(len) > 1).any()


def scenes(context, cells):
    """([(name, cells of one scene, all settings)], at most COLUMNS of them; messages about the others; the setting)."""
    setting = next(iter(context.settings(cells)), None)
    found = []
    for scene in split(cells, ["scene"]):
        names = ["scene", *varying(context.store, scene, ("dimension", setting))]
        found += [(describe(equal.iloc[0], names), equal) for equal in split(scene, names)]
    return found[:COLUMNS], [f"{where}: not drawn, the chart shows {COLUMNS} scenes" for where, _ in found[COLUMNS:]], setting


def own_setting(cells, setting):
    """The cells, with no value of the setting for methods that have no such setting. An older store gives these the first value:
    there a method with one value among methods with several counts as a method without the setting."""
    if not setting or cells[setting].dropna().empty or cells["settings_told"].all():
        return cells
    alone = cells["method"].map(cells.groupby("method")[setting].nunique()) < min(2, cells[setting].nunique())
    return cells.assign(**{setting: cells[setting].where(~alone)})


def at_middle(cells, setting):
    """The cells at the middle value of the setting, at which methods are compared."""
    if not setting or cells[setting].dropna().empty:
        return cells
    values, cells = sorted(cells[setting].dropna().unique()), own_setting(cells, setting)
    return cells[cells[setting].isna() | (cells[setting] == values[len(values) // 2])]


def setting_of(cells, setting):
    """The value of the setting of cells `at_middle`, as words after "In 2D"; empty if there is no setting."""
    values = sorted(cells[setting].dropna().unique()) if setting else []
    return f" at {setting}={listing(f'{v:g}' if isinstance(v, float) else str(v) for v in values)}" if values else ""


def without_setting(cells, setting):
    """For the note: the methods that have no such setting; empty if there is none."""
    names = sorted(set(cells["method"][cells[setting].isna()])) if setting and cells[setting].notna().any() else []
    return f" Without {setting}: {listing(names)}." if names else ""


def by_scene(parts, title, unit):
    """The finding's table from [(scene, lines, names that tie with the best)]: all methods of one scene, or the best and the
    worst method of each of several scenes. Less is better."""
    if len(parts) == 1:
        (_, lines, ties), = parts
        return by_rank(lines, title, unit, ties, keep=[line.name for line in lines if line.outcome])
    rows = []
    for where, lines, ties in parts:
        known = sorted((line for line in lines if not line.outcome), key=lambda line: line.value)
        first = list(dict.fromkeys([line.name for line in known[:1]] + list(ties)))
        last = known[-1] if known and known[-1].name not in first else None
        rows.append({"scene": where, "best": some(first, most=3) if first else "none",
                     **one(f"{title}, best", unit, known[0].value if known else math.nan), "worst": last.name if last else "",
                     **one(f"{title}, worst", unit, last.value if last else math.nan),
                     "remark": "; ".join(f"{line.name} ({line.outcome})" for line in lines if line.outcome)})
    return cut(pd.DataFrame(rows))


def one(title, unit, value):
    """table.quantity for a single row."""
    return {name: values[0] for name, values in quantity(title, unit, [value]).items()}


def stretches(values, of=np.median):
    """(first step, value) of each of STRETCHES intervals of steps; NaN does not count."""
    edges = np.unique(np.linspace(0, len(values), min(STRETCHES, len(values)) + 1).astype(int))
    parts = [values[a:b][np.isfinite(values[a:b])] for a, b in zip(edges[:-1], edges[1:])]
    return edges[:-1], np.array([of(part) if len(part) else math.nan for part in parts])


def grid(context, cells, rows, columns):
    legend_width = legend_room(ranking.names(context, cells).values(), 2.0)
    figure, axes = grid_of_axes(rows, columns, 2.2, legend_width, left=1.0, gap_x=0.8, gap_y=0.75)
    return figure, axes, legend_width


def legend(context, figure, cells, width):
    looks, called = context.looks(cells), ranking.names(context, cells)
    legend_right(figure, [Line2D([], [], label=called[m], **looks(m)) for m in sorted(called)], width)


def lines(context, ax, cells, values_of, place, of=np.median, drawn=None):
    """One line per method: `values_of(cell)` has a value per step, `place` puts a value on the axis. The letters of failed runs
    are drawn last. `of`: the statistic of an interval of steps; `drawn`: the methods with a line, if others equal them."""
    looks, spots = context.looks(cells), []
    for order, (_, cell) in enumerate(cells.drop_duplicates("method").sort_values("method").iterrows()):
        values = None if cell["key"] is None else values_of(cell)
        if values is None or not np.isfinite(values).any() or drawn is not None and cell["method"] not in drawn:
            continue
        step, shown = stretches(values, of)
        every = max(1, len(step) // MARKS)
        look = {**looks(cell["method"]), "lw": 1.2}
        ax.plot(step, [place(v) if math.isfinite(v) else math.nan for v in shown], **look,
                markevery=(order * every // max(1, cells["method"].nunique()), every))
        if cell["outcome"] != "ok":
            last = [v for v in shown if math.isfinite(v)][-1]
            spots.append((len(values), place(last), cell["outcome"], look["color"]))
    fallen(ax, spots, clip_on=False, path_effects=HALO)
    ax.set_xlabel("step")
