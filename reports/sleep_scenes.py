# SPDX-License-Identifier: Zlib
"""What each policy of sleep does in three small scenes, which the 2009 report complains of (6.5.1, 9.4.3): the wave in which a
sleeping stack wakes, sleepers that a gentle touch wakes for nothing, and slow rollers that do not fall asleep."""

import math

import pandas as pd
from matplotlib.patches import Rectangle

from chart import Chart, holes
from load import family, split
from sentences import listing
from style import grid_of_axes

SECTION = "What does sleeping save, and what does it cost?"
WAVE, TOUCH, ROLL = "sleep_wave", "sleep_touch", "sleep_roll"
SINGLE, SPLIT = "millington", "split_average"  # the report's first average, and the two that it made of it for the rollers' sake
NEVER = "never"


def of_sweep(context, cells):
    """One chart per dimension, where a sweep has all three scenes; charts/sleeping.py asks."""
    if not {WAVE, TOUCH, ROLL} <= set(cells.get("scene", ())):
        return []
    cells = cells[cells["scene"].isin((WAVE, TOUCH, ROLL))]
    return [_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def asleep_from(awake):
    """The step from which on nobody is awake; None where somebody is in the end."""
    last = max((i for i, count in enumerate(awake) if count > 0), default=-1)
    return None if last == len(awake) - 1 else last + 1


def told(context, cell):
    """(what a cell says, whether it is what one would not want, its number)."""
    if cell["outcome"] != "ok" or cell["key"] is None:
        return cell["outcome"], True, math.nan
    if cell["scene"] == ROLL:
        awake = context.store.series(cell["key"], "awake")
        at = None if awake is None else asleep_from(awake)
        return ("?", False, math.nan) if awake is None else (NEVER, True, math.inf) if at is None else (f"step {at}", False, at)
    woken, steps = float(cell["woken"]), float(cell["wake_steps"])
    if cell["scene"] == TOUCH:
        return ("0", False, 0.0) if not woken else (f"{woken:.0f}", True, woken)
    return ("no sleep", True, math.nan) if not woken else (f"{steps:.0f}", steps > 0, steps)


def question(cell):
    return {WAVE: f"{cell.get('n', 0):.0f} boxes: steps\nuntil all wake", TOUCH: f"touch at {cell.get('speed', 0):g} m/s:\nwoken",
            ROLL: f"roller at {cell.get('speed', 0):g} m/s:\nasleep from"}[cell["scene"]]


def finding(rows):
    """Per question what the policies do at their defaults; then whether two averages get slow rollers to sleep sooner."""
    said, plain = [], [row for row in rows if row["method"] == family(row["method"]) and row["method"] != "none"]
    for scene, begins, unit in ((WAVE, "a sleeping stack of {} boxes whose support goes is awake within", " steps"),
                                (TOUCH, "a touch at {} m/s wakes", " of a stack"), (ROLL, "a roller of {} m/s sleeps", "")):
        for at in dict.fromkeys(row["at"] for row in plain if row["scene"] == scene):
            here, groups = [row for row in plain if row["scene"] == scene and row["at"] == at], {}
            for row in here:
                groups.setdefault(row["told"], []).append(row["method"])
            words = [f"{text.replace('step', 'from step')}{unit} under {listing(names)}" for text, names in groups.items()]
            said.append(f"{begins.format(f'{at:g}')} {listing(words)}")
    return "; ".join(said) + "." + rollers(rows)


def rollers(rows):
    """The report split its average since slow rollers did not fall asleep soon enough: at which speeds that helps here."""
    by = {(row["method"], row["at"]): row["number"] for row in rows if row["scene"] == ROLL}
    speeds = sorted({at for method, at in by if method == SINGLE and (SPLIT, at) in by})
    known = [at for at in speeds if not any(math.isnan(by[method, at]) for method in (SINGLE, SPLIT))]
    if not known:
        return ""
    sooner, later = ([at for at in known if sign * (by[SPLIT, at] - by[SINGLE, at]) < 0] for sign in (1, -1))
    word = "holds" if sooner and not later else "does not hold" if not sooner else "does not hold everywhere"
    each = [f"at {at:g} m/s {SPLIT} {_beside(by[SPLIT, at], by[SINGLE, at])}" for at in known]
    return f" That splitting the average lets slow rollers sleep sooner (6.5.1) {word}: {listing(each)}."


def _beside(split_, single):
    return (f"sleeps sooner than {SINGLE}" if split_ < single else "sleeps no sooner" if split_ == single else
            f"never sleeps, {SINGLE} does" if math.isinf(split_) else f"sleeps later than {SINGLE}")


def _chart(context, cells):
    sweep, dimension = cells["sweep"].iloc[0], int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    cells = cells.assign(at=[cell["n"] if cell["scene"] == WAVE else cell["speed"] for _, cell in cells.iterrows()],
                         place=[(WAVE, TOUCH, ROLL).index(scene) for scene in cells["scene"]])
    cells = cells.sort_values(["place", "at", "method"])
    asked, policies, rows = {}, sorted(cells["method"].unique(), key=lambda m: (m != "none", m)), []
    for _, cell in cells.iterrows():
        text, bad, number = told(context, cell)
        asked.setdefault((cell["scene"], cell["at"]), question(cell))
        rows.append({"scene": cell["scene"], "at": float(cell["at"]), "method": cell["method"], "told": text, "bad": bad,
                     "number": number, "outcome": cell["outcome"]})
    left = 0.35 + 0.075 * max(map(len, policies))
    figure, panels = grid_of_axes(1, 1, 0.3 * len(policies) + 0.1, 0.2, left=left, top=0.75, bottom=0.15)
    ax = panels[0][0]
    for row in rows:
        x, y = list(asked).index((row["scene"], row["at"])), policies.index(row["method"])
        ax.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, fc="#F6D8C8" if row["bad"] else "#DDEEDD", ec="white", lw=2))
        ax.text(x, y, row["told"], ha="center", va="center", fontsize=8.5)
    ax.set_xlim(-0.5, len(asked) - 0.5)
    ax.set_ylim(len(policies) - 0.5, -0.5)
    ax.set_xticks(range(len(asked)), list(asked.values()))
    ax.set_yticks(range(len(policies)), policies)
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    ax.grid(False)
    for spine in ax.spines.values():
        spine.set_visible(False)
    table = pd.DataFrame([{"scene": row["scene"], "boxes, or speed in m/s": row["at"], "policy": row["method"],
                           "outcome": row["outcome"], "told": row["told"]} for row in rows])
    return Chart(f"{sweep}_scenes_{dimension}d", SECTION, f"Waves, touches and slow rollers, {dimension}D",
                 f"In {dimension}D {finding(rows)}", sweep, figure, table, holes(cells, ["scene", "method", "at"]),
                 "Left how many steps after its support went most of a sleeping stack is awake: 0 is all at once. Middle how "
                 "many of a stack a ball wakes that touches it. Right from which step on a rolling ball sleeps. Reddish is what "
                 "a user would rather not have.")
