# SPDX-License-Identifier: Zlib
"""Our pair queries beside packaged libraries: per pair of shapes, how many times our time theirs is, and how often they fail."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import failure
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, identifier, of_sweeps, plural
from load import one_machine, varying
from style import WIDTH, ZeroLog, legend_right, legend_room, plt, times
from table import quantity

SECTION = "Which pair query is fast and right?"
TIME = "ns_single"
WHAT = ("dimension", "pair", "vertices", "drawing")  # a row, besides what else differs in the sweep


@of_sweeps("peers", 71, SECTION,
           Needs("pairs", metrics=(TIME, "max_error"), also="ours and a witness on the same pairs of shapes"),
           "Beside packaged libraries", "No timed sweep asks ours and witnesses about the same pairs.", "pair_queries")
def peers(context, cells):
    if "wrong" not in cells or "stream" in cells:
        return []
    cells, refused = one_machine(context.store, cells)
    cells = cells.assign(dimension=dimension_of(cells),
                         pair=["–".join(sorted((str(a), str(b)))) for a, b in zip(cells["kind_a"], cells["kind_b"])],
                         ours=[context.store.role(m) == "competitor" for m in cells["method"]],
                         failures=failure.in_pairs(cells))
    asked = metrics.column(cells, "asked")
    known = np.isfinite(metrics.column(cells, TIME)) & np.isfinite(cells["failures"]) & (asked > 0)
    others = varying(context.store, cells, ("dimension", "kind_a", "kind_b", "vertices", "drawing", "n"))
    cells = cells[cells["outcome"].isin(["ok", "wrong"]).to_numpy() & known]
    least = noise.floor_of(context, cells["sweep"].iloc[0], TIME) if len(cells) else 1.0
    rows = rows_of(cells, least, others)
    return [_chart(context, cells, rows, refused)] if rows else []


def rows_of(cells, least, others=()):
    """One entry per question that one of ours answers without a failure and a witness answers at all."""
    what = [name for name in WHAT if name in cells] + list(others)
    found = []
    for key, part in cells.groupby(what, sort=True, dropna=False):
        ours = part[part["ours"] & (part["failures"] == 0)]
        peers = part[~part["ours"]]
        if not len(ours) or not len(peers):
            continue
        best = ours.loc[ours[TIME].idxmin()]
        where = describe(part.iloc[0], others)
        row = {"what": _named(dict(zip(what, key))) + (f", {where}" if where else ""), "ours": best, "peers": []}
        for _, peer in peers.sort_values(TIME, kind="stable").iterrows():
            row["peers"].append({"name": peer["method"], "ratio": float(peer[TIME] / best[TIME]), "cell": peer,
                                 "share": float(peer["failures"] / peer["asked"]),
                                 "told": noise.tells(best, peer, TIME, least)})
        found.append(row)
    return found


def _named(key):
    text = f"{key['pair']}, {key['dimension']}D"
    if "vertices" in key:
        text += f", {key['vertices']:.0f} vertices"
    return text + (f", {key['drawing']}" if isinstance(key.get("drawing"), str) else "")


def right(row):
    """The fastest of the row's peers that fails nowhere, or None."""
    return next((peer for peer in row["peers"] if peer["share"] == 0), None)


def _silence(*cells):
    """Why times are not told apart."""
    return noise.FEW if any(0 < len(noise.runs(cell, TIME)) < noise.FEWEST for cell in cells) else noise.NOISE


def finding(rows):
    with_right = [(row, right(row)) for row in rows if right(row)]
    said = []
    if with_right:
        told = [(row, peer) for row, peer in with_right if peer["told"]]
        ahead = sorted((p["ratio"], r["what"], p["name"]) for r, p in told if p["ratio"] > 1)
        behind = sorted((p["ratio"], r["what"], p["name"]) for r, p in told if p["ratio"] < 1)
        text = f"on {len(with_right)} a library fails nowhere, either: ours is faster than the fastest such on {len(ahead)}"
        if ahead:
            least, most = (times(ahead[i][0]) for i in (0, -1))
            span = f"{least} to {most} times, most" if len(ahead) > 1 else f"{most} times,"
            text += f" ({span} on {ahead[-1][1]} against {ahead[-1][2]})"
        text += f", slower on {len(behind)}"
        if behind:
            text += f" (most on {behind[0][1]}, where {behind[0][2]} takes {times(behind[0][0])} of our time)"
        silent = [_silence(row["ours"], peer["cell"]) for row, peer in with_right if not peer["told"]]
        for why in (noise.NOISE, noise.FEW):
            text += f", {noise.IN_WORDS[why]} on {silent.count(why)}" if why in silent else ""
        said.append(text)
    none = [row for row in rows if not right(row)]
    if none:
        quick = [row for row in none if any(peer["ratio"] < 1 and peer["told"] for peer in row["peers"])]
        said.append(f"on {len(none)} every library fails, and on {len(quick)} of these one is faster than ours"
                    if quick else f"on {len(none)} every library fails, and none is faster than ours")
    return (f"Of {plural(len(rows), 'question that ours answer', 'questions that ours answer')} without a failure, "
            f"{'; '.join(said)}.")


