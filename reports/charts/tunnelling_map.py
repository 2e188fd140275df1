# SPDX-License-Identifier: Zlib
"""Bullets that tunnel through a wall: their share over speed and thickness, for each method of continuous collision, and the time
of a step against the baseline's."""

import math
import textwrap

import pandas as pd
from matplotlib.patches import Patch, Rectangle

import measured
import noise
from chart import Chart, Headline, Needs, describe, final_states, holes, identifier, of_sweeps
from finding import Finding, cut, fits
from finding import told as told_as
from load import one_machine, split, varying
from metrics import Trial
from sentences import plural, some
from style import NOT_ASKED, OUTCOMES, RIGHT, figures, grid_of_axes, si, times
from table import quantity

SECTION = "What passes through a wall, and what does it cost to stop it?"
AXES = ("speed", "thickness")
TIME = "ms_per_step_median"
MOST_COLUMNS = 5
ROW = 0.34  # inches of a row of cells
LEGIBLE = 0.27  # inches: least width of a cell with a number
SHARES = {0.1: "#FBE3CF", 0.25: "#F8C99E", 0.5: "#F0A35E", 0.75: "#DA6A2B", 1.0: "#9C2F14"}  # upper ends; 0 has its own colour
SLOWER = {1.2: "#ECE6F3", 1.5: "#DACDE8", 2.0: "#C4AEDA", 4.0: "#A98AC8", math.inf: "#8C68B3"}  # upper ends of ratios
FASTER = "#D5E9F5"
SIGNS = {noise.NOISE: "≈", noise.FEW: "?", noise.SAME_WORK: "="}
NOT_TOLD = {**noise.IN_WORDS, noise.SAME_WORK: "the same work by all counts"}


@of_sweeps("tunnelling_map", 43, SECTION,
           Needs("world", varies=AXES, also="a scene of `n` bullets, and a finished cell that counts the tunnelled ones"),
           "Tunnelling", "This store has no sweep of bullets at walls.", "continuous")
def tunnelling_map(context, cells):
    if "tunnelled" not in cells:  # an older store, without these counts
        return []
    cells, refused = one_machine(context.store, cells)
    cells = cells.assign(bullets=[bullets(context, cell) for _, cell in cells.iterrows()])
    cells["share"] = [share(cell) for _, cell in cells.iterrows()]
    if (cells["outcome"] == "ok").any() and not cells["share"].notna().any():
        return []
    others = [axis for axis in ("scene", "dimension") if axis in cells]
    others += varying(context.store, cells, (*AXES, *others))
    return [_chart(context, part, describe(part.iloc[0], others), refused) for part in split(cells, others, sort=True)]


def bullets(context, cell):
    """The number of bullets of a cell; NaN where it was not run."""
    return math.nan if cell["key"] is None else Trial(context.store, cell["key"]).parameter("n")


def share(cell):
    """The share of the bullets that tunnelled; with several seeds the largest."""
    if cell["outcome"] != "ok":
        return math.nan
    through = measured.seeds(cell, "tunnelled") or [float(cell["tunnelled"])]
    return max(through) / cell["bullets"]


def compared(cells, base, least):
    """{method: {(speed, thickness): (ratio to the baseline's time, the ratio in words or why there is none)}}"""
    def at(part):
        return {(cell["speed"], cell["thickness"]): cell for _, cell in part.iterrows() if cell["outcome"] == "ok"}
    firsts, found = at(cells[cells["method"] == base]), {}
    for method, part in cells[cells["method"] != base].groupby("method", sort=True):
        both = {spot: (firsts[spot], cell) for spot, cell in at(part).items() if spot in firsts}
        words = {spot: noise.said(*pair, TIME, least) for spot, pair in both.items()}
        found[method] = {spot: (noise.ratio(*both[spot], TIME), text) for spot, text in words.items() if text}
    return found


def worst_of(cells):
    """{method: its cell with the largest share}, the largest first, of methods with a finished cell."""
    good = cells[cells["share"].notna()]
    worst = {method: part.loc[part["share"].idxmax()] for method, part in good.groupby("method", sort=True)}
    return dict(sorted(worst.items(), key=lambda pair: -pair[1]["share"]))


def percent(part):
    return f"{figures(100 * part, 2)} %"


