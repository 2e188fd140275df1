# SPDX-License-Identifier: Zlib
"""What came of all that was planned: no cell vanishes."""

from matplotlib.patches import Patch

import coverage
from chart import Chart, listing, of_store, plural
from load import NOT_RUN, SEVERITY
from style import OUTCOMES, WIDTH, plt

SECTION = "Coverage: what was planned, what came of it?"


@of_store("coverage", 120, SECTION, "What came of the planned trials", "Nothing was planned in this store.")
def coverage_of_plan(context):
    table = coverage.trials(context.store)
    if not len(table):
        return []
    outcomes = [o for o in SEVERITY + [NOT_RUN] if (table["outcome"] == o).any()]
    outcomes += sorted(set(table["outcome"]) - set(outcomes))
    sweeps = list(dict.fromkeys(table["sweep"]))
    height = 0.75 + 0.36 * len(sweeps)
    figure, ax = plt.subplots(figsize=(WIDTH, height))
    figure.subplots_adjust(left=2.1 / WIDTH, right=1 - 2.6 / WIDTH, top=1 - 0.15 / height, bottom=0.55 / height)
    for y, sweep in enumerate(sweeps):
        part = table[table["sweep"] == sweep]
        at = 0.0
        for outcome in outcomes:
            share = 100 * float((part["outcome"] == outcome).sum()) / len(part)
            if share:
                ax.barh(y, share, left=at, color=OUTCOMES.get(outcome, ("#FF00FF", ""))[0], edgecolor="#888888", lw=0.5,
                        hatch="///" if outcome == NOT_RUN else None, height=0.7)
            at += share
        ax.text(101, y, f"{int(_ran(part).sum())} of {len(part)}", va="center", fontsize=8.5)
    ax.set_xlim(0, 100)
    ax.set_ylim(len(sweeps) - 0.5, -0.5)
    ax.set_yticks(range(len(sweeps)))
    ax.set_yticklabels(sweeps)
    ax.set_xlabel("share of the planned trials (%); how many ran of how many planned at the right")
    ax.grid(False)
    handles = [Patch(facecolor=OUTCOMES.get(o, ("#FF00FF", ""))[0], edgecolor="#888888", label=o,
                     hatch="///" if o == NOT_RUN else None) for o in outcomes]
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(1 - 1.65 / WIDTH, 1 - 0.1 / height), borderaxespad=0,
                  labelspacing=0.35)
    ran = int(_ran(table).sum())
    ok = int((table["outcome"] == "ok").sum())
    kinds = [f"{int((table['outcome'] == o).sum())} {o}" for o in outcomes if o != "ok"]
    text = (f"{ran} of {plural(len(table), 'planned trial')} ran, {ok} of them ok"
            + (f"; not ok: {listing(kinds)}." if kinds else "."))
    if context.store.superseded:
        text += f" {plural(context.store.superseded, 'older plan')} of the same cells, made with other code, left out."
    counts = table.groupby(["sweep", "outcome"], sort=False).size().unstack(fill_value=0).reindex(columns=outcomes)
    counts.insert(0, "planned", counts.sum(axis=1))
    return [Chart("coverage", SECTION, "What came of the planned trials", text, "", figure, counts.reset_index(),
                  note="What each outcome means stands under “All that is not ok”. Those that ended early, as by "
                       "collapsing, ran; those that are unsupported did not.")]


def _ran(table):
    return ~table["outcome"].isin((NOT_RUN, "unsupported"))
