# SPDX-License-Identifier: Zlib
"""When a difference of times counts: the noise floor, measured over repeats. Ranks over seeds are in ranking.py.

Times of one cell differ from repeat to repeat. The *noise floor* is the ratio by which a method differs from itself: the median
of its even repeats against that of its odd ones. Both were measured in the same rounds as all other methods. A ratio of two times
counts if it exceeds the floor and the intervals of the two medians do not overlap. Otherwise the difference is noise.

The floor is that of the whole sweep, whichever cells a chart shows. Each role has its own floor, because a method in a separate
process is noisier.
"""

import math
import numbers

import numpy as np

import measured
from sentences import listing, plural

UNMEASURED = 2.0  # the floor if too few repeats measure one: smaller ratios never count
FEWEST = 4  # repeats of a cell that measure a floor: two even and two odd
SURE = 0.9  # least probability that an interval contains the median
LIKELY = 95  # percent of the comparisons of a method with itself that lie below the floor
NOISE, FEW, SAME_WORK = "noise", "too few repeats", "identical work"  # why no ratio is reported (said)
IN_WORDS = {NOISE: "within the noise", FEW: "with too few repeats to measure a difference"}


def interval(found):
    """(low, high): order statistics that contain the median with probability SURE or more, for any distribution: the smallest and
    largest of five values, the second and ninth of ten. Fewer than five values give their whole span."""
    ordered = sorted(found)
    if not ordered:
        return math.nan, math.nan
    n, cut = len(ordered), 0
    while 2 * (cut + 1) < n and 1 - 2 * sum(math.comb(n, k) for k in range(cut + 2)) / 2**n >= SURE:
        cut += 1
    return ordered[cut], ordered[n - 1 - cut]


def wilson(failed, count):
    """(low, high): Wilson's interval, which contains the probability of a failure with 95 %. After 0 failures of 20 that
    probability may still be one in six."""
    z = 1.959964  # of 95 %
    share, scale = failed / count, 1 + z * z / count
    middle = (share + z * z / (2 * count)) / scale
    half = z / scale * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return max(0.0, middle - half) if failed else 0.0, min(1.0, middle + half) if failed < count else 1.0


def certainty(count):
    """The probability, in percent, that the interval of `count` values contains the median."""
    return math.floor(100 * min(SURE, 1 - 2 / 2**count))


def with_itself(cells, metric):
    """Ratios of the median of a cell's even repeats to that of its odd ones, one ratio per cell."""
    found = []
    for _, cell in cells.iterrows():
        mine = measured.runs(cell, metric)
        if len(mine) >= FEWEST and min(mine) > 0:
            found.append(float(np.median(mine[::2]) / np.median(mine[1::2])))
    return found


def floor(cells, metric):
    """The ratio below which two times of these cells count as equal: LIKELY percent of the ratios of methods to themselves are
    nearer to 1. UNMEASURED if there are too few repeats."""
    ratios = [abs(math.log(ratio)) for ratio in with_itself(cells, metric)]
    return math.exp(float(np.percentile(ratios, LIKELY, method="higher"))) if ratios else UNMEASURED


class Floor(float):
    """The floor of a sweep: the largest that was measured. For two methods `between` gives the larger floor of their roles.
    `cells_of`: {role: number of cells that measure it}; `few`: whether other cells have too few repeats."""

    def __new__(cls, of_role, role_of, cells_of, few):
        self = super().__new__(cls, max([v for v in of_role.values() if v != UNMEASURED], default=UNMEASURED))
        self.of_role, self.role_of, self.cells_of, self.few = of_role, role_of, cells_of, few
        return self

    def between(self, a, b):
        return max(self.of_role.get(self.role_of(cell.get("method")), self) for cell in (a, b))


def floor_of(context, sweep, metric):
    """The floor of a sweep. Charts never measure a floor on the cells that they show: few cells give too small a floor."""
    if (sweep, metric) not in context.floors:
        parts = by_role(context, sweep)
        context.floors[sweep, metric] = Floor({role: floor(part, metric) for role, part in parts}, context.store.role,
                                              {role: len(with_itself(part, metric)) for role, part in parts},
                                              any(has_few(cell, metric) for _, part in parts for _, cell in part.iterrows()))
    return context.floors[sweep, metric]


def by_role(context, sweep):
    """[(role, cells)] of a sweep."""
    cells = context.store.cells(sweep)
    roles = np.array([context.store.role(method) for method in cells["method"]]) if len(cells) else np.array([])
    return [(role, cells[roles == role]) for role in dict.fromkeys(sorted(roles))]


def has_few(cell, metric):
    """Whether a cell has too few repeats to measure a floor."""
    return 0 < len(measured.runs(cell, metric)) < FEWEST


