# SPDX-License-Identifier: Zlib
"""Tests of the chart that says what to take: the fastest of those that are right under every seed, ties with their reason, what
all that is taken costs as a whole. Run by ctest, or python3 reports/tests/choose_test.py."""

import contextlib
import io
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import choice  # noqa: E402
import load  # noqa: E402
import make  # noqa: E402
import noise  # noqa: E402
import overlap  # noqa: E402
import ranking  # noqa: E402
import style  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
from with_store import row  # noqa: E402
from charts.choose import what_to_take  # noqa: E402

SEEDS = tuple(range(1, 11))
FLAT = (1.0,) * len(SEEDS)
# method: ms per step, largest penetration (m), what is left (m), outcome, factors of the time and of what is left by seed
RESOLVERS = {"naive": (0.3, 0.05, 0.05, "ok", FLAT, FLAT), "millington": (0.2, 0.01, 0.001, "collapsed", FLAT, FLAT),
             "catto+none": (1.0, 0.011, 0.001, "ok", FLAT, FLAT), "catto+linear": (2.0, 0.01, 0.001, "ok", FLAT, FLAT),
             "soft_step": (4.0, 0.02, 0.001, "ok", FLAT, FLAT), "box2d": (0.5, 0.01, 0.001, "ok", FLAT, FLAT)}
# ms per whole step, us of the stage
BROADPHASES = {"naive": (1.0, 900.0), "sort_and_sweep": (1.0, 100.0), "region_tree": (1.0, 101.0), "uniform_grid": (1.0, 300.0)}
SPLIT = "solver=split_solver{velocity=catto{iterations=10},position=%s}"
GIVEN = "broadphase=region_tree cache=by_feature " + SPLIT % "split_impulse"
ALGORITHMS = synthetic_store.registered("broadphase", sorted(BROADPHASES)) + synthetic_store.registered(
    "solver", ["soft_step"]) + synthetic_store.registered("velocity", ["catto", "naive", "millington"]) + [
    {"stage": "solver", "group": "solver", "name": "split_solver", "role": "competitor", "params": [
        {"name": "velocity", "type": "stage:velocity", "default": "catto"},
        {"name": "position", "type": "stage:position", "default": "split_impulse"}]},
    {"stage": "engine", "group": "engine", "name": "box2d", "role": "engine"}]
ALGORITHMS[-5]["params"] = [{"name": "iterations", "type": "integer", "default": "10"}]  # catto's


def pipeline(broadphase="region_tree", resolver="catto+split_impulse"):
    if resolver == "box2d":
        return "engine=box2d{iterations=10}"
    solver = SPLIT % resolver.split("+")[1] if "+" in resolver else f"solver={resolver}"
    return f"broadphase={broadphase} cache=by_feature {solver}"


