# SPDX-License-Identifier: Zlib
"""The ledgers in which nothing failed, in one matrix with the numbers of questions: twenty ledgers of zeros say no more."""

import pandas as pd
from matplotlib.patches import Rectangle

import failure
from chart import Chart, listing, of_store, plural
from charts.ledger import MADE_BY, NOUNS, PARTS, SECTION
from style import NOT_ASKED, RIGHT, WIDTH, plt

ROW, CELL, HEAD = 0.22, 0.4, 0.3  # inches


def clean(ledger):
    """The rows of the ledgers (stage, dimension, precision) in which no method fails."""
    parts = [part for _, part in ledger.groupby(PARTS, sort=True) if not failure.in_ledger(part)]
    return pd.concat(parts) if parts else ledger[:0]


@of_store("ledger_clean", 82, SECTION,
          "Ledgers without a failure", "No ledger without a failure is in this store.", made_by=MADE_BY)
def ledger_clean(context):
    rows = clean(context.store.ledger())
    return [_chart(context, rows)] if len(rows) else []


def counted(rows):
    """One row per stage, dimension and method, with its precisions; one column per kinds of shape, or per family of inputs
    where a stage has no kinds: numbers of questions."""
    rows = rows.assign(pair=["–".join((a, b)) if a or b else "" for a, b in zip(rows["kind_a"], rows["kind_b"])])
    kinds = rows[(rows["axis"] == "all") & (rows["pair"] != "")].assign(column=lambda part: part["pair"])
    families = rows[(rows["axis"] == "family") & (rows["pair"] == "")].assign(column=lambda part: part["value"])
    whole = rows[(rows["axis"] == "all") & (rows["pair"] == "") & ~rows["stage"].isin(families["stage"])].assign(column="all")
    found = pd.concat([kinds, families, whole])
    precisions = found.groupby(["stage", "dimension", "method"])["precision"].agg(lambda p: " ".join(sorted(set(p)))).rename("in")
    table = found.groupby(["stage", "dimension", "method", "column"], sort=True)["asked"].sum().reset_index()
    return table.join(precisions, on=["stage", "dimension", "method"])


def _chart(context, rows):
    table = counted(rows)
    stages = [stage for stage in [*NOUNS, *sorted(set(table["stage"]) - set(NOUNS))] if stage in set(table["stage"])]
    lines = {stage: table[table["stage"] == stage][["dimension", "method", "in"]].drop_duplicates().values.tolist()
             for stage in stages}
    name = lambda line: f"{context.name(line[1])}, {line[0]}D, {line[2]}"  # noqa: E731
    left = 0.3 + 0.068 * max(len(name(line)) for found in lines.values() for line in found)
    feet = {stage: 0.15 + 0.04 * max(map(len, table[table["stage"] == stage]["column"])) for stage in stages}
    height = sum(HEAD + ROW * len(lines[stage]) + feet[stage] for stage in stages)
    figure, top = plt.figure(figsize=(WIDTH, height)), height
    for stage in stages:
        part = table[table["stage"] == stage]
        columns = sorted(set(part["column"]))
        wide, high = min(WIDTH - left - 0.15, CELL * 1.6 * len(columns)), ROW * len(lines[stage])
        ax = figure.add_axes((left / WIDTH, (top - HEAD - high) / height, wide / WIDTH, high / height))
        asked = {(row.dimension, row.method, row.column): row.asked for row in part.itertuples()}
        for y, (dimension, method, _) in enumerate(lines[stage]):
            for x, column in enumerate(columns):
                number = asked.get((dimension, method, column))
                ax.add_patch(Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, facecolor=RIGHT if number else NOT_ASKED, lw=0))
                ax.text(x, y, _short(number) if number else "–", ha="center", va="center", fontsize=7,
                        color="#2F5D44" if number else "#888888")
        ax.set_xlim(-0.5, len(columns) - 0.5)
        ax.set_ylim(len(lines[stage]) - 0.5, -0.5)
        ax.set_xticks(range(len(columns)))
        ax.set_xticklabels([column.replace("_", " ") for column in columns], rotation=35, ha="right", rotation_mode="anchor",
                           fontsize=7.5)
        ax.set_yticks(range(len(lines[stage])))
        ax.set_yticklabels([name(line) for line in lines[stage]], fontsize=8)
        ax.set_title(f"{NOUNS.get(stage, stage)}: questions, none failed")
        ax.grid(False)
        ax.tick_params(length=0)
        for side in ax.spines.values():
            side.set_visible(False)
        top -= HEAD + high + feet[stage]
    everything = rows[rows["axis"] == "all"]
    ledgers = everything[PARTS].drop_duplicates()
    text = (f"Nothing fails in {plural(len(ledgers), 'ledger')}: "
            + listing([f"{NOUNS.get(stage, stage)} {listing([f'{d}D {p}' for d, p in zip(part['dimension'], part['precision'])])}"
                       for stage, part in ledgers.groupby("stage", sort=True)])
            + f"; {int(everything['asked'].sum()):,} questions to {everything['method'].nunique()} methods.")
    numbers = table.rename(columns={"in": "precisions", "column": "kinds or family"})
    unsure = int(everything["undecided"].sum())
    return Chart("ledger_clean", SECTION, "Ledgers without a failure", text, "", figure, numbers, [],
                 f"A number is how many questions were asked. {failure.DEFINITION}"
                 + (f" On {plural(unsure, 'question')} the referee's interval was too wide to judge." if unsure else ""),
                 made_by=MADE_BY)


def _short(number):
    """Of questions, in a narrow cell."""
    return f"{number}" if number < 10000 else f"{number / 1000:.0f}k" if number < 1e6 else f"{number / 1e6:.1f}M"
