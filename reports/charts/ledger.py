# SPDX-License-Identifier: Zlib
"""The ledger of verifications: which method is wrong or gives no answer, and time against error of pair queries."""

import math
from collections import Counter

import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle

import failure
import noise
from chart import Chart, Headline, of_store
from finding import Finding, cut, fits
from load import family
from sentences import clauses, listing, methods, plural, some, verb
from style import NOT_ASKED, REFUSED, RIGHT, WIDTH, ZeroLog, direct_labels, grid_of_axes, legend_right, plt
from table import quantity

SECTION = "Which method is right, and which fails where?"
COUNTS = ("asked", "agree", "tie", "wrong", "wrong_side", "undecided", "refused", "not_finite", "threw", "crashed", "hung",
          "capped")
NOUNS = {"pair_query": "pair queries", "contacts": "contact generators", "broadphase": "broadphases"}
FLOOR = 1e-17  # smaller errors count as 0: a tenth of the rounding of one operation in double precision


MANY = 30  # columns with cells too narrow for decimals
LABELS = 6  # most numbers beside a panel: more cannot be matched with their marks
PARTS, MADE_BY = ["stage", "dimension", "precision"], "verify --pairs 200"


@of_store("ledger", 80, SECTION,
          "Ledgers with failures", "This store has no ledger with a failure.", made_by=MADE_BY)
def ledger(context):
    ledger = context.store.ledger()
    made = []
    for (stage, dimension, precision), part in ledger.groupby(["stage", "dimension", "precision"], sort=True):
        if failure.in_ledger(part):  # ledgers without a failure share one matrix (ledger_clean)
            made.append(_heat_map(context, part, stage, dimension, precision))
        if stage == "pair_query":
            made.append(_cost(context, part, dimension, precision))
    order = list(NOUNS)
    return sorted(made, key=lambda c: order.index(next(s for s in order if s in c.id)))


def median_error(histogram):
    """The lower end of the decade that contains the median: 0 for exact zeros, NaN if there is no answer."""
    decades = sorted((-math.inf if name == "zero" else float(name), count) for name, count in histogram.items() if count)
    total, below = sum(count for _, count in decades), 0
    for decade, count in decades:
        below += count
        if 2 * below >= total:
            return 0.0 if math.isinf(decade) else 10.0**decade
    return math.nan


def added(histograms):
    total = {}
    for histogram in histograms:
        for name, count in histogram.items():
            total[name] = total.get(name, 0) + count
    return total


def by_method(rows):
    """One row per method, summed over kinds of shape, with the worst case."""
    found = []
    for method, part in rows.groupby("method", sort=True):
        asked = int(part["asked"].sum())
        worst = part.loc[part["max_error"].fillna(-1).idxmax()]
        found.append({"method": method, "role": part["role"].iloc[0], **{name: int(part[name].sum()) for name in COUNTS},
                      "failed": failure.in_ledger(part), "side alone": _without_value(part),
                      "max_error": float(worst["max_error"]) if part["max_error"].notna().any() else math.nan,
                      "median_error": median_error(added(part["histogram"])),
                      "ns": float(part["ns"].sum()) / asked if asked else math.nan, "worst": worst["worst"] or ""})
    # LPC's methods first, then the witnesses.
    return pd.DataFrame(found).sort_values(["role", "method"], kind="stable").reset_index(drop=True)


def _without_value(part):
    """For pair queries: the number of answers that are judged by the side only, because the method claims no distance."""
    values = sum(added(part["histogram"]).values())
    if part["stage"].iloc[0] != "pair_query":
        return 0
    return int(sum(part[name].sum() for name in ("agree", "tie", "wrong"))) - values


