# SPDX-License-Identifier: Zlib
"""Parts of sentences about data: lists of names, verbs that agree with their number, ranges, and clauses. An empty clause is left
out: `told and f"..."`."""

import load

IRREGULAR = {"have": "has", "are": "is", "do": "does", "go": "goes"}


def plural(count, one, many=None):
    return f"{count} {one if count == 1 else many or one + 's'}"


def listing(names):
    names = list(names)
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1] if names else "none"


def methods(names, everyone):
    """A list of method labels; a whole family of three or more (`catto+...`) is named once."""
    names, said, done = list(names), [], set()
    for name in names:
        alike = [m for m in everyone if load.family(m) == load.family(name)]
        if len(alike) >= 3 and all(m in names for m in alike):
            if alike[0] not in done:
                said.append(f"all {len(alike)} {load.family(name)} variants")
            done |= set(alike)
        else:
            said.append(name)
    return listing(said)


def some(names, everyone=(), most=2):
    """As methods(), short enough for a headline: of many the first, and how many more there are."""
    names = list(names)
    text = methods(names, everyone)
    if text.count(",") + (" and " in text) < most:
        return text
    return listing([*names[:most], f"{len(names) - most} more"]) if len(names) > most else listing(names)


def verb(count, many, one=""):
    """The verb for a number of subjects: `fails` for one, `fail` for several."""
    return many if count != 1 else one or IRREGULAR.get(many) or many + "s"


def span(*ends):
    """A range from the texts of its ends: "1 to 3"; one text where both are equal."""
    return " to ".join(dict.fromkeys(ends))


def clauses(*parts, between="; "):
    """The clauses that are not empty, joined."""
    return between.join(part for part in parts if part)
