# SPDX-License-Identifier: Zlib
"""Which method is better beyond doubt: what all charts that rank have in common.

Methods are compared seed by seed, since runs of one seed start alike. What is told is the median of log(b / a) over the seeds,
with an interval of order statistics: it holds the median whatever the distribution is, and a zero or a failure is only the end
of the scale. Of k methods each of the k (k - 1) / 2 pairs is compared, so each interval leaves out LEVEL divided by so many
(Bonferroni): all of them together hold with 95 %. A ratio whose interval holds 1 is a tie.

A rank is that of a method. What another method has computed in its place has none (`fallbacks`), and numbers of 24 bits have none
among those of 53.
"""

import math
from collections import Counter

import measured
import metrics
from sentences import listing, plural


LEVEL = 0.05  # chance that one interval or more of a rank does not hold its median
START, TOUCHING = "penetration_start", 1e-6  # m
FALLBACKS, FROZEN = "work_fallbacks", "fallbacks"  # rows left to Gauss-Seidel: per step of a world, of a frozen problem
ENOUGH = 20  # seeds of a sweep that ranks: they tell of 21 methods who is better under 19 of 20


def comparisons(count):
    """Of so many methods, all pairs; of fewer than two, one."""
    return max(1, count * (count - 1) // 2)


def left_out(count, many=1):
    """How many values at each end an interval of so many leaves out; -1 where all of them are too few to hold the median as
    surely as one of `many` intervals must."""
    below, cut = 0.0, -1
    while 2 * (cut + 1) < count:
        below += math.comb(count, cut + 1) / 2**count
        if 2 * below > LEVEL / many:
            break
        cut += 1
    return cut


def fewest(many=1):
    """Seeds below which nothing can be told of one of `many` pairs."""
    count = 1
    while left_out(count, many) < 0:
        count += 1
    return count


def interval(values, many=1):
    """(low, high) of the median, one of `many`; without end where they are too few."""
    ordered, cut = sorted(values), left_out(len(values), many)
    return (ordered[cut], ordered[-1 - cut]) if cut >= 0 else (-math.inf, math.inf)


def by_seed(cells, metric):
    """{seed: value} of one method's cells (a Series or several rows); infinite where a seed failed."""
    rows = [cells] if getattr(cells, "ndim", 1) == 1 else [cell for _, cell in cells.iterrows()]
    found = {}
    for cell in rows:
        values = measured.of_seeds(cell, metric)
        seeds = cell.get("seeds")
        named = isinstance(seeds, (list, tuple)) and len(seeds) == len(values)
        found |= dict(zip(seeds if named else range(len(values)), values))
    return found


def log_ratio(a, b, zero=0.0):
    """log(b / a); what is not above `zero` is `zero`, and what failed is beyond all that did not."""
    a, b = max(a, zero), max(b, zero)
    if a == b:
        return 0.0
    return math.inf if a == 0 or math.isinf(b) else -math.inf if b == 0 or math.isinf(a) else math.log(b / a)


def log_ratios(a, b, metric, zero=0.0):
    """log(b / a) under each seed that both have."""
    mine, other = by_seed(a, metric), by_seed(b, metric)
    return [log_ratio(mine[seed], other[seed], zero) for seed in mine if seed in other]


def ratio(a, b, metric, zero=0.0, many=1):
    """(median, low, high) of b over a."""
    found = sorted(log_ratios(a, b, metric, zero))
    if not found:
        return math.nan, 0.0, math.inf
    half = len(found) // 2
    ends = found[half - (len(found) % 2 == 0)], found[half]
    middle = ends[0] if ends[0] == ends[1] else (0.0 if math.isinf(ends[0]) and math.isinf(ends[1]) else sum(ends) / 2)
    return tuple(math.exp(v) if v < 700 else math.inf for v in (middle, *interval(found, many)))


def better(a, b, metric, zero=0.0, many=1, times=1.0):
    """Whether `b` has more than so many times what `a` has, beyond doubt, as one of `many` pairs. One start is no sample: of it
    only who has less."""
    found, least = log_ratios(a, b, metric, zero), math.log(times)
    return found[0] > least if len(found) == 1 else bool(found) and interval(found, many)[0] > least


def overlapping(cells):
    """The deepest overlap (m) at the start, where it is more than that of bodies that touch: no method has made it."""
    found = [v for _, cell in cells.iterrows() for v in [cell.get(START, math.nan), *measured.seeds(cell, START)]]
    deepest = max([v for v in found if v == v], default=0.0)
    return deepest if deepest > TOUCHING else 0.0


def share_of_fallbacks(context, cell):
    """Share of the rows of a cell that its method left to Gauss-Seidel; 0 where none is counted, NaN where rows are not known."""
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
    """{index: why this cell has no rank among these}."""
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
    """The cells that are ranked."""
    return cells.drop(index=list(excused(context, cells)))


def unranked(context, cells):
    """{method: why cells of it have no rank}; of several cells the largest share."""
    why = {}
    for index, said in excused(context, cells).items():
        why.setdefault(cells["method"][index], []).append(said)
    return {method: largest(said) for method, said in sorted(why.items())}


def largest(said):
    """Of several reasons the largest share; empty where there is none."""
    return max(said, key=lambda text: float(text.split(" %")[0]) if " %" in text else 0.0, default="")


def whole(context, cells):
    """The cells of methods of which each cell is ranked: where a method has one number for all of its cells."""
    return cells[~cells["method"].isin(list(unranked(context, cells)))]


def names(context, cells):
    """{method: its name with what keeps it from a rank}: `admm (62 % Gauss-Seidel)`, `box2d (engine, f32 among f64)`."""
    why = unranked(context, cells)
    return {method: beside(context.name(method), why.get(method, "")) for method in cells["method"]}


def beside(name, why):
    """A name with the reason why it has no rank, where there is one."""
    if not why:
        return name
    return f"{name[:-1]}, {why})" if name.endswith(")") else f"{name} ({why})"


def tail(context, cells):
    """A sentence on what has no rank; empty where all have one."""
    return told(unranked(context, cells))


def tail_of(context, places):
    """The same of [(where, cells)]: where several places have ranks of their own, it says where."""
    return told({method + (f" on {where}" if len(places) > 1 else ""): why for where, cells in places
                 for method, why in unranked(context, cells).items()})


def told(why):
    """`why`: {name: why it has no rank}; those with one reason are told together."""
    groups = {}
    for name, said in why.items():
        groups.setdefault(said, []).append(name)
    return f" Not ranked: {'; '.join(f'{listing(names)} ({said})' for said, names in groups.items())}." if why else ""


def raw(context, error):
    """Which depth ranks, where there are two."""
    return (f" What ranks is raw: {context.title(error)}. Beyond the slop that each method keeps on purpose it is in the table."
            if error in metrics.BEYOND_SLOP else "")


def rule(seeds, *methods):
    """What a reader must know of the ranks of a chart. `methods`: how many have a rank, of each panel or budget: each is compared
    with each other there."""
    if max(methods, default=0) < 2:
        return "Fewer than two methods have a rank here."
    return rule_of_pairs(seeds, *map(comparisons, methods))


def rule_of_pairs(seeds, *many):
    most = max(many, default=1)
    pairs = f"{'up to ' if len(set(many)) > 1 else ''}{plural(most, 'pair')}"
    if seeds < 2:
        return "One start: an order of these runs and no rank, which takes seeds."
    if seeds < fewest(most):
        return f"{seeds} seeds tell nothing of {pairs}, which takes {fewest(most)}: all tie."
    return (f"A method is better when the interval of its median ratio over {seeds} seeds, paired, does not hold 1, with 95 % "
            f"for {pairs} together (order statistics, Bonferroni): here where it is so under "
            f"{seeds - left_out(seeds, most)} seeds. Else the two tie.")
