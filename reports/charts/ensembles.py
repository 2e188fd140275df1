# SPDX-License-Identifier: Zlib
"""One scene run from many perturbed starts (seeds): how often a method fails, and how far its errors spread."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from finding import AGAINST, BEST, ROWS, TIE, Finding, cut, fits, ratio
from load import split, varying
from sentences import plural, some, verb
from style import ZeroLog, grid_of_axes, legend_right, si
from table import quantity

SECTION = "Which ranks hold for slightly different starts?"
ERRORS = 2  # panels


@of_sweeps("ensembles", 25, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), also="several seeds"),
           "Ensembles", "No sweep over seeds is in this store.", "ensembles")
def ensembles(context, cells):
    cells = metrics.add(context.store, cells[cells["seeds"].map(len) > 1],
                        [*context.metrics("world", "error"), *set(metrics.BEYOND_SLOP.values())])
    if not len(cells):
        return []
    groups = [axis for axis in ("scene", "dimension") if axis in cells]
    return [_chart(context, part, describe(part.iloc[0], groups), telling(part, varying(context.store, part, groups)))
            for part in split(cells, groups)]


def telling(cells, axes):
    """The axes that distinguish the ensembles. An axis that is fixed by another one, such as a gap by `perturb`, is left out."""
    kept = []
    for axis in sorted(axes, key=lambda axis: axis != "perturb"):
        if not kept or (cells.groupby(kept)[axis].nunique() > 1).any():
            kept.append(axis)
    return kept


def candidates(part, error):
    """The ranked cells of one ensemble: most of their seeds finish."""
    return part[np.isfinite([np.median(measured.of_seeds(cell, error)) for _, cell in part.iterrows()])]


def ranks(part, error, zero):
    """(the cell with the least median, the methods that it does not beat significantly, itself among them) of one ensemble."""
    known = candidates(part, error)
    if not len(known):
        return None, []
    cells = [cell for _, cell in known.iterrows()]
    # Where most seeds end alike medians are equal: then the method that errs less under more seeds is the first.
    wins = [sum((v > 0) - (v < 0) for other in cells for v in ranking.log_ratios(mine, other, error, zero)) for mine in cells]
    order = sorted(range(len(cells)), key=lambda i: (max(float(np.median(measured.of_seeds(cells[i], error))), zero), -wins[i]))
    best, many = cells[order[0]], ranking.comparisons(len(cells))
    return best, [cells[i]["method"] for i in order if not ranking.better(best, cells[i], error, zero, many)]


def against(best, other, error, zero):
    """(seeds with the same error, seeds with the same final state) of another cell and the best of an ensemble."""
    states = sum(a == b and a is not None for a, b in zip(best["hashes"], other["hashes"]))
    return sum(v == 0 for v in ranking.log_ratios(best, other, error, zero)), states


def winners(part, error, zero):
    """The methods that no other beats significantly, where they beat at least one."""
    best, equals = ranks(part, error, zero)
    return [] if best is None or len(equals) == len(part) or ranking.overlapping(part) else equals


def found(context, where, groups, error, everyone):
    """The finding: the winner of each ensemble, and a table with a row per ensemble and method."""
    zero, what = context.floor(error), context.title(error).removeprefix("largest ")
    won, rows = [], []
    for place, part in groups:
        eligible, deep = ranking.eligible(context, part), ranking.overlapping(part)
        best, equals = ranks(eligible, error, zero)
        won.append((place, [] if deep or best is None else equals, best, deep, len(candidates(eligible, error))))
        rows.append(_rows(context, place, part, error, None if deep else best, [] if deep else equals, deep, len(groups) > 1))
    table = cut(pd.concat([cut(part, most=max(3, ROWS // len(rows))) for part in rows], ignore_index=True))
    seeds = max(len(seeds) for _, part in groups for seeds in part["seeds"])
    over = f"On {where}, over {seeds} seeds,"
    of = lambda equals, most=2: f"{some(equals, everyone, most)} {verb(len(equals), 'tie for', 'has')}"  # noqa: E731
    place, equals, best, deep, count = won[-1]
    here = f" at {place}" if len(won) > 1 else ""
    if deep:
        return Finding(f"On {where}{here} no method has a rank: bodies overlap by up to {si(deep, 'm')} at the start.", table)
    if best is None:
        return Finding(f"On {where}{here} every ranked method fails under at least half of the {seeds} seeds.", table)
    value = above(float(np.median(measured.of_seeds(best, error))), zero, context.unit(error))
    if len({tuple(sorted(found)) for _, found, *_ in won}) == 1:
        at = " at every perturbation" if len(won) > 1 and all("perturb=" in name for name, *_ in won) else (
            f" in all {len(won)} ensembles" if len(won) > 1 else "")
        all_tie = f"{over} all {count} ranked methods tie for the smallest {what}{at}."
        most = "at most " if len(won) > 1 else ""
        text = fits(f"{over} {of(equals)} the smallest {what}{at} (median {most}{value}).",
                    f"{over} {of(equals)} the smallest {what}{at}.")
        return Finding(all_tie if len(equals) == count > 2 else text, table)
    first = won[0]
    named = f"{of(first[1], 1)} the smallest {what} at {first[0]}" if first[1] else f"no method has a rank at {first[0]}"
    return Finding(fits(f"{over} {named}; {of(equals, 1)} it at {place} (median {value}).", f"{over} {named}; {of(equals, 1)} it "
                        f"at {place}.", f"{over} the ensembles differ in the method with the smallest {what}."), table)


def _rows(context, place, part, error, best, equals, deep, several):
    """The table's rows of one ensemble, from the best to the worst."""
    unit, zero, other = context.unit(error), context.floor(error), metrics.BEYOND_SLOP.get(error)
    why, what, rows = ranking.unranked(context, part), context.title(error), []
    firsts = ranks(ranking.eligible(context, part), other, context.floor(other))[1] if other in part and best is not None else []
    idle = bool(noise.idle_seeds(part))
    for _, cell in part.iterrows():
        method, of_seeds, seeds = cell["method"], measured.of_seeds(cell, error), len(cell["seeds"])
        median, failed = float(np.median(of_seeds)), cell["failed_seeds"]
        word = (f"not ranked: {why[method]}" if method in why else "not ranked: overlap at the start" if deep else
                "failed: most seeds" if not math.isfinite(median) else _word(best, cell, equals, error, zero, unit, median))
        low, high = noise.wilson(failed, seeds)
        row = {"ensemble": place} if several else {}
        row |= {"method": method, f"{what}, median [{unit}]": 0.0 if median <= zero else finite(median),
                f"{what}, worst [{unit}]": finite(max(of_seeds)), AGAINST: word, "failed seeds": f"{failed} of {seeds} "
                                                                                                 f"({100 * low:.0f} to "
                                                                                                 f"{100 * high:.0f} %)"}
        if idle:
            row["seeds"] = "change nothing"
        if other in part:
            value = float(np.median(measured.of_seeds(cell, other)))
            row |= {f"{context.title(other)}, median [{context.unit(other)}]": finite(value) * (value > context.floor(other)),
                    "beyond the slop": "best" if method in firsts and len(firsts) == 1 else "tie" if method in firsts else ""}
        rows.append(((word.startswith(("not", "failed")), median), row))
    return pd.DataFrame([row for _, row in sorted(rows, key=lambda pair: pair[0])])


