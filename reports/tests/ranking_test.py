# SPDX-License-Identifier: Zlib
"""Tests of the rules of all charts that rank: intervals over seeds, ties, and methods without a rank. Run by ctest, or
python3 reports/tests/ranking_test.py."""

import itertools
import json
import math
import random
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import pandas as pd  # noqa: E402

import measured  # noqa: E402
import ranking  # noqa: E402
import with_store  # noqa: E402
from charts import ensembles  # noqa: E402
from charts.cost_against_error import cost_against_error, error_within_budgets  # noqa: E402
from charts.equal_cost import equal_cost  # noqa: E402
from measured import Measured  # noqa: E402
from with_store import row  # noqa: E402


def cell(*values):
    """One method under seeds 1, 2, ...; NaN is a failure."""
    return {"e": values[0], measured.MEASURED: {"e": Measured(seeds=tuple(values))}, "seeds": list(range(1, len(values) + 1)),
            "outcome": "ok"}


def false_ranks(better, methods=5, seeds=20, trials=400):
    """How often at least one difference is reported among equal methods: each seed shifts all of them, and each method
    a little."""
    source, told = random.Random(9), 0
    many = ranking.comparisons(methods)
    for _ in range(trials):
        starts = [source.lognormvariate(0, 1) for _ in range(seeds)]
        found = [cell(*(start * source.lognormvariate(0, 0.1) for start in starts)) for _ in range(methods)]
        told += any(better(a, b, "e", many=many) for a, b in itertools.permutations(found, 2))
    return told / trials


class Intervals(unittest.TestCase):
    def test_what_an_interval_leaves_out_is_the_binomial_distribution(self):
        # Tables of the sign test: the largest count that is significant at 5 %, two-sided (Dixon and Mood 1946).
        known = {5: -1, 6: 0, 8: 0, 9: 1, 11: 1, 12: 2, 15: 3, 17: 4, 20: 5, 25: 7, 30: 9}
        self.assertEqual({count: ranking.left_out(count) for count in known}, known)
        self.assertEqual([ranking.fewest(many) for many in (1, 10, 105, 210)], [6, 9, 13, 14])
        # 210 pairs of 21 methods: 2 * 21 / 2^20 is below 0.05 / 210, and 2 * 211 / 2^20 is not.
        self.assertEqual([ranking.left_out(ranking.ENOUGH, many) for many in (124, 125, 210)], [2, 1, 1])
        self.assertEqual(ranking.interval(range(20)), (5, 14))
        self.assertEqual(ranking.interval(range(5)), (-math.inf, math.inf))
        self.assertEqual([ranking.comparisons(count) for count in (1, 2, 3, 21)], [1, 1, 3, 210])

    def test_seeds_are_paired(self):
        starts = [10.0**(i % 7) for i in range(20)]
        a, b = cell(*starts), cell(*(1.01 * v for v in starts))
        self.assertTrue(ranking.better(a, b, "e"))
        for value in ranking.ratio(a, b, "e"):
            self.assertAlmostEqual(value, 1.01)
        turned = cell(*reversed([1.01 * v for v in starts]))
        self.assertFalse(ranking.better(a, {**turned, "seeds": a["seeds"]}, "e"), "unpaired, the seeds are noise")
        self.assertTrue(ranking.better(a, {**turned, "seeds": a["seeds"][::-1]}, "e"), "pairs have equal seeds, not equal "
                                                                                       "positions")

    def test_zeros_and_failures_are_ends_of_the_scale(self):
        nan = math.nan
        self.assertEqual(ranking.log_ratios(cell(0, 0, 1, 1, 0, nan), cell(0, 2, 0, nan, nan, nan), "e"),
                         [0, math.inf, -math.inf, math.inf, math.inf, 0])
        self.assertEqual(ranking.log_ratios(cell(1e-15, 1e-15), cell(1e-14, 1e-12), "e", 1e-12), [0, 0], "rounding")
        self.assertTrue(ranking.better(cell(*[1.0] * 20), cell(*[nan] * 18, 0.5, 0.5), "e"))
        self.assertEqual(ranking.ratio(cell(*[1.0] * 20), cell(*[nan] * 20), "e"), (math.inf, math.inf, math.inf))
        self.assertEqual(ranking.ratio(cell(*[0.0] * 20), cell(*[0.0] * 20), "e"), (1, 1, 1))

    def test_few_seeds_decide_nothing_and_one_seed_is_no_sample(self):
        self.assertFalse(ranking.better(cell(*[1.0] * 5), cell(*[9.0] * 5), "e"))
        self.assertTrue(ranking.better(cell(*[1.0] * 6), cell(*[9.0] * 6), "e"))
        self.assertFalse(ranking.better(cell(*[1.0] * 6), cell(*[9.0] * 6), "e", many=3))
        self.assertTrue(ranking.better(cell(1.0), cell(9.0), "e"))
        self.assertIn("One seed: this is an order", ranking.rule(1, 4))
        self.assertIn("5 seeds cannot decide 6 pairs, which takes 8", ranking.rule(5, 4))
        self.assertIn("under 19 of 20 seeds", ranking.rule(20, 21))
        self.assertIn("for up to 6 pairs together", ranking.rule(20, 2, 4), "two budgets")
        self.assertEqual(ranking.rule(20, 1), "Fewer than two methods have a rank here.")

    def test_equal_methods_are_ranked_in_at_most_five_percent(self):
        self.assertLessEqual(false_ranks(ranking.better), 0.05)
        # Planted bugs: each pair at the full level, and medians without an interval.
        self.assertGreater(false_ranks(lambda a, b, metric, many: ranking.better(a, b, metric)), 0.1)
        self.assertGreater(false_ranks(lambda a, b, metric, many: measured.seeds(a, "e")[0] < b["e"], trials=20), 0.5)


