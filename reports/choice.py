# SPDX-License-Identifier: Zlib
"""The choice of a method for each stage of one scene, the reasons against the others, and the pipeline that combines the choices.

A choice must hold for slightly different starts. So a method errs more only where it does significantly over the seeds
(ranking.py), is slower only significantly and beyond the noise (noise.py), and ties otherwise. Depths within the slop that
methods keep on purpose are equal, and so are speeds that count as rest. The fastest of methods that tie would change from run
to run. So the choice is the method that errs significantly least, else that of the pipeline that all sweeps share, else the
fastest.
"""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
import pandas as pd

import measured
import metrics
import noise
import ranking
from chart import describe
from load import axes_of, one_machine, split, varying
from measured import Measured
from sentences import plural
from style import si, times

COST = "ms_per_step_median"
LEFT = "mean_penetration_poses_end"  # the overlap that remains at the end
ALONE = "ms_of_stage"  # time of a stage that changes no result; a column made here
TOGETHER = "together"  # axis of a sweep of whole pipelines, which runs the combined choice
OWN = ("work_box_tests", "work_node_visits", "work_sort_moves")  # counted by broadphases only
AS_RIGHT = 2.0  # methods err equally up to this ratio of their errors
TURNS = "not told from chance over the seeds"
COMMON = "is in the pipeline that all sweeps share"
ORDER = ("take", "tie", "slower", "errs more", "not ranked")
DEPTH = "less overlap"  # Metric.smaller of a depth
JITTER, AT_REST = "jitter", 0.05  # m/s; slower bodies are at rest (experiments/trial/measure/settling.h)


@dataclass(frozen=True)
class Verdict:
    name: str
    role: str
    word: str  # one of ORDER, or why there is no number; empty for witnesses and engines
    reason: str
    cell: pd.Series
    cost: str  # the column by which it was judged: COST or ALONE


@dataclass(frozen=True)
class Choice:
    sweep: str
    question: str  # the axis along which methods compete: "broadphase", "contacts", "resolver"
    cost: str  # the column that ranks the best methods
    floor: float  # noise floor of that column
    verdicts: list  # our methods first, the best first
    why: str = ""  # why this one of the methods that tie

    @property
    def take(self):
        return next((v for v in self.verdicts if v.word == "take"), None)


@dataclass
class Advice:
    """The choices for one scene."""
    where: str
    choices: list  # of Choice
    errors: list  # names of the metrics that exclude methods
    whole: list  # (name, cell) of whole pipelines that have run
    pipeline: str  # the combined choice, canonical; empty where a stage has no choice
    run: object  # the cell that ran it, or None
    refused: list

    @property
    def given(self):
        """The cell of the pipeline that all sweeps share. It ran earlier, with the sweeps, before the choice was known."""
        return next((cell for name, cell in self.whole if self.run is not None and cell["key"] != self.run["key"]), None)


def place_of(context, cells):
    """The axes of the scene and of its parameters."""
    about = context.store.sweep(cells["sweep"].iloc[0])
    axes = [axis for axis in cells.columns if axis in axes_of(context.store, cells) and
            (axis in ("scene", "dimension", "steps") or about.roles.get(axis) == "parameter")]
    return sorted(axes, key=lambda axis: (axis != "scene", axis != "dimension", axis))


def by_place(context, cells):
    """[(place in words, cells)] of a sweep."""
    axes = place_of(context, cells)
    return [(describe(part.iloc[0], axes), _named(context, part, axes)) for part in split(cells, axes)]


def _named(context, cells, but):
    """The cells with the column `name`: the method, and the axes that distinguish the cells of one place."""
    inner = varying(context.store, cells, but)
    cells = cells.copy()
    cells["name"] = [", ".join(filter(None, [cell["method"], describe(cell, inner)])) for _, cell in cells.iterrows()]
    return cells


def errors_judged(context, parts):
    """The errors that every finished trial has: overlap at the end, largest penetration, jitter, and one further error."""
    cells = pd.concat(parts, ignore_index=True)
    finished = cells[cells["outcome"] == "ok"]
    shared = [name for name in (LEFT, "penetration_poses", JITTER) if name in finished and len(finished) and
              finished[name].notna().all() and (finished[name] > 0).any()]
    meant = {context.metric(name).smaller for name in shared}
    others = [name for name in metrics.errors_of(context, cells) if context.metric(name).smaller not in meant]
    return shared + [name for name in others if context.metric(name).compute is None][:1] or others[:1]