def headline(rows):
    """The question on which the fastest library that fails nowhere is farthest from ours, either way."""
    told = [(row, right(row)) for row in rows if right(row) and right(row)["told"]]
    if not told:
        return None
    row, peer = max(told, key=lambda found: abs(math.log(found[1]["ratio"])))
    first, last = sorted((row["ours"], peer["cell"]), key=lambda cell: cell[TIME])
    return Headline(f"On {row['what']}, {first['method']} takes 1/{times(float(last[TIME] / first[TIME]))} of the time of "
                    f"{last['method']}; neither fails.", {first["method"]: first[TIME], last["method"]: last[TIME]}, "ns",
                    "time per query")


def _chart(context, cells, rows, refused):
    sweep = cells["sweep"].iloc[0]
    names = sorted({peer["name"] for row in rows for peer in row["peers"]})
    legend_width = legend_room(list(map(context.name, names)) + ["hollow: fails somewhere"], 2.0)
    left = 0.25 + 0.075 * max(len(row["what"]) + len(row["ours"]["method"]) + 3 for row in rows)
    height = 0.75 + 0.24 * len(rows)
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    figure.subplots_adjust(left=left / WIDTH, right=1 - (legend_width + 0.15) / WIDTH, top=1 - 0.1 / height, bottom=0.6 / height)
    looks = context.looks(cells)
    scale = ZeroLog(ax, "x", [peer["ratio"] for row in rows for peer in row["peers"]] + [1.0], "1", failed_name="none")
    ax.axvline(scale.place(1.0), color="#555555", lw=1)
    for y, row in enumerate(rows):
        for peer in reversed(row["peers"]):
            look = looks(peer["name"])
            ax.plot([scale.place(peer["ratio"])], [y], ls="none", marker=look.get("marker", "o"), ms=6.5,
                    mec=look["color"], mew=1.4, mfc=look["color"] if peer["share"] == 0 else "none")
    ax.set_yticks(range(len(rows)))
    ax.set_yticklabels([f"{row['what']} ({context.name(row['ours']['method'])})" for row in rows], fontsize=8)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlabel("their time over that of our fastest that fails nowhere, which is named on the left")
    handles = [Line2D([], [], ls="none", marker=looks(n).get("marker", "o"), mec=looks(n)["color"], mfc=looks(n)["color"],
                      label=context.name(n)) for n in names]
    handles.append(Line2D([], [], ls="none", marker="o", mec="#555555", mfc="none", label="hollow: fails somewhere"))
    legend_right(figure, handles, legend_width)
    return Chart(identifier(f"{sweep} peers"), SECTION, f"Beside packaged libraries: {sweep}", finding(rows), sweep, figure,
                 _table(rows), refused,
                 f"{failure.DEFINITION} Right of the line ours is faster. A library is asked in a process of its own, ours in "
                 "that of the trial; of both a query is asked by itself, between two readings of the clock, which are in the "
                 "time.",
                 headline=headline(rows))


def _table(rows):
    pairs = [(row, peer) for row in rows for peer in row["peers"]]
    return pd.DataFrame({"question": [row["what"] for row, _ in pairs], "ours": [row["ours"]["method"] for row, _ in pairs],
                         **quantity("time of ours", "ns", [row["ours"][TIME] for row, _ in pairs]),
                         "library": [peer["name"] for _, peer in pairs],
                         **quantity("time of the library", "ns", [peer["cell"][TIME] for _, peer in pairs]),
                         "ratio [1]": [peer["ratio"] for _, peer in pairs],
                         "failures [1]": [peer["cell"]["failures"] for _, peer in pairs],
                         "asked [1]": [peer["cell"]["asked"] for _, peer in pairs]})
