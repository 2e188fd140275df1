# SPDX-License-Identifier: Zlib
"""Breaking points by single runs: a scene parameter (a stack's height, a mass ratio) or the time step is raised until each method
fails. All methods have one setting or, in a calibrated sweep, the setting that meets a budget at each value."""

import math

import numpy as np
import pandas as pd
from matplotlib.patches import Patch, Rectangle

import metrics
import ranking
from chart import Chart, Headline, Needs, describe, holes, identifier, of_sweeps
from finding import ROWS, Finding, Line, cut
from finding import ranked as by_rank
from load import JOINED, one_machine, split
from sentences import listing, methods, some, verb
from style import OUTCOMES, WIDTH, grid_of_axes, plt, si
from table import quantity

FALLS = "When does each method fall?"
BRIGHT = ("ok", "not run", "sank", "frozen", "collapsed", "wrong", "unsupported")  # outcomes with dark letters
FEWEST = 3  # values of a raised parameter


@of_sweeps("breaking_points", 40, FALLS,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), calibrated=None),
           "Breaking points", "This store has no sweep that raises a parameter.", "breaking_points_stack")
def breaking_points(context, cells):
    parts = split(cells, ["dimension"] if "dimension" in cells else [], sort=True)
    made = [(part, ladders(context, part)) for part in parts]
    return [_points_chart(context, part, found, int(part["dimension"].iloc[0]) if "dimension" in part else 2)
            for part, found in made if found]


def ladders(context, cells):
    """[(scene, raised axis, setting or budget as text, cells)]: one ladder per scene, raised axis and budget. All other axes have
    their most frequent value."""
    about, found = context.store.sweep(cells["sweep"].iloc[0]).calibrate, []
    for part in split(cells, ["scene", "budget"] if about else ["scene"], sort=bool(about)):
        raised = [axis for axis in context.parameters(part) if part[axis].nunique() >= FEWEST]
        for name in raised:
            held = part
            for other in {*context.parameters(part), *context.settings(part)} - {name, about.get("setting")}:
                held = held[held[other].map(str) == held[other].map(str).mode().iloc[0]]
            found.append((str(part["scene"].iloc[0]), name, _spent(context, about, held), held[held[name].notna()]))
    return found


def _spent(context, about, held):
    """The budget or setting of a ladder as text; empty if the sweep has none."""
    if about:
        value, unit = held["budget"].iloc[0], context.unit(about["metric"])
        return f"{si(value, unit)} {'' if unit == '1' else 'of '}{context.title(about['metric'])}"
    roles = context.store.sweep(held["sweep"].iloc[0]).roles
    settings = [axis for axis, role in roles.items() if role == "setting" and axis in held and held[axis].nunique() == 1]
    return listing(f"{axis}={held[axis].dropna().iloc[0]:g}" for axis in settings) if settings else ""


def breaking(ladder, name, excused):
    """Per method: the largest value that held before the first failure, the first value that failed, and why a cell up to there
    has no rank (`excused`: {index: why})."""
    rows = []
    for method, part in ladder.groupby("method", sort=True):
        part = part.sort_values(name)
        held, fell, outcome, step, why = math.nan, math.nan, "", math.nan, []
        for index, row in part.iterrows():
            why += [excused[index]] if index in excused else []
            if row["outcome"] == "ok":
                held = row[name]
            elif row["outcome"] not in ("not run", "unsupported"):
                fell, outcome, step = row[name], row["outcome"], row["step"]
                break
        hole = part["outcome"].isin(["not run", "unsupported"]).all()
        rows.append((method, held, fell, outcome, step, hole, ranking.largest(why)))
    return pd.DataFrame(rows, columns=["method", "held", "fell", "outcome", "step", "hole", "not ranked"])


def ranked(table):
    """The methods that were run and have a rank."""
    return table[~table["hole"].astype(bool) & (table["not ranked"] == "")]


def _value(name, value):
    if math.isnan(value):
        return ""
    if name == "dt":
        return si(value, "s")
    return f"{value:,.0f}" if value >= 1000 else f"{value:g}"