def between(least, a, b, metric):
    """The floor for two cells: `least`, or that of their roles. At least UNMEASURED if one of them has too few repeats."""
    few = has_few(a, metric) or has_few(b, metric)
    return max(least.between(a, b) if isinstance(least, Floor) else least, UNMEASURED if few else 1.0)


def silence(least):
    """Why no ratio is reported: NOISE if the floor of the sweep was measured, otherwise FEW."""
    return FEW if least == UNMEASURED else NOISE


def work(cell):
    """The work counts of a cell, by name."""
    return {name: value for name, value in cell.items() if isinstance(name, str) and name.startswith("work_") and
            isinstance(value, numbers.Real) and math.isfinite(value)}


def same_work(a, b):
    """Whether all work counts of two cells are equal, in the same dimension and precision. Their times then differ by noise or by
    uncounted work only."""
    mine, other = work(a), work(b)
    return a.get("arithmetic") == b.get("arithmetic") and bool(mine) and any(mine.values()) and mine == other


def ratio(a, b, metric):
    """b / a; NaN if one of them is unknown."""
    before, after = (float(cell[metric]) if cell is not None and cell.get(metric) is not None else math.nan for cell in (a, b))
    return after / before if before > 0 else math.nan


def tells(a, b, metric, least):
    """Whether the ratio of two cells' times exceeds the noise; `least` is the floor of their sweep."""
    found = ratio(a, b, metric)
    if not math.isfinite(found) or found <= 0 or max(found, 1 / found) <= between(least, a, b, metric):
        return False
    (low_a, high_a), (low_b, high_b) = interval(measured.runs(a, metric)), interval(measured.runs(b, metric))
    return not (low_a <= high_b and low_b <= high_a)  # with unknown intervals only the floor decides


def above(cell, metric, bound, least):
    """Whether a time exceeds a bound by more than the noise. Too few repeats to measure a floor give no room above the bound."""
    value, (low, _) = float(cell[metric]), interval(measured.runs(cell, metric))
    room = least.between(cell, cell) if isinstance(least, Floor) else least
    return value > bound and value > bound * (1.0 if room == UNMEASURED else room) and not low <= bound


def leaders(cells, metric, least):
    """The fastest of these cells and those that tie with it, the fastest first."""
    found = sorted((cell for _, cell in cells.iterrows() if math.isfinite(float(cell[metric]))), key=lambda cell: cell[metric])
    return [cell for cell in found if cell is found[0] or not tells(found[0], cell, metric, least)]


def said(a, b, metric, least):
    """A ratio of times as text, or why there is none: "1.43", NOISE, FEW, SAME_WORK; empty if a time is unknown."""
    found = ratio(a, b, metric)
    if not math.isfinite(found):
        return ""
    if same_work(a, b):
        return SAME_WORK
    if tells(a, b, metric, least):
        return f"{found:.2f}"
    return silence(between(least, a, b, metric)) if all(len(measured.runs(cell, metric)) >= FEWEST for cell in (a, b)) else FEW


def inside(count):
    """The cells that a floor contains, of `count` that measure it: `floor` takes the largest ratio of up to 20."""
    return f"{LIKELY} of 100 cells" if count > 20 else plural(count, "cell")


def percent(least):
    """A floor in percent, as text."""
    share = 100 * (least - 1)
    return f"{share:.2g}" if share < 100 else f"{share:,.0f}"


def rule(least):
    """For the note of a chart: which ratios count."""
    if least == UNMEASURED:
        return (f"Too few repeats to measure the noise: a ratio counts if it exceeds {UNMEASURED:g} and the two whiskers do not "
                "overlap.")
    known = {role: v for role, v in least.of_role.items() if v != UNMEASURED} if isinstance(least, Floor) else {"": least}
    noise = listing(f"{percent(v)} %{f' ({role})' if len(known) > 1 else ''} in "
                    f"{inside(least.cells_of[role] if role else math.inf)} with enough repeats" for role, v in known.items())
    few = f" Cells with fewer than {FEWEST} repeats need a ratio over {UNMEASURED:g}." if getattr(least, "few", False) else ""
    return (f"A method differs from itself by up to {noise}. A ratio counts if it exceeds that and the two whiskers do not "
            f"overlap; otherwise it is noise.{few}")


def idle_seeds(cells):
    """A warning if all seeds give the same final state in every cell."""
    several = [(len(found), len(set(found))) for found in ([h for h in hashes if h] for hashes in cells["hashes"])
               if len(found) > 1]
    if not several or any(different > 1 for _, different in several):
        return []
    return [f"seeds change nothing here: all {max(planned for planned, _ in several)} end in the same state, bit for bit (the "
            "scene parameter `perturb` would start each seed from other positions)"]
