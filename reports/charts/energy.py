# SPDX-License-Identifier: Zlib
"""Mechanical energy over the steps of a run: what comes from nowhere, and what goes."""

import math

import numpy as np
import pandas as pd

import metrics
import over_steps
import ranking
from chart import Chart, Needs, holes, methods, of_sweeps
from load import split
from style import si
from table import quantity

SECTION = "Does energy come from nowhere?"
ROUNDING = 1e-9  # of the energy exchanged: no energy from nowhere
LITTLE = 1e-2  # of the largest energy that a run of the chart exchanged: a gain over less is told in J


@of_sweeps("energy", 36, SECTION,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("energy_gain",),
                 series=("kinetic", "potential"), also=over_steps.ONE_COURSE),
           "Energy", "No sweep of several methods with energies is in this store.", "resolvers")
def energy(context, cells):
    if over_steps.elsewhere(context, cells):
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        made.append(_chart(context, part, [(where, over_steps.at_middle(mine, setting)) for where, mine in shown], left_out,
                           setting))
    return made


def exchanged(context, cell):
    """The largest energy that a run exchanged (J), or NaN."""
    kinetic, potential = (None if cell["key"] is None else context.store.series(cell["key"], name)
                          for name in ("kinetic", "potential"))
    if kinetic is None or potential is None or not len(kinetic):
        return math.nan
    finite = np.isfinite(kinetic) & np.isfinite(potential)
    return metrics.exchanged(kinetic[finite], potential[finite]) if finite.any() else math.nan


def over_start(context, cell):
    """(E - E of the start) over the largest energy that the run exchanged, per step."""
    kinetic, potential = (context.store.series(cell["key"], name) for name in ("kinetic", "potential"))
    if kinetic is None or potential is None or not len(kinetic):
        return None
    if not (np.isfinite(kinetic[0]) and np.isfinite(potential[0])):
        return None
    scale = exchanged(context, cell)
    return (kinetic + potential - kinetic[0] - potential[0]) / scale if scale > 0 else None


def adds_bodies(context, cells):
    """Whether the number of bodies changes in a run: the scene's script then puts energy in, and takes it out."""
    tracks = [context.store.series(key, "bodies") for key in cells["key"] if key is not None]
    return any(track is not None and len(track) and np.ptp(track[np.isfinite(track)]) > 0 for track in tracks)


def finding(where, cells, largest, scripted=False):
    """`largest`: J, that any finished run of the chart exchanged; a column `exchanged` has what each did."""
    if scripted:
        return f"on {where} the script adds bodies and with them energy: no gain is told"
    good = cells[(cells["outcome"] == "ok") & np.isfinite(cells["energy_gain"].astype(float))]
    if not len(good):
        return f"on {where} no run that has a rank finished"
    gains = good[good["energy_gain"] > ROUNDING]
    if not len(gains):
        return f"on {where} no method that finishes gains energy"
    worst = gains.loc[gains["energy_gain"].idxmax()]
    gain = (f"{si(worst['energy_gain'] * worst['exchanged'], 'J')}, where next to nothing is exchanged"
            if worst["exchanged"] < LITTLE * largest else
            f"{si(worst['energy_gain'] * worst['exchanged'], 'J')}, more than is exchanged" if worst["energy_gain"] > 1 else
            f"{si(100 * worst['energy_gain'])} % of what is exchanged")
    if gains["method"].nunique() == 1:
        return f"on {where} {worst['method']} gains energy, {gain}"
    return (f"on {where} {methods(sorted(gains['method'].unique()), sorted(cells['method'].unique()))} gain energy, "
            f"{worst['method']} most, {gain}")


def _chart(context, cells, shown, left_out, setting):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, width = over_steps.grid(context, cells, 1, len(shown))
    for column, (where, part) in enumerate(shown):
        ax = axes[0][column]
        ax.axhline(0, color="#999999", lw=0.8, ls=(0, (4, 3)), zorder=0.5)
        ax.update_datalim([(0, -0.02), (0, 0.02)])  # what is next to nothing does not fill the panel
        over_steps.lines(context, ax, part, lambda cell: over_start(context, cell), lambda v: min(1.1, max(-1.1, v)))
        ax.set_title(f"{where}, {dimension}D")
    axes[0][0].set_ylabel("energy above the start")
    over_steps.legend(context, figure, cells, width)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    table = pd.DataFrame({"scene": drawn["where"], "method": drawn["method"], "outcome": drawn["outcome"],
                          **quantity(context.title("energy_gain"), "1", metrics.column(drawn, "energy_gain"))})
    shown = [(where, part.assign(exchanged=[exchanged(context, cell) for _, cell in part.iterrows()])) for where, part in shown]
    # Of those that finished: beside the energy of one explosion nothing that the others exchange would be much.
    largest = max([v for _, part in shown for v in part[part["outcome"] == "ok"]["exchanged"] if math.isfinite(v)], default=0.0)
    said = [finding(where, ranking.eligible(context, part), largest, adds_bodies(context, part)) for where, part in shown]
    at = over_steps.setting_of(drawn, setting)
    return Chart(f"{cells['sweep'].iloc[0]}_energy_{dimension}d", SECTION, f"Energy over the steps, {dimension}D",
                 f"In {dimension}D{at} " + "; ".join(said) + "." + ranking.tail_of(context, shown), cells["sweep"].iloc[0],
                 figure, table,
                 left_out + holes(drawn, ["scene", "method"]),
                 "Kinetic and of gravity, above the start, over the largest energy that the run exchanged: 1 is as much again, "
                 "and what is beyond 1.1 is drawn there. Medians of stretches; above 0 energy came from nowhere, unless a "
                 f"script adds bodies. Of a run that exchanged less than {100 * LITTLE:g} % of the most in this chart, the gain "
                 "is told in J.")
