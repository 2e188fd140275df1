# SPDX-License-Identifier: Zlib
"""How runs fall: pictures of the last run to fall of each kind, with energy and penetration. Which methods hold hard scenes."""

import math

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

import metrics
import noise
import ranking
import rest
from chart import Chart, Headline, Needs, describe, holes, identifier, of_sweeps
from finding import Finding, cut
from load import described, one_machine, split, varying
from sentences import listing, methods, plural, some, verb
from style import OUTCOMES, WIDTH, plt, si, times
from table import quantity

SECTION = "When does each method fall?"
SERIES = ("kinetic", "potential", "max_penetration")
FALLEN = {"collapsed": "a body is farther from its start than the scene allows",
          "exploded": "a body is faster than the scene allows, or than light",
          "diverged": "a number is not finite, or the energy exceeds the scene's limit"}
BLUE, WINE, GREEN = "#0072B2", "#882255", "#009E73"
# Inches. A row has words, pictures, lines from the pictures to their steps, and two panels over the same steps.
LEFT, RIGHT, TALLEST, BETWEEN = 0.85, 1.7, 1.9, 0.08
WORDS, FAN, PANEL, GAP, FOOT = 0.62, 0.28, 0.85, 0.12, 0.62
LEAST = 60  # least steps of a panel
MOST_PATCHES = 400  # of a picture drawn as vectors; more would only make the page larger


@of_sweeps("falls", 45, SECTION,
           Needs("world", series=SERIES, also="a run that fell", calibrated=None),
           "How runs fall", "No run of this store fell: nothing collapsed, exploded or diverged.", "breaking_points_stack")
def falls(context, cells):
    runs = runs_of(context.store, cells)
    fallen = runs[runs["outcome"].isin(FALLEN)]
    fallen = fallen[[row["outcome"] != "collapsed" or not stood(context.store, row) for _, row in fallen.iterrows()]]
    if not len(fallen):
        return []
    groups = [part for _, part in fallen.groupby(fallen[["scene", "dimension", "outcome"]].apply(tuple, axis=1), sort=False)]
    drawn, left_out = [], []
    for part in groups:
        films = [(row, context.store.film(row["key"])) for _, row in part.sort_values("step", ascending=False,
                                                                                      kind="stable").iterrows()]
        row, film = next(((row, film) for row, film in films if film), (None, None))
        if film:
            drawn.append((row, film, part))
        else:
            left_out.append(f"{describe(part.iloc[0], ['scene', 'dimension'])}, {part.iloc[0]['outcome']}: "
                            f"{plural(len(part), 'run')}, not drawn")
    return [_falls_chart(context, cells, runs, fallen, drawn, left_out)]


def stood(store, run):
    """Whether a run reached its last step and failed there by creeping, so no step shows its fall."""
    steps = store.trials["canonical"][run["key"]].get("steps")
    return steps is not None and run["step"] == run["step"] and run["step"] >= steps


def runs_of(store, cells):
    """One row per run of these cells (each seed of each cell), with its outcome."""
    rows = []
    for _, cell in cells.iterrows():
        for seed, key in zip(cell["seeds"], cell["keys"]):
            if key is not None and store.trials["outcome"][key] != "unsupported":
                trial = store.trials.loc[key]
                axes = cell.to_dict()
                rows.append({**axes, "dimension": axes.get("dimension", 2), "key": key, "outcome": trial["outcome"],
                             "reason": trial["reason"], "step": trial["step"],
                             **({"seed": seed} if len(cell["seeds"]) > 1 else {})})
    return pd.DataFrame(rows, columns=None if rows else ["outcome"])


