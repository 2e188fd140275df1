# SPDX-License-Identifier: Zlib
"""Each source of the product must compile alone: in a batch (LPC_UNITE), a file may use an #include of an earlier file.
ctest runs check.py SOURCE_DIR BINARY_DIR COMPILER. It takes the compile commands of a build without batches. With the precompiled
headers of BINARY_DIR it parses each file that is not the first of its batch; a first file is already compiled alone.
tests/run --deep also compiles without precompiled headers."""

import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

SOURCE, BINARY, COMPILER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
ALONE = BINARY / "alone"
PLANTED = pathlib.Path(__file__).resolve().parent / "planted.cpp"


def hidden():
    """The files of the product that are not the first of their batch."""
    found = set()
    for folder in (".", "oracles", "experiments", "experiments/bench", "experiments/sandbox"):
        for batch in (BINARY / folder / "CMakeFiles").glob("*.dir/Unity/*_cxx.cxx"):
            found.update(map(pathlib.Path, re.findall(r'(?m)^#include "(.*)"$', batch.read_text())[1:]))
    return {file for file in found if file.exists()}  # batches may list removed files


def configure():
    """The compile command of each file in a build without batches."""
    shutil.rmtree(ALONE, ignore_errors=True)  # with the cache of another compiler CMake drops the options below
    done = subprocess.run(["cmake", "-G", "Ninja", "-S", SOURCE, "-B", ALONE, f"-DCMAKE_CXX_COMPILER={COMPILER}",
                           "-DCMAKE_BUILD_TYPE=Release", "-DLPC_ENABLE_ASSERT=ON", "-DLPC_UNITE=OFF", "-DLPC_BUILD_BENCHMARKS=ON",
                           "-DLPC_PRECISIONS=f64", "-DCMAKE_CXX_COMPILER_LAUNCHER=",
                           "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return {pathlib.Path(entry["file"]): entry["command"]
            for entry in json.loads((ALONE / "compile_commands.json").read_text())}


def parse_only(command, file):
    """The command without output, with the generated files and the precompiled headers of the build in BINARY."""
    words = iter(shlex.split(command))
    out = []
    for word in words:
        if word in ("-o", "-c"):
            next(words)
        else:
            out.append(word.replace(str(ALONE) + "/", str(BINARY) + "/"))
    return [*out, "-fsyntax-only", str(file)]


def faults(command, file):
    done = subprocess.run(parse_only(command, file), cwd=BINARY, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr


def main():
    commands, files = configure(), sorted(hidden())
    if len(files) < 150:
        sys.exit(f"{len(files)} sources of the product stand in batches behind another; expected at least 150")
    said = faults(commands[SOURCE / "framework/shape/shape.cpp"], PLANTED)
    if not re.search(r"planted\.cpp:\d+:\d+: error: .*StateInvariants", said):
        sys.exit(f"{PLANTED} lacks an #include, and the compiler does not say so:\n{said}")
    wrong = [(path, said) for path in files if (said := faults(commands[path], path))]
    for path, said in wrong:
        print(f"{path.relative_to(SOURCE)} does not compile alone:\n{said}")
    print(f"{len(files) - len(wrong)} of {len(files)} sources compile alone ({sum(os.times()[2:4]):.0f} processor seconds)")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
