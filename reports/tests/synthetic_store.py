# SPDX-License-Identifier: Zlib
"""A small invented store of schema 3 with every kind of trouble in it: failures, holes, zeros, NaN, two machines."""

import json
import math
import sqlite3

import numpy as np

import finding

finding.strict = True  # in every test that makes a store

SCHEMA = """
CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT);
CREATE TABLE machine(id INTEGER PRIMARY KEY, description TEXT UNIQUE);
CREATE TABLE sweep(name TEXT PRIMARY KEY, kind TEXT, summary TEXT, baseline TEXT, roles TEXT);
CREATE TABLE metrics(what TEXT, name TEXT, kind TEXT, title TEXT, unit TEXT, meaning TEXT, role TEXT, smaller TEXT, needs TEXT,
                     PRIMARY KEY(what, name));
CREATE TABLE planned(sweep TEXT, key TEXT, axes TEXT, PRIMARY KEY(sweep, key));
CREATE TABLE trial(key TEXT PRIMARY KEY, kind TEXT, canonical TEXT, outcome TEXT, reason TEXT, step INTEGER,
                   metrics TEXT, machine INTEGER, commit_id TEXT, started TEXT, wall REAL, timed INTEGER, hash TEXT);
CREATE TABLE series(key TEXT, name TEXT, data BLOB, PRIMARY KEY(key, name));
CREATE TABLE poses(key TEXT, step INTEGER, data BLOB, PRIMARY KEY(key, step));
CREATE TABLE benchmark(id INTEGER PRIMARY KEY, imported TEXT, data TEXT);
CREATE TABLE ledger(stage TEXT, precision TEXT, dimension INTEGER, kind_a TEXT, kind_b TEXT, axis TEXT, value TEXT,
                    method TEXT, role TEXT, asked INTEGER, agree INTEGER, wrong INTEGER, tie INTEGER, undecided INTEGER,
                    refused INTEGER, not_finite INTEGER, threw INTEGER, crashed INTEGER, hung INTEGER, wrong_side INTEGER,
                    capped INTEGER, max_error REAL, histogram TEXT, ns REAL, worst TEXT,
                    PRIMARY KEY(stage, precision, dimension, kind_a, kind_b, axis, value, method));
"""
MACHINE = {"cpu": "Invented CPU 9000", "cores": 2, "memory_gib": 8, "os": "Debian GNU/Linux 12", "compiler": "g++ 12.2.0",
           "flags": "-O3 -ffp-contract=off", "governor": "performance"}
RESOLVERS = {"naive": (0.6, 3e-2, 4), "millington": (2.5, 8e-3, 9), "catto+none": (1.0, 2e-3, 20),
             "catto+linear": (1.2, 9e-4, 25), "catto+nonlinear": (1.4, 7e-4, 30), "catto+baumgarte": (1.02, 8e-4, 25),
             "catto+split_impulse": (1.3, 4e-4, 40), "soft_step": (1.1, 1e-4, 60)}
BROADPHASES = {"naive": (0.9, 2.0, 400), "naive_sphere": (0.7, 2.0, 400), "sort_and_sweep": (28, 1.12, 1500),
               "uniform_grid": (60, 1.03, 2500), "region_tree": (95, 1.08, 3000)}
QUERIES = {"closed_form": (9, 0.0), "sat": (60, 2e-16), "gjk_epa": (400, 3e-15), "fcl": (900, 4e-7),
           "fcl_libccd_collide": (1500, 8e-5)}
