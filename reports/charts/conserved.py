# SPDX-License-Identifier: Zlib
"""Conserved quantities: energy that a run gains, and momenta that it changes."""

import math

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

import metrics
import over_steps
import ranking
from chart import Chart, Headline, Needs, holes, identifier, of_sweeps
from finding import Finding, Line, cut, fits, ranked
from load import split
from sentences import methods, plural, some, verb
from style import ZeroLog, grid_of_axes, si
from table import quantity

FROM_NOWHERE = "Which methods gain energy?"
ROUNDING = 1e-9  # share of the energy exchanged: a smaller gain is rounding
LITTLE = 1e-2  # share of the largest energy exchanged in the chart: runs that exchange less are marked


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
    """(E - E of the start) over the largest energy that the run exchanged, per step; 0 if both are rounding of the
    start's energy."""
    kinetic, potential = (context.store.series(cell["key"], name) for name in ("kinetic", "potential"))
    if kinetic is None or potential is None or not len(kinetic):
        return None
    if not (np.isfinite(kinetic[0]) and np.isfinite(potential[0])):
        return None
    scale, start = exchanged(context, cell), kinetic[0] + potential[0]
    change = kinetic + potential - start
    if max(scale, np.nanmax(np.abs(change))) <= ROUNDING * abs(start):
        change = np.where(np.isfinite(change), 0.0, change)
    return change / scale if scale > 0 else None


def adds_bodies(context, cells):
    """Whether the number of bodies changes in a run: the scene's script then adds and removes energy."""
    tracks = [context.store.series(key, "bodies") for key in cells["key"] if key is not None]
    return any(track is not None and len(track) and np.ptp(track[np.isfinite(track)]) > 0 for track in tracks)


def found_energy(context, shown, dimension, at):
    """The finding: one row per scene. `shown`: [(scene, cells with the column `exchanged`, whether a script adds bodies)]."""
    # Of runs that finished: beside the energy of one explosion every other exchange would be small.
    finished = [part[part["outcome"] == "ok"] for _, part, _ in shown]
    largest = max([v for part in finished for v in part["exchanged"] if math.isfinite(v)], default=0.0)
    rows, gaining, everyone = [], [], sorted({m for _, part, _ in shown for m in part["method"]})
    for where, part, scripted in shown:
        cells = ranking.eligible(context, part)
        good = cells[(cells["outcome"] == "ok") & np.isfinite(cells["energy_gain"].astype(float))]
        gains = good[good["energy_gain"] > ROUNDING]
        row = {"scene": where, "methods that gain": "none", "most": "", "gain [J]": math.nan, "of the energy exchanged "
                                                                                              "[1]": math.nan}
        if scripted:
            row |= {"methods that gain": "", "remark": "not compared: the script adds bodies and with them energy"}
        elif not len(good):
            row |= {"methods that gain": "", "remark": "no ranked run finished"}
        elif len(gains):
            worst = gains.loc[gains["energy_gain"].idxmax()]
            in_joules = worst["exchanged"] < LITTLE * largest or worst["energy_gain"] > 1
            if in_joules:
                worst = gains.loc[(gains["energy_gain"] * gains["exchanged"]).idxmax()]
            row |= {"methods that gain": methods(sorted(gains["method"].unique()), everyone), "most": worst["method"],
                    "gain [J]": worst["energy_gain"] * worst["exchanged"], "of the energy exchanged [1]": worst["energy_gain"],
                    "remark": "little energy is exchanged" if worst["exchanged"] < LITTLE * largest else
                    "more than is exchanged" if worst["energy_gain"] > 1 else ""}
            head = f"{gains['method'].nunique()} of {plural(good['method'].nunique(), 'method')} gain energy on {where}"
            gaining.append((worst["exchanged"] >= LITTLE * largest, worst["energy_gain"], where, row, head, in_joules))
        rows.append(row)
        rows += [{"scene": where, "methods that gain": m, "remark": f"not ranked: {why}"}
                 for m, why in ranking.unranked(context, part).items()]
    table = cut(pd.DataFrame(rows), [i for i, row in enumerate(rows) if "not ranked" not in row.get("remark", "")])
    compared = sum(not scripted for _, _, scripted in shown)
    if not gaining:
        return Finding(fits(*(f"In {dimension}D{text} no ranked method that finishes gains energy." for text in (at, ""))), table)
    in_joules = max(gaining, key=lambda entry: entry[:2])[-1]
    _, share, where, row, head, _ = max(gaining, key=lambda entry: entry[3]["gain [J]"] if in_joules else entry[:2])
    much = f"{si(row['gain [J]'], 'J')}" if in_joules else f"{si(100 * share)} % of the energy exchanged"
    one = row["methods that gain"] == row["most"]
    said = (f"methods gain energy on {len(gaining)} of {compared} scenes, {row['most']} most on {where} ({much})"
            if compared > 1 and (not one or len(gaining) > 1) else
            f"{row['most']} gains energy on {where}, {much}" if one else f"{head}, {row['most']} most ({much})")
    return Finding(fits(*(f"In {dimension}D{text} {said}." for text in (at, ""))), table)