def words(scene, name, table, dimension, spent=""):
    """One ladder in one sentence."""
    known, everyone = ranked(table), list(table["method"])
    where, at = f"On {scene} in {dimension}D{f' with {spent}' if spent else ''}", lambda value: f"{name} = {_value(name, value)}"
    if not len(known):
        return f"{where} {'nothing was run' if table['hole'].all() else 'no method has a rank'}."
    fallen, stood, top = known[known["fell"].notna()], known[known["fell"].isna()], known["held"].max()
    if not len(fallen):
        return f"{where} nothing fails up to {at(known['held'].min())}."
    first = fallen[fallen["fell"] == fallen["fell"].min()]["method"]
    if len(first) == len(known):  # one value tells no methods apart
        return (f"{where} {'all' if len(known) > 1 else 'the only one of'} {len(known)} methods fail at "
                f"{at(fallen['fell'].min())}{', the smallest value tried' if math.isnan(top) else ', and hold below'}.")
    whole = stood[stood["held"] == top]["method"]
    last = whole if len(whole) else fallen[fallen["fell"] == fallen["fell"].max()]["method"]
    text = f"{where} {some(first, everyone)} {verb(len(first), 'fail')} first, at {at(fallen['fell'].min())}; "
    if len(whole):
        return f"{text}{some(last, everyone)} {verb(len(last), 'hold')} to the largest value tried, {_value(name, top)}."
    return f"{text}{some(last, everyone)} {verb(len(last), 'fail')} last, at {_value(name, fallen['fell'].max())}."


def lines_of(name, table, everyone, most):
    """Rows of the finding's table for one ladder, from the best to the worst; methods with equal results share a row."""
    unit, rows = "s" if name == "dt" else "1", []
    known = ranked(table).assign(held=lambda t: t["held"].fillna(-math.inf), fell=lambda t: t["fell"].fillna(math.inf))
    for (held, fell, outcome), part in known.groupby(["held", "fell", "outcome"], sort=False):
        end = outcome or ("holds to the last value tried" if held == known["held"].max() else "no result beyond")
        rows.append((held, fell, {"methods": methods(part["method"], everyone),
                                  **quantity("largest that holds", unit, [held if held > -math.inf else math.nan]),
                                  **quantity("first that fails", unit, [fell if fell < math.inf else math.nan]), "outcome": end}))
    rows.sort(key=lambda row: row[:2], reverse=True)
    why = {row["method"]: f"not ranked: {row['not ranked']}" if row["not ranked"] else "not run"
           for _, row in table.iterrows() if row["hole"] or row["not ranked"]}
    made = [{name: values[0] if isinstance(values, list) else values for name, values in row.items()} for *_, row in rows]
    made += [{"methods": line.name, "outcome": line.outcome} for line in ranking.lines(why)]
    return cut(pd.DataFrame(made), range(len(rows), len(made)), most)


def headline(name, table, text):
    """For the first screen: how far each method holds; none if the first to fail holds as far as any."""
    known = ranked(table)
    fallen, held = known[known["fell"].notna()], dict(zip(known["method"], known["held"]))
    top = known["held"].max()
    if not len(fallen) or top != top or top in set(fallen[fallen["fell"] == fallen["fell"].min()]["held"]):
        return None
    return Headline(text, held, "s" if name == "dt" else "1", f"largest {name} that holds", larger=True)


