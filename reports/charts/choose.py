# SPDX-License-Identifier: Zlib
"""The pipeline to take for a given scene: of each stage the fastest method among those that err least, and all of them run
together."""

import math
import re
import textwrap

import pandas as pd
from matplotlib.lines import Line2D

import measured
import noise
from chart import Chart, Headline, holes, identifier, of_asked
from finding import Finding, fits
from choice import ALONE, AS_RIGHT, COST, JITTER, advices, pipeline_of, ratio, short, span, tie, zeros
from sentences import listing, plural, some
from style import ZeroLog, grid_of_axes, letter, si
from table import quantity

SECTION = "Which pipeline is best for this scene?"
WORDS = 2.75  # inches for the verdicts


@of_asked("choose", 5, SECTION,
          "Best pipeline", "No sweep that chooses is in this store; experiments/run choose makes one.", "choose")
def what_to_take(context):
    """One chart per scene, from all sweeps that list this chart."""
    return [_chart(context, advice) for advice in advices(context)]


def _found(context, advice):
    taken = [f"{choice.question} {choice.take.name}" for choice in advice.choices if choice.take is not None]
    lacking = [choice.question for choice in advice.choices if choice.take is None]
    head = f"For {advice.where} take {listing(taken)}" if taken else f"For {advice.where} no method can be taken"
    tail = f"; no method finished with a time for {listing(lacking)}" if lacking else ""
    rows = [_row(context, advice, choice) for choice in advice.choices]
    if advice.run is not None:
        whole = {"stage": "as a whole", "take": "all of the above", "time [s]": float(advice.run[COST]) / 1e3,
                 "median and interval": span(measured.runs(advice.run, COST) or [advice.run[COST]], "ms")}
        if advice.given is not None:
            why, found = tie(advice.run, advice.given, COST, _floor(advice)), noise.ratio(advice.given, advice.run, COST)
            against = f"tie: {why}" if why else f"{ratio(found)} times" if math.isfinite(found) else advice.given["outcome"]
            whole["against the pipeline of the sweeps"] = against
            if not why and math.isfinite(found) and not tail:
                tail = (f": {si(float(advice.run[COST]), 'ms')} a step, {ratio(found)} times the time of the pipeline of the "
                        "sweeps")
        rows.append(whole | _errors(context, advice, advice.run))
    table = pd.DataFrame(rows).dropna(axis="columns", how="all")
    table = table.drop(columns=[name for name in table if table[name].isin(["", None]).all()])
    return Finding(fits(f"{head}{tail}.", f"{head}.", f"For {advice.where} take the methods of this table."), table)


def _row(context, advice, choice):
    """The table's row of one stage."""
    take, judged, ties = choice.take, {}, {}
    for v in choice.verdicts:
        judged.setdefault(v.word, []).append(v)
    for v in judged.get("tie", ()):
        ties.setdefault(v.reason, []).append(v.name)
    slower = judged.get("slower", ())
    peers = [v for v in judged.get("", ()) if v.role != "competitor"]
    row = {"stage": choice.question, "take": take.name if take else "none finished with a time",
           "time [s]": float(take.cell[choice.cost]) / 1e3 if take else math.nan}
    row["time of"] = "the stage alone" if choice.cost == ALONE else "a step"
    row["ties"] = "; ".join(f"{listing(names)} ({why})" for why, names in ties.items())
    row["taken of the ties"] = f"it {choice.why}" if choice.why else ""
    row["next"] = f"{slower[0].name}: {slower[0].reason}" if slower else ""
    row["err more"] = listing(v.name for v in judged["errs more"]) if "errs more" in judged else ""
    row["failed"] = ", ".join(f"{v.name} ({v.word})" for v in choice.verdicts
                              if v.role == "competitor" and v.cell["outcome"] != "ok")
    row["not ranked"] = ", ".join(f"{v.name} ({v.reason})" for v in judged.get("not ranked", ()))
    row["fastest other library"] = f"{peers[0].name}: {_short_word(peers[0])}" if peers else ""
    return row | (_errors(context, advice, take.cell) if take else {})


