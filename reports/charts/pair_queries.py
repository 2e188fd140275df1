# SPDX-License-Identifier: Zlib
"""Pair queries on random pairs of shapes: time, error and rate of failures, and the comparison with packaged libraries."""

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
from finding import Finding, cut, fits, told
from load import one_machine, varying
from sentences import listing, plural, some, verb
from style import (NOT_ASKED, OUTCOMES, RIGHT, WIDTH, ZeroLog, fallen, grid_of_axes, legend_right, legend_room, letter, plt, si,
                   times)
from table import quantity

SECTION = "Which pair query is fast and right?"
FLOOR = 1e-17  # a tenth of the rounding of one operation in double precision: counts as exact
TIME = "ns_single"  # libraries answer one query at a time: times of batches, which use SIMD lanes, have no rank beside theirs
BATCH = "ns_per_query"
ERRORS = ("median_error", "p99_error", "max_error")


@of_sweeps("pair_queries", 70, SECTION,
           Needs("pairs", metrics=(TIME, *ERRORS)),
           "Time against error", "This store has no timed sweep of pair queries.", "pair_queries")
def pair_queries(context, cells):
    if "wrong" not in cells:
        return [Chart(f"{cells['sweep'].iloc[0]}_uncounted", SECTION, "Time against error",
                      "The trials of this sweep do not count wrong answers, because an older program ran them.",
                      cells["sweep"].iloc[0], holes=["Run the sweep again to count them."])]
    cells, refused = one_machine(context.store, cells)
    if "precision" in cells and cells["precision"].nunique() > 1:
        cells["method"] = cells["method"] + " " + cells["precision"].map({"f64": "", "f32": "f32"}).fillna("")
        cells["method"] = cells["method"].str.strip()
    cells["pair"] = ["–".join(sorted((str(a), str(b)))) for a, b in zip(cells["kind_a"], cells["kind_b"])]
    if "arithmetic" in cells:  # missing where no trial finished
        cells["judged"] = [context.store.judged(m, p) for m, (_, p) in zip(cells["method"], cells["arithmetic"])]
    made, least = [], noise.floor_of(context, cells["sweep"].iloc[0], TIME)
    for dimension in sorted(set(dimension_of(cells))):
        part = cells[dimension_of(cells) == dimension]
        part, absent = _present(part, dimension)
        made += [_scatter(context, part, dimension, refused + absent, least), _failures(context, part, dimension)]
    return made


def _present(cells, dimension):
    """Drops methods that do not exist in this dimension; returns the cells and a sentence that names the dropped methods."""
    supported = cells.groupby("method")["outcome"].apply(lambda o: (o != "unsupported").any())
    absent = sorted(supported[~supported].index)
    if len(absent) == len(supported):
        return cells, []
    said = [f"{listing(absent)}: unsupported in {dimension}D for every pair of shapes"] if absent else []
    return cells[~cells["method"].isin(absent)], said


def _usable(cells):
    return cells["outcome"].isin(["ok", "wrong"]).to_numpy()


def _holes(cells):
    """Cells without a number. Wrong answers are not holes: the chart counts them."""
    return holes(cells[~_usable(cells)].assign(step=math.nan), ["pair", "method"])


def answered(cells):
    """The cells that have a time, and which of them have no failure."""
    good = cells[_usable(cells) & np.isfinite(metrics.column(cells, TIME))]
    return good, failure.in_pairs(good) == 0


def share_of(failed, asked):
    """A share of queries with their number."""
    return f"{failed:,.0f} of {asked:,.0f} ({failure.share(failed / asked)})"


def tolerances(cells):
    """"1e-12 of the size": the tolerance that decides what is a failure. Ranks can change with it."""
    known = sorted({precision for _, precision in cells.get("arithmetic", []) if precision in failure.TOLERANCE}, reverse=True)
    said = [failure.tolerance(p) + (f" in {p}" if len(known) > 1 else "") for p in known]
    return listing(said) if said else "the referee's tolerance"


def judged_at(cells):
    """{method: its tolerance}: methods that compute in single precision are judged by that of f32."""
    if "judged" not in cells:
        return {}
    return {method: " and ".join(failure.tolerance(p) for p in sorted(set(part["judged"]), reverse=True)
                                 if p in failure.TOLERANCE)
            for method, part in cells.groupby("method")}