def _falls_chart(context, cells, runs, fallen, drawn, left_out):
    sweep = cells["sweep"].iloc[0]
    counts = fallen["outcome"].value_counts()
    kinds = [outcome for outcome in FALLEN if outcome in counts]
    text = f"{len(fallen)} of {plural(len(runs), 'run')} " + (
        kinds[0] if len(kinds) == 1 else f"fell: {listing(f'{counts[kind]} {kind}' for kind in kinds)}")
    crept = int(runs["outcome"].isin(FALLEN).sum()) - len(fallen)
    text += f"; {crept} more failed at {'its' if crept == 1 else 'their'} last step by creeping." if crept else "."
    if not drawn:
        return Chart(f"{sweep}_falls", SECTION, "How runs fall", text, sweep, holes=left_out + [
            "The store has no pictures of these runs. The command of this sweep makes them, except for scenes of more than 300 "
            "bodies."])
    names = ["scene", "dimension", "method", *varying(context.store, cells, ("scene", "dimension", "method")), "seed"]
    heights = [WORDS + _tall(film) + FAN + 2 * PANEL + GAP + FOOT for _, film, _ in drawn]
    figure, top, table = plt.figure(figsize=(WIDTH, sum(heights))), sum(heights), []
    for height, (row, film, alike) in zip(heights, drawn):
        tracks = _tracks(context.store, row["key"])
        where = ranking.beside(describe(row, [name for name in names if name in row]), _share(context, cells, row))
        _row(figure, top, row, film, tracks, where)
        top -= height
        table.append({"run": where, "outcome": row["outcome"], "step": row["step"], "reason": row["reason"],
                      "runs of this kind": len(alike), "energy at the start [J]": _first(tracks["energy"]),
                      "largest energy [J]": _largest(tracks["energy"]),
                      "largest penetration of contacts [m]": _largest(tracks["contacts"]),
                      "largest penetration of shapes [m]": _largest(tracks["shapes"]),
                      "which": _rank(row["step"] == alike["step"].max(), len(alike))})
    table = pd.DataFrame(table)
    short = table[["run", "outcome", "step", "which"]].assign(step=table["step"].astype(int)).rename(
        columns={"which": "of the runs alike"})
    short["largest depth [m]"] = table[[name for name in table if name.startswith("largest penetration")]].max(axis=1)
    means = "; ".join(f"{name}: {FALLEN[name]}" for name in dict.fromkeys(table["outcome"]))
    return Chart(f"{sweep}_falls", SECTION, "How runs fall", Finding(text, cut(short)), sweep, figure,
                 table.drop(columns="which"), holes=left_out,
                 note="Each row is the last run of a scene and dimension that fell, at most six of a sweep "
                      f"({means}). Pictures: the start, the fall, and between them the last steps at which a body is 60 %, "
                      "30 % and 10 % of the largest distance from its last position; the last step in sight if a body leaves "
                      "the view. Energy is kinetic and gravitational.")


def _share(context, cells, run):
    """The share of rows that the cell of this run left to Gauss-Seidel, as text; empty if it is 0."""
    own = cells[[run["key"] in keys for keys in cells["keys"]]]
    share = ranking.share_of_fallbacks(context, own.iloc[0]) if len(own) else 0.0
    return ranking.said_of_share(share) if share != 0 else ""


def _rank(last, count):
    if count == 1:
        return "the only one"
    return f"the last of {count}" if last else f"one of {count}"


def _tall(film):
    """Height of the pictures (inches)."""
    wide = (WIDTH - LEFT - RIGHT - BETWEEN * (len(film["pictures"]) - 1)) / len(film["pictures"])
    return min(TALLEST, wide * (film["height"] - film["top"]) / film["width"])


def _tracks(store, key):
    """The series of a run by content; None if it has none."""
    kinetic, potential, contacts = (store.series(key, name) for name in SERIES)
    shapes = store.series(key, "penetration_poses") if described(store.described_series, "penetration_poses") else None
    energy = None if kinetic is None or potential is None else kinetic + potential
    return {"energy": energy, "motion": kinetic, "contacts": contacts, "shapes": shapes}


def _finite(values):
    return np.array([]) if values is None else values[np.isfinite(values)]


def _first(values):
    values = _finite(values)
    return float(values[0]) if len(values) else math.nan


def _largest(values):
    values = _finite(values)
    return float(values.max()) if len(values) else math.nan


def window(steps):
    """The steps that the panels show: twice the span from the second picture to the fall, at least LEAST."""
    start, end = steps[min(1, len(steps) - 1)], steps[-1]
    return max(0, end - max(2 * (end - start), LEAST)), end