def zeros(context, cells, errors):
    """{error: value up to which it counts as 0}: for a depth the largest slop of these methods, for a speed that of rest."""
    kept = max([metrics.slop(metrics.Trial(context.store, cell["key"])) for cell in cells if cell["key"] is not None],
               default=0.0)
    return {error: max(context.floor(error), kept if context.metric(error).smaller == DEPTH else
                       AT_REST if error == JITTER else 0.0) for error in errors}


def choose(context, sweep, cells, errors, given=""):
    """The choice of one sweep. `given`: the pipeline that all sweeps share."""
    cells, cost = _costs(context, sweep, cells)
    excused = {cells["name"][index]: why for index, why in ranking.excused(context, cells).items()}
    rows = [(cell, context.store.role(cell["method"])) for _, cell in cells.iterrows()]
    ours = [cell for cell, role in rows if role == "competitor" and cell["name"] not in excused]
    race = Race(context, ours, cost, {name: noise.floor(cells, name) for name in (cost, COST)}, zeros(context, ours, errors),
                ranking.comparisons(len(ours)), _usual(ours))
    right = race.right()
    equals = [cell for cell in right if cell is right[0] or race.by(cell) == cost and race.tie(right[0], cell)]
    take, why = _of_equals(context, equals, race.least, given)
    if why:
        won = f"of those that are as fast it {why}"
    else:
        won = f"the {'fastest' if len(right) > 1 else 'only one'} of those that finished and err as little"
    found = []
    for cell, role in rows:
        if failed := _failed(cell, cost):
            word, reason = failed
        elif cell["name"] in excused:
            word, reason = "not ranked", excused[cell["name"]]
        elif cell is take:
            word, reason = "take", won
        else:
            word, reason = race.judged(cell, role, take, right)
        found.append(Verdict(cell["name"], role, word, reason, cell, race.by(cell)))
    found.sort(key=lambda v: (v.role != "competitor", ORDER.index(v.word) if v.word in ORDER else len(ORDER) * (v.word != ""),
                              _failed(v.cell, cost) is not None, v.cell[cost], v.name))
    return Choice(sweep, context.store.method_axes(sweep)[0], cost, race.floors[cost], found, why)


@dataclass(frozen=True)
class Race:
    """The rules that judge the methods of one stage."""
    context: object
    ours: list  # cells of the methods that may be chosen
    cost: str
    floors: dict  # noise floors {cost: ratio}
    least: dict  # {error: value up to which it counts as 0}
    many: int  # pairs that are compared
    usual: tuple  # the counts after the broadphase that most of our methods share

    def by(self, cell):
        """The column that judges a method: the time of whole steps where its other counts differ from the usual ones."""
        return _by(cell, self.cost, self.usual)

    def tie(self, a, b, cost=""):
        return tie(a, b, cost or self.cost, self.floors[cost or self.cost], self.many)

    def right(self):
        """The cells of our methods that finished and err as little as the best, the fastest first."""
        found = [cell for cell in self.ours
                 if not _failed(cell, self.cost) and not wrong(self.context, cell, self.ours, self.least)]
        return sorted(found, key=lambda cell: (self.by(cell) != self.cost, cell[self.cost]))

    def judged(self, cell, role, take, right):
        """(word, reason) of a method that finished and is not chosen."""
        errs, by = "; ".join(wrong(self.context, cell, self.ours, self.least)), self.by(cell)
        alike = "" if take is None else self.tie(right[0], take if cell is right[0] else cell, by)
        slow = alike
        if not alike and take is not None:
            other = "" if take is right[0] else f" as {right[0]['name']}"
            slow = f"{ratio(noise.ratio(right[0], cell, by))} times as long{other}"
        if slow and by != self.cost:
            slow += " (whole steps: it causes other work)"
        if role != "competitor":
            return "", "; ".join(filter(None, [slow, errs]))
        return ("errs more", errs) if errs else ("tie" if alike else "slower", slow)


def _later(cell):
    """The counts of the stages after the broadphase."""
    return tuple(sorted((name, value) for name, value in noise.work(cell).items() if name not in OWN))


def _usual(cells):
    """The counts after the broadphase that most finished cells share; of equally frequent ones those of the cheapest cell."""
    finished = [cell for cell in cells if cell["outcome"] == "ok" and np.isfinite(cell.get(COST, np.nan))]
    counts = Counter(map(_later, finished))
    return _later(min(finished, key=lambda cell: (-counts[_later(cell)], cell[COST]))) if finished else ()


def _by(cell, cost, usual):
    return cost if cost == COST or _later(cell) == usual else COST


