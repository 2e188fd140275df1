# SPDX-License-Identifier: Zlib
"""Tests of the report as a command: what it writes, what it refuses. Run by ctest, or python3 reports/tests/command_test.py."""

import contextlib
import io
import json
import os
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import make  # noqa: E402
import synthetic_store  # noqa: E402


def command(*arguments, **environment):
    """The command in a process of its own."""
    return subprocess.run([sys.executable, str(HERE.parent / "make.py"), *map(str, arguments)], capture_output=True,
                          text=True, check=False, env={**os.environ, **environment})


def here(*arguments):
    """The same without a new process, which takes a second to import what all take: (exit code, what it printed to stderr)."""
    error = io.StringIO()
    with contextlib.redirect_stderr(error), contextlib.redirect_stdout(io.StringIO()):
        try:
            code = make.main(list(map(str, arguments)))
        except SystemExit as ended:
            code = ended.code
    return code, error.getvalue()


class Command(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = Path(cls.folder.name) / "store.db"
        # page_test.py has a page of all themes
        synthetic_store.write(cls.path, themes=(lambda make: synthetic_store.broadphase(make, dimensions=(2,)),))

    def test_same_store_gives_the_same_bytes_alone_too_and_links_exist(self):
        files = []
        for seed, only in (("1", ()), ("2", ()), ("3", ("--only", "broadphase_crossover_2d,coverage"))):
            out = Path(self.folder.name) / "out"
            if seed == "2":
                done = command("--store", self.path, "--out", out, PYTHONHASHSEED=seed)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertEqual(done.stdout.strip(), str(out / "index.html"))
            else:  # hashes are others than there: in no order of a set may stand what is written
                self.assertEqual(here("--store", self.path, "--out", out, *only), (0, ""))
            files.append({path.relative_to(out): path.read_bytes() for path in out.rglob("*") if path.is_file()})
            out.rename(out.with_name(f"out{seed}"))
        alone = files.pop()
        self.assertEqual(len(alone), 8, alone.keys())  # two pictures and two tables of each, and no page
        for path, content in alone.items():
            self.assertTrue(content == files[0][path], path)
        self.assertEqual(files[0].keys(), files[1].keys())
        for path, content in files[0].items():
            self.assertTrue(content == files[1][path], path)
        for name in ("charts/broadphase_crossover_2d.svg", "charts/coverage.png", "tables/broadphase_crossover_2d.csv"):
            self.assertIn(Path(name), files[0])
        for source in files[0][Path("index.html")].decode("utf-8").split('src="')[1:]:
            self.assertIn(Path(source.split('"')[0]), files[0])

    def test_one_chart_for_the_readme(self):
        target = Path(self.folder.name) / "best.svg"
        store = target.with_suffix(".db")
        synthetic_store.write(store, themes=(synthetic_store.one_scene,))  # what `best` takes first, and nothing else to draw
        self.assertEqual(here("--store", store, "--chart", "best", "--to", target), (0, ""))
        self.assertIn("<svg", target.read_text(encoding="utf-8"))

    def refuses(self, expected, *arguments):
        code, said = here(*arguments)
        self.assertEqual(code, 2, said)
        self.assertIn(expected, said)
        self.assertNotIn("Traceback", said)
        self.assertLessEqual(said.count("\n"), 1 + ("usage:" in said) * 3, said)

    def test_mistakes_are_told_in_one_line(self):
        folder = Path(self.folder.name)
        done = command("--store", folder / "absent.db", "--out", folder / "o")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.refuses("no such store", "--store", folder / "absent.db", "--out", folder / "o")
        self.refuses("no such store", "--store", folder / ("x" * 300), "--out", folder / "o")
        (folder / "text.db").write_text("this is not a database, only a text that is long enough to be one" * 20)
        self.refuses("not a result store", "--store", folder / "text.db", "--out", folder / "o")
        sqlite3.connect(folder / "blank.db").execute("CREATE TABLE other(x)")
        self.refuses("no table", "--store", folder / "blank.db", "--out", folder / "o")
        synthetic_store.write(folder / "future.db", themes=())
        with sqlite3.connect(folder / "future.db") as db:
            db.execute("UPDATE meta SET value='9' WHERE key='schema_version'")
        self.refuses("store schema 9, this report reads schema 3", "--store", folder / "future.db", "--out", folder / "o")
        synthetic_store.write(folder / "empty.db", themes=())  # nothing is drawn in order to be refused
        self.refuses("no such chart", "--store", folder / "empty.db", "--out", folder / "o", "--only", "nonsense")
        self.refuses("give --out", "--store", self.path)
        whole = self.path.read_bytes()
        for size in (len(whole) // 2, 4096, 100, 0):
            (folder / "short.db").write_bytes(whole[:size])
            self.refuses("not a result store", "--store", folder / "short.db", "--out", folder / "o")
        self.assertFalse((folder / "o").exists(), "a refused command must write nothing")

    def test_what_cannot_be_written_is_told_in_one_line(self):
        folder = Path(self.folder.name)
        small = folder / "small.db"
        synthetic_store.write(small, themes=(synthetic_store.benchmark,))
        (folder / "file").write_text("a regular file")
        (folder / "full.svg").symlink_to("/dev/full")
        self.refuses("cannot be made: Not a directory", "--store", small, "--out", folder / "file" / "out")
        self.refuses("not a folder", "--store", small, "--out", folder / "file")
        self.refuses("x: File name too long", "--store", small, "--out", folder / ("x" * 300))
        self.refuses("full.svg: cannot be written: No space left on device", "--store", small, "--chart",
                     "micro_broadphase_2d", "--to", folder / "full.svg")

    def test_a_full_disk_leaves_no_partial_file(self):
        """Files of at most 20 kB: the first figure ends in the middle, as on a full disk. An earlier one stays whole."""
        folder = Path(self.folder.name) / "nearly_full"
        (folder / "charts").mkdir(parents=True)
        synthetic_store.write(folder / "small.db", themes=(synthetic_store.benchmark,))
        picture = folder / "charts" / "micro_broadphase_2d.svg"
        picture.write_text("the earlier picture")
        limited = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000)); "
        run = [sys.executable, "-c", limited + "import sys; sys.path.insert(0, sys.argv.pop(1)); import make; "
               "sys.exit(make.main(sys.argv[1:]))", str(HERE.parent), "--store", str(folder / "small.db"), "--out", str(folder),
               "--only", "micro"]
        done = subprocess.run(run, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("micro_broadphase_2d.svg: cannot be written: File too large", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertEqual(picture.read_text(), "the earlier picture")
        self.assertEqual([p.name for p in folder.rglob("*.partial")], [])

    def test_a_missing_package_is_named(self):
        script = ("import builtins, sys\nreal = builtins.__import__\n"
                  "def fake(name, *a, **k):\n"
                  "    if name == 'jinja2': raise ImportError('planted', name='jinja2')\n"
                  "    return real(name, *a, **k)\n"
                  f"builtins.__import__ = fake\nsys.path.insert(0, {json.dumps(str(HERE.parent))})\nimport make\n"
                  f"sys.exit(make.main(['--store', {json.dumps(str(self.path))}, '--list']))")
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no package jinja2", done.stderr)


if __name__ == "__main__":
    unittest.main()
