# SPDX-License-Identifier: Zlib
"""A result store (SQLite, schema 3) as pandas tables.

A *cell* is one set of axis values that a sweep plans. It holds one untimed trial (errors, counts, series) per seed and any number
of timed repeats (times). Every planned cell is a row: a cell without a result has the outcome "not run", a failed cell its
outcome, step and reason. The column MEASURED (measured.py) keeps the value of each seed and of each repeat.
"""

import json
import math
import os
import re
import sqlite3
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Optional

import numpy as np
import pandas as pd

import benchmarks
from measured import MEASURED, Measured

SCHEMA = "3"
TABLES = {"meta", "machine", "sweep", "metrics", "planned", "trial", "series", "poses", "benchmark", "ledger"}
NOT_RUN = "not run"
# A cell has the worst outcome of its trials. An outcome that is not in this list is worse than ok.
SEVERITY = ["ok", "unsupported", "nondeterministic", "wrong", "sank", "frozen", "left", "collapsed", "exploded",
            "diverged", "timeout", "out_of_memory", "crash"]
# Separates the parts of a method's label where several stages vary: `sat_clip / region_tree`.
JOINED = " / "
ROLES = ("competitor", "witness", "engine")  # a later role wins where a method has parts of several roles
REPEATS = ("timed", "repeat")
TOLERANCE = {"f64": 1e-12, "f32": 1e-5}  # of the size of a pair query: oracles/verify/verify.h
WITHIN_CELL = (*REPEATS, "seed")  # axes that distinguish trials of one cell, not cells


class UserError(Exception):
    """A user's mistake: reported in one line, exit code 2."""


@dataclass(frozen=True)
class Metric:
    """Description of a metric or series, from the store or from metrics.py."""
    name: str  # may end in *: one metric per stage, or per count
    title: str  # of an axis
    unit: str
    meaning: str
    role: str  # "cost" or "error", which charts show first, or "detail"
    smaller: str  # what a smaller value means; empty where it is neither better nor worse
    needs: tuple  # metrics, series or parameters that a trial must have; else the metric is undefined
    kind: str = "world"  # of trial
    compute: Optional[Callable] = None  # computes the metric from a Trial; None where the store has it

    @property
    def floor(self):
        """Values below this are drawn as 0: in double precision they are rounding, no difference between methods."""
        return 1e-12 if self.unit in ("m", "m/s", "rad") else 0.0


@dataclass(frozen=True)
class Sweep:
    """A sweep's description of itself."""
    name: str
    kind: str
    summary: str = ""
    baseline: str = ""  # the method that the others are compared with
    # Axis -> "label" (of pipelines), "stage", "setting" (used as $name in a pipeline), "parameter" (of the scene), "run"
    roles: dict = field(default_factory=dict)
    report: tuple = ()  # its charts; empty: every chart for which it has the data
    calibrate: dict = field(default_factory=dict)  # equal, metric, setting, most; empty where the runner made nothing equal
    questions: dict = field(default_factory=dict)  # of breaking points, by name: parameter, falling, limit, seeds, perturb, ratio
    settings_told: bool = False  # cells of methods without a setting have no value of it; older stores give them the first value
    commands: tuple = ()  # arguments of `lpc` that planned it, without the store; empty in stores of older programs

    def method_axes(self, planned):
        """The axes along which methods compete: axes of the pipeline that vary, the one with the most values first; one axis
        where none varies."""
        def values(name):
            return len({str(cell[name]) for cell in planned if name in cell})
        named = [name for name, role in self.roles.items() if role in ("label", "stage")]
        named.sort(key=lambda name: (self.roles[name] != "label", -values(name)))
        return [name for name in named if values(name) > 1] or named[:1]


def _sweep(name, kind, summary, baseline, roles):
    """A Sweep from its row. The JSON of the roles (texts) may also hold `report`, `commands`, `calibrate`, `break` and
    `settings_told`."""
    roles = json.loads(roles)
    charts = roles.pop("report") if isinstance(roles.get("report"), list) else ()
    equal = roles.pop("calibrate") if isinstance(roles.get("calibrate"), dict) else {}
    questions = roles.pop("break") if isinstance(roles.get("break"), dict) else {}
    commands = roles.pop("commands") if isinstance(roles.get("commands"), list) else ()
    told = roles.pop("settings_told") if isinstance(roles.get("settings_told"), bool) else False
    return Sweep(name, kind, summary, baseline, roles, tuple(charts), equal, questions, told, tuple(map(tuple, commands)))