class Choose(undrawn.Undrawn):
    def made(self, resolvers=RESOLVERS, whole=None, seeds=SEEDS, repeats=4, hashes="same", broadphases=BROADPHASES):
        """(context, charts); `whole`: ms per step of the taken pipeline, where it ran beside what was given."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "store.db"
        maker = synthetic_store.Maker(self.path, algorithms=ALGORITHMS)
        place = {"scene": "mixed_pile", "dimension": 2, "n": 50}
        maker.sweep("choose_broadphase", "world", "", broadphase="stage", n="parameter", report=["choose"])
        for label, (ms, us) in broadphases.items():
            for seed in seeds:
                maker.world("choose_broadphase", {**place, "broadphase": label, "seed": seed}, ms, 1e-2, repeats=repeats,
                            left=1e-3, hash=f"{hashes if hashes == 'same' else label}{seed}",
                            stages={"broadphase": us, "boxes": 1.0},
                            extra={"pipeline": pipeline(broadphase=label)})
        maker.sweep("choose_resolver", "world", "", resolver="label", n="parameter", report=["choose"])
        for label, (ms, error, left, outcome, speed, more) in resolvers.items():
            for seed, slow, worse in zip(seeds, speed, more):
                maker.world("choose_resolver", {**place, "resolver": label, "seed": seed}, ms * slow, error, outcome,
                            "it fell" if outcome != "ok" else "", repeats=repeats, left=left * worse,
                            extra={"pipeline": pipeline(resolver=label)})
        if whole is not None:
            maker.sweep("choose_together", "world", "given", together="label", n="parameter", report=["choose"])
            for label, ms, text in (("given", 3.0, GIVEN), ("taken", whole, pipeline("sort_and_sweep", "catto+none"))):
                for seed in seeds:
                    maker.world("choose_together", {**place, "together": label, "seed": seed}, ms, 2e-2, repeats=repeats,
                                left=2e-3, extra={"pipeline": text})
        maker.close()
        context = chart.Context(load.Store(self.path))
        made = what_to_take.make(context)
        self.addCleanup(style.plt.close, "all")
        for c in made:
            if c.figure is not None and self.draws:
                self.assertEqual(overlap.overlaps(c.figure), ([], []))
        return context, made

    def column(self, table, stage, name):
        return {row["method"]: row[name] for _, row in table[table["stage"] == stage].iterrows()}

    def verdicts(self, table, stage):
        return {method: word for method, word in self.column(table, stage, "verdict").items() if word in ("take", "tie")}

    def test_one_chart_takes_the_fastest_of_those_that_are_right(self):
        _, made = self.made()
        self.assertEqual([c.id for c in made], ["choose_mixed_pile__2d__n_50"])
        self.assertEqual(self.verdicts(made[0].table, "resolver"), {"catto+none": "take"})
        self.assertEqual(made[0].finding.headline,
                         "For mixed_pile, 2D, n=50 take broadphase sort_and_sweep and resolver catto+none.")
        found = row(made[0], "resolver")
        self.assertEqual((found["take"], found["time of"]), ("catto+none", "a step"))
        self.assertIn("box2d: 0.5", found["fastest other library"])
        self.assertIn("millington (collapsed)", found["failed"])
        self.assertIn("naive", found["err more"])
        self.assertIn("millington: collapsed (it fell)", " ".join(made[0].holes))
        # The planted bug would take whoever is fastest, however wrong.
        with unittest.mock.patch.object(choice, "wrong", lambda *_: []):
            _, wrong = self.made()
        self.assertEqual(self.verdicts(wrong[0].table, "resolver"), {"naive": "take"}, "the planted bug was not seen")

    def test_every_verdict_has_its_reason(self):
        _, made = self.made()
        reasons = self.column(made[0].table, "resolver", "reason")
        self.assertIn("mean penetration of shapes at the end 50 times that of", reasons["naive"])
        self.assertIn("above 2 times over 10 seeds", reasons["naive"])
        self.assertEqual(reasons["millington"], "collapsed under 10 of 10 seeds: it fell")
        self.assertRegex(reasons["catto+linear"], r"^(1\.9\d|2\.\d+) times as long$")
        self.assertTrue(all(reasons.values()), reasons)

    def test_what_a_scene_is_left_with_excludes_as_the_largest_penetration_does(self):
        sunk = {**RESOLVERS, "catto+none": (1.0, 0.01, 0.009, "ok", FLAT, FLAT)}  # deep at the end, never deeper than others
        _, made = self.made(sunk)
        self.assertEqual(self.verdicts(made[0].table, "resolver"), {"catto+linear": "take"})
        with unittest.mock.patch.object(choice, "LEFT", "max_penetration"):  # as it was: the largest alone
            _, wrong = self.made(sunk)
        self.assertEqual(self.verdicts(wrong[0].table, "resolver"), {"catto+none": "take"}, "the planted bug was not seen")

    def test_depths_within_the_slop_are_equal_and_then_who_rests_and_the_time_rank(self):
        """Else the dear one would be taken for a millimetre that the cheap one keeps on purpose."""
        def fill(cheap, jitter, slop="0.005"):
            """(method taken, reasons): avbd errs least and is three times as dear; the cheap one keeps slop."""
            folder = tempfile.TemporaryDirectory()
            self.addCleanup(folder.cleanup)
            path = Path(folder.name) / "store.db"
            maker = synthetic_store.Maker(path, algorithms=ALGORITHMS)
            maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                             ("metric", "jitter", "world", "jitter", "m/s", "", "detail", "what rests stays", ""))
            maker.sweep("choose_resolver", "world", "", resolver="label", n="parameter", report=["choose"])
            for label, ms, depth, speed in (("soft_step", 8.0, 1e-4, 1e-3), ("catto+none", 2.6, cheap, jitter)):
                text = pipeline(resolver=label).replace("position=none", f"position=linear{{slop={slop}}}")
                for seed in SEEDS:
                    axes = {"kind": "world", "precision": "f64", "scene": "mixed_pile", "dimension": 2, "n": 50,
                            "resolver": label, "seed": seed}
                    for repeat in range(4):
                        maker.trial("choose_resolver", {**axes, "timed": True, "repeat": repeat},
                                    {"ms_per_step_median": ms * (1 + repeat / 100), "penetration_poses": depth * (1 + seed / 100),
                                     "mean_penetration_poses_end": depth / 2, "jitter": speed * (1 + seed / 100)},
                                    extra={"pipeline": text})
            maker.close()
            made, = what_to_take.make(chart.Context(load.Store(path)))
            self.addCleanup(style.plt.close, "all")
            return (next(m for m, word in self.verdicts(made.table, "resolver").items() if word == "take"),
                    self.column(made.table, "resolver", "reason"), made)
        taken, _, made = fill(2e-3, 1e-3)
        self.assertEqual(taken, "catto+none", "2 mm are within the slop")
        self.assertIn("up to 5 mm, the slop that methods keep on purpose", made.note)
        self.assertIn("jitter counts as 0 up to 50 mm/s, which is rest", made.note)
        taken, reasons, _ = fill(2e-2, 1e-3)
        self.assertEqual(taken, "soft_step", "20 mm are not")
        self.assertIn("which counts as 0", reasons["catto+none"])
        taken, reasons, _ = fill(2e-3, 0.5)
        self.assertEqual(taken, "soft_step", "what trembles does not stand")
        self.assertIn("jitter", reasons["catto+none"])
        self.assertEqual(fill(2e-3, 1e-3, "0")[0], "soft_step", "nobody keeps it on purpose")
        # The planted bug is what was: whoever is less deep, however little.
        with unittest.mock.patch.object(choice, "zeros", lambda context, cells, errors: dict.fromkeys(errors, 1e-12)):
            self.assertEqual(fill(2e-3, 1e-3)[0], "soft_step", "the planted bug was not seen")

    def test_an_error_that_seeds_turn_round_excludes_nobody(self):
        flips = {**RESOLVERS, "naive": (0.3, 0.01, 0.003, "ok", FLAT, (1.0, 0.3) * 5)}
        _, made = self.made(flips)
        self.assertEqual(self.verdicts(made[0].table, "resolver"), {"naive": "take"})
        # Medians alone, the planted bug, would send it away.
        _, wrong = self.made({**flips, "naive": (0.3, 0.01, 0.003, "ok", FLAT, FLAT)})
        self.assertEqual(self.column(wrong[0].table, "resolver", "verdict")["naive"], "errs more")

    def test_a_rank_that_seeds_turn_round_is_a_tie_and_says_so(self):
        turns = {**RESOLVERS, "catto+linear": (1.3, 0.011, 0.001, "ok", (1.0, 0.7) * 5, FLAT)}
        _, made = self.made(turns)
        self.assertEqual(self.verdicts(made[0].table, "resolver"), {"catto+none": "take", "catto+linear": "tie"})
        self.assertEqual(row(made[0], "resolver")["ties"], f"catto+linear ({choice.TURNS})")
        told = ranking.better
        with unittest.mock.patch.object(ranking, "better", lambda a, b, metric, *more, **named: metric == choice.COST or
                                        told(a, b, metric, *more, **named)):
            _, wrong = self.made(turns)
        self.assertEqual(self.verdicts(wrong[0].table, "resolver"), {"catto+none": "take"}, "the planted bug was not seen")

    def test_of_those_that_tie_the_hour_does_not_choose(self):
        """Else the next run on the same machine would advise another."""
        near = {"catto+none": (1.0, 0.01, 0.0013, "ok", FLAT, FLAT), "catto+linear": (1.01, 0.01, 0.001, "ok", FLAT, FLAT)}
        taken = {}
        for label, factor in (("as it was", 1.0), ("another hour", 0.98)):
            ms, *rest = near["catto+linear"]
            _, made = self.made({**near, "catto+linear": (ms * factor, *rest)})
            taken[label] = self.verdicts(made[0].table, "resolver")
            self.assertEqual(row(made[0], "resolver")["taken of the ties"],
                             "it has the smallest mean penetration of shapes at the end over 10 seeds")
        self.assertEqual(taken["as it was"], {"catto+linear": "take", "catto+none": "tie"})
        self.assertEqual(taken["as it was"], taken["another hour"])
        # Where nobody errs less, what the other stages were judged with stays.
        same = {"catto+none": (1.0, 0.01, 0.001, "ok", FLAT, FLAT), "catto+split_impulse": (1.01, 0.01, 0.001, "ok", FLAT, FLAT)}
        _, made = self.made(same)
        self.assertEqual(self.verdicts(made[0].table, "resolver"), {"catto+split_impulse": "take", "catto+none": "tie"})
        self.assertEqual(self.verdicts(made[0].table, "broadphase"), {"region_tree": "take", "sort_and_sweep": "tie"})
        self.assertEqual(row(made[0], "resolver")["taken of the ties"], f"it {choice.COMMON}")
        # Judged against the fastest, whose name has room in the table, not in the picture.
        _, made = self.made(same, broadphases={**BROADPHASES, "naive_sphere": (2.3, 900.0)})
        reasons = self.column(made[0].table, "broadphase", "reason")
        self.assertIn("times as long as sort_and_sweep (whole", reasons["naive_sphere"])
        # The planted bug is the fastest of the hour.
        with unittest.mock.patch.object(choice, "_of_equals", lambda _, cells, *__: (cells[0], "")):
            _, wrong = self.made(near)
        self.assertEqual(self.verdicts(wrong[0].table, "resolver")["catto+none"], "take", "the planted bug was not seen")

    def test_broadphases_of_equal_runs_are_judged_by_their_stage(self):
        _, made = self.made()
        self.assertEqual(self.verdicts(made[0].table, "broadphase"), {"sort_and_sweep": "take", "region_tree": "tie"})
        found = row(made[0], "broadphase")
        self.assertEqual(found["time of"], "the stage alone")
        self.assertRegex(found["ties"], rf"^region_tree \((within the noise|{choice.TURNS})\)$")
        self.assertRegex(found["taken of the ties"], "^it ")
        self.assertRegex(found["next"], "^uniform_grid: 3.0")
        # Who makes more pairs than there are leaves more work to the rest of the step, and that counts.
        more = {"sort_and_sweep": (1.0, 100.0), "region_tree": (1.0, 150.0), "naive_sphere": (2.3, 90.0)}
        _, dear = self.made(broadphases=more)
        self.assertEqual(self.verdicts(dear[0].table, "broadphase"), {"sort_and_sweep": "take"})
        self.assertRegex(self.column(dear[0].table, "broadphase", "reason")["naive_sphere"], r"^2\.3 times as long \(whole steps")
        with unittest.mock.patch.object(choice, "_by", lambda cell, cost, usual: cost):
            _, wrong = self.made(broadphases=more)
        self.assertEqual(self.verdicts(wrong[0].table, "broadphase"), {"naive_sphere": "take"}, "the planted bug was not seen")
        # Where their runs differ, the rest of the step is other work, and whole steps are judged.
        _, differ = self.made(hashes="each")
        self.assertEqual(len(self.verdicts(differ[0].table, "broadphase")), len(BROADPHASES), "all tie by whole steps")

    def test_too_few_repeats_are_told_from_noise(self):
        near = {**RESOLVERS, "catto+linear": (1.01, 0.011, 0.001, "ok", FLAT, FLAT)}
        few, near_by = noise.IN_WORDS[noise.FEW], noise.IN_WORDS[noise.NOISE]
        for repeats, why, other in ((4, near_by, few), (2, few, near_by)):
            _, made = self.made(near, repeats=repeats)
            self.assertEqual(self.column(made[0].table, "resolver", "reason")["catto+linear"], why)
            self.assertNotIn(other, made[0].finding.text())

    def test_no_ratio_is_told_within_the_noise(self):
        _, made = self.made({**RESOLVERS, "box2d": (1.01, 0.01, 0.001, "ok", FLAT, FLAT)})
        self.assertRegex(row(made[0], "resolver")["fastest other library"], f"^box2d: (within the noise|{choice.TURNS})")

    def test_nobody_who_finished_is_no_error(self):
        _, made = self.made({m: (1.0, 1e-3, 1e-3, "collapsed", FLAT, FLAT) for m in ("catto+none", "soft_step")}, seeds=SEEDS[:1])
        self.assertIn("take broadphase sort_and_sweep; no method finished with a time for resolver.", made[0].finding.headline)
        self.assertEqual(row(made[0], "resolver")["take"], "none finished with a time")
        self.assertEqual(choice.to_run(chart.Context(load.Store(self.path))), "")

    def test_what_is_taken_is_run_as_a_whole_and_stands_beside_what_was_given(self):
        context, made = self.made()
        pasted = "broadphase=sort_and_sweep cache=by_feature solver=split_solver{position=none}"
        self.assertEqual(choice.to_run(context), pasted)
        self.assertIn(f"Not yet run as a whole: --pipeline '{pasted}'", made[0].note)
        self.assertIn("The combined pipeline has not run yet", " ".join(made[0].holes))
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            self.assertEqual(make.main(["--store", str(self.path), "--taken"]), 0)
        self.assertEqual(printed.getvalue(), pasted + "\n")
        context, made = self.made(whole=1.0)
        self.assertEqual(choice.to_run(context), "", "it has run")
        found = row(made[0], "as a whole")
        self.assertRegex(found["median and interval"], r"^1\.0\d ms \(.* to .*\)$")
        self.assertRegex(found["against the pipeline of the sweeps"], r"^0\.3\d times$")
        self.assertEqual(found["mean penetration of shapes at the end"], "2 mm")
        self.assertIn(f"To paste: --pipeline '{pasted}'", made[0].note)
        self.assertEqual(self.verdicts(made[0].table, "as a whole"), {"taken": "take"})
        self.assertRegex(made[0].headline.text, r"take broadphase sort_and_sweep and resolver catto\+none: 1\.0\d ms a step, "
                                                r"0\.3\d "
                         "times the time of the pipeline of the sweeps")
        self.assertNotIn("has not run", " ".join(made[0].holes))
        _, made = self.made(whole=3.01)
        self.assertEqual(row(made[0], "as a whole")["against the pipeline of the sweeps"], "tie: within the noise")
        self.assertNotIn("pipeline of the sweeps", made[0].headline.text)

    def test_what_is_taken_may_have_run_anyway(self):
        context, made = self.made({"catto+split_impulse": (1.0, 0.01, 0.001, "ok", FLAT, FLAT)},
                                  broadphases={"region_tree": (1.0, 100.0), "naive": (1.0, 900.0)})
        self.assertEqual(choice.to_run(context), "")
        self.assertRegex(row(made[0], "as a whole")["median and interval"], r"^1\.0\d ms")

    def test_errors_and_times_have_intervals(self):
        left = (0.7, 0.8, 0.9, 1.0, 1.0, 1.0, 1.0, 1.1, 1.4, 1.5)
        _, made = self.made({**RESOLVERS, "catto+none": (1.0, 0.01, 0.001, "ok", FLAT, left)})
        table = made[0].table.set_index("method").loc["catto+none"]
        ends = [table[f"mean penetration of shapes at the end{end} [m]"] for end in (", low end", "", ", high end")]
        for value, expected in zip(ends, (0.0008, 0.001, 0.0014)):
            self.assertAlmostEqual(value, expected)
        self.assertLess(table["time per step, low end [s]"], table["time per step [s]"])

    @undrawn.drawn
    def test_methods_are_named_where_they_stand(self):
        """A legend of nineteen entries is no legend: each row has its name, other libraries' say what they are."""
        _, made = self.made(whole=1.0)
        labels = [text.get_text() for text in made[0].figure.axes[0].get_yticklabels()]
        self.assertLessEqual({"naive", "box2d (engine)", "catto+none", "taken: all stages"}, set(labels))
        self.assertLess(len(made[0].figure.legends[0].get_texts()), 6)


class Pipelines(unittest.TestCase):
    def test_what_has_its_default_is_left_out(self):
        long = "broadphase=naive solver=split_solver{velocity=catto{iterations=10},position=none} sleep=none"
        self.assertEqual(choice.short(long, ALGORITHMS), "broadphase=naive solver=split_solver{position=none} sleep=none")
        other = long.replace("=10", "=12")
        self.assertEqual(choice.short(other, ALGORITHMS),
                         "broadphase=naive solver=split_solver{velocity=catto{iterations=12},position=none} sleep=none")
        self.assertEqual(choice.short(long, []), long, "what nobody has described is kept")


if __name__ == "__main__":
    unittest.main()
