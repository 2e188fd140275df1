# SPDX-License-Identifier: Zlib
"""Searches for breaking points: how the seeds of the values that were tried give a breaking point with its interval.
experiments/runner/breaking.cpp has the same rules."""

import math
from dataclasses import dataclass

import measured
import noise
import ranking
import rest


@dataclass
class Rung:
    value: float
    failed: int
    of: int
    outcome: str

    @property
    def holds(self):
        return 2 * self.failed < self.of


@dataclass
class Found:
    """The result of a search for one method. A Rung is one value that was tried, with its seeds."""
    rungs: list  # in order of value
    held: object = None  # the last Rung that holds before the first that fails
    fell: object = None  # the first Rung that fails
    half: float = math.nan  # the breaking point: where half of the seeds fail, interpolated between these two
    low: float = math.nan  # interval of `half`, from the intervals of the shares; NaN: open
    high: float = math.nan
    beyond: tuple = ()  # values that hold beyond the first that fails
    laxer: dict = None  # {limit: Found for "more than that share of the smallest body has sunk"}
    hole: str = ""  # why there is no rung
    dear: str = ""  # the meaning of an unsupported rung: "over budget" or "unsupported"
    cost: float = math.nan  # multiply-adds per step at `held`, or at the first rung
    ms: float = math.nan
    excuse: str = ""  # why it has no rank


def failed_seeds(cell, limit):
    """The number of seeds of a rung that fail, by their outcome or by the limit of a metric."""
    if not limit:
        return int(cell["failed_seeds"])
    metric, below, bound = limited(limit)
    values = measured.of(cell, metric).seeds if len(cell["seeds"]) > 1 else [cell.get(metric)]
    if not values:  # every seed failed, so none has a value
        return len(cell["seeds"])
    return max(int(cell["failed_seeds"]), sum(v is None or not (v < bound if below else v > bound) for v in values))


def limited(text):
    at = next(i for i, c in enumerate(text) if c in "<>")
    return text[:at], text[at] == "<", float(text[at + 1:])


def judged(rungs, falling):
    """The Found of these rungs, as `judge` of experiments/runner/breaking.cpp."""
    found, sure, to_hold, to_fail, beyond = Found(sorted(rungs, key=lambda r: r.value)), True, math.nan, math.nan, []
    for rung in reversed(found.rungs) if falling else found.rungs:
        low, high = noise.wilson(rung.failed, rung.of)
        sure = sure and high < 0.5
        if sure:
            to_hold = rung.value
        if found.fell is None:
            if rung.holds:
                found.held = rung
            else:
                found.fell = rung
        elif rung.holds:
            beyond.append(rung.value)
        if found.fell is not None and math.isnan(to_fail) and low > 0.5:
            to_fail = rung.value
    found.low, found.high = (to_fail, to_hold) if falling else (to_hold, to_fail)
    found.beyond = tuple(beyond)
    if found.held and found.fell and not ended_by_cost(found):
        a, b = (rung.failed / rung.of for rung in (found.held, found.fell))
        found.half = found.held.value * (found.fell.value / found.held.value) ** ((0.5 - a) / (b - a))
    return found


def laxer(store, cells, about):
    """The searches by the laxer limits, from the runs that were made for the strictest limit."""
    found = {}
    for limit in rest.LIMITS[1:]:
        rungs = []
        for _, cell in cells.iterrows():
            trials = [store.trials.loc[key] for key in cell["keys"]]
            far = [rest.sunk(trial["outcome"], trial["metrics"].get("sunk")) > limit or breaks(trial["metrics"], about["limit"])
                   for trial in trials]
            rungs.append(Rung(float(cell[about["parameter"]]), sum(far), len(far), cell["outcome"]))
        found[limit] = judged(rungs, about["falling"])
    return found


def breaks(measured, limit):
    if not limit:
        return False
    metric, below, bound = limited(limit)
    value = measured.get(metric)
    return value is None or not (value < bound if below else value > bound)


def found_of(store, cells, about, excused):
    """The search of one method on one question, from the cells of its rungs. `excused`: {index: why a cell has no rank}."""
    name, rungs, known = about["parameter"], [], []
    for _, cell in cells.iterrows():
        if any(key is None for key in cell["keys"]) or not cell["keys"]:
            continue  # the sweep stopped before all seeds were run
        rungs.append(Rung(float(cell[name]), failed_seeds(cell, about["limit"]), len(cell["seeds"]), cell["outcome"]))
        known.append((float(cell[name]), cell))
    if not rungs:
        return Found([], hole="not run")
    found = judged(rungs, about["falling"])
    found.excuse = ranking.largest(excused[cell.name] for value, cell in known
                                   if cell.name in excused and reached(found, value, about["falling"]))
    if len(rungs) == 1 and rungs[0].outcome == "unsupported":
        found.hole = "unsupported"
    shown = found.held or found.fell
    cell = next(cell for value, cell in known if value == shown.value)
    found.dear = "over budget" if cell.get("budget", math.nan) == cell.get("budget", math.nan) else "unsupported"
    whole = cells[[bool(keys) and None not in keys for keys in cells["keys"]]]
    if any(store.trials.loc[key]["metrics"].get("sunk") is not None for keys in whole["keys"] for key in keys):
        found.laxer = laxer(store, whole, about)
    found.cost, found.ms = (float(cell.get(metric, math.nan)) for metric in ("work_multiply_adds", "ms_per_step_median"))
    return found


def reached(found, value, falling):
    """Whether a value lies up to the first that fails; values beyond do not affect the result."""
    return found.fell is None or (value >= found.fell.value if falling else value <= found.fell.value)


def ended_by_cost(found):
    """Whether the first value that fails was not run because it costs more than the budget."""
    return found.fell is not None and found.fell.outcome == "unsupported"


def edge(found):
    """Where half of the seeds fail; the last value tried if nothing fails; NaN if nothing holds."""
    return math.nan if not found.held else found.half if found.half == found.half else found.held.value


def ranked(column):
    """The methods that were run and have a rank."""
    return {method: found for method, found in column.items() if not found.hole and not found.excuse}


def best_of(column, falling):
    values = [edge(f) for f in column.values() if f.held]
    return (min(values) if falling else max(values)) if values else math.nan


def span(found):
    """The interval of the breaking point; infinite where it is open."""
    return (found.low if found.low == found.low else -math.inf, found.high if found.high == found.high else math.inf)


def ties(known, value):
    """Methods that tie with those of this breaking point: their intervals overlap in more than an end."""
    held = {m: f for m, f in known.items() if f.held}
    there = [span(f) for f in held.values() if edge(f) == value]
    return [m for m, f in held.items() if edge(f) == value or any(span(f)[0] < high and low < span(f)[1] for low, high in there)]


def right(known, truth):
    """Methods with an interval that contains the value of the closed form."""
    return [m for m, f in known.items() if f.held and span(f)[0] <= truth <= span(f)[1]]
