# SPDX-License-Identifier: Zlib
"""Charts of a store that a test fills."""

import tempfile
from pathlib import Path

import chart
import load
import overlap
import style
import synthetic_store
import table
import undrawn


def row(made, name):
    """{title: text for eyes} of the first row of a finding's table that has this value."""
    rows = [entry for entry in made.finding.rows() if name in entry.values()]
    assert rows, f"no row {name} in: {made.finding.text()}"
    return {table.heading(title)[0]: text for title, text in zip(rows[0], table.texts(rows[0]))}


class WithStore(undrawn.Undrawn):
    def context(self, fill):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(style.plt.close, "all")
        maker = synthetic_store.Maker(Path(folder.name) / "store.db")
        fill(maker)
        maker.close()
        return chart.Context(load.Store(Path(folder.name) / "store.db"))

    def made(self, kind, fill):
        found = chart.made(kind, self.context(fill))
        for c in found:
            if c.figure is not None and self.draws:
                self.assertEqual(overlap.overlaps(c.figure), ([], []), c.id)
        return found