def _energy_chart(context, cells, shown, left_out, setting):
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    figure, axes, width = over_steps.grid(context, cells, 1, len(shown))
    for column, (where, part) in enumerate(shown):
        ax = axes[0][column]
        ax.axhline(0, color="#999999", lw=0.8, ls=(0, (4, 3)), zorder=0.5)
        ax.update_datalim([(0, -0.02), (0, 0.02)])  # a tiny change does not fill the panel
        over_steps.lines(context, ax, part, lambda cell: over_start(context, cell), lambda v: min(1.1, max(-1.1, v)))
        ax.set_title(f"{where}, {dimension}D")
    axes[0][0].set_ylabel("energy above the start")
    over_steps.legend(context, figure, cells, width)
    drawn = pd.concat([part.assign(where=where) for where, part in shown])
    table = pd.DataFrame({"scene": drawn["where"], "method": drawn["method"], "outcome": drawn["outcome"],
                          **quantity(context.title("energy_gain"), "1", metrics.column(drawn, "energy_gain"))})
    shown = [(where, part.assign(exchanged=[exchanged(context, cell) for _, cell in part.iterrows()]), adds_bodies(context, part))
             for where, part in shown]
    return Chart(f"{cells['sweep'].iloc[0]}_energy_{dimension}d", FROM_NOWHERE, f"Energy over the steps, {dimension}D",
                 found_energy(context, shown, dimension, over_steps.setting_of(drawn, setting).split(" (")[0]),
                 cells["sweep"].iloc[0], figure, table,
                 left_out + holes(drawn, ["scene", "method"]),
                 "Kinetic energy and energy of gravity, above the start, over the largest energy that the run exchanged: each "
                 "line has its own scale. Values beyond ±1.1 are drawn at ±1.1. A run that exchanges and gains only rounding of "
                 "the start's energy is drawn at 0. Lines are medians of stretches. Above 0 a run has gained energy, unless a "
                 "script adds bodies.")


STAY = "Which methods conserve momentum?"
SHARES = ("momentum_share", "angular_momentum_share")
# Share of the momentum, by precision: some roundings in each of some hundred steps.
ROUNDINGS = {"f64": 1e-12, "f32": 1e-4}
# Declared failures by the share that shows them: properties of whole steps of free bodies, and of position correction.
PROPERTIES = {"momentum_share": ("Solver.KeepsLinearMomentum",),
              "angular_momentum_share": ("Solver.KeepsAngularMomentum", "Solver.TurningKeepsAngularMomentum",
                                         "PositionError.KeepsAngularMomentum")}
ALIKE = 0.5  # share of the largest change from which a method is named beside it
SHORT = {"momentum_share": "linear", "angular_momentum_share": "angular"}


@of_sweeps("momenta", 37, STAY,
           Needs("world", methods=(2, math.inf), fixed=("model", "precision"),
                 metrics=("momentum_error", "angular_momentum_error", *SHARES), also="a scene that declares its momenta"),
           "Momenta", "No sweep of several methods on a scene that declares its momenta is in this store.", "momenta")
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
    """Whether a stage of the cell's pipeline declares that it fails to keep this momentum."""
    return cell["key"] is not None and not context.store.declared(cell["key"]).isdisjoint(PROPERTIES[share])


def lost(cells, share, rounding):
    """{method: the largest share in any scene} of the methods that finish and change more than rounding."""
    good = cells[cells["outcome"] == "ok"]
    most = good.groupby("method")[share].max()
    return most[most > rounding].sort_values(ascending=False).to_dict()


