#!/usr/bin/python3
# SPDX-License-Identifier: Zlib
"""Draws the resting pyramid under several compilers and optimisation levels (2009 report, figures 7.6 and 7.7) from the CSV files
of experiments/heritage/compilers, and writes its finding."""

import argparse
import re
import sys
from pathlib import Path

EXAMPLE = """example:
  reports/heritage_compilers.py results/heritage_compilers --to reports/out/heritage/compilers.svg
  reports/heritage_compilers.py results/heritage_compilers --page docs/heritage_figures.md"""
PHASES = ("findPairs", "findContacts", "applyForces", "resolveVelocities", "moveApart")
MARKS = re.compile(r"<!-- compilers -->\n.*?<!-- end -->", re.DOTALL)  # on a page, below the picture
WARM_UP = 10  # first steps, which do not count


def builds_of(folder):
    """A row per build: medians of the medians of its runs (s), the interval of the whole step's median, the number of bodies, and
    the hashes of the last states."""
    import noise
    import pandas as pd
    runs = {}
    for path in sorted(Path(folder).glob("*_*_*.csv")):
        steps = pd.read_csv(path, dtype={"state": str})
        if len(steps) <= WARM_UP:
            raise ValueError(f"{path}: {len(steps)} steps; valid: more than {WARM_UP}")
        runs.setdefault(tuple(path.stem.rsplit("_", 2)[:2]), []).append(steps)
    if not runs:
        raise ValueError(f"{folder}: no COMPILER_LEVEL_REPEAT.csv; experiments/heritage/compilers makes them")
    rows = []
    for (compiler, level), part in sorted(runs.items()):
        medians = pd.DataFrame([steps.iloc[WARM_UP:][[f"{name} [s]" for name in ("whole", *PHASES)]].median() for steps in part])
        low, high = noise.interval(list(medians["whole [s]"]))
        rows.append({"compiler": compiler, "level": level, "low [s]": low, "high [s]": high, **medians.median(),
                     "bodies": int(part[0]["bodies"].iloc[-1]), "states": {steps["state"].iloc[-1] for steps in part}})
    return pd.DataFrame(rows)


def finding(builds):
    """A row per build. Ratios only where the intervals of two builds do not overlap."""
    import pandas as pd
    from finding import NOISE, TIE, Finding, ends, fits
    from style import times
    rows, gains = [], []
    apart = lambda a, b: a["high [s]"] < b["low [s]"] or b["high [s]"] < a["low [s]"]  # noqa: E731
    ratio = lambda a, b: a["whole [s]"] / b["whole [s]"] if apart(a, b) else f"{TIE}: {NOISE}"  # noqa: E731
    first = builds.sort_values("compiler")["compiler"].iloc[0]
    for compiler, part in builds.groupby("compiler", sort=True):
        last = part.iloc[-1]
        for _, build in part.iterrows():
            row = {"compiler": compiler, "level": f"-{build['level']}", "time of a step [s]": build["whole [s]"],
                   "range": ends(build["low [s]"], build["high [s]"], "s"),
                   "over the last level": None if build is last or build["level"] == last["level"] else ratio(build, last)}
            if builds["compiler"].nunique() > 1:
                other = builds[(builds["compiler"] == first) & (builds["level"] == build["level"])]
                row[f"over {first}"] = None if compiler == first or not len(other) else ratio(build, other.iloc[0])
            rows.append(row)
        if len(part) > 1 and apart(part.iloc[0], last):
            least = "" if gains else f" as fast as -{part.iloc[0]['level']}"
            gains.append(f"{times(ratio(part.iloc[0], last))} times{least} with {compiler}")
    states = len(set.union(*builds["states"]))
    bits = "all builds end in the same bits" if states == 1 else f"builds end in {states} different states"
    where = f"On a resting 2D pyramid of {builds['bodies'].iloc[0] - 1} boxes"
    level = f"-{builds['level'].iloc[-1]} is {' and '.join(gains)}; " if gains else ""
    return Finding(fits(f"{where} {level}{bits}.", f"{where} {bits}."), pd.DataFrame(rows))


def draw(builds, target):
    import numpy as np
    import overlap
    import pages
    from matplotlib.patches import Patch
    from style import PALETTE, grid_of_axes, legend_right, si
    compilers = list(dict.fromkeys(builds["compiler"]))
    figure, axes = grid_of_axes(1, len(compilers), 2.6, 1.75, left=0.9, gap_x=0.35, sharey=True)
    colours = {**{name: PALETTE[i] for i, name in enumerate(PHASES)}, "other": PALETTE[11]}
    for ax, compiler in zip(axes[0], compilers):
        part = builds[builds["compiler"] == compiler]
        below = np.zeros(len(part))
        # Shares, because a step at -O0 takes hundreds of times as long and would hide the other bars.
        whole = part["whole [s]"].to_numpy()
        parts = {name: 100 * part[f"{name} [s]"].to_numpy() / whole for name in PHASES}
        parts["other"] = np.maximum(0, 100 - sum(parts.values()))
        for name, values in parts.items():
            ax.bar(range(len(part)), values, bottom=below, color=colours[name], width=0.62, alpha=0.85)
            below = below + values
        for x, (_, build) in enumerate(part.iterrows()):
            ax.annotate(f"{si(build['whole [s]'], 's')}\n{si(build['low [s]'], 's')} to {si(build['high [s]'], 's')}", (x, 100),
                        xytext=(0, 4), textcoords="offset points", ha="center", fontsize=8)
        ax.set_xticks(range(len(part)), [f"-{level}" for level in part["level"]])
        ax.set_title(compiler)
        ax.grid(axis="x", visible=False)
    axes[0][0].set_ylabel("share of the time of a step (%)")
    axes[0][0].set_yticks(range(0, 101, 20))
    axes[0][0].set_ylim(0, 122)
    legend_right(figure, [Patch(color=colours[name], alpha=0.85, label=name) for name in reversed(colours)], 1.75)
    pages.folder(Path(target).parent)
    pages.save(figure, Path(target), said(finding(builds)))
    return overlap.overlaps(figure)


def said(found):
    """The finding as the page shows it: headline and table."""
    import table
    return f"*{found.headline}*\n\n{table.to_markdown(found.rows())}"


def write(text, page):
    """Writes the finding below the picture of a page."""
    import pages
    old = page.read_text(encoding="utf-8")
    if not MARKS.search(old):
        raise ValueError(f"--page {page}: no place for a finding; it needs lines '<!-- compilers -->' and '<!-- end -->'")
    pages.whole(page, lambda target: target.write_text(MARKS.sub(lambda _: block(text), old), encoding="utf-8"))


def block(text):
    return f"<!-- compilers -->\n{text}<!-- end -->"


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="reports/heritage_compilers.py", description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="DIR", help="folder that experiments/heritage/compilers wrote")
    parser.add_argument("--to", metavar="FILE", help="draw the chart into this file (.svg, .png or .pdf)")
    parser.add_argument("--page", metavar="FILE", help="write the finding on this page, between '<!-- compilers -->' and "
                        "'<!-- end -->'")
    options = parser.parse_args(arguments)
    try:
        builds = builds_of(options.folder)
        if options.to:
            draw(builds, options.to)
        if options.page:
            write(said(finding(builds)), Path(options.page))
        print(said(finding(builds)), end="")
    except (OSError, ValueError, KeyError) as error:
        print(f"reports/heritage_compilers.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
