# SPDX-License-Identifier: Zlib
"""What a run must not gain: energy from nowhere, and momenta."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import over_steps
import ranking
from chart import Chart, Headline, Needs, holes, identifier, of_sweeps
from load import split
from sentences import clauses, does, listing, methods, plural, verb
from style import ZeroLog, grid_of_axes, si
from table import quantity

FROM_NOWHERE = "Does energy come from nowhere?"
ROUNDING = 1e-9  # of the energy exchanged: no energy from nowhere
LITTLE = 1e-2  # of the largest energy that a run of the chart exchanged: a gain over less is told in J


@of_sweeps("energy", 36, FROM_NOWHERE,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"), metrics=("energy_gain",),
                 series=("kinetic", "potential"), also=over_steps.ONE_COURSE),
           "Energy", "No sweep of several methods with energies is in this store.", "resolvers")
def energy(context, cells):
    if over_steps.elsewhere(context, cells):
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        at_one = [(where, over_steps.at_middle(mine, setting)) for where, mine in shown]
        made.append(_energy_chart(context, part, at_one, left_out, setting))
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


def finding_of_energy(where, cells, largest, scripted=False):
    """`largest`: J, that any finished run of the chart exchanged; a column `exchanged` has what each did."""
    good = cells[(cells["outcome"] == "ok") & np.isfinite(cells["energy_gain"].astype(float))]
    gains = good[good["energy_gain"] > ROUNDING]
    if scripted:
        return f"on {where} the script adds bodies and with them energy: no gain is told"
    if not len(good):
        return f"on {where} no run that has a rank finished"
    if not len(gains):
        return f"on {where} no method that finishes gains energy"
    worst = gains.loc[gains["energy_gain"].idxmax()]
    gain = si(worst["energy_gain"] * worst["exchanged"], "J")
    if worst["exchanged"] < LITTLE * largest:
        gain += ", where next to nothing is exchanged"
    elif worst["energy_gain"] > 1:
        gain += ", more than is exchanged"
    else:
        gain = f"{si(100 * worst['energy_gain'])} % of what is exchanged"
    names = sorted(gains["method"].unique())
    most = f", {worst['method']} most" if len(names) > 1 else ""
    return f"on {where} {does(names, 'gain', sorted(cells['method'].unique()))} energy{most}, {gain}"


def _energy_chart(context, cells, shown, left_out, setting):
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
    said = [finding_of_energy(where, ranking.eligible(context, part), largest, adds_bodies(context, part))
            for where, part in shown]
    at = over_steps.setting_of(drawn, setting)
    return Chart(f"{cells['sweep'].iloc[0]}_energy_{dimension}d", FROM_NOWHERE, f"Energy over the steps, {dimension}D",
                 f"In {dimension}D{at} " + "; ".join(said) + "." + ranking.tail_of(context, shown), cells["sweep"].iloc[0],
                 figure, table,
                 left_out + holes(drawn, ["scene", "method"]),
                 "Kinetic and of gravity, above the start, over the largest energy that the run exchanged: 1 is as much again, "
                 "and what is beyond 1.1 is drawn there. Medians of stretches; above 0 energy came from nowhere, unless a "
                 f"script adds bodies. Of a run that exchanged less than {100 * LITTLE:g} % of the most in this chart, the gain "
                 "is told in J.")


STAY = "Do momenta stay?"
SHARES = ("momentum_share", "angular_momentum_share")
# Of what there is, by the arithmetic: some roundings in each of some hundred steps.
ROUNDINGS = {"f64": 1e-12, "f32": 1e-4}
# What a method declares that it fails, by the share that shows it; the properties are of whole steps of free bodies, and of what
# moves them apart.
PROPERTIES = {"momentum_share": ("Solver.KeepsLinearMomentum",),
              "angular_momentum_share": ("Solver.KeepsAngularMomentum", "Solver.TurningKeepsAngularMomentum",
                                         "PositionError.KeepsAngularMomentum")}
TOLD = 3  # methods in a sentence
ALIKE = 0.5  # of the largest share: what changes as much is named beside what changes most
SHORT = {"momentum_share": "linear", "angular_momentum_share": "angular"}


@of_sweeps("momenta", 37, STAY,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"),
                 metrics=("momentum_error", "angular_momentum_error", *SHARES), also="a scene that says what momenta it has"),
           "Momenta", "No sweep of several methods on a scene that says what momenta it has is in this store.", "momenta")
def momenta(context, cells):
    cells = cells[cells["outcome"].ne("ok") | cells[list(SHARES)].notna().all(axis=1)]
    if not cells[list(SHARES)].notna().any(axis=None):
        return []
    made = []
    for part in split(cells, ["dimension"] if "dimension" in cells else [], sort=True):
        shown, left_out, setting = over_steps.scenes(context, part)
        at_one = [(where, over_steps.at_middle(mine, setting)) for where, mine in shown]
        made.append(_momenta_chart(context, at_one, left_out, setting))
    return made


def declares(context, cell, share):
    """Whether a part of the cell's pipeline says that it fails to keep this momentum."""
    return cell["key"] is not None and not context.store.declared(cell["key"]).isdisjoint(PROPERTIES[share])


