# SPDX-License-Identifier: Zlib
"""The failures that methods declare (info().failures), and links to them from the table of failed trials."""

import html
import re

COLUMN = "declared failures of"  # of the table of failed trials: the methods of the trial that declare any


def methods(store, key):
    """The methods of a trial that declare failures, such as "velocity catto, position linear"."""
    return ", ".join(" ".join(method) for method in sorted(store.declared_by(key)))


def linked(text):
    """The same as HTML, each method linked to its declared failures."""
    return ", ".join(f'<a href="#{anchor(name)}">{html.escape(name)}</a>' for name in text.split(", ") if name)


def anchor(name):
    return "declared-" + re.sub(r"\W+", "-", name)


def section(store, failed):
    """One entry per method that the table of failed trials names: [{id, name, failures}], each failure with all its tests."""
    wanted = {name for text in failed[COLUMN] for name in text.split(", ")}
    found = []
    for entry in store.algorithms:
        name = f"{entry['stage']} {entry['name']}"
        if name in wanted:
            found.append({"id": anchor(name), "name": name, "failures": _merged(entry)})
    return sorted(found, key=lambda method: method["name"])


def _merged(entry):
    rows = {}
    for failure in entry["failures"]:
        dimensions = tuple(failure.get("dimensions", ()))
        where = "" if dimensions == tuple(entry.get("dimensions", dimensions)) else " ".join(f"{d}D" for d in dimensions)
        rows.setdefault((failure["when"], failure["symptom"], where), []).append(failure["test"])
    return [{"when": when, "symptom": symptom, "where": where, "tests": ", ".join(tests)}
            for (when, symptom, where), tests in rows.items()]
