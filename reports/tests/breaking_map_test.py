# SPDX-License-Identifier: Zlib
"""Tests of the map of breaking points: numbers, intervals and findings of searches with known results. Run by ctest, or python3
reports/tests/breaking_map_test.py."""

import math
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import load  # noqa: E402
import overlap  # noqa: E402
import ranking  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from charts import breaking_map  # noqa: E402

ABOUT = {"parameter": "n", "falling": False, "seeds": 5, "perturb": 1e-3, "ratio": 1.05, "limit": ""}
FOUND = ("half of the seeds fail at n [1]", "95 % interval", "against the best", "remark")  # columns of a finding
COLUMNS = ["last that holds [1]", "first that fails [1]", "half fail from [1]", "half fail to [1]"]


class Map(undrawn.Undrawn):
    def made(self, questions, asked, picture=None, budget=None, fallbacks=(), few=5):
        """`asked`: question -> method -> {value: number of seeds of five that fail, the list of their measurements, or "dear"};
        `fallbacks`: (method, value) of runs that leave 4 of 5 rows to Gauss-Seidel; `few`: seeds of a value at which none
        fails."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        roles = {about["parameter"]: "parameter" for about in questions.values()}
        maker.sweep("mine", resolver="label", question="run", report=["breaking_map"], **roles, **{"break": questions})
        for question, of_methods in asked.items():
            name, limit = questions[question]["parameter"], questions[question]["limit"]
            for method, rungs in of_methods.items():
                for value, seeds in rungs.items():
                    for seed in range(1, 1 + (few if seeds == 0 else 5)):
                        axes = {"kind": "world", "precision": "f64", "scene": "stack", "dimension": 2, "question": question,
                                "resolver": method, name: value, "seed": seed, "timed": False, "repeat": 0}
                        if budget:
                            axes["budget"] = budget
                        if seeds == "dear":
                            maker.trial("mine", axes, {}, "unsupported", "it costs 500, the budget is 400")
                            continue
                        if limit:
                            maker.trial("mine", axes, {"joint_error_max": seeds[seed - 1], "work_multiply_adds": 9.0})
                            continue
                        fell = seed <= seeds
                        left = {"work_fallbacks": 80.0} if (method, value) in fallbacks else {}
                        maker.trial("mine", axes, {"work_multiply_adds": 10.0 * value, **left}, "collapsed" if fell else "ok",
                                    "drift" if fell else "", 50 if fell else None,
                                    series={"points": [50] * 50} if left else None)
        maker.close()
        found = chart.made(breaking_map.breaking_map, chart.Context(load.Store(Path(folder.name) / "store.db")))
        self.assertEqual(len(found), 1)
        if self.draws:
            self.assertEqual(overlap.overlaps(found[0].figure), ([], []))
        if picture:
            found[0].figure.savefig(picture)
        return found[0]

    @staticmethod
    def rows(made, *columns):
        """{method: values of these columns of the finding's table}, in its order."""
        return {row["method"]: tuple(row.get(column) for column in columns) for row in made.finding.rows()}

    def test_numbers_intervals_and_what_is_not_monotone(self):
        made = self.made({"tallest tower": ABOUT}, {"tallest tower": {
            "catto": {1: 0, 2: 0, 3: 0, 4: 2, 5: 3, 6: 4, 8: 5},  # 5 is where half fail; sure from 3 to 8
            "naive": {1: 0, 2: 5, 4: 0, 8: 5},  # holds again at 4
            "soft_step": {1: 0, 2: 0, 4: 0, 8: 0},
            "millington": {1: 5, 2: 5, 4: 5, 8: 5}}})
        rows = {row["method"]: row for _, row in made.table.iterrows()}
        self.assertEqual([rows["catto"][name] for name in COLUMNS], [4, 5, 3, 8])
        self.assertEqual([rows["naive"][name] for name in COLUMNS], [1, 2, 1, 2])
        self.assertEqual(rows["naive"]["hold beyond"], 1)
        self.assertEqual(rows["soft_step"]["last that holds [1]"], 8)
        self.assertTrue(math.isnan(rows["soft_step"]["first that fails [1]"]))
        self.assertTrue(math.isnan(rows["millington"]["last that holds [1]"]))
        self.assertEqual(rows["catto"]["multiply-adds per step [1]"], 40)
        self.assertAlmostEqual(rows["catto"]["half of the seeds fail at [1]"], math.sqrt(20), msg="2 of 5, then 3")
        self.assertEqual(made.finding.headline, "Tallest tower, stack: soft_step holds to n = 8 (the last value tried, 5 seeds).")
        self.assertEqual(self.rows(made, *FOUND[1:]), {
            "soft_step": ("8 to ?", "best", "last value tried, 5 seeds"), "catto": ("3 to 8", "0.6 times", None),
            "naive": ("1 to 2", "0.2 times", "not monotone"),
            "millington": ("", "failed: holds at no value tried", None)})
        self.assertIn("Tallest tower, stack, naive: not monotone, holds again at 4", made.holes)
        self.assertEqual(made.headline.text, made.finding.headline)

    def test_falling_and_by_what_is_measured(self):
        about = {**ABOUT, "falling": True, "limit": "joint_error_max<0.01"}
        good, bad, some = [0.001] * 5, [0.02] * 5, [0.02, 0.02, 0.001, 0.001, 0.001]
        made = self.made({"smallest n": about}, {"smallest n": {"catto": {1: bad, 2: bad, 3: some, 4: good},
                                                                "naive": {1: bad, 2: bad, 3: bad, 4: good}}})
        rows = {row["method"]: row for _, row in made.table.iterrows()}
        self.assertEqual([rows["catto"][name] for name in COLUMNS], [3, 2, 2, 4])
        self.assertEqual([rows["naive"][name] for name in COLUMNS], [4, 3, 3, 4])
        self.assertIn("joint_error_max<0.01", made.note)
        self.assertFalse(made.headline.larger)

    @undrawn.drawn
    def test_breaking_points_by_laxer_limits_are_shown(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        maker.sweep("mine", resolver="label", question="run", report=["breaking_map"], n="parameter",
                    **{"break": {"largest n": ABOUT}})
        for value, share in ((1, 0.001), (2, 0.05), (4, 0.2), (8, 0.9)):
            for seed in range(1, 6):
                axes = {"kind": "world", "precision": "f64", "scene": "stack", "dimension": 2, "question": "largest n",
                        "resolver": "catto", "n": value, "seed": seed, "timed": False, "repeat": 0}
                maker.trial("mine", axes, {"sunk": share}, "ok" if share <= 0.01 else "sank", "", 50)
        maker.close()
        made, = chart.made(breaking_map.breaking_map, chart.Context(load.Store(Path(folder.name) / "store.db")))
        row = made.table.iloc[0]
        self.assertEqual(row["last that holds [1]"], 1)
        self.assertAlmostEqual(row["half have sunk by more than 10 % at [1]"], math.sqrt(8))
        self.assertAlmostEqual(row["half have sunk by more than 50 % at [1]"], math.sqrt(32))
        self.assertIn("10 %: 2.83, 50 %: 5.66", [text.get_text() for text in made.figure.axes[0].texts])

    def test_methods_whose_intervals_overlap_tie_at_either_end(self):
        """8 [4, 16] and 4.5 [2, 16] overlap; 2.8 [2, 4] and 2.4 [1, 4] share only an end with the first interval."""
        asked = {"tallest tower": {
            "catto": {2: 0, 4: 0, 8: 2, 9: 3, 16: 5}, "naive": {2: 0, 4: 2, 5: 3, 16: 5}, "xpbd": {2: 0, 4: 5, 16: 5},
            "jacobi": {1: 0, 2: 2, 3: 3, 4: 5}}}
        made = self.made({"tallest tower": ABOUT}, asked)
        self.assertEqual(made.finding.headline, "Tallest tower, stack: catto and naive hold to n = 8.49 and tie.")
        self.assertEqual(self.rows(made, *FOUND[1:3]), {"catto": ("4 to 16", "best, tie"), "naive": ("2 to 16", "tie"),
                                                        "xpbd": ("2 to 4", "0.3 times"), "jacobi": ("1 to 4", "0.3 times")})
        self.assertEqual(made.headline.text, made.finding.headline)
        with unittest.mock.patch.object(breaking_map, "ties", lambda known, value: [m for m, f in known.items()
                                                                                    if breaking_map.edge(f) == value]):
            bug = self.made({"tallest tower": ABOUT}, asked)
        self.assertIn("catto holds to n = 8.49.", bug.finding.headline, "the planted bug, numbers alone, was not seen")
        self.assertEqual(self.rows(bug, "against the best")["naive"], ("0.5 times",))

    def test_several_questions_have_a_row_each(self):
        tower = {"catto": {2: 0, 4: 0, 8: 2, 9: 3, 16: 5}, "naive": {2: 0, 4: 2, 5: 3, 16: 5}, "xpbd": {2: 0, 4: 5, 16: 5}}
        made = self.made({"tallest tower": ABOUT, "least n": {**ABOUT, "falling": True}},
                         {"tallest tower": tower, "least n": {"catto": {1: 5, 2: 0, 4: 0}, "naive": {1: 5, 2: 5, 4: 5}}})
        self.assertEqual(made.finding.headline, "catto is best or ties for the best in 2 of 2 questions; xpbd is worst in 1.")
        self.assertEqual(made.finding.rows(), [
            {"question": "Tallest tower, stack", "best": "catto and naive", "best breaks at": "n = 8.49",
             "95 % interval": "4 to 16", "worst": "xpbd", "worst breaks at": "2.83", "no value or rank": ""},
            {"question": "Least n, stack", "best": "catto", "best breaks at": "n = 1.41", "95 % interval": "1 to 2",
             "worst": "", "worst breaks at": "", "no value or rank": "naive (failed: holds at no value tried)"}])

    def test_a_method_that_never_failed_has_the_seeds_of_the_last_value(self):
        made = self.made({"tallest tower": ABOUT}, {"tallest tower": {"catto": {1: 0, 8: 0}, "naive": {1: 0, 2: 5}}}, few=4)
        self.assertIn("catto holds to n = 8 (the last value tried, 4 seeds).", made.finding.headline)
        self.assertEqual(list(made.table["seeds at the last that holds"]), [4, 4])

    @undrawn.drawn
    def test_a_method_that_left_rows_to_gauss_seidel_up_to_its_breaking_point_has_no_rank(self):
        asked = {"tallest tower": {"admm": {1: 0, 4: 0, 8: 0}, "catto": {1: 0, 2: 0, 4: 5}, "direct_lcp": {1: 0, 2: 5, 8: 5}}}
        made = self.made({"tallest tower": ABOUT}, asked, fallbacks={("admm", 4), ("direct_lcp", 8)})
        self.assertEqual(made.finding.headline, "Tallest tower, stack: catto holds to n = 2.83.")
        self.assertEqual(self.rows(made, "against the best"), {"catto": ("best",), "direct_lcp": ("0.5 times",),
                                                               "admm": ("not ranked: 80 % Gauss-Seidel",)})
        self.assertEqual(set(made.headline.values), {"catto", "direct_lcp"}, "values beyond the first failure do not count")
        self.assertIn("80 % Gauss-Seidel", [text.get_text() for text in made.figure.axes[0].texts])
        self.assertEqual(list(made.table["not ranked"]), ["80 % Gauss-Seidel", "", ""])
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            bug = self.made({"tallest tower": ABOUT}, asked, fallbacks={("admm", 4)})
        self.assertIn("admm holds to n = 8", bug.finding.headline, "the planted bug was not seen")

    def test_a_closed_form_judges_from_both_sides(self):
        """A block that stays put below the closed form is as wrong as one that slides above it."""
        about = {**ABOUT, "parameter": "friction", "falling": True, "truth": 0.5}
        made = self.made({"least friction": about}, {"least friction": {
            "catto": {0.4: 5, 0.499: 5, 0.501: 0, 0.6: 0}, "naive": {0.4: 5, 0.45: 0, 0.6: 0},
            "xpbd": {0.5: 5, 0.55: 5, 0.6: 0}}})
        self.assertEqual(made.finding.headline, "Least friction, stack: the closed form gives friction = 0.5; catto breaks "
                         "there, naive at 0.424.")
        self.assertEqual(self.rows(made, "95 % interval", "against the closed form"), {
            "catto": ("0.499 to 0.501", "as the closed form"), "xpbd": ("0.55 to 0.6", "fails before it by 0.0745"),
            "naive": ("0.4 to 0.45", "holds beyond it by 0.0757")})
        self.assertEqual(made.headline.text, made.finding.headline)
        self.assertAlmostEqual(made.headline.values["catto"], 0, places=5)
        self.assertFalse(made.headline.larger)
        without = self.made({"least friction": {**about, "truth": 0}}, {"least friction": {
            "catto": {0.4: 5, 0.499: 5, 0.501: 0, 0.6: 0}, "naive": {0.4: 5, 0.45: 0, 0.6: 0}}})
        self.assertIn("naive holds to friction = 0.424", without.finding.headline,
                      "the planted bug, one side only, ranks the wrong method first")

    @undrawn.drawn
    def test_a_method_over_budget_does_not_fail(self):
        made = self.made({"tallest tower": ABOUT}, {"tallest tower": {
            "proximal_newton": {1: 0, 2: 0, 4: "dear", 8: "dear"}, "direct_lcp": {1: "dear", 2: "dear", 4: "dear", 8: 0},
            "catto": {1: 0, 2: 5, 4: 5, 8: 5}, "naive": {1: 5, 2: 5, 4: 5, 8: 5}}}, budget=400.0)
        self.assertEqual(made.finding.headline, "Tallest tower, stack: proximal_newton holds to n = 2 (then over budget).")
        self.assertEqual(self.rows(made, *FOUND[2:]), {
            "proximal_newton": ("best", "then over budget"), "catto": ("0.7 times", None),
            "direct_lcp": ("over budget at every value tried", None), "naive": ("failed: holds at no value tried", None)})
        words = [text.get_text() for text in made.figure.axes[0].texts]
        self.assertEqual((words.count("over budget"), words.count("then over budget"), words.count("none")), (1, 1, 1))
        self.assertIn("one iteration costs more than the budget allows", made.note)

    @undrawn.drawn
    def test_many_questions_stand_in_rows_of_six(self):
        names = ["tallest tower", "largest mass ratio", "largest dt", "longest chain", "smallest slope margin", "farthest origin",
                 "one more"]
        made = self.made({name: {**ABOUT, "parameter": "dt" if name == "largest dt" else "n"} for name in names},
                         {name: {"catto+linear": {1: 0, 2: 0, 300: 5, 4000: 0}, "soft_step": {1: 0, 2: 5, 300: 5, 4000: 5}}
                          for name in names}, picture=PICTURE)
        first, second = (ax.get_position().width / len(ax.get_xticks()) for ax in made.figure.axes)
        self.assertAlmostEqual(first, second)

    def test_long_values_beside_their_interval(self):
        steps, places = {0.0166667: 0, 0.0235702: 5, 0.0333333: 0}, {4.194304e6: 0, 8.388608e6: 5, 1.6777216e7: 0}
        names = ["largest step", "farthest origin", "a third", "a fourth", "a fifth", "a sixth"]
        self.made({name: {**ABOUT, "parameter": "y" if name == "farthest origin" else "dt"} for name in names},
                  {name: {"catto+split_impulse": places if name == "farthest origin" else steps} for name in names})


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
