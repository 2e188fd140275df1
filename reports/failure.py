# SPDX-License-Identifier: Zlib
"""What a failure is: the one definition, for the ledger of verifications and for trials of pairs alike.

A refusal is no answer. It counts, and charts tell it apart: a method that says that it cannot is safer than one that errs.
"""

import math

import numpy as np

import metrics

from load import TOLERANCE
from sentences import listing

DEFINITION = ("A method fails on a question that it declares when it gives no answer (refused, not finite, thrown, crashed, "
              "hung) or one that the referee proves wrong: on the wrong side, or off by more than 1e-12 of the size of the "
              "query (1e-5 of what computes in single precision, whatever it is asked in). Of shapes that are apart the side "
              "alone counts where a method claims no distance. What fails is on no Pareto front. A trial "
              "with a looser tolerance is judged by that in reports.")
UNANSWERED = ("refused", "not_finite", "threw", "crashed", "hung")  # columns of the ledger
OF_PAIRS = ("failed", "refused", "wrong")  # metrics of trials of pairs; `failed` is all of UNANSWERED but refusals


def in_ledger(rows):
    """How many questions of these rows of a ledger (or of one row) failed."""
    return sum(int(np.sum(rows[name])) for name in ("wrong", *UNANSWERED))


def in_pairs(cells):
    """Failures of each cell of a sweep of pairs; NaN where the trial does not say. Whoever was asked nothing has none."""
    return sum(metrics.column(cells, name) for name in OF_PAIRS)


def front(cost, error, failures):
    """Indices of the Pareto front (metrics.pareto) among those that have not failed; what is not known has not passed."""
    return metrics.pareto(cost, [e if f == 0 else math.nan for e, f in zip(error, failures)])


def tolerance(precision, coarser=()):
    """In the words of a finding. `coarser`: methods that were asked in it, compute in f32 and are judged by that."""
    said = f"1e{round(math.log10(TOLERANCE[precision]))} of the size"
    return said + (f" ({listing(coarser)}, in single precision, at {tolerance('f32')})" if coarser else "")


def share(part):
    """A share of questions, short enough for a cell."""
    if math.isnan(part):
        return "unknown"
    if part in (0, 1):
        return "0" if part == 0 else "100%"
    return "<0.01%" if part < 1e-4 else ">99%" if part > 0.99 else f"{100 * part:.2g}%"
