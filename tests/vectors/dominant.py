"""Where rough surfaces are looked up, from the lobe itself: dominant.json."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.conformance.digits import inner, unit
from tests.conformance.dominant import FAMILIES, FIT, Views, bound, exact, halfway_to_the_mean, towards

from .vector_file import Record, VectorFile, digits, tolerance

PER_FAMILY = 8
FACETS = {"mirrors": None, "IOR 1.33": 1.33, "IOR 1.5": 1.5, "IOR 2.4": 2.4}
LEAST_COSINE, LEAST_ROUGHNESS = 0.03, 0.1  # of lobes; below, the directions are next to the mirrored view

ABOUT = [
    "Where a rough surface is looked up: inputs, the directions that follow from the lobe, tolerances. Inputs are "
    "float32 numbers, written exactly; incoming (to the eye) and normal have length 1 to rounding.",
    "direction: halfway, by the angle, between the mirrored view and the mean direction of the light that the lobe "
    "sends to the eye where it is the same from everywhere: the mean over all directions l of D G F l, with GGX's D "
    "of alpha = roughness^2, the height-correlated Smith G, and Fresnel's F for the index ior; ior null: F = 1. "
    "Roughness 0: the mirrored view. Summed over 160 x 160 facets in float64.",
    "tolerance: radians; what a fit by a few coefficients may miss, less than a tenth of the lobe's width, and what "
    "single precision adds. tests/conformance/dominant.py bounds that alone, for the coefficients of this project.",
]


def sections() -> dict[str, list[Record]]:
    return {
        "cases": [record for facets in FACETS for name, views in _chosen() for record in _records(name, views, facets)]
    }


def _chosen() -> list[tuple[str, Views]]:
    views: Views = FAMILIES.cases("anywhere", 64)
    view, normal = (v.astype(np.float64) for v in (views.incoming, views.normal))
    rough = views[(inner(view, normal)[:, 0] >= LEAST_COSINE) & (views.roughness >= LEAST_ROUGHNESS)]
    flat = replace(views[-2:], roughness=np.zeros(2, np.float32))
    return [
        ("rough", rough[:PER_FAMILY]),
        ("head-on, ±1e-7", FAMILIES.cases("head-on, ±1e-7", 64)[:2]),
        ("mirrors", flat),
    ]


def _records(family: str, views: Views, facets: str) -> list[Record]:
    bounds = bound(views, facets, exact(views, facets))
    view, normal = (unit(v.astype(np.float64)) for v in (views.incoming, views.normal))
    cosines = np.minimum(inner(view, normal)[:, 0], 1.0)
    angles = [
        halfway_to_the_mean(c, r, FACETS[facets]) if r > 0.0 else np.arccos(c)
        for c, r in zip(cosines, views.roughness.astype(np.float64), strict=True)
    ]
    directions = towards(views, np.array(angles))
    return [
        {
            "family": family,
            "facets": facets,
            "ior": FACETS[facets],
            "incoming": views.incoming[k].tolist(),
            "normal": views.normal[k].tolist(),
            "roughness": float(views.roughness[k]),
            "direction": digits(directions[k], 6),
            "tolerance": tolerance(bounds[k] + (FIT if views.roughness[k] > 0.0 else 1e-6)),
        }
        for k in range(len(views))
    ]


FILE = VectorFile("dominant.json", ABOUT, ("incoming", "normal", "roughness"), sections)
