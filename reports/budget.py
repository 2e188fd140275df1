# SPDX-License-Identifier: Zlib
"""Budgets of a cost, and the least error that each method reaches within one."""

import numpy as np

import metrics
import noise

BUDGETS = 4  # that are named, evenly on a log axis from where two methods have finished to the dearest


def within(cells, cost, error, budget, least=1.0):
    """{method: its cell with the least error at that budget}; whoever has none at that cost is not in it. A time above the budget
    by no more than the noise, `least`, or whose interval holds it, is within it: a cut through noise would be a rank by noise."""
    above = np.array([noise.above(cell, cost, budget, least) for _, cell in cells.iterrows()])
    good = cells[(cells["outcome"] == "ok").to_numpy() & ~above & np.isfinite(metrics.column(cells, cost)) &
                 np.isfinite(metrics.column(cells, error))]
    return {method: part.loc[part[error].idxmin()] for method, part in good.groupby("method", sort=True)}


def marks(cells, cost, error):
    """The budgets that are named."""
    good = cells[(cells["outcome"] == "ok").to_numpy() & np.isfinite(metrics.column(cells, cost)) &
                 np.isfinite(metrics.column(cells, error))]
    firsts = sorted(good.groupby("method")[cost].min())
    if len(firsts) < 2 or good[cost].max() <= 0:
        return []
    lowest = next(v for v in sorted(good[cost]) if v >= firsts[1] and v > 0)  # what costs nothing is within every budget
    return list(np.geomspace(lowest, good[cost].max(), BUDGETS)) if good[cost].max() > lowest else [lowest]
