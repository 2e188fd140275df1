# SPDX-License-Identifier: Zlib
"""Metrics that the report computes from the series and poses of a store: a new one needs no new run.

An entry is a function under @metric. It takes a Trial and returns a number; `needs` are the stored metrics and series without
which it is undefined (NaN). The store describes the metrics that trials measure, in the same terms.
"""

import math
import re

import numpy as np

import measured
from load import Metric, UserError, described, middle
from measured import Measured

DERIVED = {}


def metric(title, unit, meaning, smaller, needs, role="detail"):
    """Registers the function below as a metric of its name; the arguments are those of load.Metric."""
    def enter(compute):
        name = compute.__name__
        DERIVED[name] = Metric(name, title, unit, meaning, role, smaller, needs, "world", compute)
        return compute
    return enter


class Trial:
    """The stored data of one finished trial."""

    def __init__(self, store, key):
        self.store, self.key = store, key
        self.metrics, self.canonical = store.by_key[key].metrics, store.by_key[key].canonical

    def series(self, name):
        return self.store.series(self.key, name)

    def has(self, name):
        """Whether the trial stored this metric (as a number) or this series."""
        if described(self.store.metrics, name):
            value = self.metrics.get(name)
            return value is not None and not math.isnan(value)
        return self.series(name) is not None  # raises where the name is neither

    def parameter(self, name):
        """A number anywhere in the canonical description: a scene parameter, dt, steps. NaN where there is none."""
        return _find(self.canonical, name)


def _find(node, name):
    if isinstance(node, dict):
        if isinstance(node.get(name), (int, float)) and not isinstance(node[name], bool):
            return float(node[name])
        for value in node.values():
            found = _find(value, name)
            if not math.isnan(found):
                return found
    return math.nan