def _plain(value):
    """An axis value that can be grouped by and printed."""
    if isinstance(value, (dict, list)):
        return json.dumps(value, sort_keys=True)
    return value


def loosened(canonical):
    """The requested tolerance of a trial of a pair query, if it is looser than the referee's; else None."""
    asked = [float(value) for value in re.findall(r"tolerance=([0-9.eE+-]+)", str(canonical.get("pair_query", "")))]
    most = max(asked, default=0.0)
    return most if most > TOLERANCE.get(canonical.get("precision"), TOLERANCE["f64"]) else None


def within_asked(metrics, asked):
    """Whether all answers are within the requested tolerance. A wrong side counts by its value; without a value it is wrong."""
    error = metrics.get("max_error")
    return error is not None and error <= asked and not (metrics.get("wrong_boolean") and metrics.get("side_alone"))


def _connected(path):
    """The database, to be read. On a read-only medium SQLite cannot make the -shm file of WAL; nobody writes there."""
    uri, pending = path.absolute().as_uri() + "?mode=ro", Path(f"{path}-wal")
    database = sqlite3.connect(uri, uri=True)
    try:
        database.execute("SELECT 1 FROM sqlite_master").fetchone()
    except sqlite3.OperationalError as error:
        if "locked" in str(error) or (pending.is_file() and pending.stat().st_size):
            raise UserError(f"{path}: cannot be read with its file -wal ({error}); valid: a copy of both") from None
        return sqlite3.connect(uri + "&immutable=1", uri=True)
    return database


