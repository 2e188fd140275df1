# SPDX-License-Identifier: Zlib
"""A chart: its question, its finding (finding.py), the figure, the numbers behind it, and what is missing.

A kind of chart is one function in a file of charts/, where it is found automatically; a file holds the kinds of one subject.
Under `@of_sweeps`, with the needs of the chart, the function gets the cells of each sweep that meets them. Under `@of_store` it
gets the whole store. It returns charts. Where it returns none, the page says what is missing.
"""

import importlib
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Callable, Optional

import pandas as pd

import finding
import load
import metrics
from finding import Finding
from sentences import listing
from style import Looks


@dataclass(frozen=True)
class Headline:
    """A chart's entry on the first screen of the page: a sentence of at most 30 words, and the numbers that it compares. They
    rank the entry and are drawn small beside it (headlines.py)."""
    text: str  # empty: the headline of the chart's finding
    values: dict  # name -> number; NaN for a failure
    unit: str = "1"
    quantity: str = ""  # name of the numbers
    larger: bool = False  # whether larger is better; failures are then drawn at the lower end
    ends: dict = field(default_factory=dict)  # name -> hashes of its final states (final_states); may lack names

    @property
    def effect(self):
        """The ratio of the largest number to the smallest; 1000 for a zero or a failure beside another number."""
        known = [value for value in self.values.values() if math.isfinite(value)]
        if not known or len(known) == len(self.values) and max(known) <= 0:
            return 1.0
        return min(1000.0, max(known) / min(known) if min(known) > 0 and len(known) == len(self.values) else 1000.0)


@dataclass
class Chart:
    id: str
    section: str  # its question; the page groups charts by question
    title: str
    finding: Finding  # computed from the data; a text is a headline without a table
    sweep: str  # the sweep that made the data
    figure: object = None  # None without data; the finding then says why
    table: pd.DataFrame = field(default_factory=pd.DataFrame)
    holes: list = field(default_factory=list)  # sentences: missing or refused data, with the reason
    note: str = ""  # one line on how to read the chart
    others: tuple = ()  # further sweeps that made the data
    made_by: str = ""  # arguments of `lpc` where no sweep made the data
    telling: bool = False  # whether `--chart best` may choose it
    headline: Optional[Headline] = None  # only for a difference that is larger than the noise

    def __post_init__(self):
        if isinstance(self.finding, str):
            self.finding = Finding(self.finding)
        if self.headline is not None and not self.headline.text:
            self.headline = replace(self.headline, text=self.finding.headline)