# what, name, kind, title, unit, role, smaller, needs
DESCRIBED = [("metric", *row.split("|")) for row in """\
ms_per_step_median|world|time per step|ms|cost|cheaper|timing
work_multiply_adds|world|multiply-adds per step|1|cost|cheaper|
work_row_updates|world|row updates per step|1|cost|cheaper|
slope_error|world|error of the distance slid|m|error|nearer the closed form|slope
joint_error_max|world|largest joint error|m|error|joints hold better|joints
max_penetration|world|largest penetration|m|error|less overlap|
penetration_poses|world|largest penetration of shapes|m|error|less overlap|
penetration_start|world|penetration at the start|m|detail||
ms_per_step_p25|world|quarter|ms|detail|cheaper|timing
ms_per_step_p75|world|three quarters|ms|detail|cheaper|timing
slope_distance|world|distance slid|m|detail||slope
drift_limit|world|limit of drift|m|detail||drift limit
end_drift_max|world|largest drift at the end|m|detail|less drift|
mean_penetration_poses_end|world|mean penetration of shapes at the end|m|detail|less overlap|
max_speed_end|world|largest speed at the end|m/s|detail|calmer|
bodies|world|bodies|1|detail||
steps_done|world|steps|1|detail||
residual_median|world|normalised complementarity|1|detail|contacts obey|
momentum_error|world|change of momentum|kg m/s|detail|momentum is kept|isolation
angular_momentum_error|world|change of angular momentum|kg m^2/s|detail|angular momentum is kept|isolation
ms_per_step_p99|world|99th|ms|detail|cheaper|timing
ms_per_step_worst|world|slowest|ms|detail|cheaper|timing
load|any|load average|1|detail|a quieter machine|timing
us_*|world|time of a stage|us|detail|cheaper|timing
ns_per_frame_median|boxes|time per frame|ns|cost|cheaper|timing
box_tests_mean|boxes|box tests per frame|1|cost|cheaper|
wrong_pairs|boxes|wrong pairs|1|error|fewer wrong|
ns_per_frame_p25|boxes|quarter|ns|detail|cheaper|timing
ns_per_frame_p75|boxes|three quarters|ns|detail|cheaper|timing
pairs_mean|boxes|pairs|1|detail||
ns_per_query|pairs|time per query|ns|cost|cheaper|timing
ns_single|pairs|time of a single query|ns|cost|cheaper|timing
max_error|pairs|worst error|1|error|more exact|
p99_error|pairs|error of 99 of 100|1|error|more exact|
median_error|pairs|median error|1|error|more exact|
failed|pairs|failed|1|error|fewer without an answer|
refused|pairs|refused|1|error|fewer without an answer|
wrong_boolean|pairs|wrong yes or no|1|error|fewer wrong|
wrong|pairs|wrong answers|1|error|fewer wrong|
asked|pairs|asked|1|detail||
problem_residual|problems|natural map|1|error|nearer|
multiply_adds|problems|multiply-adds|1|cost|cheaper|
ns_per_solve|problems|time per solve|ns|cost|cheaper|timing
multiply_adds_to_thousandth|problems|multiply-adds to a thousandth|1|detail|faster|
rows|problems|rows|1|detail||
fallbacks|problems|rows left to sweeps|1|detail||
rate|problems|rate of convergence|1|detail|faster|
predicted_rate|problems|predicted rate|1|detail|faster|""".splitlines()] + [
    ("series", "problem_residual", "problems", "natural map", "1", "error", "", ""),
    ("series", "multiply_adds", "problems", "multiply-adds", "1", "cost", "", ""),
    ("series", "ns_per_solve", "problems", "time per solve", "ns", "cost", "", "timing")] + [
    ("series", name, "world", name, "1", "detail", "", needs) for name, needs in (
    ("max_speed", ""), ("points", ""), ("kinetic", ""), ("potential", ""), ("drift", ""), ("max_penetration", ""),
    ("penetration_poses", ""), ("mean_penetration", ""), ("height", ""), ("residual", ""), ("pairs", ""),
    ("bodies", ""), ("awake", ""),
    ("seconds", "timing"), ("sec_*", "timing"))]
GROUPS = {"broadphase": "broadphase", "pair_query": "narrowphase", "solver": "solver", "velocity": "solver", "position": "solver",
          "engine": "engine"}
STAGES = {"solver": ("soft_step", "split_solver"), "velocity": ("catto", "millington", "naive"),
          "position": ("baumgarte", "linear", "none", "nonlinear", "split_impulse")}


def registered(stage, names, role="competitor"):
    return [{"stage": stage, "group": GROUPS[stage], "name": name, "role": role} for name in names]