def _errors(context, advice, cell):
    """{column: error} of one cell, the median over its seeds."""
    return {name: value[0] for error in advice.errors
            for name, value in quantity(context.title(error), context.unit(error), [_values(cell, error)[2]]).items()}


def _pasted(context, advice):
    if not advice.pipeline:
        return ""
    pasted = f"--pipeline '{short(advice.pipeline, context.store.algorithms)}'"
    return f" {'Not yet run as a whole' if advice.run is None else 'To paste'}: {pasted}."


def _floor(advice):
    return noise.floor(pd.DataFrame([cell for _, cell in advice.whole]), COST)


def _rows(context, advice):
    """[(heading, cost, [(label, cell, role, verdict, cost)])], the top of the picture first."""
    groups = []
    for choice in advice.choices:
        groups.append((choice.question, choice.cost,
                       [(_label(v.name, v.role), v.cell, v.role, _short_word(v), v.cost) for v in choice.verdicts]))
    if advice.whole:
        chosen = None if advice.run is None else advice.run["key"]
        groups.append(("as a whole", COST, [(f"{name}: {'all stages' if cell['key'] == chosen else 'of the sweeps'}"
                                             if name in ("taken", "given") else name, cell, "competitor",
                                             "take" if cell["key"] == chosen else _beside(advice, cell), COST)
                                            for name, cell in advice.whole]))
    return groups


def _beside(advice, cell):
    """A whole pipeline against the one that combines all taken methods."""
    if cell["outcome"] != "ok":
        return cell["outcome"]
    if advice.run is None:
        return ""
    return tie(advice.run, cell, COST, _floor(advice)) or f"{ratio(noise.ratio(advice.run, cell, COST))} times as long"


def _label(name, role):
    return name if role == "competitor" else f"{name} ({role})"


def _short_word(verdict):
    """A verdict for the picture; the table has the full reason."""
    if verdict.word == "not ranked":
        return f"not ranked: {verdict.reason}"
    if verdict.word in ("take", "errs more") or verdict.cell["outcome"] != "ok":
        return verdict.word
    first = verdict.reason.split("; ")[0].replace(noise.IN_WORDS[noise.FEW], "too few repeats")
    more = ", errs more" if "; " in verdict.reason or "above" in first else ""
    first = re.sub(r" times as long as \S+", " times the fastest", first)
    if " times " in first:
        return first.replace(" (whole steps: it causes other work)", " (whole steps)") + more
    return "tie: " * (verdict.role == "competitor") + first + more