def _points_chart(context, cells, found, dimension):
    rows_of, excused, called = sorted(cells["method"].unique()), ranking.excused(context, cells), ranking.names(context, cells)
    columns = min(3, len(found))
    rows = math.ceil(len(found) / columns)
    left, legend_width, gap_x = max(1.75, 0.3 + 0.078 * max(map(len, called.values()))), 2.0, 0.85
    row_height, gap_y, top, bottom = 0.27 * len(rows_of) + 0.1, 1.15, 0.65, 0.65
    height = top + bottom + rows * row_height + (rows - 1) * gap_y
    figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, height), squeeze=False)
    cell_width = (WIDTH - left - legend_width - (columns - 1) * gap_x) / columns
    figure.subplots_adjust(left=left / WIDTH, right=1 - legend_width / WIDTH, top=1 - top / height,
                           bottom=bottom / height, wspace=gap_x / cell_width, hspace=gap_y / row_height)
    seen, told, tables, lines = set(), [], [], []
    for index, ax in enumerate(axes.flat):
        if index >= len(found):
            ax.set_visible(False)
            continue
        scene, name, spent, ladder = found[index]
        table = breaking(ladder, name, excused)
        text = words(scene, name, table, dimension, spent)
        told.append((headline(name, table, text), text))
        part = lines_of(name, table, rows_of, max(1, ROWS // len(found)))
        if len(found) > 1:
            part.insert(0, "scene, parameter, setting", [", ".join(filter(None, (scene, name, spent)))] * len(part))
        lines.append(part)
        tables.append(table.assign(scene=scene, raised=name, spent=spent))
        seen |= _strips(ax, ladder, name, rows_of, table, called if index % columns == 0 else {})
        ax.set_title(f"{scene}, {dimension}D: {name} raised" + (f"\n{spent}" if spent else ""))
    handles = [Patch(facecolor=OUTCOMES.get(o, OUTCOMES["not run"])[0], edgecolor="#999999",
                     label=f"{OUTCOMES.get(o, ('', '?'))[1]}  {o}".strip()) for o in OUTCOMES if o in seen]
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(1 - (legend_width - 0.65) / WIDTH, 0.97),
                  borderaxespad=0, handlelength=1.2)
    table = pd.concat(tables)
    table["unit"] = ["s" if raised == "dt" else "" for raised in table["raised"]]
    table = table[["scene", "raised", "unit", "spent", "method", "held", "fell", "outcome", "step", "not ranked"]]
    table = table.rename(columns={"held": "largest that held", "fell": "first that failed"})
    first, text = max(told, key=lambda pair: pair[0].effect if pair[0] else 0)  # the ladder with the largest difference
    return Chart(f"{cells['sweep'].iloc[0]}_raised_{dimension}d", FALLS, f"Breaking points, {dimension}D",
                 Finding(text, cut(pd.concat(lines, ignore_index=True))), cells["sweep"].iloc[0], figure, table,
                 holes(cells[cells["outcome"].isin(["not run", "unsupported", "timeout", "crash", "out_of_memory"])],
                       ["scene", "method", *sorted({name for _, name, *_ in found}), *(["budget"] if "budget" in cells else [])]),
                 "A square is one run, so no interval is known; the map of breaking points has one, over seeds. Right of a row: "
                 "the largest value that held before the first failure."
                 + equal_words(context.store.sweep(cells["sweep"].iloc[0]).calibrate), headline=first)


def equal_words(about):
    """For the note: at which setting or budget methods are compared."""
    if not about:
        return " All methods have the setting in the title of a panel; their costs differ."
    how = "the most within the budget" if about["equal"] == "cost" else "the fewest with an error within the budget"
    left = about["equal"] == "cost" and about.get("most")
    return (f" Methods are compared at equal {about['equal']}: at each value the runner gives each method {about['setting']}, "
            f"{how}{f', at most {left:g}' if left else ''}.")


def _strips(ax, ladder, name, rows_of, table, called):
    values = sorted(ladder[name].unique())
    seen = set()
    by = table.set_index("method")
    for y, method in enumerate(rows_of):
        part = ladder[ladder["method"] == method]
        for x, value in enumerate(values):
            rows = part[part[name] == value]
            outcome = rows["outcome"].iloc[0] if len(rows) else None
            if outcome is None:  # not planned: this method's ladder is shorter
                continue
            seen.add(outcome)
            colour, letter = OUTCOMES.get(outcome, ("#FFFFFF", "?"))
            ax.add_patch(Rectangle((x - 0.5, y - 0.42), 1, 0.84, facecolor=colour, lw=1,
                                   edgecolor="#BBBBBB" if outcome == "not run" else "white",
                                   hatch="///" if outcome == "not run" else None))
            ax.text(x, y, letter, ha="center", va="center", fontsize=8,
                    color="black" if outcome in BRIGHT else "white")
        if method in by.index and not by["hole"][method]:
            held = by["held"][method]
            text = "none held" if math.isnan(held) else _value(name, held)
            ax.text(len(values) - 0.4, y, text, va="center", fontsize=8, color="#333333")
    ax.set_xlim(-0.5, len(values) - 0.5)
    ax.set_ylim(len(rows_of) - 0.4, -0.6)
    ax.set_xticks(range(len(values)))
    labels = [_value(name, v).replace(" ", "\n") if name == "dt" else _value(name, v) for v in values]
    # Long ladders get every second label, so that none overlap. A digit needs 0.08 inches, and a gap.
    room = ax.get_position().width * ax.figure.get_figwidth() / len(values)
    every = max(1, math.ceil((0.08 * max(len(part) for label in labels for part in label.split("\n")) + 0.08) / room))
    ax.set_xticklabels([label if i % every == 0 else "" for i, label in enumerate(labels)])
    ax.set_yticks(range(len(rows_of)))
    ax.set_yticklabels([called[m] for m in rows_of] if called else [])
    ax.tick_params(length=0)
    ax.grid(False)
    ax.set_xlabel("dt: time step" if name == "dt" else name)
    for side in ax.spines.values():
        side.set_visible(False)
    return seen


CACHES = "Does the cache matter more than the resolver?"
DRIFT = "lean"


@of_sweeps("cache_solver", 41, CACHES,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), calibrated=None,
                 also="several caches under several resolvers, and a parameter that is raised"),
           "Cache x resolver", "This store has no sweep of caches under several resolvers.", "cache_solver")
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
            made.append(_caches_chart(context, part, raised, groups, refused))
    return made


