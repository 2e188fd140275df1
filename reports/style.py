# SPDX-License-Identifier: Zlib
"""The look of charts: fixed colours of algorithms, log axes with a place for zero and for failures, labels."""

import gc
import math
import textwrap
import zlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.patheffects as patheffects  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker as ticker  # noqa: E402

from load import family  # noqa: E402

# Okabe and Ito's palette without its yellow and black, continued by Paul Tol's muted one: both suit colour-blind readers.
PALETTE = ["#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#332288", "#882255", "#44AA99", "#999933",
           "#661100", "#777777"]
# For more families than colours: the dark ones lightened, the light ones darkened.
SHADES = ["#8C3E00", "#66AAD1", "#00573F", "#7A3E61", "#8A5F00", "#1F6F9E", "#8A7FC9", "#C98AA3", "#1E5F55", "#5A5A10",
          "#B5806F", "#333333"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "d", "*"]  # distinct at the size of a legend
OUTCOMES = {"ok": ("#DCE9F2", ""), "not run": ("#FFFFFF", "?"), "sank": ("#F3DFA2", "S"), "frozen": ("#A9CCE3", "F"),
            "left": ("#8C6BB1", "L"), "collapsed": ("#E69F00", "C"),
            "exploded": ("#D55E00", "E"), "diverged": ("#000000", "N"), "timeout": ("#332288", "T"),
            "crash": ("#661100", "X"), "wrong": ("#CC79A7", "W"), "out_of_memory": ("#44AA99", "M"),
            "unsupported": ("#BBBBBB", "U"), "nondeterministic": ("#999933", "D")}
RIGHT, REFUSED, NOT_ASKED = "#E3F0E8", "#B9CFE4", "#F2F2F2"  # of verdicts
WIDTH = 11.6  # inches at 100 dots: the page's column
gc.set_threshold(100_000)  # charts keep many small objects: collecting every 700 took a tenth of the time of a report

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9.5, "axes.titlesize": 10.5, "axes.labelsize": 9.5,
    "xtick.labelsize": 8.5, "ytick.labelsize": 8.5, "legend.fontsize": 8.5, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#E6E6E6", "grid.linewidth": 0.6,
    "axes.axisbelow": True, "lines.linewidth": 1.6, "lines.markersize": 5.5, "figure.dpi": 100,
    "figure.max_open_warning": 0,  # a report's figures are all made before they are written
    # The same store gives the same bytes.
    "svg.hashsalt": "lpc", "svg.fonttype": "path", "legend.frameon": False, "axes.titlelocation": "left"})


class Looks:
    """Colour and marker of each method label of one pool: the methods that can be in one chart.

    The family of the label (`catto` of `catto+linear`) gives the colour, the member the marker. The looks of registered names
    depend on the registry alone, so a label looks the same on all pages. Other labels take the looks that are left.
    """

    def __init__(self, store, registered, labels):
        """`registered`: entries of the registry in this pool, in the registry's order; `labels`: all labels that are drawn."""
        self.store, self.families, self.looks = store, {}, {}
        stages = {}
        for entry in registered:
            stages.setdefault(entry["stage"], []).append(entry["name"])
        # `+linear` shifts the marker by the same number in each family: its place among the names of its stage.
        self.shifts = {"+" + name: 1 + place for names in stages.values() for place, name in enumerate(sorted(names))}
        for name in [entry["name"] for entry in registered] + sorted({family(label) for label in labels}):
            self._enter(name)
        everyone = [*self.families, *sorted(set(labels) - set(self.families), key=lambda label: (self._member(label) not in
                                                                                                self.shifts, label))]
        taken = set()
        for label in everyone:
            slot, member = self.families[family(label)], self._member(label)
            marker = 7 * slot + (self.shifts.get(member, zlib.crc32(member.encode())) if member else 0)
            colours = PALETTE + SHADES
            # A family with more members than markers continues in the other shade of its colour.
            tried = [(colours[place % len(colours)], MARKERS[(marker + step) % len(MARKERS)])
                     for place in (slot, slot + len(PALETTE)) for step in range(len(MARKERS))]
            self.looks[label] = next((look for look in tried if look not in taken), tried[0])
            taken.add(self.looks[label])

    @staticmethod
    def _member(label):
        return label[len(family(label)):]

    def _enter(self, name):
        """Gives a family the slot of its name's hash, or the next free slot: of the palette first, then of its shades."""
        if name in self.families:
            return
        used = set(self.families.values())
        ring = len(self.families) // len(PALETTE)  # rings fill one after another
        first = zlib.crc32(name.encode())
        slots = [ring * len(PALETTE) + (first + step) % len(PALETTE) for step in range(len(PALETTE))]
        self.families[name] = next(slot for slot in slots if slot not in used)

    def __call__(self, label):
        """Keyword arguments for plot(). Witnesses and engines are drawn hollow and dashed."""
        colour, marker = self.looks[label]
        look = {"color": colour, "marker": marker, "markersize": plt.rcParams["lines.markersize"] * scale_of(marker)}
        if self.store.role(label) != "competitor":
            look.update(markerfacecolor="white", linestyle="--")
        return look


