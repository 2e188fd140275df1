# SPDX-License-Identifier: Zlib
"""How far from solved a step is: normalised complementarity over the iterations spent, and over the steps of the run."""

import math

import numpy as np
import pandas as pd

import metrics
import over_steps
import ranking
from chart import Chart, Needs, holes, methods, of_sweeps
from load import split
from style import ZeroLog, plain_log, si
from table import quantity

SECTION = "Do more iterations solve the contacts?"
SERIES, RESIDUAL = "residual", "residual_median"
FLOOR = 1e-12  # below it a residual is rounding


@of_sweeps("residual", 35, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"),
                 also="one seed, contacts and several values of a setting"),
           "Residual", "No sweep of several methods with residuals is in this store.", "resolvers")
def residual(context, cells):
    if RESIDUAL not in context.store.metrics or (cells["seeds"].map(len) > 1).any():
        return []  # a store of an earlier program; an ensemble, of which one run says little
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        if nothing(part):
            continue  # no contacts, no residual
        shown, left_out, setting = over_steps.scenes(context, part)
        if setting and metrics.column(part[part["outcome"] == "ok"], RESIDUAL).size:
            made.append(_chart(context, part, shown, left_out, setting))
    return made


def slopes(cells, setting):
    """Per method: its residual at the least and at the most of the setting that most methods finished both at, so that all are
    compared over the same span; nothing where there is no such span."""
    good = cells[(cells["outcome"] == "ok") & np.isfinite(metrics.column(cells, RESIDUAL))].drop_duplicates(["method", setting])
    table = good.pivot(index="method", columns=setting, values=RESIDUAL).sort_index(axis=1)
    values = list(table.columns)
    spans = [(least, most) for i, least in enumerate(values) for most in values[i + 1:]]
    # Of spans that as many methods have, the widest.
    least, most = max(spans, key=lambda span: (len(table[list(span)].dropna()), span[1] / span[0] if span[0] > 0 else math.inf),
                      default=(None, None))
    rows = [] if least is None else [(method, least, row[least], most, row[most])
                                     for method, row in table[[least, most]].dropna().iterrows()]
    return pd.DataFrame(rows, columns=["method", "least", "before", "most", "after"])


def nothing(cells):
    """Whether no run of these has a residual above 0: a scene without contacts has none."""
    return not (metrics.column(cells, RESIDUAL) > 0).any()


def finding(where, cells, setting):
    table = slopes(cells, setting)
    if nothing(cells):
        return f"on {where} every residual is 0"
    values = cells[setting].dropna().unique()
    if len(values) == 1:
        return f"on {where} only {setting}={values[0]:g} was run"
    if not len(table):
        return f"on {where} no method finished at two values of {setting}"
    span = f"from {table['least'].iloc[0]:g} to {table['most'].iloc[0]:g} {setting}"
    table = table.assign(before=table["before"].where(table["before"] > FLOOR, 0.0),
                         after=table["after"].where(table["after"] > FLOOR, 0.0))
    if not (table[["before", "after"]] > 0).any(axis=None):
        return f"on {where} every residual is below {si(FLOOR)}, which is rounding, {span}"
    falls = table[table["after"] < table["before"]]
    if not len(falls):
        return f"on {where} no residual falls {span}"
    small, idle = (int(which.sum()) for which in ((table["before"] == 0) & (table["after"] == 0),
                                                  (table["before"] > 0) & (table["after"] >= table["before"])))
    tail = f"; that of {idle} of {len(table)} methods does not fall" if idle else ""
    tail += f"; that of {small} of {len(table)} methods is below {si(FLOOR)} from the first" if small else ""
    everyone, solved = sorted(cells["method"].unique()), falls[falls["after"] == 0]
    if len(solved):  # all of them: beyond that the one that falls most would be the one that starts worst
        starts = list(dict.fromkeys(si(v) for v in sorted(solved["before"])))
        return (f"on {where} the residual of {methods(sorted(solved['method']), everyone)} falls {span} below {si(FLOOR)}, from "
                f"{starts[0] if len(starts) == 1 else f'{starts[0]} to {starts[-1]}'}{tail}")
    best = falls.loc[(falls["before"] / falls["after"]).idxmax()]
    equals = sorted(falls[(falls["before"] == best["before"]) & (falls["after"] == best["after"])]["method"])
    most = f" most of {len(table)} methods" if len(table) > len(equals) else ""
    return (f"on {where} the residual of {methods(equals, everyone)} falls{most} {span}, from {si(best['before'])} to "
            f"{si(best['after'])}{tail}")


def _chart(context, cells, shown, left_out, setting):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, width = over_steps.grid(context, cells, 2, len(shown))
    looks, said = context.looks(cells), []
    for column, (where, part) in enumerate(shown):
        above, below = axes[0][column], axes[1][column]
        good = part[(part["outcome"] == "ok") & np.isfinite(part[RESIDUAL].astype(float))]
        up = ZeroLog(above, "y", list(good[RESIDUAL]), failures=False, floor=FLOOR)
        plain_log(above, "x", [float(v) for v in part[setting].dropna()] or [1.0])
        for method, mine in good.groupby("method", sort=True):
            mine = mine.sort_values(setting)
            above.plot(mine[setting].astype(float), [up.place(v) for v in mine[RESIDUAL]], **looks(method))
        above.set_xlabel(setting)
        above.set_title(f"{where}, {dimension}D")
        middle = over_steps.at_middle(part, setting)
        tracks = {key: context.store.series(key, SERIES) for key in middle["key"] if key is not None}
        values = [v for track in tracks.values() if track is not None for v in over_steps.stretches(track)[1] if math.isfinite(v)]
        scale = ZeroLog(below, "y", values, failures=False, floor=FLOOR)
        over_steps.lines(context, below, middle, lambda cell, tracks=tracks: tracks[cell["key"]], scale.place)
        ranked = ranking.eligible(context, part)
        said.append(finding(where, ranked, setting) if len(ranked) else f"on {where} no method has a rank")
    axes[0][0].set_ylabel("residual, median of steps")
    axes[1][0].set_ylabel("residual")
    over_steps.legend(context, figure, cells, width)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    table = pd.DataFrame({"scene": drawn["where"], "method": drawn["method"], setting: drawn[setting],
                          "outcome": drawn["outcome"], **quantity(context.title(RESIDUAL), "1", metrics.column(drawn, RESIDUAL))})
    return Chart(f"{cells['sweep'].iloc[0]}_residual_{dimension}d", SECTION,
                 f"Residual over {setting} and over steps, {dimension}D",
                 f"In {dimension}D " + "; ".join(said) + "." + ranking.tail_of(context, shown),
                 cells["sweep"].iloc[0], figure, table,
                 left_out + holes(drawn, ["scene", "method", setting]),
                 "The residual is the worst product of a contact's normal impulse and closing speed, one of which should be 0, "
                 f"over m (g dt)² of all bodies. Below: medians of stretches at the middle value of {setting}; a letter marks "
                 "where a run failed. Engines that tell no contacts have none. Falls are compared over one span: the widest "
                 "whose two ends the most methods finished at.")
