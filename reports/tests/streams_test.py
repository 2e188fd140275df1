# SPDX-License-Identifier: Zlib
"""Tests of the chart of pair queries on streams: ranks change only where both orders are beyond the noise. Run by ctest, or
python3 reports/tests/streams_test.py [PICTURE.png]."""

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
from charts import pair_times  # noqa: E402
from charts.pair_times import streams  # noqa: E402

# Scene: {method: ns a query on drawn pairs, cold, warm (None: no cached data)}
SCENES = {"pile": {"sat": (200, 90, None), "gjk_epa": (100, 160, 120), "closed_form": (50, 40, None)},
          "tower": {"sat": (90, 80, None), "gjk_epa": (200, 202, 201), "closed_form": (None, None, None)}}


class Streams(with_store.WithStore):
    @staticmethod
    def asked(of=None, repeats=4, noisy=0.01, wrong=(), dimensions=(3,)):
        def fill(maker):
            for name in pair_times.WORK[:2]:
                maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                                 ("metric", name, "pairs", name.replace("_", " "), "1", "invented", "detail", "cheaper", ""))
            maker.sweep("streams", "pairs", pair_query="stage", n="parameter", report=["streams"])
            for dimension in dimensions:
                for scene, methods in (of or SCENES).items():
                    for method, costs in methods.items():
                        for way, ns in zip(pair_times.MARKS, costs):
                            one(maker, dimension, scene, method, way, ns)

        def one(maker, dimension, scene, method, way, ns):
            axes = {"kind": "pairs", "dimension": dimension, "pair_query": method, "precision": "f64", "timed": True,
                    "scene": scene, "stream": way, **({"n": 200} if scene == "pile" else {})}
            for repeat in range(repeats):
                if ns is None:
                    maker.trial("streams", {**axes, "repeat": repeat}, {}, "unsupported", "it remembers nothing of a pair", 0)
                    continue
                bad = (method, scene, way) in wrong
                facts = {"ns_per_query": ns * (1 + noisy * (repeat % 2)), "asked": 100, "wrong": 3.0 * bad, "failed": 0,
                         "refused": 0, "max_error": 1e-15, "support_calls": ns / 10 if method == "gjk_epa" else 0.0,
                         "axis_tests": 15.0 if method == "sat" else 0.0}
                maker.trial("streams", {**axes, "repeat": repeat}, facts, "wrong" if bad else "ok")
        return fill

    def one(self, **about):
        found = self.made(streams, self.asked(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_changed_ranks_have_both_ratios(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "In 3D methods change ranks between drawn pairs and a world's pairs on 1 of 2 "
                         "scenes, beyond the noise.")
        table = made.finding.table.set_index(["comparison", "scene"])
        row = table.loc[("sat over gjk_epa", "pile")]
        self.assertEqual([round(row[c], 2) for c in ("ratio of times, drawn pairs", "ratio of times, pairs of the "
                                                                                    "world")], [2.0, 0.75])
        self.assertEqual(row["outcome"], "rank changes")
        self.assertEqual(table.loc[("all methods", "tower"), "outcome"], "no rank changes beyond the noise")
        self.assertEqual(table.loc[("gjk_epa: no cache over cached data", "1 of 2 scenes"), "ratio of times, pairs of the "
                                                                                            "world"], "1.3")
        self.assertEqual(len(table), 3)
        self.assertEqual(made.headline.text, "On pile in 3D gjk_epa is 2.0 times as fast as sat on drawn pairs, but sat is "
                                             "1.3 times "
                         "as fast on the pairs of the world.")
        self.assertEqual([made.headline.values[m] for m in ("gjk_epa", "sat")], [120.6, 90.45])
        self.assertNotIn("sat", " ".join(made.holes), "a method without cached data is no hole")
        self.assertIn("tower, closed_form, stream=cold: unsupported (it remembers nothing of a pair)", made.holes)
        self.assertEqual([ax.get_xlabel() for ax in made.figure.axes if ax.get_xlabel()],
                         [title for title in ("time per query", "support calls", "axis tests") for _ in range(2)])

    def test_the_planted_bug_an_order_within_the_noise_is_no_rank(self):
        about = {"of": {"pile": {"sat": (105, 90, None), "gjk_epa": (100, 95, 95)}}, "noisy": 0.3}
        found = self.one(**about).finding
        self.assertEqual(found.headline, "In 3D methods change ranks between drawn pairs and a world's pairs on 0 of 1 scene, "
                                         "beyond "
                         "the noise.")
        self.assertEqual(list(found.table["outcome"]), ["no rank changes beyond the noise", "inside the noise"])
        self.assertIsNone(self.one(**about).headline)
        real, noise.tells = noise.tells, lambda a, b, metric, least: True
        try:
            self.assertIn("rank changes", list(self.one(**about).finding.table["outcome"]))
        finally:
            noise.tells = real

    @undrawn.drawn
    def test_a_failing_method_has_a_ring(self):
        rings = lambda made: sum(line.get_markersize() == 11 for ax in made.figure.axes for line in ax.lines)  # noqa: E731
        self.assertEqual(rings(self.one()), 0)
        made = self.one(wrong=(("sat", "pile", "cold"),))
        self.assertIn("rank changes; sat fails", list(made.finding.table["outcome"]))
        self.assertIsNone(made.headline, "the rank of a failing method is no headline")
        self.assertEqual(rings(made), 2, "beside its time and its axis tests")

    def test_a_chart_for_each_dimension_and_none_without_streams(self):
        self.assertEqual([c.id for c in self.made(streams, self.asked(dimensions=(2, 3)))], ["streams_2d", "streams_3d"])
        self.assertEqual(self.made(streams, synthetic_store.queries), [streams.absent])

    def test_one_method_has_no_rank(self):
        made = self.one(of={"pile": {"sat": (105, 90, None)}})
        self.assertEqual(made.finding.headline, "In 3D no scene has two methods with times on drawn pairs and in its world.")
        self.assertTrue(math.isnan(made.table[made.table["stream"] == "warm"]["time per query [s]"].iloc[0]))


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