def finding(stage, dimension, precision, rows):
    """Which of LPC's methods fail, and which witness fails most; a row per method that fails, and the clean ones together."""
    found, noun = by_method(rows), NOUNS.get(stage, stage)
    found["share"] = found["failed"] / found["asked"]
    ours, others = found[found["role"] == "competitor"], found[found["role"] != "competitor"]
    bad = ours[ours["failed"] > 0].sort_values("share", ascending=False)
    said = []
    if len(bad):
        first = bad.iloc[0]
        fails = f"{first['method']} fails most" if len(bad) > 1 else f"only {first['method']} fails"
        said.append(f"of LPC's {noun} {fails}, on {failure.share(first['share'])} of its questions")
    elif len(ours):
        said.append(f"none of LPC's {noun} fails on any of {int(ours['asked'].sum()):,} questions")
    if len(others):
        first, families = others.loc[others["share"].idxmax()], others["method"].map(family).nunique()
        witnesses = plural(families, "witness", "witnesses")
        if families < len(others):  # some are also asked at their library's tightest tolerance
            witnesses += f" in {len(others)} settings"
        said.append(f"of {witnesses}, {first['method']} fails most, on {failure.share(first['share'])}" if first["failed"] else
                    f"none of {witnesses} fails")
    return Finding(f"In {dimension}D, {precision}, {clauses(*said)}.", table_of(stage, found))


def table_of(stage, found):
    """Shares of failures, the methods that fail most first."""
    rows = []
    for row in found[found["failed"] > 0].sort_values("share", ascending=False, kind="stable").itertuples():
        lost = row.failed - row.wrong - row.refused
        parts = {name: "" if not count else failure.share(count / row.asked) for name, count in (
            ("wrong", row.wrong), ("refused", row.refused), ("other without an answer", lost))}
        rows.append({"method": row.method, "role": "LPC" if row.role == "competitor" else row.role,
                     "questions": row.asked, "fails": failure.share(row.share), **parts,
                     "largest error [1]": row.max_error, "remark": _sided(row, stage)})
    for role, part in found[found["failed"] == 0].groupby("role", sort=True):
        rows.append({"method": methods(part["method"], list(found["method"])), "role": "LPC" if role == "competitor" else role,
                     "questions": int(part["asked"].sum()), "fails": "0", "largest error [1]": part["max_error"].max()})
    table = pd.DataFrame(rows)
    if stage != "pair_query":
        table = table.drop(columns=[name for name in ("largest error [1]", "remark") if name in table])
    clean = range(int((found["failed"] > 0).sum()), len(table))
    ours = [i for i, role in enumerate(table["role"]) if role == "LPC"]
    table = table[[name for name in table if name in ("method", "questions") or table[name].fillna("").ne("").any()]]
    return cut(table, [*clean, *ours])


def _sided(row, stage):
    """Whether all failures of a pair query are wrong distances on the right side, as an approximate query may have."""
    right = stage == "pair_query" and row.failed == row.wrong and not row.wrong_side
    return "no wrong yes or no" if right else ""


def _value(text):
    """A value of an axis as text: a short number, or a name without underscores."""
    try:
        return f"{float(text):g}"
    except ValueError:
        return text.replace("_", " ")


def _order(column):
    try:
        return (0, float(column), "")
    except ValueError:
        return (1, 0.0, column)


def _pairs(rows):
    return ["–".join((a, b)) if a or b else "all" for a, b in zip(rows["kind_a"], rows["kind_b"])]


def _heat_map(context, rows, stage, dimension, precision):
    everything = rows[rows["axis"] == "all"].copy()
    everything["column"] = _pairs(everything)
    panels = [("by kinds of shape", everything)] if everything["column"].nunique() > 1 else []
    for axis in ("family", "regime", "scale", "offset"):
        part = rows[rows["axis"] == axis].copy()
        part["column"] = [_value(text) for text in part["value"]]
        if part["column"].nunique() > 1:
            panels.append((f"by {axis}", part))
    summary = by_method(everything)
    methods = list(summary["method"])
    figure, axes = _panel_axes(panels or [("all", everything)], context, methods)
    for (title, part), ax in zip(panels or [("all", everything)], axes):
        _panel(ax, part, methods)
        ax.set_title(title)
    for ax in axes:
        first = ax.get_position().x0 == min(a.get_position().x0 for a in axes)
        ax.set_yticklabels([context.name(m) for m in methods] if first else [])
    handles = [Patch(facecolor=RIGHT, label="0: never fails"), Patch(facecolor=plt.cm.Oranges(0.3), label="seldom fails"),
               Patch(facecolor=plt.cm.Oranges(0.85), label="often fails"),
               Patch(facecolor=REFUSED, label="only refuses"), Patch(facecolor=NOT_ASKED, label="–: not declared")]
    figure.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 0), ncol=5, handlelength=1.2)
    table = summary.drop(columns=["ns", "max_error", "median_error", "worst"]).assign(
        **quantity("time per question", "ns", summary["ns"]), **quantity("largest error", "1", summary["max_error"]),
        **quantity("median error", "1", summary["median_error"]), worst=summary["worst"])
    coarser = sorted(set(everything["method"][everything["judged"] != everything["precision"]]))
    tolerance = "none (exact)" if stage == "broadphase" else failure.tolerance(precision, coarser)
    return Chart(f"ledger_{stage}_{dimension}d_{precision}", SECTION,
                 f"Ledger of {NOUNS.get(stage, stage)}, {dimension}D, {precision}",
                 finding(stage, dimension, precision, everything),
                 "", figure, table, [],
                 "A cell is the share of questions that failed; blue: refused, blue corner: some refused. Tolerance: "
                 f"{tolerance}. {failure.DEFINITION} Witnesses were not made for this tolerance; the chart of shares within a "
                 "tolerance has all others. The numbers have the worst case of each method; lpc verify --cases replays it.",
                 headline=Headline("", dict(zip(methods, summary["failed"] / summary["asked"])),
                                   quantity="share of the questions that failed"),
                 made_by=f"verify --stage {stage} --dimension {dimension} --precision {precision} --pairs 200")