class Store:
    """One open store. Series and poses are read on request, all else when the store is opened."""

    def __init__(self, path):
        self.path = Path(path)
        if not os.path.isfile(self.path):  # false for a name that is too long, too
            raise UserError(f"{path}: no such store; make one with: build/release/bin/lpc sweep NAME --store {path}")
        try:
            self.db = _connected(self.path)
            self._read()
        except (sqlite3.DatabaseError, pd.errors.DatabaseError, json.JSONDecodeError) as error:
            reason = " ".join(str(error).split())  # pandas gives several lines
            raise UserError(f"{path}: not a result store, or a damaged one ({reason})") from error

    def _read(self):
        path = self.path
        names = {row[0] for row in self.db.execute("SELECT name FROM sqlite_master WHERE type='table'")}
        missing = sorted(TABLES - names)
        if missing:
            raise UserError(f"{path}: not a result store: no table {', '.join(missing)}")
        self.meta = dict(self.db.execute("SELECT key, value FROM meta"))
        version = self.meta.get("schema_version", "none")
        if str(version) != SCHEMA:
            raise UserError(f"{path}: store schema {version}, this report reads schema {SCHEMA}")
        self.machines = {row[0]: json.loads(row[1]) for row in self.db.execute("SELECT id, description FROM machine")}
        self.trials = self._read_trials()
        self.planned = self._read_planned()
        self.algorithms = self._read_registry()
        self.metrics, self.described_series = self._read_metrics("metric"), self._read_metrics("series")
        self._sweeps = {row[0]: _sweep(*row) for row in
                        self.db.execute("SELECT name, kind, summary, baseline, roles FROM sweep")}
        self._cells, self._axes, self._method_axes, self._roles = {}, {}, {}, None
        self.by_key = {trial.Index: trial for trial in self.trials.itertuples()}  # pandas looks up far slower

    def _read_trials(self):
        trials = pd.read_sql("SELECT * FROM trial", self.db, index_col="key")
        trials["metrics"] = [json.loads(text) if text else {} for text in trials["metrics"]]
        trials["canonical"] = [json.loads(text) if text else {} for text in trials["canonical"]]
        for key, trial in trials[trials["outcome"] == "wrong"].iterrows():
            asked = loosened(trial["canonical"])
            if asked is None:
                continue
            if within_asked(trial["metrics"], asked):
                trials.at[key, "outcome"], trials.at[key, "reason"] = "ok", ""
                trial["metrics"]["wrong"] = 0.0
            else:
                trials.at[key, "reason"] = f"{trial['reason'] or ''}, asked to {asked:g} of the size".removeprefix(", ")
        return trials

    def _read_planned(self):
        planned = pd.read_sql("SELECT sweep, key, axes FROM planned ORDER BY rowid", self.db)
        # A sweep that is run again after a change of code plans the same cells under new keys: the newest counts.
        newest = planned.drop_duplicates(["sweep", "axes"], keep="last")
        self.superseded = len(planned) - len(newest)
        planned = newest.reset_index(drop=True)
        planned["axes"] = [{name: _plain(value) for name, value in json.loads(text).items()} for text in planned["axes"]]
        return planned

    def _read_registry(self):
        """The algorithms of the program that wrote the store, as `lpc list --json` has them."""
        try:
            registry = json.loads(self.meta.get("registry", "{}"))
        except json.JSONDecodeError:
            registry = {}
        return registry.get("algorithms", []) if isinstance(registry, dict) else []

    def _read_metrics(self, what):
        rows = self.db.execute("SELECT name, title, unit, meaning, role, smaller, needs, kind FROM metrics WHERE what=? "
                               "ORDER BY rowid", (what,))
        return {row[0]: Metric(*row[:6], (row[6],) if row[6] else (), row[7]) for row in rows}

    def is_time(self, metric):
        """Whether a metric is a time. Times come from the timed trials of one machine, other metrics from the untimed trial."""
        found = described(self.metrics, metric)
        return found is not None and "timing" in found.needs

    def role(self, label):
        """The role of a method. Labels are free text, so the pipelines of its trials decide; without a trial (a ledger, a cell
        that has not run) the names in the label do. An unknown method is a competitor."""
        if self._roles is None:
            self._roles = self._roles_of_trials()
        parts = [family(part) for part in str(label).split(JOINED)]
        return self._roles.get(label) or theirs(entry["role"] for entry in self.algorithms if entry["name"] in parts)

    def judged(self, label, precision):
        """The precision that gives the tolerance of a method asked in `precision`: f32 for a method that computes in f32."""
        part = family(str(label))
        return "f32" if any(entry["name"] == part and entry.get("in_float") for entry in self.algorithms) else precision

    def _roles_of_trials(self):
        found, role_of = {}, {(entry["stage"], entry["name"]): entry["role"] for entry in self.algorithms}
        for entry in self.planned[self.planned["key"].isin(self.trials.index)].itertuples():
            named = _named(self.by_key[entry.key].canonical)
            roles = [role_of.get((stage, name), stage if stage == "engine" else None) for stage, name in named]
            found.setdefault(self.method_of(entry.sweep, entry.axes), set()).update(filter(None, roles))
        return {label: theirs(roles) for label, roles in found.items() if roles}

    def declared_by(self, key):
        """{(stage, name): failures} of a trial's methods that declare any (info().failures). A failure whose `when` begins with a
        choice and a colon, "friction=box: ...", applies to this choice only; each to the dimensions that it names."""
        canonical = self.by_key[key].canonical
        named, dimension = set(_named(canonical)), canonical.get("dimension")
        def applies(failure):
            if dimension not in failure.get("dimensions", (dimension,)):  # older stores name none
                return False
            choice = re.match(r"(\w+)=(\w+):", failure["when"])
            return choice is None or choice.groups() in named
        found = {(entry["stage"], entry["name"]): list(filter(applies, entry.get("failures", ())))
                 for entry in self.algorithms if (entry["stage"], entry["name"]) in named}
        return {method: failures for method, failures in found.items() if failures}

    def declared(self, key):
        """The properties that a trial's methods declare to fail."""
        return {failure["test"] for failures in self.declared_by(key).values() for failure in failures}

    def sweeps(self):
        return list(dict.fromkeys(self.planned["sweep"]))

    def sweep(self, name):
        return self._sweeps.get(name) or Sweep(name, "")

    def axes(self, sweep):
        """Names of all axes that distinguish its cells."""
        if sweep not in self._axes:
            planned = self.planned[self.planned["sweep"] == sweep]["axes"]
            self._axes[sweep] = {name for axes in planned for name in axes} - set(WITHIN_CELL)
        return self._axes[sweep]

    def method_axes(self, sweep):
        if sweep not in self._method_axes:
            planned = self.planned[self.planned["sweep"] == sweep]["axes"]
            self._method_axes[sweep] = self.sweep(sweep).method_axes(planned)
        return self._method_axes[sweep]

    def series(self, key, name):
        """One value per step, or None where the trial did not store this series."""
        if described(self.described_series, name) is None:
            raise UserError(f"no series '{name}'; valid: {', '.join(self.described_series)}")
        row = self.db.execute("SELECT data FROM series WHERE key=? AND name=?", (key, name)).fetchone()
        return None if row is None else np.frombuffer(row[0], dtype="<f8")

    def series_names(self, key):
        return [row[0] for row in self.db.execute("SELECT name FROM series WHERE key=? ORDER BY rowid", (key,))]

    def poses(self, key, dimension):
        """{step: array of rows}: slot, position, rotation (2D: angle; 3D: quaternion w x y z)."""
        width = 4 if dimension == 2 else 8
        rows = self.db.execute("SELECT step, data FROM poses WHERE key=? ORDER BY step", (key,))
        return {step: np.frombuffer(data, dtype="<f8").reshape(-1, width) for step, data in rows}

    def film(self, key):
        """Pictures of a fallen run, drawn by experiments/film/falls.cpp: per picture width, top and height in pixels, step,
        time (s) and patches [fill, edge, [x, y, x, y, ...]]. None where the store has none."""
        if not self.db.execute("SELECT 1 FROM sqlite_master WHERE name='film'").fetchone():
            return None
        row = self.db.execute("SELECT data FROM film WHERE key=?", (key,)).fetchone()
        return None if row is None else json.loads(row[0])

    def benchmarks(self):
        """The imports of `lpc import-benchmark`, oldest first: (when, see benchmarks.read)."""
        rows = self.db.execute("SELECT imported, data FROM benchmark ORDER BY id")
        return [(imported, benchmarks.read(imported, text)) for imported, text in rows]

    def found_cases(self):
        """The simplest pair of each failure: (case as in a file of cases, its vertices, its size)."""
        if not self.db.execute("SELECT 1 FROM sqlite_master WHERE name='found_case'").fetchone():
            return []
        rows = self.db.execute("SELECT data, vertices, size FROM found_case ORDER BY name")
        return [(json.loads(text), vertices, size) for text, vertices, size in rows]

    def ledger(self):
        """The ledger of `lpc verify`: one row per method, kinds of shape and value of one axis; histograms as dictionaries. Rows
        of `lpc verify --metamorphic` are left out. An engine that answers as a witness has the role engine, as in all charts."""
        ledger = pd.read_sql("SELECT * FROM ledger WHERE axis <> 'relation' ORDER BY stage, precision, dimension, axis, value, "
                             "kind_a, kind_b, method", self.db)
        ledger["histogram"] = [json.loads(text) if text else {} for text in ledger["histogram"]]
        ledger["judged"] = [self.judged(method, precision) for method, precision in zip(ledger["method"], ledger["precision"])]
        ledger["role"] = [theirs((role, self.role(method))) for role, method in zip(ledger["role"], ledger["method"])]
        ledger["max_error"] = pd.to_numeric(ledger["max_error"]).where(ledger["histogram"].map(bool))  # none without an answer
        return ledger

    def cells(self, sweep):
        """All cells of a sweep, one row each: axes, outcome, reason, step, all metrics of its kind of trial (NaN where a cell has
        no value), keys of the trials."""
        if sweep not in self._cells:
            self._cells[sweep] = pd.DataFrame(self._cells_of(sweep))
        return self._cells[sweep].copy()

    def _cells_of(self, sweep):
        groups = {}
        for entry in self.planned[self.planned["sweep"] == sweep].itertuples():
            identity = json.dumps({k: v for k, v in entry.axes.items() if k not in WITHIN_CELL}, sort_keys=True)
            groups.setdefault(identity, []).append(entry)
        return [self._cell(sweep, entries) for entries in groups.values()]

    def _cell(self, sweep, entries):
        axes = {k: v for k, v in entries[0].axes.items() if k not in WITHIN_CELL}
        trials = [self.by_key[entry.key] for entry in entries if entry.key in self.by_key]
        about = self.sweep(sweep)
        unset = {name: np.nan for name, role in about.roles.items() if role == "setting"}
        cell = {"sweep": sweep, "settings_told": about.settings_told, **unset, **axes,
                "method": self.method_of(sweep, axes), "planned_trials": len(entries),
                "finished_trials": len(trials), "outcome": NOT_RUN, "reason": "planned, no result in the store",
                "step": np.nan, "key": None, "key_timed": None, "keys_timed": [], "machine": None, "keys": [], "hashes": [],
                "seeds": list(dict.fromkeys(entry.axes.get("seed") for entry in entries)), "failed_seeds": 0,
                "refused_repeats": 0, MEASURED: {},
                **{_free(name, axes): np.nan for name, m in self.metrics.items()
                   if m.kind in (about.kind, "any") and "*" not in name}}
        if not trials:
            return cell
        worst = max(trials, key=severity)
        cell.update(outcome=worst.outcome, reason=worst.reason or "", step=np.nan if worst.step is None else worst.step)
        if len(trials) < len(entries):
            cell["reason"] = "; ".join(filter(None, [cell["reason"], f"{len(entries) - len(trials)} of {len(entries)} "
                                                     "trials not run"]))
        timed = [trial for trial in trials if trial.timed == 1]
        seed_of = {entry.key: entry.axes.get("seed") for entry in entries}
        bad = self._facts(cell, axes, trials, seed_of)
        if timed:
            # Times come from the machine with the most repeats; one_machine reports the others.
            machines = [trial.machine for trial in timed if not pd.isna(trial.machine)]
            machine = min(machines, key=lambda number: (-machines.count(number), number)) if machines else None
            same = {trial.Index: trial.metrics for trial in timed if machine is None or trial.machine == machine}
            cell.update(key_timed=next(iter(same)), keys_timed=list(same), machine=machine,
                        refused_repeats=len(timed) - len(same))
            for name in dict.fromkeys(name for metrics in same.values() for name in metrics if self.is_time(name)):
                repeats, of_seeds = {}, {}  # a repeat is one pass over all cells
                for entry in entries:
                    value = same[entry.key].get(name) if entry.key in same else None
                    if value is not None:
                        repeats.setdefault(entry.axes.get("repeat"), {})[entry.axes.get("seed")] = value
                        of_seeds.setdefault(entry.axes.get("seed"), []).append(value)
                values = over_seeds(repeats, bad)
                cell[_free(name, axes)] = median(values) if values else np.nan
                several = cell["seeds"] if len(cell["seeds"]) > 1 else ()
                cell[MEASURED][_free(name, axes)] = Measured(
                    tuple(values), tuple(math.nan if seed in bad else middle(of_seeds.get(seed, [])) for seed in several))
        return cell

    def _facts(self, cell, axes, trials, seed_of):
        """Enters outcomes, keys and metrics that are no times, from one trial per seed: medians over the seeds that are ok, and
        all values. The cell's key, for series and poses, is that of the first seed that is ok. Returns the failed seeds."""
        of_seed, bad = {}, set()
        for trial in sorted(trials, key=lambda trial: trial.timed == 1):  # untimed first
            of_seed.setdefault(seed_of[trial.Index], trial)
            if trial.outcome != "ok":
                bad.add(seed_of[trial.Index])
        cell["failed_seeds"] = len(bad)
        firsts = [of_seed.get(seed) for seed in cell["seeds"]]
        cell["keys"] = [None if trial is None else trial.Index for trial in firsts]
        cell["hashes"] = [None if trial is None else trial.hash for trial in firsts]
        good = [trial for seed, trial in of_seed.items() if seed not in bad] or list(of_seed.values())
        cell["key"] = good[0].Index
        cell["arithmetic"] = tuple(good[0].canonical.get(name) for name in ("dimension", "precision"))
        any_timed = any(trial.timed == 1 for trial in trials)
        for name in dict.fromkeys(name for trial in good for name in trial.metrics):
            if self.is_time(name) and any_timed:
                continue
            cell[_free(name, axes)] = middle([trial.metrics.get(name) for trial in good])
            if len(cell["seeds"]) > 1:
                cell[MEASURED][_free(name, axes)] = Measured(seeds=tuple(
                    math.nan if trial is None or seed in bad or trial.metrics.get(name) is None else trial.metrics[name]
                    for seed, trial in zip(cell["seeds"], firsts)))
        return bad

    def method_of(self, sweep, axes):
        return JOINED.join(str(axes[name]) for name in self.method_axes(sweep) if name in axes) or "default"

    def started(self):
        times = sorted(t for t in self.trials["started"] if t)
        return (times[0], times[-1]) if times else ("", "")