class Maker:
    def __init__(self, path, seed=7, algorithms=None):
        self.db = sqlite3.connect(path)
        self.db.execute("PRAGMA synchronous=OFF")  # nobody needs it after a power cut
        self.db.executescript(SCHEMA)
        self.db.execute("INSERT INTO meta VALUES ('schema_version', '3')")
        self.db.execute("INSERT INTO machine VALUES (1, ?)", (json.dumps(MACHINE),))
        for what, name, kind, title, unit, role, smaller, needs in DESCRIBED:
            self.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                            (what, name, kind, title, unit, f"{title}, as invented", role, smaller, needs))
        if algorithms is None:
            algorithms = registered("broadphase", sorted(BROADPHASES))
            algorithms += registered("pair_query", ["closed_form", "gjk_epa", "sat"])
            algorithms += registered("pair_query", [m for m, v in VERIFIED.items() if v[0] == "witness"] + ["fcl"], "witness")
            for stage, names in STAGES.items():
                algorithms += registered(stage, names)
            algorithms += registered("engine", ["box2d"], "engine")
        self.db.execute("INSERT INTO meta VALUES ('registry', ?)", (json.dumps({"algorithms": algorithms}),))
        self.random = np.random.default_rng(seed)
        self.count = 0

    def second_machine(self):
        self.db.execute("INSERT INTO machine VALUES (2, ?)", (json.dumps({**MACHINE, "cpu": "Another CPU"}),))

    def sweep(self, name, kind="world", baseline="", **roles):
        """What a sweep says of its axes: roles that are not told are "run"; `report` is a list of charts."""
        self.db.execute("INSERT OR REPLACE INTO sweep VALUES (?,?,?,?,?)", (name, kind, "invented", baseline, json.dumps(roles)))

    def plan(self, sweep, **axes):
        if not self.db.execute("SELECT 1 FROM sweep WHERE name=?", (sweep,)).fetchone():
            self.sweep(sweep, axes.get("kind", "world"), resolver="label", iterations="setting")
        self.count += 1
        key = f"{self.count:032x}"
        self.db.execute("INSERT INTO planned VALUES (?, ?, ?)", (sweep, key, json.dumps(axes)))
        return key

    def trial(self, sweep, axes, metrics, outcome="ok", reason="", step=None, series=None, machine=1, extra=None, hash=None):
        """Plans and finishes one trial; returns its key."""
        key = self.plan(sweep, **axes)
        timed = 1 if axes.get("timed") else 0
        canonical = {"schema": 1, "seed": 1, "dt": 1 / 60, "dimension": axes.get("dimension"),
                     "precision": axes.get("precision"), **(extra or {}), "axes": axes}
        clean = {k: None if v is None or math.isnan(v) else v for k, v in metrics.items()}
        self.db.execute("INSERT INTO trial VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)",
                        (key, axes.get("kind"), json.dumps(canonical), outcome, reason, step, json.dumps(clean), machine,
                         "abc1234", "2026-11-21T04:00:00Z", 0.1, timed, hash or key[-16:]))
        for name, values in (series or {}).items():
            self.db.execute("INSERT INTO series VALUES (?,?,?)", (key, name, np.asarray(values, "<f8").tobytes()))
        return key

    def leave_rows(self, percent, where=None):
        """Says that so much of the rows was left to Gauss-Seidel: of the last trial, or of those of a method (resolver)."""
        trials = self.db.execute("SELECT key, canonical FROM trial ORDER BY rowid DESC").fetchall()
        for key, canonical in trials if where else trials[:1]:
            canonical = json.loads(canonical)
            if where in (None, canonical["axes"].get("resolver")):
                left = percent / 100 * 50 * (canonical["dimension"] or 2)
                self.db.execute("INSERT OR REPLACE INTO series VALUES (?,'points',?)", (key, np.full(9, 50.0, "<f8").tobytes()))
                self.db.execute("UPDATE trial SET metrics = json_set(metrics, '$.work_fallbacks', ?) WHERE key = ?", (left, key))

    def poses(self, key, step, rows):
        self.db.execute("INSERT INTO poses VALUES (?,?,?)", (key, step, np.asarray(rows, "<f8").tobytes()))

    def film(self, key, data):
        """Pictures of a run that fell, as load.Store.film gives them."""
        self.db.execute("CREATE TABLE IF NOT EXISTS film(key TEXT PRIMARY KEY, data TEXT)")
        self.db.execute("INSERT INTO film VALUES (?,?)", (key, json.dumps(data)))

    def world(self, sweep, axes, base_ms, error, outcome="ok", reason="", step=None, restless=0.01, points=40, repeats=5,
              machine=1, steps=300, extra=None, without=(), zero=(), work=None, hash=None, left=None, stages=None):
        """The untimed trial and the timed repeats of one cell; `points`: contacts in the end, or by step;
        `left`: mean penetration at the end; `stages`: us of each."""
        axes = {"kind": "world", "precision": "f64", **axes}
        n = steps if step is None else step
        at = np.arange(n)
        noise = self.random.random(n)
        touching = np.minimum(at, points) * 1.0 if np.isscalar(points) else np.asarray(points, float)[:n]
        series = {"max_speed": restless * (0.3 + noise) + 2 * np.exp(-at / 15), "points": touching,
                  "kinetic": 10 * np.exp(-at / 20) + restless, "potential": 100 - 5 * (1 - np.exp(-at / 20)),
                  "drift": error * 3 * at / steps, "residual": error * (0.5 + noise) / 10,
                  "mean_penetration": np.full(n, 0 if "mean_penetration" in zero else error / 2)}
        measured = "slope" in (extra or {})
        facts = {"penetration_poses": error, "slope_error": error if measured else math.nan,
                 "drift_limit": math.nan if measured else 0.5,
                 "max_penetration": error, "end_drift_max": error * 3, "residual_median": error / 10,
                 "work_row_updates": base_ms * 4000 if work is None else work,
                 "work_multiply_adds": base_ms * 48000 if work is None else 12 * work, "bodies": 15,
                 "steps_done": n, "max_speed_end": restless}
        facts |= {} if left is None else {"mean_penetration_poses_end": left}
        facts = {name: math.nan if name in without else 0.0 if name in zero else value for name, value in facts.items()}
        self.trial(sweep, {**axes, "timed": False, "repeat": 0}, facts, outcome, reason, step, series, machine, extra, hash)
        if outcome in ("ok", "collapsed"):
            for repeat in range(repeats):
                ms = base_ms * (1 + 0.04 * self.random.random())
                self.trial(sweep, {**axes, "timed": True, "repeat": repeat},
                           {"ms_per_step_median": ms, "ms_per_step_p25": ms * 0.97, "ms_per_step_p75": ms * 1.05,
                            "ms_per_step_p99": ms * 1.3, "ms_per_step_worst": ms * 2.5, "load": 0.4,
                            **{f"us_{stage}": us * ms / base_ms for stage, us in (stages or {}).items()}, **facts},
                           outcome, reason, step, machine=machine, extra=extra, hash=hash)

    def close(self):
        self.db.commit()
        self.db.close()