def finding(cells, dimension, least):
    good, passed = answered(cells)
    if not len(good):
        return Finding(f"In {dimension}D no pair query has both a time and an error.")
    rows = found_by_method(good, passed, least)
    clean, count = [row["method"] for row in rows if row["outcome"] == "never fails"], good["method"].nunique()
    if not passed.any():
        head = f"In {dimension}D every timed pair query fails somewhere, judged at {tolerances(good)}."
    else:
        most = max((row["fastest on"] + row["ties for fastest on"] for row in rows), default=0)
        first = [row["method"] for row in rows if row["fastest on"] + row["ties for fastest on"] == most]
        pairs = good[passed].groupby("pair")["method"].nunique()
        rivals = int((pairs > 1).sum())
        these = "of these" if set(first) <= set(clean) else "without failures"
        head = (f"In {dimension}D {len(clean)} of {count} methods never fail at {tolerances(good)}" +
                (f"; {these}, {some(first)} {verb(len(first), 'are')} fastest or tied on {most} of "
                 f"{plural(rivals, 'pair of shapes', 'pairs of shapes')}." if rivals else "; no two on one pair of shapes."))
    table = pd.DataFrame(rows)
    return Finding(head, cut(table if table["only method on"].any() else table.drop(columns="only method on")))


def found_by_method(good, passed, least):
    """A row per method: on how many pairs of shapes it is the fastest among the methods without a failure there."""
    count = {method: [0, 0, 0] for method in good["method"]}  # fastest, tied, only one
    for _, part in good[passed].groupby("pair", sort=True):
        first = [cell["method"] for cell in noise.leaders(part, TIME, least)]
        for method in first:
            count[method][2 if len(part) == 1 else 0 if len(first) == 1 else 1] += 1
    judged, rows = judged_at(good), []
    for method, part in good.groupby("method", sort=True):
        failing = int((failure.in_pairs(part) > 0).sum())
        errors = metrics.column(part, "max_error")
        rows.append({"method": method, "outcome": f"fails on {failing} of {plural(len(part), 'pair')}" if failing else
                     "never fails", "fastest on": count[method][0], "ties for fastest on": count[method][1],
                     "only method on": count[method][2],
                     "worst error over the size [1]": np.nanmax(errors) if np.isfinite(errors).any() else math.nan,
                     "judged at": judged.get(method, "")})
    return sorted(rows, key=lambda row: (row["outcome"] != "never fails", -row["fastest on"] - row["ties for fastest on"],
                                         -row["only method on"], row["method"]))


def headline(cells, dimension, least):
    """Where methods fail: the failing pair of shapes that most methods answer. Where none fails: the pair on which the times of
    the fastest and the slowest differ most, if by more than the noise."""
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
    first = [cell["method"] for cell in noise.leaders(right, TIME, least)]
    text = (f"On {pair} in {dimension}D {len(wrong)} of {len(cells)} methods fail, on {shares} of the queries; fastest without a "
            f"failure {verb(len(first), 'are')} {some(first)} ({si(right[TIME].iloc[0], 'ns')}).")
    return Headline(text, {**dict(zip(right["method"], right[TIME])), **dict.fromkeys(wrong["method"], math.nan)}, "ns",
                    "time per query")