def scale_of(marker):
    """Factor of a marker's size: a star looks smaller than a disc of the same size."""
    return 1.6 if marker == "*" else 1.0


def letter(outcome):
    """The marker of a failed run: the letter of its outcome, upright."""
    return f"$\\mathbf{{{OUTCOMES.get(outcome, ('', '?'))[1] or '?'}}}$"


HALO = [patheffects.withStroke(linewidth=2.5, foreground="white")]  # keeps a letter readable on lines


def fallen(ax, spots, **kwargs):
    """Draws letters of failed runs at (x, y, outcome, colour); letters that would overlap become one letter with their number.
    Call it last: the limits of the axes are fixed from then on."""
    if not spots:
        return
    ax.update_datalim([spot[:2] for spot in spots])
    ax.autoscale_view()
    ax.autoscale(False)
    dots, box = ax.figure.dpi / 72, ax.get_window_extent()
    places = ax.transData.transform([(x, y) for x, y, *_ in spots])
    groups = [([i], places[i]) for i in np.argsort(places[:, 0], kind="stable")]
    merged = True
    while merged:
        merged = False
        for i, (members, middle) in enumerate(groups):
            near = next((j for j, (others, at) in enumerate(groups[i + 1:], i + 1) if abs(middle[1] - at[1]) < 9 * dots and
                         abs(middle[0] - at[0]) < (_wide(spots, members) + _wide(spots, others)) / 2 * dots), None)
            if near is not None:
                members = members + groups.pop(near)[0]
                half = _wide(spots, members) / 2 * dots
                x, y = places[members].mean(axis=0)
                groups[i] = (members, (min(max(x, box.x0 + half), max(box.x1 - half, box.x0 + half)), y))
                merged = True
                break
    for members, middle in groups:
        colours, text = {spots[i][3] for i in members}, _counted(spots, members)
        colour = colours.pop() if len(colours) == 1 else "#444444"
        if len(members) == 1:
            ax.plot(*[[v] for v in spots[members[0]][:2]], ls="none", marker=letter(spots[members[0]][2]), ms=7, mew=0.3,
                    color=colour, zorder=4, **{"clip_on": False, **kwargs})
        else:
            ax.text(*ax.transData.inverted().transform(middle), text, ha="center", va="center", fontsize=8, fontweight="bold",
                    color=colour, zorder=4, path_effects=kwargs.get("path_effects"))


def _counted(spots, members):
    letters = [OUTCOMES.get(spots[i][2], ("", "?"))[1] or "?" for i in members]
    return " ".join(f"{one}×{letters.count(one)}" if len(members) > 1 else one for one in dict.fromkeys(letters))


def _wide(spots, members):
    """Width of the letters of these spots in points, with room beside them."""
    return 7.0 * len(_counted(spots, members)) + 3


