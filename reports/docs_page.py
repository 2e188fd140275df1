# SPDX-License-Identifier: Zlib
"""Charts on a page of docs/: finding, figure and numbers between each pair of marks, all from one store.

A page marks the place of a chart with `<!-- chart ID -->` and `<!-- end -->`. The text between the marks is written from ID.json
in figures/numbers.zip alone; the picture's metadata hold the finding, too. A test writes the text again and compares.
"""

import json
import re
import zipfile

import finding
import pages
import table
from load import UserError
from PIL import Image

MARKS = re.compile(r"<!-- chart (\w+) -->\n.*?<!-- end -->", re.DOTALL)
DPI = 110  # of the pictures: the width of a page
NUMBERS = "numbers.zip"  # ID.json of every chart on the pages of a folder


def block(facts):
    """The marks and the text between them."""
    made = ", then ".join(f"`{line}`" for line in facts["commands"])
    found = table.to_markdown(facts.get("found", []))
    note = f"{facts['note']} " if facts.get("note") else ""
    return (f"<!-- chart {facts['id']} -->\n*{facts['finding']}*\n\n{found}{'' if not found else chr(10)}"
            f"![{facts['title']}](figures/{facts['id']}.png)\n\n{note}"
            f"Numbers: `{facts['id']}.json` in [{NUMBERS}](figures/{NUMBERS}); made by {made}.\n<!-- end -->")


def wanted(text, page):
    ids = [found[1] for found in MARKS.finditer(text)]
    if not ids:
        raise UserError(f"--page {page}: no place for a chart; it needs lines '<!-- chart ID -->' and '<!-- end -->'")
    return ids


def read_numbers(figures):
    """{ID: text of ID.json}; empty without the file."""
    if not (figures / NUMBERS).is_file():
        return {}
    with zipfile.ZipFile(figures / NUMBERS) as packed:
        return {name.removesuffix(".json"): packed.read(name).decode() for name in packed.namelist()}


def write_numbers(numbers, figures):
    """Writes numbers.zip, in the order of names and without dates, so that the same numbers give the same bytes."""
    def pack(target):
        with zipfile.ZipFile(target, "w") as packed:
            for name in sorted(numbers):
                member = zipfile.ZipInfo(f"{name}.json")
                member.external_attr = 0o644 << 16
                packed.writestr(member, numbers[name], zipfile.ZIP_DEFLATED, 9)
    pages.whole(figures / NUMBERS, pack)


def finding_in(picture):
    """The finding in the metadata of a picture that `write` made."""
    with Image.open(picture) as image:
        return image.info.get("Description", "")


def write(context, charts, page):
    """Writes the page, and figures/ID.png and the numbers of each chart that it marks; returns the ids. Drops numbers that no
    page of the folder uses."""
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
    used = {found[1] for other in page.parent.glob("*.md") for found in MARKS.finditer(other.read_text(encoding="utf-8"))}
    numbers = {name: text for name, text in read_numbers(figures).items() if name in used}
    for name in ids:
        chart = drawn[name]
        commands = [line for sweep in dict.fromkeys((chart.sweep, *chart.others)) if sweep
                    for line in pages.sweep_commands(context.store, sweep, f"results/{context.store.path.name}")]
        facts = {"id": name, "title": chart.title, "finding": chart.finding.headline,
                 "found": chart.finding.rows(), "note": chart.note.strip(),
                 "commands": commands + [f"reports/make.py --store results/{context.store.path.name} --page docs/{page.name}"],
                 **pages.source(context.store)}
        described = {"Software": "LPC reports", "Description": chart.finding.text()}
        pages.whole(figures / f"{name}.png",
                    lambda target: chart.figure.savefig(target, format="png", dpi=DPI, metadata=described))  # noqa: B023
        numbers[name] = table.json_of(chart.table, facts)
        blocks[name] = block(facts)
    write_numbers(numbers, figures)
    pages.whole(page, lambda target: target.write_text(MARKS.sub(lambda found: blocks[found[1]], text), encoding="utf-8"))
    return ids


def faults(page):
    """Sentences about differences between a page, its pictures and its numbers; none where they agree."""
    said, numbers = [], read_numbers(page.parent / "figures")
    for found in MARKS.finditer(page.read_text(encoding="utf-8")):
        name, picture = found[1], page.parent / "figures" / f"{found[1]}.png"
        if not picture.is_file() or name not in numbers:
            said.append(f"{name}: {picture.name}, or {name}.json in {NUMBERS}, is missing")
            continue
        facts = json.loads(numbers[name])
        if found[0] != block(facts):
            said.append(f"{name}: the text of the page differs from {name}.json")
        if finding_in(picture) != finding.text(facts["finding"], facts.get("found", [])):
            said.append(f"{name}: the data of the picture differ from {name}.json")
    return said
