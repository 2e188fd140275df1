#!/usr/bin/python3
# SPDX-License-Identifier: Zlib
"""Makes charts and a web page from a result store."""

import argparse
import sys
from pathlib import Path

EXAMPLE = """example:
  reports/make.py --store results/quick.db --out reports/out/quick
  reports/make.py --store results/quick.db --out reports/out/quick --only quick_broadphase_2d
  reports/make.py --store results/quick.db --chart quick_resolvers_pyramid__2d --to chart.svg
  reports/make.py --store results/quick.db --readme README.md
  reports/make.py --store results/evidence.db --page docs/evidence.md"""


def parse(arguments):
    parser = argparse.ArgumentParser(prog="reports/make.py", description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--store", required=True, metavar="FILE.db", help="the store that `lpc sweep` filled")
    parser.add_argument("--out", metavar="DIR", help="folder for index.html, charts/ and tables/ (made if absent)")
    parser.add_argument("--only", metavar="ID,ID", default="",
                        help="only the charts whose id begins with one of these, and no page")
    parser.add_argument("--chart", metavar="ID", help="one chart alone, written to --to; `best` chooses one")
    parser.add_argument("--to", metavar="FILE", help="with --chart: where to write it (.svg, .png or .pdf)")
    parser.add_argument("--readme", metavar="FILE",
                        help="the README: writes its figure, numbers and caption from this store")
    parser.add_argument("--page", metavar="FILE", help="a page of docs/: writes the finding, figure and numbers of each "
                        "chart that it marks with '<!-- chart ID -->' and '<!-- end -->', from this store")
    parser.add_argument("--check", action="store_true", help="print the texts that overlap or are cut off in the pictures, "
                        "and exit with 1 if there are any; write nothing")
    parser.add_argument("--list", action="store_true",
                        help="print the ids, titles and findings, and the metrics, and write nothing")
    parser.add_argument("--taken", action="store_true", help="print the combined pipeline of the sweeps of choose, if no sweep "
                        "has run it; write nothing")
    options = parser.parse_args(arguments)
    one_of = (options.out, options.list, options.check, options.readme, options.page, options.taken, options.chart and options.to)
    if not any(one_of):
        parser.error("give --out DIR, or --chart ID --to FILE, or --readme FILE, or --page FILE, or --list, or --check, "
                     "or --taken")
    return options


def all_charts(context, only=()):
    """All charts of the report in reading order. A kind of chart without data gives a chart that says so."""
    from chart import kinds, made
    from load import UserError
    from style import plt
    kept, everyone = [], []
    for kind in kinds():
        for chart in made(kind, context):
            if chart.id in context.ids:
                raise UserError(f"two charts have the id {chart.id}")
            context.ids.append(chart.id)
            everyone.append(chart)
            if not only or any(chart.id.startswith(name) for name in only):
                kept.append(chart)
            elif chart.figure is not None:
                plt.close(chart.figure)
    name_apart(everyone)
    return kept


def name_apart(charts):
    """Adds the sweep's name to titles that several charts share."""
    titles = [chart.title for chart in charts]
    for chart, title in zip(charts, titles):
        if titles.count(title) > 1 and chart.sweep:
            chart.title = f"{title}: {chart.sweep}"


def most_telling(charts):
    """The chart of `--chart best`: the first with `telling`, else the first that is drawn."""
    drawn = sorted((c for c in charts if c.figure is not None), key=lambda c: not c.telling)
    return drawn[0] if drawn else None


def run(options):
    from chart import Context
    from load import Store, UserError
    from metrics import known
    import pages
    store = Store(options.store)
    context = Context(store)
    if options.taken:
        from choice import to_run
        print(to_run(context))
        return 0
    if options.readme:
        import readme
        print(f"{options.readme}: {readme.write(context, Path(options.readme))}")
        return 0
    only = [name for name in options.only.split(",") if name]
    charts = all_charts(context, only)
    names = ", ".join(context.ids)
    if not charts:
        raise UserError(f"--only {options.only}: no such chart; there are {names}")
    if options.list:
        for chart in charts:
            print(f"{chart.id}  {chart.title}\n    " + chart.finding.text().replace("\n", "\n      "))
        print("\nmetrics")
        for name, metric in known(store).items():
            print(f"  {name} ({metric.unit})  {metric.meaning}")
        return 0
    if options.check:
        return check(charts)
    if options.page:
        import docs_page
        print(f"{options.page}: {', '.join(docs_page.write(context, charts, Path(options.page)))}")
        return 0
    if options.chart:
        found = most_telling(charts) if options.chart == "best" else next((c for c in charts if c.id == options.chart), None)
        if found is None or found.figure is None:
            raise UserError(f"--chart {options.chart}: not drawn from this store; there are {names}")
        target = Path(options.to)
        if target.suffix not in (".svg", ".png", ".pdf"):
            raise UserError(f"--to {options.to}: unknown ending; valid are .svg, .png, .pdf")
        pages.folder(target.parent)
        pages.save(found.figure, target)
        print(f"{target}: {found.finding.headline}")
        return 0
    out = Path(options.out)
    if out.exists() and not out.is_dir():
        raise UserError(f"--out {options.out}: not a folder")
    if only:
        for path in pages.write_charts(store, charts, out):
            print(path)
    else:
        pages.forget_earlier(out)
        print(pages.write(context, charts, out, options.store, options.out))
    return 0


def check(charts):
    """Prints the faults of the pictures; returns 1 if there are any."""
    import headlines
    import overlap
    faults = 0
    for chart in charts:
        figures = [chart.figure, headlines.drawn(chart.headline) if chart.headline is not None else None]
        for figure in filter(None, figures):
            together, outside = overlap.overlaps(figure)
            said = [f"{a!r} on {b!r}" for a, b in together] + [f"{text!r} is cut off" for text in outside]
            print("".join(f"{chart.id}: {fault}\n" for fault in said), end="")
            faults += len(said)
    print(f"{faults} faults in the pictures of {len(charts)} charts")
    return 1 if faults else 0


def main(arguments=None):
    try:
        return main_until_stopped(arguments)
    except KeyboardInterrupt:
        print("reports/make.py: stopped", file=sys.stderr)
        return 130


def main_until_stopped(arguments):
    options = parse(arguments)
    try:
        import jinja2  # noqa: F401
        import matplotlib  # noqa: F401
        import numpy  # noqa: F401
        import pandas  # noqa: F401
    except ImportError as error:
        print(f"reports/make.py: {sys.executable} has no package {error.name}; on Debian: apt install python3-matplotlib "
              "python3-pandas python3-jinja2", file=sys.stderr)
        return 2
    import json
    import sqlite3
    from load import UserError
    try:
        return run(options)
    except UserError as error:
        print(f"reports/make.py: {error}", file=sys.stderr)
    except OSError as error:
        print(f"reports/make.py: {error.filename}: {error.strerror}", file=sys.stderr)
    except (json.JSONDecodeError, sqlite3.DatabaseError) as error:  # of what is read after the store was opened
        print(f"reports/make.py: {options.store}: a damaged store ({' '.join(str(error).split())})", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