def heights(part, raised, excused):
    """({(resolver, cache): largest value that held before the first failure}, {(resolver, cache): why it has no rank}). The value
    is 0 if the smallest failed; pairs that were not run are missing."""
    found, unranked = {}, {}
    for pair, cells in part.groupby(["resolver of pair", "cache"], sort=True):
        row = breaking(cells, raised, excused).iloc[0]
        if row["not ranked"]:
            unranked[pair] = row["not ranked"]
        elif not row["hole"] and not (math.isnan(row["held"]) and math.isnan(row["fell"])):
            found[pair] = 0.0 if math.isnan(row["held"]) else float(row["held"])
    return found, unranked


def effects(found, of):
    """How much the largest value that holds changes if only the cache (`of` 1) or only the resolver (0) changes: for each of the
    others, the largest less the smallest."""
    others = {}
    for pair, height in found.items():
        others.setdefault(pair[1 - of], []).append(height)
    return [max(values) - min(values) for values in others.values() if len(values) > 1]


def finding_of_caches(found, unranked, raised, where, top):
    out = ranking.lines({f"{resolver} with {cache}": f"not ranked: {why}" for (resolver, cache), why in sorted(unranked.items())})
    groups = {}
    for (resolver, cache), height in sorted(found.items()):
        groups.setdefault(height, []).append(f"{resolver} with {cache}")
    lines = [Line(listing(pairs), height) if height else Line(listing(pairs), outcome="failed: at the smallest value tried")
             for height, pairs in groups.items()]
    cache, resolver = effects(found, 1), effects(found, 0)
    if cache and resolver:
        lines += [Line(f"change by another {name}", float(np.median(values)), min(values), max(values), "median change")
                  for name, values in (("cache", cache), ("resolver", resolver))]
    lines += out
    table = by_rank(lines, f"largest {raised} that holds", "1", larger=True, name="resolver and cache",
                    keep=[line.name for line in lines if line.outcome])
    if not found or not max(found.values()):
        return Finding(f"On {where} " + ("every pair fails at the smallest value tried." if found else
                                         "no pair has a rank." if unranked else "nothing was run."), table)
    if not cache or not resolver:
        best = max(found.values())
        return Finding(f"On {where} {some(groups[best])} {verb(len(groups[best]), 'hold')} to {raised} = {best:g}"
                       f"{', the largest value tried' if best == top else ''}.", table)
    a, b = float(np.median(cache)), float(np.median(resolver))
    more = "cache and resolver matter alike" if a == b else f"the {'cache' if a > b else 'resolver'} matters more"
    return Finding(f"On {where} {more}: another cache changes the largest {raised} that holds by {a:g}, another resolver by "
                   f"{b:g} (medians).", table)


