# SPDX-License-Identifier: Zlib
"""Tests of the page of known answers: it equals its data, and measured errors outside their intervals correct the data. Run by
ctest, or python3 reports/tests/known_answers_test.py."""

import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import known_answers  # noqa: E402

LINES = """\
# Statics

[box]
formula: x = 0
setup: 5 s
place, m | a | 0 | 0.02 | 0.015 .. 0.025 | -
load, N | a | 2 | 2 | -1e-13 .. 1e-13 | -1e-05 .. 1e-05
load, N | split_solver{velocity=b} | 2 | 3 | 0.4 .. 0.6 | -""".splitlines()


class KnownAnswers(unittest.TestCase):
    def test_the_page_equals_its_data(self):
        page = known_answers.PAGE.read_text(encoding="utf-8")
        data = known_answers.DATA.read_text(encoding="utf-8").splitlines()
        self.assertEqual(known_answers.MARKS.search(page)[0], known_answers.block(known_answers.problems_of(data)),
                         "run reports/known_answers.py")

    def test_a_problem_shows_the_largest_error_of_each_method(self):
        text = known_answers.block(known_answers.problems_of(LINES))
        self.assertIn("| box | x = 0 | 5 s | To 10 %: `a` 0.02. Worse in *load, N*: `b` 50 % |", text)
        self.assertIn("1 problems have 2 figures, which are measured 3 times by 2 methods", text)

    def test_errors_outside_their_intervals_correct_the_data(self):
        measured = ["f64 | box | place, m | a | 0 | 0.021 | 0.021",  # inside
                    "f64 | box | load, N | a | 2 | 2.2 | 0.1",
                    "f32 | box | load, N | a | 2 | 2.2 | 0.1",
                    "f64 | box | load, N | c | 2 | 2 | 0",  # new
                    "[ RUN      ] KnownAnswer.box"]
        lines, changed = known_answers.corrected(LINES, measured)
        self.assertEqual(changed, 3)
        self.assertEqual(lines[:6], LINES[:6])
        self.assertEqual(lines[6], "load, N | a | 2 | 2.2 | 0.075 .. 0.12 | 0.05 .. 0.15")
        self.assertEqual(lines[8:], ["load, N | c | 2 | 2 | -1e-13 .. 1e-13 | -"])

    def test_unknown_problems_and_torn_rows_are_refused(self):
        with self.assertRaisesRegex(ValueError, r"no problem \[ball\]"):
            known_answers.corrected(LINES, ["f64 | ball | load, N | a | 2 | 2 | 0"])
        with self.assertRaisesRegex(ValueError, "line 9: 2 cells"):
            known_answers.problems_of([*LINES, "load, N | a"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
