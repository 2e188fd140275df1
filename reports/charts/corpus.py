# SPDX-License-Identifier: Zlib
"""The corpus of published hard cases: each method on each case, as `lpc verify --cases FILE --store STORE` keeps it."""

import io

import pandas as pd
from matplotlib.patches import Rectangle

from chart import Chart, Headline, listing, plural
from style import NOT_ASKED, REFUSED, RIGHT, WIDTH, plt

PLACE = 90
SECTION = "Who is right, and who fails where?"
VERDICTS = {"ok": RIGHT, "refused": REFUSED, "wrong": "#D55E00", "failed": "#661100", "hang": "#332288"}
MADE_BY = "verify --cases tests/regressions/hard_cases.json"


ABSENT = Chart("corpus", SECTION, "Published hard cases", "No corpus was run into this store.", "", made_by=MADE_BY)


def of_store(context):
    """A chart when the store has the table; `lpc verify` alone does not make it."""
    rows = read(context.store)
    if not len(rows):
        return []
    return [_chart(context, rows, context.store.meta.get("corpus_file", "a file of cases"))]


def read(store):
    """One row per case and method; not those of the referee, nor of queries that nobody takes (method `-`)."""
    if not store.meta.get("corpus"):
        return pd.DataFrame()
    rows = pd.read_csv(io.StringIO(store.meta["corpus"]), dtype=str, keep_default_na=False)
    rows["role"] = [store.role(method) for method in rows["method"]]
    return rows[~rows["method"].isin(["referee", "-"])]


def counts(rows):
    """Cases by method and verdict, ours first; a method has its row also where it was never right."""
    table = rows.groupby(["role", "method", "verdict"]).size().unstack(fill_value=0)
    for verdict in VERDICTS:
        if verdict not in table:
            table[verdict] = 0
    return table[list(VERDICTS)].reset_index()


def finding(table, rows):
    bad = table["wrong"] + table["failed"] + table["hang"]
    ours, theirs = table[table["role"] == "competitor"], table[table["role"] == "witness"]
    said = []
    wrong = [f"{m} fails on {n}" for m, n in zip(ours["method"], bad[ours.index]) if n]
    said.append(f"of {plural(rows['id'].nunique(), 'published case')} " +
                (listing(wrong) if wrong else "our own methods are right on all that they declare"))
    if len(theirs):
        worst = bad[theirs.index].idxmax()
        spared = [m for m, n in zip(theirs["method"], bad[theirs.index]) if not n]
        said.append(f"{table['method'][worst]} fails on {bad[worst]}, the most of {plural(len(theirs), 'witness', 'witnesses')}"
                    if bad[worst] else "no witness fails")
        if bad[worst] and spared:
            said.append(f"{listing(spared)} on none")
    text = "; ".join(said) + "."
    return text[0].upper() + text[1:]


def _chart(context, rows, file):
    table = counts(rows)
    methods = list(table["method"])
    # Cases on which somebody fails, the most telling first.
    failing = rows[rows["verdict"].isin(["wrong", "failed", "hang"])]
    cases = list(failing.groupby("id").size().sort_values(ascending=False, kind="stable").index)
    left, body, top, bottom = 0.35 + 0.075 * max(len(context.name(m)) for m in methods), 0.24 * len(methods), 0.35, 0.3
    height = top + body + bottom
    figure = plt.figure(figsize=(WIDTH, height))
    wide = 0.62 * len(VERDICTS)
    numbers = figure.add_axes((left / WIDTH, bottom / height, wide / WIDTH, body / height))
    for y, row in table.iterrows():
        for x, verdict in enumerate(VERDICTS):
            count = int(row[verdict])
            numbers.add_patch(Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, lw=0, facecolor=VERDICTS[verdict] if count else NOT_ASKED))
            numbers.text(x, y, count, ha="center", va="center", fontsize=8,
                         color="#888888" if not count else "black" if verdict in ("ok", "refused") else "white")
    numbers.set_xticks(range(len(VERDICTS)))
    numbers.set_xticklabels(VERDICTS)
    numbers.xaxis.tick_top()
    _plain(numbers, len(VERDICTS), len(methods))
    numbers.set_yticks(range(len(methods)))
    numbers.set_yticklabels([context.name(m) for m in methods])
    if cases:
        start = left + wide + 0.35
        grid = figure.add_axes((start / WIDTH, bottom / height, (WIDTH - start - 0.2) / WIDTH, body / height))
        at = {key: verdict for key, verdict in zip(zip(rows["method"], rows["id"]), rows["verdict"])}
        for y, method in enumerate(methods):
            for x, case in enumerate(cases):
                colour = VERDICTS.get(at.get((method, case)), NOT_ASKED)
                grid.add_patch(Rectangle((x - 0.47, y - 0.45), 0.94, 0.9, facecolor=colour, lw=0))
        grid.set_xticks([])
        grid.set_yticks([])
        _plain(grid, len(cases), len(methods))
        grid.set_xlabel(f"the {plural(len(cases), 'case')} on which a method fails, one column each", fontsize=8.5)
    verdicts = rows.pivot_table(index="id", columns="method", values="verdict", aggfunc="first").fillna("")
    verdicts = verdicts[[m for m in methods if m in verdicts]].reindex(cases + sorted(set(rows["id"]) - set(cases)))
    return Chart("corpus", SECTION, "Published hard cases, method by method", finding(table, rows), "", figure,
                 verdicts.reset_index(), [],
                 f"From {file}. Refused are shapes and queries that a method does not declare; failed is an exception, a crash "
                 "or a number that is not finite. All cases with their names are in the numbers.", made_by=MADE_BY,
                 headline=Headline(finding(table, rows), dict(zip(methods, table["wrong"] + table["failed"] + table["hang"]))))


def _plain(ax, columns, rows):
    ax.set_xlim(-0.5, columns - 0.5)
    ax.set_ylim(rows - 0.5, -0.5)
    ax.grid(False)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
