# SPDX-License-Identifier: Zlib
"""Tests of findings: the length of a headline, and the small table below it."""

import json
import math
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import pandas as pd  # noqa: E402

import chart  # noqa: E402
import finding  # noqa: E402
import sentences  # noqa: E402
import synthetic_store  # noqa: E402, F401
import table  # noqa: E402
from finding import Finding, Line  # noqa: E402

LONG = "On pyramid, 2D " + "catto has 1 mm and " * 6 + "tgs has 2 mm."


class Headlines(unittest.TestCase):
    def test_a_headline_is_one_sentence_of_at_most_30_words(self):
        self.assertEqual(finding.fault("direct_lcp penetrates least (0 m) within 801 µs a step; naive fails."), "")
        for bad in (LONG, "One fact. Another fact.", "No full stop", "One; two; three.", "", "Is it? It is."):
            self.assertNotEqual(finding.fault(bad), "", bad)

    def made(self, headline, rows=1, text=""):
        numbers = chart.Headline(text, {"a": 1.0, "b": 2.0})
        about = Finding(headline, pd.DataFrame({"method": ["a"] * rows}))
        kind = chart.of_store("x", 1, "Question?", "Title", "Nothing is in this store.")(
            lambda context: [chart.Chart("x", "", "", about, "", headline=numbers)])
        return chart.made(kind, None)[0]

    def test_every_chart_of_a_test_is_checked(self):
        self.assertEqual(self.made("a has 1 m.").headline.text, "a has 1 m.", "the first screen repeats the headline")
        for planted in ((LONG,), ("a has 1 m.", 1, LONG), ("a has 1 m.", finding.ROWS + 1)):
            with self.assertRaises(AssertionError):
                self.made(*planted)
            with unittest.mock.patch.object(finding, "strict", False):
                self.made(*planted)  # the report itself never stops at a headline

    def test_of_many_names_a_headline_has_two(self):
        self.assertEqual(sentences.some(["a", "b", "c", "d"]), "a, b and 2 more")
        self.assertEqual(sentences.some(["a", "b"]), "a and b")
        self.assertEqual(sentences.some(["c+1", "c+2", "c+3", "a"], ["c+1", "c+2", "c+3", "a"]), "all 3 c variants and a")


class Tables(unittest.TestCase):
    def test_methods_stand_from_the_best_to_the_worst(self):
        lines = [Line("b", 3e-3, 2e-3, 4e-3), Line("fell", outcome="failed: collapsed"), Line("a", 2e-3), Line("c", 2.1e-3)]
        made = finding.ranked(lines, "error", "m", ties=["c"])
        self.assertEqual(list(made.columns), ["method", "error [m]", "range", "against the best"])
        self.assertEqual(made["method"].tolist(), ["a", "c", "b", "fell"])
        self.assertEqual(made["against the best"].tolist(), ["best, tie", "tie", "1.5 times", "failed: collapsed"])
        self.assertEqual(made["range"].tolist(), ["", "", "2 mm to 4 mm", ""])
        fastest = finding.ranked([Line("a", 2.0), Line("b", 4.0), Line("c", 0.0)], "speed", "m/s", larger=True)
        self.assertEqual(fastest["against the best"].tolist(), ["best", "0.5 times", "-4 m/s"])

    def test_methods_that_failed_or_have_no_rank_are_not_cut(self):
        lines = [Line(f"m{i:02}", float(i)) for i in range(20)]
        lines += [Line("fell", outcome="failed: sank"), Line("box2d", 1.0, outcome="not ranked: f32 among f64"), Line("none")]
        shown = finding.ranked(lines, "error", "m", ties=["m05"])["method"].tolist()
        self.assertLessEqual({"m00", "m05", "m19", "fell", "box2d", "none"}, set(shown))

    def test_no_ratio_to_nothing(self):
        self.assertEqual([finding.ratio(*v, unit="m") for v in ((2e-3, 0.0), (0.0, 0.0), (2.0, 1.0), (1.0001, 1.0))],
                         ["+2 mm", "equal", "2.0 times", "equal in three digits"])
        self.assertEqual(finding.ratio(1e-9, 0.0, floor=1e-6), "equal")

    def test_a_long_table_says_what_it_leaves_out(self):
        rows = pd.DataFrame({"method": [f"m{i}" for i in range(40)], "n": range(40)})
        for keep in ((), (1, 2), (20,), tuple(range(3, 30))):
            made = finding.cut(rows, keep)
            self.assertLessEqual(len(made), finding.ROWS)
            shown = [name for name in made["method"] if not name.startswith("…")]
            left = sum(int(name.split()[1]) for name in made["method"] if name.startswith("…"))
            self.assertEqual(len(shown) + left, 40, "a silent cut")
            self.assertEqual((shown[0], shown[-1]), ("m0", "m39"))
            self.assertTrue(len(keep) > 8 or {f"m{i}" for i in keep} <= set(shown), shown)
        self.assertEqual(finding.cut(rows[:12])["method"].tolist(), [f"m{i}" for i in range(12)])

    def test_json_and_pages_show_the_same_rows(self):
        made = Finding("a is best.", finding.ranked([Line("a|x", 1.5e-3), Line("b", math.inf), Line("c")], "error", "m"))
        rows = json.loads(json.dumps(made.rows(), allow_nan=False))
        self.assertEqual(rows[0], {"method": "a|x", "error [m]": 1.5e-3, "against the best": "best"})
        self.assertEqual(finding.text(made.headline, rows), made.text())
        self.assertEqual(made.text().split("\n")[1:3], ["method; error; against the best", "a|x; 1.5 mm; best"])
        page = table.to_markdown(rows)
        self.assertEqual(page.split("\n")[:3], ["| method | error | against the best |", "| --- | --- | --- |",
                                                "| a\\|x | 1.5 mm | best |"])


if __name__ == "__main__":
    unittest.main()
