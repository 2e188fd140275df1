# SPDX-License-Identifier: Zlib
"""What is measured: one table, name -> description, unit, direction.

A metric with `compute` is worked out here from the stored per-step series and poses, so adding one needs no new run.
`compute` takes a Trial and returns a number; NaN says that the trial does not hold what the metric needs.
"""

import math
from dataclasses import dataclass
from typing import Callable, Optional

import numpy as np


@dataclass(frozen=True)
class Metric:
    description: str
    unit: str
    better: str  # "lower", "higher", or "" where neither is better
    compute: Optional[Callable] = None

    @property
    def floor(self):
        """Below this a chart shows 0: rounding of metres in double precision, not a difference between methods."""
        return 1e-12 if self.unit in ("m", "m/s", "rad") else 0.0


class Trial:
    """What one finished trial stored."""

    def __init__(self, store, key):
        self.store, self.key = store, key
        self.row = store.trials.loc[key]
        self.metrics, self.canonical = self.row["metrics"], self.row["canonical"]

    def series(self, name):
        return self.store.series(self.key, name)

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


def jitter(trial):
    """Root mean square of the fastest body's speed in the last quarter: how restless a scene at rest is."""
    speed = _last_quarter(trial.series("max_speed"))
    return math.nan if speed is None else float(np.sqrt(np.mean(np.square(speed))))


def creep(trial):
    drift, dt = _last_quarter(trial.series("drift")), trial.parameter("dt")
    if drift is None or math.isnan(dt):
        return math.nan
    return float(drift[-1] - drift[0]) / (dt * (len(drift) - 1))


def energy_gain(trial):
    """Above the start, as a fraction of the largest kinetic energy or fall that the run saw: no division by zero."""
    energy = _energy(trial)
    if energy is None:
        return math.nan
    scale = max(float(np.max(trial.series("kinetic"))), float(np.ptp(trial.series("potential"))))
    return 0.0 if scale == 0 else max(0.0, float(np.max(energy) - energy[0])) / scale


def contact_flicker(trial):
    points = _last_quarter(trial.series("points"))
    return math.nan if points is None else float(np.mean(np.abs(np.diff(points))))


def settle_time(trial, still=0.05):
    """The first moment after which no body is faster than `still` (m/s); infinite when that never comes."""
    speed, dt = trial.series("max_speed"), trial.parameter("dt")
    if speed is None or math.isnan(dt):
        return math.nan
    moving = np.flatnonzero(~(speed < still))
    if not len(moving):
        return 0.0
    return math.inf if moving[-1] == len(speed) - 1 else float((moving[-1] + 1) * dt)


def slope_error(trial):
    """|distance slid - g (sin a - mu cos a) t^2 / 2|, or the whole distance where friction should hold."""
    angle, mu, dt = trial.parameter("angle"), trial.parameter("mu"), trial.parameter("dt")
    mu = trial.parameter("friction") if math.isnan(mu) else mu
    gravity = trial.parameter("g")
    gravity = 10.0 if math.isnan(gravity) else abs(gravity)  # every scene's, unless it says otherwise
    slid, steps = trial.metrics.get("slope_distance"), trial.metrics.get("steps_done")
    if slid is None or steps is None or any(math.isnan(v) for v in (angle, mu, dt)):
        return math.nan
    pull = gravity * (math.sin(angle) - mu * math.cos(angle))
    # A pull within rounding of zero is the case on the edge: it should hold.
    right = pull * (steps * dt)**2 / 2 if pull > 1e-9 * gravity else 0.0
    return abs(slid - right)


def mean_penetration_rest(trial):
    values = _last_quarter(trial.series("mean_penetration"))
    return math.nan if values is None else float(np.mean(values))


def tilt_end(trial):
    """Largest angle by which any body is turned against its first stored pose; from the stored poses."""
    dimension = trial.parameter("dimension")
    if dimension not in (2, 3):
        return math.nan
    poses = trial.store.poses(trial.key, int(dimension))
    if len(poses) < 2:
        return math.nan
    first, last = poses[min(poses)], poses[max(poses)]
    start = {row[0]: row[1 + int(dimension):] for row in first}
    tilts = [0.0]
    for row in last:
        before, now = start.get(row[0]), row[1 + int(dimension):]
        if before is None:
            continue
        if dimension == 2:
            tilts.append(abs(math.remainder(now[0] - before[0], 2 * math.pi)))
        else:
            tilts.append(2 * math.acos(min(1.0, abs(float(np.dot(now, before))))))
    return float(np.max(tilts)) if np.isfinite(tilts).all() else math.nan


