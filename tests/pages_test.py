# SPDX-License-Identifier: Zlib
"""What pages name is there: files and sections of links, paths; of docs/heritage.md also the tests that show a row. Its rows are
numbered without a gap, and their counts are those above them. Run by ctest: pages_test.py SOURCE_DIR.

What a test shows is read by people. This finds what was renamed, moved or taken away since. Commands are run by docs_test.py.
"""

import collections
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
STATES = {"done": True, "in part": True, "not there": False, "left out": False}  # and whether something shows it
# By a reader of adding_an_algorithm.md.
TO_BE_MADE = {"algorithms/broadphase/bucket_sort.cpp", "algorithms/velocity/backward.cpp"}


def prose(page):
    return re.sub(r"(?ms)^ *```.*?^ *```$", "", page)


def sections(page):
    return {re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in re.findall(r"(?m)^#+ (.*)$", prose(page))}


def link_faults(page, folder):
    """Links and paths of a page in this folder that lead nowhere."""
    out = []
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        name, _, section = target.partition("#")
        file = folder / name
        if "://" in target:
            continue
        if name and not file.exists():
            out.append(f"there is no {target}")
        elif section and section not in sections(file.read_text() if name else page):
            out.append(f"there is no section {target}")
    paths = re.findall(r"`((?:\.ci|algorithms|docs|experiments|framework|oracles|reports|tests)/[\w./-]+)`", prose(page))
    return out + [f"there is no {path}" for path in paths if path not in TO_BE_MADE and not (SOURCE / path).exists()]


def heritage_faults(page, tests):
    out, counts = [], collections.Counter()
    for number, line in enumerate(re.findall(r"(?m)^\| \d+ \|.*$", page), 1):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        state = next((s for s in STATES if len(cells) == 4 and cells[2].startswith(s + ": ")), None)
        if state is None or cells[0] != str(number):
            out.append(f"row {number} is none: {line}")
            continue
        counts[state] += 1
        if bool(re.search("`|]", cells[3])) != STATES[state]:
            out.append(f"row {number}, {state}, is shown by {cells[3]}")
        out += [f"there is no test {name}" for name in re.findall(r"`([A-Z]\w*\.\w+)`", cells[3]) if name not in tests]
    told = {what: int(count) for what, count in re.findall(r"(?m)^\| ([a-z ]+) \| (\d+) \|$", page)}
    return out + [f"{what}: {told.get(what)} above the tables" for what, count in
                  [*((state, counts[state]) for state in STATES), ("together", counts.total())] if told.get(what) != count]


class Pages(unittest.TestCase):
    def test_links_and_paths_lead_somewhere(self):
        pages = [*SOURCE.glob("*.md"), *SOURCE.glob("docs/*.md"), *SOURCE.glob(".github/**/*.md")]
        self.assertGreater(len(pages), 20)
        for page in pages:
            if page.name != "CHANGELOG.md":  # names what was there
                self.assertEqual(link_faults(page.read_text(), page.parent), [], page)

    def test_the_report_of_2009(self):
        code = "".join(file.read_text() for end in ("cpp", "h") for file in SOURCE.glob(f"tests/**/*.{end}"))
        tests = {".".join(name) for name in re.findall(r"\b(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)", code)}
        self.assertGreater(len(tests), 500)
        self.assertEqual(heritage_faults((SOURCE / "docs/heritage.md").read_text(), tests), [])

    def test_the_citation_has_the_version(self):
        built = re.search(r"project\(lpc VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        self.assertIn(f"\nversion: {built}\n", (SOURCE / "CITATION.cff").read_text())

    def test_planted_faults_are_found(self):
        page = ("# A step\n[a](README.md), [b](#a-step), [c](docs/manual.md#reading-the-report), `tests/run`\n"
                "```\n[d](x.md)\n```\n")
        self.assertEqual(link_faults(page, SOURCE), [])
        for right in ("README.md", "#a-step", "docs/manual.md", "#reading-the-report", "tests/run"):
            self.assertTrue(link_faults(page.replace(right, right + "s"), SOURCE), right)
        page = ("| done | 1 |\n| in part | 0 |\n| not there | 0 |\n| left out | 1 |\n| together | 2 |\n"
                "| 1 | Cache (4.2.5) | done: `cache` | `Cache.Carries`, `tests/run` |\n"
                "| 2 | Clay (9.4.5) | left out: later | – |\n")
        self.assertEqual(heritage_faults(page, {"Cache.Carries"}), [])
        for right, wrong in [("Cache.C", "Cache.D"), ("done | 1", "done | 2"), ("together | 2", "together | 3"),
                             ("| 2 | C", "| 3 | C"), ("| in part | 0 |\n", ""), ("done: ", "did "), ("– |", "`a` |"),
                             ("`Cache.Carries`, `tests/run`", "–"), ("Clay", "Cl | ay")]:
            self.assertTrue(heritage_faults(page.replace(right, wrong), {"Cache.Carries"}), right)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
