# SPDX-License-Identifier: Zlib
"""Every planned trial with its outcome; failed and missing trials with their reason."""

import numpy as np
import pandas as pd

import declared

from chart import describe
from load import NOT_RUN, REPEATS
from style import OUTCOMES

# In the words of docs/reference_sweeps.md.
MEANINGS = {
    "ok": "ran to its end within the limits of its scene, without a wrong answer",
    "unsupported": "a method, an engine or a scene cannot do what the cell asks, or no setting meets the budget",
    "nondeterministic": "a repeat ended in another state than the first run",
    "wrong": "the referee proves an answer wrong, or a broadphase misses a pair or returns one too many",
    "sank": "at its end a body sags, overlaps another or sinks by more than a hundredth of the scene's smallest body",
    "frozen": "all bodies rest, also one that must fall: numbers are too coarse, or nothing moves",
    "left": "a body is below everything that could hold it: over an edge, or through the floor",
    "collapsed": "a body moved farther from its start than the scene's limit of drift, not by sagging alone, or still creeps "
                 "at the end",
    "exploded": "a body was faster than the scene's limit of speed, or than light",
    "diverged": "a number of the state is not finite, or the energy exceeds the scene's limit of energy",
    "timeout": "it took longer than the sweep's wall_limit",
    "out_of_memory": "it needed more memory than a trial may have",
    "crash": "its process ended by a signal or an exception",
    NOT_RUN: "planned, without a result in the store",
}


def trials(store):
    """One row per planned trial (timed repeats apart), with its outcome or "not run"."""
    rows = []
    for entry in store.planned.itertuples():
        trial = store.by_key.get(entry.key)
        axes = {k: v for k, v in entry.axes.items() if k not in REPEATS}
        named = {**axes, "method": store.method_of(entry.sweep, axes)}
        rows.append({"sweep": entry.sweep, "cell": describe(named, _order(axes)),
                     "timed": bool(entry.axes.get("timed", False)), "outcome": trial.outcome if trial else NOT_RUN,
                     "step": trial.step if trial else np.nan,
                     "reason": (trial.reason or "") if trial else "planned, no result in the store",
                     declared.COLUMN: declared.methods(store, entry.key) if trial and trial.outcome != "ok" else ""})
    return pd.DataFrame(rows, columns=["sweep", "cell", "timed", "outcome", "step", "reason", declared.COLUMN])


def _order(axes):
    first = [n for n in ("scene", "dimension") if n in axes]
    return first + [n for n in axes if n not in first and n != "kind"]


def outcomes(table):
    """One row per possible outcome: its letter, its meaning, the number of trials of this store."""
    return pd.DataFrame([(name, OUTCOMES[name][1], meaning, int((table["outcome"] == name).sum()))
                         for name, meaning in MEANINGS.items()], columns=["outcome", "letter", "what it means", "trials"])


def not_ok(table):
    """All failed and missing trials; timed and untimed trials of a cell with the same outcome share a row."""
    bad = table[table["outcome"] != "ok"]
    grouped = bad.groupby(["sweep", "cell", "outcome", "reason", declared.COLUMN], sort=False, dropna=False)
    return grouped.agg(step=("step", "max"), trials=("timed", "size")).reset_index()[
        ["sweep", "cell", "outcome", "step", "reason", "trials", declared.COLUMN]]