def _row(figure, top, row, film, tracks, where):
    wide, high = figure.get_size_inches()
    tall, pictures = _tall(film), film["pictures"]
    colour, steps = OUTCOMES[row["outcome"]][0], [picture["step"] for picture in pictures]
    figure.text(LEFT / wide, (top - 0.2) / high, where, weight="bold", fontsize=9.5)
    figure.text(LEFT / wide, (top - 0.38) / high, f"{row['outcome']} at step {row['step']:.0f}: {row['reason']}", fontsize=8.5)
    column = (wide - LEFT - RIGHT + BETWEEN) / len(pictures)
    one = tall * film["width"] / (film["height"] - film["top"])
    bottom = top - WORDS - tall
    middles = []
    for index, picture in enumerate(pictures):
        left = LEFT + index * column
        ax = figure.add_axes([left / wide, bottom / high, min(one, column) / wide, tall / high])
        paint(ax, film, picture, colour if index == len(pictures) - 1 else "#BBBBBB")
        ax.set_title(f"step {picture['step']}, {picture['time']:.2f} s", fontsize=8, pad=2, loc="left")
        middles.append(left + min(one, column) / 2)
    first, last = window(steps)
    panels, at = [], bottom - FAN - PANEL
    for _ in range(2):
        panels.append(figure.add_axes([LEFT / wide, at / high, (wide - LEFT - RIGHT) / wide, PANEL / high]))
        at -= PANEL + GAP
    _energy(panels[0], tracks, first)
    _depth(panels[1], tracks, first)
    room = 0.01 * (last - first)
    for ax in panels:
        ax.set_xlim(first - room, last + room)
        ax.tick_params(labelsize=7.5)
        for step in steps[:-1]:
            ax.axvline(step, color="#BBBBBB", lw=0.8)
        ax.axvline(row["step"], color=colour, lw=1.4, ls="--")
    panels[0].tick_params(labelbottom=False)
    panels[0].text(1.012, 0.1, f"{row['outcome']} at {row['step']:.0f}", transform=panels[0].transAxes, color=colour, fontsize=8)
    panels[1].set_xlabel("step", fontsize=8)
    for middle, step in zip(middles, steps):  # a line from each picture to its step
        if step >= first:
            x = LEFT + (wide - LEFT - RIGHT) * (step - first + room) / (last - first + 2 * room)
            figure.add_artist(Line2D([middle / wide, x / wide], [bottom / high, (bottom - FAN) / high], lw=0.8,
                                     color=colour if step == steps[-1] else "#BBBBBB"))


def paint(ax, film, picture, frame):
    """Draws the patches of a picture, in pixels with y down."""
    corners = [np.reshape(patch[2], (-1, 2)) for patch in picture["patches"]]
    ax.add_collection(PolyCollection(corners, facecolors=[patch[0] for patch in picture["patches"]],
                                     edgecolors=[patch[1] for patch in picture["patches"]], linewidths=0.5,
                                     rasterized=len(corners) > MOST_PATCHES))
    ax.set_xlim(0, film["width"])
    ax.set_ylim(film["height"], film["top"])
    ax.set_facecolor("#F7F7F5")
    ax.set(xticks=[], yticks=[])
    if not any(_moves(patch[0]) for patch in picture["patches"]):
        ax.text(0.5, 0.5, "out of sight", transform=ax.transAxes, ha="center", va="center", fontsize=8, color="#555555")
    for spine in ax.spines.values():
        spine.set(visible=True, color=frame, linewidth=1.2)


def _moves(fill):
    """Whether this is the colour of a body that may move; static bodies are grey."""
    shades = [int(fill[i:i + 2], 16) for i in (1, 3, 5)]
    return max(shades) - min(shades) > 10


def _line(ax, values, first, **look):
    """Draws the part of a series in the panel's steps; entry i is the value after step i + 1. True if it has a number."""
    values = np.array([]) if values is None else np.asarray(values, float)
    steps = np.arange(1, len(values) + 1)
    shown = np.isfinite(values) & (steps >= first)
    ax.plot(steps[shown], values[shown], **look)
    return bool(shown.any())


def _every(values):
    """The number of steps between the values of a series."""
    gaps = np.diff(np.flatnonzero(np.isfinite(values)))
    return int(np.median(gaps)) if len(gaps) else len(values)


