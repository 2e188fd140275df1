# SPDX-License-Identifier: Zlib
"""Which method is significantly better: the rules of all charts that rank.

Methods are compared seed by seed, because runs with one seed start alike. The statistic is the median of log(b / a) over the
seeds. Its interval consists of order statistics, which are valid for any distribution; a zero or a failure is an end of the
scale.
k methods make k (k - 1) / 2 pairs, so each interval uses LEVEL divided by the number of pairs (Bonferroni): all of them hold
together with 95 %. Two methods tie if the interval of their ratio contains 1.

A method that left rows to its fallback, Gauss-Seidel, has no rank. Nor has a method in f32 among methods in f64.
"""

import math
from collections import Counter

import measured
import metrics
from finding import Line
from sentences import listing, plural

LEVEL = 0.05  # probability that any interval of a ranking misses its median
START, TOUCHING = "penetration_start", 1e-6  # m
FALLBACKS, FROZEN = "work_fallbacks", "fallbacks"  # rows left to Gauss-Seidel: mean per step of a world; of a frozen problem
ENOUGH = 20  # seeds of a sweep that ranks: with 21 methods, the better one must win under 19 of 20 seeds


def comparisons(count):
    """The number of pairs of `count` methods, at least one."""
    return max(1, count * (count - 1) // 2)


def left_out(count, many=1):
    """How many of `count` values the interval leaves out at each end; -1 if even all of them are too few for one of `many`
    intervals."""
    below, cut = 0.0, -1
    while 2 * (cut + 1) < count:
        below += math.comb(count, cut + 1) / 2**count
        if 2 * below > LEVEL / many:
            break
        cut += 1
    return cut


def fewest(many=1):
    """The least number of seeds that can decide one of `many` pairs."""
    count = 1
    while left_out(count, many) < 0:
        count += 1
    return count


def interval(values, many=1):
    """(low, high) of the median, as one of `many` intervals; infinite if there are too few values."""
    ordered, cut = sorted(values), left_out(len(values), many)
    return (ordered[cut], ordered[-1 - cut]) if cut >= 0 else (-math.inf, math.inf)


def by_seed(cells, metric):
    """{seed: value} of one method's cells (a Series or several rows); infinite for a seed that failed."""
    rows = [cells] if getattr(cells, "ndim", 1) == 1 else [cell for _, cell in cells.iterrows()]
    found = {}
    for cell in rows:
        values = measured.of_seeds(cell, metric)
        seeds = cell.get("seeds")
        named = isinstance(seeds, (list, tuple)) and len(seeds) == len(values)
        found |= dict(zip(seeds if named else range(len(values)), values))
    return found


def log_ratio(a, b, zero=0.0):
    """log(b / a). Values up to `zero` count as `zero`; a failure (infinity) is worse than any value."""
    a, b = max(a, zero), max(b, zero)
    if a == b:
        return 0.0
    return math.inf if a == 0 or math.isinf(b) else -math.inf if b == 0 or math.isinf(a) else math.log(b / a)


def log_ratios(a, b, metric, zero=0.0):
    """log(b / a) for each seed that both have."""
    mine, other = by_seed(a, metric), by_seed(b, metric)
    return [log_ratio(mine[seed], other[seed], zero) for seed in mine if seed in other]


def ratio(a, b, metric, zero=0.0, many=1):
    """(median, low, high) of b / a."""
    found = sorted(log_ratios(a, b, metric, zero))
    if not found:
        return math.nan, 0.0, math.inf
    half = len(found) // 2
    ends = found[half - (len(found) % 2 == 0)], found[half]
    middle = ends[0] if ends[0] == ends[1] else (0.0 if math.isinf(ends[0]) and math.isinf(ends[1]) else sum(ends) / 2)
    return tuple(math.exp(v) if v < 700 else math.inf for v in (middle, *interval(found, many)))


def better(a, b, metric, zero=0.0, many=1, times=1.0):
    """Whether `b` is significantly more than `times` as large as `a`, as one of `many` pairs. With one seed the values alone
    decide."""
    found, least = log_ratios(a, b, metric, zero), math.log(times)
    return found[0] > least if len(found) == 1 else bool(found) and interval(found, many)[0] > least


def overlapping(cells):
    """The deepest penetration (m) at the start if it exceeds that of touching bodies, otherwise 0: no method caused it."""
    found = [v for _, cell in cells.iterrows() for v in [cell.get(START, math.nan), *measured.seeds(cell, START)]]
    deepest = max([v for v in found if v == v], default=0.0)
    return deepest if deepest > TOUCHING else 0.0


def share_of_fallbacks(context, cell):
    """The share of a cell's rows that its method left to Gauss-Seidel; 0 if none is counted, NaN if the row count is unknown."""
    told = [cell.get(FROZEN) or 0.0, cell.get(FALLBACKS) or 0.0, *measured.seeds(cell, FALLBACKS)]
    left = max([value for value in told if value == value], default=0.0)
    if not left > 0:
        return 0.0
    if (cell.get(FROZEN) or 0.0) > 0:
        rows = cell.get("rows")
        return min(1.0, left / rows) if rows is not None and rows > 0 else math.nan
    points = context.store.series(cell["key"], "points") if cell.get("key") else None
    joints = cell.get("joint_error_max")
    if points is None or not len(points) or not sum(points) > 0 or joints is not None and joints == joints:
        return math.nan
    dimension = cell["arithmetic"][0] if isinstance(cell.get("arithmetic"), tuple) else cell.get("dimension")
    return min(1.0, left / (dimension * float(sum(points)) / len(points)))


def said_of_share(share):
    return "rows by Gauss-Seidel" if share != share else f"{max(1, round(100 * share))} % Gauss-Seidel"


def precision(cell):
    known = cell.get("arithmetic")
    found = known[1] if isinstance(known, tuple) else cell.get("precision")
    return found if isinstance(found, str) else ""


def excused(context, cells):
    """{index: why this cell has no rank among these cells}."""
    known = Counter(found for _, cell in cells.iterrows() if (found := precision(cell)))
    ruling = min(known, key=lambda name: (-known[name], name != "f64")) if known else ""
    why = {}
    for index, cell in cells.iterrows():
        share = share_of_fallbacks(context, cell)
        if share != 0:
            why[index] = said_of_share(share)
        elif precision(cell) not in ("", ruling):
            why[index] = f"{precision(cell)} among {ruling}"
    return why


def eligible(context, cells):
    """The cells that have a rank."""
    return cells.drop(index=list(excused(context, cells)))


def unranked(context, cells):
    """{method: why its cells have no rank}, with the largest share of its cells."""
    why = {}
    for index, said in excused(context, cells).items():
        why.setdefault(cells["method"][index], []).append(said)
    return {method: largest(said) for method, said in sorted(why.items())}


def largest(said):
    """The reason with the largest share; empty if there is none."""
    return max(said, key=lambda text: float(text.split(" %")[0]) if " %" in text else 0.0, default="")


def whole(context, cells):
    """The cells of methods with a rank in all cells, for charts with one number per method."""
    return cells[~cells["method"].isin(list(unranked(context, cells)))]


def names(context, cells):
    """{method: its name with the reason why it has no rank}: `admm (62 % Gauss-Seidel)`, `box2d (engine, f32 among f64)`."""
    why = unranked(context, cells)
    return {method: beside(context.name(method), why.get(method, "")) for method in cells["method"]}


def beside(name, why):
    """A name, with the reason why it has no rank if there is one."""
    if not why:
        return name
    return f"{name[:-1]}, {why})" if name.endswith(")") else f"{name} ({why})"


def lines(why, also=lambda name: {}):
    """Lines of a finding's table for methods without a value or rank, one line per reason. `why`: {name: reason}; `also`: more
    columns of a line, by the first of its names."""
    groups = {}
    for name, said in why.items():
        groups.setdefault(said, []).append(name)
    return [Line(listing(names), outcome=said, more=also(names[0])) for said, names in groups.items()]


def not_ranked(why):
    """{name: why it has no rank}, as outcomes of a finding's table."""
    return {name: f"not ranked: {said}" for name, said in why.items()}


def raw(context, error):
    """For the note of a chart: which of two depths ranks."""
    return (f" Ranks use the raw depth, {context.title(error)}; the numbers have the depth beyond each method's slop, too."
            if error in metrics.BEYOND_SLOP else "")


def rule(seeds, *methods):
    """For the note of a chart: how methods are ranked. `methods`: the number of ranked methods of each panel or budget, which are
    all compared with each other."""
    if max(methods, default=0) < 2:
        return "Fewer than two methods have a rank here."
    return rule_of_pairs(seeds, *map(comparisons, methods))


def rule_of_pairs(seeds, *many):
    most = max(many, default=1)
    pairs = f"{'up to ' if len(set(many)) > 1 else ''}{plural(most, 'pair')}"
    if seeds < 2:
        return "One seed: this is an order of single runs; a ranking needs more seeds."
    if seeds < fewest(most):
        return f"{seeds} seeds cannot decide {pairs}, which takes {fewest(most)}: all methods tie."
    return (f"A method is better if it wins under {seeds - left_out(seeds, most)} of {seeds} seeds, paired; otherwise the two "
            f"tie. Then the interval of the median ratio excludes 1, with 95 % for {pairs} together (order statistics, "
            "Bonferroni).")
