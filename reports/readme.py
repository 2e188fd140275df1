# SPDX-License-Identifier: Zlib
"""The README's figure: six resolvers on one scene, cost against error, with its numbers and its caption from one store.

docs/resolvers.json has the numbers and what they are of. The caption is written from it alone, between marks in the README, and
stands in the figure, too (`caption_of_figure`). A test writes the caption again and compares.
"""

import html
import json
import math
import re

import matplotlib.ticker as ticker
import pandas as pd

import measured
import metrics
import pages
import table
from load import UserError
from sentences import listing
from style import plt, si

SWEEPS, SCENE, DIMENSION = ("quick_resolvers", "resolvers"), "pyramid", 2  # the first that the store has
METHODS = {"catto+split_impulse": "catto (2005)", "soft_step": "soft_step (Box2D 3)", "tgs": "tgs",
           "xpbd": "xpbd (2020)", "avbd": "avbd (2025)", "direct_lcp": "direct_lcp"}  # name in the store -> in the figure
ABOVE_START = ("catto+split_impulse",)  # labelled there: its end lies among other lines
COST, ERROR = "ms_per_step_median", "penetration_settled"
DEEP = 1e-3  # m: the caption names the method that stays below this depth at the least cost
EXACT = 1e-6  # m: what is less deep is drawn here
COMMANDS = ("./experiments/run quick", "reports/make.py --store results/quick.db --readme README.md")
BEGIN, END = "<!-- figure -->", "<!-- end -->"


def cells_of(context):
    """The cells of METHODS on the scene, of the first sweep that the store has."""
    sweep = next((name for name in SWEEPS if name in context.store.sweeps()), None)
    if sweep is None:
        raise UserError(f"--readme: this store has no sweep {SWEEPS[0]}, of which the README's figure is made")
    cells = metrics.add(context.store, context.store.cells(sweep), (COST, ERROR))
    cells = cells[(cells["scene"] == SCENE) & (cells["dimension"] == DIMENSION) & cells["method"].isin(METHODS)]
    absent = [name for name in METHODS if name not in set(cells["method"])]
    bodies = sorted({int(n) for n in cells["bodies"].dropna()})
    if absent or len(bodies) != 1:
        raise UserError(f"--readme: {sweep} in this store lacks {listing(absent)}" if absent else
                        f"--readme: {SCENE} in {sweep} has runs of {bodies or 'no'} bodies; a caption needs one number")
    return cells.sort_values(["method", "iterations"])


def finding(cells):
    """One sentence: which method stays below DEEP at the least cost, and which runs failed."""
    good = cells[(cells["outcome"] == "ok") & (cells[ERROR] < DEEP)].sort_values(COST)
    failed = [f"{name} at {listing(f'{n:g}' for n in part['iterations'])} iterations"
              for name, part in cells[cells["outcome"] != "ok"].groupby("method", sort=True)]
    fails = f"; {listing(failed)} {'fails' if len(failed) == 1 else 'fail'}" if failed else ""
    if not len(good):
        return f"No method keeps the penetration below {si(DEEP, 'm')}{fails}."
    first = good.iloc[0]
    slowest = max(measured.runs(first, COST), default=first[COST])
    ties = [name for name in dict.fromkeys(good["method"].iloc[1:]) if name != first["method"] and
            min(measured.runs(good[good["method"] == name].iloc[0], COST), default=math.inf) <= slowest]
    beside = f", as does {listing(ties)} within the noise" if ties else ""
    return f"{first['method']} keeps the penetration below {si(DEEP, 'm')} at the least cost, {si(first[COST] / 1e3, 's')} " \
           f"per step{beside}{fails}."


def about(context, cells):
    """What the numbers of the figure are of."""
    return {"sweep": cells["sweep"].iloc[0], "scene": SCENE, "dimension": DIMENSION, "bodies": int(cells["bodies"].max()),
            "iterations": sorted(float(n) for n in set(cells["iterations"].dropna())), "finding": finding(cells),
            **pages.source(context.store)}


def numbers(cells):
    columns = {"method": cells["method"], "iterations": cells["iterations"], "outcome": cells["outcome"], "step": cells["step"]}
    for name, title, unit in ((COST, "time per step", "ms"), (ERROR, "largest penetration after the first second", "m")):
        columns |= table.quantity(title, unit, metrics.column(cells, name))
    return pd.DataFrame(columns)