def _words(ax, height, text, colour="#555555"):
    ax.text(1.012, height, text, transform=ax.transAxes, color=colour, fontsize=8, va="top")


def _energy(ax, tracks, first):
    """Draws the kinetic energy and the change of the total energy within the panel; its absolute value depends on the origin."""
    energy, motion = tracks["energy"], tracks["motion"]
    shown = _finite(None if energy is None else energy[max(0, first - 1):])
    drawn = {"motion": motion, "change": None if energy is None or not len(shown) else energy - shown[0]}
    largest = max([_largest(None if v is None else np.abs(v[max(0, first - 1):])) for v in drawn.values()], key=np.nan_to_num)
    unit, scale = next(((unit, scale) for unit, scale in (("MJ", 1e6), ("kJ", 1e3)) if largest >= 10 * scale), ("J", 1.0))
    ax.set_ylabel(f"energy [{unit}]", fontsize=8)
    scaled = {name: None if v is None else v / scale for name, v in drawn.items()}
    if _line(ax, scaled["change"], first, color=BLUE, lw=1.3):
        _words(ax, 1.0, f"total, since step {max(1, first)}", BLUE)
    if _line(ax, scaled["motion"], first, color=WINE, lw=1.1):
        _words(ax, 0.78, "kinetic", WINE)


def _depth(ax, tracks, first):
    ax.set_ylabel("depth [m]", fontsize=8)
    if _line(ax, tracks["contacts"], first, color=BLUE, lw=1.3):
        _words(ax, 1.0, "deepest contact", BLUE)
    else:
        _words(ax, 1.0, "contacts: not reported")
    if _line(ax, tracks["shapes"], first, color=GREEN, lw=0, marker="o", ms=3.5):
        _words(ax, 0.78, f"shapes, every {_every(tracks['shapes'])} steps", GREEN)
    else:
        _words(ax, 0.78, "shapes: not measured")
    low, high = ax.get_ylim()
    ax.set_ylim(min(0, low), high + 0.08 * (high - min(0, low)))  # room for a whole dot at the top


TIME = "ms_per_step_median"
EXCUSE = "not ranked"  # column: why a cell has no rank
MOST_COLUMNS = 7


@of_sweeps("held", 42, SECTION,
           Needs("world", methods=(2, math.inf), also="a `report` that lists it"),
           "Methods that hold hard scenes", "This store has no sweep whose `report` lists this chart.", "beyond")
def held(context, cells):
    about = context.store.sweep(cells["sweep"].iloc[0])
    if "held" not in about.report:
        return []
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, ["lateral_max", "sag_end"]))
    axes = [axis for axis in ("scene", *varying(context.store, cells, ("scene", "dimension"))) if axis in cells]
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        part = part.assign(**{EXCUSE: part.index.map(ranking.excused(context, part)).fillna("")})
        columns = {describe(own.iloc[0], axes): own.drop_duplicates("method").set_index("method") for own in split(part, axes)}
        made.append(_held_chart(context, part, columns, about.baseline, refused))
    return made


def slower(column, method, baseline):
    """The time of a step over that of the baseline; NaN if one of them was not timed."""
    if TIME not in column or baseline not in column.index:
        return math.nan
    base = float(column[TIME][baseline])
    return float(column[TIME][method]) / base if base > 0 else math.nan


def share(cell):
    return rest.sunk(cell["outcome"], cell.get("sunk"))


def holders(column, limit=rest.LIMITS[0]):
    """Methods that hold and have a rank. The outcome uses the strictest limit."""
    own = column[column[EXCUSE] == ""]
    if limit == rest.LIMITS[0]:
        return sorted(own.index[own["outcome"] == "ok"])
    return sorted(m for m in own.index if share(own.loc[m]) <= limit)


