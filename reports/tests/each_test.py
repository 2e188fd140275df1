# SPDX-License-Identifier: Zlib
"""Test of what runs most of these tests. Run by ctest, or python3 reports/tests/each_test.py."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

EACH = Path(__file__).resolve().parent / "each.py"
TEST = """import unittest
class Planted(unittest.TestCase):
    def test(self):
        self.assertEqual(1, {})
if __name__ == "__main__":
    unittest.main()
"""
FILES = {"good.py": TEST.format(1), "wrong.py": TEST.format(2), "broken.py": "import nothing_of_this_name\n", "empty.py": "",
         "killed.py": "import os\nos.kill(os.getpid(), 9)\n", "also_good.py": TEST.format(1)}


class Each(unittest.TestCase):
    def test_whoever_fails_is_told_and_the_others_run(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in FILES.items():
                (Path(folder) / name).write_text(text)
            done = subprocess.run([sys.executable, "-B", str(EACH), *FILES], cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.splitlines()[-1], "failed: wrong.py, broken.py, empty.py, killed.py", done.stderr)
        self.assertEqual(done.stderr.count("\nOK\n"), 2, done.stderr)

    def test_all_is_well(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "good.py").write_text(FILES["good.py"])
            done = subprocess.run([sys.executable, "-B", str(EACH), "good.py"], cwd=folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr.splitlines()[-1]), (0, "all 1 passed"), done.stderr)


if __name__ == "__main__":
    unittest.main()
