"""How a scene's probes stand: baked or not, stale or not, files there or not."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy

from ..core.cubemap import FACE_NAMES
from ..core.errors import PccError
from ..core.faces_needed import said
from ..core.frames import STILL, FrameRange, spans
from ..core.probe import ProbeSpec, Source
from ..core.sequence import changed_frames
from ..core.sidecar import Sidecar
from .planning import plan_scene
from .read.fingerprint import SceneFingerprint
from .read.frames import at_frame, frames_of, visit
from .read.probes import all_probes, bake_record, check_place, probe_spec
from .store.levels import faulty_picture


@dataclass(frozen=True)
class ProbeStatus:
    """One probe's state.

    Attributes:
        probe: its name.
        state: 'baked', 'stale', 'unbaked' or 'error'.
        why: what makes it so, in words; empty where it is baked.
        frames: of a sequence, in words; empty for a still.
        stale_frames: those of them at which it sees something else now.
    """

    probe: str
    state: str
    why: str = ""
    frames: str = ""
    stale_frames: tuple[int, ...] = ()


def statuses(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> list[ProbeStatus]:
    """The state of every probe of a scene, by name; goes through the frames of sequences and back."""
    probes = all_probes(scene)
    fingerprint = SceneFingerprint(scene, view_layer)
    needed = _needed_faces(scene, view_layer, probes)
    seen = _seen_by_sequences(scene, view_layer, [probe for probe in probes if frames_of(probe)])
    return [
        _status(probe, view_layer, fingerprint, seen.get(probe.name, {}), needed.get(probe.name, ()))
        for probe in probes
    ]


def _needed_faces(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probes: Sequence[bpy.types.Object]
) -> dict[str, tuple[str, ...]]:
    """The faces that each probe needs now, by its name; nothing where no bake lacks one, which spares the plan."""
    for probe in probes:
        with contextlib.suppress(PccError):  # which its status tells
            record = bake_record(probe)
            if record is not None and record.lacks(FACE_NAMES):
                return {plan.probe: plan.faces for plan in plan_scene(scene, view_layer).probes}
    return {}


def _seen_by_sequences(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, probes: Sequence[bpy.types.Object]
) -> dict[str, dict[int, str]]:
    """By probe and frame the hash of what it sees, or a sentence on why it cannot be baked there."""
    found: dict[str, dict[int, str]] = {probe.name: {} for probe in probes}
    frames = {probe.name: frames_of(probe) for probe in probes}
    with at_frame(scene):
        for frame in sorted({frame for each in frames.values() for frame in each}):
            visit(scene, view_layer, frame)
            fingerprint = SceneFingerprint(scene, view_layer)
            for probe in probes:
                if frame in frames[probe.name]:
                    try:
                        check_place(probe, view_layer)
                        found[probe.name][frame] = fingerprint.content_hash(probe_spec(probe))
                    except PccError as error:
                        found[probe.name][frame] = str(error)
    return found


def _status(
    probe: bpy.types.Object,
    view_layer: bpy.types.ViewLayer,
    fingerprint: SceneFingerprint,
    seen: Mapping[int, str],
    needed: Sequence[str],
) -> ProbeStatus:
    try:
        check_place(probe, view_layer)
        spec = probe_spec(probe)
        record = bake_record(probe)
        now = fingerprint.content_hash(spec) if record and not record.moments else ""
    except PccError as error:
        return ProbeStatus(probe.name, "error", str(error))
    if record is None:
        return ProbeStatus(probe.name, "unbaked", "it has no bake")
    frames = spans(record.frames)
    fault = faulty_picture(probe, record)
    if fault:
        return ProbeStatus(probe.name, "stale", f"{fault}; bake it again", frames)
    if record.moments:
        return _status_of_sequence(spec, record, seen)
    if record.content_hash != now:
        return ProbeStatus(probe.name, "stale", f"{_CHANGED[spec.source]} or the probe changed since its bake")
    lacking = record.lacks(needed)
    if lacking:
        why = f"its {said(lacking)} not captured and needed now; bake it again, which then renders nothing else"
        return ProbeStatus(probe.name, "stale", why)
    return ProbeStatus(probe.name, "baked")


def _status_of_sequence(spec: ProbeSpec, record: Sidecar, seen: Mapping[int, str]) -> ProbeStatus:
    frames = spans(record.frames)
    changed = changed_frames(record.moments, [seen[frame] for frame in record.frames])
    if not changed:
        return ProbeStatus(spec.name, "baked", "", frames)
    why = (
        f"{_CHANGED[spec.source]} or the probe changed since its bake at {len(changed)} of its {len(record.moments)} "
        f"frames: {spans(changed)}"
    )
    return ProbeStatus(spec.name, "stale", why, frames, changed)


_CHANGED = {Source.BAKE: "the scene", Source.IMAGE: "its image", Source.WORLD: "the world"}


def stale_probes(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    among: Sequence[bpy.types.Object],
    frames: FrameRange | str | None = None,
) -> list[bpy.types.Object]:
    """Those of `among` that a bake would change: not baked, stale, or faulty (so that the fault is reported).

    Args:
        scene, view_layer: what is rendered.
        among: probes.
        frames: those that are to be baked; a probe that has others is stale. `STILL`, or None: as last baked.
    """
    fresh = {status.probe for status in statuses(scene, view_layer) if status.state == "baked"}
    wanted = tuple(frames.frames) if isinstance(frames, FrameRange) else () if frames == STILL else None
    return [p for p in among if p.name not in fresh or (wanted is not None and wanted != frames_of(p))]
