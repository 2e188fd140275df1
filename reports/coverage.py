# SPDX-License-Identifier: Zlib
"""Every planned trial with what came of it; what is not ok is listed with its reason."""

import numpy as np
import pandas as pd

from chart import describe
from load import NOT_RUN, REPEATS


def trials(store):
    """One row per planned trial (timed repeats apart), with its outcome or "not run"."""
    rows = []
    for entry in store.planned.itertuples():
        known = entry.key in store.trials.index
        trial = store.trials.loc[entry.key] if known else None
        axes = {k: v for k, v in entry.axes.items() if k not in REPEATS}
        named = {**axes, "method": store.method_of(entry.sweep, axes)}
        rows.append({"sweep": entry.sweep, "cell": describe(named, _order(axes)),
                     "timed": bool(entry.axes.get("timed", False)), "outcome": trial["outcome"] if known else NOT_RUN,
                     "step": trial["step"] if known else np.nan,
                     "reason": (trial["reason"] or "") if known else "planned, no result in the store"})
    return pd.DataFrame(rows, columns=["sweep", "cell", "timed", "outcome", "step", "reason"])


def _order(axes):
    first = [n for n in ("scene", "dimension") if n in axes]
    return first + [n for n in axes if n not in first and n != "kind"]


def not_ok(table):
    """All trials that are not ok; the timed and untimed trial of a cell that ended alike share a line."""
    bad = table[table["outcome"] != "ok"]
    grouped = bad.groupby(["sweep", "cell", "outcome", "reason"], sort=False, dropna=False)
    return grouped.agg(step=("step", "max"), trials=("timed", "size")).reset_index()[
        ["sweep", "cell", "outcome", "step", "reason", "trials"]]
