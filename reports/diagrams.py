#!/usr/bin/env python3
# SPDX-License-Identifier: Zlib
"""Draws three figures of the docs from the source, so that they are always up to date: docs/drawings/folders.svg, the folders of
the code and their includes; docs/drawings/pipeline.svg, the stages in the order of World::step with their methods; and
docs/drawings/classes.svg, the base classes and what derives from them. Needs the standard library only.

usage: reports/diagrams.py [--check]

  --check   writes nothing; exit code 1 where a figure differs from the source

Example: reports/diagrams.py
"""

import re
import sys
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FIGURES = ROOT / "docs" / "drawings"
CHAR, LINE, PAD = 6.8, 16, 10  # px, of the font below
STYLE = ('<style>text{font:11px ui-monospace,Menlo,Consolas,monospace;fill:#222}.h{font-weight:bold}.s{fill:#666}'
         'rect{fill:#f6f6f4;stroke:#999}.p{fill:#e4eef7;stroke:#7aa2c4}path{stroke:#999;fill:none}</style>')


class UserError(Exception):
    pass


def source(path):
    """The text of a file without its comments."""
    text = (ROOT / path).read_text()
    return re.sub(r"//[^\n]*", "", text)


def stages():
    """{enumerator: name} in the order of framework/stage/stages.h."""
    rows = re.findall(r'\{StageKind::(\w+), "(\w+)", "\w+", "(\w*)"\}', source("framework/stage/stages.h"))
    if not rows:
        raise UserError("framework/stage/stages.h: found no rows of kStages; expected {StageKind::NAME, \"name\", ...}")
    return {kind: name for kind, name, _ in rows}


def interfaces():
    """{class: name of its stage}, of the classes with kStage = StageKind::..."""
    names, found = stages(), {}
    for path in sorted((ROOT / "framework").glob("*/*.h")):
        text = source(path.relative_to(ROOT))
        for match in re.finditer(r"class (\w+) : public Stage \{(.*?)kStage = StageKind::(\w+)", text, re.S):
            found[match[1]] = names[match[3]]
    return found


def competitors(stage):
    """Names of the methods in algorithms/STAGE, from their info(); engines are in oracles/engines."""
    folder = ROOT / ("oracles/engines" if stage == "engine" else f"algorithms/{stage}")
    found = []
    for path in sorted(folder.glob("*.cpp")):
        text = source(path.relative_to(ROOT))
        if "LPC_REGISTER(" in text:
            found += re.findall(r'\.name = "(\w+)"', text)[:1]
    return found


def parts(stage):
    """Stages that methods of this stage contain: v.stage("query", query, StageKind::pairQuery, ...)."""
    names = stages()
    kinds = set()
    for path in (ROOT / "algorithms" / stage).glob("*.cpp"):
        kinds |= set(re.findall(r"v\.stage\(\"\w+\", \w+, StageKind::(\w+)", source(path.relative_to(ROOT))))
    return [name for kind, name in names.items() if kind in kinds]


def parts_of_world():
    """{member: class} of the parts of World<D>."""
    found = re.search(r"// Parts[^\n]*\n(.*?)\n\n", (ROOT / "framework/world/world.h").read_text(), re.S)
    members = re.findall(r"(\w+)<D> (m_\w+);", found[1]) if found else []
    if not members:
        raise UserError("framework/world/world.h: found no members NAME<D> m_NAME after `// Parts`")
    return {member: name for name, member in members}


def body_of(name, function):
    """The body of NAME<D>::FUNCTION, from any file of framework/world."""
    for path in sorted((ROOT / "framework/world").glob("*.cpp")):
        text = source(path.relative_to(ROOT))
        match = re.search(name + r"<D>::" + function + r"\([^;{]*\)(?: const)? \{(.*?)\n\}", text, re.S)
        if match:
            return match[1]
    return ""


def order():
    """[(function, stage)] in the order of the last call of each stage in World::step."""
    of, owners = interfaces(), parts_of_world()
    step = body_of("World", "step")

    def named(text):
        return [of[c] for c in re.findall(r"stage<(\w+)>\(\)", text)]

    given = {name: named(text) for name, text in re.findall(r"(\w+)\{([^;]*)\};", step)}  # inputs that hold stages
    found = []
    for match in re.finditer(r"stage<\w+>\(\)\.|\b(m_\w+)\.(\w+)\((.*?)\);", step, re.S):
        if not match[1]:
            found += [("World::step", name) for name in named(match[0])]
        elif match[1] in owners:
            where = f"{owners[match[1]]}::{match[2]}"
            names = [name for word in re.findall(r"\w+", match[3]) for name in given.get(word, [])] + named(match[3])
            if "boxes.findPairs" in body_of(owners[match[1]], match[2]):  # a BoxIndex, which calls the broadphase
                names.append("broadphase")
            found += [(where, name) for name in names]
    last = {name: at for at, (_, name) in enumerate(found)}
    of_world = re.findall(r'\{StageKind::\w+, "(\w+)", "\w+", "\w+"\}', source("framework/stage/stages.h"))
    missing = [name for name in of_world if name not in last]
    if missing:
        raise UserError(f"World::step: found no call of {', '.join(missing)}")
    return [(where, name) for at, (where, name) in enumerate(found) if last[name] == at]


