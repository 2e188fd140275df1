# SPDX-License-Identifier: Zlib
"""What every call of the program must satisfy, whatever its input: exit code 0, 1 or 2; for a mistake a one-line message and no
file; no signal; bounded time and memory; no process left running."""

import ctypes
import dataclasses
import os
import resource
import select
import signal
import subprocess
import tempfile
import time
from pathlib import Path

MOST_TOLD = 2000  # characters of a message


@dataclasses.dataclass
class Limits:
    cpu: int = 10          # s of processor time of each process, independent of load
    wall: float = 120      # s by the clock, for a process that sleeps
    memory: int = 2 << 30  # bytes
    address_space: bool = True  # False: a sanitizer reserves far more than it uses
    grace: float = 5       # s: workers end shortly after their parent


@dataclasses.dataclass
class Seen:
    code: int = -1
    signal: int = 0
    out: bytes = b""
    err: bytes = b""
    late: bool = False      # by the clock
    left: str = ""          # a process that outlived the call
    memory: int = 0         # bytes, of the largest process
    before: dict = dataclasses.field(default_factory=dict)  # files of the folder
    after: dict = dataclasses.field(default_factory=dict)


def adopt_orphans():
    """Orphaned processes become children of this process, so that they are found."""
    PR_SET_CHILD_SUBREAPER = 36
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def files_in(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


def children():
    return [int(pid) for task in Path("/proc/self/task").iterdir() for pid in (task / "children").read_text().split()]


def end_orphans(grace):
    """Kills processes that still run after the grace period, and returns the name of one."""
    until, name = time.monotonic() + grace, ""
    while pids := children():
        if time.monotonic() > until:
            name = name or (Path("/proc") / str(pids[0]) / "comm").read_text().strip()
            for pid in pids:
                os.kill(pid, signal.SIGKILL)
        while any(os.waitpid(pid, os.WNOHANG)[0] for pid in children()):
            pass
        time.sleep(0.005)
    return name


def run(argv, folder, limits, environment=None):
    """Runs a command in the folder. This process must have no other children meanwhile."""
    seen = Seen(before=files_in(folder))

    def restrict():
        resource.setrlimit(resource.RLIMIT_CPU, (limits.cpu, limits.cpu + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if limits.address_space:
            resource.setrlimit(resource.RLIMIT_AS, (limits.memory, limits.memory))

    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = subprocess.Popen(argv, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, preexec_fn=restrict,
                                 start_new_session=True, env={**os.environ, **(environment or {})})
        handle = os.pidfd_open(child.pid)
        seen.late = not select.select([handle], [], [], limits.wall)[0]
        os.close(handle)
        if seen.late:
            child.kill()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = 0  # already waited for
        seen.memory = usage.ru_maxrss * 1024
        seen.signal = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        seen.code = os.WEXITSTATUS(status) if os.WIFEXITED(status) else -1
        seen.left = end_orphans(limits.grace)
        for stream, name in ((out, "out"), (err, "err")):
            stream.seek(0)
            setattr(seen, name, stream.read(1 << 24))
    seen.after = files_in(folder)
    return seen


def first_line(text):
    return text.decode("utf-8", "replace").strip().split("\n")[0][:160]


def message_fault(err):
    """What is wrong with the message about a mistake."""
    try:
        text = err.decode("utf-8")
    except UnicodeDecodeError:
        return "bytes that are no text in the message"
    if text.count("\n") != 1 or not text.endswith("\n"):
        return f"{text.count(chr(10))} lines where one is owed"
    if len(text) > MOST_TOLD:
        return f"a message of {len(text)} characters"
    if any(ord(c) < 32 or 127 <= ord(c) < 160 for c in text[:-1]):
        return "control characters in the message"
    return "" if text.startswith("lpc: ") and len(text) > len("lpc: \n") else "the message does not begin with 'lpc: '"


def fault(seen, limits, may_write=(), may_change=()):
    """Empty if the call satisfies all rules. `may_write`: requested files, and folders with a final /; "*": any.
    `may_change`: stores, which keep trials that finished before a mistake was found."""
    if seen.late:
        return f"still ran after {limits.wall:g} s"
    if seen.signal in (signal.SIGXCPU, signal.SIGKILL):
        return f"took more than {limits.cpu} s of processor time"
    if seen.signal:
        return f"signal {seen.signal}: {first_line(seen.err)}"
    if seen.code not in (0, 1, 2):
        return f"exit code {seen.code}: {first_line(seen.err)}"
    if seen.left:
        return f"left a process running: {seen.left}"
    if seen.memory > limits.memory:
        return f"took {seen.memory >> 20} MiB"
    if seen.code == 2 and (told := message_fault(seen.err)):
        return f"exit code 2 and {told}"
    # A run that failed says so in its output: a line on stderr is an unexpected exception.
    notes = [line for line in seen.err.split(b"\n") if line and not line.startswith(b"lpc: sweep ")]
    if seen.code == 1 and notes:
        return f"exit code 1 and an unexpected end: {first_line(seen.err)}"
    if seen.code == 1 and not seen.out:
        return "exit code 1 and no word why"
    if b"\n" in seen.out and (outcomes := seen.out.rstrip().rsplit(b"\n", 1)[-1]) and b" crash" in outcomes:
        return f"a trial crashed: {first_line(outcomes)}"

    def asked(name):
        return seen.code != 2 and any(w in (name, "*") or (w.endswith("/") and name.startswith(w)) for w in may_write)

    for name in sorted(seen.after.keys() - seen.before.keys()):
        if not asked(name):
            return f"left {name} behind (exit code {seen.code})"
    for name, content in seen.before.items():
        if name not in seen.after:
            return f"{name} is gone"
        if seen.after[name] != content and name not in may_change:
            return f"{name} has changed (exit code {seen.code})"
    return ""