def same(curves):
    """{method: the first method with the same points}: lines that coincide are drawn once. A curve without a finite point is no
    line."""
    curves, firsts = {method: np.asarray(points, float) for method, points in curves.items()}, {}
    drawn = {method: np.isfinite(np.atleast_2d(points)).all(axis=0).any() for method, points in curves.items()}
    return {method: firsts.setdefault(points.tobytes() if drawn[method] else method, method) for method, points in curves.items()}


def one_line(ax, firsts, words):
    """Writes above the axes which methods coincide, in `words` of a group. Without room it writes their number alone, and returns
    the words for the caption."""
    groups = [[m for m in firsts if firsts[m] == first] for first in dict.fromkeys(firsts.values())]
    groups = [group for group in groups if len(group) > 1]
    room = int(ax.get_position().width * ax.figure.get_figwidth() / 0.067)
    told, unnamed = "; ".join(f"{words(group)} coincide" for group in groups), ""
    lines = textwrap.wrap("; ".join(f"{words(group)} coincide" for group in groups), room)
    if len(lines) > 1:
        apart = f" in {len(groups)} groups" if len(groups) > 1 else ""  # a curve may be a point
        lines = textwrap.wrap(f"{sum(map(len, groups))} methods coincide{apart}", room)
        unnamed = told
    if lines:
        ax.text(0, 1.02, "\n".join(lines), transform=ax.transAxes, va="bottom", fontsize=8, color="#555555")
        if ax.get_title("left"):
            ax.set_title(ax.get_title("left"), pad=7 + 10.5 * len(lines))
    return unnamed


def caption_of_lines(found):
    """The end of a caption, from [(panel, words that one_line returned)]."""
    panels = {}
    for panel, words in found:
        if words:
            panels.setdefault(words, []).append(panel)
    said = [f"{'; '.join(dict.fromkeys(names))}: {words}." for words, names in panels.items()]
    return "".join(f" {text[0].upper()}{text[1:]}" for text in said)


def figures(value, digits=3):
    """A number with three digits; from a thousand to a million all digits, without a power of ten."""
    rounded = float(f"{value:.{digits - 1}e}")  # 999.6 is 1,000
    return f"{value:,.0f}" if 10**digits <= abs(rounded) < 1e6 else f"{value:.{digits}g}"


def si(value, unit="", digits=3):
    """A number with its unit: 0.00123 m -> 1.23 mm. Zero stays 0."""
    if value is None or math.isnan(value):
        return "unknown"
    if math.isinf(value):
        return "never" if unit == "s" else "infinite"
    if value == 0:
        return "0" if unit == "1" else f"0 {unit}".strip()
    if unit in ("ms", "ns", "us"):
        value, unit = value * {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit], "s"
    if unit in ("", "1", "J", "kg m/s", "rad"):
        return f"{figures(value, digits)} {'' if unit == '1' else unit}".strip()
    if abs(value) < 1e-15:
        return f"{value:.1e} {unit}"
    power = min(3, max(-15, 3 * math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))) / 3)))  # 999.6 ns is 1 µs
    if unit == "m":
        power = min(0, power)
    prefix = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k"}[power]
    return f"{figures(value / 10**power, digits)} {prefix}{unit}"


def times(ratio):
    """A ratio as text."""
    short = f"{ratio:.1f}"
    if short in ("0.0", "1.0"):  # the ratio differs from both
        return f"{ratio:.2g}" if ratio < 0.5 else f"{ratio:.2f}"
    return short if ratio < 20 else f"{ratio:,.0f}"


def _tick(value, unit):
    if unit in ("m", "s", "ms", "ns", "us", "m/s"):
        return si(value, unit, 3)
    power = round(math.log10(value))
    if 1e-2 <= value < 1e6:
        return f"{value:,.0f}" if value >= 1 else f"{value:g}"
    if abs(value / 10.0**power - 1) < 1e-9:
        return f"$10^{{{power}}}$"
    short = f"{value:.0e}"
    return short if abs(float(short) / value - 1) < 1e-9 else f"{value:.1e}"  # 1.5e-04 is not 2e-04


