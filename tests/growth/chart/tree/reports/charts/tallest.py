# SPDX-License-Identifier: Zlib
"""The greatest height of any body, by method."""

import math

import numpy as np
import pandas as pd

from chart import Chart, Needs, of_sweeps
from style import plt, si

SECTION = "Who throws bodies up?"


@of_sweeps("tallest", 35, SECTION, Needs("world", methods=(2, math.inf), series=("height",)),
           "Highest body", "No sweep of several methods is in this store.", "resolvers")
def tallest(context, cells):
    rows = []
    for _, cell in cells[cells["key"].notna()].iterrows():
        heights = context.store.series(cell["key"], "height")
        rows.append((cell["method"], round(float(np.max(heights)), 2)))
    table = pd.DataFrame(rows, columns=["method", "height"])
    figure, ax = plt.subplots(figsize=(6, 2))
    looks = context.looks(cells)
    for y, (method, height) in enumerate(rows):
        ax.plot([height], [y], ls="none", **looks(method))
    ax.set_yticks(range(len(rows)))
    ax.set_yticklabels([context.name(method) for method, _ in rows])
    figure.subplots_adjust(left=0.3, bottom=0.2)
    sweep = cells["sweep"].iloc[0]
    text = f"The highest body was at {si(table['height'].max(), 'm')}." if rows else "Nothing was run."
    return [Chart(f"{sweep}_tallest", SECTION, "Highest body", text, sweep, figure, table)]
