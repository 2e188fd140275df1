# SPDX-License-Identifier: Zlib
"""What the number of a metric in a cell is the median of. The number itself is the column of the metric's name; the column
MEASURED has, by metric, what stands behind it."""

import math
from dataclasses import dataclass

MEASURED = "measured"  # {metric: Measured}


@dataclass(frozen=True)
class Measured:
    runs: tuple = ()  # the value of each repeat, of what is a time
    seeds: tuple = ()  # that of each seed, NaN where it failed; empty where the cell has one seed


def of(cell, metric):
    """Empty where the cell has one value, or none."""
    found = cell.get(MEASURED)
    return found.get(metric, Measured()) if isinstance(found, dict) else Measured()


def known(values):
    return [float(value) for value in values if value is not None and math.isfinite(value)]


def runs(cell, metric):
    return known(of(cell, metric).runs)


def seeds(cell, metric):
    return known(of(cell, metric).seeds)


def of_seeds(cell, metric):
    """The values of all seeds, infinite where a seed failed; a cell of one seed has one."""
    found = of(cell, metric).seeds
    if found:
        return [math.inf if v is None or v != v else float(v) for v in found]
    value = cell.get(metric)
    return [math.inf if value is None or value != value or cell["outcome"] != "ok" else float(value)]


def add(cells, metric, values):
    """Enters what stands behind a metric that is worked out: one Measured for each of these cells, which are changed."""
    cells[MEASURED] = [{**found, metric: value} for found, value in zip(cells[MEASURED], values)]