def wrapped(words, width):
    lines = [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + len(word) + 2 > width:
            lines.append("")
        lines[-1] += (", " if lines[-1] else "") + word
    return lines if words else ["none"]


def box(x, y, width, title, lines, kind="", note=""):
    height = PAD + LINE * (1 + len(lines)) + PAD / 2
    text = [f'<rect {kind} x="{x}" y="{y}" width="{width}" height="{height}" rx="4"/>',
            f'<text class="h" x="{x + PAD}" y="{y + PAD + 8}">{escape(title)}</text>']
    if note:
        text.append(f'<text class="s" x="{x + width - PAD}" y="{y + PAD + 8}" text-anchor="end">{escape(note)}</text>')
    text += [f'<text x="{x + PAD}" y="{y + PAD + 8 + LINE * (i + 1)}">{escape(line)}</text>' for i, line in enumerate(lines)]
    return text, height


def picture(width, height, content, label):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" viewBox="0 0 {width:g} {height:g}" '
            f'role="img" aria-label="{escape(label)}">\n'
            '<rect x="0" y="0" width="100%" height="100%" style="fill:#fff;stroke:none"/>\n' + STYLE + "\n" +
            "\n".join(content) + "\n</svg>\n")


def pipeline():
    """A column of the stages of a step, each with the stages that it contains beside it."""
    left, wide, beside = 20, 400, 460
    fits = int((wide - 2 * PAD) / CHAR)
    content, y = [], 20
    for where, name in order():
        drawn, height = box(left, y, wide, name, wrapped(competitors(name), fits), note=where)
        content += drawn
        at = y
        for part in parts(name):
            held, tall = box(beside, at, wide, part, wrapped(competitors(part), fits), kind='class="p"')
            content += held
            content.append(f'<path d="M{left + wide} {y + 18} H{left + wide + 20} V{at + 18} H{beside}"/>')
            at += tall + 8
        bottom = max(y + height, at - 8)
        content.append(f'<path d="M{left + wide / 2} {y + height} V{bottom + 16}"/>')
        y = bottom + 16
    content.pop()
    y += 8
    content.append(f'<text class="s" x="{left}" y="{y + 8}">Not called in every step; used by scenes and programs:</text>')
    y += 18
    shown = {n for _, n in order()} | {p for _, n in order() for p in parts(n)}
    for name in stages().values():
        if name not in shown:
            drawn, height = box(left, y, wide, name, wrapped(competitors(name), fits))
            content += drawn
            y += height + 10
    return picture(beside + wide + 20, y + 10, content, "The stages of a step, in the order of World::step")


def classes():
    """Trees of base and derived classes, of the framework's public headers and of engines; beside them the parts and the state of
    a world."""
    children, about = {}, {}
    for path in [*sorted((ROOT / "framework").glob("*/*.h")), ROOT / "oracles/engines/engine_world.h"]:
        text = source(path.relative_to(ROOT))
        for match in re.finditer(r"\b(?:class|struct) (\w+)(?: final)? : public (\w+)", text):
            children.setdefault(match[2], []).append(match[1])
            about[match[1]] = path.name
    roots = sorted(set(children) - {c for made in children.values() for c in made})
    content, y = [], 20

    def draw(name, depth):
        nonlocal y
        x, top = 20 + depth * 30, y
        of = interfaces().get(name)
        note = f"  algorithms/{of}" if of and of != "engine" else "  oracles/engines" if of else f"  {about.get(name, '')}"
        content.append(f'<text class="h" x="{x + 6}" y="{y + 12}">{escape(name)}</text>')
        content.append(f'<text class="s" x="{x + 6 + CHAR * len(name)}" y="{y + 12}">{escape(note)}</text>')
        y += 20
        for child in sorted(children.get(name, [])):
            content.append(f'<path d="M{x + 10} {top + 18} V{y + 8} H{x + 32}"/>')
            draw(child, depth + 1)

    for root in roots:
        draw(root, 0)
        y += 8
    state = re.search(r"struct SavedState \{\n(.*?)\n\};", source("framework/world/saved_state.h"), re.S)
    if not state:
        raise UserError("framework/world/saved_state.h: found no struct SavedState")
    fields = [re.sub(r"\s+", " ", line).strip(" ;") for line in state[1].split("\n")]
    boxes = [("Parts of World", [f"{name} {member[2:]}" for member, name in parts_of_world().items()]),
             ("State of World, as saved", [f for f in fields if f])]
    width = max(len(line) for title, lines in boxes for line in [title, *lines]) * CHAR + 2 * PAD
    bottom = 20
    for title, lines in boxes:
        drawn, height = box(430, bottom, width, title, lines, kind='class="p"')
        content += drawn
        bottom += height + 20
    return picture(430 + width + 20, max(y, bottom), content, "Base classes with derived classes, and the state of a world")


