#!/usr/bin/env python3
# SPDX-License-Identifier: Zlib
"""Holds comments and pages to docs/writing.md: words for people stand for people, sentences are short, names are the field's.

Run by ctest: prose_test.py. To find what to mend: prose_test.py --list [PATH...], for example
    tests/prose_test.py --list framework docs/manual.md
"""

import io
import pathlib
import re
import sys
import tokenize
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent
MOST_MARKED = 0.5  # per thousand words of comments, and of pages
LONGEST, MEAN = 35, 18  # words of a sentence of a page
# Words for people. Of code and data they make riddles; a few are about people, which is what MOST_MARKED leaves room for.
MARKED = re.compile(r"\b(?:who|whom|whose|whoever|whomever|(?:no|some|any|every)body|(?:some|any|every)one)(?:'s)?\b", re.I)
# Names that this project had and that are not the field's, with what stands for them now.
DENIED = {"Girth": "InnerOuterRadii", "Lookout": "CcdPhase", "Ways": "BodySweeps", "Meeting": "ToiEvent",
          "PairWarmth": "GjkCache", "rubAt": "solveFrictionAt", "takeApart": "splitByShape", "Deed": "Action"}
SKIPPED = ("docs/figures/", "docs/drawings/", "experiments/heritage/", "build/", "results/")
C_LIKE, HASHED = (".h", ".cpp", ".in"), (".cmake", ".toml", ".sh")
SCRIPTS = ("CMakeLists.txt", "experiments/run", "tests/run", "tests/format", "tests/times")


def comments_of_c(text):
    """(line, comment) for each comment of C++; lines of comment that follow each other are one."""
    found, start, alone = [], 0, False
    for number, line in enumerate(text.split("\n"), 1):
        bare = re.sub(r'"(?:[^"\\]|\\.)*"', lambda literal: '"' + "x" * (len(literal[0]) - 2) + '"', line)
        at = re.search(r"(?:^|[\s;{},()])//[/!<]*", bare)
        said = line[at.end():].strip() if at and "SPDX" not in line else None
        whole = said is not None and bare.lstrip().startswith("//")
        if whole and found and alone:
            found.append(said)
            continue
        if found:
            yield start, " ".join(found)
        found, start, alone = ([said], number, whole) if said is not None else ([], 0, False)
    if found:
        yield start, " ".join(found)


def comments_of_python(text):
    """(line, comment or docstring) of Python."""
    found, start, last, before = [], 0, -1, None
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and "SPDX" not in token.string:
            if found and token.start[0] != last + 1:
                yield start, " ".join(found)
                found = []
            start = start if found else token.start[0]
            found.append(token.string.lstrip("#! "))
            last = token.start[0]
        elif token.type == tokenize.STRING and '"""' in token.string[:4] and before in (
                None, tokenize.NEWLINE, tokenize.INDENT, tokenize.NL, tokenize.COMMENT, tokenize.ENCODING):
            yield token.start[0], " ".join(token.string.strip('rf"').split())
        before = token.type
    if found:
        yield start, " ".join(found)


def comments_of_hashes(text):
    """(line, comment) where `#` begins one: CMake, TOML, shell."""
    found, start = [], 0
    for number, line in enumerate([*text.split("\n"), ""], 1):
        comment = re.match(r"\s*#(?!!)\s?(.*)$", line)
        if comment and "SPDX" not in line:
            start = start if found else number
            found.append(comment[1])
        elif found:
            yield start, " ".join(found)
            found = []


def paragraphs(text):
    """(line, text, whether it is a cell of a table) of a page, without code and headings."""
    code, found, start = False, [], 0
    for number, line in enumerate([*text.split("\n"), ""], 1):
        line = line.strip()
        if line.startswith("```"):
            code, line = not code, ""
        elif code:
            continue
        item = re.match(r"(?:[-*]|\d+\.)\s+", line)
        if found and (not line or item or line.startswith(("|", "#", "<!--"))):
            yield start, " ".join(found), False
            found = []
        if line.startswith("|"):
            if not re.fullmatch(r"[|\s:-]+", line):
                for cell in re.split(r"(?<!\\)\|", line.strip("|")):
                    yield number, cell.strip(), True
        elif line and not line.startswith(("#", "<!--")):
            start = start if found else number
            found.append(line[item.end():] if item else line)


