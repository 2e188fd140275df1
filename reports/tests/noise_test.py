# SPDX-License-Identifier: Zlib
"""Tests of the report: noise over repeats, ranks over seeds. Run by ctest, or python3 reports/tests/noise_test.py. Each check is
seen to fail on a planted bug."""

import math
import random
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402

import chart  # noqa: E402
import measured  # noqa: E402
import noise  # noqa: E402
import ranking  # noqa: E402
import overlap  # noqa: E402
import style  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import broadphase, ensembles, measurements  # noqa: E402
from charts.cost_against_error import cost_against_error  # noqa: E402
from charts.measurements import noise_floor  # noqa: E402
from charts.one_change import precision, unneeded  # noqa: E402
from charts.step_times import step_times  # noqa: E402
from measured import Measured  # noqa: E402
from with_store import row  # noqa: E402

COST = "ms_per_step_median"


def cell(runs, **more):
    return {COST: float(np.median(runs)), measured.MEASURED: {COST: Measured(tuple(runs))}, "outcome": "ok",
            "arithmetic": (2, "f64"), **more}


def check_interval(interval_of):
    """The interval contains the median with at least the promised probability, for any distribution."""
    source = random.Random(4)
    for size in (5, 8, 10):
        for draw, median in ((source.random, 0.5), (lambda: source.expovariate(1.0), math.log(2))):
            held = sum(low <= median <= high for low, high in
                       (interval_of([draw() for _ in range(size)]) for _ in range(3000)))
            if held < 3000 * noise.SURE - 3 * math.sqrt(3000 * 0.09):
                return f"{size} values: {held} of 3000"
    return ""


class Noise(unittest.TestCase):
    def test_an_interval_contains_the_median(self):
        self.assertEqual(check_interval(noise.interval), "")
        quartiles = lambda values: (float(np.percentile(values, 25)), float(np.percentile(values, 75)))  # noqa: E731
        self.assertNotEqual(check_interval(quartiles), "", "quartiles were not seen")
        self.assertEqual(noise.interval([3, 1, 2, 5, 4]), (1, 5))
        self.assertEqual(noise.interval(range(10)), (1, 8))
        self.assertEqual([noise.certainty(n) for n in (2, 3, 4, 5, 10)], [50, 75, 87, 90, 90])

    def test_a_ratio_counts_only_beyond_the_floor_and_with_disjoint_intervals(self):
        base = cell([1.0, 1.01, 1.02, 1.03, 1.04])
        for runs, least, told in (([1.5, 1.51, 1.52, 1.53, 1.54], 1.1, "1.49"), ([1.05, 1.06, 1.07, 1.08, 1.09], 1.1, "noise"),
                                  ([0.9, 1.5, 1.5, 1.5, 1.6], 1.1, "noise"), ([math.nan] * 5, 1.1, "")):
            self.assertEqual(noise.said(base, cell(runs), COST, least), told)

    def test_identical_work_is_no_ratio(self):
        base = cell([1.0, 1.01, 1.02, 1.03, 1.04], work_row_updates=700.0)
        other = [0.8, 0.81, 0.82, 0.83, 0.84]
        self.assertEqual(noise.said(base, cell(other, work_row_updates=700.0), COST, 1.05), "identical work")
        self.assertEqual(noise.said(base, cell(other, work_row_updates=701.0), COST, 1.05), "0.80")
        self.assertEqual(noise.said(base, {**cell(other, work_row_updates=700.0), "arithmetic": (2, "f32")}, COST, 1.05), "0.80")
        self.assertEqual(noise.said(base, cell(other), COST, 1.05), "0.80", "no work counts")

    def test_few_repeats_are_not_called_noise(self):
        few, many = cell([1.0, 1.02, 1.01]), cell([1.03, 1.02, 1.0, 1.01, 1.04])
        for a, b, least, told in ((few, few, noise.UNMEASURED, noise.FEW), (few, many, 1.1, noise.FEW),
                                  (many, many, 1.1, noise.NOISE), (many, many, noise.UNMEASURED, noise.FEW)):
            self.assertEqual(noise.said(a, b, COST, least), told)


