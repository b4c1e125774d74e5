"""What stands around a capture point: for captures that came out black because they were taken inside something."""

from __future__ import annotations

import itertools

import bpy
import numpy as np
from mathutils import Vector

from ...core.probe import ProbeSpec, Source

NEARLY_BLACK = 1e-4  # radiance
_NEARLY_ALL = 0.98  # of a capture's pixels
_DIRECTIONS = [Vector(d).normalized() for d in itertools.product((-1, 0, 1), repeat=3) if any(d)]
_ORIGINS = {Source.IMAGE: "the image", Source.WORLD: "the world"}
_STEPS = (-0.6, -0.3, 0.0, 0.3, 0.6)  # of the half edges, where another capture point is looked for


def is_nearly_black(picture: np.ndarray) -> bool:
    """Whether a capture (h, w, 3) shows next to nothing."""
    return bool((picture.max(-1) <= NEARLY_BLACK).mean() >= _NEARLY_ALL)


def black_capture(probe: ProbeSpec, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> str:
    """A sentence on what a nearly black capture has around it, and where it could be taken instead."""
    if probe.source.stretched:
        return f"its picture, {_ORIGINS[probe.source]}, is nearly black; choose another, or set its source to Bake"
    around = _around(scene, view_layer, Vector(probe.capture_point))
    names = sorted({name for name, _ in around})
    near = f": around the capture point stand {', '.join(names[:4])}" if names else ": there is nothing around it"
    offset = _freer_offset(probe, scene, view_layer)
    remedy = "light the scene, or move the capture point out of what it is in"
    if offset is not None and names:
        remedy = f"try a capture offset of ({', '.join(f'{c:.2f}' for c in offset)}) m, or hide what is in the way"
    return f"its capture is nearly black{near}; {remedy}"


def _around(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, point: Vector) -> list[tuple[str, float]]:
    """(object, distance in metres) of what is met first in each of 26 directions."""
    found = []
    for direction in _DIRECTIONS:
        hit, place, _, _, item, _ = scene.ray_cast(view_layer.depsgraph, point, direction)
        if hit:
            found.append((f"'{item.name}'", (place - point).length))
    return found


def _freer_offset(
    probe: ProbeSpec, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
) -> tuple[float, ...] | None:
    """The capture offset within the box from which the nearest thing is farthest, if that is farther than now."""

    def clearance(offset: np.ndarray) -> float:
        point = probe.box.centre + probe.box.axes @ (offset / probe.box.half_extents)
        return min((distance for _, distance in _around(scene, view_layer, Vector(point))), default=0.0)

    candidates = [np.array(steps) * probe.box.half_extents for steps in itertools.product(_STEPS, repeat=3)]
    best = max(candidates, key=clearance)
    return tuple(float(c) for c in best) if clearance(best) > clearance(np.array(probe.capture_offset)) else None
