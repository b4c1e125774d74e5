"""Six pictures of a scene from one point: sees what a reflection ray would see, and leaves no trace."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.cubemap import FACES
from ...core.errors import BakeError
from ...core.probe import Engine, ProbeSpec
from .. import compat
from ..overrides import override, temporary
from ..read.scene import rendered_objects
from ..rendering import Renderer, RenderSettings
from . import lamps

OVERSCAN = 8  # pixels on each side, so that denoising and filtering at an edge have real neighbours
_SENSOR = 36.0


class Stage:
    """A scene made ready for captures; close its stack to have the scene back as it was."""

    def __init__(self, stack: ExitStack, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
        self.scene = scene
        self.view_layer = view_layer
        self._renderer = Renderer(stack, scene, view_layer)
        _quiet_render(stack, scene)
        _set_engines(stack, scene)
        _show_as_reflected(stack, scene, view_layer)
        camera = temporary(stack, bpy.data.cameras, bpy.data.cameras.new("pcc capture"))
        self.camera = temporary(stack, bpy.data.objects, bpy.data.objects.new("pcc capture", camera))
        scene.collection.objects.link(self.camera)
        override(stack, scene, "camera", self.camera)

    def aim(self, stack: ExitStack, probe: ProbeSpec) -> None:
        """Set the engine and the camera for one probe, and what is hidden from it until `stack` closes."""
        scene, camera = self.scene, self.camera.data
        self._renderer.use(_settings(probe))
        for name in probe.hidden:
            override(stack, bpy.data.objects[name], "hide_render", True)
        if probe.engine is Engine.EEVEE and not compat.EEVEE_DRAWS_LAMPS:
            lamps.add_stand_ins(stack, scene, Vector(probe.capture_point), probe.clip_end)
        camera.sensor_fit = "HORIZONTAL"
        camera.sensor_width = _SENSOR
        camera.lens = 0.5 * _SENSOR * probe.resolution / _size(probe)  # the inner pixels span exactly 90°
        camera.clip_start, camera.clip_end = probe.clip_start, probe.clip_end

    def face(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """Render one face: (n + 2·OVERSCAN, same, 3) float32 scene-linear radiance, row 0 at the bottom.

        Raises:
            Cancelled: the user stopped the render.
            BakeError: the render gave no picture, or one of another size.
        """
        rotation = Matrix(FACES[index].rotation.tolist()).to_4x4()
        self.camera.matrix_world = Matrix.Translation(Vector(probe.capture_point)) @ rotation
        what = f"probe '{probe.name}': face {FACES[index].name}"
        picture, size = self._renderer.picture(what).pixels, _size(probe)
        if picture.shape[:2] != (size, size):
            raise BakeError(
                f"{what} came out {picture.shape[1]}×{picture.shape[0]} pixels instead of {size}×{size}; another "
                "add-on may change render settings"
            )
        return picture

    def glimpse(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """A face by Cycles of one sample for each pixel, without the denoiser that would hide its faults."""
        self._renderer.use(replace(_settings(probe), samples=1, denoise=False))
        try:
            return self.face(probe, index)
        finally:
            self._renderer.use(_settings(probe))


def _size(probe: ProbeSpec) -> int:
    """Pixels along a rendered face."""
    return probe.resolution + 2 * OVERSCAN


def _settings(probe: ProbeSpec) -> RenderSettings:
    return RenderSettings(probe.engine, probe.samples, probe.denoise, _size(probe), _size(probe))


def _quiet_render(stack: ExitStack, scene: bpy.types.Scene) -> None:
    """No post-processing, no borders, no motion blur: the plain radiance of the scene."""
    render = scene.render
    for name, value in (
        ("pixel_aspect_x", 1.0),
        ("pixel_aspect_y", 1.0),
        ("use_border", False),
        ("use_multiview", False),
        ("use_motion_blur", False),
        ("use_compositing", False),
        ("use_sequencer", False),
        ("use_freestyle", False),
        ("use_stamp", False),
        ("use_single_layer", True),
        ("film_transparent", False),
        ("use_persistent_data", True),
        ("dither_intensity", 0.0),
    ):
        override(stack, render, name, value)


def _set_engines(stack: ExitStack, scene: bpy.types.Scene) -> None:
    """What either engine would add to or take from the radiance."""
    override(stack, scene.eevee, "use_overscan", False)
    for name, value in (
        ("time_limit", 0.0),
        ("use_adaptive_sampling", False),
        ("film_exposure", 1.0),
        ("pixel_filter_type", "BOX"),
        ("film_transparent_glass", False),
    ):
        override(stack, scene.cycles, name, value)


def _show_as_reflected(stack: ExitStack, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
    """Let cameras see what glossy rays see: lamps, and objects that only reflections show, but no camera-only ones."""
    for item in rendered_objects(scene, view_layer):
        override(stack, item, "visible_camera", item.visible_glossy)
        override(stack, item, "is_holdout", False)
    visibility = getattr(scene.world, "cycles_visibility", None)
    if visibility is not None:
        override(stack, visibility, "camera", visibility.glossy)
    _clear_camera_only_flags(stack, view_layer.layer_collection)


def _clear_camera_only_flags(stack: ExitStack, layer: bpy.types.LayerCollection) -> None:
    override(stack, layer, "holdout", False)
    override(stack, layer, "indirect_only", False)
    for child in layer.children:
        _clear_camera_only_flags(stack, child)