def drawn(cells):
    """Each method is one line with its label beside it; its marks grow with the iterations. A cross is a failed run."""
    figure, ax = plt.subplots(figsize=(8.2, 4.3))
    top = 3 * max(EXACT, cells.loc[cells["outcome"] == "ok", ERROR].max())
    for place, name in enumerate(METHODS):
        mine, colour = cells[cells["method"] == name], f"C{place}"
        good = mine[mine["outcome"] == "ok"]
        x, y = good[COST] * 1e3, good[ERROR].clip(lower=EXACT)
        ax.plot(x, y, color=colour, lw=1.8)
        ax.scatter(x, y, s=[22 + 30 * i for i in range(len(good))], color=colour, zorder=3)
        bad = mine[mine["outcome"] != "ok"]
        ax.scatter(bad[COST] * 1e3, [top] * len(bad), marker="x", s=60, color=colour, zorder=3)
        for cost, outcome in zip(bad[COST] * 1e3, bad["outcome"]):
            ax.annotate(f"{name}: {outcome}", (cost, top), xytext=(8, 0), textcoords="offset points", va="center", color=colour)
        if len(good):
            exact = good[ERROR].iloc[-1] < EXACT
            end, offset = (0, (-5, 13)) if name in ABOVE_START else (-1, (9, 0))
            ax.annotate(METHODS[name] + (": exact" if exact else ""), (x.iloc[end], y.iloc[end]), xytext=offset,
                        textcoords="offset points", va="center", color=colour, fontweight="bold")
    ax.set_xscale("log")
    ax.set_yscale("log")
    low, high = ax.get_xlim()
    ax.set_xlim(low, 2.2 * high)
    ax.set_ylim(EXACT / 2, 2 * top)
    ax.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")
    ax.yaxis.set_major_formatter(lambda value, _: f"{value * 1e3:g}")
    ax.set_xlabel("time per step (µs)")
    ax.set_ylabel("deepest penetration (mm)")
    ax.annotate("better", (0.03, 0.04), (0.13, 0.2), xycoords="axes fraction", fontsize=12, color="#555555", ha="center",
                arrowprops={"arrowstyle": "-|>", "color": "#555555", "lw": 2})
    figure.tight_layout()
    return figure


def caption(facts):
    """From what docs/resolvers.json says, and nothing else."""
    marks = listing(f"{n:g}" for n in facts["iterations"])
    return (f"A {facts['scene']} of {facts['bodies'] - 1} boxes in {facts['dimension']}D, after its first second. "
            f"{facts['finding']} Growing marks: {marks} iterations or sub-steps. Most methods leave up to 5 mm on purpose.")


def block(facts):
    """What stands between the marks."""
    return (f"{BEGIN}\n![Six resolvers on a {facts['scene']}: time per step against penetration](docs/resolvers.svg)\n\n"
            f"*{caption(facts)}* [Numbers](docs/resolvers.json); made by `{COMMANDS[0]}`, then `{COMMANDS[1]}`.\n{END}")


def between_marks(text):
    """The README's part that is written here, with its marks."""
    found = re.findall(f"{BEGIN}.*?{END}", text, re.DOTALL)
    if len(found) != 1:
        raise UserError(f"--readme: the file has {len(found)} places between {BEGIN} and {END}; it needs one")
    return found[0]


def caption_of_figure(svg):
    """As `write` left it in the picture."""
    found = re.search("<dc:description>(.*?)</dc:description>", svg, re.DOTALL)
    return " ".join(html.unescape(found[1]).split()) if found else ""


def write(context, readme):
    """Writes docs/resolvers.svg, docs/resolvers.json and the README's caption; returns the caption."""
    if not readme.is_file():
        raise UserError(f"--readme {readme}: no such file")
    text, cells = readme.read_text(encoding="utf-8"), cells_of(context)
    old, facts, docs = between_marks(text), about(context, cells), readme.parent / "docs"
    pages.folder(docs)
    figure = drawn(cells)
    described = {"Date": None, "Creator": "LPC reports", "Description": caption(facts)}
    pages.whole(docs / "resolvers.svg", lambda target: figure.savefig(target, format="svg", metadata=described))
    plt.close(figure)
    pages.whole(docs / "resolvers.json", lambda target: table.to_json(numbers(cells), facts, target))
    pages.whole(readme, lambda target: target.write_text(text.replace(old, block(facts)), encoding="utf-8"))
    return caption(facts)


def read_facts(path):
    return json.loads(path.read_text(encoding="utf-8"))