def lost(cells, share, rounding):
    """{method: the largest share in any scene} of those that finish and change more than rounding."""
    good = cells[cells["outcome"] == "ok"]
    most = good.groupby("method")[share].max()
    return most[most > rounding].sort_values(ascending=False).to_dict()


def finding_of_momenta(cells, said, rounding, at):
    """`said`: {share: methods that declare that they do not keep it}."""
    everyone = sorted(cells["method"].unique())
    if not everyone:
        return f"{at}no method has a rank."
    failed = sorted(cells[cells["outcome"] != "ok"]["method"].unique())
    of = {share: lost(cells, share, rounding) for share in SHARES}
    keep = [m for m in everyone if m not in failed and not any(m in found for found in of.values())]
    parts = [f"{len(keep)} of {len(everyone)} methods keep both momenta to rounding ({rounding:g} of what there is)"]
    for share, found in of.items():
        most = listing(f"{m} ({si(100 * v)} %)" for m, v in list(found.items())[:TOLD])
        parts.append(f"{plural(len(found), 'method changes', 'methods change')} {SHORT[share]} momentum: "
                     f"{'most ' if len(found) > 1 else ''}{most}" if found else f"no method changes {SHORT[share]} momentum")
    silent = sorted({m for share, found in of.items() for m in found if m not in said[share]})
    told = methods(silent, everyone) if len(silent) <= TOLD else f"{len(silent)} of these"
    return at + clauses(*parts, any(of.values()) and (f"{told} {verb(len(silent), 'do')} not declare it" if silent else
                                                      "all of these declare it"),
                        failed and does(failed, "fail", everyone)) + "."


def headline(cells, rounding, at):
    """The methods that change the angular momentum most, beside those that keep it."""
    share = SHARES[1]
    found = lost(cells, share, rounding)
    good = cells[cells["outcome"] == "ok"].groupby("method")[share].max()
    keep = [m for m, v in good.items() if v <= rounding]
    if not found or not keep:
        return None
    # What changes it as much by eye is named, too: one of four is not alone.
    least = max(found.values()) * ALIKE
    most = [f"{m} ({si(100 * v)} %)" for m, v in found.items() if v >= least]
    others = f", {plural(len(found) - len(most), 'other', 'others')} less" if len(most) < len(found) else ""
    return Headline(f"{at}nothing turns free bodies from outside: {plural(len(keep), 'method keeps', 'methods keep')} their "
                    f"angular momentum to rounding; {does(most, 'change')} most{others}.",
                    {m: 0.0 if v <= rounding else v for m, v in good.items()}, "1",
                    "share of angular momentum that changes")


