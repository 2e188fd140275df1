# SPDX-License-Identifier: Zlib
"""The same scene with one feature more that it does not need: what the feature costs."""

import noise
import twins
from chart import Headline, Needs, describe, listing, of_sweeps
from load import one_machine, split, varying

SECTION = "What does a feature cost that a scene does not need?"
COST = "ms_per_step_median"


@of_sweeps("unneeded", 50, SECTION,
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
    return [twins.drawn(context, f"{cells['sweep'].iloc[0]}_model", SECTION, "One unneeded feature at a time", text, cells,
                        rows, base_name, "with it", refused, "Each row is one scene with one feature that it does not need; "
                        f"the ratio is to the blue dot, the same scene with the {base_name} model.",
                        headline(rows, base_name, least))]


def headline(rows, base_name, least):
    """The feature that makes its scene dearest."""
    told = [(float(text), place, model, base, row) for place, model, base, row in rows
            if (text := twins.told(base, row, COST, least))[:1].isdigit()]
    if not told or max(told, key=lambda pair: pair[0])[0] <= 1:
        return None
    ratio, place, model, base, row = max(told, key=lambda pair: pair[0])
    return Headline(f"{place} does not need {model}, which makes its step {ratio:.2f} times as dear.",
                    {base_name: base[COST] / 1e3, model: row[COST] / 1e3}, "s", "time per step")