def _panel_axes(panels, context, methods):
    """Panels from left to right in rows, as many as fit; all rows have the height that the methods need."""
    left, right, cell, gap = 0.35 + 0.075 * max(len(context.name(m)) for m in methods), 0.2, 0.5, 0.25
    room, rows = WIDTH - left - right, []
    for title, part in panels:
        wide = part["column"].nunique() * cell
        if rows and sum(w + gap for _, w in rows[-1]) + wide <= room:
            rows[-1].append((title, wide))
        else:
            rows.append([(title, wide)])
    body, head, legend = 0.24 * len(methods), 0.3, 0.35
    labels = [0.3 + 0.034 * max(len(c) for title, part in panels if title in [t for t, _ in row] for c in part["column"])
              for row in rows]
    height = sum(body + head + foot for foot in labels) + legend
    figure = plt.figure(figsize=(WIDTH, height))
    axes, top = [], height
    for row, foot in zip(rows, labels):
        stretch = min(1.8, (room - gap * (len(row) - 1)) / sum(w for _, w in row))
        at = left
        for _, wide in row:
            axes.append(figure.add_axes((at / WIDTH, (top - head - body) / height, wide * stretch / WIDTH, body / height)))
            at += wide * stretch + gap
        top -= head + body + foot
    return figure, axes


def _whole(part):
    """A share for a narrow cell: in whole percent."""
    return failure.share(part) if part == 0 or part >= 0.1 else "<1%" if part < 0.005 else f"{100 * part:.0f}%"


def _panel(ax, rows, methods):
    columns = sorted(set(rows["column"]), key=_order)
    groups = {key: part for key, part in rows.groupby(["method", "column"])}
    for y, method in enumerate(methods):
        for x, column in enumerate(columns):
            colour, text, ink, corner = NOT_ASKED, "–", "#888888", False
            part = groups.get((method, column))
            asked = int(part["asked"].sum()) if part is not None else 0
            if asked:
                bad, refused = failure.in_ledger(part) / asked, int(part["refused"].sum()) / asked
                text, ink = _whole(bad) if len(columns) > MANY else failure.share(bad), "black"
                if bad > refused:
                    depth = min(1.0, max(0.0, 1 + math.log10(bad) / 4))
                    colour, ink, corner = plt.cm.Oranges(0.2 + 0.65 * depth), "white" if depth > 0.8 else "black", refused > 0
                elif refused:
                    colour = REFUSED
                else:
                    colour, ink = RIGHT, "#4C7A5E"
            ax.add_patch(Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, facecolor=colour, lw=0))
            if corner:
                ax.add_patch(Polygon([(x + 0.48, y - 0.45), (x + 0.48, y - 0.05), (x + 0.28, y - 0.45)], facecolor="#4F86B8",
                                     lw=0))
            ax.text(x, y, text, ha="center", va="center", fontsize=7, color=ink)
    ax.set_xlim(-0.5, len(columns) - 0.5)
    ax.set_ylim(len(methods) - 0.5, -0.5)
    ax.set_xticks(range(len(columns)))
    ax.set_xticklabels(columns, rotation=30, ha="right", fontsize=7.5)
    ax.set_yticks(range(len(methods)))
    ax.grid(False)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)


