"""The frames of a scene, one after another, and the current one again afterwards."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.errors import BakeError
from .probes import bake_record


@contextmanager
def at_frame(scene: bpy.types.Scene) -> Iterator[None]:
    """Go to any frames meanwhile; afterwards the scene is at the one where it was."""
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        if (scene.frame_current, scene.frame_subframe) != (frame, subframe):
            scene.frame_set(frame, subframe=subframe)


def visit(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, frame: int, subframe: float = 0.0) -> None:
    """Go to a frame; what animation moves is there then."""
    scene.frame_set(frame, subframe=subframe)
    view_layer.update()


def frames_of(probe: bpy.types.Object) -> tuple[int, ...]:
    """The frames that a probe's last bake has pictures for; none where it is a still, or there is none."""
    try:
        record = bake_record(probe)
    except BakeError:  # a damaged record is mended by the bake that asks
        return ()
    return record.frames if record else ()