def severity(trial):
    return SEVERITY.index(trial.outcome) if trial.outcome in SEVERITY else 1


def middle(values):
    """The median of the values that are numbers; a single value is returned unchanged."""
    values = [value for value in values if value is not None and value == value]
    return values[0] if len(values) == 1 else median(values) if values else math.nan


def median(values):
    """The median. numpy's is slower on the few values of a cell."""
    ordered, half = sorted(values), len(values) // 2
    return float(ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2)


def over_seeds(repeats, bad):
    """The median of each repeat {seed: time} over the seeds that are ok, or over all where none is. Only repeats with all seeds
    of the fullest repeat count: in a repeat cut short the missing seeds would look like noise."""
    ok = [{seed: value for seed, value in of_seed.items() if seed not in bad} for of_seed in repeats.values()]
    of_seeds = ok if any(ok) else list(repeats.values())
    counted = max(of_seeds, key=len, default={}).keys()
    whole = [of_seed for of_seed in of_seeds if counted and counted <= of_seed.keys()]
    return [median([of_seed[seed] for seed in counted]) for of_seed in whole]


def theirs(roles):
    """The role of a pipeline with parts of these roles: a part of another library decides it."""
    return max(roles, key=lambda role: ROLES.index(role) if role in ROLES else len(ROLES), default=ROLES[0])


