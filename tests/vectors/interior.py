"""Interior mapping: interior.json."""

from __future__ import annotations

import numpy as np

from pcc_addon.core.backends.hashing import random
from tests.conformance.interior import FAMILIES, Panes, cases, direction_bound, exact

from .vector_file import Record, VectorFile, digits, first, tolerance

PER_FAMILY, KEYS = 12, 24

ABOUT = [
    "Interior mapping: inputs, exact results, tolerances. Inputs are float32 numbers, written exactly.",
    "place: the point of the pane in cells (u to the right, v up). Its cell: (floor u, floor v); its spot in the unit "
    "room [-1, 1]^3 is (2 fract u - 1, -1, 2 fract v - 1): the pane lies on y = -1.",
    "ray: from the eye on, x to the right along the pane, y into the room (never negative), z up; of any length. size: "
    "the room's width, depth, height, in the ray's units.",
    "hit: where the ray leaves the unit room, with the ray's components divided by half of the size. Walls that it "
    "touches and looks out of are met at once.",
    "The room is then mirrored (mirror -1: x changes its sign) and turned by quarters about z, from x to y.",
    "direction: half_edges[0] x + half_edges[1] y + half_edges[2] z - capture for the hit (x, y, z) so turned, "
    "normalised. tolerance: the largest angle in radians by which a careful float32 implementation may miss it.",
    "random: three numbers of 0 ... 1 for a key of three float32 numbers, by their bits: Blender's White Noise in 3D.",
]


def sections() -> dict[str, list[Record]]:
    rng = np.random.default_rng(77)
    keys = np.concatenate([rng.integers(-99, 99, (KEYS // 2, 3)), rng.normal(size=(KEYS // 2, 3))]).astype(np.float32)
    numbers = random(keys).astype(np.float64)
    return {
        "cases": [record for name in FAMILIES.names for record in _records(name, _some(name))],
        "random": [{"key": k.tolist(), "random": n.tolist()} for k, n in zip(keys, numbers, strict=True)],
    }


def _some(name: str) -> Panes:
    panes = cases(name, 64)
    return panes[first(direction_bound(panes, exact(panes)), PER_FAMILY)]


def _records(family: str, panes: Panes) -> list[Record]:
    truth = exact(panes)
    bound = direction_bound(panes, truth)
    return [
        {
            "family": family,
            "place": panes.place[k, :2].tolist(),
            "ray": panes.ray[k].tolist(),
            "size": panes.size[k].tolist(),
            "half_edges": panes.half_edges[k].tolist(),
            "capture": panes.capture[k].tolist(),
            "quarters": int(panes.quarters[k]),
            "mirror": int(panes.mirror[k]),
            "direction": digits(truth.direction[k], 12),
            "tolerance": tolerance(bound[k]),
        }
        for k in range(len(panes))
    ]


FILE = VectorFile("interior.json", ABOUT, ("place", "ray", "size", "half_edges", "capture"), sections)