def _last_quarter(values):
    return None if values is None or len(values) < 8 else values[-(len(values) // 4):]


def _energy(trial):
    kinetic, potential = trial.series("kinetic"), trial.series("potential")
    return None if kinetic is None or potential is None or not len(kinetic) else kinetic + potential


@metric("sideways drift at the end", "m", "largest sideways displacement of a body at the end", "less drift",
        ("drift_limit",), "error")
def lean(trial):
    """The largest sideways displacement of a body from its first to its last stored pose; y is up."""
    dimension = trial.parameter("dimension")
    if dimension not in (2, 3):
        return math.nan
    poses = trial.store.poses(trial.key, int(dimension))
    if len(poses) < 2:
        return math.nan
    sideways = [1] if dimension == 2 else [1, 3]  # columns: slot, x, y, z
    start = {row[0]: row[sideways] for row in poses[min(poses)]}
    moved = [float(np.linalg.norm(row[sideways] - start[row[0]])) for row in poses[max(poses)] if row[0] in start]
    return float(np.max(moved)) if moved and np.isfinite(moved).all() else math.nan


@metric("restlessness (speed)", "m/s", "speed of the fastest body, root mean square of the last quarter", "calmer",
        ("drift_limit", "max_speed"), "error")
def restlessness(trial):
    """Root mean square of the fastest body's speed in the last quarter."""
    speed = _last_quarter(trial.series("max_speed"))
    return math.nan if speed is None else float(np.sqrt(np.mean(np.square(speed))))


def exchanged(kinetic, potential):
    """The largest energy (J) that a run exchanged, from finite values: the largest kinetic energy or the largest fall of the
    potential energy. A rise does not count: a gain over itself would always be 100 %."""
    return max(float(np.max(kinetic)), float(np.max(np.maximum.accumulate(potential) - potential)))


@metric("energy gained", "1", "energy above the start, over the largest energy exchanged", "less energy gained",
        ("kinetic", "potential"))
def energy_gain(trial):
    """The largest energy above the start over the energy exchanged; 0 where none is exchanged."""
    energy = _energy(trial)
    if energy is None:
        return math.nan
    scale = exchanged(trial.series("kinetic"), trial.series("potential"))
    return 0.0 if scale == 0 else max(0.0, float(np.max(energy) - energy[0])) / scale


def _share(trial, of):
    """The error of a momentum over the scene's parameter of that name."""
    total = trial.parameter(of)
    return trial.metrics[f"{of}_error"] / total if total > 0 else math.nan


@metric("relative change of momentum", "1", "change of momentum from start to end, over the scene's `momentum`",
        "momentum is kept", ("momentum_error",))
def momentum_share(trial):
    return _share(trial, "momentum")


@metric("relative change of angular momentum", "1",
        "change of angular momentum from start to end, over the scene's `angular_momentum`", "angular momentum is kept",
        ("angular_momentum_error",))
def angular_momentum_share(trial):
    return _share(trial, "angular_momentum")


@metric("flickering contacts", "1", "contact points gained or lost per step in the last quarter", "calmer",
        ("drift_limit", "points"))
def contact_flicker(trial):
    points = _last_quarter(trial.series("points"))
    return math.nan if points is None else float(np.mean(np.abs(np.diff(points))))


@metric("mean penetration at rest", "m", "mean overlap over the last quarter", "less overlap",
        ("drift_limit", "mean_penetration"))
def mean_penetration_rest(trial):
    values = _last_quarter(trial.series("mean_penetration"))
    return math.nan if values is None else float(np.mean(values))


def slop(trial):
    """The depth (m) that a method keeps on purpose: the largest slop of its pipeline and of its engine."""
    told = [trial.canonical.get("pipeline", ""), str(trial.canonical.get("engine", ""))]
    found = [value for text in told for value in re.findall(r"\bslop['\"]?[=:]\s*['\"]?([0-9.e+-]+)", text)]
    return max(map(float, found), default=0.0)


@metric("penetration beyond the slop", "m", "largest penetration of shapes (after a second, where bodies should rest), less the "
        "slop that the method keeps on purpose", "less overlap beyond the slop", ("penetration_poses",))
def penetration_beyond_slop(trial):
    settled = trial.metrics.get("penetration_settled")
    return max(0.0, (trial.metrics["penetration_poses"] if settled is None else settled) - slop(trial))


# The metric without the intended slop, for each depth.
BEYOND_SLOP = dict.fromkeys(("penetration_settled", "penetration_poses", "max_penetration"), "penetration_beyond_slop")


def known(store):
    """Every metric by name: those that trials measure, then those of DERIVED. A name must not be in both."""
    twice = sorted(store.metrics.keys() & DERIVED.keys())
    if twice:
        raise UserError(f"reports/metrics.py: trials already measure {', '.join(twice)}; a metric needs a unique name")
    return {**store.metrics, **DERIVED}


def find(store, name):
    found = described(known(store), name)
    if found is None:
        raise UserError(f"no metric '{name}'; valid: {', '.join(known(store))}")
    return found


def add(store, cells, names):
    """Adds the named computed metrics as columns; cells without a finished trial get NaN."""
    for name in names:
        entry = find(store, name)
        if entry.compute and len(cells):
            values = [[math.nan if key is None else _value(entry, Trial(store, key)) for key in keys or [None]]
                      for keys in cells["keys"]]
            ok = [[key in store.by_key and store.by_key[key].outcome == "ok" for key in keys] for keys in cells["keys"]]
            cells[name] = [middle([v for v, good in zip(mine, fine) if good] or mine) for mine, fine in zip(values, ok)]
            if any(len(mine) > 1 for mine in values):
                measured.add(cells, name, [Measured(seeds=tuple(v if good else math.nan for v, good in zip(mine, fine)))
                                           for mine, fine in zip(values, ok)])
    return cells


def _value(entry, trial):
    return entry.compute(trial) if all(trial.has(need) for need in entry.needs) else math.nan


def column(cells, name):
    """A metric's values as floats. Every metric of the trials' kind is a column, so a missing column is a misspelt name."""
    if name not in cells:
        raise UserError(f"no metric '{name}' among these cells; they have {', '.join(map(str, cells.columns))}")
    return cells[name].astype(float).to_numpy()


def pareto(cost, error):
    """Indices of the points that no other beats: ascending cost, strictly falling error. Zeros are points like any other."""
    order = sorted((i for i in range(len(cost)) if math.isfinite(cost[i]) and math.isfinite(error[i])),
                   key=lambda i: (cost[i], error[i]))
    front = []
    for i in order:
        if not front or error[i] < error[front[-1]]:
            front.append(i)
    return front


def crossover(n, a, b):
    """The n from which `b` stays below `a`, interpolated on log-log axes; None where it never or always does."""
    n, a, b = (np.asarray(v, dtype=float) for v in (n, a, b))
    good = np.isfinite(a) & np.isfinite(b) & (a > 0) & (b > 0)
    n, gap = n[good], np.log(a[good]) - np.log(b[good])
    if len(n) < 2 or gap[-1] <= 0:
        return None
    before = np.flatnonzero(gap <= 0)
    if not len(before):
        return None
    i = before[-1]
    share = -gap[i] / (gap[i + 1] - gap[i])
    return float(math.exp(math.log(n[i]) + share * (math.log(n[i + 1]) - math.log(n[i]))))


def errors_of(context, cells):
    """At most three errors for panels, the most important first: errors that every method has and that are not all zero, one per
    meaning."""
    finished = cells[cells["outcome"] == "ok"]
    names, kept = context.metrics("world", "error"), {}
    for name in names:
        values = column(finished, name)
        has = finished["method"][np.isfinite(values)]
        if np.nansum(np.abs(values)) > 0 and set(has) == set(finished["method"]):
            kept.setdefault(context.metric(name).smaller, name)
    return list(kept.values())[:3] or names[:1]