def _named(canonical):
    """(stage, name) of all methods of a trial: its pipeline's, its engine, or the single method that it asks."""
    alone = [f"{key}={value}" for key, value in canonical.items() if isinstance(value, str) and key != "pipeline"]
    engine = canonical.get("engine")
    return re.findall(r"(\w+)=(\w+)", " ".join([canonical.get("pipeline", ""), *alone])) + (
        [("engine", engine.get("name", ""))] if isinstance(engine, dict) else [])


def _free(metric, axes):
    return "metric_" + metric if metric in axes else metric


def family(label):
    """The part of a method's label before its variant: `catto` of `catto+linear`, `gjk_epa` of `gjk_epa{...}`."""
    return re.split(r"[+{ ]", str(label), 1)[0]


def described(table, name):
    """The entry of this name, or the entry with a star that matches it, or None."""
    if name in table:
        return table[name]
    return next((entry for key, entry in table.items() if key.endswith("*") and name.startswith(key[:-1])), None)


def varying(store, cells, but=()):
    """Axes of these cells with more than one value, without the axes of the methods. An engine that exists in one precision only
    does not make the precision an axis."""
    axes = axes_of(store, cells) - {axis for name in cells["sweep"].unique() for axis in store.method_axes(name)} - set(but)
    sweeps = [store.sweep(name) for name in cells["sweep"].unique()]
    settings = {axis for about in sweeps for axis, role in about.roles.items() if role == "setting"}  # some methods have none
    several = [c for c in cells.columns
               if c in axes and (cells[c].dropna() if c in settings else cells[c]).map(str).nunique() > 1]
    return [c for c in several if c != "precision" or (cells.groupby("method")[c].nunique() > 1).any()]


