"""How a scene's probes stand: baked or not, stale or not, files there or not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import bpy

from ..core.content_hash import VERSION, version_of
from ..core.errors import PccError
from ..core.faces_needed import said
from ..core.frames import STILL, FrameRange, spans
from ..core.plan import Plan, make_plan
from ..core.probe import ProbeSpec, Source
from ..core.probe_plan import told_copy
from ..core.sequence import changed_frames
from ..core.sidecar import Sidecar
from ..core.words import listed
from .read.fingerprint import SceneFingerprint
from .read.frames import at_frame, frames_of, visit
from .read.probes import all_probes, bake_record, check_place, probe_spec, told_overridden
from .read.scene import read_scene
from .shade.captured import seen_matt
from .shade.outdated import outdated
from .store.levels import faulty_picture

NO_BAKE = "it has no bake"


@dataclass(frozen=True)
class ProbeStatus:
    """One probe's state.

    Attributes:
        probe: its name.
        state: 'baked', 'stale', 'unbaked' or 'error'.
        why: what makes it so, in words; empty where it is baked.
        frames: of a sequence, in words; empty for a still.
        stale_frames: those of them at which it sees something else now.
        unneeded: why it needs no bake, in words; empty: it needs one.
        outdated: in words, what its materials would show otherwise after an injection.
        copy_of: the name of the probe whose pictures it shows, as it is a copy without a bake of its own; empty: none.
    """

    probe: str
    state: str
    why: str = ""
    frames: str = ""
    stale_frames: tuple[int, ...] = ()
    unneeded: str = ""
    outdated: tuple[str, ...] = ()
    copy_of: str = ""

    @property
    def words(self) -> str:
        """All that there is to say of it."""
        said = [told_copy(self.copy_of)] * bool(self.copy_of)
        said += [self.why] * bool(self.why)
        if self.unneeded and self.state == "unbaked":
            said = [f"{NO_BAKE} and needs none: {self.unneeded}"]
        elif self.unneeded and self.state != "baked":
            said.append(f"it needs no bake: {self.unneeded}")
        if self.outdated:
            said.append(f"inject again: {'; '.join(self.outdated)}")
        return "; ".join(said)


def statuses(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> list[ProbeStatus]:
    """The state of every probe of a scene, by name; goes through the frames of sequences and back."""
    return planned_statuses(scene, view_layer)[1]


def planned_statuses(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> tuple[Plan, list[ProbeStatus]]:
    """`statuses`, and the plan that they are held to."""
    probes = all_probes(scene)
    reading = read_scene(scene, view_layer)
    plan = make_plan(reading)
    late = outdated(reading, plan, {probe.name: probe for probe in probes})
    fingerprint = SceneFingerprint(scene, view_layer, seen_matt(plan))
    seen = _seen_by_sequences(scene, view_layer, [probe for probe in probes if frames_of(probe)])
    faces = {probe.probe: probe.faces for probe in plan.probes}
    found = [
        _status(probe, view_layer, fingerprint, seen.get(probe.name, {}), faces.get(probe.name, ())) for probe in probes
    ]
    unneeded = {probe.probe: probe.unneeded for probe in plan.probes}
    originals = {probe.name: probe.copy_of for probe in reading.probes}
    return plan, [
        replace(
            status,
            unneeded=unneeded.get(status.probe, ""),
            outdated=late.get(status.probe, ()),
            copy_of=originals[status.probe],
        )
        for status in found
    ]


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
        still = record if record and not record.moments else None
        now = fingerprint.content_hash(spec) if still else ""
        faces = fingerprint.face_hashes(spec) if still and still.content_hash != now and still.face_hashes else ()
    except PccError as error:
        return ProbeStatus(probe.name, "error", str(error))
    if record is None:
        return ProbeStatus(probe.name, "unbaked", NO_BAKE)
    found = _status_of_bake(probe, spec, record, now, faces, seen, needed)
    if found.state == "stale" and probe.override_library:
        return replace(found, why=f"{found.why.removesuffix('; bake it again')}; it {told_overridden(probe)}")
    return found


def _status_of_bake(
    probe: bpy.types.Object,
    spec: ProbeSpec,
    record: Sidecar,
    now: str,
    faces: Sequence[str],
    seen: Mapping[int, str],
    needed: Sequence[str],
) -> ProbeStatus:
    frames = spans(record.frames)
    fault = faulty_picture(probe, record)
    if fault:
        return ProbeStatus(probe.name, "stale", f"{fault}; bake it again", frames)
    if record.moments:
        return _status_of_sequence(spec, record, seen)
    changed = record.changed(now, faces)
    if changed:
        why = _of_another_version([record.content_hash]) or _what_changed(spec, record, changed)
        return ProbeStatus(probe.name, "stale", why)
    if record.half_float != spec.half_float:
        have, wanted = ("half", "full") if record.half_float else ("full", "half")
        why = f"its pictures are kept in {have} precision and are to be in {wanted}; bake it again"
        return ProbeStatus(probe.name, "stale", why)
    if spec.captures_distance and record.departure is None:
        why = "its distances were not captured and are needed now; bake it again, which then renders nothing else"
        return ProbeStatus(probe.name, "stale", why)
    lacking = record.lacks(needed)
    if lacking:
        why = f"its {said(lacking)} not captured and needed now; bake it again, which then renders nothing else"
        return ProbeStatus(probe.name, "stale", why)
    return ProbeStatus(probe.name, "baked")


def _what_changed(spec: ProbeSpec, record: Sidecar, changed: tuple[str, ...]) -> str:
    another = record.blender and record.blender != bpy.app.version_string
    since = f"since its bake by Blender {record.blender}, which may read the file otherwise" if another else _SINCE
    if changed == record.faces:
        return f"{_CHANGED[spec.source]} or the probe changed {since}"
    see = "faces {} see" if len(changed) > 1 else "face {} sees"
    return f"what its {see.format(listed(changed))} changed {since}"


_SINCE = "since its bake"


def _status_of_sequence(spec: ProbeSpec, record: Sidecar, seen: Mapping[int, str]) -> ProbeStatus:
    frames = spans(record.frames)
    changed = changed_frames(record.moments, [seen[frame] for frame in record.frames])
    if not changed:
        return ProbeStatus(spec.name, "baked", "", frames)
    why = _of_another_version([moment.content_hash for moment in record.moments]) or (
        f"{_CHANGED[spec.source]} or the probe changed since its bake at {len(changed)} of its {len(record.moments)} "
        f"frames: {spans(changed)}"
    )
    return ProbeStatus(spec.name, "stale", why, frames, changed)


def _of_another_version(hashes: Sequence[str]) -> str:
    """A sentence where hashes of a bake cannot be compared with those of today; empty where they can."""
    versions = {version_of(content_hash) for content_hash in hashes if content_hash}
    if not versions or versions == {VERSION}:
        return ""
    which = "an earlier" if min(versions) < VERSION else "a later"
    return f"it was baked by {which} version of the add-on, which looked at other things; bake it again"


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
    return _stale(statuses(scene, view_layer), among, frames)


def _stale(
    known: Sequence[ProbeStatus], among: Sequence[bpy.types.Object], frames: FrameRange | str | None
) -> list[bpy.types.Object]:
    fresh = {status.probe for status in known if status.state == "baked"}
    wanted = tuple(frames.frames) if isinstance(frames, FrameRange) else () if frames == STILL else None
    return [p for p in among if p.name not in fresh or (wanted is not None and wanted != frames_of(p))]


@dataclass(frozen=True)
class Waiting:
    """What a bake of stale probes has to do.

    Attributes:
        probes: those that are stale and needed, or faulty.
        unneeded: a sentence for each that is stale and not needed.
    """

    probes: tuple[bpy.types.Object, ...]
    unneeded: tuple[str, ...]


def waiting_probes(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    among: Sequence[bpy.types.Object],
    frames: FrameRange | str | None = None,
) -> Waiting:
    """Of `stale_probes`, with the same arguments, those that anything shows."""
    return waiting_among(statuses(scene, view_layer), among, frames)


def waiting_among(
    found: Sequence[ProbeStatus], among: Sequence[bpy.types.Object], frames: FrameRange | str | None = None
) -> Waiting:
    """`waiting_probes` where it is known how the probes stand."""
    needless = {status.probe: status.unneeded for status in found if status.unneeded and status.state != "error"}
    stale = _stale(found, among, frames)
    sentences = [
        f"probe '{probe.name}' is left as it is: {needless[probe.name]}; select it and bake it if you want it baked"
        for probe in stale
        if probe.name in needless
    ]
    return Waiting(tuple(probe for probe in stale if probe.name not in needless), tuple(sentences))