def _told_times(cells, dimension, least):
    """Of pairs of shapes on which times differ by more than the noise, the one with the largest ratio."""
    found = []
    for pair, part in cells.groupby("pair", sort=True):
        part = part.sort_values(TIME, kind="stable")
        first, last = part.iloc[0], part.iloc[-1]
        if len(part) > 1 and noise.tells(first, last, TIME, least):
            found.append((last[TIME] / first[TIME], pair, part))
    if not found:
        return None
    ratio, pair, part = max(found, key=lambda told: told[:2])
    first = [cell["method"] for cell in noise.leaders(part, TIME, least)]
    return Headline(f"In {dimension}D no method fails; times differ most on {pair}, where {part['method'].iloc[-1]} takes "
                    f"{times(ratio)} times the {si(part[TIME].iloc[0], 'ns')} of {some(first)}"
                    f"{' (tie)' if len(first) > 1 else ''}.", dict(zip(part["method"], part[TIME])), "ns", "time per query")


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
    # A pair that a method does not declare is not a failure; the next chart has a cell for it.
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
    handles.append(Line2D([], [], color="#222222", lw=2.4, alpha=0.3, label="Pareto front, no failures"))
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
                 "Lower left is better. A mark is the 99th percentile of the error over the size (largest extent + distance + "
                 "largest coordinate); its bar spans the median to the worst. A time is that of a single query and two readings "
                 f"of the clock. Hollow marks are witnesses. {noise.rule(least)} {failure.DEFINITION} Methods that fail are on "
                 "no Pareto front. Trials with a looser tolerance are judged by theirs.",
                 headline=headline(cells, dimension, least))


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
    handles += [Patch(facecolor=colour, label=f"{text}: {'not declared' if outcome == 'unsupported' else outcome}")
                for outcome, (colour, text) in sorted(outcomes.items())]
    blank = len(rows) < len(pairs) * len(methods)
    handles += [Patch(facecolor=NOT_ASKED, label="blank: not asked")] if blank else []
    figure.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 0), ncol=len(handles), handlelength=1.2)
    return Chart(f"{cells['sweep'].iloc[0]}_failures_{dimension}d", SECTION, f"Rate of failures by pair of shapes, {dimension}D",
                 finding_of_failures(cells[_usable(cells)], bad, dimension), cells["sweep"].iloc[0], figure, pd.DataFrame(rows),
                 _holes(cells),
                 "A cell is the share of the queries that fail; the number of queries of each pair of shapes stands beside each "
                 f"name. “Unseen share, at most” bounds the failures of a method without any, with 95 %. {failure.DEFINITION}")


def finding_of_failures(good, bad, dimension):
    """`bad`: (rate, method, pair, failures, queries) of each cell with a failure."""
    asked = metrics.column(good, "asked")
    good, worst, judged = good[asked > 0], {}, judged_at(good)
    for one in sorted(bad):
        worst[one[1]] = one
    rows = []
    for method, part in good.groupby("method", sort=True):
        n, text = part["asked"], " to ".join(dict.fromkeys(f"{x:,.0f}" for x in (part["asked"].min(), part["asked"].max())))
        rate, _, pair, found, number = worst.get(method, (0.0, method, "", 0, n.min()))
        rows.append({"method": method, "worst share [1]": rate,
                     "failures there": f"{found:,.0f} of {number:,.0f}" if found else "none", "on": pair,
                     "unseen share, at most": "" if found else failure.share(3 / n.min()), "queries of a pair": text,
                     "judged at": judged.get(method, "")})
    rows.sort(key=lambda row: (row["worst share [1]"], row["method"]))
    count, clean = len(rows), [row["method"] for row in rows if row["failures there"] == "none"]
    if not rows:
        head = f"In {dimension}D no query was answered."
    elif not bad:
        head = f"In {dimension}D no query of {np.nansum(asked):,.0f} fails, judged at {tolerances(good)}."
    else:
        rate, *_, found, number = max(bad)
        first, pairs = (sorted({one[at] for one in bad if one[0] == rate}) for at in (1, 2))
        head = fits(*(f"In {dimension}D {len(clean)} of {count} methods never fail at {tolerances(good)}; {some(first)} "
                      f"{verb(len(first), 'fail')} most often{on}: {share_of(found, number)}."
                      for on in (f", on {some(pairs)}", "")))
    return Finding(head, cut(pd.DataFrame(rows)))


WHAT = ("dimension", "pair", "vertices", "drawing")  # axes of a question; other axes that vary are added


@of_sweeps("peers", 71, SECTION,
           Needs("pairs", metrics=(TIME, "max_error"), also="one of LPC's methods and a witness on the same pairs of shapes"),
           "LPC and packaged libraries", "This store has no timed sweep of LPC's methods and witnesses on equal pairs of shapes.",
           "pair_queries")
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
    """One entry per question that one of LPC's methods answers without a failure and that a witness answers at all."""
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
    """The fastest of the row's libraries without a failure, or None."""
    return next((peer for peer in row["peers"] if peer["share"] == 0), None)


