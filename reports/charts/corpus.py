# SPDX-License-Identifier: Zlib
"""The corpus of published hard cases, each method on each case, and the failing pairs of a ledger. `lpc verify --cases FILE
--store STORE` stores the corpus."""

import io
import json
import math

import numpy as np
import pandas as pd
from matplotlib.patches import Rectangle

from chart import Chart, Headline, of_store
from finding import Finding, cut, fits
from load import family
from sentences import listing, plural, some
from silhouette import of_case
from style import NOT_ASKED, REFUSED, RIGHT, WIDTH, grid_of_axes, plt, si
from table import quantity

SECTION = "Which method is right, and which fails where?"
COLUMNS = 7  # most pairs side by side
TINY = 0.02  # extent of a shape over that of the other: smaller ones cannot be seen
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
    return [_pairs_chart(context, {method: kept for (*at, method), kept in sorted(pairs.items()) if tuple(at) == place and
                                   len(kept) == 2}, *place) for place in places]


def _read(text):
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return {}


def _keep(pairs, case, what, order):
    """Keeps the first case of each method in this order. Only pair queries have shapes that can be drawn."""
    found = case.get("found", {})
    if found.get("stage") != "pair_query" or "shapeA" not in case:
        return
    kept = pairs.setdefault((case["dim"], found["precision"], found["method"]), {})
    if what not in kept or order < kept[what][0]:
        kept[what] = (order, case)


def kinds(case):
    """The kinds of a pair as in the ledger: `polytope–ellipsoid`."""
    return "–".join({"convex": "polytope"}.get(case[s]["type"], case[s]["type"]) for s in ("shapeA", "shapeB"))


def told(case):
    """Short lines: what is wrong, the answer and the true value, the error."""
    found, truth = case["found"], case["expected"]["signed_distance"]
    lines = [kinds(case), case.get("note", "").replace("_", " "), WRONG.get(found["failure"], f"no answer: {found['failure']}"
                                                                           .replace("_", " "))]
    if found.get("error") is None:  # the method answered only the side, or nothing
        return [*lines, f"true: {si(truth, 'm')}"]
    if found["failure"] == "wrong_normal":  # the distance is right
        return [*lines, f"off by {found['error']:.1e} along it"]
    said, true = si(found["value"], "m"), si(truth, "m")
    return [*lines, f"{said} for {true}" if said != true else f"at {true}", f"off by {found['error']:.1e}"]


def found_pairs(pairs, dimension, precision):
    """The worst answer of each method, the largest error first."""
    worst = {method: kept["worst"][1] for method, kept in pairs.items()}
    order = sorted(worst, key=lambda m: -(worst[m]["found"].get("error") or 0))
    said = lambda case: (f"{kinds(case)} ({case['note'].replace('_', ' ')})" if case.get("note") else kinds(case))  # noqa: E731
    ends = [worst[m]["found"]["failure"] for m in order]
    table = pd.DataFrame({"method": order, "worst answer on": [said(worst[m]) for m in order],
                          "failure": [WRONG.get(end, end.replace("_", " ")) for end in ends],
                          "error / size [1]": [worst[m]["found"].get("error") for m in order],
                          "error of": ["the normal" if end == "wrong_normal" else "the distance, or along the normal"
                                       for end in ends]})
    case, error = worst[order[0]], worst[order[0]]["found"].get("error") or 0
    of = "along its normal alone" if ends[0] == "wrong_normal" else WRONG.get(ends[0], ends[0].replace("_", " "))
    families = len(set(map(family, order)))
    many = plural(families, "method") + (f" in {len(order)} settings" if families < len(order) else "")
    return Finding(f"In {dimension}D, {precision}, {order[0]} has the largest error of {many}, {error:.2g} of the size, on "
                   f"{said(case)}: {of}.", cut(table))


