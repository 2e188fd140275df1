# SPDX-License-Identifier: Zlib
"""The README's figure: the chart, its numbers and its caption from one store, so that none of them tells of other data.

docs/resolvers.json has the numbers and what they are of; the caption is written from it alone, between marks in the README,
and stands in the figure, too (`caption_of_figure`). A test writes the caption again and compares.
"""

import html
import json
import re

import pages
import table
from chart import identifier
from load import UserError
from sentences import listing

SWEEPS, SCENE, DIMENSION = ("quick_resolvers", "resolvers"), "pyramid", 2  # the first that the store has
CHARTS = [identifier(f"{sweep} {SCENE}, {DIMENSION}D") for sweep in SWEEPS]
COMMANDS = ("./experiments/run quick", "reports/make.py --store results/quick.db --readme README.md")
BEGIN, END = "<!-- figure -->", "<!-- end -->"


def about(context, chart):
    """What the numbers of the chart are of."""
    cells = context.cells(chart.sweep)
    cells = cells[(cells["scene"] == SCENE) & (cells["dimension"] == DIMENSION)]
    bodies = sorted({int(n) for n in cells["bodies"].dropna()})
    if len(bodies) != 1:
        raise UserError(f"--readme: {SCENE} in {chart.sweep} has runs of {bodies or 'no'} bodies; a caption needs one number")
    return {"id": chart.id, "sweep": chart.sweep, "scene": SCENE, "dimension": DIMENSION, "bodies": bodies[0],
            "settings": {axis: sorted(float(v) for v in set(cells[axis].dropna())) for axis in context.settings(cells)},
            "finding": chart.headline.text if chart.headline else chart.finding, **pages.source(context.store)}


def caption(facts):
    """From what docs/resolvers.json says, and nothing else."""
    settings = "; ".join(f"{axis} {listing(f'{v:g}' for v in values)} (growing marks)"
                         for axis, values in facts["settings"].items())
    return f"{facts['bodies']} bodies with the ground{'; ' if settings else ''}{settings}. {facts['finding']}"


def block(facts):
    """What stands between the marks."""
    title = f"Resolvers on a {facts['scene']} of {facts['bodies']} bodies, {facts['dimension']}D: cost against error"
    return (f"{BEGIN}\n![{title}](docs/resolvers.svg)\n\n*{caption(facts)}* [Numbers](docs/resolvers.json); made by "
            f"`{COMMANDS[0]}`, then `{COMMANDS[1]}`.\n{END}")


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


def write(context, charts, readme):
    """Writes docs/resolvers.svg, docs/resolvers.json and the README's caption; returns the caption."""
    drawn = {c.id: c for c in charts if c.figure is not None}
    chart = next((drawn[name] for name in CHARTS if name in drawn), None)
    if chart is None:
        raise UserError(f"--readme: the chart {CHARTS[0]} is not drawn from this store; the sweep {SWEEPS[0]} makes it")
    if not readme.is_file():
        raise UserError(f"--readme {readme}: no such file")
    text = readme.read_text(encoding="utf-8")
    old, facts, docs = between_marks(text), about(context, chart), readme.parent / "docs"
    pages.folder(docs)
    described = {"Date": None, "Creator": "LPC reports", "Description": caption(facts)}
    pages.whole(docs / "resolvers.svg", lambda target: chart.figure.savefig(target, format="svg", metadata=described))
    pages.whole(docs / "resolvers.json", lambda target: table.to_json(chart.table, facts, target))
    pages.whole(readme, lambda target: target.write_text(text.replace(old, block(facts)), encoding="utf-8"))
    return caption(facts)


def read_facts(path):
    return json.loads(path.read_text(encoding="utf-8"))