def _chart(context, advice):
    groups, errors = _rows(context, advice), advice.errors
    lines = sum(len(rows) + 1 for _, _, rows in groups)
    cells = [cell for *_, rows in groups for _, cell, *_ in rows]
    left = max(1.2, 0.3 + 0.075 * max(len(label) for _, _, rows in groups for label, *_ in rows))
    figure, axes = grid_of_axes(1, 1 + len(errors), 0.225 * lines + 0.1, WORDS, left=left, gap_x=0.4, top=0.6, bottom=0.75)
    for column, measure in enumerate([COST, *errors]):
        ax = axes[0][column]
        unit, floor = ("ms", 0.0) if measure == COST else (context.unit(measure), context.floor(measure))
        drawn = [_values(cell, cost if measure == COST else measure) for *_, rows in groups for _, cell, *_, cost in rows]
        scale = ZeroLog(ax, "x", [v for ticks, ends, middle in drawn for v in (*ticks, *ends, middle) if math.isfinite(v)], unit,
                        failures=any(not math.isfinite(middle) for *_, middle in drawn), failed_name="none", floor=floor)
        room = int(ax.get_position().width * figure.get_figwidth() / 0.078)
        ax.set_title(textwrap.fill("time per step" if measure == COST else context.title(measure), room))
        y, ticks = 0, []
        for heading, cost, rows in groups:
            if column == 0:
                ax.text(-0.04, y, heading, transform=ax.get_yaxis_transform(), fontsize=9, ha="right", va="center",
                        fontweight="bold")
            if column == len(errors) and cost == ALONE:
                ax.text(1.04, y, "time of the stage alone", transform=ax.get_yaxis_transform(), va="center", fontsize=8.5,
                        style="italic", color="#555555")
            y += 1
            for label, cell, role, word, by in rows:
                _mark(ax, scale, y, cell, by if measure == COST else measure, role)
                if column == len(errors):
                    ax.text(1.04, y, word, transform=ax.get_yaxis_transform(), va="center", fontsize=8.5,
                            weight="bold" if word == "take" else "normal", color="black" if word == "take" else "#555555")
                ticks.append((y, label))
                y += 1
        ax.set_ylim(y - 0.3, -0.7)
        ax.set_yticks([t for t, _ in ticks])
        ax.set_yticklabels([label for _, label in ticks] if column == 0 else [])
        ax.tick_params(axis="y", length=0)
    alone = [Line2D([], [], ls="none", marker="D", color="#555555", label="of the stage alone")]
    figure.legend(handles=[Line2D([], [], ls="none", marker="o", color="#555555", label="median"),
                           *(alone if any(cost == ALONE for _, cost, _ in groups) else []),
                           Line2D([], [], ls="none", marker="|", ms=9, color="#555555", label="one seed"),
                           Line2D([], [], color="#555555", label="holds the median (time: of repeats)"),
                           Line2D([], [], ls="none", marker="o", mfc="white", color="#555555", label="other libraries'")],
                  loc="lower left", bbox_to_anchor=(left / figure.get_figwidth(), 0.0), ncol=5, borderaxespad=0.3,
                  columnspacing=1.5)
    missing = [] if not advice.pipeline or advice.run is not None else [
        "The combined pipeline has not run yet; experiments/run choose runs it with "
        "lpc sweep choose_together --with \"taken=$(lpc report STORE --taken)\""]
    bad = [hole for choice in advice.choices for hole in holes(pd.DataFrame([v.cell for v in choice.verdicts]), ["method"])]
    known = [f"{100 * (c.floor - 1):.2g} % ({c.question})" for c in advice.choices if c.floor != noise.UNMEASURED]
    rules = [f"The same method against itself differs by up to {listing(known)}: smaller differences are noise."] if known else []
    rules += [noise.rule(noise.UNMEASURED)] if len(known) < len(advice.choices) else []
    seeds = max(len(cell["seeds"]) for cell in cells)
    return Chart(identifier(f"choose {advice.where}"), SECTION, f"Best pipeline: {advice.where}", _found(context, advice),
                 advice.choices[0].sweep, figure, _table(context, advice), advice.refused + missing + bad,
                 f"A stage takes its fastest method among those that finished and err at most {AS_RIGHT:g} times the least error "
                 f"({listing([context.title(error) for error in errors])}; {plural(seeds, 'seed')}; {none_of(context, advice)}). "
                 "“Errs more” and “slower” are significant over the seeds, “slower” also beyond the noise; else methods tie. "
                 "Of "
                 "methods that tie the one with the significantly least error is taken, else that of the sweeps' common "
                 "pipeline. "
                 f"{' '.join(rules)}{_pasted(context, advice)}", telling=True, headline=_headline(advice),
                 others=tuple(dict.fromkeys([choice.sweep for choice in advice.choices[1:]] +
                                            [cell["sweep"] for _, cell in advice.whole])))


def none_of(context, advice):
    """The errors that count as 0, for the note."""
    cells = [v.cell for choice in advice.choices for v in choice.verdicts if v.role == "competitor"]
    least = zeros(context, cells, advice.errors)
    said = {}
    for error, zero in least.items():
        if zero > context.floor(error):
            why = "which is rest" if error == JITTER else "the slop that methods keep on purpose"
            said.setdefault(f"{si(zero, context.unit(error))}, {why}", []).append(context.title(error))
    return "; ".join(f"{listing(titles)} counts as 0 up to {text}" for text, titles in said.items()) or "no error counts as 0"


def _values(cell, measure):
    """(one value of each seed, ends of the interval of the median, the median); NaN where the cell has none."""
    if cell["outcome"] != "ok" or measure not in cell or not math.isfinite(cell[measure]):
        return [], (), math.nan
    seeds = measured.of_seeds(cell, measure)
    times_of = measured.runs(cell, measure)
    return seeds if len(seeds) > 1 else [], noise.interval(times_of or seeds), float(cell[measure])


