# SPDX-License-Identifier: Zlib
"""What becomes of scenes under each method, as a table in colours (2009 report, 9.1.10)."""

import math

import pandas as pd
from matplotlib.patches import Patch, Rectangle

import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, listing, of_sweeps, plural
from load import split, varying
from style import OUTCOMES, grid_of_axes, legend_right

SECTION = "What stands, and under whom?"
REST = "rest_since"


def _with(held, most):
    """The methods that hold as many as this one, and the verb."""
    alike = [method for method in held if held[method] == held[most]]
    return f"{listing(alike)} hold{'s' if len(alike) == 1 else ''}"


@of_sweeps("stability", 31, SECTION,
           Needs("world", methods=(2, math.inf), also="`report` that names it"),
           "What becomes of scenes under each method",
           "No sweep that asks for this chart is in this store; experiments/run heritage makes one.", "heritage_stability")
def stability(context, cells):
    if "stability" not in context.store.sweep(cells["sweep"].iloc[0]).report:
        return []
    return [_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def told(cell):
    """What stands in a cell: since when all rests, or the step of the end."""
    if cell["outcome"] == "ok":
        rest = cell.get(REST)
        return f"rests, {rest:.1f} s" if rest is not None and math.isfinite(rest) else "ok, moves"
    return cell["outcome"] + ("" if cell["step"] != cell["step"] else f", {int(cell['step'])}")


def finding(rows, methods):
    """Per method how much of what it was asked stands, then what each fall was."""
    said = []
    for method in methods:
        mine = [row for row in rows if row["method"] == method]
        fell = [row for row in mine if row["outcome"] != "ok"]
        said.append(f"{method} holds {len(mine) - len(fell)} of {len(mine)}" +
                    (f" (not {listing(_fallen(fell, mine))})" if 0 < len(fell) < len(mine) else ""))
    return "; ".join(said or ["no method has a rank"]) + "."


def _fallen(fell, mine):
    """Where, each as it is called; of more than two of a scene how many."""
    for scene in dict.fromkeys(row["scene"] for row in fell):
        there, of = [row["where"] for row in fell if row["scene"] == scene], sum(row["scene"] == scene for row in mine)
        yield from [scene] if len(there) == of else there if len(there) < 3 else [f"{scene} in {len(there)} of {of}"]


def _chart(context, cells):
    sweep = cells["sweep"].iloc[0]
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    axes = ["scene", *(name for name in varying(context.store, cells) if name not in ("scene", "dimension"))]
    methods, rows, places = list(dict.fromkeys(cells["method"])), [], {}
    called, kept = ranking.names(context, cells), set(ranking.whole(context, cells)["method"])
    ranked = [method for method in methods if method in kept]
    for _, cell in cells.iterrows():
        where = describe(cell, axes)
        places.setdefault(where, len(places))
        rows.append({"where": where, "scene": cell["scene"], "method": cell["method"], "outcome": cell["outcome"],
                     "step": cell["step"],
                     "told": told(cell), "reason": cell["reason"]})
    left = 0.35 + 0.075 * max(map(len, places))
    figure, panels = grid_of_axes(1, 1, 0.34 * len(places) + 0.1, 1.5, left=left, top=0.6, bottom=0.15)
    ax = panels[0][0]
    for row in rows:
        x, y = methods.index(row["method"]), places[row["where"]]
        colour = OUTCOMES.get(row["outcome"], ("#FFFFFF", ""))[0]
        ax.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=colour, edgecolor="white", lw=2))
        dark = sum(int(colour[i:i + 2], 16) for i in (1, 3, 5)) < 330
        ax.text(x, y, row["told"], ha="center", va="center", fontsize=8, color="white" if dark else "black")
    ax.set_xlim(-0.5, len(methods) - 0.5)
    ax.set_ylim(len(places) - 0.5, -0.5)
    ax.set_xticks(range(len(methods)), [called[m].replace(" (", "\n(").replace("+", "\n+") for m in methods])
    ax.set_yticks(range(len(places)), list(places))
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    ax.grid(False)
    for spine in ax.spines.values():
        spine.set_visible(False)
    legend_right(figure, [Patch(facecolor=OUTCOMES.get(o, ("#FFFFFF", ""))[0], edgecolor="#999999",
                                label=o if o == "ok" else f"{o}, at step")
                          for o in sorted({row["outcome"] for row in rows}, key=list(OUTCOMES).index)], 1.5)
    held = {method: sum(row["outcome"] == "ok" for row in rows if row["method"] == method) for method in ranked}
    least, most = min(held, key=held.get, default=None), max(held, key=held.get, default=None)
    head = None if not held or held[least] == held[most] else Headline(
        f"Of {plural(len(places), 'scene')} in {dimension}D, each with and without what varies, {_with(held, most)} {held[most]} "
        f"and {listing([m for m in held if held[m] == held[least]])} {held[least]}.", {m: float(v) for m, v in held.items()},
        quantity="scenes that stand", larger=True)
    return Chart(identifier(f"{sweep} stability {dimension}d"), SECTION,
                 f"What becomes of scenes under each method, {dimension}D",
                 f"In {dimension}D {finding(rows, ranked)}{ranking.tail(context, cells)}", sweep, figure,
                 pd.DataFrame(rows).drop(columns=["told", "scene"]).rename(columns={"where": "scene"}),
                 holes(cells, ["method", *axes]),
                 "Each cell is one run: since when all bodies rest, where they do until the end, or the step at which the run "
                 "ended, with its outcome. “moves”: it stands, and something is not at rest.", headline=head)