def facts(where, column, baseline, everyone, least):
    """A row of the finding's table: one scene."""
    holding, before, sinks = holders(column), set(holders(column)), []
    for limit in rest.LIMITS[1:]:
        more = sorted(set(holders(column, limit)) - before)
        before |= set(more)
        if more:
            deep = limit if len(more) > 1 else float(f"{share(column.loc[more[0]]):.2g}")
            sinks.append(f"{methods(more, everyone)} by {'up to ' if len(more) > 1 else ''}{rest.percent(deep)}")
    own = column[column[EXCUSE] == ""]
    row = {"scene": where, "held by": "all methods" if len(holding) == len(column) else
           methods(holding, everyone) if holding else "none", "sinks": "; ".join(sinks),
           "fails": methods(sorted(set(own.index) - before), everyone) if set(own.index) - before else ""}
    timed = column.loc[[m for m in holding if m != baseline and math.isfinite(slower(column, m, baseline))]]
    if len(timed):
        first = sorted(cell["method"] for cell in noise.leaders(timed.reset_index(), TIME, least))
        row[f"cheapest besides {baseline}"] = methods(first, everyone) + (" (tie)" if len(first) > 1 else "")
        row[f"its time over that of {baseline}"] = f"{times(min(slower(column, m, baseline) for m in first))} times"
    row["remark"] = "; ".join(f"not ranked: {line.name} ({line.outcome})" for line in ranking.lines({
        m: f"{column[EXCUSE][m]}{'' if column['outcome'][m] == 'ok' else ', ' + column['outcome'][m]}"
        for m in column.index if column[EXCUSE][m]}))
    return row


def headline(columns, baseline, dimension):
    """For the first screen: the scene that fewest methods hold, if any does and others do not."""
    held = {where: holders(column) for where, column in columns.items() if holders(column)}
    where = min(held, key=lambda name: len(held[name]), default=None)
    if where is None or len(held[where]) == len(columns[where]):
        return None
    column, holding = columns[where], held[where]
    own = column[column[EXCUSE] == ""]
    if len(holding) == len(own):
        return None
    text = f"Only {some(holding, list(column.index))} {verb(len(holding), 'hold')} {where} in {dimension}D."
    values = {m: float(own["lateral_max"][m]) if m in holding else math.nan for m in own.index}
    return Headline(text, values, "m", "sideways drift")


def words(columns, dimension):
    """The headline where no scene tells methods apart."""
    held = sum(bool(holders(column)) for column in columns.values())
    every = sum(len(holders(column)) == len(column) for column in columns.values())
    scenes = plural(len(columns), "scene")
    if every == len(columns):
        return f"In {dimension}D every method holds each of {scenes}."
    return f"In {dimension}D {held or 'none'} of {scenes} {'is' if held < 2 else 'are'} held by a ranked method."


def _held_chart(context, part, columns, baseline, refused):
    everyone, dimension = sorted(part["method"].unique()), int(part["dimension"].iloc[0]) if "dimension" in part else 2
    sweep = part["sweep"].iloc[0]
    least = noise.floor_of(context, sweep, TIME)
    found = pd.DataFrame([facts(where, column, baseline, everyone, least) for where, column in columns.items()]).fillna("")
    found = found[[name for name in found if name in ("scene", "held by") or (found[name] != "").any()]]
    head = headline(columns, baseline, dimension)
    return Chart(identifier(f"{sweep} held {dimension}d"), SECTION, f"Methods that hold hard scenes, {dimension}D",
                 Finding(head.text if head else words(columns, dimension), cut(found)), sweep,
                 _figure(columns, everyone, baseline), _table(columns, everyone, baseline),
                 refused + holes(part, ["scene", "method"]),
                 "A cell is one run: the largest sideways motion of a body, the sag at the end, and the time of a step over that "
                 f"of {baseline}. A letter is the outcome of a failed run, with its step. {rest.WORDS}. S: by how much a run "
                 "sank, and the limit that it satisfies."
                 + (" A white cell has no rank: its method left rows to Gauss-Seidel, or its precision differs."
                    if (part[EXCUSE] != "").any() else ""), headline=head)


