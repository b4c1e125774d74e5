"""Bakes of which only some faces are missing: nothing that they show has changed, so the others are taken over."""

from __future__ import annotations

import contextlib
from dataclasses import replace

import bpy

from ...core.cubemap import FACE_NAMES
from ...core.errors import BakeError
from ...core.probe import ProbeSpec
from ...core.probe_plan import ProbePlan
from ...core.sidecar import Sidecar
from ...version import ADDON_VERSION
from ..read.probes import bake_record
from ..store.levels import faulty_picture
from .faces import Capture


def capture_of(
    probe: bpy.types.Object, spec: ProbeSpec, plan: ProbePlan, content_hash: str, reuse: bool
) -> tuple[Capture, Sidecar | None]:
    """The capture that a probe needs, and the record of the bake that it completes, if it does.

    Args:
        probe: the probe object.
        spec, plan: of it.
        content_hash: of what it sees now.
        reuse: whether faces that are there already are kept where nothing has changed.
    """
    record = None
    with contextlib.suppress(BakeError):  # a damaged record; a new one comes in its place
        record = bake_record(probe) if reuse else None
    lacking = record.lacks(plan.faces) if record else ()
    picture = next((level.image for level in probe.pcc_probe.levels if level.roughness == 0.0), None)
    if record is None or picture is None or not lacking or not _holds(probe, record, content_hash):
        return Capture(spec, plan.faces), None
    return Capture(spec, lacking, picture), record


def _holds(probe: bpy.types.Object, record: Sidecar, content_hash: str) -> bool:
    """Whether a bake by this very Blender and add-on shows what the probe would see now."""
    by_us = (record.blender, record.addon) == (bpy.app.version_string, ADDON_VERSION)
    return by_us and not record.moments and record.content_hash == content_hash and not faulty_picture(probe, record)


def completed(record: Sidecar, before: Sidecar | None) -> Sidecar:
    """The record of a bake together with what it took over of the one before."""
    if before is None:
        return record
    return replace(
        record,
        seconds=round(before.seconds + record.seconds, 3),
        replaced_pixels=(*before.replaced_pixels, *record.replaced_pixels),
        faces=tuple(name for name in FACE_NAMES if name in before.faces or name in record.faces),
    )