def finding(cells, ratios, where):
    """A row per method, the smallest share first; methods with a failed cell last."""
    rows, worst = [], worst_of(cells)
    for method, mine in cells.groupby("method", sort=True):
        done, cell = mine[mine["share"].notna()], worst.get(method)
        row = {"method": method, "largest share that tunnels [1]": math.nan if cell is None else float(cell["share"])}
        if cell is not None and cell["share"] > 0:
            row |= {"speed [m/s]": float(cell["speed"]), "thickness [m]": float(cell["thickness"])}
        row["cells with tunnelling"] = f"{int((done['share'] > 0).sum())} of {len(done)}"
        if any(ratios.values()):
            row["time of a step over the baseline's"] = _times_of(ratios.get(method))
        if "ghost_hits" in cells and (cells["ghost_hits"] > 0).any():
            row["ghost hits in a cell, most [1]"] = mine["ghost_hits"].max()
        row["outcome"] = f"no result in {len(mine) - len(done)} of {plural(len(mine), 'cell')}" if len(done) < len(mine) else ""
        rows.append(row)
    rows.sort(key=lambda row: (bool(row["outcome"]), row["largest share that tunnels [1]"], row["method"]))
    safe = [row["method"] for row in rows if row["largest share that tunnels [1]"] == 0 and not row["outcome"]]
    through = next(iter(worst.values()), None)
    head = f"no bullet tunnels with {some(safe, sorted(worst))}" if safe else "no method stops all bullets"
    passes = through is not None and through["share"] > 0
    head += f"; up to {percent(through['share'])} tunnel with the method {through['method']}." if passes else "."
    head = fits(f"{where}: {head}", head[0].upper() + head[1:])
    columns = dict.fromkeys(key for row in sorted(rows, key=len, reverse=True) for key in row)
    return Finding(head, cut(pd.DataFrame(rows, columns=list(columns))))


def _times_of(found):
    """The range of the ratios beyond the noise, and in how many cells there is none."""
    if found is None:
        return "baseline"
    told = [ratio for ratio, text in found.values() if text not in SIGNS]
    rest = " or ".join(dict.fromkeys(told_as(text) for _, text in found.values() if text in SIGNS))
    silent = f"{rest} in {len(found) - len(told)} of {plural(len(found), 'cell')}" if rest else ""
    return "; ".join(filter(None, (" to ".join(dict.fromkeys((times(min(told)), times(max(told))))) if told else "", silent)))


def headline(cells):
    """The largest share of each method, where they differ. A method with a failed cell has no number."""
    failed, worst = set(cells["method"][cells["share"].isna()]), worst_of(cells)
    most = {m: float(worst[m]["share"]) if m not in failed else math.nan for m in sorted(cells["method"].unique())}
    if len({v for v in most.values() if v == v}) < 2:
        return None
    return Headline("", most, quantity="largest share that tunnelled", ends=final_states(cells))


def _chart(context, cells, where, refused):
    sweep, base = cells["sweep"].iloc[0], context.baseline(cells)
    everyone = sorted(cells["method"].unique(), key=lambda m: (m != base, m))
    least = noise.floor_of(context, sweep, TIME)
    ratios = compared(cells, base, least)
    figure = _figure(context, cells, everyone, ratios, base)
    note = ("Greener is better. A column is a speed of the bullets, a row a thickness of the wall. A number is the percentage of "
            "bullets with a centre that came out at the far side, including bullets that the wall pushed out there. A letter "
            "is a failed run. ")
    if any(ratios.values()):
        signs = {text for found in ratios.values() for _, text in found.values()}
        note += (f"Below, the time of a step over that of {base} in the same cell. " + "".join(
            f"“{sign}”: {NOT_TOLD[text]}. " for text, sign in SIGNS.items() if text in signs) +
            "A bullet that tunnels makes no more contacts, so part of a method's extra time is the contacts that it keeps. " +
            noise.rule(least))
    where = where or "bullets at walls"
    return Chart(identifier(f"{sweep} tunnelling map {where}"), SECTION, f"Tunnelling: {where}",
                 finding(cells, ratios, where), sweep, figure, _table(context, cells, ratios, base),
                 refused + holes(cells, ["method", *AXES]), note, headline=headline(cells))


def _figure(context, cells, everyone, ratios, base):
    timed = any(ratios.values())
    blocks = [everyone[i:i + MOST_COLUMNS] for i in range(0, len(everyone), MOST_COLUMNS)]
    spots = [sorted(cells[axis].dropna().unique()) for axis in AXES]
    per = 2 if timed else 1
    figure, axes = grid_of_axes(per * len(blocks), max(3, len(blocks[0])), ROW * len(spots[1]), left=0.9, gap_x=0.22, gap_y=0.72,
                                top=0.5, bottom=0.95)
    for ax in axes.flat:
        ax.set_visible(False)
    seen = set()
    for row, block in enumerate(blocks):
        for column, method in enumerate(block):
            mine = cells[cells["method"] == method]
            ax = axes[per * row][column]
            _axes(ax, spots, column == 0, not timed)
            ax.set_title("\n".join(textwrap.wrap(context.name(method), 26)), fontsize=9.5)
            seen |= _shares(ax, mine, spots)
            if timed:
                ax = axes[per * row + 1][column]
                _axes(ax, spots, column == 0, True)
                _times(ax, mine, ratios.get(method), spots, base)
    handles = [Patch(facecolor=RIGHT, label="no bullet tunnels")]
    handles += [Patch(facecolor=colour, label=f"up to {percent(upper)}") for upper, colour in SHARES.items()]
    handles += [Patch(facecolor=OUTCOMES.get(o, OUTCOMES["not run"])[0], edgecolor="#999999",
                      label=f"{OUTCOMES.get(o, ('', '?'))[1]}  {o}".strip()) for o in [*OUTCOMES, *sorted(seen - set(OUTCOMES))]
                if o in seen]
    figure.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.01, 0.0), ncol=len(handles), columnspacing=1.2,
                  handlelength=1.2, handletextpad=0.5)
    return figure


