# SPDX-License-Identifier: Zlib
"""The arithmetic of tests/times on a small log. Run by ctest."""

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
0\t5000\t1\tCMakeFiles/lpc_algorithms_f64.dir/algorithms/cache/a.cpp.o\t2
2000\t3000\t1\tlib/liblpc_f64.so\t3
500\t1000\t1\tCMakeFiles/lpc_algorithms_f64.dir/algorithms/solver/b.cpp.o\t5
"""


class Times(unittest.TestCase):
    def test_the_last_time_counts(self):
        self.assertEqual(times.build_table(LOG), [("algorithms f64", 2, 5.5), ("linking and the rest", 1, 1.0)])

    def test_folders(self):
        for output, folder in {
                "tests/CMakeFiles/test_broadphase_f32.dir/conformance/broadphase_test.cpp.o": "tests/conformance f32",
                "experiments/CMakeFiles/lpc-worker-f64.dir/trial/measure/rest.cpp.o": "experiments/trial f64",
                "CMakeFiles/lpc_framework_f64.dir/framework/world/world.cpp.o": "framework f64",
                "tests/CMakeFiles/test_known_answers_f32.dir/Unity/unity_0_cxx.cxx.o": "tests/known_answers f32",
                "oracles/CMakeFiles/lpc_oracles_f64.dir/Unity/unity_2_cxx.cxx.o": "oracles f64",
                "CMakeFiles/lpc_framework_f64.dir/cmake_pch.hxx.gch": "precompiled headers"}.items():
            self.assertEqual(times.folder_of(output), folder, output)


if __name__ == "__main__":
    unittest.main()
