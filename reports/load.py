# SPDX-License-Identifier: Zlib
"""A result store (SQLite, schema 2) as pandas tables.

A *cell* is what a sweep plans: one set of axis values. It holds one untimed trial (errors, counts, series) and any
number of timed repeats (times). Every planned cell is a row here, whatever became of it: a cell without a result has
the outcome "not run", a failed one its outcome, step and reason. Nothing is dropped.
"""

import json
import sqlite3
from pathlib import Path

import numpy as np
import pandas as pd

SCHEMA = "2"
TABLES = {"meta", "machine", "planned", "trial", "series", "poses", "benchmark", "ledger"}
NOT_RUN = "not run"
# The worst outcome of a cell's trials is the cell's; an outcome that this list does not know is worse than ok.
SEVERITY = ["ok", "unsupported", "nondeterministic", "wrong", "collapsed", "exploded", "diverged", "timeout",
            "out_of_memory", "crash"]
# Axes that tell the trials of one cell apart, not the cells.
WITHIN_CELL = ("timed", "repeat")
# Names under which sweeps may put the competing thing, the most telling first.
METHOD_AXES = ("resolver", "broadphase", "pair_query", "query", "method", "solver", "velocity", "algorithm", "pipeline")
TIME_PREFIXES = ("ms_", "us_", "ns_", "s_")


class UserError(Exception):
    """A mistake of the user's: told in one line, exit code 2."""


def is_time(metric):
    return metric.startswith(TIME_PREFIXES)


def _plain(value):
    """An axis value as something that can be grouped by and printed."""
    if isinstance(value, (dict, list)):
        return json.dumps(value, sort_keys=True)
    return value


