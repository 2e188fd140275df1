# SPDX-License-Identifier: Zlib
"""Tests of the page and its tables. Run by ctest, or python3 reports/tests/page_test.py. Every check that guards a promise is
seen to fail on a planted bug."""

import contextlib
import csv
import io
import json
import math
import random
import re
import sys
import tempfile
import unittest
import unittest.mock
import warnings
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import matplotlib.text  # noqa: E402
import pandas as pd  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

import chart  # noqa: E402
import coverage  # noqa: E402
import headlines  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import overlap  # noqa: E402
import pages  # noqa: E402
import sentences  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import table  # noqa: E402
import undrawn  # noqa: E402
from charts.measurements import coverage_of_plan  # noqa: E402

CASES = 60 if undrawn.ALL else 20  # of pictures that are drawn at random
PREFIXED = re.compile(r"^-?[\d.]+(e[-+]?\d+)? ?([pnµmk]?(m|s|J|m/s)|%)$")  # a number that was rounded for eyes


def check_for_programs(made):
    """No number of a table is a text, and every unit is one of SI."""
    for name in made.columns:
        unit = table.heading(name)[1]
        if unit not in ("", "1", "m", "s", "m/s", "rad", "J", "kg m/s"):
            return f"{name}: the unit is not SI"
        for value in made[name]:
            if isinstance(value, str) and (unit or PREFIXED.match(value)):
                return f"{name}: {value} is a text"
    return ""


def check_round_trip(rows, to_csv):
    """What is read from the two files is what was written, to the last bit."""
    with tempfile.TemporaryDirectory() as folder:
        to_csv(rows, Path(folder) / "t.csv")
        table.to_json(rows, {"id": "t"}, Path(folder) / "t.json")
        with open(Path(folder) / "t.csv", encoding="utf-8", newline="") as file:
            head, *lines = csv.reader(file)
        read = json.loads((Path(folder) / "t.json").read_text(encoding="utf-8"))
    if head != list(rows.columns) or [table.heading(name) for name in head] != [tuple(c.values()) for c in read["columns"]]:
        return f"columns {head}"
    for row, line, values in zip(rows.itertuples(index=False), lines, read["rows"], strict=True):
        for name, value, text, plain in zip(head, row, line, values, strict=True):
            if table.unknown(value):
                same = text == "" and plain is None
            elif isinstance(value, (str, bool)):
                same = str(value) == text == str(plain)
            else:
                same = float(text) == float(plain) == float(value)
            if not same:
                return f"{name}: {value!r} became {text!r} and {plain!r}"
    return ""


def rounded(rows, target):
    """Planted bug: six digits, as many a table is printed."""
    rows.to_csv(target, index=False, float_format="%.6g")


