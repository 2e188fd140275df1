# SPDX-License-Identifier: Zlib
"""What may be imported by what: a chart imports no other chart, so that what two charts share stands in reports/ under a name
of its own."""

import ast
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import chart  # noqa: E402

LONGEST = 500  # lines of a file


def imports(text):
    """Names of the modules that a text imports."""
    found = [node for node in ast.walk(ast.parse(text)) if isinstance(node, (ast.Import, ast.ImportFrom))]
    return {name for node in found for name in ([node.module or ""] if isinstance(node, ast.ImportFrom) else
                                                [alias.name for alias in node.names])}


def of_charts(text):
    return sorted(name for name in imports(text) if name.split(".")[0] == "charts")


class Architecture(unittest.TestCase):
    def setUp(self):
        self.files = sorted((HERE.parent / "charts").glob("*.py"))

    def test_no_chart_imports_another(self):
        for path in self.files:
            self.assertEqual(of_charts(path.read_text(encoding="utf-8")), [], path.name)
        planted = self.files[0].read_text(encoding="utf-8") + "\nfrom charts.falls import window\n"
        self.assertEqual(of_charts(planted), ["charts.falls"], "the planted import was not seen")

    def test_no_file_is_long(self):
        for path in [*self.files, *HERE.parent.glob("*.py")]:
            self.assertLessEqual(len(path.read_text(encoding="utf-8").splitlines()), LONGEST, path.name)

    def test_each_kind_of_chart_has_a_name_of_its_own(self):
        names = [kind.name for kind in chart.kinds()]
        self.assertEqual(sorted(names), sorted(set(names)))
        self.assertEqual({kind.file for kind in chart.kinds()}, {path.name for path in self.files}, "a file without a chart")


if __name__ == "__main__":
    unittest.main()
