"""What the measurements of a run depend on, as one text: where it is another, they are of something else."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, replace

import bpy

from ...core.influence import Influence
from ...core.probe import ProbeSpec
from ...version import ADDON_VERSION
from ..read.fingerprint import SceneFingerprint
from ..read.probes import probe_spec
from .partner import partner_of
from .question import Subject

_LENS = (
    "type", "lens", "sensor_fit", "sensor_width", "sensor_height", "shift_x", "shift_y", "clip_start", "clip_end",
    "ortho_scale",
)  # fmt: skip
_PICTURE = ("pixel_aspect_x", "pixel_aspect_y", "use_motion_blur", "motion_blur_shutter")


def run_key(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, subject: Subject) -> str:
    """A text that changes with the scene at its frame, the probe's box and influence, the camera, and what is asked.

    What is measured at many values (resolution, samples, correction …) does not count.
    """
    spec = probe_spec(subject.probe)
    camera = subject.camera
    partner = partner_of(subject.probe, scene, view_layer)
    fingerprint = SceneFingerprint(scene, view_layer)
    parts = [
        fingerprint.content_hash(_at_its_default(spec)),
        _plain(spec.influence),
        fingerprint.content_hash(_at_its_default(probe_spec(partner))) if partner else "",
        spec.box.axes.tolist(),
        spec.box.centre.tolist(),
        [spec.padding, spec.falloff, spec.outside.value, spec.contact_hardening],
        [sorted(effect.value for effect in effects) for effects in (spec.forced.on, spec.forced.off)],
        [list(row) for row in camera.matrix_world],
        [getattr(camera.data, name) for name in _LENS],
        [camera.data.dof.use_dof, camera.data.dof.focus_distance, camera.data.dof.aperture_fstop],
        [getattr(scene.render, name) for name in _PICTURE],
        [subject.engine.value, subject.size.width, subject.size.height, *subject.frames],
        [bpy.app.version_string, ADDON_VERSION],
    ]
    return hashlib.blake2b(json.dumps(parts).encode(), digest_size=12).hexdigest()


def _at_its_default(spec: ProbeSpec) -> ProbeSpec:
    """A probe with what is measured at many values as in a new one."""
    new = ProbeSpec
    return replace(spec, resolution=new.resolution, samples=new.samples, denoise=new.denoise, adaptive=new.adaptive)


def _plain(influence: Influence) -> list[tuple[str, object]]:
    named = asdict(influence).items()
    return [(name, sorted(value) if isinstance(value, frozenset) else value) for name, value in named]