def _figure(columns, everyone, baseline):
    names = list(columns)
    blocks = [names[i:i + MOST_COLUMNS] for i in range(0, len(names), MOST_COLUMNS)]
    left, row, above, below = 0.3 + 0.078 * max(map(len, everyone)), 0.56, 0.6, 0.4  # inches
    height = sum(above + row * len(everyone) for _ in blocks) + below
    figure, y = plt.figure(figsize=(WIDTH, height)), height
    for block in blocks:
        y -= above + row * len(everyone)
        wide = (WIDTH - left - 0.15) * len(block) / min(MOST_COLUMNS, max(4, len(names)))
        ax = figure.add_axes((left / WIDTH, y / height, wide / WIDTH, row * len(everyone) / height))
        ax.set_xlim(0, len(block))
        ax.set_ylim(len(everyone), 0)
        for x, where in enumerate(block):
            for place, method in enumerate(everyone):
                _cell(ax, x, place, columns[where], method, baseline)
        ax.set_xticks([x + 0.5 for x in range(len(block))])
        ax.set_xticklabels([where.replace(", ", "\n") for where in block], fontsize=8.5)
        ax.xaxis.tick_top()
        ax.set_yticks([place + 0.5 for place in range(len(everyone))])
        ax.set_yticklabels(everyone)
        ax.tick_params(length=0)
        ax.grid(False)
        for side in ax.spines.values():
            side.set_visible(False)
    seen = [o for o in OUTCOMES if any((column["outcome"] == o).any() for column in columns.values())]
    handles = [Rectangle((0, 0), 1, 1, facecolor=OUTCOMES[o][0],
                         label=f"held, to {rest.percent(rest.LIMITS[0])}" if o == "ok" else f"{OUTCOMES[o][1]} {o}")
               for o in seen]
    figure.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.01, 0.0), ncol=len(handles), handlelength=1.0)
    return figure


def _cell(ax, x, y, column, method, baseline):
    if method not in column.index:
        return
    cell, ratio = column.loc[method], slower(column, method, baseline)
    face, mark = OUTCOMES.get(cell["outcome"], ("#FFFFFF", "?"))
    ink = "white" if cell["outcome"] in ("diverged", "timeout", "crash") and not cell[EXCUSE] else "black"
    ax.add_patch(Rectangle((x + 0.02, y + 0.04), 0.96, 0.92, facecolor="white" if cell[EXCUSE] else face,
                           lw=0.8 if cell[EXCUSE] else 0, edgecolor="#BBBBBB"))
    if cell["outcome"] == "ok":
        lines = [f"{si(float(cell['lateral_max']), 'm')} sideways", f"{si(float(cell['sag_end']), 'm')} sag"]
    elif cell["outcome"] == "sank":
        within = [limit for limit in rest.LIMITS if share(cell) <= limit]
        lines = [f"{mark} by {100 * share(cell):.2g} %",
                 f"holds to {rest.percent(within[0])}" if within else f"beyond {rest.percent(rest.LIMITS[-1])}"]
    else:
        lines = [mark + (f" at step {int(cell['step'])}" if cell["step"] == cell["step"] else "")]
    lines += [f"{times(ratio)} x the time"] if math.isfinite(ratio) and method != baseline else []
    lines += [cell[EXCUSE]] if cell[EXCUSE] else []
    for k, line in enumerate(lines):
        ax.text(x + 0.07, y + (k + 0.75) / (len(lines) + 0.5), line, ha="left", va="center", color=ink,
                fontsize=7.5 if len(lines) < 4 else 6.5)


def _table(columns, everyone, baseline):
    parts = []
    for where, column in columns.items():
        own = [m for m in everyone if m in column.index]
        part = {"scene": where, "method": own, "outcome": [column["outcome"][m] for m in own],
                "step": [column["step"][m] for m in own], EXCUSE: [column[EXCUSE][m] for m in own]}
        part |= quantity("sunk, of the smallest body", "1", [share(column.loc[m]) if share(column.loc[m]) < math.inf else
                                                             math.nan for m in own])
        part |= {f"held to {rest.percent(limit)}": ["yes" if share(column.loc[m]) <= limit else "no" for m in own]
                 for limit in rest.LIMITS}
        part |= quantity("sideways drift", "m", [column["lateral_max"][m] for m in own])
        part |= quantity("sag at the end", "m", [column["sag_end"][m] for m in own])
        part |= quantity(f"time over that of {baseline}", "1", [slower(column, m, baseline) for m in own])
        parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True)
