# SPDX-License-Identifier: Zlib
"""Tests of imported benchmarks in a report: alone in a store, damaged, on a medium that cannot be written."""

import json
import sqlite3
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import benchmarks  # noqa: E402
import make  # noqa: E402
import synthetic_store  # noqa: E402
from chart import Context  # noqa: E402
from load import Store  # noqa: E402

GOOD = {"name": "broadphase/2D/naive/64", "cpu_time": 1.5, "real_time": 2}


class Benchmarks(unittest.TestCase):
    def test_only_what_can_be_drawn_is_taken(self):
        bad = [None, 5, "x", [], {}, {**GOOD, "name": 7}, {**GOOD, "name": ["a"]}, {**GOOD, "cpu_time": None},
               {**GOOD, "cpu_time": "1.5"}, {**GOOD, "real_time": -1}, {**GOOD, "real_time": True}, {**GOOD, "time_unit": "min"},
               {**GOOD, "run_name": 3}, {"name": "x", "cpu_time": 1}, {**GOOD, "name": "x" * 301}]
        for entry in bad:
            found = benchmarks.read("today", json.dumps({"benchmarks": [GOOD, entry]}))
            self.assertEqual(found["benchmarks"], [GOOD], entry)
            self.assertEqual(found["faults"], ["1 of 2 entries imported at today are no benchmarks; the first is number 1."])
        good = [GOOD, {"name": "x", "error_occurred": True}, {"name": "x", "run_type": "aggregate", "aggregate_name": "BigO"}]
        self.assertEqual(benchmarks.read("today", json.dumps({"context": {"load_avg": ["x"]}, "benchmarks": good})),
                         {"context": {}, "benchmarks": good, "faults": []})
        for text in ("", "[", "3", "[]", "{}", '{"benchmarks": 3}', "[" * 100000):
            found = benchmarks.read("today", text)
            self.assertEqual((found["benchmarks"], len(found["faults"])), ([], 1), text[:20])

    def test_a_store_of_benchmarks_alone_is_drawn(self):
        """Without a metric, with a name that SQLite reads in its own way, and with a folder where SQLite's -wal file would be:
        that is like a medium that cannot be written, for root too."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a?b#c%d.db"
            synthetic_store.write(path, themes=())
            with sqlite3.connect(path) as db:
                db.execute("DELETE FROM metrics")
                for entries in ([], [5, {"name": 7}], [GOOD, None]):
                    text = json.dumps({"benchmarks": entries})
                    db.execute("INSERT INTO benchmark(imported, data) VALUES ('today', ?)", (text,))
            db.close()
            with sqlite3.connect(path) as db:
                db.execute("PRAGMA journal_mode=WAL")
            db.close()
            Path(f"{path}-wal").mkdir()
            made = {chart.title: chart for chart in make.all_charts(Context(Store(path)))}
            self.assertIn("2 of 2 entries imported at today are no benchmarks; the first is number 0.",
                          made["Micro-benchmark: broadphase 2D"].holes)


if __name__ == "__main__":
    unittest.main()
