"""How several probes share points, as twins compute it: from probes to what each has of a point in the end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.belonging import beside, layered
from pcc_addon.core.effects import choice
from pcc_addon.core.effects import lookup as formula
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from pcc_addon.core.influence import Influence
from pcc_addon.core.probe import Box, ProbeSpec

from . import boxes


def inputs_of(spec: ProbeSpec, correction: Correction = Correction.ORIENTED_BOX) -> dict[str, object]:
    """What a probe's group feeds its lookup."""
    return {
        "Box Centre": spec.box.centre,
        **{f"Face Normal {name}": row for name, row in zip("XYZ", spec.box.face_normals, strict=True)},
        "Turn Mirror": spec.box.turn_mirror,
        "Half Widths": spec.box.half_widths,
        "Capture Point": spec.capture_point,
        "Padding": spec.influence_padding,
        "Falloff": spec.influence_falloff,
        "Boundary": spec.boundary,
        "Normal Fade": spec.influence.normal_fade,
        "Probe Weight": spec.influence.weight,
        **spec.shown_faces(correction),
    }


def weight_and_depth(
    spec: ProbeSpec,
    points: np.ndarray,
    normals: np.ndarray,
    dtype: type,
    correction: Correction,
    *,
    facing: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """(n,) each: how much of points the probe has where it is the only one, and how deep they lie in it."""
    influence = spec.influence
    effects = LookupEffects(
        correction,
        Outside.OWN,
        offset=True,
        facing=facing,
        per_face=spec.has_different_faces,
        by_normal=influence.normal_fade > 0.0,
        weighted=influence.weight < 1.0,
    )
    given = {
        **inputs_of(spec, correction),
        "Position": points,
        "Normal": normals,
        "Direction": normals,
        "Offset": np.zeros(3),
    }
    found = evaluate(formula.probe(effects, {}).outputs | _depth(spec, correction), given, dtype)
    return np.broadcast_to(found["Weight"], len(points)), found["Depth"]


def _depth(spec: ProbeSpec, correction: Correction) -> dict:
    q = formula.along_face_normals(correction, formula.CENTRE - formula.POSITION)
    return {"Depth": formula.depth(q, per_face=spec.has_different_faces)}


def parts_of(
    depths: np.ndarray,
    weights: np.ndarray,
    fades: Sequence[float],
    dtype: type = np.float32,
    apart: Sequence[Sequence[int]] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """(n, probes) how much of n points each probe ends up with, and (n,) how much stays with the surface's own lobe.

    Depths and weights are (n, probes), each probe over those before it, or beside those that `apart` names for it; by
    default beside all.
    """
    covered, parts = weights[:, 0].astype(dtype), [np.ones(len(depths), dtype)]
    outside = [evaluate(choice.OUTSIDE.outputs, {"Depth": depth}, dtype)["Distance"] for depth in depths.T]
    for k in range(1, depths.shape[1]):
        beside = range(k) if apart is None else apart[k]
        inputs = {"Depth": depths[:, k], "Weight": weights[:, k], "Coverage": covered, "Fade": fades[k]}
        if beside:
            inputs["Distance"] = outside[beside[0]]
        for other in beside[1:]:
            both = {"Distance": inputs["Distance"], "Other Distance": outside[other]}
            inputs["Distance"] = evaluate(choice.NEARER.outputs, both, dtype)["Distance"]
        step = evaluate((choice.BESIDE if beside else choice.OVER).outputs, inputs, dtype)
        covered = step["Coverage"]
        parts = [part * (1.0 - step["Share"]) for part in parts] + [step["Share"]]
    own = evaluate(choice.own_share(None).outputs, {"Coverage": covered, "Diffuse Depth": 0.0, "Captured": 0.0}, dtype)[
        "Share"
    ]
    return np.stack(parts, -1) * np.asarray(covered)[:, None], np.broadcast_to(own, len(depths))


def shared(
    specs: Sequence[ProbeSpec], points: np.ndarray, normals: np.ndarray, dtype: type = np.float32
) -> tuple[np.ndarray, np.ndarray]:
    """`parts_of` points (n, 3) of surfaces with these normals, in the order of `specs`."""
    names = layered([spec.name for spec in specs], {spec.name: spec for spec in specs})
    ordered = [next(spec for spec in specs if spec.name == name) for name in names]
    each = [weight_and_depth(spec, points, normals, dtype, Correction.ORIENTED_BOX) for spec in ordered]
    weights, depths = (np.stack(columns, -1) for columns in zip(*each, strict=True))
    fades = [spec.influence_falloff for spec in ordered]
    parts, own = parts_of(depths, weights, fades, dtype, beside(ordered))
    return parts[:, [names.index(spec.name) for spec in specs]], own


def random_probes(rng: np.random.Generator, count: int) -> list[ProbeSpec]:
    """Boxes of any kind around the origin that overlap, touch or leave gaps, with influences of all sorts."""
    found: list[ProbeSpec] = []
    for k in range(count):
        if found and rng.random() < 0.5:  # a room beside the one before, with a thin wall or none between
            m = np.array(found[-1].box.matrix).reshape(4, 4)
            axis = int(rng.integers(3))
            gap = float(rng.choice([0.0, 0.03, 0.12])) * found[-1].box.face_normals[axis]
            m[:3, 3] += (2.0 * m[:3, axis] + gap) * rng.choice([-1.0, 1.0])
        else:
            m = boxes.matrix(str(rng.choice(boxes.KINDS)), rng, tuple(np.round(rng.uniform(-4.0, 4.0, 3), 1)))
        found.append(_random_probe(rng, f"Probe {k}", m))
    return found


def _random_probe(rng: np.random.Generator, name: str, m: np.ndarray) -> ProbeSpec:
    box = Box.from_matrix(name, m)

    def triple(low: float, high: float) -> tuple[float, float, float]:
        return tuple(float(v) for v in rng.uniform(low, high, 3))

    influence = Influence(
        *(triple(-0.2, 0.5), triple(-0.2, 0.5)) if rng.random() < 0.5 else (),
        **{"falloff_low": triple(0.05, 1.0), "falloff_high": triple(0.05, 1.0)} if rng.random() < 0.5 else {},
        normal_fade=float(rng.choice([0.0, rng.uniform(0.05, 0.5)])),
        weight=float(rng.choice([1.0, rng.uniform(0.0, 1.0)])),
        priority=int(rng.integers(-1, 2)),
    )
    return ProbeSpec(name, box, falloff=float(rng.uniform(0.05, 1.0)), influence=influence)


def steepest(specs: Sequence[ProbeSpec]) -> float:
    """How much what one of the probes has of a surface may change a metre, at most.

    A part is a product of what its probe covers and what those over it leave, so their slopes add up. What a probe
    covers is a share times its fade, its normals' fade and its weight. Depths change by a metre a metre, times the
    steepness where faces differ; the distance from the boxes before by that of any.
    """
    ratios = [spec.influence_falloff / float(spec.face_falloffs.min()) for spec in specs]
    total = 0.0
    for spec, ratio in zip(specs, ratios, strict=True):
        fade, by_normal = spec.influence_falloff, spec.influence.normal_fade
        total += choice.steepness(fade) * max(ratios) + 1.5 / fade * ratio
        if by_normal > 0.0:  # of its depth, and of the way from the capture point, no shorter than the fade
            total += ratio / by_normal + 2.5 / by_normal
    return total
