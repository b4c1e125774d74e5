"""The one door to a render: a picture as numbers, and everything as it was before."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..core.errors import BakeError, Cancelled
from ..core.probe import Engine
from ..core.workplace import workplace
from . import compat
from .overrides import override
from .store import pictures


@dataclass(frozen=True)
class RenderSettings:
    """What a render needs; None: as the scene has it.

    Attributes:
        engine: the render engine.
        samples: for each pixel, in either engine.
        denoise: whether Cycles removes noise.
        width, height: of the picture in pixels; with one of them the scene's percentage of its size is 100.
        adaptive: the noise at which Cycles stops sampling a pixel; 0: it takes all samples everywhere.
    """

    engine: Engine | None = None
    samples: int | None = None
    denoise: bool | None = None
    width: int | None = None
    height: int | None = None
    adaptive: float | None = None


AS_IS = RenderSettings()


@dataclass(frozen=True)
class Frame:
    """A rendered picture (h, w, 3) float32, scene-linear, row 0 at the bottom; and the seconds it took."""

    pixels: np.ndarray
    seconds: float


class Renderer:
    """Renders a scene again and again; close its stack to have the settings and the picture on show back.

    Between two pictures no data block comes or goes: after that a renderer would read the whole scene anew, which
    takes longer the larger the scene is. For the same reason settings stay until other ones are asked for.
    """

    def __init__(self, stack: ExitStack, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer | None = None) -> None:
        """View layer: the only one to render; None: those that the scene renders."""
        self._stack, self._scene, self._view_layer = stack, scene, view_layer
        self._folder = workplace(stack)
        stack.enter_context(pictures.desk())
        stack.callback(compat.set_float_exr(scene.render.image_settings))
        if view_layer is not None:
            override(stack, view_layer, "use", True)  # where no layer is for rendering, Blender renders nothing
        results = _render_result()
        if results is not None and len(results.render_slots) > 1:  # keep the picture that the user is looking at
            override(stack, results.render_slots, "active_index", len(results.render_slots) - 1)

    def use(self, settings: RenderSettings) -> None:
        """Render like this from now on."""
        scene, render = self._scene, self._scene.render
        changes = [(render, "resolution_x", settings.width), (render, "resolution_y", settings.height)]
        if settings.width is not None or settings.height is not None:
            changes.append((render, "resolution_percentage", 100))
        if settings.engine is not None:
            changes.append((render, "engine", compat.engine_id(settings.engine)))
        changes += [(scene.cycles, "samples", settings.samples), (scene.eevee, "taa_render_samples", settings.samples)]
        changes.append((scene.cycles, "use_denoising", settings.denoise))
        if settings.adaptive is not None:
            changes.append((scene.cycles, "use_adaptive_sampling", settings.adaptive > 0.0))
            changes.append((scene.cycles, "adaptive_threshold", settings.adaptive or None))
        for owner, name, value in changes:
            if value is not None:
                override(self._stack, owner, name, value)

    def picture(self, what: str, shown: Path | None = None) -> Frame:
        """Render once.

        Args:
            what: what is rendered, for errors.
            shown: a PNG to write the picture to as well, with the scene's view transform.

        Raises:
            Cancelled: the user stopped the render.
            BakeError: there is nothing to render with, or the render gave no picture.
        """
        begin = time.perf_counter()
        self._render(what)
        seconds = time.perf_counter() - begin
        image = _render_result()
        path = self._folder / "picture.exr"
        if image is not None:
            with contextlib.suppress(RuntimeError):  # "could not be saved": there is no file then
                image.save_render(str(path), scene=self._scene)
        if image is None or not path.is_file():
            raise BakeError(self._no_picture(what))
        if shown is not None:
            self._save_shown(image, shown)
        return Frame(self._taken(path, what), seconds)

    def views(self, what: str, cameras: Sequence[bpy.types.Object]) -> list[np.ndarray]:
        """Render once for several cameras, so that a renderer goes over the scene's objects only once.

        Cycles gives each picture but the first a noise of its own.

        Args:
            what: what is rendered, for errors.
            cameras: in the scene, called by one name and then ` 0`, ` 1`, …

        Returns:
            A picture for each, as in `Frame`.

        Raises:
            Cancelled, BakeError: as in `picture`.
        """
        with ExitStack() as stack:
            endings = [f" {k}" for k in range(len(cameras))]
            _show_as_views(stack, self._scene, endings)
            override(stack, self._scene, "camera", cameras[0])
            override(stack, self._scene.render, "filepath", str(self._folder / "view"))
            self._render(what, write_still=True)
        paths = [self._folder / f"view{ending}.exr" for ending in endings]
        if not all(path.is_file() for path in paths):
            raise BakeError(self._no_picture(what))
        return [self._taken(path, what) for path in paths]

    def _render(self, what: str, **options: bool) -> None:
        layer = {} if self._view_layer is None else {"layer": self._view_layer.name}
        try:
            result = bpy.ops.render.render(scene=self._scene.name, **layer, **options)
        except RuntimeError as error:  # no camera, no view layer, an engine that gave up
            raise BakeError(f"{what} cannot be rendered ({str(error).strip()})") from error
        if "FINISHED" not in result:
            raise Cancelled(f"{what}: the render was stopped")

    def _no_picture(self, what: str) -> str:
        return (
            f"{what} was rendered without a picture; free space in '{self._folder.parent}', or look whether another "
            "add-on removes it"
        )

    def _taken(self, path: Path, what: str) -> np.ndarray:
        """The pixels of a file that is not needed any more."""
        try:
            pixels = pictures.read_file(path)
        except (BakeError, RuntimeError) as error:
            raise BakeError(
                f"{what}: its picture came out incomplete; free space in '{self._folder.parent}'"
            ) from error
        path.unlink()
        return pixels

    def _save_shown(self, image: bpy.types.Image, path: Path) -> None:
        settings = self._scene.render.image_settings
        with ExitStack() as stack:
            stack.callback(compat.set_float_exr(settings))
            settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "8"
            image.save_render(str(path), scene=self._scene)


def render(
    scene: bpy.types.Scene,
    settings: RenderSettings = AS_IS,
    view_layer: bpy.types.ViewLayer | None = None,
    shown: Path | None = None,
) -> Frame:
    """Render a scene's camera once; arguments and errors as in `Renderer`."""
    with ExitStack() as stack:
        renderer = Renderer(stack, scene, view_layer)
        renderer.use(settings)
        return renderer.picture(f"scene '{scene.name}'", shown)


def _show_as_views(stack: ExitStack, scene: bpy.types.Scene, endings: Sequence[str]) -> None:
    """Let a scene render a view for each ending of its camera's name, into files with that ending."""
    render = scene.render
    views = render.views
    stack.callback(setattr, views, "active_index", views.active_index)
    for view in views:
        override(stack, view, "use", False)
    for ending in endings:
        view = views.new(f"pcc{ending}")
        stack.callback(views.remove, view)
        view.use, view.camera_suffix, view.file_suffix = True, ending, ending
    override(stack, render, "use_multiview", True)
    override(stack, render, "views_format", "MULTIVIEW")
    override(stack, render.image_settings, "views_format", "INDIVIDUAL")
    override(stack, render, "use_file_extension", True)


def _render_result() -> bpy.types.Image | None:
    """The image that renders appear in, whatever the user has called it; None before the first render."""
    return next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)
