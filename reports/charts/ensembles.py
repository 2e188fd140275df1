# SPDX-License-Identifier: Zlib
"""The same scene many times, each started a little beside the others: how often a method fails, and how far its errors spread."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import measured
import metrics
import noise
import ranking
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from load import split, varying
from sentences import does, listing, methods
from style import ZeroLog, grid_of_axes, legend_right, si
from table import quantity

SECTION = "Which ranks hold when a scene starts a little elsewhere?"
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
    """Of these axes those that tell ensembles apart: air that goes with the perturbation says nothing beside it."""
    kept = []
    for axis in sorted(axes, key=lambda axis: axis != "perturb"):
        if not kept or (cells.groupby(kept)[axis].nunique() > 1).any():
            kept.append(axis)
    return kept


def candidates(part, error):
    """The cells of one ensemble that may have a rank: most of their seeds finish."""
    return part[np.isfinite([np.median(measured.of_seeds(cell, error)) for _, cell in part.iterrows()])]


def ranks(part, error, zero):
    """(the best by the median, those that it does not beat beyond doubt) among the cells of one ensemble."""
    known = candidates(part, error)
    if not len(known):
        return None, []
    cells = [cell for _, cell in known.iterrows()]
    # Where most seeds end alike medians are equal: then whoever errs less than the others under more seeds stands first.
    wins = [sum((v > 0) - (v < 0) for other in cells for v in ranking.log_ratios(mine, other, error, zero)) for mine in cells]
    order = sorted(range(len(cells)), key=lambda i: (max(float(np.median(measured.of_seeds(cells[i], error))), zero), -wins[i]))
    best, many = cells[order[0]], ranking.comparisons(len(cells))
    return best, [cells[i]["method"] for i in order if not ranking.better(best, cells[i], error, zero, many)]


def against(best, other, error, zero):
    """Under how many seeds another cell errs as much as the best of an ensemble, and ends in the same state."""
    states = sum(a == b and a is not None for a, b in zip(best["hashes"], other["hashes"]))
    return sum(v == 0 for v in ranking.log_ratios(best, other, error, zero)), states


def winners(part, error, zero):
    """The methods that nobody beats beyond doubt, where they beat another."""
    best, equals = ranks(part, error, zero)
    return [] if best is None or len(equals) == len(part) or ranking.overlapping(part) else equals


def standing(part, best, equals, everyone, error, zero, what, value):
    """Who errs least in one ensemble, and what is known of those whom it does not beat beyond doubt."""
    rows, seeds = {cell["method"]: cell for _, cell in part.iterrows()}, len(best["seeds"])
    if len(equals) == 1:
        text = f"{best['method']} has the smallest {what} over {seeds} seeds (median {value})"
    else:
        text = f"{methods(equals, everyone)} tie for the smallest {what} over {seeds} seeds ({best['method']}: median {value})"
    alike = {}  # (errs as much, ends in the same state) under so many seeds -> who
    for method in equals:
        if method != best["method"]:
            alike.setdefault(against(best, rows[method], error, zero), []).append(method)
    for (same, states), found in alike.items():
        verb = "s" if len(found) == 1 else ""
        if states:
            text += (f"; {methods(found, everyone)} end{verb} in the same state as {best['method']} under {states} of {seeds} "
                     "seeds")
        if same > states:
            text += f"; {methods(found, everyone)} err{verb} as much as {best['method']} under {same} of {seeds} seeds"
    return text


def above(value, zero, unit):
    """A value, or that it is below what tells methods apart."""
    return si(value, unit) if value > zero or zero == 0 else f"below {si(zero, unit)}"


def finding(context, where, groups, error, everyone):
    unit, what, zero = context.unit(error), context.title(error).removeprefix("largest "), context.floor(error)
    said = []
    for place, part in groups:
        seeds, ranked = max(map(len, part["seeds"])), ranking.eligible(context, part)
        best, equals = ranks(ranked, error, zero)
        if best is None:
            said.append(f"{place}: every method fails under half of the {seeds} seeds or more")
            continue
        if deep := ranking.overlapping(part):
            said.append(f"{place}: no method has a rank, since bodies overlap by up to {si(deep, 'm')} at the start")
            continue
        worst = max(measured.of_seeds(best, error))
        value = (f"{above(float(np.median(measured.of_seeds(best, error))), zero, unit)}, worst "
                 f"{above(worst, zero, unit) if math.isfinite(worst) else 'a failure'}")
        text = f"{place}: {standing(ranked, best, equals, everyone, error, zero, what, value)}"
        text += beyond(context, ranked, error, everyone)
        fails = {}  # number of seeds -> who fails under so many
        for _, cell in part[part["failed_seeds"] > 0].iterrows():
            low, high = noise.wilson(cell["failed_seeds"], len(cell["seeds"]))
            count = f"{cell['failed_seeds']} of {len(cell['seeds'])} seeds (of all, {100 * low:.0f} to {100 * high:.0f} %)"
            fails.setdefault(count, []).append(cell["method"])
        under = [f"{does(who, 'fail', everyone)} under {count}" for count, who in fails.items()]
        said.append("; ".join([text, *under]) +
                    ("; the seeds change nothing: each method ends in one state" if noise.idle_seeds(part) else ""))
    return "; ".join(text.removeprefix(f"{where}: ") for text in said) + "."


def beyond(context, part, error, everyone):
    """Who stands first by what is deeper than the slop that each method keeps on purpose; empty where the error is no depth."""
    other = metrics.BEYOND_SLOP.get(error)
    if other is None or other not in part:
        return ""
    best, equals = ranks(part, other, context.floor(other))
    if best is None:
        return ""
    value = float(np.median(measured.of_seeds(best, other)))
    return (f"; beyond the slop that each keeps on purpose {does(equals, 'tie', everyone, one='is')} "
            f"first ({si(value if value > context.floor(other) else 0.0, context.unit(other))})")


def headline(context, where, groups, error, everyone):
    """Who is best beyond doubt, in each ensemble: what holds where bodies start far apart need not hold where they start
    close. The numbers are those of the widest ensemble; where it has no winner, or its seeds change nothing, there is none."""
    zero, what = context.floor(error), context.title(error).removeprefix("largest ")
    groups = [(place, ranking.eligible(context, part)) for place, part in groups]
    won = [(place, winners(part, error, zero)) for place, part in groups]
    part = groups[-1][1]
    if not won[-1][1] or noise.idle_seeds(part):
        return None
    medians = {cell["method"]: float(np.median(measured.of_seeds(cell, error))) for _, cell in part.iterrows()}
    places = {}  # who -> where; that nobody wins comes last
    for place, found in sorted(won, key=lambda one: not one[1]):
        places.setdefault(tuple(found), []).append(place)
    (winner, at), *further = ((methods(found, everyone) if found else "no method", listing(at)) for found, at in places.items())
    has = f"{winner} {'tie for' if len(next(iter(places))) > 1 else 'has'} the smallest {what}"
    first = f"On {where}, started in {max(map(len, part['seeds']))} places"
    if len(groups) == 1:
        text = f"{first}, {has}."
    else:
        others = "".join(f", {name} at {there}" for name, there in further)
        text = f"{first}, {has} at {at}{others} (the numbers: medians at {won[-1][0]})."
    return Headline(text, {m: v if math.isfinite(v) else math.nan for m, v in medians.items()}, context.unit(error),
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
                 f"On {where}, {finding(context, where, groups, errors[0], everyone)}"
                 f"{ranking.tail(context, cells)}", cells["sweep"].iloc[0], figure,
                 _table(context, cells, inner, errors), noise.idle_seeds(cells) + holes(cells, [*inner, "method"]),
                 "Each row is one method, started at as many places as there are seeds; a seed that failed stands at the edge. "
                 "The bar beside the share of failures is Wilson's interval: with 95 % it holds that of all places near the "
                 "start, and it is no point where none failed. "
                 f"The bar of an error holds its median with at least {certain} %, whatever the distribution. "
                 f"{ranking.rule(int(cells['seeds'].map(len).max()), *compared)}{ranking.raw(context, errors[0])}",
                 headline=headline(context, where, groups, errors[0], everyone))


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