def finite(value):
    return value if math.isfinite(value) else math.nan


def _word(best, cell, equals, error, zero, unit, median):
    """How a method stands to the best of its ensemble."""
    if best is None:
        return ""
    method, same, states = cell["method"], *against(best, cell, error, zero)
    if method == best["method"]:
        return BEST if len(equals) < 2 else f"{BEST}, {TIE}"
    if method not in equals:
        return ratio(median, float(np.median(measured.of_seeds(best, error))), zero, unit)
    alike = f"; same final state under {plural(states, 'seed')}" if states else ""
    return TIE + alike + (f"; same error under {plural(same, 'seed')}" if same > states else "")


def above(value, zero, unit):
    """A value in words; up to `zero` methods are not distinguished."""
    return si(value, unit) if value > zero or zero == 0 else f"below {si(zero, unit)}"


def entry(context, groups, error):
    """The entry of the first screen: the medians of the last ensemble, which is the widest. None where it has no winner or its
    seeds change nothing."""
    part = ranking.eligible(context, groups[-1][1])
    if not winners(part, error, context.floor(error)) or noise.idle_seeds(part):
        return None
    medians = {cell["method"]: float(np.median(measured.of_seeds(cell, error))) for _, cell in part.iterrows()}
    return Headline("", {m: v if math.isfinite(v) else math.nan for m, v in medians.items()}, context.unit(error),
                    f"{context.title(error)}, median of the seeds", ends=final_states(part))


