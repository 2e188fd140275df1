# SPDX-License-Identifier: Zlib
"""Shipped files as bytes to damage: small enough to be read and run quickly."""

import json
import re

SMALL_SWEEP = """summary = "s"
kind = "world"
pipeline = "contacts=sat_clip cache=by_feature"
wall_limit = 5

[axes]
scene = "vertical_stack"
dimension = [2, 3]
n = [2, 3]
steps = 2
iterations = [1, 4]

[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=$iterations}}"
"soft_step" = "solver=soft_step{substeps=$iterations}"
"""
SMALL_SCENE = """name = "small"
summary = "s"
dimensions = [2, 3]
gravity = [0, -10, 0]
steps = 5

[parameters]
n = { default = 2, min = 1, max = 5, meaning = "boxes" }

[[body]]
type = "fixed"
name = "ground"
position = [0, -1, 0]
shapes = [{ kind = "box", half = [20, 1, 20] }]

[[body]]
repeat = { i = "n" }
position = ["0.1 * i", "0.5 + i", 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5], friction = "0.6 + 0.1 * k" }]
"""


def scenes(source):
    table = [line.split() for line in (source / "tests/experiments/scene_states.txt").read_text().splitlines() if line[0] != "#"]
    large = {words[0] for words in table if int(words[2]) > 1000}  # they are slow
    found = [p for p in sorted((source / "experiments/scenes").glob("*.toml")) if p.stem not in large]
    return [p.read_bytes() for p in found] + [SMALL_SCENE.encode()] * 5


def small_scenes(source):
    """Scenes with few bodies and every kind of block."""
    names = ("bouncing_ball", "bridge", "compounds", "cylinders", "pendulum", "script_events", "slope")
    return [(source / f"experiments/scenes/{name}.toml").read_bytes() for name in names] + [SMALL_SCENE.encode()]


def sweeps(source):
    """Sweeps without sets and without large ones, which take a second to plan."""
    found = [p.read_bytes() for p in sorted((source / "experiments/sweeps").glob("*.toml")) if not p.stem.endswith("_full")]
    return [text for text in found if b"sweeps = " not in text]


def pipelines(source):
    found = b"\n".join(sweeps(source)).decode()
    texts = re.findall(r'"((?:\w+=[^"\s]+ ?)+)"', found)
    return [re.sub(r"\$\w+", "3", t).replace("*", "catto").encode() for t in sorted(set(texts))]


def expressions(source):
    found = b"\n".join(scenes(source)).decode()
    return sorted({t.encode() for t in re.findall(r'"([^"\n]*)"', found) if re.search(r"[-+*/<]", t)})


def cases(source):
    """Files of one case, which run quickly."""
    out = []
    for path in sorted((source / "tests/regressions").glob("*.json")):
        out += [json.dumps({"cases": [c]}, indent=1).encode() for c in json.loads(path.read_text()).get("cases", [])]
    return out
