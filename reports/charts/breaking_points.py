# SPDX-License-Identifier: Zlib
"""Where methods fail: a parameter of the scene (a stack's height, a mass ratio) or the time step raised until each falls, at one
setting of all methods or, in a calibrated sweep, each at the setting that meets a budget at every rung."""

import math

import pandas as pd
from matplotlib.patches import Patch, Rectangle

import ranking
from chart import Chart, Headline, Needs, holes, listing, methods, of_sweeps
from load import split
from style import OUTCOMES, WIDTH, plt, si

SECTION = "When does each method fall?"
BRIGHT = ("ok", "not run", "sank", "frozen", "collapsed", "wrong", "unsupported")  # outcomes whose letters are dark
FEWEST = 3  # values of a parameter that is raised


@of_sweeps("breaking_points", 40, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), calibrated=None),
           "Breaking points", "No sweep that raises a parameter is in this store.", "breaking_points_stack")
def breaking_points(context, cells):
    parts = split(cells, ["dimension"] if "dimension" in cells else [], sort=True)
    made = [(part, ladders(context, part)) for part in parts]
    return [_chart(context, part, found, int(part["dimension"].iloc[0]) if "dimension" in part else 2)
            for part, found in made if found]


def ladders(context, cells):
    """(scene, raised axis, in words at what setting or budget, cells): one ladder per scene, raised axis and budget, everything
    else held at its usual value."""
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
    """What methods may spend on this ladder, in words; empty where the sweep does not say."""
    if about:
        value, unit = held["budget"].iloc[0], context.unit(about["metric"])
        return f"{si(value, unit)} {'' if unit == '1' else 'of '}{context.title(about['metric'])}"
    roles = context.store.sweep(held["sweep"].iloc[0]).roles
    settings = [axis for axis, role in roles.items() if role == "setting" and axis in held and held[axis].nunique() == 1]
    return listing(f"{axis}={held[axis].dropna().iloc[0]:g}" for axis in settings) if settings else ""


def breaking(ladder, name, excused):
    """Per method: the largest value that held before the first failure, the first that failed, and why a cell up to there has no
    rank (`excused`: {index: why})."""
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
    """What was run and has a rank."""
    return table[~table["hole"].astype(bool) & (table["not ranked"] == "")]


def _value(name, value):
    if math.isnan(value):
        return ""
    if name == "dt":
        return si(value, "s")
    return f"{value / 1000:g}k" if value >= 10000 and value % 1000 == 0 else f"{value:g}"


def finding(scene, name, table, spent=""):
    known, everyone = ranked(table), list(table["method"])
    scene = f"{scene}{f' with {spent}' if spent else ''}"
    fallen = known[known["fell"].notna()]
    if not len(known):
        return f"{scene}: nothing was run" if table["hole"].all() else f"on {scene} no method has a rank"
    if not len(fallen):
        return f"on {scene} nothing fails up to {name} = {_value(name, known['held'].min())}"
    first = fallen[fallen["fell"] == fallen["fell"].min()]
    text = (f"on {scene} {methods(first['method'], everyone)} {'fails' if len(first) == 1 else 'fail'} first, at {name} = "
            f"{_value(name, first['fell'].iloc[0])} ({listing(sorted(set(first['outcome'])))})")
    stood = known[known["fell"].isna()]
    top = known["held"].max()
    if len(first) == len(known):  # one rung tells no methods apart
        rung = "already at the smallest tried" if math.isnan(top) else "each after it held below"
        return (f"on {scene} {'all' if len(known) > 1 else 'the only one of the'} {len(known)} methods fail at {name} = "
                f"{_value(name, first['fell'].iloc[0])} ({listing(sorted(set(first['outcome'])))}), {rung}")
    whole, partly = stood[stood["held"] == top], stood[stood["held"] < top]
    if len(whole):
        text += f", while {methods(whole['method'], everyone)} held to the largest tried ({_value(name, top)})"
    for row in partly.itertuples():
        text += f", and {row.method} held to {_value(name, row.held)} with no result beyond"
    if len(stood):
        return text
    last = fallen[fallen["fell"] == fallen["fell"].max()]
    return text + f" and {methods(last['method'], everyone)} last, at {_value(name, last['fell'].iloc[0])}"