@dataclass(frozen=True)
class Needs:
    """The needs of a chart: what a sweep must have."""
    kind: str  # of its trials: world, boxes, pairs
    varies: tuple = ()  # axes with several values
    fixed: tuple = ()  # axes, or roles of axes (load.Sweep), with one value
    methods: tuple = (1, math.inf)  # least and largest number of methods
    metrics: tuple = ()  # metrics of a finished cell; without a finished cell the plan decides
    series: tuple = ()  # series that the chart reads
    also: str = ""  # further needs that its function checks, in words
    calibrated: Optional[bool] = False  # whether the runner calibrated the methods to budgets; None: either


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of chart: @of_sweeps or @of_store makes it from the function that draws."""
    name: str  # in a sweep's `report = [...]`
    place: int  # on the page
    absent: Chart  # shown where no chart is made
    make: Callable  # (context, cells of a sweep) or (context) -> charts
    needs: Optional[Needs] = None  # None: made from the whole store

    @property
    def file(self):
        return Path(self.make.__code__.co_filename).name


def of_sweeps(name, place, section, needs, title, absent, sweep):
    """Makes the function below a kind of chart, called for each sweep that meets its needs. Where none does, the page shows
    `absent` under `title`, and the command of `sweep`, which would make one. `lpc` reads the name in the text of the file
    (locations.cpp)."""
    return lambda make: Kind(name, place, Chart(name, section, title, absent, sweep), make, needs)


def of_store(name, place, section, title, absent, sweep="", made_by=""):
    """As of_sweeps, but called once, for the whole store."""
    return lambda make: Kind(name, place, Chart(name, section, title, absent, sweep, made_by=made_by), make)


def of_asked(*words):
    """As of_store, for all sweeps together that list it in `report`."""
    return of_store(*words)


def kinds():
    """All kinds of charts, in the order of the page."""
    files = sorted(path.stem for path in (Path(__file__).parent / "charts").glob("*.py"))
    modules = [importlib.import_module(f"charts.{file}") for file in files]
    found = [kind for module in modules for kind in vars(module).values() if isinstance(kind, Kind)]
    return sorted(found, key=lambda kind: (kind.place, kind.name))


def made(kind, context):
    """The charts of one kind."""
    charts = _made(kind, context)
    for chart in charts if finding.strict else ():
        for text in filter(None, (chart.finding.headline, chart.headline and chart.headline.text)):
            assert not finding.fault(text), f"{chart.id}: {finding.fault(text)}"
        assert len(chart.finding.table) <= finding.ROWS, f"{chart.id}: {len(chart.finding.table)} rows of a finding"
    return charts


def _made(kind, context):
    if kind.needs is None:
        return kind.make(context) or [kind.absent]
    sweeps = context.store.sweeps()
    if context.store.metrics:  # none in an old store of benchmarks alone
        context.check(kind)
    found = [chart for sweep in sweeps if context.has(sweep, kind)
             for chart in kind.make(context, context.cells(sweep, kind.needs.metrics))]
    found += [_asked_for(kind, sweep, context) for sweep in sweeps
              if kind.name in context.store.sweep(sweep).report and sweep not in {c.sweep for c in found}]
    elsewhere = [name for name in sweeps if (about := context.store.sweep(name)).kind == kind.needs.kind
                 and about.report and kind.name not in about.report]  # sweeps that are for other charts
    if found or not elsewhere:
        return found or [kind.absent]
    return [replace(kind.absent, holes=[f"Not used for this chart: {listing(elsewhere)}. The `report` of "
                                        f"{'this sweep' if len(elsewhere) == 1 else 'these sweeps'} lists other charts."])]


def _asked_for(kind, sweep, context):
    """Stands for a chart that a sweep lists in `report` without the data for it. Names only what the sweep lacks."""
    absent, needs = kind.absent, kind.needs
    wanted = (needs.also or "a cell that it can draw") if context.has(sweep, kind) else described(needs)
    return Chart(identifier(f"{sweep} {absent.id}"), absent.section, f"{absent.title}: {sweep}",
                 f"The `report` of {sweep} lists this chart, but the sweep lacks its data.", sweep,
                 holes=[f"The chart needs {wanted}."])


def described(needs):
    parts = [f"trials of kind {needs.kind}", *(f"several values of {axis}" for axis in needs.varies)]
    parts += ["calibrated methods"] if needs.calibrated else []
    if needs.metrics:
        parts.append(f"{listing(needs.metrics)} in a finished cell")
    parts += [needs.also] if needs.also else []
    return listing(parts)


class Context:
    """The context of every chart function."""

    def __init__(self, store):
        self.store = store
        self.ids = []  # of all charts made so far, kept or not
        self._looks, self._varying = {}, {}
        self.floors = {}  # (sweep, metric) -> noise.Floor, on first use

    def check(self, kind):
        """Raises UserError for a need that no store has: a chart with a misspelt name would never be made."""
        try:
            for name in kind.needs.metrics:
                metrics.find(self.store, name)
            for name in kind.needs.series:
                self.store.series("", name)
        except load.UserError as error:
            raise load.UserError(f"{kind.file}: {error}") from error

    def has(self, sweep, kind):
        """Whether a sweep meets the needs of this kind of chart. For a sweep with a `report`, `methods` and `fixed` do not
        count."""
        about, cells, needs = self.store.sweep(sweep), self.store.cells(sweep), kind.needs
        if not len(cells) or about.kind != needs.kind or needs.calibrated not in (None, bool(about.calibrate)):
            return False
        if about.report and kind.name not in about.report:
            return False
        if sweep not in self._varying:
            self._varying[sweep] = load.varying(self.store, cells)
        several = self._varying[sweep]
        low, high = needs.methods
        if not about.report and (not low <= cells["method"].nunique() <= high or any(
                axis in needs.fixed or about.roles.get(axis) in needs.fixed for axis in several)):
            return False
        return set(needs.varies) <= set(several) and all(self._holds(sweep, cells, metric) for metric in needs.metrics)

    def _holds(self, sweep, cells, name):
        if self.store.is_time(name):  # the plan says what is timed
            axes = self.store.planned[self.store.planned["sweep"] == sweep]["axes"]
            return any(cell.get("timed") for cell in axes)
        done = cells[cells["finished_trials"] > 0]
        return not len(done) or metrics.find(self.store, name).compute is not None or done[name].notna().any()

    def cells(self, sweep, names=()):
        """The cells of a sweep, with all metrics that trials measure and the computed metrics `names`."""
        return metrics.add(self.store, self.store.cells(sweep), names)

    def metrics(self, kind, *roles):
        """Names of the metrics of these roles, the most important first."""
        return [name for name, m in metrics.known(self.store).items() if m.kind == kind and m.role in roles and "*" not in name]

    def metric(self, name):
        return metrics.find(self.store, name)

    def title(self, name):
        return metrics.find(self.store, name).title

    def unit(self, name):
        return metrics.find(self.store, name).unit

    def floor(self, name):
        return metrics.find(self.store, name).floor

    def baseline(self, cells):
        """The baseline method of the sweep of these cells; empty where it has none. Where several stages vary it is the first
        method with the baseline among its parts."""
        named = self.store.sweep(cells["sweep"].iloc[0]).baseline
        having = [label for label in sorted(set(cells["method"])) if named in label.split(load.JOINED)]
        return having[0] if having else named

    def settings(self, cells):
        """Numeric axes that are settings of the methods, such as iterations, and that vary; most values first."""
        about = self.store.sweep(cells["sweep"].iloc[0])
        found = [axis for axis in load.varying(self.store, cells) if about.roles.get(axis) == "setting" and
                 pd.api.types.is_numeric_dtype(cells[axis].dropna().infer_objects())]
        return sorted(found, key=lambda axis: -cells[axis].nunique())

    def parameters(self, cells):
        """Numeric axes that make the scene harder: its parameters, and the time step."""
        about = self.store.sweep(cells["sweep"].iloc[0])
        return [axis for axis in load.varying(self.store, cells) if (about.roles.get(axis) == "parameter" or axis == "dt") and
                pd.api.types.is_numeric_dtype(cells[axis].dropna().infer_objects())]

    def name(self, label):
        """A label for legends and axes; witnesses and engines have their role beside it."""
        role = self.store.role(label)
        return label if role == "competitor" else f"{label} ({role})"

    def looks(self, cells):
        """Colours and markers of the methods of these cells."""
        return self._looks_of(self._group_of(cells["sweep"].iloc[0]))

    def looks_of_stage(self, stage):
        return self._looks_of(self._groups().get(stage, stage))

    def _groups(self):
        """Stage -> group; methods of stages of one group share charts."""
        return {entry["stage"]: entry["group"] for entry in self.store.algorithms}

    def _group_of(self, sweep):
        axes, groups = self.store.method_axes(sweep), self._groups()
        if axes and axes[0] in groups:
            return groups[axes[0]]
        # Labels defined by the sweep: the group of most of their families.
        families = {load.family(label) for label in self.store.cells(sweep)["method"]}
        votes = [entry["group"] for entry in self.store.algorithms if entry["name"] in families]
        return max(sorted(set(votes)), key=votes.count) if votes else ""

    def _looks_of(self, group):
        if group not in self._looks:
            registered = [entry for entry in self.store.algorithms if entry["group"] == group]
            registered.sort(key=lambda entry: entry["role"] != "competitor")
            labels = {label for sweep in self.store.sweeps() if self._group_of(sweep) == group
                      for label in self.store.cells(sweep)["method"]}
            ledger = self.store.ledger()
            labels |= {method for stage, method in zip(ledger["stage"], ledger["method"])
                       if self._groups().get(stage, stage) == group}
            self._looks[group] = Looks(self.store, registered, sorted(labels))
        return self._looks[group]


def final_states(cells):
    """{method: the hashes of the final states of its cells}, for methods with all hashes."""
    found = {}
    for method, part in cells.groupby("method", sort=True):
        hashes = [found for of_cell in part["hashes"] for found in of_cell or [None]]
        if hashes and all(hashes):
            found[method] = tuple(hashes)
    return found


def describe(row, axes):
    """A cell in words: `vertical_stack, 2D, catto+linear, iterations=10`."""
    parts = []
    for name in axes:
        value = row.get(name)
        if value is None or value != value:
            continue
        if name == "dimension":
            parts.append(f"{int(value)}D")
        elif name in ("scene", "method", "model", "distribution"):
            parts.append(str(value))
        else:
            parts.append(f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}")
    return ", ".join(parts)


def holes(cells, axes, limit=12):
    """Sentences for the cells without a number in a chart; the page's list of failed trials has all of them."""
    bad = cells[cells["outcome"] != "ok"]
    said = []
    for _, row in bad.iterrows():
        step = "" if row["step"] != row["step"] else f" at step {int(row['step'])}"
        reason = f" ({row['reason']})" if row["reason"] else ""
        said.append(f"{describe(row, axes)}: {row['outcome']}{step}{reason}")
    more = len(said) - limit
    return said[:limit] + ([f"and {more} more, listed under “Failed and missing trials”"] if more > 0 else [])


def identifier(text):
    return "".join(c if c.isalnum() else "_" for c in text.lower()).strip("_")


def dimension_of(cells):
    return cells["dimension"].astype(int) if "dimension" in cells else pd.Series(2, index=cells.index)
