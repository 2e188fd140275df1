# SPDX-License-Identifier: Zlib
"""What docs/heritage.md says is there: the tests that show a row, files, scenes and options of commands, sections of pages; and
its numbers and counts are those of its tables. Run by ctest: heritage_test.py SOURCE_DIR.

What a test shows is read by people. This finds what was renamed, moved or taken away since.
"""

import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
PAGE = "docs/heritage.md"
STATES = ("done", "in part", "not there", "left out")
SHOWN = ("done", "in part")  # needs something that shows it; the others have none
NOTHING = "–"


class Tree:
    """The names that a page may use."""

    def __init__(self, source):
        self.source = source
        self.tests = set()
        for file in [*source.glob("tests/**/*.cpp"), *source.glob("tests/**/*.h")]:
            code = re.sub(r"//.*", "", file.read_text())
            found = re.findall(r"\b(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)", code)
            self.tests.update(f"{suite}.{name}" for suite, name in found)
        self.options = {}  # of each subcommand
        for file in source.glob("experiments/lpc/*.cpp"):
            text = file.read_text()
            options = set(re.findall(r'\b(?:option|flag|seeded)\(\s*"(--[a-z-]+)"', text))
            for command in re.findall(r'LPC_COMMAND\("([a-z-]+)"', text):
                self.options[command] = options

    def toml(self, folder, name, numbered):
        """The text of a scene or script by its name, its number or its path; none: ''."""
        stem = numbered + name if name.isdigit() else name
        for file in (self.source / "experiments" / folder / f"{stem}.toml", self.source / name):
            if file.is_file():
                return file.read_text()
        return ""

    def anchors(self, page):
        file = self.source / page
        if not file.is_file():
            return None
        prose = re.sub(r"(?ms)^ *```.*?^ *```$", "", file.read_text())
        heads = re.findall(r"(?m)^#+ (.*)$", prose)
        return {re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in heads}


def parameters(toml):
    block = re.search(r"(?ms)^\[parameters\]\n(.*?)(?=^\[|\Z)", toml)
    return set(re.findall(r"(?m)^(\w+) *=", block[1])) if block else set()


def command_faults(command, tree):
    """What a call of lpc names that is not there."""
    words = command.split()[1:]
    if not words or words[0] not in tree.options:
        return [f"there is no '{' '.join(command.split()[:2])}'"]
    subcommand, rest = words[0], words[1:]
    out = [f"'lpc {subcommand}' has no {w}" for w in rest if w.startswith("--") and w not in tree.options[subcommand]]
    if subcommand != "run":
        return out
    scene = rest[0] if rest else ""
    toml = tree.toml("scenes", scene, "preset_")
    if not toml:
        return out + [f"there is no scene '{scene}'"]
    known = parameters(toml) | {"perturb"}
    for option, value in zip(rest, rest[1:]):
        if option == "--script":
            script = tree.toml("scripts", value, "director_")
            out += [] if script else [f"there is no script '{value}'"]
            known |= parameters(script)
    given = [value.split("=")[0] for option, value in zip(rest, rest[1:]) if option == "--param"]
    return out + [f"'{scene}' has no parameter '{name}'" for name in given if name not in known]


def shown_faults(cell, tree):
    """What the last cell of a row names that is not there."""
    out = []
    for text, target in re.findall(r"\[([^\]]+)\]\(([^)]+)\)", cell):
        page, _, anchor = target.partition("#")
        anchors = tree.anchors(f"docs/{page}")
        if anchors is None:
            out.append(f"there is no page '{page}'")
        elif anchor and anchor not in anchors:
            out.append(f"'{page}' has no section '{anchor}'")
    rest = re.sub(r"\[[^\]]+\]\([^)]+\)", "", cell)
    for name in re.findall(r"`([^`]+)`", rest):
        if name.startswith("lpc "):
            out += command_faults(name, tree)
        elif re.fullmatch(r"[A-Z]\w*\.\w+", name):
            out += [] if name in tree.tests else [f"there is no test '{name}'"]
        else:
            out += [] if (tree.source / name).is_file() else [f"there is no file '{name}'"]
    rest = re.sub(r"`[^`]+`", "", rest).replace(",", "").strip()
    return out + ([f"'{rest}' shows nothing"] if rest and rest != NOTHING else [])