def headline_of_caches(found, raised, where):
    """For the first screen: the resolver that another cache changes most."""
    rows = {}
    for (resolver, cache), height in found.items():
        rows.setdefault(resolver, {})[cache] = height
    rows = {resolver: row for resolver, row in sorted(rows.items()) if len(row) > 1 and max(row.values()) > min(row.values())}
    if not rows:
        return None
    resolver = max(rows, key=lambda name: max(rows[name].values()) - min(rows[name].values()))
    row = rows[resolver]
    most, least = max(row, key=row.get), min(row, key=row.get)
    falls = f"to {row[least]:g}" if row[least] else "at no value tried"
    return Headline(f"On {where} {resolver} holds to {raised} = {row[most]:g} with the cache {most}, and {falls} with {least}.",
                    {f"{resolver} / {cache}": height or math.nan for cache, height in row.items()}, "1",
                    f"largest {raised} that holds", larger=True)


def _caches_chart(context, part, raised, groups, refused):
    where = describe(part.iloc[0], [c for c in groups if c != "budget"])
    about = context.store.sweep(part["sweep"].iloc[0]).calibrate
    if about and "budget" in part:
        spent = part["budget"].iloc[0]
        text = f"{spent:,.0f} " if context.unit(about["metric"]) == "1" else si(spent, context.unit(about["metric"])) + " of "
        where += f", at {text}{context.title(about['metric'])}"
    found, unranked = heights(part, raised, ranking.excused(context, part))
    values = sorted(part[raised].dropna().unique())
    # Drift and cost are shown at the value at which most pairs hold.
    standing = {value: int((part[part[raised] == value]["outcome"] == "ok").sum()) for value in values}
    at = max(values, key=lambda value: (standing[value], value))
    costs = [name for name in context.metrics("world", "cost") if np.isfinite(metrics.column(part, name)).any()]
    panels = [(f"largest {raised} that holds", "Blues", lambda pair, cell: found.get(pair, math.nan), "1", False)]
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
    return Chart(identifier(f"{part['sweep'].iloc[0]} {where}"), CACHES, f"Cache x resolver: {where}",
                 finding_of_caches(found, unranked, raised, where, values[-1]), part["sweep"].iloc[0], figure,
                 _table(context, found, unranked, here, resolvers, caches, raised, at, costs, whole),
                 refused + holes(part[part["outcome"].isin(["not run", "unsupported", "timeout", "crash", "out_of_memory"])],
                                 ["method", raised]),
                 f"Left: the largest {raised} that holds before the first failure; a dash if the smallest ({values[0]:g}) fails. "
                 f"The other panels: drift and cost at {raised} = {at:g}, where most pairs hold; a letter is the outcome of a "
                 "failed run."
                 + (" A white square has no rank: its resolver left that share of rows to Gauss-Seidel (GS)."
                    if unranked else "") + equal_words(about),
                 headline=headline_of_caches(found, raised, where))


def _map(ax, numbers, here, unranked, resolvers, caches, colours, unit, log):
    """A square with its number for each pair; darker is larger."""
    known = [v for v in numbers.values() if math.isfinite(v) and (v > 0 or not log)]
    scale = (lambda v: math.log10(max(v, min(known)))) if log else float
    low, high = (scale(min(known)), scale(max(known))) if known else (0.0, 1.0)
    low, high = (low, max(high, low + 0.5)) if log else (min(low, 0.0), high)  # a few percent get the same colour
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
             f"largest {raised} that holds": [found.get(pair, math.nan) for pair in pairs],
             "not ranked": [unranked.get(pair, "") for pair in pairs],
             f"outcome at {raised} = {at:g}": ["not run" if row is None else row["outcome"] for row in rows]}
    if setting:
        table[f"{setting} at {raised} = {at:g}"] = [math.nan if row is None else row[setting] for row in rows]
    for name in dict.fromkeys((DRIFT, *costs[:2])):
        table |= quantity(f"{context.title(name)} at {raised} = {at:g}", context.unit(name),
                          [math.nan if row is None else row[name] for row in rows])
    return pd.DataFrame(table)