def folders():
    """{folder: folders that it includes}, of all folders with C++."""
    holds = {}
    for part in ("framework", "algorithms", "oracles", "experiments"):
        for path in sorted((ROOT / part).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                holds.setdefault(path.parent.relative_to(ROOT).as_posix(), []).append(path)
    uses = {folder: set() for folder in holds}
    for folder, files in holds.items():
        for path in files:
            for target in re.findall(r'(?m)^\s*#\s*include [<"]([a-z_0-9/]+)/[^/">]+[">]', path.read_text()):
                if target == "lpc":  # <lpc/world.h>: a header of the framework
                    target = "framework/world"
                if target in holds and target != folder:
                    uses[folder].add(target)
    return uses


def by_layers(uses):
    """The folders of one part of the project, in layers: a folder stands above those that it includes."""
    below = {folder: {u for u in used if u in uses} for folder, used in uses.items()}
    reach = {}

    def reached(folder, seen):
        for used in below[folder] - seen:
            seen.add(used)
            reached(used, seen)
        return seen

    for folder in below:
        reach[folder] = reached(folder, set())
    return sorted(below, key=lambda f: (-len(reach[f] - {f}), f))


def layout():
    """A column per part of the project: each folder with its includes, above the folders that it includes."""
    uses = folders()
    wide, gap, content, bottom = 300, 24, [], 0
    fits = int((wide - 2 * PAD) / CHAR)
    parts_of = ("framework", "algorithms", "oracles", "experiments")
    for column, part in enumerate(parts_of):
        own = {f: u for f, u in uses.items() if f.split("/")[0] == part}
        x, y = 20 + column * (wide + gap), 20
        content.append(f'<text class="h" x="{x}" y="{y + 4}">{part}/</text>')
        y += 14
        shown = [f for f in by_layers(own) if part != "algorithms" or f.count("/") == 1]
        for folder in shown:
            short = {u: u[len(part) + 1:] if u.startswith(part + "/") else u for u in own[folder]}
            if part == "algorithms":
                inner = sorted(f.split("/")[2] for f in own if f.startswith(folder + "/"))
                lines = wrapped(["kernels: " + inner[0], *inner[1:]], fits) if inner else []
            else:
                mine = sorted(s for u, s in short.items() if u.startswith(part + "/"))
                others = sorted({u.split("/")[0] for u in own[folder] if not u.startswith(part + "/")})
                words = [*mine, *(f"{o}/" for o in others)]
                lines = wrapped(["includes " + words[0], *words[1:]], fits) if words else ["includes no other folder"]
            kind = 'class="p"' if part == "algorithms" else ""
            drawn, height = box(x, y, wide, folder[len(part) + 1:] + "/", lines, kind)
            content += drawn
            y += height + 8
        bottom = max(bottom, y)
    return picture(20 + len(parts_of) * (wide + gap), bottom + 10, content, "The folders of the code and their includes")


def main(words):
    if words and words[0] in ("-h", "--help"):
        print(__doc__.strip())
        return 0
    if words not in ([], ["--check"]):
        print(f"diagrams.py: unknown argument '{words[0]}'; valid: --check, --help", file=sys.stderr)
        return 2
    stale = []
    for name, draw in (("folders.svg", layout), ("pipeline.svg", pipeline), ("classes.svg", classes)):
        try:
            text = draw()
        except UserError as error:
            print(f"diagrams.py: {error}", file=sys.stderr)
            return 1
        path = FIGURES / name
        if words:
            if not path.exists() or path.read_text() != text:
                stale.append(path.relative_to(ROOT).as_posix())
        else:
            path.write_text(text)
    if stale:
        print(f"{', '.join(stale)}: out of date; run reports/diagrams.py", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
