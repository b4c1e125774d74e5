"""What a bake depends on, as one hash: another hash means that the bake is stale.

It is made of what things are and not of what they are called or in which order they are listed:

* `nodes.py`: shaders and geometry nodes, from the outputs back; `materials.py`: materials and worlds
* `attributes.py`, `geometry.py`, `weights.py`: what objects are made of; `modifiers.py`: what changes that
* `rendered.py`: which objects there are; `objects.py`: where and how they look, and what data blocks are for who points
  to them; `evaluated.py`: what Blender makes of them where nothing else tells
* `unlit.py`, `bounds.py`: whether nothing scatters light, and where things are: then each face has a hash of its own
* `pictures.py`: images and files; `scene_settings.py`: what the engines are told
* `digests.py`, `properties.py`: how all of that becomes digests
"""

from __future__ import annotations

from dataclasses import fields
from enum import Enum
from types import MappingProxyType
from typing import Any

import bpy
import numpy as np

from ....core.content_hash import written
from ....core.cubemap import FACE_NAMES, OVERSCAN
from ....core.errors import ProbeError
from ....core.face_views import may_show
from ....core.picture_files import picture_files
from ....core.probe import Engine, ProbeSpec, Source
from ... import compat
from .digests import digest, plain, unordered
from .evaluated import Shapes
from .objects import Objects, Placed
from .pictures import contents
from .scene_settings import of_scene
from .unlit import Matt, Unlit

# Fields of a probe's record that its pictures depend on; the capture point stands for the box and the offset.
_CAPTURED = [
    field.name
    for field in fields(ProbeSpec)
    if field.name
    not in {"name", "box", "capture_offset", "padding", "falloff", "outside", "corrected", "hidden", "animated"}
    | {"source", "picture", "influence", "followed", "contact_hardening", "forced"}
    | {"relief", "relief_steps", "relief_refinements", "half_float", "adaptive"}
]


class SceneFingerprint:
    """What the probes of a scene see at its frame; what they share is read once for all of them."""

    def __init__(
        self, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, matt: Matt = MappingProxyType({})
    ) -> None:
        """What is seen now.

        Args:
            scene, view_layer: what is rendered.
            matt: the surfaces whose specular lobes captures do not see; only `face_hashes` asks for them.
        """
        view_layer.update()  # what is moved is there then
        self._scene, self._view_layer = scene, view_layer
        self._unlit = Unlit(view_layer, matt)
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
            settings = (probe.engine.value, probe.resolution, probe.samples, probe.denoise, *_adaptive(probe))
            axes = (np.round(probe.box.face_normals, 5) + 0.0).tolist()  # no negative zeros
            return written(digest("world", plain((*settings, axes)), seen.world).hex())
        parts = _captured(probe), seen.settings(probe.denoise), seen.world, seen.objects(probe.hidden)
        return written(digest(*parts).hex())

    def face_hashes(self, probe: ProbeSpec) -> tuple[str, ...]:
        """Of each face, in the order of `FACES`, a text that changes with all that its picture depends on.

        Empty where it is not proved that nothing scatters light: then a face may depend on what it does not show.
        """
        if probe.source is not Source.BAKE or probe.engine is not Engine.CYCLES:
            return ()
        seen = self._seen(probe.engine)
        if not seen.is_unlit(probe.hidden):
            return ()
        shared = "face", _captured(probe), seen.settings(probe.denoise), seen.world
        return tuple(
            written(digest(*shared, name, unordered(shown)).hex())
            for name, shown in zip(FACE_NAMES, seen.by_face(probe), strict=True)
        )

    def _seen(self, engine: Engine) -> _Seen:
        is_eevee = engine is Engine.EEVEE
        if is_eevee not in self._engines:
            self._engines[is_eevee] = _Seen(
                self._scene, self._view_layer, is_eevee, self._meshes, self._shapes, self._unlit
            )
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
        unlit: Unlit,
    ) -> None:
        self._objects = Objects(scene, view_layer, is_eevee, meshes, shapes)
        world = compat.world_override(view_layer) or scene.world
        found = self._objects.materials.world(world)
        self.world = digest(found.digest, *self._objects.extras(found))
        self._settings = {denoise: of_scene(scene, view_layer, is_eevee, denoise) for denoise in (False, True)}
        self._known: dict[frozenset[str], bytes] = {}
        self._placed: dict[frozenset[str], list[Placed]] = {}
        self._world, self._unlit = world, unlit
        self._proved: dict[frozenset[str], bool] = {}
        self.objects(())

    def settings(self, is_denoised: bool) -> bytes:
        return self._settings[is_denoised]

    def objects(self, hidden: tuple[str, ...]) -> bytes:
        """All that is seen but for objects of these names."""
        names = frozenset(hidden)
        if names not in self._known:
            self._known[names] = self._objects.seen(names)
        return self._known[names]

    def is_unlit(self, hidden: tuple[str, ...]) -> bool:
        """Whether it is proved that nothing scatters light but for objects of these names."""
        names = frozenset(hidden)
        if names not in self._proved:
            self._proved[names] = self._unlit.world(self._world) and self._unlit.proved(self._objects.each(names))
        return self._proved[names]

    def by_face(self, probe: ProbeSpec) -> list[list[bytes]]:
        """For each face the digests of what it may show."""
        placed = self._all_placed(probe.hidden)
        shown = np.ones((len(placed), len(FACE_NAMES)), bool)
        known = [k for k, each in enumerate(placed) if each.boxes is not None]
        if known:
            boxes = [placed[k].boxes for k in known]
            begins = np.cumsum([0, *(len(each) for each in boxes[:-1])])
            met = may_show(np.concatenate(boxes), probe.capture_point, probe.resolution, OVERSCAN)
            shown[known] = np.logical_or.reduceat(met, begins)
        return [[each.digest for each, is_met in zip(placed, face, strict=True) if is_met] for face in shown.T]

    def _all_placed(self, hidden: tuple[str, ...]) -> list[Placed]:
        names = frozenset(hidden)
        if names not in self._placed:
            self._placed[names] = list(self._objects.placed(names))
        return self._placed[names]


def _captured(probe: ProbeSpec) -> str:
    """The settings of a probe that its captures obey, and the place."""
    settings = (getattr(probe, name) for name in _CAPTURED)
    captured = [setting.value if isinstance(setting, Enum) else setting for setting in settings]
    return plain((np.float32(probe.capture_point).tolist(), *captured, *_adaptive(probe)))


def _adaptive(probe: ProbeSpec) -> list[float]:
    """Nothing where it is off, as in all bakes that were made before there was such a setting."""
    return [probe.adaptive] if probe.adaptive else []


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
