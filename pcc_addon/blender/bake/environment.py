"""Pictures that are not captured in a probe's box: a cubemap that the user gives, or the scene's world alone."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import ExitStack
from dataclasses import dataclass

import bpy
import numpy as np

from ...core import equirect, radiance
from ...core.cubemap import FACES
from ...core.errors import ProbeError
from ...core.kept_faces import NOWHERE, KeptFace, KeptProbe
from ...core.picture_files import picture_files
from ...core.probe import ProbeSpec, Source
from ..overrides import override, temporary
from ..store.image_files import read_cubemap
from .capture import OVERSCAN, Stage


@dataclass(frozen=True)
class Environment:
    """A picture (2n, 4n, 3) float32 along the box's own axes, and what was wrong with it in words."""

    picture: np.ndarray
    replaced: tuple[str, ...]


def check_source(spec: ProbeSpec, scene: bpy.types.Scene) -> None:
    """Refuse a probe whose pictures are to come from where there are none.

    Raises:
        ProbeError: no image is chosen, its file is missing, or the scene has no world.
    """
    if spec.source is Source.IMAGE:
        picture_files(spec.name, spec.picture)
    if spec.source is Source.WORLD and scene.world is None:
        raise ProbeError(
            f"probe '{spec.name}' shows the world, but scene '{scene.name}' has none; add one, or set the source to "
            "Bake"
        )


def steps(source: Source) -> int:
    """How many pieces of work `take` does."""
    return 1 if source is Source.IMAGE else len(FACES)


def take(spec: ProbeSpec, scene: bpy.types.Scene, kept: KeptProbe = NOWHERE) -> Generator[str, None, Environment]:
    """The picture of a probe that is not captured in its box; yields what comes next.

    Renders of the world may be kept until the bake is whole.

    Raises:
        PccError: a file cannot be read or has no layout that is known, or the world cannot be rendered.
    """
    if spec.source is Source.WORLD:
        return (yield from _world(spec, scene, kept))
    files = picture_files(spec.name, spec.picture)
    yield f"reading {files[0].name}"
    try:
        return Environment(*read_cubemap(files, spec.resolution))
    except ProbeError as error:
        raise ProbeError(f"probe '{spec.name}': {error}") from error


def _world(spec: ProbeSpec, scene: bpy.types.Scene, kept: KeptProbe) -> Generator[str, None, Environment]:
    """Six renders of a scene that holds nothing but the world, turned from the world's axes to the box's."""
    faces, replaced = [], []
    with ExitStack() as stack:
        empty = temporary(stack, bpy.data.scenes, bpy.data.scenes.new("pcc world"))
        empty.world = scene.world
        empty.frame_set(scene.frame_current, subframe=scene.frame_subframe)
        override(stack, empty.cycles, "device", scene.cycles.device)
        for name in ("threads_mode", "threads"):
            override(stack, empty.render, name, getattr(scene.render, name))
        stage = Stage(stack, empty, empty.view_layers[0], [spec])
        stage.aim(stack, spec)
        for index, face in enumerate(FACES):
            found = kept.take(face.name)
            if found is None:
                yield f"world, face {face.name}"
                picture, bad = radiance.clean(index, stage.face(spec, index), OVERSCAN)
                found = KeptFace(picture, (str(bad),) if bad else ())
                kept.keep(face.name, found)
            faces.append(found.picture)
            replaced += found.words
    axes = np.linalg.inv(spec.box.face_normals)
    return Environment(equirect.from_faces(faces, OVERSCAN, axes=axes), tuple(replaced))
