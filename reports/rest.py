# SPDX-License-Identifier: Zlib
"""Limits of holding a scene: how far a run may have sunk by its end, as a share of the scene's smallest body. The limits are
those of experiments/trial/measure/rest.h. The outcome uses the strictest, so a run that is ok satisfies all of them."""

import math

LIMITS = (0.01, 0.1, 0.5)  # of the smallest body
WORDS = ("A scene is held if no body has sunk by more than 1 % of the smallest body at the end. Sinking is the largest of sag, "
         "penetration and motion in the last second, beyond the slop of 5 mm. Laxer limits: 10 and 50 %")


def sunk(outcome, share):
    """The share by which a run sank; 0 if its scene does not measure it, infinite if the run failed in another way."""
    if outcome not in ("ok", "sank"):
        return math.inf
    return 0.0 if share is None or math.isnan(share) else float(share)


def percent(limit):
    return f"{100 * limit:g} %"