def faults(page, tree):
    """All that is wrong with the page."""
    out, counts, number = [], dict.fromkeys(STATES, 0), 0
    for line in page.split("\n"):
        cells = [c.strip() for c in line.strip("|").split("|")] if line.startswith("|") else []
        if not cells or not cells[0].isdigit():
            continue
        number += 1
        if len(cells) != 4:
            out.append(f"row {cells[0]} has {len(cells)} cells")
            continue
        if cells[0] != str(number):
            out.append(f"row {cells[0]} stands in place {number}")
        if not re.search(r"\((?:\d|minutes |[A-D]\.|September|October|January|February)[^)]*\)$", cells[1]):
            out.append(f"row {number} names no section")
        state = next((s for s in STATES if re.match(s + r": \S", cells[2])), None)
        if state is None:
            out.append(f"row {number} is neither of {', '.join(STATES)}: {cells[2]}")
            continue
        counts[state] += 1
        if (cells[3] == NOTHING) != (state not in SHOWN):
            out.append(f"row {number}, {state}, is shown by '{cells[3]}'")
        out += [f"row {number}: {f}" for f in shown_faults(cells[3], tree)]
    said = dict(re.findall(r"(?m)^\| ([a-z ]+) \| (\d+) \|$", page))
    for what, count in [*counts.items(), ("together", number)]:
        if said.get(what) != str(count):
            out.append(f"{what}: {count} in the tables, {said.get(what)} above them")
    return out


class Heritage(unittest.TestCase):
    tree = Tree(SOURCE)
    page = (SOURCE / PAGE).read_text()

    def test_what_it_names_is_there(self):
        self.assertEqual(faults(self.page, self.tree), [])

    def test_it_is_read(self):
        self.assertGreater(len(re.findall(r"(?m)^\| \d+ \|", self.page)), 134)
        self.assertGreater(len(set(re.findall(r"`([A-Z]\w*\.\w+)`", self.page))), 100)
        self.assertGreater(len(self.tree.tests), 500)
        self.assertTrue("(docs/heritage.md)" in (SOURCE / "README.md").read_text(), "README has no link to it")


class ThisTest(unittest.TestCase):
    """What it must see, planted in a page of its own."""

    tree = Heritage.tree
    SECOND = "| 2 | Towers (7.2, 9) | in part: small | `lpc run vertical_stack --param n=4`, [s](architecture.md#a-step) |\n"
    ROWS = ("| 1 | Cache (4.2.5) | done: `cache` | `Cache.CarriesImpulses`, `tests/CMakeLists.txt` |\n"
            + SECOND + "| 3 | Clay (9.4.5) | left out: later | – |\n")
    GOOD = ("| | features |\n| --- | --- |\n| done | 1 |\n| in part | 1 |\n| not there | 0 |\n| left out | 1 |\n"
            "| together | 3 |\n\n"
            "| no | the report (section) | now | shown by |\n| --- | --- | --- | --- |\n" + ROWS)

    def test_a_right_page_has_no_fault(self):
        self.assertEqual(faults(self.GOOD, self.tree), [])

    def test_planted_errors_are_caught(self):
        for right, wrong, says in [
                ("Cache.CarriesImpulses", "Cache.CarriesNothing", "there is no test 'Cache.CarriesNothing'"),
                ("tests/CMakeLists.txt", "tests/absent.txt", "there is no file 'tests/absent.txt'"),
                ("tests/CMakeLists.txt", "tests", "there is no file 'tests'"),
                ("| done | 1 |", "| done | 2 |", "done: 1 in the tables, 2 above them"),
                ("| together | 3 |", "| together | 4 |", "together: 3 in the tables, 4 above them"),
                ("| not there | 0 |\n", "", "not there: 0 in the tables, None above them"),
                ("| 2 | Towers", "| 3 | Towers", "row 3 stands in place 2"),
                (self.SECOND, "", "row 3 stands in place 2"),
                ("run vertical_stack", "run vertical_stuck", "there is no scene 'vertical_stuck'"),
                ("run vertical_stack", "run 99", "there is no scene '99'"),
                ("--param n=4", "--parm n=4", "'lpc run' has no --parm"),
                ("--param n=4", "--store n.db", "'lpc run' has no --store"),
                ("--param n=4", "--param m=4", "'vertical_stack' has no parameter 'm'"),
                ("lpc run", "lpc dance", "there is no 'lpc dance'"),
                ("#a-step", "#a-leap", "'architecture.md' has no section 'a-leap'"),
                ("architecture.md", "absent.md", "there is no page 'absent.md'"),
                ("| done: `cache`", "| did it", "row 1 is neither of"),
                ("in part: small | `lpc run vertical_stack --param n=4`, [s](architecture.md#a-step)", "in part: small | –",
                 "row 2, in part, is shown by '–'"),
                ("later | –", "later | `tests/run`", "row 3, left out, is shown by"),
                (" (4.2.5)", "", "row 1 names no section"),
                ("`Cache.CarriesImpulses`,", "`Cache.CarriesImpulses`, by and by,", "shows nothing"),
                ("Cache (4.2.5)", "Cache | box (4.2.5)", "row 1 has 5 cells")]:
            with self.subTest(says):
                self.assertEqual(self.GOOD.count(right), 1, right)
                self.assertTrue([f for f in faults(self.GOOD.replace(right, wrong), self.tree) if says in f], says)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
