"""Writes lookup.json: python3 dev.py run tests/vectors/make.py"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from pcc_addon.core.effects.records import Correction
from tests.conformance.bound import direction_bound
from tests.conformance.cases import Cases
from tests.conformance.families import FAMILIES, Family
from tests.conformance.reference import exact, exact_direction_in_50_digits

FILE = Path(__file__).with_name("lookup.json")
PER_FAMILY = 12
ILL_POSED = 0.1  # radians; where single precision cannot say more, there is nothing to compare

ABOUT = [
    "Box-projected reflection lookup: inputs, exact results, tolerances. Inputs are float32 numbers, written exactly.",
    "World space, metres. position: shaded point. incoming: from it to the eye. normal: of any length but 0 (a zero "
    "normal lets the ray go straight on). reflected ray R = 2 (incoming . n) n - incoming with n = normal / |normal|.",
    "The box lies between three pairs of planes: |face_normals[k] . (x - centre)| <= half_widths[k]. Face normals have "
    "length 1 to rounding and need not be orthogonal; take them as they are.",
    "hit = position + t R with t >= 0 where the ray leaves the box: the least, over the planes that it runs towards, "
    "of the distance to them; 0 for a plane that it has passed already.",
    "direction: (hit - capture_point), normalised, computed with 50 digits. tolerance: the largest angle in radians by "
    "which a careful float32 implementation may miss it; docs/numerics.md derives it.",
]


def text() -> str:
    """The file's text."""
    finite = [family for family in FAMILIES if family.finite]
    lines = [json.dumps(record) for family in finite for record in _records(family.name, _some(family))]
    return json.dumps({"about": ABOUT}, indent=1)[:-2] + ',\n "cases": [\n  ' + ",\n  ".join(lines) + "\n ]\n}\n"


def _some(family: Family) -> Cases:
    cases = family.cases(64, Correction.ORIENTED_BOX)
    truth = exact(cases)
    usable = (direction_bound(cases, truth) < ILL_POSED) & truth.direction.any(-1)
    return cases[np.flatnonzero(usable)[:PER_FAMILY]]


def _records(family: str, cases: Cases) -> list[dict]:
    tolerance = direction_bound(cases, exact(cases))
    return [
        {
            "family": family,
            "position": cases.position[k].tolist(),
            "incoming": cases.incoming[k].tolist(),
            "normal": cases.normal[k].tolist(),
            "centre": cases.centre[k].tolist(),
            "face_normals": cases.face_normals[k].tolist(),
            "half_widths": cases.half_widths[k].tolist(),
            "capture_point": cases.capture_point[k].tolist(),
            "direction": [float(f"{c:.15g}") for c in exact_direction_in_50_digits(cases, k)],
            "tolerance": float(f"{1.01 * tolerance[k]:.3g}"),
        }
        for k in range(len(cases))
    ]


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
    print(FILE)