def broadphase(make, sizes=(50, 100, 200, 500, 1000, 2000), dimensions=(2, 3)):
    make.sweep("broadphase_crossover", "boxes", "naive", broadphase="stage")
    for dimension in dimensions:
        for distribution in ("uniform", "cluster"):
            for name, (scale, power, tests) in BROADPHASES.items():
                for n in sizes:
                    axes = {"kind": "boxes", "dimension": dimension, "distribution": distribution, "broadphase": name, "n": n,
                            "precision": "f64"}
                    if name == "uniform_grid" and distribution == "cluster" and n == 2000:
                        make.plan("broadphase_crossover", **axes, timed=False, repeat=0)  # a hole
                        continue
                    wrong = name == "naive_sphere" and dimension == 3 and n == 500
                    ns = scale * n**power * (1.3 if dimension == 3 else 1)
                    make.trial("broadphase_crossover", {**axes, "timed": False, "repeat": 0},
                               {"box_tests_mean": tests / 1000 * n**power, "pairs_mean": 2.5 * n, "wrong_pairs": wrong},
                               "wrong" if wrong else "ok", "3 pairs that naive has not" if wrong else "")
                    if not wrong:
                        make.trial("broadphase_crossover", {**axes, "timed": True, "repeat": 0},
                                   {"ns_per_frame_median": ns, "ns_per_frame_p25": ns * 0.95, "ns_per_frame_p75": ns * 1.1})


RESOLVED = (("vertical_stack", (2, 3)), ("pyramid", (2,)), ("slope", (2,)), ("mass_ratio", (2,)))


def resolvers(make, scenes=RESOLVED, **about):
    make.sweep("resolvers", "world", "naive", resolver="label", iterations="setting", **about)
    for scene, dimensions in scenes:
        for dimension in dimensions:
            for label, (ms, error, _) in RESOLVERS.items():
                for i, iterations in enumerate((4, 10, 40)):
                    axes = {"scene": scene, "dimension": dimension, "resolver": label, "iterations": iterations}
                    extra = {"slope": True} if scene == "slope" else None
                    e = 0.0 if label == "soft_step" and iterations == 40 else error / (1 + i)
                    if label == "naive" and iterations < 40:
                        make.world("resolvers", axes, ms * (1 + i), e, "collapsed", "drift 0.6 m over 0.5 m", 88 + i,
                                   restless=0.5)
                    elif label == "millington" and scene == "mass_ratio":
                        make.world("resolvers", axes, ms, math.nan, "diverged", "nan", 12)
                    else:
                        make.world("resolvers", axes, ms * (1 + i), e, restless=error * 5, extra=extra)