def _cost(context, rows, dimension, precision):
    rows = rows[(rows["axis"] == "all") & (rows["asked"] > 0)].copy()
    rows["pair"] = _pairs(rows)
    rows["median_error"] = [median_error(h) for h in rows["histogram"]]
    rows["share"] = [failure.in_ledger(row) / row["asked"] for _, row in rows.iterrows()]
    rows["time"] = rows["ns"] / rows["asked"]
    answered = rows["refused"] < rows["asked"]
    holes = [f"{row.method} on {row.pair}: refused all {row.asked:,} questions" for row in rows[~answered].itertuples()]
    rows = rows[answered]
    pairs, methods = sorted(rows["pair"].unique()), list(by_method(rows)["method"])
    looks = context.looks_of_stage("pair_query")
    columns = min(4 if len(methods) <= 5 else 3, len(pairs))
    legend_width = 0.6 + 0.068 * max(len(context.name(m)) for m in methods)
    figure, axes = grid_of_axes(math.ceil(len(pairs) / columns), columns, 1.95, legend_width + 0.5, left=0.75, gap_x=0.62,
                                gap_y=0.55)
    finite = [v for v in list(rows["max_error"]) + list(rows["median_error"]) if v == v and math.isfinite(v)]
    for index, ax in enumerate(axes.flat):
        if index >= len(pairs):
            ax.set_visible(False)
            continue
        part = rows[rows["pair"] == pairs[index]]
        across = ZeroLog(ax, "x", list(rows["time"]), "ns", failures=False)
        up = ZeroLog(ax, "y", finite, "1", floor=FLOOR, failures=bool(rows["max_error"].isna().any()))
        ends = []
        for row in part.itertuples():
            look, x = looks(row.method), across.place(row.time)
            worst = up.place(row.max_error)
            if math.isfinite(row.median_error):
                ax.plot([x, x], [up.place(row.median_error), worst], color=look["color"], lw=1.2, alpha=0.6)
                ax.plot([x], [up.place(row.median_error)], color=look["color"], marker="_", ms=8, mew=1.6, ls="none")
            ax.plot([x], [worst], **{**look, "linestyle": "none"})
            if row.share > 0:
                ends.append((worst, failure.share(row.share), look["color"]))
        ax.set_title(pairs[index])
        direct_labels(ax, ends if len(ends) <= LABELS else [], 7)
        if index % columns == 0:
            ax.set_ylabel("error / size")
        else:
            ax.tick_params(labelleft=False)
        if index + columns >= len(pairs):
            ax.set_xlabel("time per query")
    handles = [Line2D([], [], label=context.name(m), **looks(m)) for m in methods]
    handles.append(Line2D([], [], color="#555555", marker="_", ms=8, mew=1.6, ls="none", label="median error"))
    legend_right(figure, handles, legend_width)
    table = pd.DataFrame({"pair": rows["pair"], "method": rows["method"], "asked": rows["asked"],
                          **quantity("time per query", "ns", rows["time"]), **quantity("median error", "1", rows["median_error"]),
                          **quantity("worst error", "1", rows["max_error"]), **quantity("failed", "1", rows["share"])})
    return Chart(f"ledger_cost_pair_query_{dimension}d_{precision}", SECTION,
                 f"Pair queries of LPC and witnesses: time against error, {dimension}D, {precision}",
                 _cost_finding(rows, dimension, precision), "", figure, table.sort_values(["pair", "method"]), holes,
                 "A mark is the worst error of all questions, the dash the median (lower end of its decade), the number at the "
                 f"right the share that failed. Where more than {LABELS} methods fail, the chart of the ledger has these "
                 "shares. At least half of the questions are of families that broke libraries before. All "
                 f"questions are timed once together, so noise is unknown and only ratios beyond {noise.UNMEASURED:g} count. "
                 "Witnesses (hollow marks) are timed in their own process.",
                 made_by=f"verify --stage pair_query --dimension {dimension} --precision {precision} --pairs 200")


