# SPDX-License-Identifier: Zlib
"""The page: one HTML file with its charts in folders beside it. It opens from disk, without a server or scripts."""

import multiprocessing
import os
import shlex
import warnings
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import jinja2
import pandas as pd

import coverage
import declared
import headlines
import metrics
import table

from load import NOT_RUN, UserError
from sentences import plural
from style import plt

HERE = Path(__file__).resolve().parent
PROGRAM = "build/release/bin/lpc"
MARK = '<meta name="generator" content="LPC reports">'


def whole(path, write):
    """Calls write(path) so that the file is complete or absent: writes under another name, then renames. An existing device or
    pipe is written in place."""
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


def save(figure, path, finding=None):
    """Saves a figure in the format of the path's ending, without dates, so that the same store gives the same bytes. A given
    finding goes into the metadata of an SVG."""
    ending = path.suffix[1:]
    made_by = {"svg": {"Date": None, "Creator": "LPC reports"}, "png": {"Software": "LPC reports"}}
    metadata = made_by.get(ending, {}) | ({"Description": finding} if finding and ending == "svg" else {})
    whole(path, lambda target: figure.savefig(target, format=ending, dpi=150, metadata=metadata))


def save_all(pictures):
    """Saves [(figure, path)] with one process per core: this takes most of the time of a report."""
    global _pictures
    _pictures = pictures  # figures cannot be pickled: the forked processes inherit them
    cores = min(len(os.sched_getaffinity(0)), len(pictures))
    if cores < 2:
        for figure, path in pictures:
            save(figure, path)
        return
    try:
        with ProcessPoolExecutor(cores, multiprocessing.get_context("fork")) as pool:
            for said in pool.map(_save, range(len(pictures))):
                for message, category in said:  # the warnings of a forked process would be lost
                    warnings.warn(message, category, stacklevel=2)
    except BrokenProcessPool as error:
        raise UserError(f"a process that writes pictures was killed, perhaps for lack of memory: {error}") from error
    finally:
        _pictures = []


_pictures = []


def _save(place):
    """Saves one picture; returns its warnings."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        save(*_pictures[place])
    return [(str(warning.message), warning.category) for warning in said]


def save_table(rows, about, path):
    """Writes path.csv, and path.json with a description of the table."""
    whole(path.with_suffix(".csv"), lambda target: table.to_csv(rows, target))
    whole(path.with_suffix(".json"), lambda target: table.to_json(rows, about, target))


def facts(store):
    """The source of the numbers: machine, compiler, commit, seeds, dates, store."""
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
    seeds = sorted({seed for seed in (metrics._find(c, "seed") for c in store.trials["canonical"]) if seed == seed})
    more = f" and {len(seeds) - 8} more" if len(seeds) > 8 else ""
    rows.append(("seeds", ", ".join(f"{seed:.0f}" for seed in seeds[:8]) + more if seeds else "not recorded"))
    rows.append(("trials started", f"{first} to {last}" if first else "none"))
    rows.append(("store", f"{store.path.name}, schema {store.meta['schema_version']}, {len(store.trials)} trials"))
    return rows


def source(store):
    """The source of a table's numbers, for JSON; times are ISO 8601, UTC."""
    first, last = store.started()
    return {"store": store.path.name, "first_trial": first, "last_trial": last}


def forget_earlier(out):
    """Removes the charts and tables of an earlier report in this folder, and no other file."""
    page = out / "index.html"
    if not page.is_file() or MARK not in page.read_text(encoding="utf-8", errors="replace"):
        return
    for pattern in ("charts/*.svg", "charts/*.png", "charts/small/*.svg", "tables/*.csv", "tables/*.json"):
        for path in out.glob(pattern):
            path.unlink()


def write_charts(store, charts, out):
    """Writes each chart's figure and table; returns the paths of the figures."""
    pictures, tables = out / "charts", out / "tables"
    folder(pictures)
    folder(tables)
    drawn = [chart for chart in charts if chart.figure is not None]
    save_all([(chart.figure, pictures / (chart.id + ending)) for chart in drawn
              for ending in (".svg", ".png")])  # PNG for programs without SVG
    for chart in drawn:
        plt.close(chart.figure)
    for chart in charts:
        if len(chart.table):
            about = {"id": chart.id, "title": chart.title, "question": chart.section,
                     "finding": chart.finding.headline, "found": chart.finding.rows(), "sweep": chart.sweep}
            save_table(chart.table, {**about, **source(store)}, tables / chart.id)
    return [pictures / f"{chart.id}.svg" for chart in drawn]


