"""What a bake depends on, as one hash: another hash means that the bake is stale.

It is made of what things are and not of what they are called or in which order they are listed:

* `nodes.py`: shaders and geometry nodes, from the outputs back; `materials.py`: materials and worlds
* `attributes.py`, `geometry.py`, `weights.py`: what objects are made of; `modifiers.py`: what changes that
* `rendered.py`: which objects there are; `objects.py`: where and how they look, and what data blocks are for who points
  to them; `evaluated.py`: what Blender makes of them where nothing else tells
* `pictures.py`: images and files; `scene_settings.py`: what the engines are told
* `digests.py`, `properties.py`: how all of that becomes digests
"""

from __future__ import annotations

from dataclasses import fields
from enum import Enum
from typing import Any

import bpy
import numpy as np

from ....core.content_hash import written
from ....core.errors import ProbeError
from ....core.picture_files import picture_files
from ....core.probe import Engine, ProbeSpec, Source
from ... import compat
from ..node_lines import material_lines, node_lines
from .digests import digest, plain
from .evaluated import Shapes
from .objects import Objects
from .pictures import contents
from .scene_settings import of_scene

__all__ = ["SceneFingerprint", "material_lines", "node_lines"]

# Fields of a probe's record that its pictures depend on; the capture point stands for the box and the offset.
_CAPTURED = [
    field.name
    for field in fields(ProbeSpec)
    if field.name
    not in {"name", "box", "capture_offset", "padding", "falloff", "outside", "corrected", "hidden", "animated"}
    | {"source", "picture", "influence", "followed", "contact_hardening", "forced"}
]


class SceneFingerprint:
    """What the probes of a scene see at its frame; what they share is read once for all of them."""

    def __init__(self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
        view_layer.update()  # what is moved is there then
        self._scene, self._view_layer = scene, view_layer
        self._meshes: dict[int, Any] = {}
        self._shapes = Shapes(view_layer)
        self._engines: dict[bool, _Seen] = {}
        for engine in sorted({o.pcc_probe.engine for o in scene.objects if o.pcc_probe.is_probe}):
            self._seen(Engine(engine))

    def content_hash(self, probe: ProbeSpec) -> str:
        """A text that changes with all that the probe's pictures depend on.

        Raises:
            ProbeError: they are to come from an image that is not there.
        """
        if probe.source is Source.IMAGE:
            return written(_of_image(probe))
        seen = self._seen(probe.engine)
        if probe.source is Source.WORLD:
            settings = (probe.engine.value, probe.resolution, probe.samples, probe.denoise)
            axes = (np.round(probe.box.face_normals, 5) + 0.0).tolist()  # no negative zeros
            return written(digest("world", plain((*settings, axes)), seen.world).hex())
        settings = (getattr(probe, name) for name in _CAPTURED)
        captured = [setting.value if isinstance(setting, Enum) else setting for setting in settings]
        place = np.float32(probe.capture_point).tolist()
        parts = plain((place, *captured)), seen.settings(probe.denoise), seen.world, seen.objects(probe.hidden)
        return written(digest(*parts).hex())

    def _seen(self, engine: Engine) -> _Seen:
        is_eevee = engine is Engine.EEVEE
        if is_eevee not in self._engines:
            self._engines[is_eevee] = _Seen(self._scene, self._view_layer, is_eevee, self._meshes, self._shapes)
        return self._engines[is_eevee]


class _Seen:
    """A scene as one engine shows it."""

    def __init__(
        self,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        is_eevee: bool,
        meshes: dict[int, Any],
        shapes: Shapes,
    ) -> None:
        self._objects = Objects(scene, view_layer, is_eevee, meshes, shapes)
        world = compat.world_override(view_layer) or scene.world
        found = self._objects.materials.world(world)
        self.world = digest(found.digest, *self._objects.extras(found))
        self._settings = {denoise: of_scene(scene, view_layer, is_eevee, denoise) for denoise in (False, True)}
        self._known: dict[frozenset[str], bytes] = {}
        self.objects(())

    def settings(self, is_denoised: bool) -> bytes:
        return self._settings[is_denoised]

    def objects(self, hidden: tuple[str, ...]) -> bytes:
        """All that is seen but for objects of these names."""
        names = frozenset(hidden)
        if names not in self._known:
            self._known[names] = self._objects.seen(names)
        return self._known[names]


def _of_image(probe: ProbeSpec) -> str:
    """Whatever the files of the picture are called.

    Raises:
        ProbeError: there are none, or one cannot be read.
    """
    files = picture_files(probe.name, probe.picture)
    try:
        held = [contents(path) for path in files]
    except OSError as error:
        raise ProbeError(
            f"probe '{probe.name}': its picture '{files[0]}' cannot be read ({error.strerror}); choose another"
        ) from error
    return digest("image", plain(probe.resolution), *held).hex()
