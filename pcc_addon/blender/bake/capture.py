"""Six pictures of a scene from one point: sees what a reflection ray would see, and leaves no trace."""

from __future__ import annotations

import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.cubemap import FACE_NAMES, FACES, OVERSCAN, Face
from ...core.errors import BakeError
from ...core.probe import Engine, ProbeSpec
from .. import compat
from ..overrides import override, temporary
from ..read.scene import rendered_objects
from ..rendering import Renderer, RenderSettings
from . import lamps, survey

_SENSOR = 36.0
# What Cycles takes in every render, and in each of its views: in camera rays with their bounces, about 1 µs each
# (measured: benchmarks/renders_together.py).
_OF_AN_OBJECT, _OF_A_MATERIAL, _OF_BOTH, _OF_AN_OBJECT_IN_VIEW = 40.0, 300.0, 0.06, 3.0
# All views of a render may take so many times what it takes whatever it shows: nobody can stop it between two.
_VIEWS_TO_REST = 1
_TOGETHER, _PIXELS_TOGETHER = 64, 2**22  # probes and pixels of one render at most, as these are held at once


class Stage:
    """A scene made ready for captures; close its stack to have the scene back as it was.

    Attributes:
        owed: seconds by a probe's name that its faces took while another's were asked for; below 0 for that other one.
    """

    def __init__(
        self,
        stack: ExitStack,
        scene: bpy.types.Scene,
        view_layer: bpy.types.ViewLayer,
        probes: Sequence[ProbeSpec],
        at_once: int = 0,
        faces: Mapping[str, Sequence[str]] | None = None,
        most_seconds: float = 0.0,
    ) -> None:
        """A stage for some probes.

        Args:
            stack: what closes the stage.
            scene, view_layer: what is rendered.
            probes: all that will be captured, in order; faces of the next ones may be rendered with those of one.
            at_once: of how many probes `expect` will be told at most.
            faces: by a probe's name the names of those that will be asked for; of others all are.
            most_seconds: after which Cycles gives a picture as it is then, too noisy to be kept; 0: never.
        """
        self.scene = scene
        self.view_layer = view_layer
        self.owed: dict[str, float] = {}
        compat.detach_compositor(stack, scene)
        self._renderer = Renderer(stack, scene, view_layer)
        _quiet_render(stack, scene)
        _set_engines(stack, scene, most_seconds)
        _show_as_reflected(stack, scene, view_layer)
        view_layer.update()
        self._things = len(view_layer.depsgraph.object_instances)
        self._probes = list(probes)
        self._faces = faces or {}
        self._surveying = False
        self._most = 1 if _looks_at_camera(scene) else min(max(len(self._probes), at_once), _TOGETHER)
        self._lens = temporary(stack, bpy.data.cameras, bpy.data.cameras.new("pcc capture"))
        name = f"pcc capture {uuid.uuid4().hex}"  # which nobody has: views find their cameras by name
        count = len(FACES) * max(self._most, 1)
        self._cameras = _cameras(stack, scene, self._lens, [f"{name} {k}" for k in range(count)])
        override(stack, scene, "camera", self._cameras[0])
        self._ready: dict[tuple[ProbeSpec, RenderSettings, int], np.ndarray] = {}  # rendered with others, not asked for

    def expect(self, probes: Sequence[ProbeSpec]) -> None:
        """The scene is another, as at another frame: these probes will be captured next, in order."""
        self._probes = list(probes)
        self._ready.clear()

    def aim(self, stack: ExitStack, probe: ProbeSpec) -> None:
        """Set the engine and the camera for one probe, and what is hidden from it until `stack` closes."""
        scene, lens = self.scene, self._lens
        coming = self._coming(probe)
        self._ready = {key: face for key, face in self._ready.items() if key[0] in coming}
        self._renderer.use(_settings(probe))
        by_eevee = probe.engine is Engine.EEVEE and not self._surveying
        for name in probe.hidden:
            override(stack, bpy.data.objects[name], "hide_render", True)
        if by_eevee and not compat.EEVEE_DRAWS_LAMPS:
            lamps.add_stand_ins(stack, scene, Vector(probe.capture_point), probe.clip_end)
        lens.sensor_fit = "HORIZONTAL"
        lens.sensor_width = _SENSOR
        lens.lens = 0.5 * _SENSOR * probe.resolution / _size(probe)  # the inner pixels span exactly 90°
        lens.clip_start, lens.clip_end = probe.clip_start, probe.clip_end
        self._place_cameras([(probe, face) for face in FACES])

    def face(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """Render one face: (n + 2·OVERSCAN, same, 3) float32 scene-linear radiance, row 0 at the bottom.

        Raises:
            Cancelled: the user stopped the render.
            BakeError: the render gave no picture, or one of another size.
        """
        return self._face(probe, index, _settings(probe))

    def glimpse(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """A face by Cycles of one sample for each pixel, without the denoiser that would hide its faults."""
        return self._face(probe, index, replace(_settings(probe), samples=1, denoise=False, adaptive=0.0))

    @contextmanager
    def survey(self) -> Iterator[None]:
        """Let faces show meanwhile how near things are, for `nearness`; whole surveys belong together.

        After each change of what materials are, a renderer reads the scene anew.
        """
        with ExitStack() as stack:
            survey.show_nearness(stack, self.scene, self.view_layer)
            override(stack, self, "_surveying", True)
            self._ready.clear()
            stack.callback(self._ready.clear)
            yield

    def nearness(self, probe: ProbeSpec, index: int) -> np.ndarray:
        """One face during a `survey`: (n + 2·OVERSCAN, same, 3) float32, 1/metres, three times the same.

        That is the reciprocal of the distance from the capture point, through the centre of each pixel; 0 where nothing
        is. By Cycles, whatever the probe's engine.

        Raises:
            Cancelled, BakeError: as `face`.
        """
        size = _size(probe)
        return self._face(probe, index, RenderSettings(Engine.CYCLES, 1, False, size, size, 0.0))

    def _face(self, probe: ProbeSpec, index: int, settings: RenderSettings) -> np.ndarray:
        self._renderer.use(settings)
        if not self._probes_at_once(settings):
            what = f"probe '{probe.name}': face {FACES[index].name}"
            self.scene.camera = self._cameras[index]
            return _checked(what, self._renderer.picture(what).pixels, settings)
        if (probe, settings, index) not in self._ready:
            self._render_together(probe, settings, FACES[index])
        return self._ready.pop((probe, settings, index))

    def _render_together(self, probe: ProbeSpec, settings: RenderSettings, asked: Face) -> None:
        """Render a face of a probe, its others, and those of probes that come after it and are captured alike."""
        begin = time.perf_counter()
        probes = self._alike(probe, settings)
        views = [
            (each, face)
            for each in probes
            for face in FACES
            if self._is_asked_for(each, face) or (each is probe and face is asked)
        ]
        self._place_cameras(views)
        what = f"probe '{probe.name}': its faces"
        pictures = self._renderer.views(what, self._cameras[: len(views)])
        for (each, face), picture in zip(views, pictures, strict=True):
            self._ready[each, settings, FACES.index(face)] = _checked(what, picture, settings)
        seconds = time.perf_counter() - begin
        self.owed[probe.name] = self.owed.get(probe.name, 0.0) - seconds
        for each, _ in views:
            self.owed[each.name] = self.owed.get(each.name, 0.0) + seconds / len(views)

    def _is_asked_for(self, probe: ProbeSpec, face: Face) -> bool:
        return self._surveying or face.name in self._faces.get(probe.name, FACE_NAMES)

    def _alike(self, probe: ProbeSpec, settings: RenderSettings) -> list[ProbeSpec]:
        """The probes whose faces are rendered with those of one: it and the next ones that nothing sets apart."""
        most, found = self._probes_at_once(settings), [probe]
        for other in self._coming(probe)[1:]:
            if len(found) >= most or _apart(other) != _apart(probe) or probe.hidden:
                break
            found.append(other)
        return found

    def _coming(self, probe: ProbeSpec) -> list[ProbeSpec]:
        """A probe and those after it."""
        return self._probes[self._probes.index(probe) :]

    def _place_cameras(self, views: Sequence[tuple[ProbeSpec, Face]]) -> None:
        """A camera for each face."""
        for camera, (probe, face) in zip(self._cameras, views, strict=False):
            rotation = Matrix(face.rotation.tolist()).to_4x4()
            camera.matrix_world = Matrix.Translation(Vector(probe.capture_point)) @ rotation

    def _probes_at_once(self, settings: RenderSettings) -> int:
        """Of how many probes one render gives all faces; 0 where each face is worth a render, which can be stopped."""
        if not compat.VIEWS_CAN_BE_READ or settings.engine is not Engine.CYCLES:
            return 0
        pixels = len(FACES) * settings.width * settings.height
        views = pixels * settings.samples + len(FACES) * _OF_AN_OBJECT_IN_VIEW * self._things
        worth = int(_VIEWS_TO_REST * _of_a_render(self._things, len(bpy.data.materials)) / views)
        return min(self._most, worth, max(_PIXELS_TOGETHER // pixels, 1))


def _of_a_render(objects: int, materials: int) -> float:
    """What a render takes whatever it shows, in rays: Cycles looks for the attributes of objects in all materials."""
    return _OF_AN_OBJECT * objects + _OF_A_MATERIAL * materials + _OF_BOTH * objects * materials


def _apart(probe: ProbeSpec) -> tuple:
    """What must be the same for two probes in one render."""
    return _settings(probe), probe.clip_start, probe.clip_end, probe.hidden


def _looks_at_camera(scene: bpy.types.Scene) -> bool:
    """Whether anything has a shape that depends on where the scene's camera is: one render knows only one."""
    trees = [tree for tree in bpy.data.node_groups if tree.bl_idname == "GeometryNodeTree"]
    drawn = any(modifier.type == "LINEART" for item in scene.objects for modifier in item.modifiers)
    return drawn or any(node.bl_idname == "GeometryNodeInputActiveCamera" for tree in trees for node in tree.nodes)


def _checked(what: str, picture: np.ndarray, settings: RenderSettings) -> np.ndarray:
    size = settings.width
    if picture.shape[:2] != (size, size):
        raise BakeError(
            f"{what} came out {picture.shape[1]}×{picture.shape[0]} pixels instead of {size}×{size}; another "
            "add-on may change render settings"
        )
    return picture


def _cameras(
    stack: ExitStack, scene: bpy.types.Scene, lens: bpy.types.Camera, names: Sequence[str]
) -> list[bpy.types.Object]:
    """Cameras in a scene until `stack` closes; removed at once, since each removal goes over the whole file."""
    cameras = [bpy.data.objects.new(name, lens) for name in names]
    stack.callback(bpy.data.batch_remove, cameras)
    for camera in cameras:
        scene.collection.objects.link(camera)
    return cameras


def _size(probe: ProbeSpec) -> int:
    """Pixels along a rendered face."""
    return probe.resolution + 2 * OVERSCAN


def _settings(probe: ProbeSpec) -> RenderSettings:
    return RenderSettings(probe.engine, probe.samples, probe.denoise, _size(probe), _size(probe), probe.adaptive)


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


def _set_engines(stack: ExitStack, scene: bpy.types.Scene, most_seconds: float) -> None:
    """What either engine would add to or take from the radiance."""
    override(stack, scene.eevee, "use_overscan", False)
    for name, value in (
        ("time_limit", most_seconds),
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
