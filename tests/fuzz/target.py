# SPDX-License-Identifier: Zlib
"""Runs a libFuzzer target on inputs that once failed (kept/NAME/), then on damaged shipped files. By ctest, or longer by hand:
target.py PROGRAM SOURCE_DIR WORK_DIR [libFuzzer's options, such as -max_total_time=3600]."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import shipped

MOST_BYTES = {"world_load_fuzz": 60000, "scene_fuzz": 4096, "sweep_fuzz": 4096, "cases_fuzz": 8192, "spec_fuzz": 1024,
              "expression_fuzz": 256, "pair_query_fuzz": 128}


def write_seeds(program, source, folder):
    of = {"spec_fuzz": shipped.pipelines, "expression_fuzz": shipped.expressions, "scene_fuzz": shipped.small_scenes,
          "sweep_fuzz": lambda _: [shipped.SMALL_SWEEP.encode()], "cases_fuzz": shipped.cases,
          "pair_query_fuzz": lambda _: [bytes(range(k, k + 40)) for k in range(0, 200, 3)]}
    if program.name == "world_load_fuzz":
        subprocess.run([program, "--seeds", folder], check=True)
        return
    for number, seed in enumerate(of[program.name](source)):
        if len(seed) <= MOST_BYTES[program.name]:
            (folder / str(number)).write_bytes(seed)


def main():
    program, source, work = (Path(p).resolve() for p in sys.argv[1:4])
    kept = sorted((source / "tests/fuzz/kept" / program.name).glob("*"))
    work = work / program.name
    shutil.rmtree(work / "corpus", ignore_errors=True)
    (work / "corpus").mkdir(parents=True)
    write_seeds(program, source, work / "corpus")
    limits = ["-timeout=120", "-rss_limit_mb=2048", f"-artifact_prefix={work}/", "-print_final_stats=1"]
    if kept:
        done = subprocess.run([program, *limits, *kept], check=False)
        if done.returncode:
            return 1
    seed = os.environ.get("LPC_TEST_SEED", "1")
    options = sys.argv[4:] or [f"-runs={int(os.environ.get('LPC_FUZZ_RUNS', '8000'))}", f"-seed={int(seed) % 2**32}"]
    return subprocess.run([program, *limits, f"-max_len={MOST_BYTES[program.name]}", *options, work / "corpus"],
                          check=False).returncode


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