def _cost_finding(rows, dimension, precision):
    """Which methods without a failure are fastest on how many pairs of shapes, and how large their worst error is."""
    good, where = rows[rows["share"] == 0], f"In {dimension}D, {precision},"
    leaders = {pair: [cell["method"] for cell in noise.leaders(part, "time", noise.UNMEASURED)] if len(part) > 1 else []
               for pair, part in good.groupby("pair", sort=True)}
    only = {pair: part["method"].iloc[0] for pair, part in good.groupby("pair", sort=True) if len(part) == 1}
    counts = []
    for method, part in rows.groupby("method", sort=True):
        worst = part.loc[part["max_error"].fillna(-1).idxmax()]
        counts.append({"method": method, "role": "LPC" if worst["role"] == "competitor" else worst["role"],
                       "fastest on": sum(found == [method] for found in leaders.values()),
                       f"within {noise.UNMEASURED:g} times the fastest on": sum(
                           len(found) > 1 and method in found for found in leaders.values()),
                       "the only one without a failure on": sum(name == method for name in only.values()),
                       "fails on some questions of": int((part["share"] > 0).sum()),
                       "worst error [1]": worst["max_error"], "on": worst["pair"]})
    table = pd.DataFrame(counts)
    names = list(table.columns[2:6])
    table = table.sort_values(names[:3], ascending=False, kind="stable")
    table = cut(table[[name for name in table if name not in names or table[name].any()]])
    if not len(good):
        return Finding(f"{where} every pair query fails somewhere on every pair of shapes.", table)
    alone = [found[0] for found in leaders.values() if len(found) == 1]
    pairs = plural(len(leaders), "pair of shapes", "pairs of shapes")
    close = Counter(method for found in leaders.values() if len(found) > 1 for method in found)
    first = max(sorted(set(alone)), key=alone.count, default="")
    groups = [(sorted(m for m in close if close[m] == count), count) for count in sorted(set(close.values()), reverse=True)[:2]]
    clean, most = "" if first else " without a failure", max(close.values(), default=0)
    near = [f"{some(named)} {verb(len(named), 'are')} within {noise.UNMEASURED:g} times the fastest{clean} on {count}"
            if count == most else f"{some(named)} on {count}" for named, count in groups]
    fastest = [f"{first} is the fastest without a failure on {alone.count(first)}"] if first else []
    sole = [f"{some(sorted(set(only.values())))} alone {verb(len(set(only.values())), 'have')} no failure on {len(only)}"
            ] if only else []
    return Finding(fits(*(f"{where} of {pairs}, {listing(said)}." for said in (
        fastest + near + sole, fastest + near[:1] + sole, fastest + near[:1] or sole))), table)


ROW, CELL, HEAD = 0.22, 0.4, 0.3  # inches
NARROW = 0.3  # inches: numbers are upright in narrower cells


def clean(ledger):
    """The rows of the ledgers (stage, dimension, precision) in which no method fails."""
    parts = [part for _, part in ledger.groupby(PARTS, sort=True) if not failure.in_ledger(part)]
    return pd.concat(parts) if parts else ledger[:0]


@of_store("ledger_clean", 82, SECTION,
          "Ledgers without a failure", "This store has no ledger without a failure.", made_by=MADE_BY)
def ledger_clean(context):
    rows = clean(context.store.ledger())
    return [_chart(context, rows)] if len(rows) else []


def counted(rows):
    """Numbers of questions: a row per stage, dimension and method, with its precisions; a column per pair of shapes, or per
    family of inputs if a stage has no shapes."""
    rows = rows.assign(pair=["–".join((a, b)) if a or b else "" for a, b in zip(rows["kind_a"], rows["kind_b"])])
    kinds = rows[(rows["axis"] == "all") & (rows["pair"] != "")].assign(column=lambda part: part["pair"])
    families = rows[(rows["axis"] == "family") & (rows["pair"] == "")].assign(column=lambda part: part["value"])
    whole = rows[(rows["axis"] == "all") & (rows["pair"] == "") & ~rows["stage"].isin(families["stage"])].assign(column="all")
    found = pd.concat([kinds, families, whole])
    precisions = found.groupby(["stage", "dimension", "method"])["precision"].agg(lambda p: " ".join(sorted(set(p)))).rename("in")
    table = found.groupby(["stage", "dimension", "method", "column"], sort=True)["asked"].sum().reset_index()
    return table.join(precisions, on=["stage", "dimension", "method"])