def _chart(context, cells, where, inner):
    errors, looks = metrics.errors_of(context, cells)[:ERRORS], context.looks(cells)
    everyone = sorted(cells["method"].unique())
    groups = [(describe(part.iloc[0], inner) or where, part.sort_values("method")) for part in split(cells, inner, sort=True)]
    lines = sum(len(part) + 1 for _, part in groups)
    called = ranking.names(context, cells)
    longest = max(map(len, [*called.values(), *(place for place, _ in groups)]))
    left = max(1.2, 0.3 + 0.078 * longest)
    figure, axes = grid_of_axes(1, 1 + len(errors), 0.24 * lines + 0.1, 1.5, left=left, gap_x=0.5, bottom=0.55)
    for column, error in enumerate([None, *errors]):
        ax = axes[0][column]
        if error is None:
            ax.set_xlim(-4, 104)
            ax.set_title("seeds that failed (%)")
        else:
            all_values = [v for _, cell in cells.iterrows() for v in measured.of_seeds(cell, error)]
            scale = ZeroLog(ax, "x", all_values, context.unit(error), floor=context.floor(error))
            ax.set_title(context.title(error))
        y, ticks = 0, []
        for place, part in groups:
            if column == 0:
                ax.text(-0.04, y, place, transform=ax.get_yaxis_transform(), ha="right", va="center", fontsize=9,
                        fontweight="bold")
            y += 1
            for _, cell in part.iterrows():
                look = {**looks(cell["method"]), "linestyle": "none"}
                if error is None:
                    ends = noise.wilson(cell["failed_seeds"], len(cell["seeds"]))
                    ax.plot([100 * end for end in ends], [y, y], color=look["color"], lw=1.4, alpha=0.8)
                    ax.plot([100 * cell["failed_seeds"] / len(cell["seeds"])], [y], **look, zorder=3)
                else:
                    of_seeds = measured.of_seeds(cell, error)
                    ax.plot([scale.place(v) for v in of_seeds], [y] * len(of_seeds), ls="none", marker="|", ms=9,
                            color=look["color"], alpha=0.5, mew=0.8)
                    ax.plot([scale.place(v) for v in noise.interval(of_seeds)], [y, y], color=look["color"], lw=1.4, alpha=0.8)
                    ax.plot([scale.place(float(np.median(of_seeds)))], [y], **look, zorder=3)
                ticks.append((y, called[cell["method"]]))
                y += 1
        ax.set_ylim(y - 0.3, -0.7)
        ax.set_yticks([t for t, _ in ticks])
        ax.set_yticklabels([name for _, name in ticks] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
    legend_right(figure, [Line2D([], [], ls="none", marker="o", color="#555555", label="median"),
                          Line2D([], [], ls="none", marker="|", ms=9, color="#555555", label="one seed"),
                          Line2D([], [], color="#555555", label="its interval")], 1.5)
    compared = [len(candidates(ranking.eligible(context, part), errors[0])) for _, part in groups]
    certain = noise.certainty(int(cells["seeds"].map(len).min()))
    return Chart(identifier(f"{cells['sweep'].iloc[0]} ensemble {where}"), SECTION, f"Ensembles: {where}",
                 found(context, where, groups, errors[0], everyone), cells["sweep"].iloc[0], figure,
                 _table(context, cells, inner, errors), noise.idle_seeds(cells) + holes(cells, [*inner, "method"]),
                 "Each row is one method under all seeds; a failed seed is drawn at the edge. The bar beside the share of "
                 "failures "
                 "is Wilson's interval: with 95 % it holds the chance of a failure, also where none failed. "
                 f"The bar of an error holds its median with at least {certain} %, for any distribution. "
                 f"{ranking.rule(int(cells['seeds'].map(len).max()), *compared)}{ranking.raw(context, errors[0])}",
                 headline=entry(context, groups, errors[0]))


def _table(context, cells, inner, errors):
    errors = [*errors, *{metrics.BEYOND_SLOP[error] for error in errors if error in metrics.BEYOND_SLOP}]
    columns = {name: cells[name] for name in [*inner, "method", "outcome"]}
    columns |= {"seeds": cells["seeds"].map(len), "seeds that failed": cells["failed_seeds"]}
    chances = [noise.wilson(failed, len(seeds)) for failed, seeds in zip(cells["failed_seeds"], cells["seeds"])]
    for end, values in (("low end", [low for low, _ in chances]), ("high end", [high for _, high in chances])):
        columns |= quantity(f"chance of a failure, {end}", "1", values)
    for error in errors:
        of_seeds = [measured.of_seeds(cell, error) for _, cell in cells.iterrows()]
        ends = [noise.interval(v) for v in of_seeds]
        for name, values in (("median", [float(np.median(v)) for v in of_seeds]), ("low end", [low for low, _ in ends]),
                             ("high end", [high for _, high in ends]), ("worst", [max(v) for v in of_seeds])):
            columns |= quantity(f"{context.title(error)}, {name}", context.unit(error), values)
    return pd.DataFrame(columns).sort_values([*inner, "method"])