def _momenta_chart(context, shown, left_out, setting):
    shown = [(where, part.drop_duplicates("method")) for where, part in shown]
    cells = pd.concat([part.assign(where=where) for where, part in shown])
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    known = [found for found in cells.get("arithmetic", pd.Series(dtype=object)) if isinstance(found, tuple)]
    rounding = ROUNDINGS.get(known[0][1] if known else "f64", ROUNDINGS["f32"])
    said = {share: {cell["method"] for _, cell in cells.iterrows() if declares(context, cell, share)} for share in SHARES}
    good = cells[cells["outcome"] == "ok"]
    worst = good.groupby("method")[list(SHARES)].max().max(axis=1)
    kept = set(ranking.whole(context, cells)["method"])
    order = sorted(cells["method"].unique(), key=lambda m: (m not in kept, -max(worst.get(m, math.inf), rounding), m))
    called, ranked = ranking.names(context, cells), ranking.whole(context, cells)
    names, looks = [called[m] for m in order], context.looks(cells)
    figure, axes = grid_of_axes(1, 2 * len(shown), 0.2 * len(order) + 0.1, left=max(1.6, 0.3 + 0.074 * max(map(len, names))),
                                gap_x=0.2, top=0.6, bottom=0.55)
    # One axis for all panels, up to all that there is: shares of both momenta compare.
    everything = [0.0, 1.0, *(v for share in SHARES for v in metrics.column(good, share) if np.isfinite(v))]
    bad = bool((cells["outcome"] != "ok").any())
    for column, (where, part) in enumerate(shown):
        for i, share in enumerate(SHARES):
            ax = axes[0][2 * column + i]
            scale = ZeroLog(ax, "x", everything, failures=bad, floor=rounding)
            for _, cell in part.iterrows():
                y = order.index(cell["method"])
                x = scale.place(float(cell[share]) if cell["outcome"] == "ok" else math.nan)
                ax.plot([x], [y], **{**looks(cell["method"]), "linestyle": "none"}, zorder=3)
                if cell["method"] in said[share]:
                    ax.plot([x], [y], ls="none", marker="o", ms=11, mfc="none", mec="#333333", mew=1.0, zorder=4)
            ax.set_ylim(len(order) - 0.4, -0.6)
            ax.set_yticks(range(len(order)))
            ax.set_yticklabels(names if column == i == 0 else [])
            ax.tick_params(axis="y", length=0)
            ax.set_xlabel("of what there is")
            ax.set_title(f"{where}:\n{SHORT[share]} momentum")
    figure.legend(handles=[Line2D([], [], ls="none", marker="o", ms=11, mfc="none", mec="#333333", label="declared failure")],
                  loc="lower left", bbox_to_anchor=(0, 0), borderaxespad=0.3, handlelength=1.2)  # under the names there is room
    at = f"In {dimension}D{over_steps.setting_of(cells, setting)} "
    table = pd.DataFrame({"scene": cells["where"], "method": cells["method"], "outcome": cells["outcome"],
                          **{k: v for share in SHARES for k, v in quantity(context.title(share), "1",
                                                                          metrics.column(cells, share)).items()},
                          **{f"declares that it changes {SHORT[share]} momentum": cells["method"].isin(said[share])
                             for share in SHARES}})
    return Chart(identifier(f"{cells['sweep'].iloc[0]} momenta {dimension}d"), STAY, f"Momenta of what is free, {dimension}D",
                 finding_of_momenta(ranked, said, rounding, at) + ranking.tail(context, cells), cells["sweep"].iloc[0],
                 figure, table, left_out + holes(cells, ["where", "method"]),
                 "How far the momentum at the end of the run is from that at its start, over that of the start; the angular one "
                 f"about the world's origin. Up to {rounding:g} is rounding, and stands at the left. A ring is around what a "
                 "method says of itself (info().failures): that it fails a property of this momentum, which is tested.",
                 headline=headline(ranked, rounding, at))