METHODS = {"catto": 3e-3, "admm": 1e-3, "naive": 4e-3, "box2d": 5e-4}


class WithoutRank(with_store.WithStore):
    @staticmethod
    def sweep(fallbacks=400.0, about=None, precision="f32", start=0.0, **roles):
        """admm leaves rows to Gauss-Seidel; box2d, the best method, is in f32."""
        def fill(maker):
            maker.sweep("mine", resolver="label", iterations="setting", perturb="parameter",
                        **({"calibrate": about, "budget": "run"} if about else {}), **roles)
            entry = {"stage": "engine", "group": "engine", "name": "box2d", "role": "engine"}
            registry = json.loads(maker.db.execute("SELECT value FROM meta WHERE key='registry'").fetchone()[0])
            registry["algorithms"] = [a for a in registry["algorithms"] if a["name"] != "box2d"] + [entry]
            maker.db.execute("UPDATE meta SET value=? WHERE key='registry'", (json.dumps(registry),))
            for name, error in METHODS.items():
                for seed in range(1, 21):
                    for iterations in (4,) if about else (4, 8):
                        axes = {"kind": "world", "scene": "stack", "dimension": 2, "perturb": 1e-3, "resolver": name,
                                "seed": seed, "iterations": iterations, "precision": precision if name == "box2d" else "f64",
                                **({"budget": 400} if about else {})}
                        depth = error * (1 + seed / 100)
                        facts = {"penetration_start": start, "penetration_poses": depth, "max_penetration": depth,
                                 "work_row_updates": 90.0 * iterations, "drift_limit": 0.5,
                                 "work_fallbacks": fallbacks if name == "admm" and seed > 15 else 0.0}
                        maker.trial("mine", {**axes, "timed": False, "repeat": 0}, facts, hash=f"{name}{seed}",
                                    series={"points": [0] * 100 + [500] * 100})
                        for repeat in range(2):
                            maker.trial("mine", {**axes, "timed": True, "repeat": repeat},
                                        {**facts, "ms_per_step_median": 0.1 * iterations * (1 + repeat / 100)},
                                        hash=f"{name}{seed}")
        return fill

    CALIBRATED = {"equal": "cost", "metric": "work_row_updates", "setting": "iterations"}

    def all_charts(self, **more):
        found = {kind: self.made(kind, self.sweep(**more)) for kind in (
            cost_against_error, error_within_budgets, ensembles.ensembles)}
        found[equal_cost] = self.made(equal_cost, self.sweep(about=self.CALIBRATED, **more))
        return {kind.name: made for kind, (made, *_) in found.items()}

    def test_fallbacks_and_other_precisions_have_no_rank(self):
        for name, made in self.all_charts().items():
            with self.subTest(name):
                self.assertRegex(made.finding.text(), "not ranked: 80 % Gauss-Seidel")
                self.assertRegex(made.finding.text(), "not ranked: f32 among f64")
                first = "\n".join(line for line in made.finding.text().split("\n") if "not ranked" not in line)
                self.assertIn("catto", made.finding.headline)
                self.assertNotIn("admm", first)
                self.assertNotIn("box2d", first)
                if made.headline:
                    self.assertTrue(all(made.headline.values.get(m) != made.headline.values[m] for m in ("admm", "box2d")
                                        if m in made.headline.values), "no number that ranks")
        # Without fallbacks and in one precision, all methods have a rank.
        for name, made in self.all_charts(fallbacks=0.0, precision="f64").items():
            with self.subTest(name):
                self.assertNotIn("not ranked", made.finding.text())
                self.assertNotIn("Gauss-Seidel", made.finding.text())
                self.assertIn("box2d", made.finding.headline)
        # Planted bug: every method with a number has a rank.
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            for name, made in self.all_charts().items():
                self.assertNotIn("Gauss-Seidel", made.finding.text(), name)
                self.assertIn("box2d", made.finding.headline, name)

    def test_the_note_counts_pairs_of_ranked_methods(self):
        for about, pairs in (({}, "1 pair"), ({"fallbacks": 0.0, "precision": "f64"}, "6 pairs")):
            for name, made in self.all_charts(**about).items():
                self.assertIn(f"with 95 % for {pairs} together", made.note, name)

    def test_a_penetration_at_the_start_prevents_ranks(self):
        for start, words in ((1.5e-3, "no method has a rank: bodies overlap by up to 1.5 mm at the start"),
                             (1e-9, "catto has the smallest penetration")):
            made = self.made(ensembles.ensembles, self.sweep(start=start))[0]
            self.assertIn(words, made.finding.headline)
            self.assertEqual("not ranked: overlap at the start" in made.finding.text(), start > 1e-6)
            self.assertEqual(made.headline is None, start > 1e-6)
            made = self.made(equal_cost, self.sweep(start=start, about=self.CALIBRATED))[0]
            self.assertEqual("Bodies overlap by up to 1.5 mm at the start" in " ".join(made.holes), start > 1e-6)
        with unittest.mock.patch.object(ranking, "overlapping", lambda cells: 0.0):
            self.assertIn("catto has", self.made(ensembles.ensembles, self.sweep(start=1.5e-3))[0].finding.headline,
                          "the planted bug was not seen")

    def test_the_depth_beyond_the_slop_has_its_own_column(self):
        """The raw depth ranks; another method may be best beyond the slop."""
        def fill(maker):
            maker.sweep("mine", resolver="label", perturb="parameter")
            for name, error, slop in (("catto", 6e-3, 0.005), ("naive", 3e-3, 0.0)):
                for seed in range(1, 21):
                    axes = {"scene": "stack", "dimension": 2, "perturb": 1e-3, "resolver": name, "seed": seed}
                    maker.world("mine", axes, 1.0, error * (1 + seed / 1000), repeats=0,
                                extra={"pipeline": f"solver=split_solver{{velocity={name},position=linear{{slop={slop:g}}}}}"})
        made = self.made(ensembles.ensembles, fill)[0]
        self.assertEqual(made.finding.headline, "On stack, 2D, over 20 seeds, naive has the smallest penetration (median 3.03 "
                                                "mm).")
        found = row(made, "catto")
        self.assertEqual((found["penetration beyond the slop, median"], found["beyond the slop"]), ("1.06 mm", "best"))
        self.assertEqual(row(made, "naive")["beyond the slop"], "")
        self.assertIn("Ranks use the raw depth, largest penetration;", made.note)
        self.assertIn("penetration beyond the slop, median [m]", made.table)

    def test_a_gap_that_follows_the_perturbation_names_no_place(self):
        cells = pd.DataFrame({"gap": [4e-6, 4e-3, 4e-6], "perturb": [1e-6, 1e-3, 1e-6], "n": [5, 5, 10]})
        self.assertEqual(ensembles.telling(cells, ["gap", "n", "perturb"]), ["perturb", "n"])
        self.assertEqual(ensembles.telling(cells, []), [])

    def test_names_have_the_reason_without_a_rank(self):
        context = self.context(self.sweep())
        found = ranking.names(context, context.cells("mine"))
        self.assertEqual(found, {"catto": "catto", "admm": "admm (80 % Gauss-Seidel)", "naive": "naive",
                                 "box2d": "box2d (engine, f32 among f64)"})

    def test_the_share_of_rows_is_unknown_with_joints(self):
        context = self.context(self.sweep())
        cells = context.cells("mine").assign(joint_error_max=1e-3)
        self.assertEqual(ranking.names(context, cells)["admm"], "admm (rows by Gauss-Seidel)")


if __name__ == "__main__":
    unittest.main()
