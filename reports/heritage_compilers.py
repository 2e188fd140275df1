#!/usr/bin/python3
# SPDX-License-Identifier: Zlib
"""The resting pyramid under compilers and levels (2009 report, figures 7.6 and 7.7): medians and chart of the CSV files that
experiments/heritage/compilers writes."""

import argparse
import re
import sys
import xml.etree.ElementTree
from pathlib import Path

EXAMPLE = """example:
  reports/heritage_compilers.py results/heritage_compilers --medians
  reports/heritage_compilers.py results/heritage_compilers --to reports/out/heritage/compilers.svg
  reports/heritage_compilers.py results/heritage_compilers --page docs/heritage_figures.md"""
PHASES = ("findPairs", "findContacts", "applyForces", "resolveVelocities", "moveApart")
LEVELS = ("O0", "O1", "O2", "O3")
MARKS = re.compile(r"<!-- compilers -->\n.*?<!-- end -->", re.DOTALL)  # on a page, below its picture
WARM_UP = 10  # steps that are not counted


def medians_of(folder):
    """A row per run: compiler, level, repeat, the medians of its steps (s), bodies, contact points and the hash of its last
    state."""
    import pandas as pd
    rows = []
    for path in sorted(Path(folder).glob("*_*_*.csv")):
        compiler, level, repeat = path.stem.rsplit("_", 2)
        steps = pd.read_csv(path, dtype={"state": str})
        told = steps.iloc[WARM_UP:]
        if not len(told):
            raise ValueError(f"{path}: {len(steps)} steps; valid: more than {WARM_UP}")
        rows.append({"compiler": compiler, "level": level, "repeat": int(repeat),
                     **{f"{name} [s]": float(told[f"{name} [s]"].median()) for name in ("whole", *PHASES)},
                     "bodies": int(steps["bodies"].iloc[-1]), "contact points": int(steps["contact points"].iloc[-1]),
                     "state": steps["state"].iloc[-1]})
    if not rows:
        raise ValueError(f"{folder}: no COMPILER_LEVEL_REPEAT.csv; experiments/heritage/compilers makes them")
    return pd.DataFrame(rows)


def builds_of(medians):
    """A row per build: the median of its runs, and the interval that holds the median of the whole step."""
    import noise
    import pandas as pd
    rows = []
    for (compiler, level), part in medians.groupby(["compiler", "level"], sort=False):
        low, high = noise.interval(list(part["whole [s]"]))
        rows.append({"compiler": compiler, "level": level, "runs": len(part), "low [s]": low, "high [s]": high,
                     **{f"{name} [s]": float(part[f"{name} [s]"].median()) for name in ("whole", *PHASES)}})
    found = pd.DataFrame(rows)
    return found.sort_values(["compiler", "level"], key=lambda column: column.map(
        lambda v: LEVELS.index(v) if v in LEVELS else v) if column.name == "level" else column, kind="stable")


def finding(medians):
    """What the levels give each compiler, which compiler is faster where, and whether all end in the same bits. Ratios only where
    the intervals of two builds are apart."""
    from style import si, times
    builds, said = builds_of(medians), []
    apart = lambda a, b: a["high [s]"] < b["low [s]"] or b["high [s]"] < a["low [s]"]  # noqa: E731
    ratio = lambda a, b: (f"{times(a['whole [s]'] / b['whole [s]'])} times" if apart(a, b) else  # noqa: E731
                          "alike within the noise")
    for compiler, part in builds.groupby("compiler", sort=True):
        first, last = part.iloc[0], part.iloc[-1]
        said.append(f"{compiler} takes {si(last['whole [s]'], 's')} a step at -{last['level']}" +
                    (f" and {ratio(first, last)} of that at -{first['level']}" if len(part) > 1 else "") +
                    (f"; -{part.iloc[-2]['level']} is {ratio(part.iloc[-2], last)} of -{last['level']}" if len(part) > 2 else ""))
    if builds["compiler"].nunique() == 2:
        a, b = (part for _, part in builds.groupby("compiler", sort=True))
        for _, one in a.iterrows():
            for _, other in b[b["level"] == one["level"]].iterrows():
                said.append(f"at -{one['level']} {one['compiler']} over {other['compiler']} is {ratio(one, other)}")
    ends = medians["state"].nunique()
    said.append("all end in the same bits" if ends == 1 else f"they end in {ends} different states")
    return (f"A resting pyramid of {medians['bodies'].iloc[0] - 1} boxes in 2D, with the stages of 2009: " + "; ".join(said) +
            ".")


def draw(medians, target):
    import numpy as np
    import overlap
    import pages
    from matplotlib.patches import Patch
    from style import PALETTE, grid_of_axes, legend_right, si
    builds = builds_of(medians)
    compilers = list(dict.fromkeys(builds["compiler"]))
    figure, axes = grid_of_axes(1, len(compilers), 2.6, 1.75, left=0.9, gap_x=0.35, sharey=True)
    colours = {**{name: PALETTE[i] for i, name in enumerate(PHASES)}, "other": PALETTE[11]}
    for ax, compiler in zip(axes[0], compilers):
        part = builds[builds["compiler"] == compiler]
        below = np.zeros(len(part))
        # Shares: at -O0 a step takes hundreds of times as long, and beside it no other bar would be seen.
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
    pages.save(figure, Path(target), finding(medians))
    return overlap.overlaps(figure)


def finding_in(picture):
    """As `draw` left it there; empty where a picture has none."""
    found = xml.etree.ElementTree.parse(picture).find(".//{http://purl.org/dc/elements/1.1/}description")
    return "" if found is None else found.text


def write(text, page):
    """Puts the finding below the picture of a page."""
    import pages
    old = page.read_text(encoding="utf-8")
    if not MARKS.search(old):
        raise ValueError(f"--page {page}: no place for a finding; it needs lines '<!-- compilers -->' and '<!-- end -->'")
    pages.whole(page, lambda target: target.write_text(MARKS.sub(lambda _: block(text), old), encoding="utf-8"))


def block(text):
    return f"<!-- compilers -->\n*{text}*\n<!-- end -->"


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="reports/heritage_compilers.py", description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="DIR", help="where experiments/heritage/compilers wrote")
    parser.add_argument("--medians", action="store_true", help="write DIR/medians.csv, a row per run")
    parser.add_argument("--to", metavar="FILE", help="draw the chart there (.svg, .png or .pdf)")
    parser.add_argument("--page", metavar="FILE", help="write the finding on that page, between '<!-- compilers -->' and "
                        "'<!-- end -->'")
    options = parser.parse_args(arguments)
    try:
        medians = medians_of(options.folder)
        if options.medians:
            medians.to_csv(Path(options.folder) / "medians.csv", index=False)
        if options.to:
            draw(medians, options.to)
        if options.page:
            write(finding(medians), Path(options.page))
        print(finding(medians))
    except (OSError, ValueError, KeyError) as error:
        print(f"reports/heritage_compilers.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
