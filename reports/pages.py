# SPDX-License-Identifier: Zlib
"""The page: one HTML file with the charts beside it, that opens from disk without a server or script."""

import html
import shlex
from pathlib import Path

import jinja2
import pandas as pd

import coverage
import metrics
from load import UserError
from style import plt

HERE = Path(__file__).resolve().parent
MARK = '<meta name="generator" content="LPC reports">'


def table_html(table):
    """A plain table; numbers right, nothing hidden. Empty cells of a table are empty, zero is 0."""
    head = "".join(f"<th>{html.escape(str(c))}</th>" for c in table.columns)
    body = []
    for row in table.itertuples(index=False):
        cells = []
        for value in row:
            text = cell_text(value)
            numeric = text[:1].isdigit() or text[:2].lstrip("-")[:1].isdigit()
            cells.append(f"<td{' class=n' if numeric else ''}>{html.escape(text)}</td>")
        body.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table>"


def cell_text(value):
    if value is None or (isinstance(value, float) and value != value) or value is pd.NA:
        return ""
    if isinstance(value, float):
        return f"{value:,.0f}" if value == int(value) and abs(value) < 1e15 else f"{value:.4g}"
    return str(value)


def whole(path, write):
    """Calls write(path) so that the file is there whole or not at all: under another name first, then renamed. What
    exists and is no regular file (a device, a pipe) is written in place."""
    special = path.exists() and not path.is_file()
    target = path if special else path.with_name(path.name + ".partial")
    try:
        write(target)
        if not special:
            target.replace(path)
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        if not special:
            target.unlink(missing_ok=True)


def folder(path):
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{path}: cannot be made: {error.strerror}") from error


def save(figure, path):
    """As the ending says; no dates inside, so the same store gives the same bytes."""
    ending = path.suffix[1:]
    made_by = {"svg": {"Date": None, "Creator": "LPC reports"}, "png": {"Software": "LPC reports"}}
    whole(path, lambda target: figure.savefig(target, format=ending, dpi=150, metadata=made_by.get(ending, {})))


def save_table(table, path):
    whole(path, lambda target: table.to_csv(target, index=False))


def facts(store):
    """The header: where these numbers come from."""
    first, last = store.started()
    rows = []
    for number, machine in sorted(store.machines.items()):
        text = ", ".join(f"{key}: {machine[key]}" for key in machine if key not in ("compiler", "flags"))
        rows.append(("machine" if len(store.machines) == 1 else f"machine {number}", text))
        rows.append(("compiler", str(machine.get("compiler", "not recorded"))))
        rows.append(("flags", str(machine.get("flags", "not recorded"))))
    commits = sorted({c for c in store.trials["commit_id"] if c})
    rows.append(("commit", ", ".join(commits[:6]) + (f" and {len(commits) - 6} more" if len(commits) > 6 else "")
                 if commits else "not recorded"))
    seeds = sorted({str(seed) for seed in (metrics._find(c, "seed") for c in store.trials["canonical"]) if seed == seed})
    rows.append(("seeds", ", ".join(s.removesuffix(".0") for s in seeds[:8]) + (" …" if len(seeds) > 8 else "")
                 if seeds else "not recorded"))
    rows.append(("trials started", f"{first} to {last}" if first else "none"))
    rows.append(("store", f"{store.path.name}, schema {store.meta['schema_version']}, {len(store.trials)} trials"))
    return rows


def forget_earlier(out):
    """Removes the charts and tables of an earlier report in this folder, and nothing that is not a report's."""
    page = out / "index.html"
    if not page.is_file() or MARK not in page.read_text(encoding="utf-8", errors="replace"):
        return
    for pattern in ("charts/*.svg", "charts/*.png", "tables/*.csv"):
        for path in out.glob(pattern):
            path.unlink()


def write_charts(charts, out):
    """Writes each chart's figure and table; returns the paths of the figures."""
    pictures, tables = out / "charts", out / "tables"
    folder(pictures)
    folder(tables)
    written = []
    for chart in charts:
        if chart.figure is not None:
            for ending in (".svg", ".png"):  # PNG for where SVG does not go
                save(chart.figure, pictures / (chart.id + ending))
            plt.close(chart.figure)
            written.append(pictures / f"{chart.id}.svg")
        if len(chart.table):
            save_table(chart.table, tables / f"{chart.id}.csv")
    return written


def write(context, charts, out, store_argument, out_argument):
    """Writes out/index.html, out/charts/* and out/tables/*; returns the path of the page."""
    tables = out / "tables"
    write_charts(charts, out)
    items, sections = [], {}
    for chart in charts:
        item = {"id": chart.id, "title": chart.title, "finding": chart.finding, "note": chart.note,
                "holes": chart.holes, "drawn": chart.figure is not None,
                "width": round(100 * chart.figure.get_figwidth()) if chart.figure is not None else 0,
                "table": table_html(chart.table) if len(chart.table) else "", "rows": len(chart.table),
                "commands": commands(chart, store_argument, out_argument)}
        items.append(item)
        sections.setdefault(chart.section, []).append(item)
    bad = coverage.not_ok(coverage.trials(context.store))
    save_table(bad, tables / "not_ok.csv")
    glossary = pd.DataFrame([(name, m.meaning, m.unit, m.smaller or "–", ", ".join(m.needs) or "–",
                              "the report" if m.compute else "the trial") for name, m in metrics.known(context.store).items()],
                            columns=["metric", "what it is", "unit", "smaller is", "needs", "computed by"])
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE / "templates"), autoescape=True,
                                     trim_blocks=True, lstrip_blocks=True)
    page = environment.get_template("index.html.j2").render(
        sections=[{"name": name, "id": f"q{i}", "charts": part} for i, (name, part) in enumerate(sections.items())],
        charts=items, facts=facts(context.store), style=(HERE / "templates" / "style.css").read_text(),
        not_ok=table_html(bad) if len(bad) else "", not_ok_count=len(bad), glossary=table_html(glossary),
        store=context.store.path.name, mark=MARK)
    path = out / "index.html"
    whole(path, lambda target: target.write_text(page, encoding="utf-8"))
    return path


def commands(chart, store, out):
    """What to type to get this figure again: the sweep that measures, the report that draws."""
    store, out = shlex.quote(str(store)), shlex.quote(str(out))
    made_by = f"sweep {shlex.quote(chart.sweep)}" if chart.sweep else chart.made_by
    lines = [f"build/release/bin/lpc {made_by} --store {store}"] if made_by else []
    return lines + [f"reports/make.py --store {store} --out {out} --only {chart.id}"]