def _ticks(low, high, most):
    """Round values between 10^low and 10^high: decades, 1-2-5 or every digit, at most `most`."""
    first, last = math.ceil(low - 1e-9), math.floor(high + 1e-9)
    decades = [10.0**p for p in range(first, last + 1)]
    if len(decades) >= 3 or len(decades) > most:
        return decades[::max(1, math.ceil(len(decades) / most))]
    for digits in ((1, 2, 5), (1, 1.5, 2, 3, 4, 5, 6, 8)):
        found = [d * 10.0**p for p in range(math.floor(low), last + 1) for d in digits]
        found = [v for v in found if low - 1e-9 <= math.log10(v) <= high + 1e-9]
        if len(found) >= 3 or (digits[1] == 1.5):
            return found[::max(1, math.ceil(len(found) / most))]
    return decades


def _apart(ticks, kept, inch_of, which):
    """Ticks with labels that do not touch: first those in `kept`, then the others in order."""
    found = {}
    for value in sorted(ticks, key=lambda v: (v not in kept, v)):
        if all(abs(inch_of(value) - inch_of(other)) > _BESIDE[which] + (_inches(ticks[value], which) +
                                                                        _inches(ticks[other], which)) / 2 for other in found):
            found[value] = ticks[value]
    return found


_BESIDE = {"x": 0.12, "y": 0.05}  # inches between labels of ticks: more where they are side by side


def _inches(label, which):
    """Length of a tick's label along its axis; a power of ten is shorter than its text."""
    return 0.12 if which == "y" else 0.075 * (4 if label.startswith("$") else len(label))


class ZeroLog:
    """A log axis with places for zeros, left of (below) a gap at "0", and for failures, beyond the other end.

    `place` gives the position of a value: its own, that of zeros, or that of failures for NaN and infinity. Values up to `floor`
    are drawn with the zeros; the label then says so.
    """

    def __init__(self, ax, which, values, unit="", failures=None, failed_name="failed", floor=0.0):
        finite = [math.log10(v) for v in values if math.isfinite(v) and v > floor]
        low, high = (min(finite), max(finite)) if finite else (-1, 1)
        if high - low < 0.5:
            low, high = (low + high) / 2 - 0.25, (low + high) / 2 + 0.25
        self.floor = floor
        self.has_zero = any(v <= floor for v in values if math.isfinite(v))
        self.has_failed = any(not math.isfinite(v) for v in values) if failures is None else failures
        inches = ax.get_position().width * ax.figure.get_figwidth() if which == "x" else (
            ax.get_position().height * ax.figure.get_figheight())
        pad = 0.06 * (high - low)
        low, high = low - pad, high + pad
        gap = (0.2 if which == "x" else 0.11) * (high - low) * max(1.0, 2.4 / inches)
        self.zero, self.failed = 10.0**(low - gap), 10.0**(high + gap)
        getattr(ax, f"set_{which}scale")("log")
        bottom = low - gap * 1.6 if self.has_zero else low
        top = high + gap * 1.6 if self.has_failed else high
        getattr(ax, f"set_{which}lim")(10.0**bottom, 10.0**top)
        share = (high - low) / (top - bottom)
        most = max(2, int(inches * share / (0.66 if which == "x" else 0.3)))
        ticks = {v: _tick(v, unit) for v in _ticks(low, high, most) if v >= floor}  # smaller values are drawn with the zeros
        if self.has_zero:
            below = any(0 < v <= floor for v in values)
            ticks[self.zero] = f"<{si(floor, unit)}" if below else "0"
        if self.has_failed:
            ticks[self.failed] = failed_name
        ticks = _apart(ticks, {self.zero, self.failed}, lambda v: inches * (math.log10(v) - bottom) / (top - bottom), which)
        axis = getattr(ax, which + "axis")
        axis.set_major_locator(ticker.FixedLocator(sorted(ticks)))
        axis.set_major_formatter(ticker.FixedFormatter([ticks[t] for t in sorted(ticks)]))
        axis.set_minor_locator(ticker.NullLocator())
        span = ax.axhspan if which == "y" else ax.axvspan
        line = ax.axhline if which == "y" else ax.axvline
        if self.has_zero:
            span(10.0**bottom, 10.0**(low - gap * 0.4), color="#F3F7F0", zorder=0, lw=0)
            line(10.0**(low - gap * 0.4), color="#999999", lw=0.8, ls=(0, (4, 3)), zorder=0.5)
        if self.has_failed:
            span(10.0**(high + gap * 0.4), 10.0**top, color="#FBEDE6", zorder=0, lw=0)
            line(10.0**(high + gap * 0.4), color="#999999", lw=0.8, ls=(0, (4, 3)), zorder=0.5)

    def place(self, value):
        if not math.isfinite(value):
            return self.failed
        return self.zero if value <= self.floor else value


