"""How a scene's probes stand: baked or not, stale or not, files there or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..core.errors import PccError
from ..core.probe import Source
from .read.fingerprint import SceneFingerprint
from .read.probes import all_probes, bake_record, check_place, probe_spec
from .store.levels import faulty_picture


@dataclass(frozen=True)
class ProbeStatus:
    """One probe's state.

    Attributes:
        probe: its name.
        state: 'baked', 'stale', 'unbaked' or 'error'.
        why: what makes it so, in words; empty where it is baked.
    """

    probe: str
    state: str
    why: str = ""


def statuses(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> list[ProbeStatus]:
    """The state of every probe of a scene, by name."""
    fingerprint = SceneFingerprint(scene, view_layer)
    return [_status(probe, view_layer, fingerprint) for probe in all_probes(scene)]


def _status(probe: bpy.types.Object, view_layer: bpy.types.ViewLayer, fingerprint: SceneFingerprint) -> ProbeStatus:
    try:
        check_place(probe, view_layer)
        spec = probe_spec(probe)
        record = bake_record(probe)
        changed = record is not None and record.content_hash != fingerprint.content_hash(spec)
    except PccError as error:
        return ProbeStatus(probe.name, "error", str(error))
    if record is None:
        return ProbeStatus(probe.name, "unbaked", "it has no bake")
    fault = faulty_picture(probe, record)
    if fault:
        return ProbeStatus(probe.name, "stale", f"{fault}; bake it again")
    if changed:
        return ProbeStatus(probe.name, "stale", f"{_CHANGED[spec.source]} or the probe changed since its bake")
    return ProbeStatus(probe.name, "baked")


_CHANGED = {Source.BAKE: "the scene", Source.IMAGE: "its image", Source.WORLD: "the world"}


def stale_probes(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, among: Sequence[bpy.types.Object]
) -> list[bpy.types.Object]:
    """Those of `among` that a bake would change: not baked, stale, or faulty (so that the fault is reported)."""
    fresh = {status.probe for status in statuses(scene, view_layer) if status.state == "baked"}
    return [probe for probe in among if probe.name not in fresh]
