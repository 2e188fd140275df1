# SPDX-License-Identifier: Zlib
"""Imports of `lpc import-benchmark`, as far as they can be drawn."""
import json
import math


def read(imported, text):
    """An import with a `context` and the `benchmarks` that a chart can draw; `faults` names the others."""
    try:
        data = json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        data = None
    found = data.get("benchmarks") if isinstance(data, dict) else None
    if not isinstance(found, list):
        return {"context": {}, "benchmarks": [], "faults": [f"The import of {imported} is not of Google Benchmark."]}
    context = data["context"] if isinstance(data.get("context"), dict) else {}
    load = context.get("load_avg", [])
    if not (isinstance(load, list) and all(_is_number(x) for x in load)):
        context = {name: value for name, value in context.items() if name != "load_avg"}
    bad = [number for number, entry in enumerate(found) if not _is_benchmark(entry)]
    faults = [f"{len(bad)} of {len(found)} entries imported at {imported} are no benchmarks; the first is number {bad[0]}."
              ] if bad else []
    return {"context": context, "benchmarks": [entry for entry in found if _is_benchmark(entry)], "faults": faults}


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and 0 <= value < math.inf


def _is_benchmark(entry):
    """Whether `lpc import-benchmark` takes it."""
    texts = ("name", "run_name", "run_type", "aggregate_name", "error_message", "time_unit")
    if not isinstance(entry, dict) or not all(isinstance(entry.get(name, ""), str) for name in texts) or "name" not in entry:
        return False
    if any(len(entry.get(name, "").encode()) > 300 for name in ("name", "run_name")):
        return False
    drawn = entry.get("run_type", "iteration") == "iteration" or entry.get("aggregate_name") == "median"
    return not drawn or entry.get("error_occurred") is True or (
        all(_is_number(entry.get(clock)) for clock in ("cpu_time", "real_time")) and
        entry.get("time_unit", "ns") in ("ns", "us", "ms", "s"))
