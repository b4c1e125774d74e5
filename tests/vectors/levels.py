"""The radiance at a roughness, between the levels of a ladder: levels.json."""

from __future__ import annotations

import numpy as np

from tests.conformance.digits import fifty
from tests.conformance.levels import FAMILIES, LADDERS, Mixed, bound, exact

from .vector_file import Record, VectorFile, digits, tolerance

PER_FAMILY = 4

ABOUT = [
    "The radiance at a roughness, mixed from the two nearest levels of a ladder: inputs, exact results, tolerances. "
    "Inputs are float32 numbers, written exactly.",
    "rungs: the roughnesses of the levels, ascending. levels: the radiance of each. roughness: of the surface. "
    "spread: what the roughness is multiplied by where contacts are hardened (lookup.json), else 1.",
    "radiance: with x = roughness * spread and rungs[k] <= x <= rungs[k + 1], levels[k] (1 - s) + levels[k + 1] s "
    "with s = (x - rungs[k]) / (rungs[k + 1] - rungs[k]); the first and the last level beyond the ladder's ends. "
    "Computed with 50 digits. tolerances: how far off a careful float32 implementation may be that adds a difference "
    "for each rung; docs/numerics.md derives them.",
]


def sections() -> dict[str, list[Record]]:
    kinds = [(n, ladder, h) for ladder in LADDERS for h in (False, True) for n in FAMILIES.names]
    return {"cases": [record for kind in kinds for record in _records(*kind)]}


def _records(family: str, ladder: str, hardening: bool) -> list[Record]:
    mixed: Mixed = FAMILIES.cases(family, 64, ladder)[:PER_FAMILY]
    bounds = bound(mixed, ladder, hardening, exact(mixed, ladder, hardening))
    spread = mixed.spread if hardening else np.ones(len(mixed), np.float32)
    with fifty() as numbers:
        truth = exact(mixed, ladder, hardening, numbers)
    return [
        {
            "family": family,
            "ladder": ladder,
            "hardening": hardening,
            "rungs": list(LADDERS[ladder]),
            "roughness": float(mixed.roughness[k]),
            "spread": float(spread[k]),
            "levels": mixed.levels[k].tolist(),
            "radiance": digits(truth[k]),
            "tolerances": tolerance(bounds[k]),
        }
        for k in range(len(mixed))
    ]


FILE = VectorFile("levels.json", ABOUT, ("rungs", "roughness", "spread", "levels"), sections)
