# SPDX-License-Identifier: Zlib
"""Tests of the tunnelling map: shares, ratios of times and findings of known runs. Run by ctest, or python3
reports/tests/tunnelling_map_test.py [PICTURE.png]."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import noise  # noqa: E402
import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts.tunnelling_map import tunnelling_map  # noqa: E402

SPEEDS, WALLS = (25, 100, 400), (0.001, 0.01)
# Method: us of a step, and how many of 20 bullets tunnel, walls from the thinnest on, speeds from the slowest on.
METHODS = {"none": (10.0, ((10, 17, 19), (8, 16, 18))), "speculative": (12.0, ((0, 0, 1), (0, 0, 0))),
           "ray": (15.0, ((0, 0, 0), (0, 0, 0))), "cast": (30.0, ((0, 0, 0), (0, 0, 0))),
           "cast+bilateral": (10.1, ((0, 0, 0), (0, 0, 0)))}
SHARE, RATIO = "share that tunnelled [1]", "time per step over that of none [1]"


class Map(with_store.WithStore):
    @staticmethod
    def bullets(of=None, fell=(), repeats=6, dimensions=(2,), counted=True, seeds=None, n=20, ghosts=0,
                report=("tunnelling_map",)):
        """`fell`: (method, speed) of runs that explode; `seeds`: offset of the count of each seed; `ghosts`: of speculative."""
        def fill(maker):
            for name in ("tunnelled", "ghost_hits", "lost_time") if counted else ():
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "world", name.replace("_", " "), "s" if name == "lost_time" else "1",
                                  "invented", "detail", "fewer", ""))
            maker.sweep("mine", baseline="none", continuous="label", speed="parameter", thickness="parameter",
                        **({"report": list(report)} if report else {}))
            for dimension in dimensions:
                for method, (us, passed) in (of or METHODS).items():
                    for wall, row in zip(WALLS, passed):
                        for speed, count in zip(SPEEDS, row):
                            one(maker, dimension, method, wall, speed, count, us / 1000)

        def one(maker, dimension, method, wall, speed, count, ms):
            axes = {"kind": "world", "precision": "f64", "scene": "bullet_wall", "dimension": dimension, "continuous": method,
                    "speed": speed, "thickness": wall}
            outcome = ("exploded", "speed", 7) if (method, speed) in fell else ("ok",)
            extra = {"params": {"n": n, "radius": 0.05}}
            for seed, more in (seeds or {None: 0}).items():
                facts = {"tunnelled": count + more, "ghost_hits": ghosts if method == "speculative" else 0, "lost_time": 0.5,
                         "work_row_updates": 10.0 + ms}
                own = {**axes, **({"seed": seed} if seed else {})}
                maker.trial("mine", {**own, "timed": False, "repeat": 0}, facts if counted else {}, *outcome, extra=extra)
                for repeat in range(repeats if outcome == ("ok",) else 0):
                    maker.trial("mine", {**own, "timed": True, "repeat": repeat},
                                {"ms_per_step_median": ms * (1 + 0.02 * (repeat // 2))}, extra=extra)
        return fill

    def one(self, **about):
        found = self.made(tunnelling_map, self.bullets(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @staticmethod
    def at(made, method, speed, wall):
        table = made.table
        return table[(table["method"] == method) & (table["speed [m/s]"] == speed) &
                     (table["thickness of the wall [m]"] == wall)].iloc[0]

    def test_shares_ratios_and_the_finding(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(self.at(made, "none", 400, 0.001)[SHARE], 0.95)
        self.assertEqual(self.at(made, "none", 25, 0.01)[SHARE], 0.4)
        self.assertAlmostEqual(self.at(made, "cast", 100, 0.01)[RATIO], 3.0)
        self.assertTrue(math.isnan(self.at(made, "none", 25, 0.01)[RATIO]))
        self.assertEqual(self.at(made, "speculative", 25, 0.001)["lost time [s]"], 0.5)
        self.assertEqual(made.finding.headline, "bullet_wall, 2D: no bullet tunnels with cast, cast+bilateral and 1 more; up "
                                                "to 95 % "
                         "tunnel with the method none.")
        table = made.finding.table.set_index("method")
        self.assertEqual(list(table.index), ["cast", "cast+bilateral", "ray", "speculative", "none"])
        self.assertEqual(list(table["cells with tunnelling"]), ["0 of 6", "0 of 6", "0 of 6", "1 of 6", "6 of 6"])
        self.assertEqual(list(table.loc["none", ["largest share that tunnels [1]", "speed [m/s]", "thickness [m]"]]),
                         [0.95, 400, 0.001])
        self.assertEqual(list(table["time of a step over the baseline's"]),
                         ["3.0", "tie: inside the noise in 6 of 6 cells", "1.5", "1.2", "baseline"])
        self.assertEqual(made.headline.text, made.finding.headline)
        self.assertEqual(made.headline.values, {"none": 0.95, "speculative": 0.05, "ray": 0, "cast": 0, "cast+bilateral": 0})
        self.assertIn(f"“≈”: {noise.IN_WORDS[noise.NOISE]}.", made.note)
        self.assertNotIn("“=”", made.note)

    @undrawn.drawn
    def test_a_panel_for_each_method_the_baseline_first(self):
        made = self.one()
        panels = [ax for ax in made.figure.axes if ax.get_visible()]
        self.assertEqual([ax.get_title() or ax.get_title("left") for ax in panels[:5]],
                         ["none", "cast", "cast+bilateral", "ray", "speculative"])
        words = [sorted(text.get_text() for text in ax.texts) for ax in panels]
        self.assertEqual(words[0], sorted(["50", "85", "95", "40", "80", "90"]))
        self.assertEqual(words[3], ["0"] * 6)
        self.assertEqual(words[6], ["3.0"] * 6)
        self.assertEqual(words[7], ["≈"] * 6)
        greens = {patch.get_facecolor() for patch in panels[3].patches}
        few = {patch.get_facecolor() for patch in panels[4].patches}
        self.assertEqual((len(greens), len(few - greens)), (1, 1), "one of twenty looks like none")

    def test_the_planted_bug_a_difference_inside_the_noise_is_a_tie(self):
        made = self.one()
        told = self.at(made, "cast+bilateral", 25, 0.001)
        self.assertEqual((told["ratio is"], self.at(made, "ray", 25, 0.001)["ratio is"]),
                         (noise.IN_WORDS[noise.NOISE], "beyond the noise"))
        real, noise.said = noise.said, lambda a, b, metric, least: f"{noise.ratio(a, b, metric):.2f}"
        try:
            self.assertFalse(self.one().finding.table["time of a step over the baseline's"].str.contains("tie").any())
        finally:
            noise.said = real

    def test_few_repeats_give_ratios_beyond_two_only(self):
        made = self.one(repeats=2)
        times = made.finding.table.set_index("method")["time of a step over the baseline's"]
        self.assertEqual((times["cast"], times["cast+bilateral"]), ("3.0", "tie: too few repeats in 6 of 6 cells"))
        self.assertIn(f"“?”: {noise.IN_WORDS[noise.FEW]}", made.note)

    @undrawn.drawn
    def test_an_untimed_sweep_has_no_times(self):
        made = self.one(repeats=0)
        self.assertNotIn("time of a step over the baseline's", made.finding.table)
        self.assertEqual(sum(ax.get_visible() for ax in made.figure.axes), 5)
        self.assertNotIn(RATIO, made.table)

    @undrawn.drawn
    def test_a_failure_is_a_letter_and_no_zero(self):
        made = self.one(fell=(("ray", 400), ("none", 25)))
        panels = {ax.get_title("left"): ax for ax in made.figure.axes if ax.get_visible()}
        self.assertEqual(sorted(text.get_text() for text in panels["ray"].texts), ["0"] * 4 + ["E"] * 2)
        table = made.finding.table.set_index("method")
        self.assertEqual(list(table.index), ["cast", "cast+bilateral", "speculative", "ray", "none"], "failures stand last")
        self.assertEqual(list(table.loc[["ray", "none"], "outcome"]), ["no result in 2 of 6 cells"] * 2)
        self.assertEqual(list(table.loc[["cast", "ray"], "cells with tunnelling"]), ["0 of 6", "0 of 4"])
        self.assertTrue(math.isnan(made.headline.values["ray"]))
        self.assertNotIn("ray", made.headline.text)
        self.assertIn("ray, speed=400, thickness=0.001: exploded at step 7 (speed)", made.holes)
        self.assertTrue(math.isnan(self.at(made, "ray", 400, 0.001)[SHARE]))
        self.assertTrue(math.isnan(self.at(made, "cast", 25, 0.001)[RATIO]), "over a baseline that failed")

    def test_the_worst_seed_counts(self):
        made = self.one(seeds={1: 0, 2: 1})
        self.assertEqual(self.at(made, "ray", 25, 0.001)[SHARE], 0.05)
        self.assertEqual(self.at(made, "none", 400, 0.001)[SHARE], 1.0)
        self.assertIn("no method stops all bullets", made.finding.headline)

    def test_ghost_hits_are_listed(self):
        ghosts = self.one(ghosts=7).finding.table.set_index("method")["ghost hits in a cell, most [1]"]
        self.assertEqual((ghosts["speculative"], ghosts["cast"]), (7, 0))
        self.assertNotIn("ghost hits in a cell, most [1]", self.one().finding.table)

    def test_equal_shares_are_no_headline(self):
        self.assertIsNone(self.one(of={m: (us, ((0, 0, 0), (0, 0, 0))) for m, (us, _) in METHODS.items()}).headline)

    def test_a_chart_for_each_dimension(self):
        found = self.made(tunnelling_map, self.bullets(dimensions=(2, 3)))
        self.assertEqual([c.id for c in found], ["mine_tunnelling_map_bullet_wall__2d", "mine_tunnelling_map_bullet_wall__3d"])

    @undrawn.drawn
    def test_many_methods_stand_in_rows(self):
        many = {f"method_{i}" if i else "none": (10.0 + i, METHODS["none"][1]) for i in range(12)}
        made = self.one(of=many)
        self.assertEqual(sum(ax.get_visible() for ax in made.figure.axes), 24)

    def test_without_counts_or_without_a_number_of_bullets_there_is_no_chart(self):
        self.assertEqual(self.made(tunnelling_map, self.bullets(counted=False, report=())), [tunnelling_map.absent])
        self.assertEqual(self.made(tunnelling_map, self.bullets(n=None, report=())), [tunnelling_map.absent])
        asked = self.made(tunnelling_map, self.bullets(counted=False))
        self.assertEqual(asked[0].finding.headline, "The `report` of mine lists this chart, but the sweep lacks its data.")

    def test_a_sweep_with_the_axes_makes_a_chart(self):
        self.assertEqual(len(self.made(tunnelling_map, self.bullets(report=()))), 1)
        self.assertEqual(self.made(tunnelling_map, synthetic_store.resolvers), [tunnelling_map.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