def plain_log(ax, which, values, unit=""):
    """A log axis with readable ticks for values that are all positive (body counts, iterations)."""
    return ZeroLog(ax, which, values, unit, failures=False)


def direct_labels(ax, ends, size=8.5):
    """Labels right of the axes at the ends of lines, moved apart so that they do not overlap. ends: (y, text, colour)."""
    if not ends:
        return
    to_axes = ax.transAxes.inverted()
    height = ax.get_window_extent().height
    gap = size * 1.3 * ax.figure.dpi / 72 / height
    spots = sorted([to_axes.transform(ax.transData.transform((ax.get_xlim()[1], y)))[1], y, text, colour]
                   for y, text, colour in ends)
    wanted = [spot[0] for spot in spots]
    for i in range(1, len(spots)):
        spots[i][0] = max(spots[i][0], spots[i - 1][0] + gap)
    excess = spots[-1][0] - max(1.0, wanted[-1])
    for i in range(len(spots) - 1, -1, -1):
        above = spots[i + 1][0] - gap if i + 1 < len(spots) else spots[i][0] - max(0.0, excess)
        spots[i][0] = min(spots[i][0], above)
    for (place, _, text, colour), origin in zip(spots, wanted):
        ax.plot([1.0, 1.025], [origin, place], transform=ax.transAxes, color=colour, lw=0.8, clip_on=False)
        ax.text(1.032, place, text, transform=ax.transAxes, color=colour, size=size, va="center", clip_on=False)


def grid_of_axes(rows, columns, row_height, legend_width=0.0, width=WIDTH, top=0.45, bottom=0.6, left=0.85, gap_x=0.85,
                 gap_y=0.75, **kwargs):
    """Axes with sizes in inches, and room at the right for a legend or direct labels."""
    height = top + bottom + rows * row_height + (rows - 1) * gap_y
    edge = 0.35 if legend_width else 0.15  # half of the last label of an axis goes beyond its end
    cell = (width - left - legend_width - edge - (columns - 1) * gap_x) / columns
    figure, axes = plt.subplots(rows, columns, figsize=(width, height), squeeze=False, **kwargs)
    figure.subplots_adjust(left=left / width, right=1 - (legend_width + edge) / width, top=1 - top / height,
                           bottom=bottom / height, wspace=gap_x / cell, hspace=gap_y / row_height)
    return figure, axes


def legend_room(names, least):
    """Width (inches) of a legend with these names."""
    return max([least] + [0.62 + 0.074 * len(name) for name in names])


def legend_right(figure, handles, legend_width, title=None, width=WIDTH):
    """A legend in the room that grid_of_axes leaves; the figure grows where the legend is higher."""
    figure.set_figheight(max(figure.get_figheight(), 0.35 + 0.2 * len(handles) + (0.2 if title else 0)))
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(1 - legend_width / width, 0.97), title=title,
                  alignment="left", borderaxespad=0, labelspacing=0.55, handlelength=1.8)