def _pairs_chart(context, pairs, dimension, precision):
    columns = math.ceil(len(pairs) / math.ceil(len(pairs) / COLUMNS))
    rows = 2 * math.ceil(len(pairs) / columns)
    figure, axes = grid_of_axes(rows, columns, 1.25, left=0.65, gap_x=0.15, gap_y=1.05, top=0.4, bottom=0.85)
    lines, missing = [], []
    for ax in axes.flat:
        ax.set_visible(False)
    for index, (method, kept) in enumerate(pairs.items()):
        for below, what in enumerate(("simplest", "worst")):
            ax, case = axes[2 * (index // columns) + below][index % columns], kept[what][1]
            missing += [f"{method}, {what}: the store, written by an older program, has no outline of {kind}"
                        for kind in _draw(ax, case)]
            if below == 0:
                ax.set_title(context.name(method).replace("{", "\n{").replace(" (witness)", ""), fontsize=8)
            if index % columns == 0:
                ax.set_ylabel(what)
            found = case["found"]
            lines.append({"method": method, "which": what, "shapes": kinds(case), "family": case.get("note", ""),
                          "failure": found["failure"], "answer": found["value"], "truth": case["expected"]["signed_distance"],
                          "error": found.get("error"), "case": case["id"],
                          "input": json.dumps({key: v for key, v in case.items() if not key.startswith("outline")})})
    numbers = pd.DataFrame(lines)
    numbers = pd.DataFrame({**{c: numbers[c] for c in ("method", "which", "shapes", "family", "failure")},
                            **quantity("answer", "m", numbers["answer"]), **quantity("truth", "m", numbers["truth"]),
                            **quantity("error / size", "1", numbers["error"]), "case": numbers["case"],
                            "input": numbers["input"]})
    return Chart(f"failing_pairs_{dimension}d_{precision}", SECTION,
                 f"The simplest and the worst failing pair of each method, {dimension}D, {precision}",
                 found_pairs(pairs, dimension, precision), "", figure, numbers, missing,
                 "Upper rows: the failing pair with the fewest vertices; lower rows: the one with the largest error. Under each "
                 "pair stand its family and the failure. A wrong distance is given with the true one; its error is that of the "
                 "distance or, where larger, along the normal, over the size. A wrong normal has a right distance; its error is "
                 "the missing separation along it. Wrong side: the method says apart where the shapes overlap, or the reverse. "
                 "“At” gives a distance that reads as the true one. A is blue, B orange; a ring is at a shape of less than "
                 f"{100 * TINY:g} % of the other's extent. In 3D shapes are shadows from one side, which may "
                 "overlap. The numbers hold the inputs, as do the files in NAME.found/ beside the store NAME, for "
                 "lpc verify --cases.",
                 made_by=f"verify --stage pair_query --dimension {dimension} --precision {precision} --pairs 200")


def _draw(ax, case):
    """Draws both shapes, and a ring at one that is too small to be seen; returns the kinds of shapes without an outline."""
    ax.set_visible(True)
    without, drawn = [], []
    for side, colour in zip("AB", SHADES):
        points = of_case(case, side)
        if points is None:
            without.append(case[f"shape{side}"]["type"])
            continue
        ax.fill(points[:, 0], points[:, 1], facecolor=colour, alpha=0.25, lw=0)
        ax.plot(points[:, 0], points[:, 1], color=colour, lw=1.2)
        drawn.append((points, colour))
    extents = [np.ptp(points, axis=0).max() for points, _ in drawn]
    for (points, colour), extent in zip(drawn, extents):
        if extent < TINY * max(extents):
            ax.plot(*[[middle] for middle in points.mean(axis=0)], ls="none", marker="o", ms=9, mfc="none", mec=colour, mew=1.2,
                    clip_on=False, zorder=4)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xticks([])
    ax.set_yticks([])
    ax.grid(False)
    ax.set_xlabel("\n".join(told(case)), fontsize=7)
    for spine in ax.spines.values():
        spine.set_visible(False)
    return without


# Ends of a case for a method, with the colour of the cell and the words over the column. The last three are no failures
# (failure.py): a method is asked only what it declares and supports, and may refuse other questions.
ENDS = {"ok": (RIGHT, "right"), "wrong": ("#D55E00", "wrong"), "failed": ("#661100", "failed"), "hang": ("#332288", "hang"),
        "undeclared": (REFUSED, "shape not\ndeclared"), "dimension": (NOT_ASKED, "other\ndimension"),
        "query": (NOT_ASKED, "other\nquery")}
FAILURES = ("wrong", "failed", "hang")
NOT_A_METHOD, REFEREE = "-", "referee"  # entries of the table that are no method: a query without a method, and the referee
UNDECLARED = ("unsupported_shape", "undecided", "nothing_expected")  # reasons of a refusal that is no failure
MADE_BY = "verify --cases tests/regressions/hard_cases.json"


@of_store("corpus", 90, SECTION,
          "Published hard cases", "No corpus was run into this store.", made_by=MADE_BY)
def corpus(context):
    """One chart, if the store has the table of the corpus; only `lpc verify --cases` writes it."""
    rows = read(context.store)
    if not len(rows):
        return []
    return [_corpus_chart(context, rows, context.store.meta.get("corpus_file", "a file of cases"))]


def read(store):
    """One row per case and method: the query of the case and its end. Methods that were not asked have a row too, so that each
    method has every case of the file."""
    if not store.meta.get("corpus"):
        return pd.DataFrame()
    rows = pd.read_csv(io.StringIO(store.meta["corpus"]), dtype=str, keep_default_na=False)
    if "precision" in rows:  # older stores have one
        twice = rows.duplicated(["id", "method"], keep=False)
        rows.loc[twice, "id"] += " " + rows.loc[twice, "precision"]
    stages = {entry["name"]: entry["stage"] for entry in store.algorithms if entry["stage"] in ("pair_query", "contacts")}
    query = lambda method: stages.get(method, method)  # noqa: E731
    asked = rows[rows["method"] != REFEREE]
    of_case = {case: query(method) for case, method in zip(asked["id"], asked["method"])}
    ends = {(case, method): _end(verdict, reason) for case, method, verdict, reason in
            zip(asked["id"], asked["method"], asked["verdict"], asked["reason"])}
    methods = sorted(set(asked["method"]) - {NOT_A_METHOD})
    found = [{"id": case, "method": method, "role": store.role(method), "query": of_case[case],
              "end": ends.get((case, method), "dimension" if query(method) == of_case[case] else "query")}
             for method in methods for case in of_case]
    return pd.DataFrame(found)


def _end(verdict, reason):
    """The end of a case. A refusal of declared shapes is a failure."""
    return verdict if verdict != "refused" else "undeclared" if reason in UNDECLARED else "failed"


def counts(rows):
    """Cases by method and end, our methods first. Each row adds up to the cases of the file."""
    table = rows.groupby(["role", "method", "end"]).size().unstack(fill_value=0)
    return table.reindex(columns=list(ENDS), fill_value=0).reset_index()


def found(table, rows):
    bad = table[list(FAILURES)].sum(axis=1)
    declared = bad + table["ok"]
    small = pd.DataFrame({"method": table["method"], "role": table["role"].replace("competitor", "LPC"),
                          "cases declared": declared, "failed": bad,
                          **{{"failed": "no answer"}.get(end, end): table[end] for end in FAILURES if table[end].any()}})
    small = small.sort_values(["failed", "role", "method"], ascending=[False, True, True], kind="stable").reset_index(drop=True)
    ours, theirs = table["role"] == "competitor", table["role"] == "witness"
    wrong = [table["method"][row] for row in table.index if ours[row] and bad[row]]
    most = max(wrong, key=lambda name: bad[table["method"] == name].iloc[0], default=None)
    at = table.index[table["method"] == most]
    said = f"{most} fails on {bad[at[0]]} of the {declared[at[0]]} that it declares" if len(wrong) == 1 else (
        f"{some(wrong)} fail, {most} on {bad[at[0]]} of {declared[at[0]]}" if wrong else "our methods fail on none that they "
                                                                                         "declare")
    worst = bad[theirs].idxmax() if theirs.any() and bad[theirs].max() else None
    other = "" if not theirs.any() else "; no witness fails" if worst is None else (
        f"; {table['method'][worst]} fails on {bad[worst]} of {declared[worst]}, the most of "
        f"{plural(int(theirs.sum()), 'witness', 'witnesses')}")
    head = f"Of {plural(rows['id'].nunique(), 'published case')} {said}"
    kept = [i for i, name in enumerate(small["method"]) if name in wrong]
    return Finding(fits(f"{head}{other}.", f"{head}."), cut(small, kept))


def _corpus_chart(context, rows, file):
    table = counts(rows)
    methods = list(table["method"])
    # Cases on which a method fails, the case with the most failures first.
    failing = rows[rows["end"].isin(FAILURES)]
    cases = list(failing.groupby("id").size().sort_values(ascending=False, kind="stable").index)
    left, body, top, bottom = 0.35 + 0.075 * max(len(context.name(m)) for m in methods), 0.24 * len(methods), 0.5, 0.3
    height = top + body + bottom
    figure = plt.figure(figsize=(WIDTH, height))
    wide = 0.62 * len(ENDS)
    numbers = figure.add_axes((left / WIDTH, bottom / height, wide / WIDTH, body / height))
    for y, row in table.iterrows():
        for x, (end, (colour, _)) in enumerate(ENDS.items()):
            count = int(row[end])
            numbers.add_patch(Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, lw=0, facecolor=colour if count else NOT_ASKED))
            numbers.text(x, y, count, ha="center", va="center", fontsize=8,
                         color="#888888" if not count else "white" if end in FAILURES else "black")
    numbers.set_xticks(range(len(ENDS)))
    numbers.set_xticklabels([words for _, words in ENDS.values()], fontsize=7.5)
    numbers.xaxis.tick_top()
    _plain(numbers, len(ENDS), len(methods))
    numbers.set_yticks(range(len(methods)))
    numbers.set_yticklabels([context.name(m) for m in methods])
    at = {(method, case): end for method, case, end in zip(rows["method"], rows["id"], rows["end"])}
    if cases:
        start = left + wide + 0.35
        grid = figure.add_axes((start / WIDTH, bottom / height, (WIDTH - start - 0.2) / WIDTH, body / height))
        for y, method in enumerate(methods):
            for x, case in enumerate(cases):
                grid.add_patch(Rectangle((x - 0.47, y - 0.45), 0.94, 0.9, facecolor=ENDS[at[method, case]][0], lw=0))
        grid.set_xticks([])
        grid.set_yticks([])
        _plain(grid, len(cases), len(methods))
        grid.set_xlabel(f"the {plural(len(cases), 'case')} on which a method fails, one column each", fontsize=8.5)
    ends = rows.pivot(index="id", columns="method", values="end")[methods].reindex(cases + sorted(set(rows["id"]) - set(cases)))
    return Chart("corpus", SECTION, "Published hard cases, method by method", found(table, rows), "", figure,
                 ends.reset_index(), [], _note(rows, file), made_by=MADE_BY,
                 headline=Headline("", dict(zip(methods, table[list(FAILURES)].sum(axis=1))), quantity="cases that failed"))


def _note(rows, file):
    cases = rows[["id", "query"]].drop_duplicates().groupby("query").size().sort_values(ascending=False, kind="stable")
    words = {"pair_query": "the distance of a pair", "contacts": "the contacts of a pair", "convex_hull": "a convex hull",
             "mass_properties": "a mass", NOT_A_METHOD: "a query without a method, such as a time of impact"}
    of = [f"{number} {words.get(query, query.replace('_', ' '))}" for query, number in cases.items()]
    return (f"A row adds up to the {cases.sum()} cases of {file}, which ask for {listing(of)}. Failed: an exception, a crash, "
            "a number that is not finite, or a refusal of declared shapes. The last three columns are no failures. At the "
            "right undeclared shapes are blue, cases of another dimension or query grey; other colours are as at the left. The "
            "numbers list all cases by name.")


def _plain(ax, columns, rows):
    ax.set_xlim(-0.5, columns - 0.5)
    ax.set_ylim(rows - 0.5, -0.5)
    ax.grid(False)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
