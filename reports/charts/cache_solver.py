# SPDX-License-Identifier: Zlib
"""Every cache under every resolver: how far a parameter of the scene can be raised (a stack's height) before the run fails, and
what it drifts and costs. Which of the two choices matters more?"""

import math

import numpy as np
import pandas as pd
from matplotlib.patches import Rectangle

import metrics
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, methods, of_sweeps
from charts.breaking_points import FEWEST, breaking, equal_words
from load import JOINED, one_machine, split
from style import OUTCOMES, grid_of_axes, plt, si
from table import quantity

SECTION = "Does the cache matter more than the resolver?"
DRIFT = "lean"
NAMED = 4  # pairs in a sentence; more are counted


@of_sweeps("cache_solver", 41, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), calibrated=None,
                 also="several caches under several resolvers, and a parameter that is raised"),
           "Cache x resolver", "No sweep of caches under several resolvers is in this store.", "cache_solver")
def cache_solver(context, cells):
    axes = [axis for axis in context.store.method_axes(cells["sweep"].iloc[0]) if axis != "cache"]
    if "cache" not in cells or cells["cache"].nunique() < 2 or not axes:
        return []
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, [DRIFT]))
    cells["resolver of pair"] = [JOINED.join(str(row[axis]) for axis in axes) for _, row in cells.iterrows()]
    if cells["resolver of pair"].nunique() < 2:
        return []
    groups, made = [c for c in ("scene", "dimension", "budget") if c in cells], []
    for part in split(cells, groups, sort=True):
        raised = next((axis for axis in context.parameters(part) if part[axis].nunique() >= FEWEST), None)
        if raised:
            made.append(_chart(context, part, raised, groups, refused))
    return made


def heights(part, raised, excused):
    """({(resolver, cache): the largest value that held before the first failure}, {...: why the pair has no rank}); 0 where the
    smallest fell, and nothing where nothing ran."""
    found, unranked = {}, {}
    for pair, cells in part.groupby(["resolver of pair", "cache"], sort=True):
        row = breaking(cells, raised, excused).iloc[0]
        if row["not ranked"]:
            unranked[pair] = row["not ranked"]
        elif not row["hole"] and not (math.isnan(row["held"]) and math.isnan(row["fell"])):
            found[pair] = 0.0 if math.isnan(row["held"]) else float(row["held"])
    return found, unranked


def effects(found, of):
    """How much the height changes when one of the two is changed alone, the cache (`of` 1) or the resolver (0): of each of the
    others the largest less the smallest."""
    others = {}
    for pair, height in found.items():
        others.setdefault(pair[1 - of], []).append(height)
    return [max(values) - min(values) for values in others.values() if len(values) > 1]


def finding(found, unranked, raised, where, top):
    out = ranking.told({f"{resolver} with {cache}": why for (resolver, cache), why in sorted(unranked.items())})
    if not found:
        return f"On {where} {'no pair has a rank' if unranked else 'nothing was run'}.{out}"
    best = max(found.values())
    pairs = [f"{resolver} with {cache}" for (resolver, cache), height in sorted(found.items()) if height == best]
    if not best:
        return f"On {where} every pair falls already at the smallest {raised} tried.{out}"
    highest = methods(pairs, []) if len(pairs) <= NAMED else f"{len(pairs)} of {len(found)} pairs"
    text = (f"On {where} {highest} {'stands' if len(pairs) == 1 else 'stand'} to {raised} = {best:g}"
            f"{', the largest tried' if best == top else ''}.")
    cache, resolver = effects(found, 1), effects(found, 0)
    if not cache or not resolver:
        return text + out
    def said(values):
        return (f"{min(values):g} to {max(values):g} (median {np.median(values):g})" if min(values) < max(values) else
                f"{values[0]:g}")
    text += f" Another cache alone changes that by {said(cache)}. Another resolver alone changes it by {said(resolver)}."
    a, b = float(np.median(cache)), float(np.median(resolver))
    return text + (" By the medians both choices matter alike." if a == b else
                   f" By the medians the {'cache' if a > b else 'resolver'} matters more.") + out


def headline(found, raised, where):
    """The resolver that another cache changes most."""
    rows = {}
    for (resolver, cache), height in found.items():
        rows.setdefault(resolver, {})[cache] = height
    rows = {resolver: row for resolver, row in sorted(rows.items()) if len(row) > 1 and max(row.values()) > min(row.values())}
    if not rows:
        return None
    resolver = max(rows, key=lambda name: max(rows[name].values()) - min(rows[name].values()))
    row = rows[resolver]
    most, least = max(row, key=row.get), min(row, key=row.get)
    falls = f"to {row[least]:g}" if row[least] else "to none that was tried"
    return Headline(f"On {where}, {resolver} stands to {raised} = {row[most]:g} with the cache {most} and {falls} with {least}.",
                    {f"{resolver} / {cache}": height or math.nan for cache, height in row.items()}, "1",
                    f"largest {raised} that stands", larger=True)