def found_momenta(context, cells, declared, rounding, at):
    """(finding, entry of the first screen or None). `declared`: {share: methods that declare that they do not keep it}."""
    why, ranked_cells = ranking.unranked(context, cells), ranking.whole(context, cells)
    good, lines = ranked_cells[ranked_cells["outcome"] == "ok"], []
    of = {share: lost(ranked_cells, share, rounding) for share in SHARES}
    failed = {m: part["outcome"].iloc[0] for m, part in cells[cells["outcome"] != "ok"].groupby("method")}
    for method in sorted(cells["method"].unique()):
        changed = [share for share in SHARES if method in of[share]]
        outcome = f"not ranked: {why[method]}" if method in why else f"failed: {failed[method]}" if method in failed else ""
        if changed or outcome:
            silent = [SHORT[share] for share in changed if method not in declared[share]]
            more = {f"{SHORT[SHARES[0]]} momentum [1]": of[SHARES[0]].get(method, 0.0) if not outcome else math.nan,
                    "declared": "" if outcome or not changed else "yes" if not silent else f"not {' and '.join(silent)}"}
            lines.append(Line(method, of[SHARES[1]].get(method, 0.0), outcome=outcome, more=more))
    everyone = sorted(ranked_cells["method"].unique())
    keep = [m for m in everyone if m not in failed and not any(m in found for found in of.values())]
    if keep:
        lines.append(Line(keep[0] if len(keep) == 1 else plural(len(keep), "method"), 0.0,
                          more={f"{SHORT[SHARES[0]]} momentum [1]": 0.0, "methods": methods(keep, everyone)}))
    table = ranked(lines, f"change of {SHORT[SHARES[1]]} momentum", "1", keep=[lines[-1].name] if lines else ())
    if not everyone:
        return Finding(f"{at}no method has a rank.", table), None
    head = (f"{at}{len(keep)} of {plural(len(everyone), 'method')} {verb(len(keep), 'keep')} both momenta of free bodies to "
            "rounding")
    share = SHARES[1] if of[SHARES[1]] else SHARES[0]
    most = [m for m, v in of[share].items() if v >= max(of[share].values()) * ALIKE]
    text = (f"; {some(most)} {verb(len(most), 'change')} {SHORT[share]} momentum most ({si(100 * max(of[share].values()))} "
            "%)") if most else ""
    short = head.removeprefix(at)
    text = fits(f"{head}{text}.", f"{short[0].upper()}{short[1:]}{text}.", f"{head}.", f"{short[0].upper()}{short[1:]}.")
    shares = good.groupby("method")[SHARES[1]].max()
    entry = None if not of[SHARES[1]] or not (shares <= rounding).any() else Headline(
        "", {m: 0.0 if v <= rounding else v for m, v in shares.items()}, "1", "share of angular momentum that changes")
    return Finding(text, table), entry


def _momenta_chart(context, shown, left_out, setting):
    shown = [(where, part.drop_duplicates("method")) for where, part in shown]
    cells = pd.concat([part.assign(where=where) for where, part in shown])
    dimension = int(cells["dimension"].iloc[0]) if "dimension" in cells else 2
    known = [found for found in cells.get("arithmetic", pd.Series(dtype=object)) if isinstance(found, tuple)]
    rounding = ROUNDINGS.get(known[0][1] if known else "f64", ROUNDINGS["f32"])
    declared = {share: {cell["method"] for _, cell in cells.iterrows() if declares(context, cell, share)} for share in SHARES}
    good = cells[cells["outcome"] == "ok"]
    worst = good.groupby("method")[list(SHARES)].max().max(axis=1)
    kept = set(ranking.whole(context, cells)["method"])
    order = sorted(cells["method"].unique(), key=lambda m: (m not in kept, -max(worst.get(m, math.inf), rounding), m))
    called = ranking.names(context, cells)
    names, looks = [called[m] for m in order], context.looks(cells)
    figure, axes = grid_of_axes(1, 2 * len(shown), 0.2 * len(order) + 0.1, left=max(1.6, 0.3 + 0.074 * max(map(len, names))),
                                gap_x=0.2, top=0.6, bottom=0.55)
    # One axis for all panels, up to the whole momentum: shares of both momenta compare.
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
                if cell["method"] in declared[share]:
                    ax.plot([x], [y], ls="none", marker="o", ms=11, mfc="none", mec="#333333", mew=1.0, zorder=4)
            ax.set_ylim(len(order) - 0.4, -0.6)
            ax.set_yticks(range(len(order)))
            ax.set_yticklabels(names if column == i == 0 else [])
            ax.tick_params(axis="y", length=0)
            ax.set_xlabel("share of the momentum")
            ax.set_title(f"{where}:\n{SHORT[share]} momentum")
    figure.legend(handles=[Line2D([], [], ls="none", marker="o", ms=11, mfc="none", mec="#333333", label="declared failure")],
                  loc="lower left", bbox_to_anchor=(0, 0), borderaxespad=0.3, handlelength=1.2)  # the room is below the names
    at = f"In {dimension}D{over_steps.setting_of(cells, setting).split(' (')[0]} "
    table = pd.DataFrame({"scene": cells["where"], "method": cells["method"], "outcome": cells["outcome"],
                          **{k: v for share in SHARES for k, v in quantity(context.title(share), "1",
                                                                          metrics.column(cells, share)).items()},
                          **{f"declares a change of {SHORT[share]} momentum": cells["method"].isin(declared[share])
                             for share in SHARES}})
    about, entry = found_momenta(context, cells, declared, rounding, at)
    return Chart(identifier(f"{cells['sweep'].iloc[0]} momenta {dimension}d"), STAY, f"Momenta of free bodies, {dimension}D",
                 about, cells["sweep"].iloc[0], figure, table, left_out + holes(cells, ["where", "method"]),
                 "The change of momentum from the start of the run to its end, over the momentum that the scene declares; "
                 "angular "
                 f"momentum is about the world's origin. A change up to {rounding:g} is rounding and is drawn at the left edge. "
                 f"A "
                 "ring marks a method that declares this failure (info().failures), which is tested.",
                 headline=entry)