class OfStores(with_store.WithStore):
    @staticmethod
    def features(slower):
        def fill(maker):
            maker.sweep("features", "world", "minimal", resolver="label")
            for model, ms in (("minimal", 1.0), ("+joints", 0.81), ("+cache", 1.3), ("+friction", 1.02)):
                work = {} if model in ("minimal", "+joints") else {"work": 5000 * ms}
                axes = {"scene": "slope", "dimension": 2, "model": model, "resolver": "catto"}
                maker.world("features", axes, ms * slower, 1e-3, work=work.get("work", 4000))
        return fill

    def test_identical_work_is_never_a_finding(self):
        """A scene without joints cannot take 0.81 times the time with joints."""
        found = self.made(unneeded, self.features(1.0))[0]
        rows = {row["feature"]: (row["time over that of minimal [1]"], row["remark"]) for row in found.finding.rows()}
        self.assertRegex(found.finding.headline,
                         r"^slope does not need \+cache, which takes 1\.\d+ times the time of minimal\.$")
        self.assertAlmostEqual(rows.pop("+cache")[0], 1.3, delta=0.05)
        self.assertEqual(rows, {"+joints": (None, "identical work"), "+friction": (None, "inside the noise")})
        told = found.table.set_index("run")
        self.assertTrue(math.isnan(told.loc["+joints", "ratio of time per step [1]"]))
        self.assertEqual(told.loc["+joints", "time per step: why no ratio"], "identical work")
        self.assertIn("+cache", found.headline.text)
        with unittest.mock.patch.object(noise, "same_work", lambda a, b: False):
            bad = self.made(unneeded, self.features(1.0))[0]
        ratio = next(row["time over that of minimal [1]"] for row in bad.finding.rows() if row["feature"] == "+joints")
        self.assertAlmostEqual(ratio, 0.81, delta=0.05, msg="the planted bug was not seen")

    def test_all_repeats_are_kept(self):
        context = self.context(self.features(1.0))
        cells = context.store.cells("features")
        self.assertEqual({len(measured.runs(cell, COST)) for _, cell in cells.iterrows()}, {5})
        self.assertEqual(float(np.median(measured.runs(cells.iloc[0], COST))), cells[COST].iloc[0])
        self.assertEqual(cells["load"].iloc[0], 0.4)

    @undrawn.drawn
    def test_the_floor_is_that_of_a_method_with_itself(self):
        def fill(maker, spread=0.2):
            for repeat in range(6):
                axes = {"kind": "world", "scene": "s", "resolver": "a", "precision": "f64", "timed": True, "repeat": repeat}
                maker.trial("noisy", axes, {COST: 1 + spread * (repeat % 2)})
        context = self.context(fill)
        self.assertAlmostEqual(noise.floor(context.store.cells("noisy"), COST), 1.2)
        few = context.store.cells("noisy").assign(measured=[{COST: Measured((1.0, 1.1, 1.0))}])
        self.assertEqual(noise.floor(few, COST), noise.UNMEASURED)
        row = chart.made(noise_floor, context)[0]
        self.assertEqual(row.finding.headline, "A method differs from itself by at most 20 % (noisy, 1 cell).")
        self.assertEqual([(found["sweep"], found["noise floor"], found["cells with enough repeats"])
                          for found in row.finding.rows()], [("noisy", "20 %", 1)])
        drawn = [x for line in row.figure.axes[0].lines for x in line.get_xdata()]
        self.assertAlmostEqual(max(drawn), 20.0, msg="percent, as in the finding")
        self.assertIn("noisy, 1 cell", [label.get_text() for label in row.figure.axes[0].get_yticklabels()])

    def test_precisions_within_the_noise_have_no_ratio(self):
        def fill(maker, ratio=1.01):
            for name in ("f64", "f32"):
                maker.world("precision", {"scene": "stack", "dimension": 2, "resolver": "catto", "precision": name},
                            1.0 if name == "f64" else ratio, 1e-3)
        found = self.made(precision, fill)[0].finding
        self.assertEqual(found.headline, "Steps in f32 and f64 take the same time within the noise (1 pair); no outcome differs.")
        self.assertEqual(found.rows()[0]["remark"], "inside the noise")
        found = self.made(precision, lambda maker: fill(maker, 0.5))[0].finding
        self.assertRegex(found.headline, "A step in f32 takes 0.[45]")
        self.assertAlmostEqual(found.rows()[0]["time over that of f64 [1]"], 0.5, delta=0.05)

    def test_a_median_over_precisions_is_that_of_all_pairs(self):
        def fill(maker):
            for scene, ratio in (("a", 0.5), ("b", 0.52), ("c", 1.0), ("d", 1.0), ("e", 0.54)):
                for name in ("f64", "f32"):
                    for repeat in range(5):
                        axes = {"kind": "world", "scene": scene, "dimension": 2, "resolver": "catto", "precision": name,
                                "timed": True, "repeat": repeat}
                        ms = (ratio if name == "f32" else 1.0) * (1 + 0.01 * (repeat % 2))
                        maker.trial("precision", axes, {COST: ms, "lean": 1e-3})
        found = self.made(precision, fill)[0]
        self.assertEqual(found.finding.headline, "A step in f32 takes 0.54 times the time of one in f64 (median of 5 pairs, 3 "
                         "beyond the noise); no outcome differs.")
        self.assertEqual(found.headline.text, found.finding.headline)
        self.assertEqual([row["remark"] for row in found.finding.rows()], ["", "", "", "inside the noise", "inside the noise"])
        for least in (1.1, noise.UNMEASURED):
            self.assertIn("two whiskers do not overlap", noise.rule(least))

    @undrawn.drawn
    def test_the_fastest_broadphases_within_the_noise_are_all_named(self):
        def fill(maker):
            maker.sweep("boxes", "boxes", "naive", broadphase="stage")
            for method, times in (("naive", (10, 100, 1000)), ("other", (20, 50, 100)), ("third", (5, 40, 101))):
                for n, ns in zip((64, 128, 256), times):
                    for repeat in range(5):
                        axes = {"kind": "boxes", "dimension": 2, "distribution": "uniform", "broadphase": method, "n": n,
                                "precision": "f64", "timed": True, "repeat": repeat}
                        ns = ns * (1 + 0.02 * (repeat % 2))
                        maker.trial("boxes", axes, {"ns_per_frame_median": ns, "ns_per_frame_p25": ns, "ns_per_frame_p75": ns,
                                                    "box_tests_mean": 5.0, "load": 0.1})
        found = self.made(broadphase.broadphase, fill)[0]
        self.assertEqual(found.finding.headline, found.headline.text)
        self.assertIn("other and third (within the noise) are 9.9 to 10.0 times as fast as naive; other is faster from about 91 "
                      "bodies "
                      "on.", found.headline.text)
        self.assertEqual(row(found, "uniform")["between"], "64 and 128 bodies")
        drawn = " ".join(text.get_text() for ax in found.figure.axes for text in ax.texts)
        self.assertNotIn("wins", drawn)
        self.assertIn("faster than naive", drawn.replace("\n", " "))

    def test_a_missing_time_is_neither_a_line_nor_a_failure(self):
        """All ten frames are warm-up: runs that finished have no time, and are neither a line nor a failure."""
        def fill(maker, time=math.nan):
            maker.sweep("boxes", "boxes", "naive", broadphase="stage")
            for method in ("naive", "widest"):
                for n in (16, 64):
                    axes = {"kind": "boxes", "dimension": 2, "distribution": "uniform", "broadphase": method, "n": n,
                            "precision": "f64", "timed": True, "repeat": 0}
                    maker.trial("boxes", axes, {"ns_per_frame_median": time, "ns_per_frame_p25": time, "ns_per_frame_p75": time,
                                                "box_tests_mean": 5.0 if method == "naive" else 7.0})
        found = self.made(broadphase.broadphase, fill)[0]
        self.assertEqual(found.finding.headline, f"In 2D no time was taken: {broadphase.WHY_UNTIMED}.")
        self.assertEqual(found.holes, [f"no time of naive and widest: {broadphase.WHY_UNTIMED}"])
        self.assertNotIn("coincide", found.note)
        found = self.made(broadphase.broadphase, lambda maker: fill(maker, 1.0))[0]
        self.assertNotIn("no time", found.finding.text() + " ".join(found.holes))

    def test_a_broadphase_within_the_noise_crosses_nothing(self):
        def fill(maker):
            maker.sweep("boxes", "boxes", "naive", broadphase="stage")
            for method, power in (("naive", 1.0), ("other", 0.996)):
                for n in (64, 512):
                    for repeat in range(5):
                        axes = {"kind": "boxes", "dimension": 2, "distribution": "uniform", "broadphase": method, "n": n,
                                "precision": "f64", "timed": True, "repeat": repeat}
                        ns = (1.02 if method == "other" else 1.0) * n**power * (1 + 0.05 * (repeat % 2))
                        maker.trial("boxes", axes, {"ns_per_frame_median": ns, "ns_per_frame_p25": ns, "ns_per_frame_p75": ns,
                                                    "box_tests_mean": 5.0, "load": 0.1})
        found = self.made(broadphase.broadphase, fill)[0]
        self.assertIn("other: tie at the largest size, within the noise; no crossing", found.finding.text())
        self.assertEqual(found.finding.headline, "In 2D no broadphase is faster than naive beyond the noise at the largest size.")

    @undrawn.drawn
    def test_no_chart_calls_too_few_repeats_noise(self):
        def fill(maker):
            self.features(1.0)(maker)
            maker.sweep("costs", "world", "naive", resolver="label")
            maker.sweep("boxes", "boxes", "naive", broadphase="stage")
            for label, ms in (("catto", 1.0), ("naive", 1.02), ("box2d", 0.99)):
                for name in ("f64", "f32"):
                    where = {"scene": "stack", "dimension": 2, "resolver": label}
                    maker.world("costs" if name == "f64" else "precision", where, ms, 1e-3 * ms, repeats=2)
                    maker.world("precision", {**where, "precision": name}, ms, 1e-3, repeats=2)
                for n in (64, 128):
                    axes = {"kind": "boxes", "dimension": 2, "distribution": "uniform", "broadphase": label, "n": n,
                            "precision": "f64", "timed": True, "repeat": 0}
                    maker.trial("boxes", axes, {"ns_per_frame_median": n * ms, "ns_per_frame_p25": n * ms, "box_tests_mean": 5.0,
                                                "ns_per_frame_p75": n * ms})
            with maker.db:
                maker.db.execute("DELETE FROM planned WHERE sweep='features' AND axes GLOB '*repeat\": [34]*'")
        context, said = self.context(fill), ""
        for kind in (unneeded, cost_against_error, precision, broadphase.broadphase,
                     step_times):
            for made in chart.made(kind, context):
                told = made.finding.text() + (made.headline.text if made.headline else "")
                self.assertNotRegex(told, "(within|inside) the noise", made.id)
                self.assertEqual(overlap.overlaps(made.figure), ([], []), made.id)
                said += told
        self.assertGreaterEqual(said.lower().count("too few repeats"), 5, said)

    @staticmethod
    def two_scenes(maker, wide=0.2):
        """A sweep of two scenes, of which one has noisy repeats; naive takes 1.1 times the time of catto."""
        maker.sweep("costs", "world", "naive", resolver="label")
        for scene, spread in (("calm", 0.01), ("busy", wide)):
            for label, ms, error in (("naive", 1.1, 2e-3), ("catto", 1.0, 1e-3), ("soft_step", 0.5, 3e-3)):
                for repeat in range(6):
                    axes = {"kind": "world", "scene": scene, "dimension": 2, "resolver": label, "precision": "f64", "timed": True,
                            "repeat": repeat}
                    maker.trial("costs", axes, {COST: ms * (1 + spread * (repeat % 2)), "max_penetration": error,
                                                "penetration_poses": error})

    def test_the_floor_of_every_chart_is_that_of_its_sweep(self):
        context, everywhere = self.context(self.two_scenes), "up to 20 % in 6 cells with enough repeats"
        self.assertAlmostEqual(noise.floor_of(context, "costs", COST), 1.2)
        for found in chart.made(cost_against_error, context):
            self.assertIn(everywhere, found.note, found.id)
            self.assertEqual(row(found, "catto")["time per step against naive"], "inside the noise")
        of_shown = lambda context, sweep, metric: noise.floor(  # noqa: E731
            context.store.cells(sweep).query("scene == 'calm'"), metric)
        with unittest.mock.patch.object(noise, "floor_of", of_shown):
            bad = chart.made(cost_against_error, context)
        self.assertFalse(all(everywhere in found.note for found in bad), "the planted bug was not seen")
        for path in (HERE.parent / "charts").glob("*.py"):
            if path.stem not in ("measurements", "choose"):  # choose compares whole pipelines of several sweeps
                self.assertNotRegex(path.read_text(encoding="utf-8"), r"noise\.floor\(", "a floor of a chart's own cells")

    def test_each_role_has_a_floor_of_its_own(self):
        def fill(maker):
            maker.sweep("pairs", "pairs", pair_query="stage")
            for label, ns, spread in (("sat", 100.0, 0.02), ("gjk_epa", 120.0, 0.02), ("fcl", 90.0, 0.9)):
                for kind in ("box", "polytope"):
                    for repeat in range(6):
                        axes = {"kind": "pairs", "dimension": 3, "pair_query": label, "kind_a": kind, "kind_b": kind,
                                "timed": True, "precision": "f64", "repeat": repeat}
                        maker.trial("pairs", axes, {"ns_per_query": ns * (1 + spread * (repeat % 2))})
        context = self.context(fill)
        least = noise.floor_of(context, "pairs", "ns_per_query")
        sat, gjk, fcl = (cell for _, cell in context.store.cells("pairs").query("kind_a == 'box'").iterrows())
        for floor, told in ((least, "1.20"), (float(least), "noise")):  # a plain number: the planted bug, one floor for all
            self.assertEqual(noise.said(sat, gjk, "ns_per_query", floor), told)
        self.assertEqual(noise.said(sat, fcl, "ns_per_query", least), "noise")
        self.assertIn("up to 2 % (competitor) in 4 cells with enough repeats and 90 % (witness) in 2 cells with enough",
                      noise.rule(least))
        self.assertEqual([noise.percent(v) for v in (1.0234, 1.9, 2.6)], ["2.3", "90", "160"])
        found = chart.made(noise_floor, context)[0]
        self.assertEqual({row["sweep"]: row["noise floor"] for row in found.finding.rows()},
                         {"pairs": "2 %", "pairs (witness)": "90 %"})
        self.assertIn("Drawn at the edge of the first panel: marks of pairs (witness) (a factor of up to 1.9)", found.note)
        with unittest.mock.patch.object(measurements, "WIDEST", 200.0):
            self.assertNotIn("Drawn at the edge", chart.made(noise_floor, context)[0].note)
        told = measurements.finding_of_noise([
            {"sweep": name, "cells": 54, "ratios": [1.0] * n, "floor": floor, "loads": []}
            for name, n, floor in (("a", 3, 1.1), ("b", 21, 1.2), ("c", 0, noise.UNMEASURED))])
        self.assertEqual(told.headline, "A method differs from itself by at most 10 % (a, 3 cells) to 20 % (b, 95 of 100 cells).")
        self.assertEqual(told.table["cells with enough repeats"].tolist(), [3, 21, 0])
        self.assertEqual(measurements.beyond([{"sweep": "s", "ratios": [0.65, 1.1], "floor": 1.4}]), "", "-35 % is no +54 %")

    def test_the_rule_tells_how_many_cells_measure_the_floor_and_that_others_have_few_repeats(self):
        def fill(cells, few):
            def into(maker):
                maker.sweep("costs", "world", resolver="label")
                for i in range(cells):
                    for repeat in range(2 if i < few else 4):
                        axes = {"kind": "world", "scene": f"s{i}", "dimension": 2, "resolver": "catto", "precision": "f64",
                                "timed": True, "repeat": repeat}
                        maker.trial("costs", axes, {COST: 1 + 0.1 * (repeat % 2)})
            return into
        rule = lambda *cells: noise.rule(noise.floor_of(self.context(fill(*cells)), "costs", COST))  # noqa: E731
        self.assertIn("up to 10 % in 95 of 100 cells with enough repeats.", rule(21, 0))
        self.assertIn("up to 10 % in 20 cells with enough repeats.", rule(21, 1))
        self.assertIn("it is noise. Cells with fewer than 4 repeats need a ratio over 2.", rule(21, 1))
        self.assertNotIn("fewer than 4 repeats", rule(21, 0))

    def test_a_cell_of_few_repeats_is_judged_by_a_larger_floor(self):
        many = cell([1.0, 1.01, 1.02, 1.01, 1.0])
        self.assertEqual(noise.said(many, cell([1.08]), COST, 1.05), noise.FEW)
        self.assertEqual(noise.said(many, cell([2.5]), COST, 1.05), "2.48")
        self.assertEqual(noise.said(many, cell([1.08, 1.09, 1.08, 1.1]), COST, 1.05), "1.07")
        with unittest.mock.patch.object(noise, "between", lambda least, a, b, metric: least):
            self.assertEqual(noise.said(many, cell([1.08]), COST, 1.05), "1.07", "the planted bug was not seen")

    @staticmethod
    def ensemble(turned=False, failing=(), idle=False):
        def fill(maker):
            maker.sweep("ensemble", "world", resolver="label", perturb="parameter")
            for seed in range(1, 11):
                for label, error in (("catto", 1e-3), ("naive", 2e-3)):
                    worse = 5 if turned and seed in (4, 7) and label == "catto" else 1
                    axes = {"scene": "stack", "dimension": 2, "perturb": 1e-3, "resolver": label, "seed": seed}
                    failed = seed in failing and label == "naive"
                    maker.world("ensemble", axes, 1.0, error * worse * (1 + seed / 100), "collapsed" if failed else "ok",
                                "fell" if failed else "", 50 if failed else None, repeats=0, hash="00" if idle else f"{seed:02x}")
        return fill

    def test_seeds_are_one_cell_with_all_values(self):
        context = self.context(self.ensemble(failing=(3, 4)))
        cells = context.store.cells("ensemble").set_index("method")
        self.assertEqual(len(cells), 2)
        self.assertEqual(len(measured.seeds(cells.loc["catto"], "max_penetration")), 10)
        self.assertEqual(cells.loc["naive", "failed_seeds"], 2)
        self.assertEqual(cells.loc["naive", "outcome"], "collapsed", "one seed that fails is not hidden by nine that do not")
        self.assertAlmostEqual(cells.loc["catto", "max_penetration"], 1e-3 * 1.055)

    def test_ranks_over_seeds(self):
        found = self.made(ensembles.ensembles, self.ensemble(failing=(3, 4)))[0]
        self.assertIn("over 10 seeds, catto has the smallest penetration", found.finding.headline)
        self.assertEqual(row(found, "naive")["failed seeds"], "2 of 10 (6 to 51 %)")
        self.assertEqual(row(found, "catto")["largest penetration, worst"], "1.1 mm")
        self.assertIn("catto", found.headline.text)
        chances = [list(found.table[f"chance of a failure, {end} [1]"].round(3)) for end in ("low end", "high end")]
        self.assertEqual(chances, [[0, 0.057], [0.278, 0.510]], "of catto and naive")
        found = self.made(ensembles.ensembles, self.ensemble(turned=True))[0]
        self.assertIn("catto and naive tie", found.finding.headline)
        self.assertIsNone(found.headline, "a tie is no headline")
        with unittest.mock.patch.object(ranking, "better", lambda a, b, metric, zero, many: a[metric] < b[metric]):
            bad = self.made(ensembles.ensembles, self.ensemble(turned=True))[0]
        self.assertNotIn("tie", bad.finding.text(), "a rank by medians was not seen")

    def test_the_interval_of_a_chance_of_failure_is_wilsons(self):
        def seen(of):
            # Wilson 1927, as other programs print it: within 0 and 1, and symmetric.
            known = {(0, 20): (0, 0.1611), (1, 20): (0.0089, 0.2361), (10, 20): (0.2993, 0.7007), (20, 20): (0.8389, 1)}
            return [case for case, ends in known.items() if not np.allclose(of(*case), ends, atol=5e-5)]
        self.assertEqual(seen(noise.wilson), [])
        half = lambda failed, count: 1.96 * math.sqrt(failed * (count - failed) / count**3)  # noqa: E731
        self.assertEqual(seen(lambda failed, count: (failed / count - half(failed, count), failed / count + half(failed, count))),
                         [(0, 20), (1, 20), (10, 20), (20, 20)], "the planted bug, a normal distribution, was not seen")

    def test_a_headline_of_seeds_has_each_perturbation_and_equal_states_tie(self):
        def fill(maker):
            maker.sweep("ensemble", "world", resolver="label", perturb="parameter")
            for perturb, errors in ((1e-6, (1e-3, 1e-3, 2e-3)), (1e-3, (3e-3, 3e-3, 2e-3))):
                for seed in range(1, 11):
                    for label, error in zip(("catto+linear", "catto+split_impulse", "soft_step"), errors):
                        axes = {"scene": "stack", "dimension": 2, "perturb": perturb, "resolver": label, "seed": seed}
                        maker.world("ensemble", axes, 1.0, error * (1 + seed / 100), repeats=0, hash=f"{error}{seed:02x}")
        found = self.made(ensembles.ensembles, fill)[0]
        self.assertEqual(found.headline.text, "On stack, 2D, over 10 seeds, catto+linear and 1 more tie for the smallest "
                                              "penetration at "
                         "perturb=1e-06; soft_step has it at perturb=0.001 (median 2.11 mm).")
        self.assertEqual(row(found, "catto+split_impulse")["against the best"], "tie; same final state under 10 seeds")
        cell = lambda name, errors: {"method": name, "e": 1.0, "measured": {"e": Measured(seeds=errors)},  # noqa: E731
                                     "outcome": "ok", "seeds": [1, 2], "hashes": [f"{v}" for v in errors]}
        for errors, alike in (([1.0, 1.0], (2, 2)), ([1.0, 2.0], (1, 1)), ([0.5, 2.0], (0, 0))):
            self.assertEqual(ensembles.against(cell("a", [1.0, 1.0]), cell("b", errors), "e", 0.0), alike)

    def test_seeds_without_effect_are_reported(self):
        found = self.made(ensembles.ensembles, self.ensemble(idle=True))[0]
        self.assertIn("seeds change nothing here: all 10 end in the same state", " ".join(found.holes))
        found = self.made(ensembles.ensembles, self.ensemble())[0]
        self.assertNotIn("seeds change nothing", " ".join(found.holes))

    def test_a_rank_that_flips_is_a_tie_in_cost_against_error(self):
        for turned, words in ((False, "catto has the smallest penetration"), (True, "catto and naive end in a tie")):
            def fill(maker, turned=turned):
                maker.sweep("costs", "world", resolver="label")
                for seed in range(1, 11):
                    for label, error in (("catto", 1e-3), ("naive", 2e-3)):
                        worse = 5 if turned and seed in (4, 7) and label == "catto" else 1
                        axes = {"scene": "stack", "dimension": 2, "resolver": label, "seed": seed}
                        maker.world("costs", axes, 1.0, error * worse)
            found = self.made(cost_against_error, fill)
            self.assertEqual(len(found), 1, "not one chart for each seed")
            self.assertIn(words, found[0].finding.headline)
            self.assertIn("tie" if turned else "2.0 times", row(found[0], "naive")["against the best"])

    def test_errors_within_a_cost_name_the_setting_and_equal_methods(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for label, each, errors in (("weld", 1.0, (3e-3, 2e-3, 1e-3)), ("pivot", 0.3, (9e-3, 8e-3, 7e-3)),
                                        ("hinge", 0.3, (9e-3, 8e-3, 7e-3)), ("rod", 0.3, (9e-3, 8e-3, 7e-3))):
                for iterations, error in zip((4, 10, 30), errors):
                    axes = {"scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations}
                    maker.world("costs", axes, each * iterations / 4, error)
        found = self.made(cost_against_error, fill)[0]
        self.assertEqual(found.finding.headline, "On stack, 2D, within 1.03 ms per step, weld has the smallest penetration (3 "
                                                 "mm at "
                         "iterations=4), hinge and 2 more the largest (8 mm at iterations=10).")
        self.assertEqual(found.headline.text, found.finding.headline)
        self.assertEqual([row(found, name)["against the best"] for name in ("weld", "hinge", "pivot", "rod")],
                         ["best", *["2.7 times"] * 3])

    def test_slowest_steps_have_the_setting_and_ties(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label", iterations="setting")
            for iterations in (4, 10, 30):
                for label, worst in (("a", 1.5), ("b", 4.0), ("c", 4.1), ("d", 3.9)):
                    for repeat in range(5):
                        axes = {"kind": "world", "scene": "stack", "dimension": 2, "resolver": label, "iterations": iterations,
                                "precision": "f64", "timed": True, "repeat": repeat}
                        maker.trial("costs", axes, {COST: 1.0, "ms_per_step_p99": 1.2,
                                                    "ms_per_step_worst": worst * (1 + 0.1 * (repeat % 2))})
        found = self.made(step_times, fill)[0]
        self.assertEqual(found.finding.headline, "On stack in 2D at iterations=10 the slowest step takes 4.1 times the median "
                         "with c (4.1 ms), 1.5 times with a (1.5 ms).")
        rows = {row["method"]: row for row in found.finding.rows()}
        self.assertEqual({name: row["against the best"] for name, row in rows.items()},
                         {"a": "best", "d": "2.6 times", "b": "2.7 times", "c": "2.7 times"})
        self.assertEqual({name: row["range"] for name, row in rows.items() if name > "a"},
                         {"b": "4 to 4.4", "c": "4.1 to 4.51", "d": "3.9 to 4.29"})
        self.assertAlmostEqual(rows["c"]["slowest step [s]"], 4.1e-3)

    def test_slowest_steps_and_engines(self):
        def fill(maker):
            maker.sweep("costs", "world", resolver="label")
            for label, ms in (("catto", 1.0), ("naive", 0.9), ("box2d", 0.3)):
                maker.world("costs", {"scene": "stack", "dimension": 2, "resolver": label}, ms, 1e-3)
        found = self.made(step_times, fill)[0]
        self.assertRegex(found.finding.headline,
                         r"the slowest step takes 2(\.\d)?( to 2\.\d)? times the median; all methods tie\.$")
        rows = {row["method"]: row["against the best"] for row in found.finding.rows()}
        self.assertRegex(rows.pop("box2d"), r"^engine: 0\.3\d times the median of naive$")
        self.assertEqual(sorted(rows.values()), ["best, tie", "tie"])

    def test_no_two_ticks_have_one_label(self):
        labels = [style._tick(value, "1") for value in style._ticks(math.log10(1.4e-4), math.log10(8e-4), 8)]
        self.assertEqual(len(set(labels)), len(labels), labels)

    def test_ticks_below_a_million_have_all_digits(self):
        self.assertEqual([style._tick(value, "1") for value in (5e4, 1e5, 2e5, 1e6)],
                         ["50,000", "100,000", "200,000", "$10^{6}$"])


if __name__ == "__main__":
    unittest.main()
