# SPDX-License-Identifier: Zlib
"""Tests of the distances from a converged reference: for how long it serves, and what is compared. Run by ctest, or
python3 reports/tests/against_reference_test.py."""

import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import ranking  # noqa: E402
import undrawn  # noqa: E402
import with_store  # noqa: E402
from charts import against_reference as of_reference  # noqa: E402
from with_store import row  # noqa: E402

DT, FINE = 0.1, 0.025
SECONDS = 3


def place(time, off):
    """Of a floor and two bodies, of which one is off by `off` and one by half of it."""
    return [[0, 0.0, 0.0, 0.0], [1, time + off, 1.0, 0.0], [2, time + off / 2, 2.0, 0.0]]


class AgainstReference(with_store.WithStore):
    def test_a_method_that_left_rows_to_gauss_seidel_is_not_nearest(self):
        left = lambda maker: (self.scene()(maker), maker.leave_rows(50, where="catto"))  # noqa: E731
        made = self.made(of_reference.against_reference, left)[0]
        self.assertEqual(made.finding.headline, "On chain, 2D only naive has a rank, 30 mm from the reference.")
        self.assertEqual(row(made, "catto")["against the best"], "not ranked: 50 % Gauss-Seidel")
        self.assertIsNone(made.headline)
        with unittest.mock.patch.object(ranking, "excused", lambda *_: {}):
            self.assertIn("catto stays nearest", self.made(of_reference.against_reference, left)[0].finding.headline,
                          "the planted bug was not seen")

    @staticmethod
    def scene(beside=lambda time: 1e-6 * time, half=lambda time: 1e-5 * time, perturbed=True,
              unlike=lambda time: 2e-6 * time, unlike_until=SECONDS):
        """Methods that go 10 mm and 40 mm in a second with 4 iterations, a quarter of it with 16; `beside`, `half` and `unlike`:
        how far the reference's own runs, and that of another solver, are from it over time."""
        def fill(maker):
            maker.sweep("mine", baseline="reference", resolver="label", iterations="setting", perturb="parameter")

            def run(axes, dt, off, work, outcome="ok", until=SECONDS):
                axes = {"kind": "world", "scene": "chain", "dimension": 2, "precision": "f64", "timed": False, **axes}
                key = maker.trial("mine", axes, {"work_multiply_adds": work}, outcome, "", None if outcome == "ok" else 5,
                                  extra={"dt": dt})
                for step in range(0, round(until / dt) + 1):
                    maker.poses(key, step, place(step * dt, off(step * dt)))
            for label, speed in (("catto", 1e-2), ("naive", 4e-2)):
                for iterations in (4, 16):
                    run({"resolver": label, "iterations": iterations}, DT, lambda t, v=speed * 4 / iterations: v * t,
                        10 * iterations)
            run({"resolver": "soft_step", "iterations": 4}, DT, lambda t: t, 40, "exploded", 0.5)
            of = {"resolver": "reference", "iterations": 30}
            run({**of, "dt": FINE, "perturb": 0}, FINE, lambda t: 0.0, 300)
            run({**of, "dt": FINE / 2}, FINE / 2, half, 300)
            if perturbed:
                run({**of, "dt": FINE, "perturb": 1e-9}, FINE, beside, 300)
            if unlike:
                run({**of, "resolver": "reference by xpbd", "dt": FINE, "perturb": 0}, FINE, unlike, 300,
                    "ok" if unlike_until == SECONDS else "exploded", unlike_until)
        return fill

    @undrawn.drawn
    def test_where_the_reference_agrees_with_itself_methods_are_compared_at_equal_cost(self):
        made = self.made(of_reference.against_reference, self.scene())
        self.assertEqual(len(made), 1)
        self.assertIn("The reference agrees with its runs at half the step and 1 nm beside it and with xpbd to 30 µm for all 3 "
                      "s.",
                      made[0].note)
        self.assertEqual(made[0].finding.headline, "On chain, 2D, within 160 multiply-adds per step, catto stays nearest to the "
                         "reference (7.5 mm); naive is 30 mm away, 4.0 times as far.")
        self.assertEqual(made[0].headline.text, made[0].finding.headline)
        self.assertEqual([list(row(made[0], name).values())[1:] for name in ("catto", "naive", "soft_step")],
                         [["7.5 mm", "best", "30 mm"], ["30 mm", "4.0 times", "120 mm"], ["", "ended before: exploded", ""]])
        first = made[0].table.iloc[0]
        self.assertEqual((first["method"], first["iterations"]), ("catto", 4))
        self.assertAlmostEqual(first["largest distance of a body from the reference [m]"], 0.03)
        self.assertAlmostEqual(first["median over bodies [m]"], 0.0225, msg="of the two that move: the floor is no body of them")

    def test_several_steps_are_compared_by_the_work_of_a_second(self):
        def fill(maker):
            maker.sweep("mine", baseline="reference", resolver="label", perturb="parameter")

            def run(axes, dt, off, work):
                axes = {"kind": "world", "scene": "chain", "dimension": 2, "precision": "f64", "timed": False, "dt": dt, **axes}
                key = maker.trial("mine", axes, {"work_multiply_adds": work}, extra={"dt": dt})
                for step in range(0, round(SECONDS / dt) + 1):
                    maker.poses(key, step, place(step * dt, off * step * dt))
            for part in (1, 2):  # half the step, half the error
                run({"resolver": "catto"}, DT / part, 2e-2 / part, 40)
                run({"resolver": "naive"}, DT / part, 4e-2 / part, 20)
            for axes in ({"perturb": 0}, {"perturb": 1e-9}):
                run({"resolver": "reference", **axes}, FINE, 0, 300)
            run({"resolver": "reference by xpbd", "perturb": 0}, FINE, 0, 300)
            run({"resolver": "reference"}, FINE / 2, 0, 300)
        chart = self.made(of_reference.against_reference, fill)[0]
        self.assertEqual(chart.finding.headline, "On chain, 2D, within 800 multiply-adds per second of the scene, catto stays "
                         "nearest to the reference (30 mm); naive is 60 mm away, 2.0 times as far.")
        self.assertEqual([row(chart, name)["within 400 multiply-adds per second of the scene"] for name in ("catto", "naive")],
                         ["60 mm", "60 mm"])
        self.assertIn("at dt=0.1", chart.note)
        with unittest.mock.patch.object(of_reference, "several_steps", lambda cells: False):
            bug = self.made(of_reference.against_reference, fill)[0]
        self.assertNotEqual(bug.finding.text(), chart.finding.text(), "the planted bug, the work of a step, was not seen")

    def test_nothing_is_compared_after_the_step_in_which_its_own_runs_part(self):
        parts = lambda time: 1e-6 if time < 1.49 else 1e-2  # noqa: E731
        for runs in ({"beside": parts}, {"half": parts}):
            made = self.made(of_reference.against_reference, self.scene(**runs))[0]
            self.assertIn("part at 1.5 s (10 mm apart); later distances are not compared.", made.note)
            self.assertIn("On chain, 2D until 1.5 s, within 160", made.finding.headline)
            self.assertAlmostEqual(made.table["largest distance of a body from the reference [m]"].max(), 4e-2 * 1.4)
            with unittest.mock.patch.object(of_reference.Runs, "serves", lambda self, time: True):
                bug = self.made(of_reference.against_reference, self.scene(**runs))[0]
            self.assertGreater(bug.table["largest distance of a body from the reference [m]"].max(), 0.1,
                               "the planted bug, that all is compared, was not seen")

    def test_nothing_is_compared_after_the_step_in_which_an_unlike_solver_parts(self):
        """Its own runs agree all the time: one family alone does not see what it does to all of them."""
        parts = self.scene(unlike=lambda time: 1e-6 if time < 1.49 else 1e-2)
        made = self.made(of_reference.against_reference, parts)[0]
        self.assertIn("The reference and xpbd, as converged, part at 1.5 s (10 mm apart)", made.note)
        self.assertAlmostEqual(made.table["largest distance of a body from the reference [m]"].max(), 4e-2 * 1.4)
        self.assertNotIn("reference by xpbd", set(made.table["method"]), "it is no method that is ranked")

    def test_an_unlike_solver_that_falls_has_parted(self):
        made = self.made(of_reference.against_reference, self.scene(unlike=lambda time: 0.0, unlike_until=1.95))[0]
        self.assertIn("The reference and xpbd, as converged, part at 1.97 s (one has ended)", made.note)

    def test_one_family_alone_is_no_reference(self):
        self.assertEqual(self.made(of_reference.against_reference, self.scene(unlike=None)),
                         [of_reference.against_reference.absent])

    def test_a_reference_that_never_converged_compares_nothing(self):
        made = self.made(of_reference.against_reference, self.scene(half=lambda t: 1e-2))[0]
        self.assertEqual(made.finding.headline, "On chain, 2D no method is ranked: the reference and its own runs part at 25 ms.")
        self.assertIsNone(made.headline)

    def test_methods_nearer_to_one_another_than_the_reference_is_to_itself_are_not_told_apart(self):
        self.assertEqual(of_reference.nearest({"a": 3e-3, "b": 3.1e-3, "c": 5e-3}, 1e-4), (["a", "b"], 3e-3, ["c"], 5e-3))
        self.assertEqual(of_reference.nearest({"a": 3e-3, "b": 3.1e-3, "c": 5e-3}, 1e-5), (["a"], 3e-3, ["c"], 5e-3))
        self.assertEqual(of_reference.nearest({"a": 3e-3, "b": 5e-3, "c": 5.1e-3}, 1e-4)[2], ["b", "c"], "not c alone")

    def test_a_baseline_without_its_own_runs_is_no_reference(self):
        self.assertEqual(self.made(of_reference.against_reference, self.scene(perturbed=False)),
                         [of_reference.against_reference.absent])


if __name__ == "__main__":
    unittest.main()
