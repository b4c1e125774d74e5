"""Moving parts of a probe: a wall of its box, of its influence, its capture point. What is not moved stays."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from ..core.dragging import Wall, farthest_in
from ..core.probe import ProbeSpec
from .read.probes import bake_record, probe_spec

Triple = tuple[float, float, float]
_ELSEWHERE = 1e-4  # metres from where the pictures were taken


@dataclass(frozen=True, eq=False)
class Before:
    """A probe before something is moved.

    Attributes:
        spec: the probe.
        location, scale: its own, as its parents see it.
        edges: (3, 3) columns: the half edges of its box, as its parents see them, metres.
    """

    spec: ProbeSpec
    location: Triple
    scale: Triple
    edges: np.ndarray


def before(probe: bpy.types.Object) -> Before:
    """A probe as it is.

    Raises:
        ProbeError: its transform is faulty.
    """
    edges = np.array(probe.matrix_basis)[:3, :3] * probe.empty_display_size
    return Before(probe_spec(probe), tuple(probe.location), tuple(probe.scale), edges)


def move_wall(probe: bpy.types.Object, start: Before, wall: Wall, metres: float) -> float:
    """Move a wall outwards from where it was, or inwards, as far as something is left.

    A wall of the box leaves the opposite one, the capture point and how far the influence reaches beyond the box where
    they are. Whatever parents and turns the probe has, location and scale along one axis give it that exactly.

    Returns:
        How far it is moved, metres.
    """
    metres = max(metres, farthest_in(start.spec, wall))
    if wall.influence:
        name = "influence_high" if wall.high else "influence_low"
        reach = list(start.spec.influence.high if wall.high else start.spec.influence.low)
        reach[wall.axis] += metres
        setattr(probe.pcc_probe, name, reach)
        return metres
    share = metres / (2.0 * float(start.spec.box.half_extents[wall.axis]))
    scale = list(start.scale)
    scale[wall.axis] *= 1.0 + share
    probe.scale = scale
    probe.location = Vector(start.location) + Vector(start.edges[:, wall.axis] * (wall.sign * share))
    if start.spec.followed is None and not start.spec.source.stretched:
        offset = list(start.spec.capture_offset)
        offset[wall.axis] -= wall.sign * 0.5 * metres
        probe.pcc_probe.capture_offset = offset
    return metres


def move_capture_point(probe: bpy.types.Object, start: Before, by: Triple) -> None:
    """Move the capture point from where it was, metres along the box's own axes; it counts from the next bake."""
    probe.pcc_probe.capture_offset = [old + way for old, way in zip(start.spec.capture_offset, by, strict=True)]


def captured_elsewhere(probe: bpy.types.Object) -> bool:
    """Whether the pictures that a probe shows were not taken where its capture point is now.

    Raises:
        PccError: its transform or its record is faulty.
    """
    record, spec = bake_record(probe), probe_spec(probe)
    if record is None or record.source.stretched:
        return False
    return float(np.abs(record.capture_point - spec.capture_point).max()) > _ELSEWHERE + spec.boundary


def restore(probe: bpy.types.Object, start: Before) -> None:
    """Give a probe back all that can be moved."""
    probe.location, probe.scale = start.location, start.scale
    settings = probe.pcc_probe
    settings.capture_offset = start.spec.capture_offset
    settings.influence_low, settings.influence_high = start.spec.influence.low, start.spec.influence.high
