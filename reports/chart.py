# SPDX-License-Identifier: Zlib
"""What a chart is: the question, one sentence found in the data, the figure, the numbers behind it, its holes."""

from dataclasses import dataclass, field

import pandas as pd

from style import Looks


@dataclass
class Chart:
    id: str
    section: str  # the question of its section; charts of one question stand together
    title: str
    finding: str  # one sentence computed from the data
    sweep: str  # the sweep that made the data
    figure: object = None  # None when there was nothing to draw; the finding then says why
    table: pd.DataFrame = field(default_factory=pd.DataFrame)
    holes: list = field(default_factory=list)  # sentences: what is missing or refused and why
    note: str = ""  # how to read it
    made_by: str = ""  # arguments of `lpc` where no sweep made the data


class Context:
    """What every chart function gets."""

    def __init__(self, store):
        self.store = store
        self.ids = []  # of all charts made so far, kept or not
        families = [("broadphase",), ("pair_quer",), ("resolver", "breaking", "unneeded", "precision", "stages")]
        labels = []
        for family in families:
            found = set()
            for stem in family:
                cells = store.cells(stem)
                found |= set(cells["method"]) if len(cells) else set()
            if family[0] == "pair_quer":  # a verification asks the same methods
                found |= set(store.ledger().query("stage == 'pair_query'")["method"])
            labels.append(sorted(found))
        self.looks = Looks(store, labels)


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
    """Sentences for the cells that have no number in a chart; the coverage table lists all of them in any case."""
    bad = cells[cells["outcome"] != "ok"]
    said = []
    for _, row in bad.iterrows():
        step = "" if row["step"] != row["step"] else f" at step {int(row['step'])}"
        reason = f" ({row['reason']})" if row["reason"] else ""
        said.append(f"{describe(row, axes)}: {row['outcome']}{step}{reason}")
    more = len(said) - limit
    return said[:limit] + ([f"and {more} more, all listed under Coverage"] if more > 0 else [])


def dimension_of(cells):
    return cells["dimension"].astype(int) if "dimension" in cells else pd.Series(2, index=cells.index)


def plural(count, one, many=None):
    return f"{count} {one if count == 1 else many or one + 's'}"


def listing(names):
    names = list(names)
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1] if names else "none"


def methods(names, everyone):
    """Method labels in a sentence; a whole family of three or more (`catto+...`) is named once."""
    names, said, done = list(names), [], set()
    for name in names:
        family = [m for m in everyone if m.split("+")[0] == name.split("+")[0]]
        if len(family) >= 3 and all(m in names for m in family):
            if family[0] not in done:
                said.append(f"all {len(family)} {name.split('+')[0]} variants")
            done |= set(family)
        else:
            said.append(name)
    return listing(said)
