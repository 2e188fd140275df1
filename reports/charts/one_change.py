# SPDX-License-Identifier: Zlib
"""Runs with one change: a model with a feature that the scene does not need, and single precision."""

import math

import numpy as np
import pandas as pd

import noise
import twins
from chart import Headline, Needs, describe, of_sweeps
from finding import NOISE, Finding, cut
from load import one_machine, split, varying
from sentences import plural, verb

NOT_NEEDED = "What does an unneeded feature cost?"
COST = "ms_per_step_median"


@of_sweeps("unneeded", 50, NOT_NEEDED,
           Needs("world", varies=("model",), metrics=(COST, "lean")),
           "Unneeded features", "This store has no sweep of models.", "unneeded")
def unneeded(context, cells):
    cells, refused = one_machine(context.store, cells)
    # A model may change the dimension, so the dimension is not an axis here.
    same = varying(context.store, cells, ("model", "dimension"))
    models = list(cells["model"])
    base_name = context.baseline(cells) if context.baseline(cells) in models else models[0]
    rows = []
    for part in split(cells, ["method", *same]):
        base = part[part["model"] == base_name]
        for _, row in part[part["model"] != base_name].iterrows():
            rows.append((describe(row, same) or str(row["scene"]), str(row["model"]), base.iloc[0] if len(base) else None, row))
    least = noise.floor_of(context, cells["sweep"].iloc[0], COST)
    return [twins.drawn(context, f"{cells['sweep'].iloc[0]}_model", NOT_NEEDED, "One unneeded feature at a time",
                        finding_of_unneeded(rows, base_name, least), cells, rows, base_name, "with feature", refused,
                        f"A row is one scene with one feature that it does not need; blue: the scene with the {base_name} model.",
                        headline_of_unneeded(rows, base_name, least))]


def told_of(base, row, least):
    """(ratio of times or NaN, why there is none) of a run and the run with one change."""
    text = twins.told(base, row, COST, least)
    if text[:1].isdigit():
        return float(text), ""
    failed = [f"{name}: {'not run' if run is None else run['outcome']}" for name, run in (("without", base), ("with", row))
              if run is None or run["outcome"] != "ok"]
    return math.nan, ", ".join(failed) or {noise.NOISE: NOISE, "": "no time"}.get(text, text)


def finding_of_unneeded(rows, base_name, least):
    """The feature that costs most; all from the most to the least expensive."""
    found = []
    for place, model, base, row in rows:
        ratio, why = told_of(base, row, least)
        found.append({"scene": place, "feature": model, f"time over that of {base_name} [1]": ratio, "remark": why})
    table = pd.DataFrame(found, columns=["scene", "feature", f"time over that of {base_name} [1]", "remark"])
    table = table.sort_values(f"time over that of {base_name} [1]", ascending=False, kind="stable")
    head = headline_of_unneeded(rows, base_name, least)
    few = any(why == noise.FEW for why in table["remark"])
    return Finding(head.text if head else f"No timed pair of {base_name} and one more feature finished." if not len(table) or
                   all(":" in why or why == "no time" for why in table["remark"]) else
                   "There are too few repeats to measure the cost of an unneeded feature." if few else
                   "No unneeded feature takes more time beyond the noise.", cut(table))


def headline_of_unneeded(rows, base_name, least):
    """For the first screen: the feature that costs most."""
    told = [(told_of(base, row, least)[0], place, model, base, row) for place, model, base, row in rows]
    told = [found for found in told if found[0] > 1]
    if not told:
        return None
    ratio, place, model, base, row = max(told, key=lambda found: found[0])
    return Headline(f"{place} does not need {model}, which takes {ratio:.2f} times the time of {base_name}.",
                    {base_name: base[COST] / 1e3, model: row[COST] / 1e3}, "s", "time per step")


SINGLE_PRECISION = "What does single precision change?"
SAME_ERROR = 1.005  # a ratio of errors that reads as 1