def one_scene(make):
    """A sweep with one chart: few pictures for tests of what writes them."""
    resolvers(make, (("pyramid", (2,)),), report=["cost_against_error"])


def breaking(make):
    for name in ("breaking_points", "breaking_points_dt"):
        make.sweep(name, resolver="label", n="parameter", ratio="parameter")
    for dimension in (2, 3):
        for label, (_, _, height) in RESOLVERS.items():
            for n in (2, 4, 6, 8, 10, 15, 20, 30, 40, 60):
                fell = n > height
                make.world("breaking_points", {"scene": "vertical_stack", "dimension": dimension, "resolver": label, "n": n},
                           1, 1e-3, "collapsed" if fell else "ok", "drift" if fell else "", 50 if fell else None, repeats=0)
            for ratio in (1, 10, 100, 1000, 10000):
                fell = ratio > height * 10
                make.world("breaking_points", {"scene": "mass_ratio", "dimension": dimension, "resolver": label,
                                               "ratio": ratio}, 1, 1e-3, "exploded" if fell else "ok", "speed" if fell else "",
                           50 if fell else None, repeats=0)
            for dt in (1 / 240, 1 / 120, 1 / 60, 1 / 30, 1 / 15):
                axes = {"scene": "vertical_stack", "dimension": dimension, "resolver": label, "n": 8, "dt": dt}
                if label == "soft_step" and dt > 0.05:
                    make.plan("breaking_points_dt", kind="world", precision="f64", **axes)
                    continue
                fell = dt * 300 > height
                make.world("breaking_points_dt", axes, 1, 1e-3, "diverged" if fell else "ok", "nan" if fell else "",
                           9 if fell else None, repeats=0)


def pairs_of_runs(make):
    make.sweep("unneeded", "world", "minimal", resolver="label")
    for scene in ("circle_towers", "pyramid"):
        for model, ratio in (("minimal", 1), ("3d", 3.4), ("+friction", 1.5), ("+rotation", 1.2), ("+cache", 1.05),
                             ("+sleeping", 0.8)):
            make.world("unneeded", {"scene": scene, "model": model, "dimension": 3 if model == "3d" else 2,
                                    "resolver": "catto+linear"}, 0.4 * ratio, 0.0 if model == "minimal" else 1e-4 * ratio)
    for scene in ("vertical_stack", "pyramid"):
        for label in ("naive", "catto+linear", "soft_step"):
            for precision in ("f64", "f32"):
                fell = scene == "pyramid" and label == "naive" and precision == "f32"
                make.world("precision", {"scene": scene, "dimension": 2, "resolver": label, "precision": precision},
                           0.5 * (0.8 if precision == "f32" else 1), 1e-4 * (1.3 if precision == "f32" else 1),
                           "diverged" if fell else "ok", "nan" if fell else "", 4 if fell else None)


def queries(make):
    make.sweep("pair_queries", "pairs", pair_query="stage")
    kinds = {2: ("circle", "box", "polygon"), 3: ("sphere", "capsule", "polytope")}
    for dimension, names in kinds.items():
        for i, a in enumerate(names):
            for b in names[i:]:
                for label, (ns, error) in QUERIES.items():
                    axes = {"kind": "pairs", "dimension": dimension, "pair_query": label, "kind_a": a, "kind_b": b,
                            "precision": "f64", "timed": True, "repeat": 0}
                    if label == "closed_form" and "poly" in a + b:
                        make.trial("pair_queries", axes, {}, "unsupported", f"no {a}-{b}")
                        continue
                    e = error * (1 + 3 * make.random.random())
                    wrong = round(10000 * min(1.0, e / 1e-4)) if e * 40 > 1e-12 and label.startswith("fcl") else 0
                    failed = 3 if label == "fcl_libccd_collide" and b in ("capsule", "box") else 0
                    make.trial("pair_queries", axes, {"ns_single": ns * (1 + make.random.random()), "median_error": e / 50,
                                                      "p99_error": e, "max_error": e * 40, "failed": failed, "refused": 0,
                                                      "wrong_boolean": 0, "wrong": wrong, "asked": 10000},
                               "wrong" if wrong else "ok", f"{wrong} wrong answers" if wrong else "")


