"""What is asked of a cost run, and what is found in the scene for it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy

from ...core.errors import PccError
from ...core.probe import Engine
from ..compat import engine_id
from ..read.probes import all_probes, check_own, check_place, named_probes, probe_spec
from .bench import Size

DEFAULT_BUDGET, QUICK_BUDGET = 600.0, 90.0  # seconds
_PIXELS, _QUICK_PIXELS = 480 * 270, 240 * 135


@dataclass(frozen=True)
class Question:
    """What is asked.

    Attributes:
        probe: its name; empty: the only one.
        camera: its name; empty: the scene's.
        engine: whose frames are measured; None: the scene's.
        frames: how many successive ones, from the scene's current one on.
        target: the relative error that is to be met; None: as good as can be had.
        budget: seconds that all may take; None: ten minutes, or a minute and a half where it is to be quick.
        quick: with a quarter of the pixels.
        width: of the pictures, pixels; None: as many pixels as 480 × 270 have.
        called: what reports call the file; empty: its own name.
    """

    probe: str = ""
    camera: str = ""
    engine: Engine | None = None
    frames: int = 1
    target: float | None = None
    budget: float | None = None
    quick: bool = False
    width: int | None = None
    called: str = ""

    @property
    def seconds(self) -> float:
        """That all may take."""
        return self.budget or (QUICK_BUDGET if self.quick else DEFAULT_BUDGET)


@dataclass(frozen=True)
class Subject:
    """What is measured.

    Attributes:
        probe, camera: the objects.
        engine: whose frames.
        size: of the pictures.
        frames: their numbers.
    """

    probe: bpy.types.Object
    camera: bpy.types.Object
    engine: Engine
    size: Size
    frames: tuple[int, ...]


def subject_of(question: Question, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Subject:
    """Find what a question is about.

    Raises:
        PccError: there is no such probe or camera, or the probe is faulty.
    """
    view_layer.update()
    probe = _probe(question, scene)
    check_own(probe)
    check_place(probe, view_layer)
    probe_spec(probe)
    first = scene.frame_current
    return Subject(
        probe,
        _camera(question, scene),
        question.engine or _engine(scene),
        _size(question, scene),
        tuple(range(first, first + question.frames)),
    )


def _probe(question: Question, scene: bpy.types.Scene) -> bpy.types.Object:
    if question.probe:
        return named_probes(scene, [question.probe])[0]
    probes = all_probes(scene)
    if not probes:
        raise PccError(f"scene '{scene.name}' has no parallax probe; add one with Add > Light Probe > Parallax Probe")
    if len(probes) > 1:
        names = ", ".join(f"'{probe.name}'" for probe in probes)
        raise PccError(f"scene '{scene.name}' has {len(probes)} probes; say which is to be measured: {names}")
    return probes[0]


def _camera(question: Question, scene: bpy.types.Scene) -> bpy.types.Object:
    if not question.camera:
        if scene.camera is None:
            raise PccError(f"scene '{scene.name}' has no camera; add one that sees what shows the probe")
        return scene.camera
    cameras = {item.name: item for item in scene.objects if item.type == "CAMERA"}
    if question.camera not in cameras:
        names = ", ".join(f"'{name}'" for name in sorted(cameras)) or "none"
        raise PccError(f"no camera is called '{question.camera}' in scene '{scene.name}'; its cameras: {names}")
    return cameras[question.camera]


def _engine(scene: bpy.types.Scene) -> Engine:
    for engine in Engine:
        if scene.render.engine == engine_id(engine):
            return engine
    raise PccError(
        f"scene '{scene.name}' renders with {scene.render.engine}, which shows no probes; choose Cycles or EEVEE"
    )


def _size(question: Question, scene: bpy.types.Scene) -> Size:
    """The scene's shape, with the pixels that are asked for."""
    shape = scene.render.resolution_x / scene.render.resolution_y
    pixels = _QUICK_PIXELS if question.quick else _PIXELS
    width = question.width or max(4, round(math.sqrt(pixels * shape)))
    return Size(width, max(4, round(width / shape)))
