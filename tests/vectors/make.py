"""Writes lookup.json: python3 dev.py run tests/vectors/make.py"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from pcc_addon.core.effects.records import Correction
from tests.conformance.bound import direction_bound, stretched_bound
from tests.conformance.cases import Cases
from tests.conformance.fades import beyond_walls, exact_weight, fades
from tests.conformance.families import FAMILIES, Family
from tests.conformance.reference import exact, exact_direction_in_50_digits

FILE = Path(__file__).with_name("lookup.json")
PER_FAMILY = {Correction.ALIGNED_BOX: 6, Correction.ORIENTED_BOX: 12}
IN_THE_FADE = 40
ILL_POSED = 0.1  # radians; where single precision cannot say more, there is nothing to compare

ABOUT = [
    "Box-projected reflection lookup: inputs, exact results, tolerances. Inputs are float32 numbers, written exactly.",
    "World space, metres. position: shaded point. incoming: from it to the eye. normal: of any length but 0 (a zero "
    "normal lets the ray go straight on). reflected ray R = 2 (incoming . n) n - incoming with n = normal / |normal|.",
    "The box lies between three pairs of planes: |face_normals[k] . (x - centre)| <= half_widths[k]. Face normals have "
    "length 1 to rounding and need not be orthogonal; take them as they are.",
    "hit = position + t R with t >= 0 where the ray leaves the box: the least, over the planes that it runs towards, "
    "of the distance to them; 0 for a plane that it has passed already.",
    "box: oriented, or aligned where the face normals are the world's axes, so that the box reaches from centre - "
    "half_widths to centre + half_widths.",
    "direction: (hit - capture_point), normalised, computed with 50 digits. tolerance: the largest angle in radians by "
    "which a careful float32 implementation may miss it; docs/numerics.md derives it.",
    "stretched_direction: where to look, from the box's centre, in a cubemap that was not captured in the box: its "
    "axes are the face normals, every component is divided by the half width. stretched_tolerance: as above; up to "
    "half a turn where single precision cannot say.",
    "weight: 3 s^2 - 2 s^3 with s = 1 - (d - padding) / falloff, cut off to 0 ... 1; d is the largest of the distances "
    "by which the point lies beyond a pair of planes. weight_tolerance: as above.",
]


def text() -> str:
    """The file's text."""
    finite = [family for family in FAMILIES if family.finite]
    kinds = [(family, correction) for family in finite for correction in PER_FAMILY if correction in family.corrections]
    records = [record for kind in kinds for record in _records(kind[0].name, _some(*kind))]
    for correction in PER_FAMILY:
        cases, fade = beyond_walls(IN_THE_FADE, correction)
        records += _records("in the fade", cases, fade)
    lines = [json.dumps(record) for record in records]
    return json.dumps({"about": ABOUT}, indent=1)[:-2] + ',\n "cases": [\n  ' + ",\n  ".join(lines) + "\n ]\n}\n"


def _some(family: Family, correction: Correction) -> Cases:
    cases = family.cases(64, correction)
    truth = exact(cases)
    usable = (direction_bound(cases, truth) < ILL_POSED) & truth.direction.any(-1)
    return cases[np.flatnonzero(usable)[: PER_FAMILY[correction]]]


def _records(family: str, cases: Cases, fade: dict[str, np.ndarray] | None = None) -> list[dict]:
    truth = exact(cases)
    tolerance, stretched_tolerance = direction_bound(cases, truth), stretched_bound(cases, truth)
    fade = fade or fades(cases, np.random.default_rng(len(family)))
    weight, weight_tolerance = exact_weight(cases, truth, fade)
    return [
        {
            "family": family,
            "box": cases.correction.words.removesuffix(" box"),
            "position": cases.position[k].tolist(),
            "incoming": cases.incoming[k].tolist(),
            "normal": cases.normal[k].tolist(),
            "centre": cases.centre[k].tolist(),
            "face_normals": cases.face_normals[k].tolist(),
            "half_widths": cases.half_widths[k].tolist(),
            "capture_point": cases.capture_point[k].tolist(),
            "direction": [float(f"{c:.15g}") for c in exact_direction_in_50_digits(cases, k)],
            "tolerance": float(f"{1.01 * tolerance[k]:.3g}"),
            "stretched_direction": [float(f"{c:.15g}") for c in exact_direction_in_50_digits(cases, k, stretched=True)],
            "stretched_tolerance": float(f"{1.01 * stretched_tolerance[k]:.3g}"),
            "padding": float(fade["Padding"][k]),
            "falloff": float(fade["Falloff"][k]),
            "weight": float(f"{weight[k]:.12g}"),
            "weight_tolerance": float(f"{1.01 * weight_tolerance[k]:.3g}"),
        }
        for k in range(len(cases))
    ]


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
    print(FILE)