def stages(make, steps=1200):
    make.sweep("stages", "world", sleep="stage")
    at = np.arange(steps)
    bodies = np.minimum(30 + at // 6, 180)
    for sleep in ("none", "split_average"):
        awake = bodies if sleep == "none" else np.where(at > 800, bodies * 0.3, bodies)
        series = {"bodies": bodies, "awake": awake, "points": awake * 1.8, "pairs": awake * 2.5}
        axes = {"kind": "world", "scene": "director_1", "dimension": 2, "sleep": sleep}
        make.trial("stages", {**axes, "timed": False, "repeat": 0}, {"bodies": 180}, series=series)
        times = {"sec_broadphase": awake * 1e-6, "sec_contacts": awake * 3e-6, "sec_solver": awake * 8e-6,
                 "sec_solver_iterate": awake * 6e-6, "sec_sleep": awake * 2e-7}
        times["seconds"] = times["sec_broadphase"] + times["sec_contacts"] + times["sec_solver"] + awake * 5e-7
        make.trial("stages", {**axes, "timed": True, "repeat": 0}, {"ms_per_step_median": 1.0}, series=times)


def benchmark(make):
    runs = [{"name": f"broadphase/2D/{name}/{layout}/{n}/manual_time", "run_type": "iteration", "cpu_time": 1.0,
             "real_time": scale * n**power, "time_unit": "ns"}
            for name, (scale, power, _) in BROADPHASES.items() for layout in ("uniform", "cluster") for n in (100, 1000)]
    runs.append({"name": "broadphase/2D/broken/uniform/100/manual_time", "run_type": "iteration", "cpu_time": 0,
                 "real_time": 0, "time_unit": "ns", "error_occurred": True, "error_message": "did not start"})
    make.db.execute("INSERT INTO benchmark(imported, data) VALUES (?, ?)",
                    ("2026-11-21", json.dumps({"context": {"num_cpus": 2, "mhz_per_cpu": 2600}, "benchmarks": runs})))


LEDGER = ("stage", "precision", "dimension", "kind_a", "kind_b", "axis", "value", "method", "role", "asked", "agree", "wrong",
          "tie", "undecided", "refused", "not_finite", "threw", "crashed", "hung", "wrong_side", "capped", "max_error",
          "histogram", "ns", "worst")
# method: role, ns, decade of the median error (None = zero), worst error, share of wrong, refused, crashed answers
VERIFIED = {"closed_form": ("competitor", 30, None, 0.0, 0, 0, 0), "sat": ("competitor", 90, -17, 3e-16, 0, 0, 0),
            "gjk_epa": ("competitor", 700, -16, 8e-14, 0, 0, 0), "fcl_libccd": ("witness", 2500, -9, 0.3, 0.25, 0, 0.01),
            "fcl_libccd_collide": ("witness", 2600, -8, 0.5, 0.31, 0, 0), "fcl_indep": ("witness", 1900, -8, 0.1, 0.02, 0.05, 0),
            "fcl_indep_collide": ("witness", 1700, -7, 0.2, 3e-5, 0, 0), "libccd_gjk": ("witness", 2900, -9, 0.4, 0.07, 0, 0),
            "libccd_mpr": ("witness", 1200, -5, 0.9, 0.4, 0.3, 0), "bullet_gjk_epa": ("witness", 800, -7, 0.05, 0.01, 0, 0),
            "bullet_box_box": ("witness", 300, -8, math.nan, 0, 1.0, 0)}
FAMILIES = ("random", "aligned_boxes", "edge_on_edge", "touching", "deep", "contained", "needles", "huge_ratio", "far_away",
            "nasty_hulls", "curved_on_flat")
REGIMES = ("separated", "touching", "shallow", "deep", "parallel_faces", "thin", "contained", "huge_ratio")


def _errors(decade, worst, right, wrong):
    """Right answers within the tolerance; nine of ten wrong ones in the decade of the median, the others in the worst's."""
    found = {"zero" if decade is None else str(min(decade, -13)): right}
    for name, count in ((decade, wrong - wrong // 10), (math.floor(math.log10(worst)) if worst > 0 else 0, wrong // 10)):
        found[str(name)] = found.get(str(name), 0) + count
    return {name: count for name, count in found.items() if count}


def ledger(make, asked=20000):
    """Wrong only where it is planted: libccd_mpr everywhere, fcl_libccd on boxes, the others in the family `needles`."""

    def row(stage, dimension, kinds, axis, value, method, n, share=1.0, precision="f64"):
        role, ns, decade, worst, wrong, refused, crashed = VERIFIED[method]
        wrong, refused, crashed = round(n * wrong * share), round(n * refused), round(n * crashed * share)
        answered = n - refused - crashed
        values = {"stage": stage, "precision": precision, "dimension": dimension, "kind_a": kinds[0], "kind_b": kinds[1],
                  "axis": axis, "value": value, "method": method, "role": role, "asked": n,
                  "agree": answered - wrong - answered // 50, "wrong": wrong, "tie": answered // 50, "refused": refused,
                  "crashed": crashed,
                  "max_error": None if math.isnan(worst) or not answered else worst if wrong else min(worst, 1e-13),
                  "histogram": json.dumps(_errors(decade, worst, answered - wrong, wrong)),
                  "ns": n * ns * (1 + 0.2 * len(kinds[1]) / 8), "worst": '{"id": "planted"}' if axis == "all" else ""}
        make.db.execute(f"INSERT INTO ledger({','.join(LEDGER)}) VALUES ({','.join('?' * len(LEDGER))})",
                        [values.get(name, 0) for name in LEDGER])

    kinds = {2: ("sphere", "polytope"), 3: ("sphere", "capsule", "box", "polytope")}
    for dimension, names in kinds.items():
        for i, a in enumerate(names):
            for b in names[i:]:
                for method, (role, *_) in VERIFIED.items():
                    if role == "witness" and dimension == 2 or method == "closed_form" and "polytope" in (a, b):
                        continue
                    share = 1.0 if method == "libccd_mpr" or "box" in (a, b) else 0.0
                    row("pair_query", dimension, (a, b), "all", "", method, asked, share)
                    for family in FAMILIES:
                        row("pair_query", dimension, (a, b), "family", family, method, asked // len(FAMILIES),
                            1.0 if method == "libccd_mpr" or family == "needles" else 0.0)
                    for regime in REGIMES:
                        row("pair_query", dimension, (a, b), "regime", regime, method, asked // len(REGIMES), share)
    for method in ("sat", "gjk_epa"):  # stands for broadphases, which have no kinds of shape
        row("broadphase", 3, ("", ""), "all", "", method, 400)
        for family in FAMILIES[:6]:
            row("broadphase", 3, ("", ""), "family", family, method, 60)


def corpus(make, cases=60):
    """Every method is right but where planted: witnesses fail on every k-th case."""
    rows = ["id,method,verdict,value,expected,error,reason", 'library-0,referee,ok,1,1,0,""']
    for i, (method, (role, *_)) in enumerate(VERIFIED.items()):
        for case in range(cases):
            verdict = "refused" if case % 9 == 8 else "ok"
            if role == "witness" and case % (i + 2) == 3:
                verdict = ("wrong", "failed", "hang")[case % 3] if i % 2 else "wrong"
            reason = "unsupported_shape" if verdict == "refused" else "a, b"
            rows.append(f'library-{case},{method},{verdict},1,1,0,"{reason}"')
    for name, value in (("corpus", "\n".join(rows) + "\n"), ("corpus_file", "hard_cases.json")):
        make.db.execute("INSERT INTO meta VALUES (?, ?)", (name, value))


def forty(make):
    """Forty methods of eight families on one scene, with a cost and an error each."""
    make.sweep("forty", "world", resolver="label")
    for i, label in enumerate(FORTY):
        make.world("forty", {"scene": "vertical_stack", "dimension": 2, "resolver": label}, 0.4 * 1.09**i,
                   3e-2 * 0.93**i * (1 + 0.5 * (i % 3)), repeats=1)


def forty_algorithms():
    return (registered("velocity", sorted({label.split("+")[0] for label in FORTY})) +
            registered("position", STAGES["position"]) + registered("solver", ("split_solver",)))


FORTY = [f"{velocity}+{position}" for velocity in ("apgd", "catto", "direct_lcp", "jacobi", "millington", "naive", "nncg",
                                                   "shock_propagation") for position in STAGES["position"]]
THEMES = (broadphase, resolvers, breaking, pairs_of_runs, queries, stages, benchmark, ledger, corpus)


def write(path, themes=THEMES, **kwargs):
    make = Maker(path, **kwargs)
    for theme in themes:
        theme(make)
    make.close()