def _of_equals(context, cells, least, given):
    """(the choice among methods that tie, the reason)."""
    if len(cells) < 2:
        return next(iter(cells), None), ""
    many = ranking.comparisons(len(cells))
    for error, zero in least.items():
        first = [cell for cell in cells if all(other is cell or ranking.better(cell, other, error, zero, many)
                                               for other in cells)]
        if first:
            return first[0], f"has the smallest {context.title(error).removeprefix('largest ')} over {_seeds(first[0])}"
    for cell in cells:
        if given and pipeline_of(context.store, cell) == given:
            return cell, COMMON
    return cells[0], "is the fastest, but the difference is noise"


def given_of(context, parts):
    """The pipeline that all these sweeps contain, each with another stage varied around it; empty where there is none."""
    shared = set.intersection(*({pipeline_of(context.store, cell) for _, cell in cells.iterrows()} for cells in parts)) - {""}
    return shared.pop() if len(parts) > 1 and len(shared) == 1 else ""


def _costs(context, sweep, cells):
    """(cells, the column that judges them): the time of whole steps. Broadphases that all end in the same states are judged by
    the time of their stage: the rest of the step is the same work and only adds noise."""
    stage = context.store.method_axes(sweep)[0]
    if stage != "broadphase":
        return cells, COST
    finished = cells[(cells["outcome"] == "ok") & [context.store.role(m) == "competitor" for m in cells["method"]]]
    names = ["us_broadphase", "us_boxes"]  # us_boxes includes reporting moved boxes to the broadphase
    same = len(finished) > 1 and len({tuple(hashes) for hashes in finished["hashes"]}) == 1 and all(finished["hashes"].iloc[0])
    if not same or any(name not in cells or finished[name].isna().any() for name in names):
        return cells, COST
    cells = cells.copy()
    cells[ALONE] = sum(cells[name].astype(float) for name in names) / 1e3
    found = [[measured.of(cell, name) for name in names] for _, cell in cells.iterrows()]
    sums = lambda lists: tuple(sum(parts) / 1e3 for parts in zip(*lists))  # noqa: E731
    measured.add(cells, ALONE, [Measured(sums(m.runs for m in mine), sums(m.seeds for m in mine)) for mine in found])
    return cells, ALONE


def _failed(cell, cost):
    """(word, reason) of a cell without a number; None of other cells."""
    if cell["outcome"] != "ok":
        failed, seeds = cell["failed_seeds"], len(cell["seeds"])
        many = f" under {failed} of {seeds} seeds" if failed and seeds > 1 else ""
        return cell["outcome"], f"{cell['outcome']}{many}" + (f": {cell['reason']}" if cell["reason"] else "")
    if not np.isfinite(cell.get(cost, np.nan)):
        return "no time", "no time was measured"
    return None


def _seeds(cell):
    return plural(len(cell["seeds"]), "seed")


def wrong(context, cell, ours, least):
    """Reasons: errors of a method that are significantly larger than AS_RIGHT times the least of our methods. `least`: {error:
    value up to which it counts as 0}."""
    said, many = [], ranking.comparisons(len(ours))
    for error, zero in least.items():
        unit = context.unit(error)
        known = [other for other in ours if np.isfinite(measured.of_seeds(other, error)).all()]
        if not known:
            continue
        best = min(known, key=lambda other: float(np.median(measured.of_seeds(other, error))))
        if not ranking.better(best, cell, error, zero, many, AS_RIGHT):
            continue
        a, b = (float(np.median(measured.of_seeds(found, error))) for found in (cell, best))
        none = "none" if zero == context.floor(error) else f"no more than {si(zero, unit)}, which counts as 0"
        more = f"{ratio(a / b)} times that of {best['name']}" if b > zero else f"{si(a, unit)} where {best['name']} has {none}"
        said.append(f"{context.title(error)} {more}, above {AS_RIGHT:g} times over {_seeds(cell)}")
    return said


def tie(a, b, cost, floor, many=1):
    """Why two finished methods tie in time; empty where one is significantly faster."""
    if cost == ALONE:  # the runs are equal, and so are their counts
        a, b = (cell[[name for name in cell.index if not name.startswith("work_")]] for cell in (a, b))
    said = noise.said(a, b, cost, floor)
    if said in (*noise.IN_WORDS, noise.SAME_WORK):
        return noise.IN_WORDS.get(said, said)
    return "" if ranking.better(a, b, cost, many=many) or ranking.better(b, a, cost, many=many) else TURNS


def ratio(value):
    return f"{value:.2f}" if value < 2 else times(value)


