"""Making probe objects, and their lasting identity."""

from __future__ import annotations

import hashlib
import itertools
import os
import uuid
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler, Vector

from ..core.errors import BakeError, ProbeError
from ..core.workplace import real
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


def ensure_uid(probe: bpy.types.Object, holders: Holders | None = None, folder: Path | None = None) -> str:
    """Give a probe its `lasting_uid`; arguments as there."""
    holders = holders or Holders()
    before, probe.pcc_probe.uid = probe.pcc_probe.uid, lasting_uid(probe, holders, folder)
    if probe.pcc_probe.uid != before:
        holders.let_go_identity(before)
    return probe.pcc_probe.uid


def lasting_uid(probe: bpy.types.Object, holders: Holders, folder: Path | None = None) -> str:
    """The probe's lasting identity, or the one that it is to have; a copy gets its own, the original keeps its.

    A new one is made of the probe's name and the file's place as seen from the pictures, so that it is the same at each
    bake of a file that is not saved, and on each machine. Without files it is drawn.

    Args:
        probe: the probe object.
        holders: who has which identity.
        folder: where its pictures go; None packs them.
    """
    before = probe.pcc_probe.uid
    if before and not (holders.share_identity(before) and _baked_as(probe) != probe.name):
        return before
    if folder is None or not bpy.data.filepath:
        return uuid.uuid4().hex
    blend = real(bpy.data.filepath)
    try:
        place = Path(os.path.relpath(blend, folder)).as_posix()
    except ValueError:  # another drive
        place = blend.as_posix()
    candidates = (_uid_of(place, probe.name, str(k)) for k in itertools.count())
    return next(uid for uid in candidates if not holders.has_identity(uid))


def _uid_of(*words: str) -> str:
    return hashlib.blake2b("\n".join(words).encode(), digest_size=16).hexdigest()


def keep_pictures_found(folder: Path) -> None:
    """Name the pictures that probes are given by whole paths, where the file is about to be saved in another folder."""
    if not bpy.data.filepath or real(bpy.data.filepath).parent == folder:
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