def write_headlines(charts, out):
    """Writes the small charts of the first screen; returns their entries for the page."""
    folder(out / "charts" / "small")
    said = []
    for chart in headlines.chosen(charts):
        figure = headlines.drawn(chart.headline)
        save(figure, out / "charts" / "small" / f"{chart.id}.svg")
        said.append({"id": chart.id, "text": chart.headline.text, "title": chart.title,
                     "width": round(100 * figure.get_figwidth())})
        plt.close(figure)
    return said


def write(context, charts, out, store_argument, out_argument):
    """Writes out/index.html, out/charts/* and out/tables/*; returns the path of the page."""
    tables = out / "tables"
    write_charts(context.store, charts, out)
    first, sections = write_headlines(charts, out), {}
    for chart in charts:
        item = {"id": chart.id, "title": chart.title, "finding": chart.finding.headline, "note": chart.note,
                "found": table.to_html(chart.finding.table) if len(chart.finding.table) else "",
                "holes": chart.holes, "drawn": chart.figure is not None,
                "width": round(100 * chart.figure.get_figwidth()) if chart.figure is not None else 0,
                "table": table.to_html(chart.table) if len(chart.table) else "", "rows": len(chart.table),
                "commands": commands(context.store, chart, store_argument, out_argument)}
        sections.setdefault(chart.section, []).append(item)
    planned = coverage.trials(context.store)
    bad, outcomes = coverage.not_ok(planned), coverage.outcomes(planned)
    save_table(bad, {"id": "not_ok", "title": "Failed and missing trials", **source(context.store)}, tables / "not_ok")
    glossary = pd.DataFrame([(name, m.title, m.meaning, m.unit, m.smaller or "–", ", ".join(m.needs) or "–",
                              "the report" if m.compute else "the trial") for name, m in metrics.known(context.store).items()],
                            columns=["metric", "in charts", "meaning", "unit", "smaller is", "needs", "computed by"])
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE / "templates"), autoescape=True,
                                     trim_blocks=True, lstrip_blocks=True)
    page = environment.get_template("index.html.j2").render(
        sections=[{"name": name, "id": f"q{i}", "charts": part, "told": told(part)}
                  for i, (name, part) in enumerate(sections.items())],
        first=first, facts=facts(context.store), style=(HERE / "templates" / "style.css").read_text(),
        not_ok=table.to_html(bad, {declared.COLUMN: declared.linked}) if len(bad) else "", not_ok_count=len(bad),
        declared=declared.section(context.store, bad), outcomes=table.to_html(outcomes),
        glossary=table.to_html(glossary), missing=missing(context.store, store_argument), store=context.store.path.name,
        mark=MARK)
    path = out / "index.html"
    whole(path, lambda target: target.write_text(page, encoding="utf-8"))
    return path


def told(items):
    """The number of drawn charts of a section."""
    drawn = sum(item["drawn"] for item in items)
    return plural(drawn, "chart") if drawn else "not in this store"


def commands(opened, chart, store, out):
    """The commands that make a chart again: the sweeps that measure, and the report."""
    store, out = shlex.quote(str(store)), shlex.quote(str(out))
    lines = [line for sweep in dict.fromkeys((chart.sweep, *chart.others)) if sweep
             for line in sweep_commands(opened, sweep, store)]
    if not lines and chart.made_by:
        lines = [f"{PROGRAM} {chart.made_by} --store {store}"]
    return lines + [f"reports/make.py --store {store} --out {out} --only {chart.id}"]


def sweep_commands(opened, sweep, store):
    """The commands that planned the cells of this sweep, with file, plugins and options, as the store recorded them."""
    asked = opened.sweep(sweep).commands or (("sweep", sweep),)
    return [f"{PROGRAM} {shlex.join(arguments)} --store {store}" for arguments in asked]


def missing(opened, store):
    """Unfinished sweeps, for the first lines of the page: (sentence, commands that continue them)."""
    table, found = coverage.trials(opened), []
    for sweep, part in table.groupby("sweep", sort=False):
        left = int((part["outcome"] == NOT_RUN).sum())
        if left:
            found.append((f"{left} of {plural(len(part), 'trial')} of {sweep} are missing: the sweep was stopped, or still runs.",
                          sweep_commands(opened, sweep, shlex.quote(str(store)))))
    return found
