# SPDX-License-Identifier: Zlib
"""Judges all claims again and compares docs/claims.md; a wrong verdict is found. Run by ctest, or
python3 reports/tests/claims_test.py build/test/bin/lpc [CLASS]: OneClaim, or ShippedClaims (slower)."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent)]

import claims  # noqa: E402

LPC = ""  # the program, from the command line
CLAIM = """[[claim]]
title = "A box"
statement = "It falls."
source = "lpc2009, somewhere"
runs.one = 'single_box --steps 2'
runs.two = 'single_box --steps 4'
says = "one.max_speed < two.max_speed"
verdict = "confirmed"
because = "Of gravity."
"""


class ShippedClaims(unittest.TestCase):
    def test_verdicts_and_page_are_what_is_measured(self):
        judged = claims.judge(claims.read(), LPC)
        for j in judged:
            self.assertEqual(j.verdict, j.claim["verdict"],
                             f"{j.claim['title']}: { {name: one.result['metrics'] for name, one in j.runs.items()} }")
        self.assertGreaterEqual(len(judged), 20)
        page = claims.ROOT / "docs" / "claims.md"
        self.assertEqual(claims.between_marks(page)[1], claims.page(judged, claims.units(LPC)),
                         "regenerate it: reports/claims.py --into docs/claims.md")


class OneClaim(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.file, self.page = Path(scratch.name) / "claims.toml", Path(scratch.name) / "claims.md"
        self.page.write_text(f"before\n{claims.BEGIN}\n{claims.END}\nafter\n", encoding="utf-8")

    def told(self, text, *arguments):
        """(exit code, printed text)."""
        self.file.write_text(text, encoding="utf-8")
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            code = claims.main(["--lpc", LPC, "--claims", str(self.file), *arguments])
        return code, out.getvalue()

    def judged(self, text):
        self.file.write_text(text, encoding="utf-8")
        return claims.judge(claims.read(self.file), LPC)[0].verdict

    def test_the_page_has_values_with_units_and_failures(self):
        fell = CLAIM.replace("single_box --steps 4", "vertical_stack --param n=40 --steps 600").replace("two.max", "2 + two.max")
        self.assertEqual(self.told(fell, "--into", str(self.page)), (0, ""))
        page = self.page.read_text(encoding="utf-8")
        self.assertTrue(page.startswith("before\n<!-- claims -->\n1 claims: 1 confirmed, 0 refuted"), page)
        self.assertTrue(page.endswith("**Confirmed.** Of gravity.\n<!-- end -->\nafter\n"), page)
        self.assertIn("| one | `lpc run single_box --steps 2` | ok, max_speed 0.3333 m/s |", page)
        self.assertIn("| collapsed at step ", page)

    def test_a_wrong_verdict_fails_and_keeps_the_page(self):
        for verdict in ("refuted", "depends"):
            before = self.page.read_text(encoding="utf-8")
            code, told = self.told(CLAIM.replace('"confirmed"', f'"{verdict}"'), "--into", str(self.page))
            self.assertEqual(code, 1)
            self.assertIn(f"A box: confirmed, but written as {verdict}", told)
            self.assertEqual(self.page.read_text(encoding="utf-8"), before)

    def test_different_results_make_depends(self):
        refuted = CLAIM.replace("one.max_speed <", "one.max_speed >")
        self.assertEqual(self.judged(CLAIM), "confirmed")
        self.assertEqual(self.judged(refuted), "refuted")
        self.assertEqual(self.judged(CLAIM + 'differs = "two.outcome == \'ok\'"\n'), "confirmed")
        self.assertEqual(self.judged(CLAIM + 'differs = "two.outcome != \'ok\'"\n'), "depends")
        self.assertEqual(self.judged(refuted + 'differs = "two.outcome == \'ok\'"\n'), "depends")
        self.assertEqual(self.judged(refuted + 'differs = "two.outcome != \'ok\'"\n'), "refuted")

    def test_a_series_has_an_end_and_a_largest_value_after_a_step(self):
        one = claims.Run("", {"series": {"max_speed": [9, 1, 3, 2], "depth": [1, None, 2]},
                              "metrics": {"last_of_all": 7, "max_speed": 9}})
        self.assertEqual([one.last_max_speed, one.after_0_max_speed, one.after_1_max_speed, one.after_3_max_speed], [2, 9, 3, 2])
        self.assertEqual([one.max_speed, one.last_of_all], [9, 7])
        self.assertEqual((one.last_depth, one.after_2_depth), (2, 2))
        for name in ("after_1_depth", "after_4_max_speed", "after_max_speed", "last_height"):
            with self.assertRaises(claims.UserError):
                one.value(name)
        after = CLAIM.replace("one.max_speed <", "one.after_1_max_speed <")
        self.assertEqual(self.told(after, "--into", str(self.page)), (0, ""))
        self.assertIn("| ok, after_1_max_speed 0.3333 m/s |", self.page.read_text(encoding="utf-8"))

    def test_mistakes_are_one_line_and_write_nothing(self):
        for wrong, right, telling in (
                ("lpc2009", "nobody2009", "has no nobody2009"), ("says", "sayz", "lacks says"),
                ("because", "colour = 'red'\nbecause", "has no key colour"), ('"confirmed"', '"perhaps"', "verdict perhaps"),
                ("single_box", "double_box", "double_box"), ("two.max_speed", "two.max_speeds", "has no max_speeds"),
                ("two.max_speed", "two.max_speed.fast", "no attribute 'fast'"),
                ("two.max_speed", "three.max_speed", "name 'three' is not defined"),
                ("two.max_speed", "two.joint_error_max", "has no joint_error_max"),
                ("one.max_speed <", "open('x') and one.max_speed <", "name 'open' is not defined"),
                ("[[claim]]", "[[claim]", "line 1"), ("[[claim]]", "[claim]", "valid: [[claim]]"),
                ("--steps 2", "--pipeline \"solver=tgs", "runs.one: single_box --pipeline \"solver=tgs: no closing quotation"),
                ("runs.two = 'single_box --steps 4'", "runs.two = 4", "valid: a table of commands"),
                ("runs.one = 'single_box --steps 2'\nruns.two = 'single_box --steps 4'", "runs = 'single_box'",
                 "runs is single_box"),
                ('"lpc2009, somewhere"', "2009", "source is 2009; valid: text")):
            code, told = self.told(CLAIM.replace(wrong, right), "--into", str(self.page))
            self.assertEqual((code, told.count("\n")), (2, 1), told)
            self.assertIn(telling, told)
            self.assertEqual(sorted(p.name for p in self.page.parent.iterdir()), ["claims.md", "claims.toml"])
        self.assertIn("valid: A box", self.told(CLAIM, "--only", "A ball")[1])
        self.page.write_text("no marks\n", encoding="utf-8")
        self.assertIn("0 places between", self.told(CLAIM, "--into", str(self.page))[1])


if __name__ == "__main__":
    LPC = sys.argv.pop(1)
    unittest.main()
