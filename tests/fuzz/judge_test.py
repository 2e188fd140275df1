# SPDX-License-Identifier: Zlib
"""Checks that judge.py rejects programs that break its rules. Run by ctest."""

import os
import random
import sqlite3
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent)]

import judge  # noqa: E402
import mutate  # noqa: E402
import mutations  # noqa: E402

LIMITS = judge.Limits(cpu=1, wall=300, memory=512 << 20, grace=0.5)


class Judge(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        judge.adopt_orphans()

    def fault(self, script, limits=LIMITS, may_write=(), may_change=()):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "input").write_text("x")
            return judge.fault(judge.run(["bash", "-c", script], folder, limits), limits, may_write, may_change)

    def test_what_is_owed_is_no_fault(self):
        self.assertEqual(self.fault("echo fine"), "")
        self.assertEqual(self.fault("echo it fell; exit 1"), "")
        self.assertEqual(self.fault("echo 'lpc: input:1: what is wrong' >&2; exit 2"), "")
        self.assertEqual(self.fault("echo fine; echo 'lpc: sweep x: a note' >&2"), "")
        self.assertEqual(self.fault("echo x > out; mkdir many; echo x > many/1", may_write=("out", "many/")), "")
        self.assertEqual(self.fault("echo y > input", may_change=("input",)), "")

    def test_each_fault_is_named(self):
        planted = {
            "signal 11": "kill -SEGV $$",
            "signal 6": "kill -ABRT $$",
            "exit code 139": "exit 139",
            "exit code 3": "exit 3",
            "2 lines": "printf 'lpc: one\\ntwo\\n' >&2; exit 2",
            "0 lines": "exit 2",
            "does not begin": "echo 'terminate called' >&2; exit 2",
            "a message of": "printf 'lpc: %03000d\\n' 7 >&2; exit 2",
            "control characters": "printf 'lpc: \\033[31m\\n' >&2; exit 2",
            "no text": "printf 'lpc: \\377\\n' >&2; exit 2",
            "an unexpected end": "echo told; echo 'lpc: std::bad_alloc' >&2; exit 1",
            "no word why": "exit 1",
            "a trial crashed": "printf 'x\\nout.db: 4 run, 1 not ok (1 crash)\\n'",
            "left out.partial": "echo x > out.partial",
            "left out behind": "echo x > out; echo 'lpc: refused' >&2; exit 2",
            "input has changed": "echo y > input",
            "input is gone": "rm input",
            "of processor time": "while :; do :; done",
            "left a process running": "sleep 60 & disown",
        }
        for name, script in planted.items():
            with self.subTest(name):
                self.assertIn(name, self.fault(script, may_write=("out",)))
        self.assertIn("still ran", self.fault("sleep 60", judge.Limits(wall=1)))
        self.assertIn("left a process running", self.fault("setsid sleep 60 &"))
        hungry = f"'{sys.executable}' -c 'x = bytes(200 << 20).swapcase(); print(len(x))'"
        self.assertIn("MiB", self.fault(hungry, judge.Limits(memory=100 << 20, grace=0.5, address_space=False)))
        self.assertIn("exit code 1", self.fault(hungry, judge.Limits(memory=100 << 20, grace=0.5)))

    def test_damage_is_the_same_for_the_same_seed(self):
        data = b'[a]\nb = [1, 2, { c = "d + 1" }]\n' * 3
        for kind in mutate.KINDS.values():
            once, again = (kind.mutate(random.Random("7"), data, data) for _ in range(2))
            self.assertEqual(once, again)

    def test_a_kind_that_is_none_is_told(self):
        done = subprocess.run([sys.executable, "-B", mutate.__file__, "lpc", ".", "work", "--replay", "dance", "x"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("there is no kind 'dance'; valid: cases, command", done.stderr)

    def test_damage_reaches_the_schema_of_a_store(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "s.db"
            db = sqlite3.connect(path)
            db.executescript("CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT);"
                             "INSERT INTO meta VALUES ('schema_version', '3')")
            db.close()
            data = path.read_bytes()
            self.assertTrue(any(b"2147483647" in mutations.database(random.Random(n), data, data) for n in range(300)))

    def test_a_program_that_falls_over_a_word_is_found_and_the_input_made_small(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "lpc"
            program.write_text(textwrap.dedent("""\
                #!/bin/bash
                for f in "$@"; do
                  [ -f "$f" ] && grep -q gravity "$f" && kill -SEGV $$
                  [[ "$f" == *.db ]] && : > "$f"
                done
                exit 0
                """))
            program.chmod(0o755)
            source = Path(__file__).resolve().parents[2]
            fuzzer = mutate.Fuzzer(program, source, Path(folder) / "work", False, make=False)
            scene = b"".join(fuzzer.seeds.of["scene"])
            told = fuzzer.fault("scene", scene)
            self.assertIn("signal 11", told)
            small = fuzzer.smaller("scene", scene, told, None)
            self.assertIn(b"gravity", small)
            self.assertLess(len(small), len(scene) / 10)
            self.assertEqual(fuzzer.fault("scene", b"name = 'x'"), "")


if __name__ == "__main__":
    os.environ.pop("LPC_TEST_SEED", None)
    unittest.main()
