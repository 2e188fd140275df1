# SPDX-License-Identifier: Zlib
"""The definition of a failure, for the ledger of verifications and for trials of pairs.

A refusal counts as a failure, but charts show it apart: a method that refuses is safer than one that answers wrongly.
"""

import math

import numpy as np

import metrics

from load import TOLERANCE
from sentences import listing

DEFINITION = ("A method fails on a question that it declares when it gives no answer (refused, not finite, thrown, crashed, "
              "hung) or a wrong one. An answer is wrong when the referee proves it on the wrong side, or off by more than 1e-12 "
              "of the size of the query (1e-5 for a method that computes in single precision). A method that claims no distance "
              "for separate shapes is judged by the side alone.")
UNANSWERED = ("refused", "not_finite", "threw", "crashed", "hung")  # columns of the ledger
OF_PAIRS = ("failed", "refused", "wrong")  # metrics of trials of pairs; `failed` counts UNANSWERED without refusals


def in_ledger(rows):
    """The number of failed questions in these rows (or this row) of a ledger."""
    return sum(int(np.sum(rows[name])) for name in ("wrong", *UNANSWERED))


def in_pairs(cells):
    """Failures of each cell of a sweep of pairs; NaN where the trial does not count them."""
    return sum(metrics.column(cells, name) for name in OF_PAIRS)


def front(cost, error, failures):
    """Indices of the Pareto front (metrics.pareto) of the entries without failures; an unknown number counts as a failure."""
    return metrics.pareto(cost, [e if f == 0 else math.nan for e, f in zip(error, failures)])


def tolerance(precision, coarser=()):
    """The tolerance in words. `coarser`: methods that compute in f32 and are judged by its tolerance."""
    said = f"1e{round(math.log10(TOLERANCE[precision]))} of the size"
    return said + (f" ({listing(coarser)}, in single precision, at {tolerance('f32')})" if coarser else "")


def share(part):
    """A share of questions as a short text."""
    if math.isnan(part):
        return "unknown"
    if part in (0, 1):
        return "0" if part == 0 else "100%"
    return "<0.01%" if part < 1e-4 else ">99%" if part > 0.99 else f"{100 * part:.2g}%"
