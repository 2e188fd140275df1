# SPDX-License-Identifier: Zlib
"""The single values behind a cell's metric, of which the metric's column has the median. The column MEASURED has them by
metric."""

import math
from dataclasses import dataclass

MEASURED = "measured"  # {metric: Measured}


@dataclass(frozen=True)
class Measured:
    runs: tuple = ()  # the value of each repeat, for a time
    seeds: tuple = ()  # the value of each seed, NaN where it failed; empty for a cell with one seed


def of(cell, metric):
    """The values behind a metric of a cell; empty where it has one value or none."""
    found = cell.get(MEASURED)
    return found.get(metric, Measured()) if isinstance(found, dict) else Measured()


def known(values):
    return [float(value) for value in values if value is not None and math.isfinite(value)]


def runs(cell, metric):
    return known(of(cell, metric).runs)


def seeds(cell, metric):
    return known(of(cell, metric).seeds)


def of_seeds(cell, metric):
    """The value of each seed, infinite where the seed failed; one value for a cell with one seed."""
    found = of(cell, metric).seeds
    if found:
        return [math.inf if v is None or v != v else float(v) for v in found]
    value = cell.get(metric)
    return [math.inf if value is None or value != value or cell["outcome"] != "ok" else float(value)]


def add(cells, metric, values):
    """Enters the values behind a computed metric into these cells, one Measured per cell."""
    cells[MEASURED] = [{**found, metric: value} for found, value in zip(cells[MEASURED], values)]
