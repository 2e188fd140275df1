# SPDX-License-Identifier: Zlib
"""The arithmetic of tests/times on small logs. Run by ctest."""

import importlib.machinery
import importlib.util
import pathlib
import sqlite3
import tempfile
import unittest

_path = str(pathlib.Path(__file__).resolve().parent / "times")
_loader = importlib.machinery.SourceFileLoader("times", _path)
times = importlib.util.module_from_spec(importlib.util.spec_from_loader("times", _loader))
_loader.exec_module(times)

LOG = """# ninja log v5
0\t2000\t1\tCMakeFiles/lpc_algorithms_f64.dir/algorithms/solver/b.cpp.o\t1
0\t5000\t1\tCMakeFiles/lpc_framework_f64.dir/framework/a.cpp.o\t2
2000\t3000\t1\tlib/liblpc_f64.so\t3
"""


class Times(unittest.TestCase):
    def test_jobs_at_one_time_share_it(self):
        table = {folder: (files, seconds) for folder, files, seconds in times.build_table(LOG)}
        # a and b share two seconds, then a runs alone for three. The second build: two of nothing, one of linking.
        self.assertEqual(table, {"framework f64": (1, 4.0), "algorithms f64": (1, 1.0),
                                 "linking and the rest": (1, 1.0)})

    def test_builds_after_one_another(self):
        again = LOG + "0\t500\t1\tCMakeFiles/lpc_algorithms_f64.dir/algorithms/solver/b.cpp.o\t5\n"
        table = {folder: (files, seconds) for folder, files, seconds in times.build_table(again)}
        self.assertEqual(table["algorithms f64"], (1, 0.5))  # its last run, alone
        self.assertEqual(table["framework f64"], (1, 5.0))

    def test_folders(self):
        for output, folder in {
                "tests/CMakeFiles/test_broadphase_f32.dir/conformance/broadphase_test.cpp.o": "tests/conformance f32",
                "tests/CMakeFiles/test_framework_f64.dir/framework/mass_test.cpp.o": "tests/framework f64",
                "experiments/CMakeFiles/lpc-worker-f64.dir/trial/measure/rest.cpp.o": "experiments/trial f64",
                "experiments/CMakeFiles/lpc.dir/lpc/list.cpp.o": "experiments/lpc",
                "oracles/CMakeFiles/lpc_oracles_f64.dir/witnesses/fcl.cpp.o": "oracles f64",
                "lpc/CMakeFiles/lpc_framework_f64.dir/framework/world/world.cpp.o": "framework f64",
                "tests/CMakeFiles/test_known_answers_f32.dir/Unity/unity_0_cxx.cxx.o": "tests/known_answers f32",
                "oracles/CMakeFiles/lpc_oracles_f64.dir/Unity/unity_2_cxx.cxx.o": "oracles f64",
                "experiments/CMakeFiles/lpc.dir/Unity/unity_0_cxx.cxx.o": "experiments/lpc",
                "CMakeFiles/lpc_algorithms_f64.dir/Unity/unity_0_cxx.cxx.o": "algorithms f64",
                "CMakeFiles/lpc_pinned_f64.dir/trace.cpp.o": "tests/determinism f64",
                "CMakeFiles/lpc_framework_f64.dir/cmake_pch.hxx.gch": "precompiled headers"}.items():
            self.assertEqual(times.folder_of(output), folder, output)

    def test_stores(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            self.assertEqual(times.stores(root), [])
            (root / "results").mkdir()
            (root / "results" / "none.db").write_text("no store")
            db = sqlite3.connect(root / "results" / "mine.db")
            db.executescript("CREATE TABLE planned(sweep TEXT, key TEXT);"
                             "CREATE TABLE trial(key TEXT, started TEXT, wall REAL);")
            db.executemany("INSERT INTO planned VALUES (?, ?)", [("a", "1"), ("a", "2"), ("b", "2"), ("b", "3"),
                                                                        ("b", "not run")])
            db.executemany("INSERT INTO trial VALUES (?, ?, ?)", [
                ("1", "2026-01-01T00:00:00Z", 2.0), ("2", "2026-01-01T00:00:01Z", 4.0), ("3", "2026-01-01T00:01:00Z", 1.5)])
            db.commit()
            self.assertEqual(times.store_table(db), ([("a", 2, 6.0), ("b", 2, 5.5)], 61.5, 3, 55.0))
            db.close()
            lines = times.stores(root)
            self.assertIn("### mine.db: 62 s by the clock, 3 trials, longest pause 55 s", lines)
            self.assertIn("| b | 2 | 5.5 |", lines)
            self.assertFalse([line for line in lines if "none.db" in line])

    def test_a_command_is_measured_with_all_that_it_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            busy = "python3 -c 'sum(range(20_000_000))'"
            clock, processor, seen, code = times.took(f"touch page; {busy}; exit 3", root, root / "page")
            self.assertEqual(code, 3)
            self.assertGreater(processor, 0.05)  # of the command's child
            self.assertLess(seen, clock)
            self.assertIsNone(times.took("true", root, root / "absent")[2])

    def test_programs(self):
        junit = ('<testsuite time="9"><testcase name="f64.A.B" time="2"/><testcase name="f64.A.C" time="1.5"/>'
                 '<testcase name="reports" time="4"/></testsuite>')
        table, whole = times.test_table(junit, {"f64.A.B": "test_a_f64", "f64.A.C": "test_a_f64"})
        self.assertEqual((table, whole), ([("reports", 1, 4.0), ("test_a_f64", 2, 3.5)], 9.0))


if __name__ == "__main__":
    unittest.main()
