"""Making probe objects, and their lasting identity."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Vector

from ..core.errors import BakeError, ProbeError
from .read.holders import Holders
from .read.probes import bake_record

_INFINITE = float(np.finfo(np.float32).max)  # an operator's properties turn infinity into this


def add_probe(
    collection: bpy.types.Collection,
    name: str,
    location: Sequence[float],
    rotation: Sequence[float],
    half_extents: Sequence[float],
    capture_offset: Sequence[float],
) -> bpy.types.Object:
    """A new probe in `collection`; rotation in radians (XYZ), lengths in metres.

    Raises:
        ProbeError: a number is not finite, or a half extent is 0.
    """
    numbers = [*location, *rotation, *half_extents, *capture_offset]
    if not (np.abs(numbers) < _INFINITE).all():
        raise ProbeError(f"probe '{name}': location, rotation, half extents and capture offset must be finite numbers")
    if 0.0 in half_extents:
        raise ProbeError(f"probe '{name}': half extents of 0 make a box without volume; give lengths above 0 m")
    probe = bpy.data.objects.new(name, None)
    probe.empty_display_type = "CUBE"
    probe.empty_display_size = 1.0
    probe.location = Vector(location)
    probe.rotation_euler = Euler(rotation, "XYZ")
    probe.scale = Vector(half_extents)
    probe.pcc_probe.is_probe = True
    probe.pcc_probe.capture_offset = capture_offset
    collection.objects.link(probe)
    return probe


def ensure_uid(probe: bpy.types.Object, holders: Holders | None = None) -> str:
    """The probe's lasting identity; a copy of a probe gets its own, the original keeps its.

    Args:
        probe: the probe object.
        holders: who has which identity, where that was asked before.
    """
    settings, holders = probe.pcc_probe, holders or Holders()
    before = settings.uid
    if not before or (holders.share_identity(before) and _baked_as(probe) != probe.name):
        settings.uid = uuid.uuid4().hex
        holders.let_go_identity(before)
    return settings.uid


def keep_pictures_found(folder: Path) -> None:
    """Name the pictures that probes are given by whole paths, where the file is about to be saved in another folder."""
    if not bpy.data.filepath or Path(bpy.data.filepath).resolve().parent == folder:
        return
    for probe in bpy.data.objects:
        if probe.pcc_probe.is_probe and not probe.library and probe.pcc_probe.picture.startswith("//"):
            probe.pcc_probe.picture = bpy.path.abspath(probe.pcc_probe.picture)


def _baked_as(probe: bpy.types.Object) -> str | None:
    """The name that a probe had at its last bake, or None where that cannot be told."""
    try:
        record = bake_record(probe)
    except BakeError:  # a damaged record is mended by the bake that asks
        return None
    return record.probe if record else None
