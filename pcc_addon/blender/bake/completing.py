"""Bakes of which only some faces are missing or show anything else now: the others are taken over."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

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


@dataclass(frozen=True)
class Hashes:
    """What a probe sees now.

    Attributes:
        content: the hash of all of it.
        faces: that of what each face shows; empty where that is not known.
    """

    content: str
    faces: tuple[str, ...]


def capture_of(
    probe: bpy.types.Object, spec: ProbeSpec, plan: ProbePlan, seen: Hashes, reuse: bool
) -> tuple[Capture, Sidecar | None]:
    """The capture that a probe needs, and the record of the bake that it completes, if it does.

    Args:
        probe: the probe object.
        spec, plan: of it.
        seen: what it sees now.
        reuse: whether faces that are there already are kept where nothing has changed.
    """
    record = None
    with contextlib.suppress(BakeError):  # a damaged record; a new one comes in its place
        record = bake_record(probe) if reuse else None
    picture = next((level.image for level in probe.pcc_probe.levels if level.roughness == 0.0), None)
    if record is None or picture is None or record.half_float != spec.half_float or not _holds(probe, record):
        return Capture(spec, plan.faces), None
    surveys = spec.captures_distance and record.departure is None
    changed, lacking = record.changed(seen.content, seen.faces), record.lacks(plan.faces)
    wanted = tuple(name for name in FACE_NAMES if name in changed or name in lacking)
    if (not wanted and not surveys) or set(record.faces) <= set(changed) or (changed and _guesses(record, wanted)):
        return Capture(spec, plan.faces), None
    return Capture(spec, wanted, picture), record


def _guesses(record: Sidecar, wanted: Sequence[str]) -> bool:
    """Whether a face would be left that is guessed from the overscan of others, which is stored nowhere."""
    return bool(set(record.lacks(FACE_NAMES)) - set(wanted))


def _holds(probe: bpy.types.Object, record: Sidecar) -> bool:
    """Whether a bake is whole, and by this very Blender and add-on."""
    by_us = (record.blender, record.addon) == (bpy.app.version_string, ADDON_VERSION)
    return by_us and not record.moments and not faulty_picture(probe, record)


def completed(record: Sidecar, before: Sidecar | None) -> Sidecar:
    """The record of a bake together with what it took over of the one before."""
    if before is None:
        return record
    again = tuple(f"face {name}: " for name in record.faces)
    kept = (words for words in before.replaced_pixels if not words.startswith(again))
    return replace(
        record,
        seconds=round(before.seconds + record.seconds, 3),
        replaced_pixels=(*kept, *record.replaced_pixels),
        face_hashes=record.face_hashes if before.face_hashes else (),
        faces=tuple(name for name in FACE_NAMES if name in before.faces or name in record.faces),
    )