def _mark(ax, scale, y, cell, measure, role):
    colour = "#0072B2" if role == "competitor" else "#777777"
    seeds, ends, middle = _values(cell, measure)
    if not math.isfinite(middle):
        mark, width = (letter(cell["outcome"]), 0.3) if cell["outcome"] != "ok" else ("x", 1)
        ax.plot([scale.failed], [y], ls="none", ms=6, mew=width, color=colour, marker=mark, clip_on=False)
        return
    ax.plot([scale.place(v) for v in seeds], [y] * len(seeds), ls="none", marker="|", ms=8, color=colour, alpha=0.5, mew=0.8)
    ax.plot([scale.place(v) for v in ends], [y, y], color=colour, lw=1.6, alpha=0.8)
    ax.plot([scale.place(middle)], [y], ls="none", marker="D" if measure == ALONE else "o", ms=5, color=colour, zorder=3,
            mfc=colour if role == "competitor" else "white")


def _headline(advice):
    """The finding, where the combined pipeline differs beyond the noise from the sweeps' common pipeline; else the stage with the
    largest difference between methods of equal error."""
    run, given = advice.run, advice.given
    if run is not None and given is not None and given["outcome"] == "ok" and not tie(run, given, COST, _floor(advice)):
        return Headline("", {"taken": float(run[COST]), "pipeline of the sweeps": float(given[COST])}, "ms", "time per step")
    made = []
    for choice in advice.choices:
        slower = [v for v in choice.verdicts if v.word == "slower" and v.cost == choice.cost]
        if slower:
            mine = {v.name: float(v.cell[choice.cost]) for v in choice.verdicts
                    if v.word in ("take", "tie", "slower") and v.cost == choice.cost}
            what = "in its stage" if choice.cost == ALONE else "a step"
            ties = [v.name for v in choice.verdicts if v.word == "tie"]
            named = some([choice.take.name, *ties]) + (" (a tie)" if ties else "")
            made.append(Headline(f"For {advice.where} take {choice.question} {named}; {slower[-1].name} errs as little and takes "
                                 f"{ratio(mine[slower[-1].name] / mine[choice.take.name])} times as long {what}.", mine, "ms",
                                 "time of the stage" if choice.cost == ALONE else "time per step"))
    return max(made, key=lambda headline: headline.effect, default=None)


def _table(context, advice):
    rows = [(choice.question, v.cost, v.name, v.role, v.word, v.reason, v.cell) for choice in advice.choices
            for v in choice.verdicts]
    chosen = None if advice.run is None else advice.run["key"]
    rows += [("as a whole", COST, name, "competitor", "take" if cell["key"] == chosen else "", cell["reason"], cell)
             for name, cell in advice.whole]
    whats, costs, names, roles, words, reasons, cells = zip(*rows)
    columns = {"stage": whats, "method": names, "role": roles, "verdict": words, "reason": reasons,
               "outcome": [cell["outcome"] for cell in cells], "seeds": [len(cell["seeds"]) for cell in cells]}
    for title, measures in (("time per step", [COST] * len(rows)),
                            ("time of the stage alone", [cost if cost == ALONE else None for cost in costs])):
        ends = [_values(cell, measure) if measure else ([], (), math.nan) for cell, measure in zip(cells, measures)]
        columns |= quantity(title, "ms", [middle for *_, middle in ends])
        columns |= quantity(f"{title}, low end", "ms", [low_high[0] if low_high else math.nan for _, low_high, _ in ends])
        columns |= quantity(f"{title}, high end", "ms", [low_high[1] if low_high else math.nan for _, low_high, _ in ends])
    for error in advice.errors:
        found, unit, title = [_values(cell, error) for cell in cells], context.unit(error), context.title(error)
        columns |= quantity(title, unit, [middle for *_, middle in found])
        columns |= quantity(f"{title}, low end", unit, [ends[0] if ends else math.nan for _, ends, _ in found])
        columns |= quantity(f"{title}, high end", unit, [ends[1] if ends else math.nan for _, ends, _ in found])
    columns["pipeline"] = [short(pipeline_of(context.store, cell), context.store.algorithms) for cell in cells]
    return pd.DataFrame(columns)