def plain(text):
    """Without links, code and tags: a piece of code is one word."""
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", " ", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"<[^>\s][^>]*>", " ", re.sub(r"`[^`]*`", "CODE", text))


def words(text):
    return re.findall(r"[A-Za-z0-9][\w'.,/^%-]*", text)


def sentences(text):
    return [part for part in re.split(r"(?<=[.!?])[\"')*]*\s+(?=[A-Z0-9\"'“(*])", text) if part.strip()]


def texts(path):
    """(line, text, "comment", "page" or "cell") of a file of the source tree."""
    name = path.relative_to(SOURCE).as_posix()
    if name.endswith(".md"):
        return [(line, plain(said), "cell" if cell else "page") for line, said, cell in paragraphs(path.read_text("utf-8"))]
    read = (comments_of_c if name.endswith(C_LIKE) else comments_of_python if name.endswith(".py") else
            comments_of_hashes if name.endswith(HASHED + SCRIPTS) else None)
    return [(line, plain(said), "comment") for line, said in read(path.read_text("utf-8"))] if read else []


def files(where=(".",)):
    """Those of the project below these paths, sorted."""
    tops = ("algorithms", "framework", "oracles", "experiments", "tests", "reports", "docs", "cmake")
    asked = [(SOURCE / path).resolve() for path in where]
    every = [p for top in tops for p in (SOURCE / top).rglob("*")] + [*SOURCE.glob("*.md"), SOURCE / "CMakeLists.txt"]
    return sorted(p for p in every if p.is_file() and not p.relative_to(SOURCE).as_posix().startswith(SKIPPED) and
                  "__pycache__" not in p.parts and any(p == a or a in p.parents for a in asked))


def too_long(part, kind):
    """Of a page; a cell of a table is a sentence if it ends as one, and may be a list of names."""
    return len(words(part)) > LONGEST and (kind == "page" or kind == "cell" and part.rstrip().endswith("."))


def faults(text, kind):
    """What must be mended in it: marked words, and sentences of pages that are too long."""
    out = []
    for part in sentences(text):
        marked, count = MARKED.findall(part), len(words(part))
        reasons = marked + ([f"{count} words"] if too_long(part, kind) else [])
        out += [f"{', '.join(reasons)}: {part.strip()}"] if reasons else []
    return out


def too_many(texts_of_kind):
    """Marked words per thousand, and whether they are too many."""
    count = sum(len(words(text)) for text in texts_of_kind)
    rate = 1000 * sum(len(MARKED.findall(text)) for text in texts_of_kind) / max(1, count)
    return rate, rate > MOST_MARKED


class Prose(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = [(path.relative_to(SOURCE).as_posix(), *found) for path in files() for found in texts(path)]

    def test_words_for_people_are_rare(self):
        for kinds in (("comment",), ("page", "cell")):
            rate, over = too_many([text for _, _, text, kind in self.found if kind in kinds])
            self.assertFalse(over, f"{rate:.2f} marked words in a thousand of {kinds[0]}s, at most {MOST_MARKED}; "
                             "tests/prose_test.py --list names them")

    def test_sentences_of_pages_are_short(self):
        pages = [(name, line, kind, part) for name, line, text, kind in self.found for part in sentences(text)]
        long = [f"{name}:{line}: {part}" for name, line, kind, part in pages if too_long(part, kind)]
        self.assertEqual(long, [], f"sentences of more than {LONGEST} words")
        lengths = [len(words(part)) for _, _, text, kind in self.found if kind == "page" for part in sentences(text)]
        self.assertLessEqual(sum(lengths) / len(lengths), MEAN, "words in a sentence, on average")

    def test_names_are_the_fields(self):
        denied = re.compile(rf"\b(?:{'|'.join(DENIED)})\b")
        for path in files(("algorithms", "framework", "oracles", "experiments")):
            if path.suffix in (".h", ".cpp"):
                for name in denied.findall(re.sub(r"//.*", "", path.read_text(encoding="utf-8"))):
                    self.fail(f"{path.relative_to(SOURCE)}: {name} is {DENIED[name]} now")

    def test_a_planted_riddle_is_caught(self):
        riddle = "int a;  // who was apart, and is asked for no more\n"
        self.assertEqual(list(comments_of_c(riddle)), [(1, "who was apart, and is asked for no more")])
        self.assertEqual(list(comments_of_c('say("// who");\n')), [])
        self.assertTrue(too_many(["who was apart, and is asked for no more"])[1])
        self.assertFalse(too_many(["The search retries the last separating axis first."])[1])
        self.assertEqual(list(comments_of_hashes("# Whoever\n# asks\nx = 1\n")), [(1, "Whoever asks")])
        self.assertEqual(list(comments_of_python('"""Who asks."""\nx = "who"  # whom\n')), [(1, "Who asks."), (2, "whom")])
        self.assertTrue(faults("Nobody's handle.", "page"))
        self.assertTrue(faults("A word " * 18 + "ends.", "page"))
        self.assertFalse(faults("A word " * 17 + "ends.", "page"))
        page = "# Who\n```\nwho\n```\n- a\n- b\n\n| who | c |\n|---|---|\n"
        self.assertEqual([said for _, said, _ in paragraphs(page)], ["a", "b", "who", "c"])


def main(arguments):
    if arguments[:1] == ["--list"]:
        for path in files(arguments[1:] or (".",)):
            for line, text, kind in texts(path):
                for fault in faults(text, kind):
                    print(f"{path.relative_to(SOURCE).as_posix()}:{line}: {fault}")
        return 0
    if arguments and arguments[0] in ("-h", "--help"):
        print(__doc__.strip())
        return 0
    if arguments:
        print(f"prose_test.py: unknown argument '{arguments[0]}'; valid: --list [PATH...], --help", file=sys.stderr)
        return 2
    unittest.main(argv=[sys.argv[0]])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
