# SPDX-License-Identifier: Zlib
"""Scenes that are hard to hold, and the methods that hold them: how far bodies have gone sideways and sunk by the end of a long
run, and how many times the baseline's time a step takes. What has sunk farther is told by which limits it would be held. A cell
in which rows were left to Gauss-Seidel has no rank. For sweeps that ask for it: `report = ["held"]`."""

import math

import pandas as pd
from matplotlib.patches import Rectangle

import metrics
import noise
import ranking
import rest
from chart import Chart, Headline, Needs, describe, holes, identifier, methods, of_sweeps
from load import one_machine, split, varying
from style import OUTCOMES, WIDTH, plt, si, times
from table import quantity

SECTION = "When does each method fall?"
TIME = "ms_per_step_median"
EXCUSE = "not ranked"  # column: why a cell has no rank
MOST_COLUMNS = 7


@of_sweeps("held", 42, SECTION,
           Needs("world", methods=(2, math.inf), also="a sweep that asks for this chart"),
           "Methods that hold what is hard to hold", "No sweep that asks for this chart is in this store.", "beyond")
def held(context, cells):
    about = context.store.sweep(cells["sweep"].iloc[0])
    if "held" not in about.report:
        return []
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, ["lateral_max", "sag_end"]))
    axes = [axis for axis in ("scene", *varying(context.store, cells, ("scene", "dimension"))) if axis in cells]
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        part = part.assign(**{EXCUSE: part.index.map(ranking.excused(context, part)).fillna("")})
        columns = {describe(own.iloc[0], axes): own.drop_duplicates("method").set_index("method") for own in split(part, axes)}
        made.append(_chart(context, part, columns, about.baseline, refused))
    return made


def slower(column, method, baseline):
    """How many times the baseline's time a step takes; NaN where one of the two was not timed."""
    if TIME not in column or baseline not in column.index:
        return math.nan
    base = float(column[TIME][baseline])
    return float(column[TIME][method]) / base if base > 0 else math.nan


def share(cell):
    return rest.sunk(cell["outcome"], cell.get("sunk"))


def holders(column, limit=rest.LIMITS[0]):
    """Methods that hold and have a rank. By the strictest limit the outcome is the answer."""
    own = column[column[EXCUSE] == ""]
    if limit == rest.LIMITS[0]:
        return sorted(own.index[own["outcome"] == "ok"])
    return sorted(m for m in own.index if share(own.loc[m]) <= limit)


def finding(where, column, baseline, everyone, least):
    holding, before = holders(column), set(holders(column))
    named = methods(holding, everyone) if len(holding) < len(column) else "Each method"
    said = [f"{named} {'holds' if len(holding) in (1, len(column)) else 'hold'} it" if holding else "No method holds it"]
    for limit in rest.LIMITS[1:]:
        more = sorted(set(holders(column, limit)) - before)
        before |= set(more)
        if more:
            deep = limit if len(more) > 1 else float(f"{share(column.loc[more[0]]):.2g}")
            sink = "sink by up to" if len(more) > 1 else "sinks by"
            said.append(f"{methods(more, everyone)} {sink} {rest.percent(deep)} of the smallest body")
    timed = column.loc[[m for m in holding if m != baseline and math.isfinite(slower(column, m, baseline))]]
    if len(timed):
        first = sorted(cell["method"] for cell in noise.leaders(timed.reset_index(), TIME, least))
        ratio = min(slower(column, m, baseline) for m in first)
        beside = f" but {baseline}" if baseline in holding else ""
        said.append(f"The cheapest{beside} {'is' if len(first) == 1 else 'are'} {methods(first, everyone)}"
                    f"{' (not told apart)' if len(first) > 1 else ''}, at {times(ratio)} times the time of {baseline}")
    out = ranking.told({m: f"{column[EXCUSE][m]}{'' if column['outcome'][m] == 'ok' else ', ' + column['outcome'][m]}"
                        for m in column.index if column[EXCUSE][m]})
    return f"{where}: {'. '.join(said)}.{out}"


def headline(columns, baseline, dimension):
    """The scene that fewest hold, if one does."""
    held = {where: holders(column) for where, column in columns.items() if holders(column)}
    where = min(held, key=lambda name: len(held[name]), default=None)
    if where is None or len(held[where]) == len(columns[where]):
        return None
    column, holding = columns[where], held[where]
    own = column[column[EXCUSE] == ""]
    if len(holding) == len(own):
        return None
    text = f"{where} in {dimension}D is held by {methods(holding, list(column.index))} alone."
    values = {m: float(own["lateral_max"][m]) if m in holding else math.nan for m in own.index}
    return Headline(text, values, "m", "sideways drift")