def span(values, unit):
    """The median with its interval: "3.1 mm (2.9 mm to 3.4 mm)"."""
    low, high = noise.interval(values)
    text = si(float(np.median(values)), unit)
    return text if si(low, unit) == si(high, unit) else f"{text} ({si(low, unit)} to {si(high, unit)})"


def pipeline_of(store, cell):
    """The canonical text of a cell's pipeline, with every parameter; empty where it has none."""
    return store.trials.loc[cell["key"], "canonical"].get("pipeline", "") if cell["key"] is not None else ""


def combination(store, choices):
    """The canonical pipeline that combines the choices: from each choice the stages in which its methods differ. Empty where a
    stage has no choice."""
    if not choices or any(choice.take is None for choice in choices):
        return ""
    whole = stages_of(pipeline_of(store, choices[0].take.cell))
    for choice in choices:
        ours = [stages_of(pipeline_of(store, v.cell)) for v in choice.verdicts if v.role == "competitor"]
        mine = stages_of(pipeline_of(store, choice.take.cell))
        for stage, spec in mine.items():
            if len({other.get(stage) for other in ours}) > 1:
                whole[stage] = spec
    return " ".join(f"{stage}={spec}" for stage, spec in whole.items())


def stages_of(pipeline):
    """{stage: algorithm with its parameters} of a pipeline's text."""
    return dict(part.split("=", 1) for part in _split(pipeline, " "))


def _split(text, separator):
    """The text split at the separators outside braces."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter == "{") - (letter == "}")
        if letter == separator and not depth:
            parts.append("")
        else:
            parts[-1] += letter
    return [part for part in parts if part]


def short(pipeline, algorithms):
    """The pipeline without parameters at their defaults. `algorithms`: the registry."""
    known = {(entry["stage"], entry["name"]): {p["name"]: p for p in entry.get("params", [])} for entry in algorithms}
    return " ".join(f"{stage}={_short(stage, spec, known)}" for stage, spec in stages_of(pipeline).items())


def _short(stage, spec, known):
    name, _, inside = spec.partition("{")
    parameters, kept = known.get((stage, name), {}), []
    for part in _split(inside[:-1], ","):
        key, value = part.split("=", 1)
        about = parameters.get(key, {})
        if about.get("type", "").startswith("stage:"):
            value = _short(about["type"].removeprefix("stage:"), value, known)
        if value != about.get("default"):
            kept.append(f"{key}={value}")
    return name + ("{" + ",".join(kept) + "}" if kept else "")


def places_of(context, cells):
    """[(place, comparable cells, sentences about refused cells)], one for each scene and size."""
    cells, refused = one_machine(context.store, metrics.add(context.store, cells, context.metrics("world", "error")))
    return [(place, part, refused) for place, part in by_place(context, cells)]


def advices(context):
    places = {}
    for sweep in [name for name in context.store.sweeps() if "choose" in context.store.sweep(name).report]:
        for place, cells, refused in places_of(context, context.cells(sweep)):
            places.setdefault(place, []).append((sweep, cells, refused))
    return [made for made in (_advice(context, place, found) for place, found in places.items()) if made.choices]


def _advice(context, where, found):
    errors = errors_judged(context, [cells for _, cells, _ in found])
    whole = [(sweep, cells) for sweep, cells, _ in found if context.store.method_axes(sweep)[0] == TOGETHER]
    competing = [(sweep, cells) for sweep, cells, _ in found if sweep not in dict(whole)]
    given = given_of(context, [cells for _, cells in competing]) if competing else ""
    choices = [choose(context, sweep, cells, errors, given) for sweep, cells in competing]
    pipeline = combination(context.store, choices)
    pool = [cell for _, cells in whole for _, cell in cells.iterrows()] + [v.cell for c in choices for v in c.verdicts]
    run = next((cell for cell in pool if pipeline and cell["outcome"] == "ok" and math.isfinite(cell[COST]) and
                pipeline_of(context.store, cell) == pipeline), None)
    rows = [(cell["name"], cell) for _, cells in whole for _, cell in cells.iterrows()]
    if run is not None and all(cell["key"] != run["key"] for _, cell in rows):
        rows.append(("taken", run))
    return Advice(where, choices, errors, rows, pipeline, run, sorted({said for *_, part in found for said in part}))


def to_run(context):
    """The combined pipeline of the first scene where it has not run; empty where all have run."""
    for advice in advices(context):
        if advice.pipeline and advice.run is None:
            return short(advice.pipeline, context.store.algorithms)
    return ""
