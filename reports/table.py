# SPDX-License-Identifier: Zlib
"""Tables: as CSV and JSON with raw SI numbers, as HTML and markdown with the same numbers rounded.

A column of numbers is titled "quantity [unit]", with an SI unit; texts and counts have no unit. Numbers are formatted only when a
page is written, so a table holds the numbers that the chart was drawn from.
"""

import html
import json
import math
import numbers
import re

import pandas as pd

from style import si

# Units of metrics that are not SI: how many make the SI unit, and the SI unit.
SI = {"ms": (1e3, "s"), "us": (1e6, "s"), "ns": (1e9, "s")}


def quantity(title, unit, values):
    """{title of the column: its numbers} in SI; NaN for an unknown value."""
    parts, unit = SI.get(unit, (1.0, unit))
    return {f"{title} [{unit}]": [math.nan if v is None else float(v) / parts for v in values]}


def heading(name):
    """(title, unit) of a column; an empty unit for a column without one."""
    found = re.fullmatch(r"(.+) \[([^\[\]]+)\]", str(name))
    return (found[1], found[2]) if found else (str(name), "")


def unknown(value):
    return value is None or value is pd.NA or (isinstance(value, numbers.Real) and value != value)


def shown(value, unit):
    """A value as text: empty where it is unknown, a number rounded; zero is 0."""
    if unknown(value):
        return ""
    if isinstance(value, numbers.Real) and unit:
        return si(float(value), unit)
    if isinstance(value, float):
        return f"{value:,.0f}" if math.isfinite(value) and value == int(value) and abs(value) < 1e15 else f"{value:.4g}"
    return str(value)


def to_html(table, linked={}):
    """The whole table, numbers at the right. `linked`: {column: its text as HTML}."""
    headings = [heading(name) for name in table.columns]
    head = "".join(f"<th>{html.escape(title)}</th>" for title, _ in headings)
    cell = {number: linked[name] for number, name in enumerate(table.columns) if name in linked}
    body = []
    for row in table.itertuples(index=False):
        cells = [f"<td{' class=n' if isinstance(value, numbers.Real) else ''}>{cell.get(i, html.escape)(shown(value, unit))}</td>"
                 for i, (value, (_, unit)) in enumerate(zip(row, headings))]
        body.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table>"


def texts(row):
    """The values of a row {title: value} as texts; an infinity may be a text, as in JSON."""
    found = []
    for name, value in row.items():
        unit = heading(name)[1]
        found.append(shown(float(value) if unit and isinstance(value, str) else value, unit))
    return found


def to_markdown(rows):
    """A table of rows {title: value} for pages of docs/, with numbers rounded; empty where there are none."""
    if not rows:
        return ""
    cell = lambda text: text.replace("|", "\\|")  # noqa: E731
    lines = [[heading(name)[0] for name in rows[0]], ["---"] * len(rows[0]), *map(texts, rows)]
    return "".join(f"| {' | '.join(map(cell, line))} |\n" for line in lines)


def records(table):
    """Rows {title of the column: value} for JSON; unknown is null, infinite is the text "inf" or "-inf"."""
    return [dict(zip(map(str, table.columns), map(_plain, row))) for row in table.itertuples(index=False, name=None)]


def to_csv(table, target):
    """Writes CSV with all digits of a number, so that it reads back unchanged; unknown is empty."""
    table.to_csv(target, index=False)


def json_of(table, about):
    """{**about, columns: [{title, unit}], rows: [[value]]}: unknown is null, infinite is the text "inf" or "-inf"."""
    described = [dict(zip(("title", "unit"), heading(name))) for name in table.columns]
    rows = [[_plain(value) for value in row] for row in table.itertuples(index=False)]
    return json.dumps({**about, "columns": described, "rows": rows}, ensure_ascii=False, allow_nan=False, indent=1) + "\n"


def to_json(table, about, target):
    target.write_text(json_of(table, about), encoding="utf-8")


def _plain(value):
    if unknown(value):
        return None
    if not isinstance(value, numbers.Real):
        return str(value)
    if isinstance(value, numbers.Integral):
        return int(value)
    return float(value) if math.isfinite(value) else str(float(value))