class Pictures(unittest.TestCase):
    """Faults that an eye sees at once, measured as the figure is drawn as SVG."""

    def figure(self, draw):
        figure, ax = style.plt.subplots(figsize=(3, 2))
        figure.subplots_adjust(left=0.2, bottom=0.25)
        ax.set_xlim(0, 10)
        ax.set_ylim(0, 10)
        draw(ax)
        found = overlap.overlaps(figure)
        style.plt.close(figure)
        return found

    def test_letters_on_letters_and_cut_letters_are_seen(self):
        def twins(ax):
            ax.text(5, 5, "planted")
            ax.text(5.2, 5, "twin")

        def slanted(ax, apart=0.8):  # the boxes round slanted labels meet, the labels do not
            ax.text(2, 2, "a long slanted label", rotation=45)
            ax.text(2 + apart, 2, "another slanted label", rotation=45)

        self.assertEqual(self.figure(twins), ([("planted", "twin")], []))
        self.assertEqual(self.figure(lambda ax: slanted(ax, 1.5)), ([], []))
        self.assertEqual(len(self.figure(lambda ax: slanted(ax, 0.3))[0]), 1)
        legend = self.figure(lambda ax: ax.figure.legend([Line2D([], [])], ["bullet (witness)"], loc="upper left",
                                                         bbox_to_anchor=(0.6, 1)))
        self.assertEqual(legend, ([], ["bullet (witness)"]))
        self.assertEqual(self.figure(lambda ax: ax.set_title("high", pad=12)), ([], ["high"]))

    def test_letters_cut_off_by_their_axes_and_handles_on_texts_are_seen(self):
        def mark(ax, x, **kwargs):
            ax.plot([x], [5], ls="none", marker=style.letter("collapsed"), ms=7, **kwargs)

        self.assertEqual(self.figure(lambda ax: mark(ax, 0)), ([], [style.letter("collapsed")]))
        self.assertEqual(self.figure(lambda ax: mark(ax, -9))[1], [style.letter("collapsed")])
        self.assertEqual(self.figure(lambda ax: (mark(ax, 5), mark(ax, 10, clip_on=False))), ([], []))

        def legend(ax, y):
            ax.text(5, y, "planted", va="center")
            ax.legend([Line2D([], [], marker="o", ls="none")], ["f64"], loc="center left", bbox_to_anchor=(0.55, 0.5),
                      borderaxespad=0)

        self.assertIn(("planted", "a handle"), self.figure(lambda ax: legend(ax, 5))[0])
        self.assertEqual(self.figure(lambda ax: legend(ax, 9)), ([], []))

    def test_thirteen_failures_at_one_place_are_one_letter_with_their_number(self):
        spots = [(5.0, 9.0, "collapsed", "#000000")] * 12 + [(5.1, 9.0, "diverged", "#000000"), (1.0, 9.0, "timeout", "#000000")]

        def piled(ax):
            for x, y, outcome, colour in spots:
                ax.plot([x], [y], ls="none", marker=style.letter(outcome), ms=7, color=colour)

        self.assertGreater(len(self.figure(piled)[0]), 60, "the planted bug was not seen")
        said = []
        self.assertEqual(self.figure(lambda ax: (style.fallen(ax, spots), said.extend(t.get_text() for t in ax.texts))), ([], []))
        self.assertEqual(said, ["C×12 N×1"])

    def test_failures_stay_apart_wherever_they_are(self):
        source = random.Random(4)
        for _ in range(CASES):
            spots = [(source.uniform(0, 10), source.choice([9.0, 9.3, 5.0]), source.choice(["collapsed", "diverged", "timeout"]),
                      "#000000") for _ in range(source.randrange(1, 25))]
            told = []
            found = self.figure(lambda ax: (style.fallen(ax, spots), told.append(len(ax.lines)),
                                            told.extend(t.get_text() for t in ax.texts)))
            self.assertEqual(found, ([], []), spots)
            counted = told[0] + sum(int(part.split("×")[1]) for text in told[1:] for part in text.split())
            self.assertEqual(counted, len(spots), "a failure vanished")

    def test_ticks_leave_room_for_zero_and_failures(self):
        source = random.Random(6)
        for _ in range(CASES):
            values = [10**source.uniform(-9, 3) for _ in range(source.randrange(1, 5))] + [0.0, math.nan]
            unit = source.choice(["ns", "m", "1"])
            found = self.figure(lambda ax: (style.ZeroLog(ax, "x", values, unit, failed_name="not timed"),
                                            style.ZeroLog(ax, "y", values, "s")))
            self.assertEqual(found[0], [], values)

    def test_lines_on_one_another_are_named(self):
        curves = {"a": [1.0, math.nan], "b": [1.0, 2.0], "c": [1.0, math.nan], "d": [math.nan, math.nan], "e": [math.nan] * 2}
        firsts = style.same(curves)
        self.assertEqual(firsts, {"a": "a", "b": "b", "c": "a", "d": "d", "e": "e"})
        untimed = style.same({m: [[16.0, 64.0], [math.nan, math.nan]] for m in ("naive", "widest")})
        self.assertEqual(untimed, {"naive": "naive", "widest": "widest"}, "without a value there is no line")
        said = []
        self.assertEqual(self.figure(lambda ax: (style.one_line(ax, firsts, " and ".join), said.extend(t.get_text()
                                                 for t in ax.texts))), ([], []))
        self.assertEqual(said, ["a and c coincide"])

    def test_many_lines_on_one_another_are_counted_in_one_line(self):
        alike = {f"a method with a long name {i}": [float(i // 3)] for i in range(9)}
        said = []
        self.figure(lambda ax: (style.one_line(ax, style.same(alike), sentences.listing),
                                said.extend(t.get_text() for t in ax.texts)))
        self.assertEqual(said, ["9 methods coincide in 3 groups"])

    def test_lines_without_room_for_their_names_are_named_in_the_caption(self):
        alike = {f"a method with a long name {i}": [1.0, 2.0] for i in range(9)}
        told, names = [], sentences.listing(alike)
        self.figure(lambda ax: told.append(style.one_line(ax, style.same(alike), sentences.listing)))
        self.assertEqual(told, [f"{names} coincide"])
        self.figure(lambda ax: told.append(style.one_line(ax, style.same({"a": [1.0], "b": [1.0]}), sentences.listing)))
        self.assertEqual(told[1], "", "named in the picture")
        self.assertEqual(style.caption_of_lines([("left", told[0]), ("middle", ""), ("right", told[0])]),
                         f" Left; right: {names} coincide.")


def check_titles(charts, name_apart):
    """No two charts have one title."""
    name_apart(charts)
    titles = [made.title for made in charts]
    return ", ".join(sorted({title for title in titles if titles.count(title) > 1}))


class Words(undrawn.Undrawn):
    """What the page says beside its charts."""

    def page(self, fill):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        maker = synthetic_store.Maker(Path(folder.name) / "s.db")
        fill(maker)
        maker.close()
        store = load.Store(Path(folder.name) / "s.db")
        self.addCleanup(store.db.close)
        path = pages.write(chart.Context(store), [], Path(folder.name) / "out", "s.db", "out")
        return re.sub(r"\s+", " ", path.read_text(encoding="utf-8"))

    def test_no_two_charts_have_one_title(self):
        twins = lambda: [chart.Chart(f"{sweep}_x", "", title, "", sweep) for sweep in ("a", "b") for title in (  # noqa: E731
            "Breaking points, 2D", f"Of {sweep}")]
        self.assertEqual(check_titles(twins(), make.name_apart), "")
        self.assertEqual(check_titles(twins(), lambda charts: None), "Breaking points, 2D", "the planted bug was not seen")
        with tempfile.TemporaryDirectory() as folder:
            maker = synthetic_store.Maker(Path(folder) / "s.db")
            for sweep in ("one", "two"):
                maker.sweep(sweep, "world", resolver="label", n="parameter")
                for n in (2, 3, 4, 5):
                    for label in ("catto", "naive"):
                        fell = ("collapsed", "far", 50) if n > 3 else ()
                        maker.world(sweep, {"scene": "s", "dimension": 2, "resolver": label, "n": n}, 1.0, 1e-3, *fell)
            maker.close()
            charts = make.all_charts(chart.Context(load.Store(Path(folder) / "s.db")))
        self.assertEqual(check_titles(charts, lambda charts: None), "")
        self.assertIn("Breaking points, 2D: two", [made.title for made in charts])
        style.plt.close("all")

    def test_every_outcome_has_its_meaning_in_the_manual_s_words(self):
        self.assertEqual(list(coverage.MEANINGS), [*load.SEVERITY, load.NOT_RUN])
        manual = (HERE.parent.parent / "docs" / "reference_sweeps.md").read_text(encoding="utf-8")
        for name, meaning in coverage.MEANINGS.items():
            self.assertIn(f"| `{name}` | {meaning} |", manual)
        page = self.page(lambda maker: maker.trial("s", {"kind": "world"}, {}, "collapsed", "far", 9))
        self.assertIn("<td>collapsed</td><td>C</td><td>a body moved farther from its start than the scene&#x27;s limit of drift, "
                      "not by sagging alone, or still creeps at the end</td><td class=n>1</td>", page)

    def test_a_metric_is_named_as_charts_name_it(self):
        page = self.page(lambda maker: None)
        self.assertIn("<th>metric</th><th>in charts</th>", page)
        self.assertIn("<td>restlessness</td><td>restlessness (speed)</td>", page)

    def test_seeds_are_in_the_order_of_numbers(self):
        def fill(maker):
            for seed in (10, 2, 1, 3):
                maker.trial("s", {"kind": "world", "seed": seed}, {}, extra={"seed": seed})
        self.assertIn("<dt>seeds</dt><dd>1, 2, 3, 10</dd>", self.page(fill))

    def test_what_is_said_to_be_shown_is_shown(self):
        page = self.page(lambda maker: None)
        self.assertNotIn("Every planned cell is shown", page, "charts have room for some scenes only")
        self.assertNotIn("finished and is ok", page, "a run that collapsed has finished, too")

    @undrawn.drawn
    def test_what_is_unsupported_or_was_never_started_did_not_run(self):
        with tempfile.TemporaryDirectory() as folder:
            maker = synthetic_store.Maker(Path(folder) / "s.db")
            for i, outcome in enumerate(("ok", "collapsed", "unsupported")):
                maker.trial("s", {"kind": "world", "n": i}, {}, outcome, "why", 1)
            maker.plan("s", kind="world", n=9)
            maker.close()
            made = coverage_of_plan.make(chart.Context(load.Store(Path(folder) / "s.db")))[0]
        self.assertEqual(made.finding.headline, "2 of 4 planned trials ran, 1 of them ok.")
        self.assertEqual({row["outcome"]: (row["trials"], row["share"]) for row in made.finding.rows()}, dict.fromkeys(
            ("ok", "unsupported", "collapsed", "not run"), (1, "25 %")))
        self.assertIn("2 of 4", [text.get_text() for text in made.figure.axes[0].texts])
        style.plt.close(made.figure)


class WholeReport(unittest.TestCase):
    """Of a store with all themes: the report itself, and its charts before they are written."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        path, cls.out = Path(cls.folder.name) / "store.db", Path(cls.folder.name) / "out"
        synthetic_store.write(path)
        cls.store, real, cls.charts, cls.said = load.Store(path), make.all_charts, [], io.StringIO()

        def kept(*arguments):
            cls.charts = real(*arguments)
            return cls.charts

        def listed(pictures):
            """What takes half of the time: command_test.py writes pictures, and here each is drawn once, to be measured."""
            for _, target in pictures:
                target.touch()

        save_all = pages.save_all if undrawn.ALL else listed
        with unittest.mock.patch.object(make, "all_charts", kept), contextlib.redirect_stderr(cls.said), (
                unittest.mock.patch.object(pages, "save_all", save_all)), (
                contextlib.redirect_stdout(io.StringIO())) as printed, warnings.catch_warnings():
            warnings.simplefilter("always")
            cls.code = make.main(["--store", str(path), "--out", str(cls.out)])
        cls.printed = printed.getvalue()

    def test_page_names_every_failure_and_links_exist(self):
        self.assertEqual((self.code, self.said.getvalue()), (0, ""))
        page = (self.out / "index.html").read_text(encoding="utf-8")
        self.assertEqual(self.printed.strip(), str(self.out / "index.html"))
        for source in page.split('src="')[1:]:
            self.assertTrue((self.out / source.split('"')[0]).is_file(), source)
        for word in ("Invented CPU 9000", "g++ 12.2.0", "-ffp-contract=off", "abc1234", "not run", "diverged",
                     "3 pairs that naive has not", "build/release/bin/lpc sweep resolvers --store",
                     "build/release/bin/lpc verify --stage pair_query --dimension 3"):
            self.assertIn(word, page)
        self.assertNotIn("http", page.replace("http-equiv", ""), "the page must open from disk alone")

    def test_no_letters_overlap_or_are_cut_off(self):
        warned = warnings.catch_warnings()
        warned.__enter__()
        self.addCleanup(warned.__exit__, None, None, None)
        warnings.simplefilter("error")  # of a letter that the font lacks, of a layout that has no room
        for made in self.charts:
            figures = [made.figure] if made.figure is not None else []
            figures += [headlines.drawn(made.headline)] if made.headline is not None else []
            for figure in figures:
                self.assertEqual(overlap.overlaps(figure), ([], []), made.id)
                style.plt.close(figure)

    def test_a_ratio_of_one_is_not_told(self):
        for made in self.charts:
            told = made.finding.text() + (made.headline.text if made.headline is not None else "")
            self.assertNotRegex(told, r"(?<![\d.,])1(\.0+)? times\b", made.id)

    def test_every_small_chart_names_its_quantity(self):
        self.assertEqual([c.id for c in self.charts if c.headline is not None and not c.headline.quantity], [])

    def test_one_is_singular(self):
        many = re.compile(r"(?<![\d.,])1 (?!is\b|has\b|times\b|s\b|ms\b)[a-z]{3,}s\b")
        self.assertRegex("planted: 1 of 1 cells", many)
        for made in self.charts:
            texts = [made.finding.text(), made.note, *made.holes, made.headline.text if made.headline is not None else ""]
            if made.figure is not None:
                texts += [text.get_text() for text in made.figure.findobj(matplotlib.text.Text)]
            for text in texts:
                self.assertNotRegex(text, many, made.id)

    def test_every_table_has_raw_numbers_with_units_and_round_trips(self):
        shown = 0
        for made in self.charts:
            self.assertEqual(check_for_programs(made.table), "", made.id)
            self.assertEqual(check_round_trip(made.table, table.to_csv), "", made.id)
            shown += len(made.table)
        self.assertGreater(shown, 500)

    def test_what_is_formatted_or_rounded_is_seen(self):
        for bad in ({"error [m]": ["1.23 mm"]}, {"error": ["1.23 mm"]}, {"share": ["26%"]}, {"time [ms]": [1.5]}):
            self.assertNotEqual(check_for_programs(pd.DataFrame(bad)), "", bad)
        rows = pd.DataFrame(table.quantity("time", "ms", [0.1 + 0.2, None, math.inf, 0.0]))
        self.assertEqual(check_round_trip(rows, table.to_csv), "")
        self.assertNotEqual(check_round_trip(rows, rounded), "", "the planted bug was not seen")

    def test_units_become_si_and_are_rounded_for_eyes_only(self):
        rows = pd.DataFrame({"method": ["a<b"], **table.quantity("time per query", "ns", [158300.4])})
        self.assertEqual(list(rows["time per query [s]"]), [158300.4 / 1e9])
        page = table.to_html(rows)
        self.assertIn("<th>time per query</th>", page)
        self.assertIn("<td class=n>158 µs</td>", page)
        self.assertIn("<td>a&lt;b</td>", page)

    def test_a_table_says_what_it_is_and_when_it_was_measured(self):
        made = next(c for c in self.charts if c.id == "coverage")
        with tempfile.TemporaryDirectory() as folder:
            pages.write_charts(self.store, [made], Path(folder))
            read = json.loads((Path(folder) / "tables" / "coverage.json").read_text(encoding="utf-8"))
        self.assertEqual((read["id"], read["finding"], read["store"]), ("coverage", made.finding.headline, "store.db"))
        self.assertEqual(read["found"], made.finding.rows())
        for name in ("first_trial", "last_trial"):
            self.assertRegex(read[name], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")


def check_first(chosen, charts):
    """At most ten; no question comes twice before every one that has a finding came once; none says that all is the same."""
    picked = chosen(charts)
    if len(picked) > 10 or any(c.headline is None or c.headline.effect <= 1 for c in picked):
        return f"{len(picked)} findings"
    questions = list(dict.fromkeys(c.section for c in charts if c.headline is not None and c.headline.effect > 1))
    rounds = [picked[i].section for i in range(min(len(questions), len(picked)))]
    if rounds != questions[:10]:
        return f"first come {rounds}"
    for i, made in enumerate(picked):
        left = [c for c in charts if c.section == made.section and c.headline is not None and c not in picked[:i]]
        if max(c.headline.effect for c in left) > made.headline.effect:
            return f"{made.id} is not the strongest that was left of its question"
    return ""


def strongest_of_all(charts):
    """Planted bug: by effect alone, so one question may have all places."""
    return sorted((c for c in charts if c.headline is not None), key=lambda c: -c.headline.effect)[:10]


def check_named(rows_of, values):
    """Whoever a sentence names has a row of the small chart, and no row is lost without a word."""
    for second in ("m5", "m9", "m1+x"):
        rows = rows_of(chart.Headline(f"m0 is best, {second} comes second and m11 last.", values))
        shown = [name for row in rows for name in row.methods]
        between = sum(int(row.name.split()[1]) for row in rows if row.value is None)
        if not {"m0", second, "m11"} <= set(shown) or len(shown) + between != len(values) or len(rows) > headlines.ROWS:
            return f"{second}: {[row.name for row in rows]}"
    return ""


def the_best_and_the_last(headline):
    """Planted bug: of many rows the best three and the last, whoever the sentence speaks of."""
    rows = headlines.rows_of(chart.Headline("", headline.values))
    return rows[:3] + [headlines.Row(f"… {len(headline.values) - 4} between", None)] + rows[-1:]


class First(unittest.TestCase):
    def charts(self, *effects):
        return [chart.Chart(f"c{i}", section, "", "", "", headline=chart.Headline("", {"a": 1.0, "b": effect}))
                for i, (section, effect) in enumerate(effects)]

    def test_the_first_screen_has_the_strongest_of_every_question(self):
        source = random.Random(8)
        seen = False
        for _ in range(200):
            effect = lambda: source.choice([1.0, 1.5, 3.0, source.random() + 1])  # noqa: E731
            charts = self.charts(*sorted((f"question {source.randrange(14):02}", effect())
                                         for _ in range(source.randrange(30))))
            charts.insert(0, chart.Chart("without", "question 00", "", "", ""))
            self.assertEqual(check_first(headlines.chosen, charts), "")
            seen |= bool(check_first(strongest_of_all, charts))
        self.assertTrue(seen, "the planted bug was not seen")

    def test_an_effect_is_a_ratio_and_a_failure_is_large(self):
        for values, effect in (({"a": 2.0, "b": 3.0}, 1.5), ({"a": 0.0, "b": 3.0}, 1000), ({"a": 0.0, "b": 0.0}, 1),
                               ({"a": math.nan, "b": 3.0}, 1000), ({"a": math.nan}, 1), ({"a": 3.0}, 1), ({}, 1)):
            self.assertEqual(chart.Headline("", values).effect, effect, values)

    def test_of_many_methods_the_least_and_the_largest_are_drawn(self):
        rows = headlines.rows_of(chart.Headline("", {f"m{i}": float(9 - i) for i in range(9)} | {"fell": math.nan}))
        self.assertEqual([row.name for row in rows], ["m8", "m7", "m6", "m5", "… 5 between", "fell"])
        rows = headlines.rows_of(chart.Headline("", {"a": 2.0, "b": 0.0, "c": math.nan}))
        self.assertEqual([row.name for row in rows], ["b", "a", "c"])
        rows = headlines.rows_of(chart.Headline("", {"a": 2.0, "b": 0.0, "c": math.nan}, larger=True))
        self.assertEqual([row.name for row in rows], ["a", "b", "c"])

    def test_whom_the_sentence_names_is_drawn(self):
        values = {f"m{i}": float(i) for i in range(12)} | {"m1+x": 1.5}
        self.assertEqual(check_named(headlines.rows_of, values), "")
        self.assertNotEqual(check_named(the_best_and_the_last, values), "", "the planted bug was not seen")

    def test_variants_with_one_result_are_one_row(self):
        values = {"catto+linear": 1e-3, "catto+none": 1e-3, "naive": 2e-3, "soft_step": math.nan}
        bits = {"catto+linear": ("7",), "catto+none": ("7",)}
        best, others = {**values, "catto+best": 1e-4}, [("naive", ""), ("soft_step", "")]
        for ends, shown, said in ((bits, values, [("catto", "2 variants, same bits")]),
                                  ({"catto+linear": ("7",)}, values, [("catto", "2 variants, equal")]),
                                  (bits, best, [("catto+best", ""), ("catto", "2 of 3 variants, same bits")])):
            rows = headlines.rows_of(chart.Headline("", shown, "m", "error", ends=ends))
            self.assertEqual([(row.name, row.under) for row in rows], said + others)

    def test_what_failed_stands_at_the_worse_end(self):
        values = {"a": 1e-3, "b": 5e-1, "c": math.nan, "d": 0.0}
        for larger in (False, True):
            figure = headlines.drawn(chart.Headline("", values, "ms", "time per step", larger))
            ax = figure.axes[0]
            places = {line.get_marker(): line.get_xdata()[0] for line in ax.lines if line.get_marker() in "xo"}
            dots = [line.get_xdata()[0] for line in ax.lines if line.get_marker() == "o"]
            self.assertEqual(len(dots), 3)
            self.assertTrue(places["x"] <= min(dots) if larger else places["x"] > max(dots) + 0.1, places)
            self.assertIn("time per step (s), logarithmic", [text.get_text() for text in figure.texts])
            self.assertEqual(overlap.overlaps(figure), ([], []))
            style.plt.close(figure)


if __name__ == "__main__":
    unittest.main()
