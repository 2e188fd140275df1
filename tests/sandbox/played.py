# SPDX-License-Identifier: Zlib
"""For tests of the sandbox: they drive it with a script of input, and check its pictures and the output of `state`. A test runs
as NAME_test.py SOURCE_DIR LPC.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import numpy

SOURCE, LPC = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PAPER = (247, 247, 245)
QUICK = ["key .", "key ."]  # four steps a picture


def png(path):
    """Height x width x (r, g, b), 0 to 255."""
    return (matplotlib.image.imread(path)[..., :3] * 255).round().astype(int)


def like(rows, colour, by):
    return (abs(rows - numpy.array(colour)) <= by).all(axis=-1)


def choose(menu, name):
    """A menu opens one picture after the click, and closes two after the choice."""
    return ["on " + menu, "press left", "release left", f"on {menu}/{name}", "press left", "release left", "wait 1"]


def click(name):
    return ["on " + name, "wait 1", "press left", "release left", "wait 2"]


def drag(a, b, button="left"):
    return [f"at {a[0]} {a[1]}", f"press {button}", f"at {b[0]} {b[1]}", f"release {button}"]


class Played(unittest.TestCase):
    """Runs the program in a separate folder."""

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def call(self, *arguments, env=None, program=LPC):
        return subprocess.run([str(program), "sandbox", *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=300, env={**os.environ, "LPC_HOME": str(SOURCE), **(env or {})})

    def play(self, orders, *arguments, states=("end",), size=(320, 240)):
        """Performs the orders in a window of this size that shows the whole scene; returns the output of `state` by name."""
        begin = ["size {} {}".format(*size), "wait 1", "key Home"]
        (self.folder / "input.txt").write_text("\n".join([*begin, *orders, "state end.json", "quit"]) + "\n")
        done = self.call(*arguments, "--input", "input.txt")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        found = [json.loads((self.folder / f"{name}.json").read_text()) for name in states]
        return found[0] if len(found) == 1 else found

    known = {}

    def commands(self, dimension):
        if dimension not in self.known:
            self.known[dimension] = self.play([], dimension)["commands"]
        return self.known[dimension]

    def registry(self):
        done = subprocess.run([str(LPC), "list", "--json"], capture_output=True, text=True, timeout=60, check=True)
        return json.loads(done.stdout)["algorithms"]

    def has(self, engine):
        return any(a["stage"] == "engine" and a["name"] == engine and not a["summary"].startswith("not in this build")
                   for a in self.registry())

    def lpc_run(self, *arguments):
        done = subprocess.run([str(LPC), "run", *map(str, arguments), "--json"], cwd=self.folder, capture_output=True, text=True,
                              timeout=300, env={**os.environ, "LPC_HOME": str(SOURCE)})
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(done.stdout)