def _outcome(row):
    """Of LPC's fastest against the fastest library without a failure; where every library fails, against the fastest."""
    peer = right(row)
    if peer is None:
        quick = any(p["ratio"] < 1 and p["told"] for p in row["peers"])
        return "every library fails, one is faster" if quick else "every library fails, none is faster"
    if peer["told"]:
        return "LPC faster" if peer["ratio"] > 1 else "LPC slower"
    few = any(0 < len(measured.runs(cell, TIME)) < noise.FEWEST for cell in (row["ours"], peer["cell"]))
    return told(noise.FEW if few else noise.NOISE)


def finding_of_peers(rows):
    """A row per outcome, with the range of the ratios and the question where the ratio is farthest from 1."""
    groups = {}
    for row in rows:
        peer = right(row) or min(row["peers"], key=lambda p: p["ratio"])
        groups.setdefault(_outcome(row), []).append((peer["ratio"], row["what"], row["ours"]["method"], peer["name"]))
    table = []
    for outcome, found in sorted(groups.items()):
        _, what, ours, name = max(found, key=lambda one: abs(math.log(one[0])))
        ratios = [one[0] for one in found]
        table.append({"outcome": outcome, "questions": len(found), "library over LPC, least [1]": min(ratios),
                      "most [1]": max(ratios), "largest difference on": what, "LPC's method": ours, "library": name})
    count = {outcome: len(found) for outcome, found in groups.items()}
    failing = sum(n for outcome, n in count.items() if outcome.startswith("every"))
    ties = sum(n for outcome, n in count.items() if outcome.startswith("tie"))
    head = (f"Against the fastest library without failures LPC is faster on {count.get('LPC faster', 0)} of "
            f"{plural(len(rows), 'question')}, slower on {count.get('LPC slower', 0)}, tied on {ties}" +
            (f"; on {failing} every library fails." if failing else "."))
    return Finding(head, pd.DataFrame(table))


def headline_of_peers(rows):
    """The question with the largest ratio, either way, between LPC's fastest and the fastest library without a failure."""
    told = [(row, right(row)) for row in rows if right(row) and right(row)["told"]]
    if not told:
        return None
    row, peer = max(told, key=lambda found: abs(math.log(found[1]["ratio"])))
    first, last = sorted((row["ours"], peer["cell"]), key=lambda cell: cell[TIME])
    return Headline(f"On {row['what']}, {last['method']} takes {times(float(last[TIME] / first[TIME]))} times as long as "
                    f"{first['method']}; neither fails.", {first["method"]: first[TIME], last["method"]: last[TIME]}, "ns",
                    "time per query")


def _chart(context, cells, rows, refused):
    sweep = cells["sweep"].iloc[0]
    names = sorted({peer["name"] for row in rows for peer in row["peers"]})
    legend_width = legend_room(list(map(context.name, names)) + ["hollow: fails"], 2.0)
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
    ax.set_xlabel("time of the library over that of LPC's fastest method without failures (named on the left)")
    handles = [Line2D([], [], ls="none", marker=looks(n).get("marker", "o"), mec=looks(n)["color"], mfc=looks(n)["color"],
                      label=context.name(n)) for n in names]
    handles.append(Line2D([], [], ls="none", marker="o", mec="#555555", mfc="none", label="hollow: fails"))
    legend_right(figure, handles, legend_width)
    return Chart(identifier(f"{sweep} peers"), SECTION, f"LPC and packaged libraries: {sweep}", finding_of_peers(rows), sweep,
                 figure, _table(rows), refused,
                 "Right of the line LPC is faster. Both answer one query at a time, between two readings of the clock, which are "
                 f"in the time. A library runs in a separate process. {failure.DEFINITION}",
                 headline=headline_of_peers(rows))


def _table(rows):
    pairs = [(row, peer) for row in rows for peer in row["peers"]]
    return pd.DataFrame({"question": [row["what"] for row, _ in pairs],
                         "LPC's method": [row["ours"]["method"] for row, _ in pairs],
                         **quantity("time of LPC", "ns", [row["ours"][TIME] for row, _ in pairs]),
                         "library": [peer["name"] for _, peer in pairs],
                         **quantity("time of the library", "ns", [peer["cell"][TIME] for _, peer in pairs]),
                         "ratio [1]": [peer["ratio"] for _, peer in pairs],
                         "failures [1]": [peer["cell"]["failures"] for _, peer in pairs],
                         "asked [1]": [peer["cell"]["asked"] for _, peer in pairs]})
