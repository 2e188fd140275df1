# SPDX-License-Identifier: Zlib
"""The arithmetic of tests/times on small logs. Run by ctest."""

import importlib.machinery
import importlib.util
import pathlib
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
                "experiments/CMakeFiles/lpc-worker-f64.dir/trial/worker_main.cpp.o": "experiments/trial f64",
                "experiments/CMakeFiles/lpc.dir/lpc/list.cpp.o": "experiments/lpc",
                "oracles/CMakeFiles/lpc_oracles_f64.dir/fcl.cpp.o": "oracles f64",
                "lpc/CMakeFiles/lpc_framework_f64.dir/framework/world.cpp.o": "framework f64",
                "tests/CMakeFiles/test_known_answers_f32.dir/Unity/unity_0_cxx.cxx.o": "tests/known_answers f32",
                "oracles/CMakeFiles/lpc_oracles_f64.dir/Unity/unity_2_cxx.cxx.o": "oracles f64",
                "experiments/CMakeFiles/lpc.dir/Unity/unity_0_cxx.cxx.o": "experiments/lpc",
                "CMakeFiles/lpc_algorithms_f64.dir/Unity/unity_0_cxx.cxx.o": "algorithms f64",
                "CMakeFiles/lpc_pinned_f64.dir/trace.cpp.o": "tests/determinism f64",
                "CMakeFiles/lpc_framework_f64.dir/cmake_pch.hxx.gch": "precompiled headers"}.items():
            self.assertEqual(times.folder_of(output), folder, output)

    def test_programs(self):
        junit = ('<testsuite time="9"><testcase name="f64.A.B" time="2"/><testcase name="f64.A.C" time="1.5"/>'
                 '<testcase name="reports" time="4"/></testsuite>')
        table, whole = times.test_table(junit, {"f64.A.B": "test_a_f64", "f64.A.C": "test_a_f64"})
        self.assertEqual((table, whole), ([("reports", 1, 4.0), ("test_a_f64", 2, 3.5)], 9.0))


if __name__ == "__main__":
    unittest.main()
