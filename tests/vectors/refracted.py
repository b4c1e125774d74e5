"""What is seen through glass and water, looked up in a box: refracted.json."""

from __future__ import annotations

from pcc_addon.core.effects.records import Correction
from pcc_addon.core.effects.transmission import Interface
from tests.conformance.digits import fifty
from tests.conformance.glass import FAMILIES, INTERFACES, Glass, bound, decided, exact

from .lookup import BOX, box
from .vector_file import Record, VectorFile, digits, first, tolerance

PER_FAMILY = {Interface.PANE: 1, Interface.ONCE: 3, Interface.SOLID: 3}
BOXES = (Correction.ALIGNED_BOX, Correction.ORIENTED_BOX)

ABOUT = [
    "Box-projected lookup of what is seen through glass or water: inputs, exact results, tolerances. The fields of "
    "the box, and where the ray leaves it, are those of lookup.json. Inputs are float32 numbers, written exactly; "
    "incoming, normal and axes have length 1 to rounding, and the normal is on the eye's side.",
    "interface: 'thin pane' (the view -incoming goes on straight, as given), 'one interface' (it is bent once, at the "
    "surface), 'solid' (bent in, and out on the far side of an ellipsoid).",
    "Bending: along = d . n, across = d - along n for a ray d and a normal n against it, both normalised; with m the "
    "index of what is behind over that of what is before, and rest = 1 - |across|^2 / m^2, the bent ray is across / m "
    "- sqrt(rest) n; where rest <= 0 there is none and all light is mirrored.",
    "one interface: m = ior, or 1 / ior where backfacing is 1, which means that the inner side is seen.",
    "solid: in with m = ior. Coordinates along the object's axes: v -> (axes[0] . v, axes[1] . v, axes[2] . v); back: "
    "(x, y, z) -> x axes[0] + y axes[1] + z axes[2]. The surface is that of the ellipsoid with half axes dimensions / "
    "2, at the place where its normal is the given one; the ray leaves it at the other end of its chord, and bends "
    "there with m = 1 / ior, or is mirrored at the far side where it cannot pass.",
    "ray: behind the surface, normalised. offset: from position to where it starts, zero but for solids, metres. "
    "passes: whether light comes through, where bent once, or through the far side; null: rounding decides. They are "
    "for finding faults; single precision is held to the direction.",
    "direction: (hit - capture_point), normalised, for the ray from position + offset, computed with 50 digits. "
    "tolerance: the largest angle in radians by which a careful float32 implementation may miss it; docs/numerics.md "
    "derives it. Of one interface that does not let light pass nothing is seen: the direction is then that of going "
    "straight on.",
]


def sections() -> dict[str, list[Record]]:
    kinds = [(name, correction, i) for name in FAMILIES.names for correction in BOXES for i in INTERFACES]
    return {"cases": [record for kind in kinds for record in _records(*kind)]}


def _records(family: str, correction: Correction, interface: Interface) -> list[Record]:
    glass: Glass = FAMILIES.cases(family, 64, correction, interface)
    glass = glass[first(bound(glass, exact(glass)), PER_FAMILY[interface])]
    bounds, sure = bound(glass, exact(glass)), decided(glass)
    with fifty() as numbers:
        truth = exact(glass, numbers)
    return [
        box(glass.cases, k, family)
        | {
            "interface": interface.words,
            "ior": float(glass.ior[k]),
            "backfacing": int(glass.backfacing[k]),
            "dimensions": glass.dimensions[k].tolist(),
            "axes": glass.axes[k].tolist(),
            "ray": digits(truth.ray[k]),
            "offset": digits(truth.offset[k]),
            "passes": bool(truth.passes[k]) if sure[k] else None,
            "direction": digits(truth.lookup.direction[k]),
            "tolerance": tolerance(bounds[k]),
        }
        for k in range(len(glass))
    ]


FILE = VectorFile("refracted.json", ABOUT, (*BOX, "ior", "dimensions", "axes"), sections)
