# SPDX-License-Identifier: Zlib
"""Charts on a page of docs/: for each pair of marks the figure, its finding and its numbers, all from one store.

A page says where it wants a chart, `<!-- chart ID -->` and `<!-- end -->`; what stands between is written here from
figures/ID.json alone, and the finding stands in the picture, too. A test writes it again and compares.
"""

import re

import pages
import table
from load import UserError
from PIL import Image
from readme import read_facts

MARKS = re.compile(r"<!-- chart (\w+) -->\n.*?<!-- end -->", re.DOTALL)
DPI = 110  # of the pictures: as wide as a page shows


def block(facts):
    """What stands between the marks, with them."""
    made = ", then ".join(f"`{line}`" for line in facts["commands"])
    return (f"<!-- chart {facts['id']} -->\n![{facts['title']}](figures/{facts['id']}.png)\n\n*{facts['finding']}* "
            f"[Numbers](figures/{facts['id']}.json); made by {made}.\n<!-- end -->")


def wanted(text, page):
    ids = [found[1] for found in MARKS.finditer(text)]
    if not ids:
        raise UserError(f"--page {page}: no place for a chart; it needs lines '<!-- chart ID -->' and '<!-- end -->'")
    return ids


def finding_in(picture):
    """As `write` left it there."""
    with Image.open(picture) as image:
        return image.info.get("Description", "")


def write(context, charts, page):
    """Writes figures/ID.png and ID.json beside the page for each chart that it wants, and the page; returns the ids."""
    if not page.is_file():
        raise UserError(f"--page {page}: no such file")
    text = page.read_text(encoding="utf-8")
    ids, drawn = wanted(text, page), {c.id: c for c in charts if c.figure is not None}
    lacking = [name for name in ids if name not in drawn]
    if lacking:
        there = f"are {', '.join(sorted(drawn))}" if drawn else "is no chart"
        raise UserError(f"--page {page}: not drawn from this store: {', '.join(lacking)}; there {there}")
    figures, blocks = page.parent / "figures", {}
    pages.folder(figures)
    for name in ids:
        chart = drawn[name]
        commands = [line for sweep in dict.fromkeys((chart.sweep, *chart.others)) if sweep
                    for line in pages.sweep_commands(context.store, sweep, f"results/{context.store.path.name}")]
        facts = {"id": name, "title": chart.title, "finding": chart.finding,
                 "commands": commands + [f"reports/make.py --store results/{context.store.path.name} --page docs/{page.name}"],
                 **pages.source(context.store)}
        described = {"Software": "LPC reports", "Description": chart.finding}
        pages.whole(figures / f"{name}.png",
                    lambda target: chart.figure.savefig(target, format="png", dpi=DPI, metadata=described))  # noqa: B023
        pages.whole(figures / f"{name}.json", lambda target: table.to_json(chart.table, facts, target))  # noqa: B023
        blocks[name] = block(facts)
    pages.whole(page, lambda target: target.write_text(MARKS.sub(lambda found: blocks[found[1]], text), encoding="utf-8"))
    return ids


def faults(page):
    """What a page, its pictures and its numbers say otherwise than each other: sentences, none where they agree."""
    said = []
    for found in MARKS.finditer(page.read_text(encoding="utf-8")):
        name = found[1]
        picture, numbers = (page.parent / "figures" / f"{name}.{ending}" for ending in ("png", "json"))
        if not picture.is_file() or not numbers.is_file():
            said.append(f"{name}: there are no {picture.name} and {numbers.name}")
            continue
        facts = read_facts(numbers)
        if found[0] != block(facts):
            said.append(f"{name}: what the page says is not what {numbers.name} does")
        if finding_in(picture) != facts["finding"]:
            said.append(f"{name}: the picture is of other data than {numbers.name}")
    return said
