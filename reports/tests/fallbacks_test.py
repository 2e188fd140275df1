# SPDX-License-Identifier: Zlib
"""Each chart of worlds and frozen problems in which a method may come first: what left its rows to Gauss-Seidel has no rank
there, and its share stands beside its name. A chart that is new must be added here. Run by ctest, or python3
reports/tests/fallbacks_test.py."""

import re
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import against_reference_test as of_reference  # noqa: E402
import bodies_at_rate_test as of_rates  # noqa: E402
import breaking_points_test as of_points  # noqa: E402
import cache_solver_test as of_caches  # noqa: E402
import chart  # noqa: E402
import falls_test as of_falls  # noqa: E402
import held_test as of_held  # noqa: E402
import momenta_test as of_momenta  # noqa: E402
import over_time_test as of_time  # noqa: E402
import problems_test as of_problems  # noqa: E402
import ranking  # noqa: E402
import ranking_test as of_ranking  # noqa: E402
import rebound_test as of_rebound  # noqa: E402
import stability_test as of_stability  # noqa: E402
import synthetic_store  # noqa: E402
import with_store  # noqa: E402

LIMIT = 1000 / 60  # ms


def energies(maker):
    maker.sweep("mine", "world", resolver="label")
    for label, gain in (("catto", 0.1), ("naive", 0.5)):
        axes = {"kind": "world", "scene": "fall", "dimension": 2, "resolver": label, "timed": False, "repeat": 0}
        maker.trial("mine", axes, {}, series={"kinetic": [0.0, 100.0, 100 * gain], "potential": [100.0, 0.0, 100.0]})


def fallen(maker):
    maker.sweep("mine", resolver="label", report=["falls"])
    axes = {"kind": "world", "scene": "tower", "dimension": 2, "resolver": "naive", "timed": False, "repeat": 0}
    maker.trial("mine", axes, {}, "collapsed", "far away", 90, {"kinetic": [1.0] * 90, "potential": [1.0] * 90,
                                                               "max_penetration": [0.1] * 90, "penetration_poses": [0.1] * 90})
    maker.film(maker.db.execute("SELECT key FROM trial").fetchone()[0], of_falls.film([0, 50, 70, 85, 90]))


def breaking(maker):
    about = {"parameter": "n", "falling": False, "seeds": 5, "perturb": 1e-3, "ratio": 1.05, "limit": ""}
    maker.sweep("mine", resolver="label", question="run", n="parameter", report=["breaking_map"], **{"break": {"tower": about}})
    for method, stands in (("catto", 2), ("naive", 4), ("soft_step", 8)):
        for n in (1, 2, 4, 8):
            axes = {"kind": "world", "precision": "f64", "scene": "stack", "dimension": 2, "question": "tower",
                    "resolver": method, "n": n, "timed": False, "repeat": 0}
            for seed in range(1, 6):
                maker.trial("mine", {**axes, "seed": seed}, {"work_multiply_adds": 9.0}, "ok" if n <= stands else "collapsed")


def slow(maker):
    maker.sweep("mine", resolver="label")
    for label, worst in (("catto", 2.0), ("naive", 9.0), ("soft_step", 4.0)):
        axes = {"kind": "world", "precision": "f64", "scene": "stack", "dimension": 2, "resolver": label, "timed": True}
        for repeat in range(5):
            ms = 1 + 0.01 * repeat
            maker.trial("mine", {**axes, "repeat": repeat}, {"ms_per_step_median": ms, "ms_per_step_p99": 1.5 * ms,
                                                             "ms_per_step_worst": worst * ms})


def ranked(**about):
    return of_ranking.WithoutRank.sweep(fallbacks=0.0, precision="f64", **about)


