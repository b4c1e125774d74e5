"""The mirrored lookup and the fade: lookup.json."""

from __future__ import annotations

import numpy as np

from pcc_addon.core.effects.records import Correction
from tests.conformance.bound import direction_bound, spread_bound, stretched_bound
from tests.conformance.cases import Cases
from tests.conformance.digits import fifty
from tests.conformance.fades import beyond_walls, exact_weight, fades
from tests.conformance.families import FAMILIES, Family
from tests.conformance.reference import exact

from .vector_file import Record, VectorFile, digits, first, tolerance

PER_FAMILY = {Correction.ALIGNED_BOX: 6, Correction.ORIENTED_BOX: 12}
IN_THE_FADE = 40

ABOUT = [
    "Box-projected reflection lookup: inputs, exact results, tolerances. Inputs are float32 numbers, written exactly.",
    "World space, metres. position: shaded point. incoming: from it to the eye. normal: of any length but 0 (a zero "
    "normal lets the ray go straight on). reflected ray R = 2 (incoming . n) n - incoming with n = normal / |normal|.",
    "The box lies between three pairs of planes: |face_normals[k] . (x - centre)| <= half_widths[k]. Face normals "
    "have length 1 to rounding and need not be orthogonal; take them as they are.",
    "hit = position + t R with t >= 0 where the ray leaves the box: the least, over the planes that it runs towards, "
    "of the distance to them; 0 for a plane that it has passed already.",
    "box: oriented, or aligned where the face normals are the world's axes, so that the box reaches from centre - "
    "half_widths to centre + half_widths.",
    "direction: (hit - capture_point), normalised, computed with 50 digits. tolerance: the largest angle in radians "
    "by which a careful float32 implementation may miss it; docs/numerics.md derives it.",
    "stretched_direction: where to look, from the box's centre, in a cubemap that was not captured in the box: its "
    "axes are the face normals, every component is divided by the half width. stretched_tolerance: as above; up to "
    "half a turn where single precision cannot say.",
    "spread: sqrt(t / |hit - capture_point|), cut off to 0.35 ... 1.5, by which the roughness is multiplied where "
    "contacts are hardened. spread_tolerance: as above.",
    "weight: 3 s^2 - 2 s^3 with s = 1 - (d - padding) / falloff, cut off to 0 ... 1; d is the largest of the "
    "distances by which the point lies beyond a pair of planes. weight_tolerance: as above.",
]


def sections() -> dict[str, list[Record]]:
    finite = [family for family in FAMILIES if family.finite]
    kinds = [(family, correction) for family in finite for correction in PER_FAMILY if correction in family.corrections]
    records = [record for kind in kinds for record in _records(kind[0].name, _some(*kind))]
    for correction in PER_FAMILY:
        cases, fade = beyond_walls(IN_THE_FADE, correction)
        records += _records("in the fade", cases, fade)
    return {"cases": records}


def _some(family: Family, correction: Correction) -> Cases:
    cases = family.cases(64, correction)
    truth = exact(cases)
    bound = np.where(truth.direction.any(-1), direction_bound(cases, truth), np.inf)
    return cases[first(bound, PER_FAMILY[correction])]


def _records(family: str, cases: Cases, fade: dict[str, np.ndarray] | None = None) -> list[Record]:
    truth = exact(cases)
    bounds = [bound(cases, truth) for bound in (direction_bound, stretched_bound, spread_bound)]
    fade = fade or fades(cases, np.random.default_rng(len(family)))
    weight, weight_tolerance = exact_weight(cases, truth, fade)
    with fifty() as numbers:
        exacter = exact(cases, numbers)
    return [
        box(cases, k, family)
        | {
            "direction": digits(exacter.direction[k]),
            "tolerance": tolerance(bounds[0][k]),
            "stretched_direction": digits(exacter.stretched[k]),
            "stretched_tolerance": tolerance(bounds[1][k]),
            "spread": digits(exacter.spread[k]),
            "spread_tolerance": tolerance(bounds[2][k]),
            "padding": float(fade["Padding"][k]),
            "falloff": float(fade["Falloff"][k]),
            "weight": digits(weight[k], 12),
            "weight_tolerance": tolerance(weight_tolerance[k]),
        }
        for k in range(len(cases))
    ]


def box(cases: Cases, k: int, family: str) -> Record:
    """What every lookup in a box is given, but for its ray."""
    kind = cases.correction.words.removesuffix(" box")
    return {"family": family, "box": kind, **{name: getattr(cases, name)[k].tolist() for name in BOX}}


BOX = ("position", "incoming", "normal", "centre", "face_normals", "half_widths", "capture_point")
FILE = VectorFile("lookup.json", ABOUT, (*BOX, "padding", "falloff"), sections)
