# SPDX-License-Identifier: Zlib
"""Pair queries alone on random pairs of shapes: time against error, and how often they fail."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import failure
import measured
import metrics
import noise
from chart import Chart, Headline, Needs, describe, dimension_of, holes, identifier, of_sweeps
from load import one_machine, varying
from sentences import clauses, listing, plural, sentence, verb
from style import (NOT_ASKED, OUTCOMES, RIGHT, WIDTH, ZeroLog, fallen, grid_of_axes, legend_right, legend_room, letter, plt, si,
                   times)
from table import quantity

SECTION = "Which pair query is fast and right?"
FLOOR = 1e-17  # a tenth of the rounding of one operation in double precision: as good as exact
TIME = "ns_single"  # libraries are asked one by one: a time in batches, of lanes, has no rank beside theirs
BATCH = "ns_per_query"
ERRORS = ("median_error", "p99_error", "max_error")
SINGLE = ("A time is that of a query by itself, between two readings of the clock, which are in it; the numbers have that in "
          "batches, too, which wide registers make shorter.")


@of_sweeps("pair_queries", 70, SECTION,
           Needs("pairs", metrics=(TIME, *ERRORS)),
           "Time against error", "No timed sweep of pair queries is in this store.", "pair_queries")
def pair_queries(context, cells):
    if "wrong" not in cells:
        return [Chart(f"{cells['sweep'].iloc[0]}_uncounted", SECTION, "Time against error",
                      "These trials of pairs do not count wrong answers: they are older than the definition of a failure. The "
                      "sweep runs them again.", cells["sweep"].iloc[0])]
    cells, refused = one_machine(context.store, cells)
    if "precision" in cells and cells["precision"].nunique() > 1:
        cells["method"] = cells["method"] + " " + cells["precision"].map({"f64": "", "f32": "f32"}).fillna("")
        cells["method"] = cells["method"].str.strip()
    cells["pair"] = ["–".join(sorted((str(a), str(b)))) for a, b in zip(cells["kind_a"], cells["kind_b"])]
    if "arithmetic" in cells:  # else none is finished
        cells["judged"] = [context.store.judged(m, p) for m, (_, p) in zip(cells["method"], cells["arithmetic"])]
    made, least = [], noise.floor_of(context, cells["sweep"].iloc[0], TIME)
    for dimension in sorted(set(dimension_of(cells))):
        part = cells[dimension_of(cells) == dimension]
        part, absent = _present(part, dimension)
        made += [_scatter(context, part, dimension, refused + absent, least), _failures(context, part, dimension)]
    return made


def _present(cells, dimension):
    """Methods that exist in this dimension; the others are named once, not drawn in every panel."""
    supported = cells.groupby("method")["outcome"].apply(lambda o: (o != "unsupported").any())
    absent = sorted(supported[~supported].index)
    if len(absent) == len(supported):
        return cells, []
    said = [f"{listing(absent)}: unsupported in {dimension}D for every pair of shapes"] if absent else []
    return cells[~cells["method"].isin(absent)], said


def _usable(cells):
    return cells["outcome"].isin(["ok", "wrong"]).to_numpy()


def _holes(cells):
    """Who has no number; wrong answers are counted in the chart."""
    return holes(cells[~_usable(cells)].assign(step=math.nan), ["pair", "method"])


def answered(cells):
    """The cells that have a time, and which of them failed nowhere."""
    good = cells[_usable(cells) & np.isfinite(metrics.column(cells, TIME))]
    return good, failure.in_pairs(good) == 0


def questions(cells):
    """Who was asked how many queries of each pair of shapes: a share of 96 is not known as one of 600 is."""
    part = cells[_usable(cells) & np.isfinite(metrics.column(cells, "asked"))]
    numbers = part.groupby("method")["asked"].agg(lambda n: " to ".join(dict.fromkeys(f"{x:,.0f}" for x in (n.min(), n.max()))))
    groups = sorted(((list(of.index), number) for number, of in numbers.groupby(numbers)), key=lambda group: len(group[0]))
    many = "methods" if len(groups) == 1 else "others"
    said = [f"{number} to {listing(names) if len(names) < 5 else f'{len(names)} {many}'}" for names, number in groups]
    return f"queries of each pair of shapes: {', '.join(said)}" if said else "no query was answered"


def share_of(failed, asked):
    """A share of queries with their number."""
    return f"{failed:,.0f} of {asked:,.0f} ({failure.share(failed / asked)})"


def finding(cells, dimension, least):
    good, passed = answered(cells)
    if not len(good):
        return f"In {dimension}D no pair query has both a time and an error."
    if not passed.any():
        return f"In {dimension}D every pair query that was timed fails somewhere."
    parts = [part for _, part in good[passed].groupby("pair", sort=True)]
    only = [part["method"].iloc[0] for part in parts if len(part) == 1]
    first = [tuple(sorted(cell["method"] for cell in noise.leaders(part, TIME, least))) for part in parts if len(part) > 1]
    wins = sorted(set(first), key=lambda names: (-first.count(names), names))
    alone, shared = ([f"{' or '.join(names)} on {first.count(names)}" for names in wins if (len(names) > 1) == several]
                     for several in (False, True))
    told = clauses(alone and f"the fastest without a failure is {listing(alone)}",
                   shared and f"{_alike(least)}, {listing(shared)}",
                   only and f"without a rival, {listing(f'{m} on {only.count(m)}' for m in sorted(set(only)))}")
    text = f"In {dimension}D, of {plural(len(parts), 'pair of shapes', 'pairs of shapes')}, {told}"
    errors, failed, at = metrics.column(good, "max_error"), sorted(set(good["method"][~passed])), judged_at(good)
    worst = good.iloc[int(np.nanargmax(errors))] if np.isfinite(errors).any() else None
    off = f"{worst['max_error']:.2g} of the size ({worst['method']} on {worst['pair']})" if worst is not None else "unknown"
    if not failed:
        return f"{text}. No method fails {at}, and no error is above {off}."
    who = listing(failed) if len(failed) < 4 else f"{len(failed)} of {good['method'].nunique()} methods"
    return f"{text}. " + sentence(f"{at}, {who} {verb(len(failed), 'fail')} somewhere; the worst error is {off}")


def judged_at(cells):
    """The tolerance that decides who fails: ranks turn round at another. Methods that are judged by another are named."""
    asked = np.array([precision for _, precision in cells.get("arithmetic", [])])
    known = sorted({precision for precision in asked if precision in failure.TOLERANCE}, reverse=True)
    coarser = {p: sorted(set(cells["method"][(asked == p) & (cells["judged"] != p).to_numpy()])) for p in known}
    return "at " + (listing([failure.tolerance(p, coarser[p]) + (f" in {p}" if len(known) > 1 else "") for p in known]) if known
                    else "the referee's tolerance")


def headline(cells, dimension, least):
    """Where somebody fails: of those pairs of kinds the one that most methods answer. Where nobody does: the one on which the
    times of the fastest and the slowest differ most, if by more than the noise."""
    good, passed = answered(cells)
    failing = set(good["pair"][~passed])
    pairs = sorted(((part["method"].nunique(), pair) for pair, part in good.groupby("pair") if pair in failing), reverse=True)
    for _, pair in pairs:
        mine, fine = good[good["pair"] == pair], passed[(good["pair"] == pair).to_numpy()]
        if fine.any():
            return _told_failing(mine, fine, pair, dimension, least)
    return None if failing else _told_times(good, dimension, least)


def _told_failing(cells, passed, pair, dimension, least):
    right, wrong = cells[passed].sort_values(TIME, kind="stable"), cells[~passed]
    share = sorted(failure.in_pairs(wrong) / metrics.column(wrong, "asked"))
    shares = " to ".join(dict.fromkeys(map(failure.share, (share[0], share[-1]))))
    numbers = lambda part: listing([f"{n:,.0f}" for n in sorted(set(part["asked"]))])  # noqa: E731
    names = listing([f"{m} ({si(ns, 'ns')} a query)" for m, ns in zip(right["method"], right[TIME])])
    text = (f"On {pair} in {dimension}D, {judged_at(cells)}, {'only ' if len(wrong) > len(right) else ''}{names} never "
            f"{verb(len(right), 'fail')}, in {numbers(right)} queries{' each' if len(right) > 1 else ''}; ")
    quick = wrong.sort_values(TIME, kind="stable").iloc[0]
    if len(wrong) == 1:
        text += f"{quick['method']} ({si(quick[TIME], 'ns')}) fails on {share_of(failure.in_pairs(wrong)[0], quick['asked'])}"
    else:
        text += f"the {len(wrong)} others fail on {shares} of {numbers(wrong)}"
        if quick[TIME] < right[TIME].iloc[0] and noise.tells(right.iloc[0], quick, TIME, least):
            text += f", the fastest, {quick['method']}, in {si(quick[TIME], 'ns')}"
    return Headline(text + ".", {**dict(zip(right["method"], right[TIME])), **dict.fromkeys(wrong["method"], math.nan)}, "ns",
                    "time per query")


def _told_times(cells, dimension, least):
    """Times differ though no method fails."""
    found = []
    for pair, part in cells.groupby("pair", sort=True):
        part = part.sort_values(TIME, kind="stable")
        first, last = part.iloc[0], part.iloc[-1]
        if len(part) > 1 and noise.tells(first, last, TIME, least):
            found.append((last[TIME] / first[TIME], pair, part))
    if not found:
        return None
    ratio, pair, part = max(found, key=lambda told: told[:2])
    first = noise.leaders(part, TIME, least)
    names = " or ".join(cell["method"] for cell in first)
    return Headline(f"In {dimension}D no method fails, in {np.nansum(metrics.column(cells, 'asked')):,.0f} queries; times differ "
                    f"most on {pair}, where {part['method'].iloc[-1]} takes {times(ratio)} times the "
                    f"{si(part[TIME].iloc[0], 'ns')} a query of "
                    f"{names}{f', which are {_alike(least)}' if len(first) > 1 else ''}.",
                    dict(zip(part["method"], part[TIME])), "ns", "time per query")


def _alike(least):
    """The words for methods with times that cannot be told apart: noise, or too few repeats."""
    word = noise.silence(least)
    return "within the noise of each other" if word == noise.NOISE else f"alike {noise.IN_WORDS[word]}"


def _scatter(context, cells, dimension, refused, least):
    pairs = sorted(cells["pair"].unique())
    methods = sorted(cells["method"].unique())
    columns = min(4, len(pairs))
    rows = math.ceil(len(pairs) / columns)
    legend_width = legend_room(map(context.name, methods), 2.2)
    figure, axes = grid_of_axes(rows, columns, 1.95, legend_width, left=0.75, gap_x=0.55, gap_y=0.5)
    usable, looks = _usable(cells), context.looks(cells)
    errors = {name: np.where(usable, metrics.column(cells, name), math.nan) for name in ERRORS}
    time, failed = metrics.column(cells, TIME), failure.in_pairs(cells)
    all_errors = np.concatenate(list(errors.values()))
    # What a method does not declare is no failure; the next chart has a cell for it.
    declared = (cells["outcome"] != "unsupported").to_numpy()
    for index, ax in enumerate(axes.flat):
        if index >= len(pairs):
            ax.set_visible(False)
            continue
        mine = np.flatnonzero((cells["pair"] == pairs[index]).to_numpy() & declared)
        across = ZeroLog(ax, "x", time[declared], "ns", failed_name="none")
        up = ZeroLog(ax, "y", list(all_errors[np.isfinite(all_errors)]), "1", floor=FLOOR,
                     failures=bool(np.isnan(errors["max_error"][declared]).any()))
        spots = []
        for i in mine:
            look = looks(cells["method"].iloc[i])
            x = across.place(time[i])
            spread = [errors[name][i] for name in ERRORS if math.isfinite(errors[name][i])]
            if spread:
                ax.plot([x, x], [up.place(min(spread)), up.place(max(spread))], color=look["color"], lw=1.3, alpha=0.6)
                middle = errors["p99_error"][i] if math.isfinite(errors["p99_error"][i]) else max(spread)
                ax.plot([x], [up.place(middle)], **{**look, "linestyle": "none"})
            else:
                spots.append((x, up.failed, cells["outcome"].iloc[i], look["color"]))
        fallen(ax, spots)
        p99 = np.where(np.isfinite(errors["p99_error"]), errors["p99_error"], errors["max_error"])
        front = [mine[i] for i in failure.front(time[mine], p99[mine], failed[mine])]
        ax.step([time[i] for i in front], [up.place(p99[i]) for i in front], where="post", color="#222222", lw=2.4,
                alpha=0.3, zorder=1)
        ax.set_title(pairs[index])
        if index % columns == 0:
            ax.set_ylabel("error / size")
        else:
            ax.tick_params(labelleft=False)
        if index + columns >= len(pairs):
            ax.set_xlabel("time per query")
    handles = [Line2D([], [], label=context.name(m), **looks(m)) for m in methods]
    handles.append(Line2D([], [], color="#222222", lw=2.4, alpha=0.3, label="front, no failures"))
    handles += [Line2D([], [], ls="none", color="#555555", marker=letter(o), ms=7, label=o)
                for o in sorted({o for o in cells["outcome"][declared] if o not in ("ok", "wrong")})]
    legend_right(figure, handles, legend_width)
    table = pd.DataFrame({"pair": cells["pair"], "method": cells["method"], "outcome": cells["outcome"],
                          **quantity("time per query", "ns", time),
                          **quantity("time per query in batches", "ns", metrics.column(cells, BATCH)),
                          **{k: v for name in ERRORS for k, v in quantity(name.replace("_", " "), "1", errors[name]).items()}})
    return Chart(f"{cells['sweep'].iloc[0]}_error_{dimension}d", SECTION, f"Time against error by pair of shapes, {dimension}D",
                 finding(cells, dimension, least), cells["sweep"].iloc[0], figure, table.sort_values(["pair", "method"]),
                 refused + _holes(cells),
                 "A mark is the error that 99 of 100 queries stay below; its bar goes from the median to the worst. "
                 "Errors are over the size of the query: largest extent + distance + largest coordinate. "
                 f"{SINGLE} Hollow marks are witnesses; a method that does not declare a pair has none. "
                 f"{questions(cells).capitalize()}. "
                 f"{noise.rule(least)} {failure.DEFINITION}", headline=headline(cells, dimension, least))


def _failures(context, cells, dimension):
    pairs, methods = sorted(cells["pair"].unique()), sorted(cells["method"].unique())
    asked = cells[_usable(cells)].groupby("method")["asked"].max()
    names = [context.name(m) + (f", {asked[m]:,.0f}" if m in asked and asked[m] > 0 else "") for m in methods]
    height, left = 1.85 + 0.3 * len(methods), 0.35 + 0.072 * max(map(len, names))
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    figure.subplots_adjust(left=left / WIDTH, right=1 - 0.2 / WIDTH, top=1 - 0.2 / height, bottom=1.4 / height)
    rows, bad, outcomes = [], [], {}
    for y, method in enumerate(methods):
        for x, pair in enumerate(pairs):
            part = cells[(cells["method"] == method) & (cells["pair"] == pair)]
            colour, text, ink = NOT_ASKED, "", "#666666"
            if len(part):
                row = part.iloc[0]
                number, found = float(row.get("asked", math.nan)), failure.in_pairs(part)[0]
                counts, rate = [metrics.column(part, name)[0] for name in failure.OF_PAIRS], math.nan
                if not _usable(part)[0]:
                    colour, text = OUTCOMES.get(row["outcome"], ("#FFFFFF", "?"))
                    ink = "black" if row["outcome"] in ("unsupported", "not run", "collapsed") else "white"
                    text = {"unsupported": "no", "not run": "?"}.get(row["outcome"], text)
                    outcomes[row["outcome"]] = (colour, text)
                elif math.isfinite(found) and number > 0:
                    rate = found / number
                    share = 0 if rate == 0 else min(1.0, max(0.1, 1 + math.log10(rate) / 3))
                    colour = RIGHT if rate == 0 else plt.cm.Oranges(0.25 + 0.6 * share)
                    text, ink = ("0", "#4C7A5E") if rate == 0 else (failure.share(rate), "white" if rate > 0.05 else "black")
                    if rate > 0:
                        bad.append((rate, method, pair, found, number))
                else:
                    text = "?"
                rows.append({"method": method, "pair": pair, "outcome": row["outcome"], "asked": number,
                             "without an answer": counts[0], "refused": counts[1], "wrong": counts[2], "rate [1]": rate})
            ax.add_patch(plt.Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, facecolor=colour, lw=0))
            ax.text(x, y, text, ha="center", va="center", fontsize=7.5 if len(pairs) > 10 else 8.5, color=ink)
    ax.set_xlim(-0.5, len(pairs) - 0.5)
    ax.set_ylim(len(methods) - 0.5, -0.5)
    ax.set_xticks(range(len(pairs)))
    ax.set_xticklabels(pairs, rotation=30 if len(pairs) > 7 else 0, ha="right" if len(pairs) > 7 else "center")
    ax.set_yticks(range(len(methods)))
    ax.set_yticklabels(names)
    ax.grid(False)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
    handles = [Patch(facecolor=RIGHT, label="0: never fails"), Patch(facecolor=plt.cm.Oranges(0.6), label="share that fails")]
    handles += [Patch(facecolor=colour, label=f"{text}: {'does not declare it' if outcome == 'unsupported' else outcome}")
                for outcome, (colour, text) in sorted(outcomes.items())]
    blank = len(rows) < len(pairs) * len(methods)
    handles += [Patch(facecolor=NOT_ASKED, label="blank: was not asked")] if blank else []
    figure.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 0), ncol=len(handles), handlelength=1.2)
    good = cells[_usable(cells)]
    if bad:
        _, method, pair, found, number = max(bad)
        clean = [m for m in methods if m not in {b[1] for b in bad} and (good["method"] == m).any()]
        text = (f"In {dimension}D, {judged_at(good)}, {method} fails most often, on {pair}: {share_of(found, number)}; "
                f"without any failure: {listing(clean)} ({questions(cells)}).")
    else:
        text = (f"In {dimension}D no query of {np.nansum(metrics.column(good, 'asked')):,.0f} failed, {judged_at(good)} "
                f"({questions(cells)}).")
    # Without a failure in n draws a share of 3/n would have shown itself with 95 %.
    clean = good[(failure.in_pairs(good) == 0) & (metrics.column(good, "asked") > 0)]
    unseen = [f"{failure.share(3 / n)} at {n:,.0f}" for n in sorted(set(clean["asked"]))]
    return Chart(f"{cells['sweep'].iloc[0]}_failures_{dimension}d", SECTION, f"Rate of failures by pair of shapes, {dimension}D",
                 text, cells["sweep"].iloc[0], figure, pd.DataFrame(rows), _holes(cells),
                 "Failures over the queries asked, whose number per pair of shapes stands beside each name"
                 + (f"; where none failed, a share of up to {listing(unseen)} queries may have stayed unseen (95 %)" if unseen
                    else "")
                 + f". {failure.DEFINITION}")


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
    return noise.FEW if any(0 < len(measured.runs(cell, TIME)) < noise.FEWEST for cell in cells) else noise.NOISE


def finding_of_peers(rows):
    told = [(row, peer) for row in rows if (peer := right(row))]
    none = [row for row in rows if not right(row)]
    said = [f"on {len(told)} a library fails nowhere, either: {_ahead_of(told)}" if told else ""]
    if none:
        quick = sum(any(peer["ratio"] < 1 and peer["told"] for peer in row["peers"]) for row in none)
        said.append(f"on {len(none)} every library fails, and " +
                    (f"on {quick} of these one is faster than ours" if quick else "none is faster than ours"))
    return (f"Of {plural(len(rows), 'question that ours answer', 'questions that ours answer')} without a failure, "
            f"{clauses(*said)}.")


def _ahead_of(found):
    """On how many questions ours is faster, slower or not told from the fastest library that fails nowhere."""
    told = sorted((peer["ratio"], row["what"], peer["name"]) for row, peer in found if peer["told"])
    ahead, behind = [one for one in told if one[0] > 1], [one for one in told if one[0] < 1]
    faster, slower = f"ours is faster than the fastest such on {len(ahead)}", f"slower on {len(behind)}"
    if ahead:
        (least, *_), (most, what, name) = ahead[0], ahead[-1]
        ends = f"{times(least)} to {times(most)} times, most" if len(ahead) > 1 else f"{times(most)} times,"
        faster += f" ({ends} on {what} against {name})"
    if behind:
        slower += f" (most on {behind[0][1]}, where {behind[0][2]} takes {times(behind[0][0])} of our time)"
    silent = [_silence(row["ours"], peer["cell"]) for row, peer in found if not peer["told"]]
    return clauses(faster, slower, *(f"{noise.IN_WORDS[why]} on {silent.count(why)}" for why in (noise.NOISE, noise.FEW)
                                     if why in silent), between=", ")


def headline_of_peers(rows):
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
    return Chart(identifier(f"{sweep} peers"), SECTION, f"Beside packaged libraries: {sweep}", finding_of_peers(rows), sweep,
                 figure, _table(rows), refused,
                 f"{failure.DEFINITION} Right of the line ours is faster. A library is asked in a process of its own, ours in "
                 "that of the trial; of both a query is asked by itself, between two readings of the clock, which are in the "
                 "time.",
                 headline=headline_of_peers(rows))


def _table(rows):
    pairs = [(row, peer) for row in rows for peer in row["peers"]]
    return pd.DataFrame({"question": [row["what"] for row, _ in pairs], "ours": [row["ours"]["method"] for row, _ in pairs],
                         **quantity("time of ours", "ns", [row["ours"][TIME] for row, _ in pairs]),
                         "library": [peer["name"] for _, peer in pairs],
                         **quantity("time of the library", "ns", [peer["cell"][TIME] for _, peer in pairs]),
                         "ratio [1]": [peer["ratio"] for _, peer in pairs],
                         "failures [1]": [peer["cell"]["failures"] for _, peer in pairs],
                         "asked [1]": [peer["cell"]["asked"] for _, peer in pairs]})
