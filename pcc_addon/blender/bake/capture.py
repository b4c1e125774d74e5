"""Six pictures of a scene from one point: sees what a reflection ray would see, and leaves no trace."""

from __future__ import annotations

from contextlib import ExitStack

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.cubemap import FACES
from ...core.errors import BakeError, Cancelled
from ...core.probe import Engine, ProbeSpec
from ...core.workplace import WORKPLACE, temporary_folder
from .. import compat
from ..overrides import override, temporary
from ..read.scene import rendered_objects
from ..store import pictures
from . import lamps

OVERSCAN = 8  # pixels on each side, so that denoising and filtering at an edge have real neighbours
_SENSOR = 36.0


class Stage:
    """A scene made ready for captures; close its stack to have the scene back as it was."""

    def __init__(self, stack: ExitStack, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> None:
        self.scene = scene
        self.view_layer = view_layer
        self._folder = stack.enter_context(temporary_folder(WORKPLACE))
        stack.callback(compat.set_float_exr(scene.render.image_settings))
        _quiet_render(stack, scene)
        _show_as_reflected(stack, scene, view_layer)
        camera = temporary(stack, bpy.data.cameras, bpy.data.cameras.new("pcc capture"))
        self.camera = temporary(stack, bpy.data.objects, bpy.data.objects.new("pcc capture", camera))
        scene.collection.objects.link(self.camera)
        override(stack, scene, "camera", self.camera)

    def aim(self, stack: ExitStack, probe: ProbeSpec) -> None:
        """Set the engine, the camera and what is hidden for one probe, until `stack` closes."""
        scene, camera = self.scene, self.camera.data
        _set_engine(stack, scene, probe)
        for name in probe.hidden:
            override(stack, bpy.data.objects[name], "hide_render", True)
        if probe.engine is Engine.EEVEE and not compat.EEVEE_DRAWS_LAMPS:
            lamps.add_stand_ins(stack, scene, Vector(probe.capture_point), probe.clip_end)
        size = probe.resolution + 2 * OVERSCAN
        override(stack, scene.render, "resolution_x", size)
        override(stack, scene.render, "resolution_y", size)
        camera.sensor_fit = "HORIZONTAL"
        camera.sensor_width = _SENSOR
        camera.lens = 0.5 * _SENSOR * probe.resolution / size  # the inner pixels span exactly 90°
        camera.clip_start, camera.clip_end = probe.clip_start, probe.clip_end

    def face(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """Render one face: (n + 2·OVERSCAN, same, 3) float32 scene-linear radiance, row 0 at the bottom.

        Raises:
            Cancelled: the user stopped the render.
        BakeError: the render gave no picture.
        """
        rotation = Matrix(FACES[index].rotation.tolist()).to_4x4()
        self.camera.matrix_world = Matrix.Translation(Vector(probe.capture_point)) @ rotation
        result = bpy.ops.render.render(scene=self.scene.name, layer=self.view_layer.name)
        if "FINISHED" not in result:
            raise Cancelled(f"probe '{probe.name}': rendering face {FACES[index].name} was stopped")
        image = _render_result()
        path = self._folder / "face.exr"
        image.save_render(str(path), scene=self.scene)
        picture = pictures.read_file(path)
        size = probe.resolution + 2 * OVERSCAN
        if picture.shape[:2] != (size, size):
            raise BakeError(
                f"probe '{probe.name}': face {FACES[index].name} came out {picture.shape[1]}×{picture.shape[0]} "
                f"pixels instead of {size}×{size}; another add-on may change render settings"
            )
        return picture

    def glimpse(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """A face by Cycles of one sample for each pixel, without the denoiser that would hide its faults."""
        with ExitStack() as stack:
            override(stack, self.scene.cycles, "samples", 1)
            override(stack, self.scene.cycles, "use_denoising", False)
            return self.face(probe, index)


def _render_result() -> bpy.types.Image | None:
    """The image that renders appear in, whatever the user has called it; None before the first render."""
    return next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)


def _quiet_render(stack: ExitStack, scene: bpy.types.Scene) -> None:
    """No post-processing, no borders, no motion blur: the plain radiance of the scene."""
    render = scene.render
    for name, value in (
        ("resolution_percentage", 100),
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
    results = _render_result()
    if results is not None and len(results.render_slots) > 1:  # keep the picture that the user is looking at
        override(stack, results.render_slots, "active_index", len(results.render_slots) - 1)


def _set_engine(stack: ExitStack, scene: bpy.types.Scene, probe: ProbeSpec) -> None:
    override(stack, scene.render, "engine", compat.engine_id(probe.engine))
    if probe.engine is Engine.EEVEE:
        override(stack, scene.eevee, "taa_render_samples", probe.samples)
        override(stack, scene.eevee, "use_overscan", False)
        return
    for name, value in (
        ("samples", probe.samples),
        ("time_limit", 0.0),
        ("use_denoising", probe.denoise),
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