@of_sweeps("precision", 60, SINGLE_PRECISION,
           Needs("world", varies=("precision",), metrics=(COST, "lean")),
           "f32 against f64", "This store has no sweep over precisions.", "precision")
def precision(context, cells):
    cells, refused = one_machine(context.store, cells)
    same, error = varying(context.store, cells, ("precision",)), twins.errors(context)[0]
    place_axes = [c for c in ("scene", "dimension") if c in same]
    rows = []
    for part in split(cells, ["method", *same]):
        f64, f32 = part[part["precision"] == "f64"], part[part["precision"] == "f32"]
        row = f32.iloc[0] if len(f32) else None
        first = part.iloc[0]
        rows.append((describe(first, place_axes) or "scene",
                     describe(first, ["method", *(c for c in same if c not in place_axes)]),
                     f64.iloc[0] if len(f64) else None, row))
    least = noise.floor_of(context, cells["sweep"].iloc[0], COST)
    text, headline = finding_of_precision(context, rows, error, least)
    return [twins.drawn(context, f"{cells['sweep'].iloc[0]}_precision", SINGLE_PRECISION, "f32 against f64", text, cells, rows,
                        "f64", "f32", refused, "A row is one run in both precisions.", headline)]


def finding_of_precision(context, rows, error, least):
    """(finding, headline of the first screen): the median ratio of times over all pairs; the ratio of errors and the outcomes."""
    both = [(place, name, base, row) for place, name, base, row in rows if base is not None and row is not None]
    # The median is that of all pairs: those beyond the noise would be a selection.
    ratios = [ratio for *_, base, row in both if math.isfinite(ratio := twins.ratio_of(base, row, COST))]
    told = [told_of(base, row, least) for *_, base, row in both]
    beyond = [ratio for ratio, _ in told if math.isfinite(ratio)]
    found = pd.DataFrame([{
        "scene": place, "run": name, "time over that of f64 [1]": ratio,
        f"{context.title(error)} over that of f64 [1]": twins.ratio_of(base, row, error),
        "remark": why if base["outcome"] == row["outcome"] else f"{base['outcome']} in f64, {row['outcome']} in f32"}
        for (place, name, base, row), (ratio, why) in zip(both, told)])
    few = any(why == noise.FEW for _, why in told)
    changed = sum(base["outcome"] != row["outcome"] for *_, base, row in both)
    ends = f"; {changed} of {plural(len(both), 'outcome')} {verb(changed, 'differ')}" if changed else "; no outcome differs"
    pairs = plural(len(ratios), "pair")
    if beyond:
        text = (f"A step in f32 takes {np.median(ratios):.2f} times the time of one in f64 (median of {pairs}, {len(beyond)} "
                "beyond the noise)")
    elif ratios and not few:
        text = f"Steps in f32 and f64 take the same time within the noise ({pairs})"
    else:
        text = "There are too few repeats to compare the times of f32 and f64" if ratios else "No timed pair finished"
    if len(found):
        found = found.sort_values("time over that of f64 [1]", kind="stable")
        worst = found[found.columns[3]].map(lambda v: abs(math.log(v)) if v > 0 else -1).to_numpy()
        keep = [i for i, why in enumerate(found["remark"]) if " in f32" in why]
        found = cut(found, [*keep, *([int(worst.argmax())] if worst.max() > math.log(SAME_ERROR) else [])])
    return Finding(f"{text}{ends}.", found), headline_of_precision(ratios, beyond, f"{text}{ends}.")


def headline_of_precision(ratios, beyond, text):
    """For the first screen: if most pairs differ beyond the noise, all in the same direction."""
    if 2 * len(beyond) <= len(ratios) or min(beyond) < 1 < max(beyond):
        return None
    return Headline(text, {"f64": 1.0, "f32": float(np.median(ratios))}, "1", "time per step, that of f64 is 1")
