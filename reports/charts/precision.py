# SPDX-License-Identifier: Zlib
"""The same run in single and in double precision."""

import math

import numpy as np

import noise
import twins
from chart import Chart, Needs, describe, listing, plural
from load import one_machine, split, varying

PLACE = 60
SECTION = "What does single precision change?"
COST = "ms_per_step_median"
NEEDS = Needs("world", varies=("precision",), metrics=(COST, "lean"))
ABSENT = Chart("precision", SECTION, "f32 against f64", "No sweep over precisions is in this store.", "precision")


def of_sweep(context, cells):
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
    least = noise.floor(cells, COST)
    words = [twins.told(base, row, COST, least) for _, _, base, row in rows if base is not None and row is not None]
    ratios, silent = [float(word) for word in words if word[:1].isdigit()], words.count("noise")
    worse = [(place, name, twins.ratio_of(base, row, error)) for place, name, base, row in rows
             if base is not None and row is not None]
    worse = [w for w in worse if math.isfinite(w[2])]
    said = []
    if ratios:
        said.append(f"f32 takes {np.median(ratios):.2f} times the time of f64 (median of {len(ratios)} pairs, "
                    f"{min(ratios):.2f} to {max(ratios):.2f})" + (f"; {plural(silent, 'pair')} within the noise" if silent else ""))
    elif silent:
        said.append(f"f32 and f64 take the same time within the noise (all {silent} pairs)")
    if worse:
        most = max(worse, key=lambda w: w[2])
        said.append(f"its {context.title(error)} differs most on {most[0]} with {most[1]} ({most[2]:.3g} times)")
    differ = [f"{place} with {name} ({base['outcome']} in f64, {row['outcome']} in f32)" for place, name, base, row in rows
              if base is not None and row is not None and base["outcome"] != row["outcome"]]
    said.append(f"the outcome differs on {listing(differ)}" if differ else "no outcome differs")
    return [twins.drawn(context, f"{cells['sweep'].iloc[0]}_precision", SECTION, "f32 against f64",
                        _capital("; ".join(said)) + ".", cells, rows, "f64", "f32", refused,
                        "Each row is one run in both precisions.")]


def _capital(text):
    return text if text.startswith("f32") else text[:1].upper() + text[1:]
