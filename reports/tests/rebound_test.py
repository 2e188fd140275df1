# SPDX-License-Identifier: Zlib
"""Tests of what is thrown back after a fall: heights that are known. Run by ctest, or
python3 reports/tests/rebound_test.py [PICTURE.png]."""

import math
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import synthetic_store  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import contacts  # noqa: E402
from charts.contacts import rebound  # noqa: E402
from with_store import row  # noqa: E402


def track(fall, back):
    """Heights of a body that falls from 1 + fall, sinks a little, rises by `back` above its place of rest and comes back."""
    return [1 + fall, 1 + fall / 2, 0.9, 1 + back, 1 + back / 2, 1, 1]


class Rebound(with_store.WithStore):
    @staticmethod
    def drops(back=None, report=("rebound",), deeper=None):
        def fill(maker):
            maker.db.execute("INSERT INTO metrics VALUES (?,?,?,?,?,?,?,?,?)",
                             ("metric", "gravity", "world", "gravity", "m/s^2", "invented", "detail", "", ""))
            maker.sweep("heritage_springs", "world", resolver="label", height="parameter", report=list(report))
            for method, shares in (back or {"springy": (0, 0.1), "calm": (0, 0), "other": (0, 0)}).items():
                for height, share in zip((2.25, 21), shares):
                    fell = share is None
                    maker.trial("heritage_springs", {"kind": "world", "scene": "box_drop", "dimension": 2, "height": height,
                                                     "resolver": method, "precision": "f64", "timed": False, "repeat": 0},
                                {"gravity": 10.0}, *(("exploded", "speed", 5) if fell else ("ok",)),
                                series={} if fell else {"height": [
                                    h - (deeper or {}).get(method, 0) * (place > 0) for place, h in
                                    enumerate(track(height - 1, share * (height - 1)))]})
        return fill

    def one(self, **about):
        found = self.made(rebound, self.drops(**about))
        self.assertEqual(len(found), 1)
        return found[0]

    @undrawn.drawn
    def test_known_rebounds(self):
        made = self.one()
        if PICTURE:
            made.figure.savefig(PICTURE)
        self.assertEqual(made.finding.headline, "In 2D springy throws a body without restitution back by up to 2 m at 20 m/s; "
                                                "calm "
                                                "and other do not.")
        self.assertEqual(made.headline.text, made.finding.headline)
        found = row(made, "springy")
        self.assertEqual((found["rebound, at most"], found["bounces from"], found["tried up to"]), ("2 m", "20 m/s", "20 m/s"))
        self.assertEqual(row(made, "calm")["rebound, at most"], "0 m")
        self.assertEqual(made.headline.values, {"calm": 0.0, "other": 0.0, "springy": 2.0})
        rows = made.table[made.table["method"] == "springy"]
        self.assertAlmostEqual(rows["share of the energy [1]"].iloc[1], 0.1)
        self.assertAlmostEqual(rows["speed [m/s]"].iloc[0], 5.0)

    def test_the_planted_bug_the_fall_itself_is_no_rebound(self):
        self.assertEqual(contacts.thrown([10, 5, 0.9, 1, 1]), (9.0, 0.0))
        self.assertGreater(max([10, 5, 0.9, 1, 1]) - 1, 0, "as the highest place of the whole run would have it")

    def test_no_line_where_no_speed_was_tried(self):
        xs, ys = contacts.joined([(20.0, 1.0), (20.5, 2.0), (40.0, 3.0), (40.4, 4.0)])
        self.assertEqual((xs[:2], xs[3:], ys[3:]), ([20.0, 20.5], [40.0, 40.4], [3.0, 4.0]))
        self.assertTrue(math.isnan(xs[2]) and math.isnan(ys[2]))

    def test_who_failed_has_no_number(self):
        made = self.one(back={"springy": (0, None), "calm": (0, 0.2)})
        self.assertEqual(made.finding.headline, "In 2D calm throws a body without restitution back by up to 4 m at 20 m/s; "
                                                "springy "
                                                "does not.")
        self.assertEqual(row(made, "springy")["tried up to"], "5 m/s", "it failed at 20 m/s")
        self.assertTrue(math.isnan(made.table[made.table["method"] == "springy"]["rebound [m]"].iloc[1]))
        self.assertIn("exploded", " ".join(made.holes))

    def test_who_sinks_is_told(self):
        made = self.one(deeper={"other": 0.3})
        self.assertEqual(row(made, "other")["left deeper than by others"], "300 mm")
        self.assertAlmostEqual(made.table["speed [m/s]"].max(), 20.0, msg="the planted bug: who sinks fell faster")

    def test_only_where_a_sweep_asks(self):
        self.assertEqual(self.made(rebound, synthetic_store.resolvers), [rebound.absent])


PICTURE = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1].endswith(".png") else None

if __name__ == "__main__":
    unittest.main()
