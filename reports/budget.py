# SPDX-License-Identifier: Zlib
"""Budgets of a cost, and the least error of each method within a budget."""

import numpy as np

import metrics
import noise

BUDGETS = 4  # evenly on a log axis, from the cost at which two methods have finished to the largest cost


def within(cells, cost, error, budget, least=1.0):
    """{method: its cell with the least error within the budget}, without methods that cost more. A time above the budget by no
    more than the noise floor `least`, or with the budget in its interval, is within it; else noise would decide a rank."""
    above = np.array([noise.above(cell, cost, budget, least) for _, cell in cells.iterrows()])
    good = cells[(cells["outcome"] == "ok").to_numpy() & ~above & np.isfinite(metrics.column(cells, cost)) &
                 np.isfinite(metrics.column(cells, error))]
    return {method: part.loc[part[error].idxmin()] for method, part in good.groupby("method", sort=True)}


def marks(cells, cost, error):
    """The budgets of a chart."""
    good = cells[(cells["outcome"] == "ok").to_numpy() & np.isfinite(metrics.column(cells, cost)) &
                 np.isfinite(metrics.column(cells, error))]
    firsts = sorted(good.groupby("method")[cost].min())
    if len(firsts) < 2 or good[cost].max() <= 0:
        return []
    lowest = next(v for v in sorted(good[cost]) if v >= firsts[1] and v > 0)  # a cost of 0 is within every budget
    return list(np.geomspace(lowest, good[cost].max(), BUDGETS)) if good[cost].max() > lowest else [lowest]