def _chart(context, rows):
    table = counted(rows)
    stages = [stage for stage in [*NOUNS, *sorted(set(table["stage"]) - set(NOUNS))] if stage in set(table["stage"])]
    lines = {stage: table[table["stage"] == stage][["dimension", "method", "in"]].drop_duplicates().values.tolist()
             for stage in stages}
    name = lambda line: f"{context.name(line[1])}, {line[0]}D, {line[2]}"  # noqa: E731
    left = 0.3 + 0.068 * max(len(name(line)) for found in lines.values() for line in found)
    feet = {stage: 0.15 + 0.04 * max(map(len, table[table["stage"] == stage]["column"])) for stage in stages}
    height = sum(HEAD + ROW * len(lines[stage]) + feet[stage] for stage in stages)
    figure, top = plt.figure(figsize=(WIDTH, height)), height
    for stage in stages:
        part = table[table["stage"] == stage]
        columns = sorted(set(part["column"]))
        wide, high = min(WIDTH - left - 0.15, CELL * 1.6 * len(columns)), ROW * len(lines[stage])
        ax = figure.add_axes((left / WIDTH, (top - HEAD - high) / height, wide / WIDTH, high / height))
        asked = {(row.dimension, row.method, row.column): row.asked for row in part.itertuples()}
        each = set(asked.values()) - {0}
        look = {"fontsize": 5, "rotation": 90} if wide / len(columns) < NARROW and len(each) > 1 else {"fontsize": 7}
        for y, (dimension, method, _) in enumerate(lines[stage]):
            for x, column in enumerate(columns):
                number = asked.get((dimension, method, column))
                ax.add_patch(Rectangle((x - 0.48, y - 0.45), 0.96, 0.9, facecolor=RIGHT if number else NOT_ASKED, lw=0))
                text = "–" if not number else _short(number) if len(each) > 1 else ""
                ax.text(x, y, text, ha="center", va="center", color="#2F5D44" if number else "#888888", **look)
        ax.set_xlim(-0.5, len(columns) - 0.5)
        ax.set_ylim(len(lines[stage]) - 0.5, -0.5)
        ax.set_xticks(range(len(columns)))
        ax.set_xticklabels([column.replace("_", " ") for column in columns], rotation=35, ha="right", rotation_mode="anchor",
                           fontsize=7.5)
        ax.set_yticks(range(len(lines[stage])))
        ax.set_yticklabels([name(line) for line in lines[stage]], fontsize=8)
        asked_of = f"{each.pop():,} questions each" if len(each) == 1 else "questions"
        ax.set_title(f"{NOUNS.get(stage, stage)}: {asked_of}, none failed")
        ax.grid(False)
        ax.tick_params(length=0)
        for side in ax.spines.values():
            side.set_visible(False)
        top -= HEAD + high + feet[stage]
    everything = rows[rows["axis"] == "all"]
    ledgers = everything[PARTS].drop_duplicates()
    asked = everything.groupby("stage", sort=True)["asked"].sum()
    found = pd.DataFrame([{"ledgers": NOUNS.get(stage, stage), "dimension and precision": listing(
        f"{d}D {p}" for d, p in zip(part["dimension"], part["precision"])), "questions": int(asked[stage]), "failures": 0}
        for stage, part in ledgers.groupby("stage", sort=True)])
    text = (f"Nothing fails in {plural(len(ledgers), 'ledger')}: {int(asked.sum()):,} questions to "
            f"{plural(everything['method'].nunique(), 'method')}.")
    numbers = table.rename(columns={"in": "precisions", "column": "kinds or family"})
    unsure = int(everything["undecided"].sum())
    return Chart("ledger_clean", SECTION, "Ledgers without a failure", Finding(text, found), "", figure, numbers, [],
                 f"A cell is the number of questions; green: asked, “–”: not declared. {failure.DEFINITION}"
                 + (f" For {plural(unsure, 'question')} the referee's interval was too wide to decide." if unsure else ""),
                 made_by=MADE_BY)


def _short(number):
    """A number of questions, for a narrow cell."""
    return f"{number}" if number < 10000 else f"{number / 1000:.0f}k" if number < 1e6 else f"{number / 1e6:.1f}M"