def headline(scene, name, table, dimension, spent=""):
    """How far each method holds; none where all hold alike."""
    known, everyone = ranked(table), list(table["method"])
    fallen, held = known[known["fell"].notna()], dict(zip(known["method"], known["held"]))
    if not len(fallen):
        return None
    first = fallen[fallen["fell"] == fallen["fell"].min()]["method"]
    top = known["held"].max()
    last = known[known["held"] == top]["method"]
    if not len(last) or set(last) & set(first):
        return None
    scene = f"{scene} in {dimension}D{f' with {spent}' if spent else ''}"
    return Headline(f"On {scene} {methods(first, everyone)} {'fails' if len(first) == 1 else 'fail'} first when "
                    f"{name} is raised, at {_value(name, fallen['fell'].min())}; {methods(last, everyone)} "
                    f"{'holds' if len(last) == 1 else 'hold'} to {_value(name, top)}.", held, "s" if name == "dt" else "1",
                    f"largest {name} that holds", larger=True)


def _chart(context, cells, found, dimension):
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
    seen, said, tables, told = set(), [], [], []
    for index, ax in enumerate(axes.flat):
        if index >= len(found):
            ax.set_visible(False)
            continue
        scene, name, spent, ladder = found[index]
        table = breaking(ladder, name, excused)
        said.append(finding(scene, name, table, spent))
        told.append(headline(scene, name, table, dimension, spent))
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
    return Chart(f"{cells['sweep'].iloc[0]}_raised_{dimension}d", SECTION, f"Breaking points, {dimension}D",
                 f"In {dimension}D " + "; ".join(said) + "." + _not_ranked(tables, len(found) > 1), cells["sweep"].iloc[0],
                 figure, table,
                 holes(cells[cells["outcome"].isin(["not run", "unsupported", "timeout", "crash", "out_of_memory"])],
                       ["scene", "method", *sorted({name for _, name, *_ in found}), *(["budget"] if "budget" in cells else [])]),
                 "A square is one run, so that no interval is known (the map of breaking points has one, over seeds). Beside a "
                 "row stands the largest value that held before the first failure."
                 + equal_words(context.store.sweep(cells["sweep"].iloc[0]).calibrate),
                 headline=max(filter(None, told), key=lambda found: found.effect, default=None))


def _not_ranked(tables, several):
    return ranking.told({row["method"] + (f" on {row['scene']}" if several else ""): row["not ranked"]
                         for table in tables for _, row in table.iterrows() if row["not ranked"]})


def equal_words(about):
    """How methods are made comparable, for the note."""
    if not about:
        return " What the title of a panel names is the same for all methods, and need not cost the same."
    how = "the most that stays within the budget" if about["equal"] == "cost" else "the fewest that err no more than the budget"
    left = about["equal"] == "cost" and about.get("most")
    return (f" At every rung each method has {how} ({about['setting']}, found by the runner): so methods are compared at equal "
            f"{about['equal']}{f', but for those with budget left at {left:g}, the most that is searched' if left else ''}.")


def _strips(ax, ladder, name, rows_of, table, called):
    values = sorted(ladder[name].unique())
    seen = set()
    by = table.set_index("method")
    for y, method in enumerate(rows_of):
        part = ladder[ladder["method"] == method]
        for x, value in enumerate(values):
            rows = part[part[name] == value]
            outcome = rows["outcome"].iloc[0] if len(rows) else None
            if outcome is None:  # not planned: the axis was not raised so far for this method
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
    # Long ladders: every second label, so that none overlap. A digit needs 0.08 inches, and some air.
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