def _chart(context, part, raised, groups, refused):
    where = describe(part.iloc[0], [c for c in groups if c != "budget"])
    about = context.store.sweep(part["sweep"].iloc[0]).calibrate
    if about and "budget" in part:
        spent = part["budget"].iloc[0]
        text = f"{spent:,.0f} " if context.unit(about["metric"]) == "1" else si(spent, context.unit(about["metric"])) + " of "
        where += f", at {text}{context.title(about['metric'])}"
    found, unranked = heights(part, raised, ranking.excused(context, part))
    values = sorted(part[raised].dropna().unique())
    # Where most pairs stand, drift and cost are of all of them.
    standing = {value: int((part[part[raised] == value]["outcome"] == "ok").sum()) for value in values}
    at = max(values, key=lambda value: (standing[value], value))
    costs = [name for name in context.metrics("world", "cost") if np.isfinite(metrics.column(part, name)).any()]
    panels = [(f"largest {raised} that stands", "Blues", lambda pair, cell: found.get(pair, math.nan), "1", False)]
    for name, colours in ((DRIFT, "Oranges"), *((cost, "Greys") for cost in costs[:1])):
        panels.append((f"{context.title(name)}, {raised} = {at:g}", colours,
                       lambda _, cell, name=name: math.nan if cell is None or cell["outcome"] != "ok" else float(cell[name]),
                       context.unit(name), True))
    resolvers, caches = sorted(part["resolver of pair"].unique()), sorted(part["cache"].unique())
    here = {(row["resolver of pair"], row["cache"]): row for _, row in part[part[raised] == at].iterrows()}
    left = 0.35 + 0.078 * max(map(len, resolvers))
    figure, axes = grid_of_axes(1, len(panels), 0.3 * len(resolvers), 0.0, left=left, gap_x=0.35, bottom=0.95)
    for ax, (title, colours, value_of, unit, log) in zip(axes[0], panels):
        numbers = {(r, c): value_of((r, c), here.get((r, c))) for r in resolvers for c in caches}
        _map(ax, numbers, here, unranked if ax is axes[0][0] else {}, resolvers, caches, colours, unit, log)
        ax.set_title(title)
        ax.set_yticklabels(resolvers if ax is axes[0][0] else [])
    whole = about.get("setting", "") if about else ""
    return Chart(identifier(f"{part['sweep'].iloc[0]} {where}"), SECTION, f"Cache x resolver: {where}",
                 finding(found, unranked, raised, where, values[-1]), part["sweep"].iloc[0], figure,
                 _table(context, found, unranked, here, resolvers, caches, raised, at, costs, whole),
                 refused + holes(part[part["outcome"].isin(["not run", "unsupported", "timeout", "crash", "out_of_memory"])],
                                 ["method", raised]),
                 f"A row is one resolver, a column one cache. Left the largest {raised} that stands before the first failure, a "
                 f"dash where the smallest tried ({values[0]:g}) falls; beside it what a run at {raised} = {at:g}, where most "
                 "pairs stand, has drifted and costs, with the letter of its outcome where it fell."
                 + (" A white square has no rank: up to its height the resolver left so many rows to Gauss-Seidel (GS)."
                    if unranked else "") + equal_words(about),
                 headline=headline(found, raised, where))


def _map(ax, numbers, here, unranked, resolvers, caches, colours, unit, log):
    """A square for each pair, the darker the larger its number, with the number in it."""
    known = [v for v in numbers.values() if math.isfinite(v) and (v > 0 or not log)]
    scale = (lambda v: math.log10(max(v, min(known)))) if log else float
    low, high = (scale(min(known)), scale(max(known))) if known else (0.0, 1.0)
    low, high = (low, max(high, low + 0.5)) if log else (min(low, 0.0), high)  # a few per cent are no other colour
    for y, resolver in enumerate(resolvers):
        for x, cache in enumerate(caches):
            value, cell = numbers[resolver, cache], here.get((resolver, cache))
            if math.isfinite(value):
                share = 0.85 * (scale(value) - low) / (high - low) if high > low and known else 0.3
                face, ink = plt.get_cmap(colours)(share), "white" if share > 0.55 else "black"
                text = si(value, unit) if log else f"{value:g}" if value else "–"
            elif (resolver, cache) in unranked:
                face, ink, text = "white", "#C0392B", unranked[resolver, cache].replace("Gauss-Seidel", "GS")
            else:
                outcome = "not run" if cell is None else cell["outcome"]
                face, text = OUTCOMES.get(outcome, ("#FFFFFF", "?"))
                ink, text = ("white" if outcome in ("exploded", "diverged", "timeout", "crash") else "black"), text or "?"
            edge = "#BBBBBB" if face == "white" else "white"
            ax.add_patch(Rectangle((x - 0.48, y - 0.47), 0.96, 0.94, facecolor=face, edgecolor=edge, lw=0.8))
            ax.text(x, y, text, ha="center", va="center", fontsize=8, color=ink)
    ax.set_xlim(-0.5, len(caches) - 0.5)
    ax.set_ylim(len(resolvers) - 0.5, -0.5)
    ax.set_xticks(range(len(caches)), caches, rotation=30, ha="right", rotation_mode="anchor")
    ax.set_yticks(range(len(resolvers)))
    ax.tick_params(length=0)
    ax.grid(False)
    for side in ax.spines.values():
        side.set_visible(False)


def _table(context, found, unranked, here, resolvers, caches, raised, at, costs, setting):
    pairs = [(resolver, cache) for resolver in resolvers for cache in caches]
    rows = [here.get(pair) for pair in pairs]
    table = {"resolver": [resolver for resolver, _ in pairs], "cache": [cache for _, cache in pairs],
             f"largest {raised} that stands": [found.get(pair, math.nan) for pair in pairs],
             "not ranked": [unranked.get(pair, "") for pair in pairs],
             f"outcome at {raised} = {at:g}": ["not run" if row is None else row["outcome"] for row in rows]}
    if setting:
        table[f"{setting} at {raised} = {at:g}"] = [math.nan if row is None else row[setting] for row in rows]
    for name in dict.fromkeys((DRIFT, *costs[:2])):
        table |= quantity(f"{context.title(name)} at {raised} = {at:g}", context.unit(name),
                          [math.nan if row is None else row[name] for row in rows])
    return pd.DataFrame(table)
