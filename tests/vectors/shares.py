"""How several probes share a point: shares.json."""

from __future__ import annotations

from tests.conformance.digits import fifty
from tests.conformance.sharing import FAMILIES, LAYOUTS, STEPPED, Shared, bound, exact, steepest, steps

from .vector_file import Record, VectorFile, digits, tolerance

PER_FAMILY = 6  # an even number: pairs stay together

ABOUT = [
    "How several probes share a point, and what the surface's own lobe keeps: inputs, exact results, tolerances. "
    "Inputs are float32 numbers, written exactly.",
    "Probes come from the lowest to the highest. depth: metres of the point below the nearest wall of each one's box, "
    "negative outside. weight: of the point that it has where it is the only one. fade: metres over which it fades. "
    "apart: for each the numbers of those before it that its box keeps out of; layout: what that is.",
    "The first probe covers its weight. One that keeps out of none covers min(weight, 3 s^2 - 2 s^3) with s = 1 + "
    "depth / fade, cut off to 0 ... 1. One that does: with e the least distance outside those boxes, max(-depth, 0), "
    "and o that outside its own, e^2 / (e^2 + o^2) min(e / (0.2 fade), 1) weight, and 0 where e is 0. 0.2 is the "
    "float32 number.",
    "parts: what each probe covers times what those after it leave, 1 - covered; the last is the own lobe's, what all "
    "leave. diffuse is 1 on paths that left a diffuse surface: all is then the own lobe's. Computed with 50 digits.",
    "tolerances: how far off a careful float32 implementation may be that mixes two at a time, by covered / coverage; "
    "docs/numerics.md derives them. The parts add up to 1 to 4 * 2^-24 a probe.",
    "steps: pairs of cases whose depths differ little; most: what any part may change between them, which is the "
    "steepest that shares ever are times the distance.",
]


def sections() -> dict[str, list[Record]]:
    cases: list[Record] = []
    pairs: list[Record] = []
    for layout in LAYOUTS:
        for family in FAMILIES.names:
            shared = FAMILIES.cases(family, 256)[:PER_FAMILY]
            if family == STEPPED:
                pairs += _steps(shared, layout, len(cases))
            cases += _records(family, shared, layout)
    return {"cases": cases, "steps": pairs}


def _records(family: str, shared: Shared, layout: str) -> list[Record]:
    bounds = bound(shared, layout, exact(shared, layout))
    with fifty() as numbers:
        truth = exact(shared, layout, numbers)
    return [
        {
            "family": family,
            "layout": layout,
            "apart": [list(others) for others in LAYOUTS[layout]],
            "depth": shared.depth[k].tolist(),
            "weight": shared.weight[k].tolist(),
            "fade": shared.fade[k].tolist(),
            "diffuse": int(shared.diffuse[k]),
            "parts": digits(truth[k]),
            "tolerances": tolerance(bounds[k]),
        }
        for k in range(len(shared))
    ]


def _steps(shared: Shared, layout: str, start: int) -> list[Record]:
    metres, _ = steps(shared, exact(shared, layout))
    most = metres * steepest(shared, layout)[::2]
    return [
        {"first": start + 2 * k, "second": start + 2 * k + 1, "most": tolerance(value)} for k, value in enumerate(most)
    ]


FILE = VectorFile("shares.json", ABOUT, ("depth", "weight", "fade"), sections)