# Chart: (store, method that its finding names first, or last, where nothing is left to Gauss-Seidel).
FIRST = {"against_reference": (of_reference.AgainstReference.scene(), "catto"),
         "bodies_at_rate": (of_rates.BodiesAtRate.ladders(of={"a": {100: LIMIT / 4, 1000: 2.5 * LIMIT},
                                                              "b": {100: LIMIT / 8, 1000: 1.25 * LIMIT}}), "b"),
         "breaking_map": (breaking, "soft_step"),
         "breaking_points": (synthetic_store.breaking, "soft_step"),
         "budgets": (ranked(), "box2d"),
         "cache_solver": (of_caches.CacheSolver.towers(), "soft_step with recycling"),
         "cost_against_error": (ranked(), "box2d"),
         "energy": (energies, "naive"),
         "ensembles": (ranked(), "box2d"),
         "equal_cost": (ranked(about=of_ranking.WithoutRank.CALIBRATED), "box2d"),
         "held": (of_held.Held().fill(), "newton"),
         "momenta": (of_momenta.Momenta.free(), "soft_step"),
         "over_time": (of_time.OverTime.piles(), "catto+ngs"),
         "problems": (of_problems.invented, "nncg"),
         "rebound": (of_rebound.Rebound.drops(), "springy"),
         "residual": (synthetic_store.resolvers, "soft_step"),
         "stability": (of_stability.Stability.presets(), "soft_step"),
         "steadiness": (synthetic_store.resolvers, "soft_step"),
         "step_times": (slow, "naive")}
# No method comes first in these, or methods of a stage other than the solver, whose rows are the same for all.
NONE_FIRST = {"contact_rules": "contact generators under one solver", "falls": "the share stands beside the name, see below",
              "precision": "a method beside itself", "script_profile": "policies of rest under one solver",
              "sleeping": "policies of rest under one solver", "sleeping_contacts": "policies of rest under one solver",
              "stages": "stages of one method", "tunnelling_map": "continuous detectors under one solver",
              "unneeded": "a method beside itself"}
KINDS = ("world", "problems")
OUT = "not ranked"  # in the table's row of a method without a rank


def left(method):
    """Stands for share_of_fallbacks: all cells of a method left four of five rows."""
    return lambda context, cell: 0.8 if method.split(" with ")[0] in str(cell["method"]) else 0.0


class Fallbacks(with_store.WithStore):
    def test_each_chart_of_worlds_is_here(self):
        charts = {kind.name for kind in chart.kinds() if kind.needs and kind.needs.kind in KINDS}
        self.assertEqual(charts, set(FIRST) | set(NONE_FIRST))
        self.assertFalse(set(FIRST) & set(NONE_FIRST))

    def told(self, name, fill):
        """(what names methods that have a rank, what names those that have none) of all charts of a file."""
        found = self.made(next(kind for kind in chart.kinds() if kind.name == name), fill)
        heads = [made.headline for made in found if made.headline]
        rows = ["; ".join(map(str, row.values())) for made in found for row in made.finding.rows()]
        said = [made.finding.headline for made in found] + [head.text for head in heads]
        said += [method for head in heads for method, value in head.values.items() if value == value]
        return said + [row for row in rows if OUT not in row], [row for row in rows if OUT in row]

    def test_what_left_rows_to_gauss_seidel_has_no_rank(self):
        for name, (fill, first) in FIRST.items():
            with self.subTest(name):
                whole = re.compile(rf"(?<![\w+]){re.escape(first)}(?![\w+])")
                named = lambda texts, whole=whole: any(map(whole.search, texts))  # noqa: E731
                self.assertTrue(named(self.told(name, fill)[0]), "it is not named where it has a rank")
                with unittest.mock.patch.object(ranking, "share_of_fallbacks", left(first)):
                    said, out = self.told(name, fill)
                    self.assertFalse(named(said), said)
                    self.assertTrue(named(out) and all("80 % Gauss-Seidel" in part for part in out), out)
                    # The planted bug, that a number is a rank, is seen.
                    with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
                        self.assertTrue(named(self.told(name, fill)[0]), "the planted bug was not seen")

    def test_a_fall_has_the_share_beside_the_name(self):
        with unittest.mock.patch.object(ranking, "share_of_fallbacks", left("naive")):
            said, _ = self.told("falls", fallen)
        self.assertIn("tower, 2D, naive (80 % Gauss-Seidel); collapsed; 90; ", said[-1])
        self.assertIn("tower, 2D, naive; collapsed; 90; ", self.told("falls", fallen)[0][-1])


if __name__ == "__main__":
    unittest.main()