class Store:
    """One open store. Everything small is read at once; series and poses when asked for."""

    def __init__(self, path):
        self.path = Path(path)
        if not self.path.is_file():
            raise UserError(f"{path}: no such store; make one with: build/release/bin/lpc sweep NAME --store {path}")
        try:
            self.db = sqlite3.connect(f"file:{self.path}?mode=ro", uri=True)
            self._read()
        except (sqlite3.DatabaseError, pd.errors.DatabaseError, json.JSONDecodeError) as error:
            reason = " ".join(str(error).split())  # pandas tells it in several lines
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
        self.roles, self.summaries = self._read_registry()
        self._cells = {}

    def _read_trials(self):
        trials = pd.read_sql("SELECT * FROM trial", self.db, index_col="key")
        trials["metrics"] = [json.loads(text) if text else {} for text in trials["metrics"]]
        trials["canonical"] = [json.loads(text) if text else {} for text in trials["canonical"]]
        return trials

    def _read_planned(self):
        planned = pd.read_sql("SELECT sweep, key, axes FROM planned ORDER BY rowid", self.db)
        # A part of a sweep run again after its code changed plans the same cells under new keys: the newest counts.
        newest = planned.drop_duplicates(["sweep", "axes"], keep="last")
        self.superseded = len(planned) - len(newest)
        planned = newest.reset_index(drop=True)
        planned["axes"] = [{name: _plain(value) for name, value in json.loads(text).items()} for text in planned["axes"]]
        return planned

    def _read_registry(self):
        """Roles and one-line summaries by algorithm name, if the store carries the registry (`lpc list --json`)."""
        try:
            registry = json.loads(self.meta.get("registry", "{}"))
        except json.JSONDecodeError:
            registry = {}
        roles, summaries = {}, {}
        for entry in registry.get("algorithms", []) if isinstance(registry, dict) else []:
            roles[entry["name"]] = entry.get("role", "competitor")
            summaries[entry["name"]] = entry.get("summary", "")
        return roles, summaries

    def role(self, label):
        """Of a method label such as `gjk_epa{simplex=johnson}` or `catto+linear`; competitor where nothing is known."""
        name = str(label).split("{")[0].split("+")[0]
        return self.roles.get(name, "witness" if name in ("fcl", "libccd", "bullet") else "competitor")

    def sweeps(self):
        return list(dict.fromkeys(self.planned["sweep"]))

    def sweeps_of(self, stem):
        """Sweeps of a theme: `resolvers` is also `resolvers_full` and `quick_resolvers`."""
        return [name for name in self.sweeps() if stem in name]

    def series(self, key, name):
        """One value per step, or None where the trial stored none of that name."""
        row = self.db.execute("SELECT data FROM series WHERE key=? AND name=?", (key, name)).fetchone()
        return None if row is None else np.frombuffer(row[0], dtype="<f8")

    def series_names(self, key):
        return [row[0] for row in self.db.execute("SELECT name FROM series WHERE key=? ORDER BY rowid", (key,))]

    def poses(self, key, dimension):
        """{step: array of rows}: slot, position, rotation (2D: angle; 3D: quaternion w x y z)."""
        width = 4 if dimension == 2 else 8
        rows = self.db.execute("SELECT step, data FROM poses WHERE key=? ORDER BY step", (key,))
        return {step: np.frombuffer(data, dtype="<f8").reshape(-1, width) for step, data in rows}

    def benchmarks(self):
        return [(row[0], json.loads(row[1])) for row in self.db.execute("SELECT imported, data FROM benchmark ORDER BY id")]

    def ledger(self):
        """What `lpc verify` wrote: one row per method, kinds of shape and value of one axis; histograms as dictionaries."""
        ledger = pd.read_sql("SELECT * FROM ledger ORDER BY stage, precision, dimension, axis, value, kind_a, kind_b, method",
                             self.db)
        ledger["histogram"] = [json.loads(text) if text else {} for text in ledger["histogram"]]
        # Without an answer there is no error; a zero stays one.
        ledger["max_error"] = pd.to_numeric(ledger["max_error"]).where(ledger["histogram"].map(bool))
        return ledger

    def cells(self, stem):
        """All cells of the sweeps of a theme, one row each: axes, outcome, reason, step, metrics, keys of the trials."""
        if stem not in self._cells:
            rows = []
            for sweep in self.sweeps_of(stem):
                rows += self._cells_of(sweep)
            self._cells[stem] = pd.DataFrame(rows)
        return self._cells[stem].copy()

    def _cells_of(self, sweep):
        groups = {}
        for entry in self.planned[self.planned["sweep"] == sweep].itertuples():
            identity = json.dumps({k: v for k, v in entry.axes.items() if k not in WITHIN_CELL}, sort_keys=True)
            groups.setdefault(identity, []).append(entry)
        return [self._cell(sweep, entries) for entries in groups.values()]

    def _cell(self, sweep, entries):
        axes = {k: v for k, v in entries[0].axes.items() if k not in WITHIN_CELL}
        have = [entry.key for entry in entries if entry.key in self.trials.index]
        trials = self.trials.loc[have]
        cell = {"sweep": sweep, **axes, "method": method_of(axes), "planned_trials": len(entries),
                "finished_trials": len(have), "outcome": NOT_RUN, "reason": "planned, no result in the store",
                "step": np.nan, "key": None, "key_timed": None, "machine": None}
        if not have:
            return cell
        worst = max(trials.itertuples(), key=lambda t: SEVERITY.index(t.outcome) if t.outcome in SEVERITY else 1)
        cell.update(outcome=worst.outcome, reason=worst.reason or "", step=np.nan if worst.step is None else worst.step)
        if len(have) < len(entries):
            cell["reason"] = "; ".join(filter(None, [cell["reason"], f"{len(entries) - len(have)} of {len(entries)} "
                                                     "trials not run"]))
        timed = trials[trials["timed"] == 1]
        untimed = trials[trials["timed"] != 1]
        facts = untimed if len(untimed) else timed
        cell["key"] = facts.index[0]
        for name, value in facts.iloc[0]["metrics"].items():
            if not is_time(name) or not len(timed):
                cell[_free(name, axes)] = np.nan if value is None else value
        if len(timed):
            # Machines do not mix: times come from the machine with most repeats, the others are counted as refused.
            machine = timed["machine"].mode().iloc[0] if timed["machine"].notna().any() else None
            same = timed if machine is None else timed[timed["machine"] == machine]
            cell.update(key_timed=same.index[0], machine=machine, refused_repeats=len(timed) - len(same))
            for name in dict.fromkeys(name for metrics in same["metrics"] for name in metrics if is_time(name)):
                values = [metrics[name] for metrics in same["metrics"] if metrics.get(name) is not None]
                cell[_free(name, axes)] = float(np.median(values)) if values else np.nan
                if values and name.endswith("_median"):
                    cell[name[:-6] + "lo"], cell[name[:-6] + "hi"] = min(values), max(values)
        return cell

    def started(self):
        times = sorted(t for t in self.trials["started"] if t)
        return (times[0], times[-1]) if times else ("", "")


def _free(metric, axes):
    return "metric_" + metric if metric in axes else metric


def method_of(axes):
    for name in METHOD_AXES:
        if name in axes:
            return str(axes[name])
    return "default"


def varying(cells, but=()):
    """Axis columns of these cells with more than one value."""
    fixed = {"sweep", "method", "planned_trials", "finished_trials", "outcome", "reason", "step", "key", "key_timed",
             "machine", "refused_repeats", *but}
    return [c for c in cells.columns if c not in fixed and cells[c].map(str).nunique() > 1]


def split(cells, names, sort=False):
    """The cells in groups that agree in these axes; all in one group when there are none."""
    if not names:
        return [cells]
    return [part for _, part in cells.groupby(names[0] if len(names) == 1 else names, sort=sort, dropna=False)]


def axes_of(store, cells):
    """Names of all axes that the sweeps of these cells have."""
    planned = store.planned[store.planned["sweep"].isin(cells["sweep"].unique())]
    return {name for axes in planned["axes"] for name in axes}


def one_machine(cells):
    """(cells whose times may be compared, sentences naming those that may not)."""
    if "machine" not in cells or cells["machine"].nunique(dropna=True) < 2:
        return cells, []
    kept = cells["machine"].mode().iloc[0]
    other = cells["machine"].notna() & (cells["machine"] != kept)
    refused = [f"{row.method}: timed on machine {int(row.machine)}, the others on machine {int(kept)}"
               for row in cells[other].itertuples()]
    cells = cells.copy()
    for name in cells.columns:
        if is_time(name):
            cells.loc[other, name] = np.nan
    return cells, sorted(set(refused))