def _chart(context, part, columns, baseline, refused):
    everyone, dimension = sorted(part["method"].unique()), int(part["dimension"].iloc[0]) if "dimension" in part else 2
    sweep = part["sweep"].iloc[0]
    least = noise.floor_of(context, sweep, TIME)
    said = [finding(where, column, baseline, everyone, least) for where, column in columns.items()]
    return Chart(identifier(f"{sweep} held {dimension}d"), SECTION, f"Methods that hold what is hard to hold, {dimension}D",
                 f"In {dimension}D " + " ".join(said), sweep, _figure(columns, everyone, baseline),
                 _table(columns, everyone, baseline), refused + holes(part, ["scene", "method"]),
                 "A cell is one run: sideways, how far a body ever went across gravity; sag, how far one has sunk by the end; "
                 f"and the median time of a step over that of {baseline} in the same scene, whether it stands there or falls. "
                 f"What fell has its letter, and the step in which it did. {rest.WORDS}; what has sunk farther (S) is told by "
                 "how much, and which of these limits would hold it."
                 + (" A white cell has no rank: so many rows were left to Gauss-Seidel, or its precision is another."
                    if (part[EXCUSE] != "").any() else ""), headline=headline(columns, baseline, dimension))


def _figure(columns, everyone, baseline):
    names = list(columns)
    blocks = [names[i:i + MOST_COLUMNS] for i in range(0, len(names), MOST_COLUMNS)]
    left, row, above, below = 0.3 + 0.078 * max(map(len, everyone)), 0.56, 0.6, 0.4  # inches
    height = sum(above + row * len(everyone) for _ in blocks) + below
    figure, y = plt.figure(figsize=(WIDTH, height)), height
    for block in blocks:
        y -= above + row * len(everyone)
        wide = (WIDTH - left - 0.15) * len(block) / min(MOST_COLUMNS, max(4, len(names)))
        ax = figure.add_axes((left / WIDTH, y / height, wide / WIDTH, row * len(everyone) / height))
        ax.set_xlim(0, len(block))
        ax.set_ylim(len(everyone), 0)
        for x, where in enumerate(block):
            for place, method in enumerate(everyone):
                _cell(ax, x, place, columns[where], method, baseline)
        ax.set_xticks([x + 0.5 for x in range(len(block))])
        ax.set_xticklabels([where.replace(", ", "\n") for where in block], fontsize=8.5)
        ax.xaxis.tick_top()
        ax.set_yticks([place + 0.5 for place in range(len(everyone))])
        ax.set_yticklabels(everyone)
        ax.tick_params(length=0)
        ax.grid(False)
        for side in ax.spines.values():
            side.set_visible(False)
    seen = [o for o in OUTCOMES if any((column["outcome"] == o).any() for column in columns.values())]
    handles = [Rectangle((0, 0), 1, 1, facecolor=OUTCOMES[o][0],
                         label=f"held, to {rest.percent(rest.LIMITS[0])}" if o == "ok" else f"{OUTCOMES[o][1]} {o}")
               for o in seen]
    figure.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.01, 0.0), ncol=len(handles), handlelength=1.0)
    return figure


def _cell(ax, x, y, column, method, baseline):
    if method not in column.index:
        return
    cell, ratio = column.loc[method], slower(column, method, baseline)
    face, mark = OUTCOMES.get(cell["outcome"], ("#FFFFFF", "?"))
    ink = "white" if cell["outcome"] in ("diverged", "timeout", "crash") and not cell[EXCUSE] else "black"
    ax.add_patch(Rectangle((x + 0.02, y + 0.04), 0.96, 0.92, facecolor="white" if cell[EXCUSE] else face,
                           lw=0.8 if cell[EXCUSE] else 0, edgecolor="#BBBBBB"))
    if cell["outcome"] == "ok":
        lines = [f"{si(float(cell['lateral_max']), 'm')} sideways", f"{si(float(cell['sag_end']), 'm')} sag"]
    elif cell["outcome"] == "sank":
        within = [limit for limit in rest.LIMITS if share(cell) <= limit]
        lines = [f"{mark} by {100 * share(cell):.2g} %",
                 f"held to {rest.percent(within[0])} alone" if within else f"beyond {rest.percent(rest.LIMITS[-1])}"]
    else:
        lines = [mark + (f" at step {int(cell['step'])}" if cell["step"] == cell["step"] else "")]
    lines += [f"{times(ratio)} x the time"] if math.isfinite(ratio) and method != baseline else []
    lines += [cell[EXCUSE]] if cell[EXCUSE] else []
    for k, line in enumerate(lines):
        ax.text(x + 0.07, y + (k + 0.75) / (len(lines) + 0.5), line, ha="left", va="center", color=ink,
                fontsize=7.5 if len(lines) < 4 else 6.5)


def _table(columns, everyone, baseline):
    parts = []
    for where, column in columns.items():
        own = [m for m in everyone if m in column.index]
        part = {"scene": where, "method": own, "outcome": [column["outcome"][m] for m in own],
                "step": [column["step"][m] for m in own], EXCUSE: [column[EXCUSE][m] for m in own]}
        part |= quantity("sunk, of the smallest body", "1", [share(column.loc[m]) if share(column.loc[m]) < math.inf else
                                                             math.nan for m in own])
        part |= {f"held to {rest.percent(limit)}": ["yes" if share(column.loc[m]) <= limit else "no" for m in own]
                 for limit in rest.LIMITS}
        part |= quantity("sideways drift", "m", [column["lateral_max"][m] for m in own])
        part |= quantity("sag at the end", "m", [column["sag_end"][m] for m in own])
        part |= quantity(f"time over that of {baseline}", "1", [slower(column, m, baseline) for m in own])
        parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True)