def split(cells, names, sort=False):
    """The cells in groups with equal values of these axes; one group where `names` is empty."""
    if not names:
        return [cells]
    return [part for _, part in cells.groupby(names[0] if len(names) == 1 else names, sort=sort, dropna=False)]


def axes_of(store, cells):
    """Names of all axes of the sweeps of these cells."""
    return set().union(*map(store.axes, dict.fromkeys(cells["sweep"])))


def one_machine(store, cells):
    """(cells with times of one machine, sentences about the times and repeats of other machines, which are left out)."""
    if "machine" not in cells:
        return cells, []
    said = [f"{method}: {int(part['refused_repeats'].sum())} timed trials on another machine are left out"
            for method, part in cells[cells["refused_repeats"] > 0].groupby("method", sort=True)]
    if cells["machine"].nunique(dropna=True) < 2:
        return cells, said
    kept = cells["machine"].mode().iloc[0]
    other = cells["machine"].notna() & (cells["machine"] != kept)
    refused = [f"{row.method}: timed on machine {int(row.machine)}, the others on machine {int(kept)}"
               for row in cells[other].itertuples()]
    cells = cells.copy()
    for name in cells.columns:
        if store.is_time(name):
            cells.loc[other, name] = np.nan
    cells[MEASURED] = [{name: mine for name, mine in found.items() if not (left and store.is_time(name))}
                       for found, left in zip(cells[MEASURED], other)]
    return cells, sorted(set(refused)) + said
