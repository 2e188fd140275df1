# SPDX-License-Identifier: Zlib
"""What sentences about data are made of: names that are joined, verbs that agree with how many they are, ranges, and clauses, of
which an empty one is left out. Where the data do not tell, a clause is empty: `told and f"..."`."""

import load

IRREGULAR = {"have": "has", "are": "is", "do": "does", "go": "goes"}


def plural(count, one, many=None):
    return f"{count} {one if count == 1 else many or one + 's'}"


def listing(names):
    names = list(names)
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1] if names else "none"


def methods(names, everyone):
    """Method labels in a sentence; a whole family of three or more (`catto+...`) is named once."""
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
    """The verb of so many: `fails` of one, `fail` of several."""
    return many if count != 1 else one or IRREGULAR.get(many) or many + "s"


def does(names, many, everyone=(), one=""):
    """Who does it: "a fails", "a and b fail", of `everyone` "all 3 catto variants fail"."""
    names = list(names)
    return f"{methods(names, everyone)} {verb(len(names), many, one)}"


def span(*ends):
    """Texts of the ends of a range: "1 to 3"; once where they read alike."""
    return " to ".join(dict.fromkeys(ends))


def clauses(*parts, between="; "):
    """Those that say something."""
    return between.join(part for part in parts if part)


def sentence(text):
    """With a capital and a full stop."""
    return f"{text[0].upper()}{text[1:]}."
