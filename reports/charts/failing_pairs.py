# SPDX-License-Identifier: Zlib
"""The simplest and the worst pair of shapes on which each method fails, drawn side by side."""

import json
import math

import pandas as pd

from chart import Chart, listing, of_store, plural
from silhouette import outline
from style import grid_of_axes, si
from table import quantity

SECTION = "Which method is right, and which fails where?"
COLUMNS = 7  # at most
SHADES = ("#0072B2", "#D55E00")  # A, B
WRONG = {"wrong_distance": "wrong distance", "wrong_normal": "wrong normal", "wrong_side": "wrong side"}  # in the ledger's order


@of_store("failing_pairs", 85, SECTION,
          "The simplest and the worst failing pairs", "No failing pair is in this store.",
          made_by="verify --stage pair_query --pairs 200")
def failing_pairs(context):
    pairs = {}
    for case, vertices, size in context.store.found_cases():
        _keep(pairs, case, "simplest", (vertices, size))
    ledger = context.store.ledger()
    for row in ledger[(ledger["axis"] == "all") & (ledger["wrong"] > 0) & (ledger["worst"] != "")].itertuples():
        _keep(pairs, _read(row.worst), "worst", -row.max_error if math.isfinite(row.max_error) else 0.0)
    places = sorted({at[:2] for at, kept in pairs.items() if set(kept) == {"simplest", "worst"}})
    return [_chart(context, {method: kept for (*at, method), kept in sorted(pairs.items()) if tuple(at) == place and
                             len(kept) == 2}, *place) for place in places]


def _read(text):
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return {}


def _keep(pairs, case, what, order):
    """The first in this order of each method; of pair queries alone, whose shapes can be drawn."""
    found = case.get("found", {})
    if found.get("stage") != "pair_query" or "shapeA" not in case:
        return
    kept = pairs.setdefault((case["dim"], found["precision"], found["method"]), {})
    if what not in kept or order < kept[what][0]:
        kept[what] = (order, case)


def kinds(case):
    """As the ledger calls them: `polytope-ellipsoid` of the pair's name."""
    return "–".join({"convex": "polytope"}.get(case[s]["type"], case[s]["type"]) for s in ("shapeA", "shapeB"))


def told(case):
    """What is wrong, what the method said for what is true, and how far off that is, in short lines."""
    found, truth = case["found"], case["expected"]["signed_distance"]
    lines = [kinds(case), case.get("note", "").replace("_", " "), WRONG.get(found["failure"], f"no answer: {found['failure']}"
                                                                           .replace("_", " "))]
    if found.get("error") is None:  # the side alone, or nothing
        return [*lines, f"true: {si(truth, 'm')}"]
    if found["failure"] == "wrong_normal":  # of a distance that is right
        return [*lines, f"off by {found['error']:.1e} along it"]
    said, true = si(found["value"], "m"), si(truth, "m")
    return [*lines, f"{said} for {true}" if said != true else f"at {true}", f"off by {found['error']:.1e}"]


def finding(pairs, dimension, precision):
    worst = {method: kept["worst"][1] for method, kept in pairs.items()}
    ends = [case["found"]["failure"] for case in worst.values()]
    counts = [f"{ends.count(end)} in {words.removeprefix('wrong ')}" for end, words in WRONG.items() if end in ends]
    method = max(worst, key=lambda m: worst[m]["found"].get("error") or 0)
    case = worst[method]
    along = "along its normal alone" if case["found"]["failure"] == "wrong_normal" else "in distance or along its normal"
    return (f"In {dimension}D, {precision}, the worst answers of {plural(len(pairs), 'method')} are wrong, {listing(counts)}; "
            f"the worst of all is {method}'s on {kinds(case)} ({case.get('note', '').replace('_', ' ')}), a "
            f"{WRONG[case['found']['failure']]}, off by {case['found'].get('error') or 0:.2g} of the size {along}.")


def _chart(context, pairs, dimension, precision):
    columns = math.ceil(len(pairs) / math.ceil(len(pairs) / COLUMNS))
    rows = 2 * math.ceil(len(pairs) / columns)
    figure, axes = grid_of_axes(rows, columns, 1.25, left=0.65, gap_x=0.15, gap_y=1.05, top=0.4, bottom=0.85)
    lines = []
    for ax in axes.flat:
        ax.set_visible(False)
    for index, (method, kept) in enumerate(pairs.items()):
        for below, what in enumerate(("simplest", "worst")):
            ax, case = axes[2 * (index // columns) + below][index % columns], kept[what][1]
            _draw(ax, case, dimension)
            if below == 0:
                ax.set_title(context.name(method).replace("{", "\n{").replace(" (witness)", ""), fontsize=8)
            if index % columns == 0:
                ax.set_ylabel(what)
            found = case["found"]
            lines.append({"method": method, "which": what, "shapes": kinds(case), "family": case.get("note", ""),
                          "failure": found["failure"], "answer": found["value"], "truth": case["expected"]["signed_distance"],
                          "error": found.get("error"), "case": case["id"], "input": json.dumps(case)})
    numbers = pd.DataFrame(lines)
    numbers = pd.DataFrame({**{c: numbers[c] for c in ("method", "which", "shapes", "family", "failure")},
                            **quantity("answer", "m", numbers["answer"]), **quantity("truth", "m", numbers["truth"]),
                            **quantity("error / size", "1", numbers["error"]), "case": numbers["case"],
                            "input": numbers["input"]})
    return Chart(f"failing_pairs_{dimension}d_{precision}", SECTION,
                 f"The simplest and the worst failing pair of each method, {dimension}D, {precision}",
                 finding(pairs, dimension, precision), "", figure, numbers, [],
                 "Above the pair with the fewest vertices on which the method fails, below the one with the largest error; "
                 "beneath, the family, and what is wrong. A wrong distance is told for the true one, with the error over the "
                 "size, of the distance or, where that is more, along the normal; a wrong normal belongs to a right distance, "
                 "and the error is what the separation along it lacks; a wrong side is apart for overlapping, or the reverse. "
                 "A is blue, B orange; in 3D their shadows from one side, in which shapes that are apart may overlap. The "
                 "inputs are in the numbers, and in NAME.found/ beside the store NAME as files for lpc verify --cases.",
                 made_by=f"verify --stage pair_query --dimension {dimension} --precision {precision} --pairs 200")


def _draw(ax, case, dimension):
    ax.set_visible(True)
    for side, colour in zip("AB", SHADES):
        points = outline(case[f"shape{side}"], case[f"pose{side}"], dimension)
        ax.fill(points[:, 0], points[:, 1], facecolor=colour, alpha=0.25, lw=0)
        ax.plot(points[:, 0], points[:, 1], color=colour, lw=1.2)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xticks([])
    ax.set_yticks([])
    ax.grid(False)
    ax.set_xlabel("\n".join(told(case)), fontsize=7)
    for spine in ax.spines.values():
        spine.set_visible(False)