def _axes(ax, spots, labelled, lowest):
    """Evenly spaced cells for each speed and thickness, whatever their distance."""
    ax.set_visible(True)
    ax.set_xlim(-0.5, len(spots[0]) - 0.5)
    ax.set_ylim(-0.5, len(spots[1]) - 0.5)
    ax.set_xticks(range(len(spots[0])))
    labels = [figures(float(v)) for v in spots[0]]
    every = max(1, math.ceil((0.075 * max(map(len, labels)) + 0.06) / _room(ax)))
    ax.set_xticklabels([label if i % every == 0 else "" for i, label in enumerate(labels)])
    ax.set_yticks(range(len(spots[1])))
    ax.set_yticklabels([si(float(v), "m") for v in spots[1]] if labelled else [])
    ax.set_ylabel("thickness" if labelled else "")
    ax.set_xlabel("speed, m/s" if lowest else "")
    ax.tick_params(length=0)
    ax.grid(False)
    for side in ax.spines.values():
        side.set_visible(False)


def _room(ax):
    """The width of a cell, in inches."""
    return ax.get_position().width * ax.figure.get_figwidth() / abs(ax.get_xlim()[1] - ax.get_xlim()[0])


def _cell(ax, x, y, colour, text, ink="black", **patch):
    ax.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=colour, **{"edgecolor": "white", "lw": 1, **patch}))
    if text and (_room(ax) >= LEGIBLE or len(text) == 1):
        ax.text(x, y, text, ha="center", va="center", fontsize=8, color=ink)


def _shares(ax, cells, spots):
    """Draws the shares of one method; returns the outcomes of its failed cells."""
    for _, cell in cells.iterrows():
        x, y = (places.index(cell[axis]) for axis, places in zip(AXES, spots))
        if cell["outcome"] != "ok":
            colour, letter = OUTCOMES.get(cell["outcome"], OUTCOMES["not run"])
            dark = cell["outcome"] in ("exploded", "diverged", "timeout", "crash")
            hole = {"edgecolor": "#BBBBBB", "hatch": "///"} if cell["outcome"] == "not run" else {}
            _cell(ax, x, y, colour, letter, "white" if dark else "black", **hole)
        elif math.isnan(cell["share"]):
            _cell(ax, x, y, NOT_ASKED, "")
        elif cell["share"] == 0:
            _cell(ax, x, y, RIGHT, "0", "#6E8F7C")
        else:
            upper = next((upper for upper in SHARES if cell["share"] <= upper), max(SHARES))
            _cell(ax, x, y, SHARES[upper], figures(100 * cell["share"], 2), "white" if upper > 0.5 else "black")
    return set(cells["outcome"]) - {"ok"}


def _times(ax, cells, ratios, spots, base):
    """Draws the baseline's time, or the ratios of another method to it."""
    if ratios is None:
        known = {(cell["speed"], cell["thickness"]): float(cell[TIME]) for _, cell in cells.iterrows() if cell["outcome"] == "ok"}
        known = {spot: ms for spot, ms in known.items() if math.isfinite(ms)}
        small = max(known.values(), default=0) < 1
        drawn = {spot: (NOT_ASKED, figures(1000 * ms if small else ms, 2 if ms >= 0.1 or small else 1))
                 for spot, ms in known.items()}
        ax.set_title(f"time of a step, {'µs' if small else 'ms'}", fontsize=8.5, color="#444444")
    else:
        drawn = {spot: (NOT_ASKED, SIGNS[text]) if text in SIGNS else
                 (FASTER if ratio < 1 else next(c for upper, c in SLOWER.items() if ratio <= upper),
                  times(ratio) if ratio < 9.95 else f"{ratio:,.0f}")
                 for spot, (ratio, text) in ratios.items()}
        ax.set_title(f"time over that of {base}", fontsize=8.5, color="#444444")
    for (speed, thickness), (colour, text) in drawn.items():
        _cell(ax, spots[0].index(speed), spots[1].index(thickness), colour, text,
              "white" if colour == SLOWER[math.inf] else "black")


def _table(context, cells, ratios, base):
    spots = zip(cells["method"], cells["speed"], cells["thickness"])
    found = [ratios.get(method, {}).get((speed, thickness), (math.nan, "")) for method, speed, thickness in spots]
    columns = {"method": cells["method"], **quantity("speed", "m/s", cells["speed"]),
               **quantity("thickness of the wall", "m", cells["thickness"]), "outcome": cells["outcome"]}
    columns |= quantity("bullets", "1", cells["bullets"]) | quantity("share that tunnelled", "1", cells["share"])
    for name in ("tunnelled", "ghost_hits", "lost_time", TIME):
        if name in cells:
            columns |= quantity(context.title(name), context.unit(name), cells[name])
    if any(ratios.values()):
        columns |= quantity(f"time per step over that of {base}", "1", [ratio for ratio, _ in found])
        columns["ratio is"] = [NOT_TOLD.get(text, "beyond the noise" if text else "") for _, text in found]
    return pd.DataFrame(columns).sort_values(["method", "thickness of the wall [m]", "speed [m/s]"])
