# SPDX-License-Identifier: Zlib
"""Runs with one thing changed: a model with features that the scene does not need, and single precision."""

import math

import numpy as np

import noise
import twins
from chart import Headline, Needs, describe, of_sweeps
from load import one_machine, split, varying
from sentences import listing, plural

NOT_NEEDED = "What does a feature cost that a scene does not need?"
COST = "ms_per_step_median"


@of_sweeps("unneeded", 50, NOT_NEEDED,
           Needs("world", varies=("model",), metrics=(COST, "lean")),
           "Unneeded features", "No sweep of models is in this store.", "unneeded")
def unneeded(context, cells):
    cells, refused = one_machine(context.store, cells)
    # A model may be another dimension, so the dimension is no axis of its own here.
    same = varying(context.store, cells, ("model", "dimension"))
    models = list(cells["model"])
    base_name = context.baseline(cells) if context.baseline(cells) in models else models[0]
    rows = []
    for part in split(cells, ["method", *same]):
        base = part[part["model"] == base_name]
        for _, row in part[part["model"] != base_name].iterrows():
            rows.append((describe(row, same) or str(row["scene"]), str(row["model"]), base.iloc[0] if len(base) else None, row))
    least, said = noise.floor_of(context, cells["sweep"].iloc[0], COST), []
    for place, part in twins.grouped(rows):
        words = [(model, twins.told(base, row, COST, least)) for model, base, row in part]
        ratios = sorted(((float(text), model) for model, text in words if text[:1].isdigit()), reverse=True)
        parts = [listing([f"{model} {ratio:.2f}" for ratio, model in ratios])] if ratios else []
        for word, meaning in ((noise.SAME_WORK, "identical work with"), *noise.IN_WORDS.items()):
            alike = [model for model, text in words if text == word]
            parts += [f"{meaning} {listing(alike)}"] if alike else []
        if parts:
            said.append(f"on {place} {', '.join(parts)}")
    text = (f"Times the time of {base_name}: " + "; ".join(said) + "." if said else
            f"No timed pair of {base_name} and one more feature finished.")
    return [twins.drawn(context, f"{cells['sweep'].iloc[0]}_model", NOT_NEEDED, "One unneeded feature at a time", text, cells,
                        rows, base_name, "with it", refused, "Each row is one scene with one feature that it does not need; "
                        f"the ratio is to the blue dot, the same scene with the {base_name} model.",
                        headline_of_unneeded(rows, base_name, least))]


def headline_of_unneeded(rows, base_name, least):
    """The feature that makes its scene dearest."""
    told = [(float(text), place, model, base, row) for place, model, base, row in rows
            if (text := twins.told(base, row, COST, least))[:1].isdigit()]
    if not told or max(told, key=lambda pair: pair[0])[0] <= 1:
        return None
    ratio, place, model, base, row = max(told, key=lambda pair: pair[0])
    return Headline(f"{place} does not need {model}, which makes its step {ratio:.2f} times as dear.",
                    {base_name: base[COST] / 1e3, model: row[COST] / 1e3}, "s", "time per step")


SINGLE_PRECISION = "What does single precision change?"
SAME_ERROR = 1.005  # a ratio of errors that reads as 1


@of_sweeps("precision", 60, SINGLE_PRECISION,
           Needs("world", varies=("precision",), metrics=(COST, "lean")),
           "f32 against f64", "No sweep over precisions is in this store.", "precision")
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
    words = [twins.told(base, row, COST, least) for _, _, base, row in rows if base is not None and row is not None]
    ratios = [twins.ratio_of(base, row, COST) for _, _, base, row in rows if base is not None and row is not None]
    # Of all pairs: those beyond the noise alone would be a selection.
    ratios = [ratio for ratio in ratios if math.isfinite(ratio)]
    told, silent = [float(word) for word in words if word[:1].isdigit()], sum(word in noise.IN_WORDS for word in words)
    worse = [(place, name, twins.ratio_of(base, row, error)) for place, name, base, row in rows
             if base is not None and row is not None]
    worse = [w for w in worse if math.isfinite(w[2])]
    said = []
    if told:
        said.append(f"f32 takes {np.median(ratios):.2f} times the time of f64 (median of {plural(len(ratios), 'pair')}, "
                    f"{min(ratios):.2f} to {max(ratios):.2f}); {len(told)} of them differ beyond the noise")
    elif silent and noise.FEW not in words:
        said.append(f"f32 and f64 take the same time within the noise (all {silent} pairs)")
    elif silent:
        said.append(f"too few repeats to tell f32 and f64 apart in time ({plural(silent, 'pair')})")
    worse = [w for w in worse if max(w[2], 1 / max(w[2], 1e-300)) > SAME_ERROR]
    if worse:
        most = max(worse, key=lambda w: max(w[2], 1 / max(w[2], 1e-300)))
        said.append(f"its {context.title(error)} differs most on {most[0]} with {most[1]} ({most[2]:.3g} times)")
    differ = [f"{place} with {name} ({base['outcome']} in f64, {row['outcome']} in f32)" for place, name, base, row in rows
              if base is not None and row is not None and base["outcome"] != row["outcome"]]
    said.append(f"the outcome differs on {listing(differ)}" if differ else "no outcome differs")
    return [twins.drawn(context, f"{cells['sweep'].iloc[0]}_precision", SINGLE_PRECISION, "f32 against f64",
                        _capital("; ".join(said)) + ".", cells, rows, "f64", "f32", refused,
                        "Each row is one run in both precisions.", headline_of_precision(ratios, told))]


def headline_of_precision(ratios, told):
    """The median of all pairs, where most of them tell a difference and on one side."""
    if 2 * len(told) <= len(ratios) or min(told) < 1 < max(told):
        return None
    middle = float(np.median(ratios))
    return Headline(f"A step in f32 takes {middle:.2f} times the time of one in f64 (median of {plural(len(ratios), 'pair')}, "
                    f"of which {len(told)} differ beyond the noise).",
                    {"f64": 1.0, "f32": middle}, "1", "time per step, that of f64 is 1")


def _capital(text):
    return text if text.startswith("f32") else text[:1].upper() + text[1:]
