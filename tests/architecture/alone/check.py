# SPDX-License-Identifier: Zlib
"""Each source of the product compiles alone: batches (LPC_UNITE) hide an #include that an earlier file of the batch has. Run by
ctest: check.py SOURCE_DIR BINARY_DIR COMPILER. It configures the project without batches, takes the compile commands of one
precision, and parses each file with the precompiled headers of BINARY_DIR. tests/run --deep also compiles without them."""

import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

SOURCE, BINARY, COMPILER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
ALONE = BINARY / "alone"
PLANTED = pathlib.Path(__file__).resolve().parent / "planted.cpp"
FOLDERS = ("framework", "algorithms", "oracles", "experiments")


def configure():
    """The compile commands of a build without batches."""
    done = subprocess.run(["cmake", "-G", "Ninja", "-S", SOURCE, "-B", ALONE, f"-DCMAKE_CXX_COMPILER={COMPILER}",
                           "-DCMAKE_BUILD_TYPE=Release", "-DLPC_ENABLE_ASSERT=ON", "-DLPC_UNITE=OFF",
                           "-DLPC_PRECISIONS=f64", "-DCMAKE_CXX_COMPILER_LAUNCHER=", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return json.loads((ALONE / "compile_commands.json").read_text())


def parse_only(command, file):
    """The command as one that writes nothing, and reads the precompiled headers of the build that is there."""
    words = iter(shlex.split(command))
    out = []
    for word in words:
        if word in ("-o", "-c"):
            next(words)
        else:
            out.append(word.replace(str(ALONE) + "/", str(BINARY) + "/") if word.endswith("cmake_pch.hxx") else word)
    return [*out, "-fsyntax-only", str(file)]


def faults(command, file):
    done = subprocess.run(parse_only(command, file), cwd=BINARY, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr


def main():
    commands = {}
    for entry in configure():
        path = pathlib.Path(entry["file"])
        if path.is_relative_to(SOURCE) and path.relative_to(SOURCE).parts[0] in FOLDERS:
            commands.setdefault(path, entry["command"])  # of two targets with one source, one is enough
    if len(commands) < 200:
        sys.exit(f"{len(commands)} sources of the product; expected at least 200")
    said = faults(commands[SOURCE / "framework" / "shape.cpp"], PLANTED)
    if not re.search(r"planted\.cpp:\d+:\d+: error: .*StateInvariants", said):
        sys.exit(f"{PLANTED} lacks an #include, and the compiler does not say so:\n{said}")
    wrong = [(path, said) for path, command in sorted(commands.items()) if (said := faults(command, path))]
    for path, said in wrong:
        print(f"{path.relative_to(SOURCE)} does not compile alone:\n{said}")
    user = sum(os.times()[2:4])
    print(f"{len(commands) - len(wrong)} of {len(commands)} sources compile alone ({user:.0f} processor seconds)")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
