# SPDX-License-Identifier: Zlib
"""Sleep policies in three small scenes that the 2009 report complains of (6.5.1, 9.4.3): the wave in which a sleeping stack
wakes, sleeping bodies that a gentle touch wakes needlessly, and slow rollers that do not fall asleep."""

import math

import pandas as pd
from matplotlib.patches import Rectangle

from chart import Chart, holes
from finding import Finding, cut
from load import family, split
from sentences import plural
from style import grid_of_axes

SECTION = "What does sleeping save, and what does it cost?"
WAVE, TOUCH, ROLL = "sleep_wave", "sleep_touch", "sleep_roll"
NONE = "none"  # the policy that keeps all bodies awake
SINGLE, SPLIT = "millington", "split_average"  # one average of v and w; the two that the 2009 report made of it for slow rollers
NEVER = "never"


def of_sweep(context, cells):
    """One chart per dimension for a sweep with all three scenes; charts/sleeping.py calls this."""
    if not {WAVE, TOUCH, ROLL} <= set(cells.get("scene", ())):
        return []
    cells = cells[cells["scene"].isin((WAVE, TOUCH, ROLL))]
    return [_chart(context, part) for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True)]


def asleep_from(awake):
    """The step from which on no body is awake; None where a body is awake at the end."""
    last = max((i for i, count in enumerate(awake) if count > 0), default=-1)
    return None if last == len(awake) - 1 else last + 1


def told(context, cell):
    """(text of a cell, whether it is an unwanted result, its number)."""
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
    return {WAVE: f"{cell.get('n', 0):.0f} boxes: steps\nuntil all wake",
            TOUCH: f"touch at {cell.get('speed', 0):g} m/s:\nboxes woken",
            ROLL: f"roller at {cell.get('speed', 0):g} m/s:\nasleep from"}[cell["scene"]]


def finding(rows, asked, dimension):
    """A row per policy with its default parameters, a column per question."""
    plain = [row for row in rows if row["method"] == family(row["method"])]
    table = {"policy": sorted({row["method"] for row in plain}, key=lambda m: (m != NONE, m))}
    by = {(row["scene"], row["at"], row["method"]): row["told"] for row in plain}
    for (scene, at), title in asked.items():
        table[title.replace("\n", " ")] = [by.get((scene, at, policy), "") for policy in table["policy"]]
    return Finding(rollers(rows, dimension), cut(pd.DataFrame(table)))


def rollers(rows, dimension):
    """The 2009 report split its average because slow rollers did not fall asleep soon enough: at how many speeds that helps."""
    by = {(row["method"], row["at"]): row["number"] for row in rows if row["scene"] == ROLL}
    speeds = sorted({at for method, at in by if method == SINGLE and (SPLIT, at) in by})
    known = [at for at in speeds if not any(math.isnan(by[method, at]) for method in (SINGLE, SPLIT))]
    sooner, later = (sum(sign * (by[SPLIT, at] - by[SINGLE, at]) < 0 for at in known) for sign in (1, -1))
    if not known:
        return f"In {dimension}D {SPLIT} and {SINGLE} have no roller to compare."
    return (f"In {dimension}D {SPLIT} lets a slow roller sleep sooner than {SINGLE} at {sooner} of "
            f"{plural(len(known), 'speed')}, later or never at {later} (2009 report, 6.5.1).")


def _chart(context, cells):
    sweep, dimension = cells["sweep"].iloc[0], int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    cells = cells.assign(at=[cell["n"] if cell["scene"] == WAVE else cell["speed"] for _, cell in cells.iterrows()],
                         place=[(WAVE, TOUCH, ROLL).index(scene) for scene in cells["scene"]])
    cells = cells.sort_values(["place", "at", "method"])
    asked, policies, rows = {}, sorted(cells["method"].unique(), key=lambda m: (m != NONE, m)), []
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
                           "outcome": row["outcome"], "result": row["told"]} for row in rows])
    return Chart(f"{sweep}_scenes_{dimension}d", SECTION, f"Sleep policies: waking waves, touches and slow rollers, {dimension}D",
                 finding(rows, asked, dimension), sweep, figure, table, holes(cells, ["scene", "method", "at"]),
                 "Left: steps from the loss of the support until most of a sleeping stack is awake; 0 is best. Middle: boxes of "
                 "a stack that wake when a ball touches it. Right: the step from which on a rolling ball sleeps. Red: unwanted.")