def lean(trial):
    """Farthest that a body has gone sideways between its first and its last stored pose; y is up."""
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


METRICS = {
    "ms_per_step_median": Metric("CPU time of one step, median over steps and repeats", "ms", "lower"),
    "ns_per_frame_median": Metric("CPU time of update and findPairs for one frame, median", "ns", "lower"),
    "ns_per_query": Metric("CPU time of one shape pair, in batches", "ns", "lower"),
    "work_row_updates": Metric("constraint rows solved once, mean per step: a cost without noise", "1", "lower"),
    "box_tests_mean": Metric("box against box overlap tests per frame", "1", "lower"),
    "node_visits_mean": Metric("tree nodes or grid cells visited per frame", "1", "lower"),
    "pairs_mean": Metric("overlapping pairs per frame", "1", ""),
    "wrong_pairs": Metric("pairs reported that naive does not report, or the reverse", "1", "lower"),
    "max_penetration": Metric("deepest overlap of any contact in any step", "m", "lower"),
    "penetration_poses": Metric("deepest overlap of any two shapes, by one exact query on the poses of every tenth step", "m",
                                "lower"),
    "mean_penetration_end": Metric("mean overlap of the contacts of the last step", "m", "lower"),
    "max_drift": Metric("farthest that any body ever was from where it started", "m", "lower"),
    "end_drift_max": Metric("farthest that any body is from where it started, at the end", "m", "lower"),
    "end_drift_top": Metric("how far the top body is from where it started, at the end", "m", "lower"),
    "max_speed": Metric("fastest body in any step", "m/s", ""),
    "max_speed_end": Metric("fastest body in the last step", "m/s", "lower"),
    "momentum_error": Metric("change of momentum that no outer force explains", "kg m/s", "lower"),
    "complementarity_max": Metric("worst normal impulse times closing speed, where nothing shall bounce", "J", "lower"),
    "cone_excess_max": Metric("worst friction impulse beyond Coulomb's cone", "N s", "lower"),
    "joint_error_max": Metric("farthest that the two anchors of a joint are apart", "m", "lower"),
    "max_error": Metric("worst error of the distance or depth, over the size of the query", "1", "lower"),
    "p99_error": Metric("error that 99 of 100 queries stay below, over the size of the query", "1", "lower"),
    "median_error": Metric("median error of the distance or depth, over the size of the query", "1", "lower"),
    "failed": Metric("queries that ended without an answer", "1", "lower"),
    "refused": Metric("queries of declared shapes that were refused", "1", "lower"),
    "wrong_boolean": Metric("queries whose yes or no is certainly wrong", "1", "lower"),
    "jitter": Metric("speed of the fastest body, root mean square of the last quarter", "m/s", "lower", jitter),
    "creep": Metric("growth of the largest drift in the last quarter", "m/s", "lower", creep),
    "energy_gain": Metric("energy above the start, over the largest energy exchanged", "1", "lower", energy_gain),
    "contact_flicker": Metric("contact points gained or lost per step in the last quarter", "1", "lower",
                              contact_flicker),
    "settle_time": Metric("time until no body is faster than 5 cm/s for good", "s", "lower", settle_time),
    "lean": Metric("farthest that any body has gone sideways at the end", "m", "lower", lean),
    "tilt_end": Metric("largest turn of a body between the first and the last stored pose", "rad", "lower", tilt_end),
    "slope_error": Metric("distance slid against the closed form of a block on a slope", "m", "lower", slope_error),
    "mean_penetration_rest": Metric("mean overlap over the last quarter", "m", "lower", mean_penetration_rest),
}


def add(store, cells, names):
    """Adds the named computed metrics as columns; cells without a finished trial get NaN."""
    for name in names:
        compute = METRICS[name].compute
        if compute and len(cells):
            cells[name] = [math.nan if key is None else compute(Trial(store, key)) for key in cells["key"]]
    return cells


def column(cells, name):
    """A metric's values as floats; a column that no trial holds is all NaN, never a missing column."""
    if name not in cells:
        return np.full(len(cells), math.nan)
    return cells[name].astype(float).to_numpy()


def pareto(cost, error):
    """Indices of the points that no other beats: ascending cost, strictly falling error. Zero counts as any number."""
    order = sorted((i for i in range(len(cost)) if math.isfinite(cost[i]) and math.isfinite(error[i])),
                   key=lambda i: (cost[i], error[i]))
    front = []
    for i in order:
        if not front or error[i] < error[front[-1]]:
            front.append(i)
    return front


def crossover(n, a, b):
    """The n from which `b` stays below `a`, interpolated on log-log axes; None when it never does or always did."""
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
