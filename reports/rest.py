# SPDX-License-Identifier: Zlib
"""What is held: how far a run has sunk by its end, as a share of the scene's smallest body, and by which limits that is holding.
experiments/trial/measure/rest.h has the same limits; an outcome is by the strictest, so that what is ok is held by each."""

import math

LIMITS = (0.01, 0.1, 0.5)  # of the smallest body
WORDS = ("Held is what has sunk by no more than 1 % of the smallest body at the end (sag, overlap, way in the last second, "
         "beyond the slop of 5 mm that methods keep), and so by no more than 10 and 50 %")


def sunk(outcome, share):
    """The share of a run; 0 where its scene does not ask, infinite where it fell in another way."""
    if outcome not in ("ok", "sank"):
        return math.inf
    return 0.0 if share is None or math.isnan(share) else float(share)


def percent(limit):
    return f"{100 * limit:g} %"
