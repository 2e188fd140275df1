# SPDX-License-Identifier: Zlib
"""Runs the commands of the pages on the files of the pages, and checks that options named in prose exist.
Run by ctest: docs_test.py SOURCE_DIR BINARY_DIR [PYTHON for reports] [--others] [--deep].
Covers README, the manual and its reference; with --others, the other pages.

A fence names its content: sh; toml, cpp or cmake with a file name; toml axes, the axes of a sweep; text pipeline; text.
Commands that are not run are listed below with the reason, or with a replacement.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

SOURCE, BINARY = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
DEEP, OTHERS = "--deep" in sys.argv, "--others" in sys.argv
HAS_SINGLE = "f32" in (BINARY / "precisions.txt").read_text()
REPORT_PYTHON = next((argument for argument in sys.argv[3:] if not argument.startswith("--")), "")
SCRATCH = BINARY / ("docs_test_others" if OTHERS else "docs_test")
REFERENCE = sorted(f"docs/{p.name}" for p in (SOURCE / "docs").glob("reference_*.md"))
FIRST = ["docs/manual.md", *REFERENCE, "README.md"]  # the manual's sweep fills the store that README reports
OTHER = sorted({f"docs/{p.name}" for p in (SOURCE / "docs").glob("*.md")} - set(FIRST))
PAGES = [*FIRST, "CONTRIBUTING.md", *OTHER]

# Sections with files and commands that another test covers.
ELSEWHERE = {
    ("docs/manual.md", "A first world in C++"): "tests/embedding/run.cmake",
    **{(f"docs/{page}.md", section): "tests/embedding/run.cmake"
       for page, sections in {"reference_world": ["Forces and rays", "Worlds that change", "Drawing", "An example program",
                                                  "A world in a window"],
                              "shapes": ["Shapes of one part", "Shapes of several parts", "A body"],
                              "joints": ["A joint", "The kinds"],
                              "forces": ["A force", "The kinds", "Forces by code"],
                              "listeners": ["The calls", "Contacts without a listener"]}.items() for section in sections},
    **{("docs/sandbox.md", section): "tests/sandbox/sandbox_test.py" for section in ("", "Sessions as scripts")},
    ("docs/adding_an_algorithm.md", "In ten minutes: a broadphase"): "tests/growth/run.cmake",
    ("docs/adding_an_algorithm.md", "A resolver"): "tests/growth/run.cmake",
    ("docs/adding_an_algorithm.md", "Outside this tree"): "tests/embedding/run.cmake",
}
NOT_RUN = {
    "./experiments/run quick": "builds and sweeps for minutes",
    "./experiments/run heritage": "builds and sweeps for minutes",
    "./experiments/run bench": "builds and times for minutes; step_times runs with few steps beside this one",
    "./tests/run": "it is what runs this",
    "./tests/run -R BroadphaseConformance": "it is what runs this",
    ".ci/install_packages run window": "installs",
    ".ci/install_packages tidy": "installs",
    "git diff --name-only origin/main -- '*.cpp' | xargs -r clang-tidy -p build/tidy --quiet": "of packages that no test needs",
    "cmake --preset release && cmake --build --preset release": "builds for minutes; this build stands for it",
    "cmake --preset tidy": "configures a build; those of the other presets are configured alike",
    "cmake --preset release -DLPC_BUILD_BENCHMARKS=ON && cmake --build --preset release --target lpc-bench":
        "builds; the test `benchmarks_start` runs what the preset `test` builds of the same",
    "taskset -c 1 build/release/bin/lpc-bench --benchmark_filter=broadphase --benchmark_out=bench.json "
    "--benchmark_out_format=json": "measures for minutes",
    "cmake --preset release && cmake --build --preset release --target lpc lpc-f32 lpc-bare":
        "builds for minutes; this build stands for it",
    "lpc verify --stage pair_query --dimension 3 --methods sat gjk_epa{iterations=20} fcl_libccd --seed 7":
        "a hundred seconds of the referee",
    "LPC_TEST_CASES=10000 LPC_TEST_SEED=7 ctest --test-dir build/test -R fuzz_mutate --output-on-failure":
        "twenty minutes; the same test runs for seconds beside this one",
    "python3 tests/fuzz/target.py build/sanitize/bin/scene_fuzz . build/sanitize/fuzz -max_total_time=7200":
        "two hours, of another build; its tests run the same",
    "lpc verify --cases results/verify.db.found/libccd_mpr-wrong_distance-3d-f64.json": "a long verification finds that file",
    "reports/claims.py --into docs/claims.md": "reports_claims_ShippedClaims runs the same",
    "reports/make.py --store results/evidence.db --page docs/evidence.md":
        "of sweeps that take minutes; reports/tests/docs_page_test.py does it with a small store",
    "reports/make.py --store results/pairs.db --page docs/pair_queries.md":
        "of sweeps that take minutes; reports/tests/docs_page_test.py does it with a small store",
    "reports/make.py --store results/heritage.db --page docs/heritage_figures.md":
        "of sweeps that take minutes; reports/tests/docs_page_test.py does it with a small store",
    "experiments/heritage/compilers --out results/heritage_compilers":
        "six builds; heritage_compilers_build makes one, with --deep",
    "reports/heritage_compilers.py results/heritage_compilers --to docs/drawings/heritage_compilers.svg "
    "--page docs/heritage_figures.md":
        "of what that has measured; reports/tests/heritage_compilers_test.py draws the like",
}
# Shorter versions that take a second or two.
INSTEAD = {
    "taskset -c 1 experiments/bench/step_times --runs 3":
        f"{SOURCE}/experiments/bench/step_times --bin {BINARY}/bin --runs 1 --steps 12",
    "taskset -c 1 experiments/bench/engines":
        f"{SOURCE}/experiments/bench/engines --bin {BINARY}/bin --only bullet_f64 --runs 1 --steps 60",
    "for n in 0 1 2 3 4 5 6 8 9 10 11; do lpc run $n --pipeline 2009 --film preset_$n.strip.svg; done":
        "for n in 0 1 2 3 4 5 6 8 9 10 11; do lpc run $n --pipeline 2009 --steps 8 --film preset_$n.strip.svg; done",
    "lpc run 7 --pipeline 2009 --param n=60 --film preset_7.strip.svg":
        "lpc run 7 --pipeline 2009 --param n=60 --steps 8 --film preset_7.strip.svg",
    "for n in 0 1 2 3 4 9 10 11; do lpc run $n --dimension 3 --pipeline 2009 --film preset_${n}_3d.strip.svg; done":
        "for n in 0 1 2 3 4 9 10 11; do lpc run $n --dimension 3 --pipeline 2009 --steps 8 --film preset_${n}_3d.strip.svg; done",
    "lpc run 7 --dimension 3 --pipeline 2009 --param n=50 --param rows=2 --film preset_7_3d.strip.svg":
        "lpc run 7 --dimension 3 --pipeline 2009 --param n=50 --param rows=2 --steps 8 --film preset_7_3d.strip.svg",
    "lpc replay catto.rec --film frames/":
        "lpc run pyramid --param base=2 --dimension 3 --steps 8 --record few.rec && lpc replay few.rec --film frames/",
    "lpc sweep ./friction.toml --store results/mine.db":  # reports_first_sweep runs and draws it in full
        "lpc sweep ./friction.toml --set n=5 --store results/mine.db",
    "lpc sweep ./compliance.toml --store results/compliance.db":
        "lpc sweep ./compliance.toml --dry-run && lpc sweep ./compliance.toml --set problems=stack --store results/compliance.db",
    "lpc needs pyramid --param base=6 --seeds 3 --store results/needs.db":
        "lpc needs box_drop --seeds 1 --store results/needs.db",
    "lpc break vertical_stack --parameter n --from 2 --to 64 --param gap=0 --store results/break.db "
    "--pipeline solver=split_solver --pipeline \"solver=soft_step{substeps=4}\"":
        "lpc break vertical_stack --parameter n --from 2 --to 8 --param gap=0 --steps 60 --store results/break.db "
        "--pipeline solver=split_solver",
    "lpc sweep choose --set n=5000 --set dimension=3 --store results/choose.db":
        "lpc sweep choose --set n=40 --set steps=20 --set seed=1 --store results/choose.db",
    "lpc sweep choose_together --set n=5000 --set dimension=3 --store results/choose.db --with "
    "\"taken=$(lpc report results/choose.db --taken)\"":
        "t=$(lpc report results/choose.db --taken) && { [ -z \"$t\" ] || lpc sweep choose_together --set n=40 --set steps=20 "
        "--set seed=1 --store results/choose.db --with \"taken=$t\"; }",
    "lpc sweep resolvers --store results/mine.db": "lpc sweep resolvers --store results/mine.db --dry-run",
    **{f"lpc sweep {name} --store results/evidence.db": f"lpc sweep {name} --store results/evidence.db --dry-run"
       for name in ("beyond", "breaking_map", "cache_solver", "ensembles", "equal_cost", "orders", "problems", "reference")},
    **{f"lpc sweep {name} --store results/pairs.db": f"lpc sweep {name} --store results/pairs.db --dry-run"
       for name in ("pair_queries", "pair_queries_curved", "hull_sizes", "streams", "tolerance_cost",
                    "continuous")},
    "lpc sweep heritage --store results/heritage.db": "lpc sweep heritage --store results/heritage.db --dry-run",
    "lpc verify --role competitor": "lpc verify --role competitor --stage broadphase --dimension 2",
    "lpc verify": "lpc verify --stage broadphase",
    "lpc verify --stage velocity": "lpc verify --stage velocity --dimension 2 --methods siconos",
    "lpc verify --minutes 10": "lpc verify --minutes 0.01 --stage broadphase",
    "lpc verify --minutes 10 --precision f64,f32": "lpc verify --minutes 0.01 --precision f64,f32 --stage broadphase",
    "build/test/bin/test_properties_f64 --gtest_filter='*EachWitness.*/libccd_gjk_*'":
        "build/test/bin/test_properties_f64 --gtest_filter='*EachWitness.*/libccd_gjk_*' --gtest_list_tests | grep libccd_gjk",
}
# Commands that start f32 workers or read their results. A build with f64 only has no such workers; tests/run --all has them.
SINGLE = re.compile(r"--precision \S*f32|\bchoose")
# Shorter versions; --deep runs the commands as they are.
SHORTER = {
    "lpc sweep ./equal.toml --store results/mine.db": "lpc sweep ./equal.toml --only catto --store results/mine.db",
    "lpc break mass_ratio --parameter ratio --to 64 --pipeline solver=split_solver --pipeline solver=avbd "
    "--store results/mine.db":
        "lpc break mass_ratio --parameter ratio --to 4 --steps 60 --pipeline solver=split_solver --store results/mine.db",
    "lpc break slope --parameter friction --from 0.45 --to 0.9 --falling --limit \"slope_distance<0.01\" --ratio 1.01 "
    "--pipeline solver=split_solver --store results/break.db":
        "lpc break slope --parameter friction --from 0.45 --to 0.9 --falling --limit \"slope_distance<0.01\" --ratio 1.5 "
        "--steps 60 --pipeline solver=split_solver --store results/break.db",
    **{f"lpc report results/{name}.db --out reports/out/{name}": f"test -s results/{name}.db"
       for name in ("needs", "break", "curves")},  # README's report of results/mine.db is drawn
    "lpc run 6 --pipeline 2009 --no-sleeping --param perturb=1e-3":
        "lpc run 6 --pipeline 2009 --no-sleeping --param perturb=1e-3 --steps 60",
    "lpc run 6 --dimension 3 --pipeline 2009 --no-sleeping --param perturb=1e-3":
        "lpc run 6 --dimension 3 --pipeline 2009 --no-sleeping --param perturb=1e-3 --steps 60",
    "lpc run 6 --dimension 3 --pipeline 2009": "lpc run 6 --dimension 3 --pipeline 2009 --steps 60",
    "lpc sweep ./questions.toml --store results/questions.db":
        "lpc sweep ./questions.toml --only catto --store results/questions.db",
}
# Exit codes other than 0, which the page describes.
EXIT_CODE = {"lpc run ./leaning_stack.toml --param n=20 --dimension 3 --profile stack.csv --record stack.rec": 1,
             "lpc run 2 --param perturb=1e-3": 1,
             "lpc run 6 --dimension 3 --pipeline solver=soft_step": 1,
             "lpc run ./slow_start.toml --pipeline 2009 --no-sleeping": 1,
             "lpc run mass_ratio --param ratio=1000": 1}
PART_OF_A_SWEEP = """summary = "the rest of a sweep whose axes are in the page"
kind = "world"
[axes]
scene = "box_drop"
iterations = 4
"""
LANGUAGES = {"sh", "toml", "json", "cpp", "cmake", "text"}


class Block:
    def __init__(self, page, line, section, info, text):
        self.page, self.line, self.section, self.text = page, line, section, text
        self.language, _, self.name = info.partition(" ")

    def where(self):
        return f"{self.page}:{self.line}"

    def commands(self):
        """Whole commands, without comments."""
        joined = self.text.replace("\\\n", " ")
        lines = (re.sub(r"(^|\s+)#.*", "", line).strip() for line in joined.split("\n"))
        return [re.sub(r"  +", " ", line) for line in lines if line]


def blocks_of(page, text):
    """The fenced blocks, in order; blocks in lists without their indent."""
    out, section, inside = [], "", None
    for number, line in enumerate(text.split("\n"), 1):
        fence = re.match(r"^( *)```(.*)$", line)
        if inside is None:
            if line.startswith("## "):
                section = line[3:]
            if fence:
                inside = (number, fence[1], fence[2].strip(), [])
        elif fence:
            begin, indent, info, lines = inside
            out.append(Block(page, begin, section, info, "\n".join(l.removeprefix(indent) for l in lines) + "\n"))
            inside = None
        else:
            inside[3].append(line)
    return out


def inline_commands(text):
    """`lpc ...` in prose."""
    prose = re.sub(r"(?ms)^ *```.*?^ *```$", "", text)
    spans = (re.sub(r"\s+", " ", s) for s in re.findall(r"`([^`]+)`", prose))
    return [s for s in spans if re.match(r"(build/\w+/bin/)?lpc ", s)]


def option_faults(command, help_of):
    """Subcommands and options of a call of lpc that its help lacks. `help_of`: help text by subcommand."""
    words = command.split()
    at = words.index("lpc") + 1 if "lpc" in words else 1
    while at < len(words) and words[at] == "--plugin":
        at += 2
    if at >= len(words) or not re.match(r"^[a-z-]+$", words[at]) or words[at].startswith("-"):
        return []
    told = help_of(words[at])
    if not told:
        return [f"there is no 'lpc {words[at]}'"]
    options = set(re.findall(r"--[a-z-]+", told))
    return [f"'lpc {words[at]}' has no {w}" for w in words[at + 1:] if re.match(r"^--[a-z-]+$", w) and w not in options]


def number(text):
    return f"{float(text):g}"


def row_of(param):
    """A parameter of the registry as a page shows it: its unit, default and range."""
    if param["type"] == "choice":
        return ["", param["default"], ", ".join(param["choices"])]
    return [param["unit"], number(param["default"]), " to ".join(number(x) for x in param["range"])]


def tables_of(text, heading):
    """Rows of tables by section, as lists of cells, without header rows. `heading`: prefix of the sections, with `#`."""
    out, section, rows = {}, None, []
    for line in re.sub(r"(?ms)^```.*?^```$", "", text).split("\n") + ["|"]:
        if line.startswith("#"):
            section = line.removeprefix(heading) if line.startswith(heading) else None
            if section:
                out[section] = []
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if cells:
            rows.append(cells)
        elif rows:
            if section:
                out[section] += rows[2:]
            rows = []
    return out


def parameter_faults(text, algorithms):
    """Differences between a page of kinds, one per section `### name`, and the registry: kinds and parameters."""
    told = {kind: {row[0].strip("`"): row[1:4] for row in rows} for kind, rows in tables_of(text, "### ").items()}
    faults = [f"{kind}: {'not on the page' if kind not in told else 'there is none'}"
              for kind in sorted({a["name"] for a in algorithms} ^ set(told))]
    for a in algorithms:
        rows, params = told.get(a["name"], {}), {p["name"]: row_of(p) for p in a["params"]}
        faults += [f"{a['name']}, {name}: {rows.get(name)} on the page, {params.get(name)} in the registry"
                   for name in sorted(set(rows) | set(params)) if rows.get(name) != params.get(name)]
    return faults


def members(header, struct):
    """The fields of a struct, or the virtual functions of a class that users implement."""
    body = re.sub(r"//.*", "", re.search(rf"(?ms)^(?:struct|class) {struct} {{\n(.*?)^}};", header)[1])
    calls = re.findall(r"virtual \w+ (\w+)\(", body)
    declared = re.findall(r"(?m)^  (?!static|using|virtual)[\w:]+(?:<[^;=]*?>)? (\w[^;]*);", body)
    return set(calls) or {re.match(r"\w+", part)[0] for one in declared for part in one.split(", ")}


def pages():
    return {page: (SOURCE / page).read_text() for page in PAGES}


def all_blocks():
    return [block for page, text in pages().items() for block in blocks_of(page, text)]


def here(command):
    """The command with the paths of this build."""
    command = re.sub(r"build/(release|test)/bin/", f"{BINARY}/bin/", command)
    return re.sub(r"(^|[ |;&(])lpc ", rf"\1{BINARY}/bin/lpc ", command)


def run(command):
    return subprocess.run(["bash", "-ec", here(command)], cwd=SCRATCH, capture_output=True, text=True,
                          env={**os.environ, **({"LPC_PYTHON": REPORT_PYTHON} if REPORT_PYTHON else {})})


_helps = {}


def help_of(subcommand):
    if subcommand not in _helps:
        told = run(f"lpc {subcommand} --help")
        _helps[subcommand] = told.stdout if told.returncode == 0 else ""
    return _helps[subcommand]


class Docs(unittest.TestCase):
    def setUp(self):
        shutil.rmtree(SCRATCH, ignore_errors=True)
        SCRATCH.mkdir(parents=True)
        for folder in ("tests", "algorithms", "framework", "oracles", "docs"):
            (SCRATCH / folder).symlink_to(SOURCE / folder)
        (SCRATCH / "bench.json").write_text('{"context": {}, "benchmarks": []}')  # as lpc-bench would write it

    def test_every_fence_says_what_it_holds(self):
        for block in all_blocks():
            self.assertIn(block.language, LANGUAGES, block.where())
            if block.language in ("toml", "json", "cpp", "cmake"):
                self.assertTrue(block.name, f"{block.where()}: the name of the file")

    def test_exceptions_are_of_commands_that_are_there(self):
        commands = {c for block in all_blocks() if block.language == "sh" for c in block.commands()}
        for command in [*NOT_RUN, *INSTEAD, *SHORTER, *EXIT_CODE]:
            self.assertIn(command, commands)
        sections = {(block.page, block.section) for block in all_blocks()}
        for section in ELSEWHERE:
            self.assertIn(section, sections)

    def test_commands_work_on_the_files_of_the_pages(self):
        ran, blocks = 0, [block for block in all_blocks() if (block.page, block.section) not in ELSEWHERE
                          and (block.page not in FIRST) == OTHERS]
        reports = [c for block in blocks for c in block.commands() if block.language == "sh" and " report " in c]
        for block in blocks:
            with self.subTest(block.where()):
                self.assertNotIn(block.language, ("cpp", "cmake"), "nobody compiles it")
                if block.language in ("toml", "json") and block.name != "axes":
                    (SCRATCH / block.name).write_text(block.text)
                commands = block.commands() if block.language == "sh" else []
                if block.language == "toml" and block.name == "axes":
                    (SCRATCH / "axes.toml").write_text(PART_OF_A_SWEEP + block.text)
                    commands = ["lpc sweep ./axes.toml --dry-run"]
                if block.language == "text" and block.name == "pipeline":
                    commands = [f"lpc run box_drop --pipeline '{block.text.strip()}'"]
                for command in commands:
                    self.assertEqual(option_faults(command, help_of) if "lpc " in command else [], [], command)
                    if command in NOT_RUN or (SINGLE.search(command) and not HAS_SINGLE):
                        continue
                    if " report " in command and not REPORT_PYTHON:
                        continue
                    if command in reports:
                        reports.remove(command)
                        if command in reports and not DEEP:
                            continue  # only its last occurrence is drawn, when its store is fullest
                    done = run(INSTEAD.get(command, command) if DEEP else SHORTER.get(command, INSTEAD.get(command, command)))
                    self.assertEqual(done.returncode, EXIT_CODE.get(command, 0),
                                     f"{command}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
                    ran += 1
        self.assertGreater(ran, 12)

    def test_options_in_prose_exist(self):
        found = 0
        for page, text in pages().items():
            for command in inline_commands(text):
                self.assertEqual(option_faults(command, help_of), [], f"{page}: {command}")
                found += 1
        self.assertGreater(found, 8)

    def test_runs_of_the_table_of_2009_start(self):
        told = {command for command in inline_commands(pages()["docs/heritage.md"]) if re.match(r"lpc run \w", command)}
        self.assertGreater(len(told), 20)
        for command in told:
            done = run(re.sub(r" --steps \d+", "", command) + " --steps 1")
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")


class Tables(unittest.TestCase):
    """Compares the numbers and names on pages of parts with the registry and the headers."""

    def setUp(self):
        SCRATCH.mkdir(parents=True, exist_ok=True)

    def test_parameters_are_those_of_the_registry(self):
        for stage, page in [("joint", "docs/joints.md"), ("force", "docs/forces.md")]:
            algorithms = json.loads(run(f"lpc list --json --stage {stage}").stdout)["algorithms"]
            text = (SOURCE / page).read_text()
            kinds = text[text.index("\n## The kinds\n"):]
            kinds = kinds[:kinds.index("\n## ", 1)]
            self.assertEqual(parameter_faults(kinds, algorithms), [], page)
            self.assertGreater(sum(len(a["params"]) for a in algorithms), 15)

    def test_shapes_are_those_of_the_registry(self):
        rows = tables_of((SOURCE / "docs/shapes.md").read_text(), "## ")["Shapes of one part"]
        told = {row[0].strip("`"): (row[1], set(re.findall(r"`(\w+)`", row[2]))) for row in rows}
        shapes = json.loads(run("lpc list --json").stdout)["shapes"]
        self.assertEqual(set(told), {s["name"] for s in shapes})
        for s in shapes:
            dimensions, sizes = told[s["name"]]
            self.assertEqual(dimensions, ", ".join(map(str, s["dimensions"])), s["name"])
            self.assertLessEqual(set(s["sizes"]), sizes, s["name"])

    def test_every_field_and_call_is_there(self):
        reader = "".join(f.read_text() for f in sorted(SOURCE.glob("experiments/trial/scene/scene_*.cpp")))
        for struct, header, page, section in [
                ("ShapeDef", "shape/shape_def.h", "shapes.md", "A shape on a body"),
                ("BodyDef", "problem/body.h", "shapes.md", "A body"),
                ("JointDef", "problem/joint.h", "joints.md", "A joint"),
                ("ForceDef", "problem/force.h", "forces.md", "A force"),
                ("ContactListener", "world/contact_listener.h", "listeners.md", "When each call comes")]:
            rows = tables_of((SOURCE / "docs" / page).read_text(), "## ")[section]
            told = {name for row in rows for name in re.findall(r"`(\w+)", row[0])}
            self.assertEqual(told, members((SOURCE / "framework" / header).read_text(), struct), struct)
            if struct != "ContactListener":  # their names in scenes
                for key in {key for row in rows for key in re.findall(r"`(\w+)`", row[1])}:
                    self.assertIn(f'"{key}"', reader, f"{page}: {key}")


class ThisTest(unittest.TestCase):
    """Faults that it must find, on a page made for the test."""

    PAGE = ("# A\n## B\n- one\n\n  ```sh\n  lpc list \\\n    --all   # so\n  ```\n\n"
            "`lpc list\n--json`, `lpc`\n```toml x.toml\na = 1\n```\n")

    def test_blocks_and_commands(self):
        first, second = blocks_of("p.md", self.PAGE)
        self.assertEqual((first.language, first.section, first.line), ("sh", "B", 5))
        self.assertEqual(first.commands(), ["lpc list --all"])
        self.assertEqual((second.language, second.name, second.text), ("toml", "x.toml", "a = 1\n"))
        self.assertEqual(inline_commands(self.PAGE), ["lpc list --json"])

    def test_wrong_rows_are_found(self):
        page = "## The kinds\n### rod\nIt is.\n\n| p | | | | |\n| - | - | - | - | - |\n| `n` | m | 1 | 0 to 1e+12 | a \"b\" |\n"
        rod = {"name": "rod", "params": [{"name": "n", "type": "real", "unit": "m", "default": "1", "range": [0, 1e12]}]}
        self.assertEqual(parameter_faults(page, [rod]), [])
        for wrong in ({"default": "2"}, {"range": [0, 1]}, {"unit": "s"}, {"name": "k"}):
            self.assertTrue(parameter_faults(page, [{**rod, "params": [{**rod["params"][0], **wrong}]}]), wrong)
        self.assertEqual(parameter_faults(page, []), ["rod: there is none"])
        self.assertEqual(parameter_faults(page, [rod, {"name": "gear", "params": []}]), ["gear: not on the page"])
        struct = "struct A {\n  int a = 1, b = 2;  // c = 3;\n  std::vector<A> d{};\n  static A of();\n};\n"
        self.assertEqual(members(struct, "A"), {"a", "b", "d"})
        self.assertEqual(members("class A {\n  virtual ~A() = default;\n  virtual void f(int) {}\n  int x;\n};\n", "A"), {"f"})

    def test_wrong_options_are_found(self):
        told = {"list": "--json  as JSON"}.get
        self.assertEqual(option_faults("lpc list --json", told), [])
        self.assertEqual(option_faults("lpc --plugin x.so list --stage a", told), ["'lpc list' has no --stage"])
        self.assertEqual(option_faults("lpc lists", told), ["there is no 'lpc lists'"])


if __name__ == "__main__":
    # Tests that read pages without running commands cover all pages, and run once.
    unittest.main(argv=[sys.argv[0], *["Docs.test_commands_work_on_the_files_of_the_pages"][:OTHERS]])
