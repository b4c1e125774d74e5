"""The probe that shares a room with the one that is measured."""

from __future__ import annotations

import bpy
import numpy as np

from ...core.errors import PccError
from ...core.probe import ProbeSpec, Source
from ..read.probes import all_probes, check_place, probe_spec


def partner_of(
    probe: bpy.types.Object, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
) -> bpy.types.Object | None:
    """The nearest other probe that renders its pictures, where the middle of one's box is in the other's; or None.

    Boxes of neighbouring rooms overlap a little at most. Faulty probes are passed over.
    """
    own = probe_spec(probe)
    found = []
    for other in all_probes(scene):
        if other == probe:
            continue
        try:
            check_place(other, view_layer)
            spec = probe_spec(other)
        except PccError:  # status tells
            continue
        if spec.source is Source.BAKE and (_has(own, spec.box.centre) or _has(spec, own.box.centre)):
            found.append((float(np.linalg.norm(spec.capture_point - own.capture_point)), other.name, other))
    return min(found)[2] if found else None


def _has(spec: ProbeSpec, point: np.ndarray) -> bool:
    return bool((np.abs(spec.box.coordinates(point[None])) <= spec.box.half_widths).all())
