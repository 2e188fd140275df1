# SPDX-License-Identifier: Zlib
"""Runs files of tests, each in a process of its own that has matplotlib, pandas and the report from the start: to import them
takes a second, which is more than most of these tests do. Run by ctest, or python3 reports/tests/each.py FILE..."""

import os
import runpy
import sys
from pathlib import Path

import jinja2  # noqa: F401
import matplotlib
import pandas  # noqa: F401

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402, F401

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chart  # noqa: E402
import docs_page  # noqa: E402, F401
import make  # noqa: E402, F401
import pages  # noqa: E402, F401
import readme  # noqa: E402, F401
import with_store  # noqa: E402, F401

chart.kinds()


def run(file):
    """The exit code of `python3 FILE`."""
    print(file, file=sys.stderr, flush=True)
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    code = 1
    try:
        sys.argv = [file]
        runpy.run_path(file, run_name="__main__")
        print("it has no tests", file=sys.stderr)  # or it would have ended by SystemExit
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except BaseException:  # noqa: B902
        sys.excepthook(*sys.exc_info())
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def main():
    failed = [file for file in sys.argv[1:] if run(file) != 0]
    print(f"failed: {', '.join(failed)}" if failed else f"all {len(sys.argv) - 1} passed", file=sys.stderr)
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
