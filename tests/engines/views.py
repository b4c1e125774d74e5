"""A room and a camera of Blender's as an engine is to see them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from pcc_addon.core.export.target import Target


@dataclass(frozen=True)
class Quad:
    """A wall of a scene, and what an engine shows on it.

    Attributes:
        name: of the object.
        kind: "wall" for the picture of the probe as it was captured, "mirror" for what a mirror shows.
        probe: its name.
        roughness: of a mirror.
    """

    name: str
    kind: str
    probe: str
    roughness: float = 0.0


def scene(target: Target, quads: Sequence[Quad], oversampling: int = 1, background: str = "") -> dict[str, object]:
    """The scene's camera and some of its walls, in an engine's axes and units, for pages.

    Args:
        target: the engine.
        quads: the walls.
        oversampling: pixels of the engine's picture across one of the scene's.
        background: the probe whose cubemap is to be the sky; empty: none.
    """
    of_scene = bpy.context.scene
    camera, settings = of_scene.camera, of_scene.render
    turned = np.array(camera.matrix_world.to_3x3().normalized())
    size = [oversampling * settings.resolution_x, oversampling * settings.resolution_y]
    across = camera.data.angle_x
    fov = math.degrees(2.0 * math.atan(math.tan(across / 2.0) * size[1] / size[0]))
    return {
        "size": size,
        "camera": {
            "position": _point(target, camera.matrix_world.translation),
            "forward": _direction(target, -turned[:, 2]),
            "up": _direction(target, turned[:, 1]),
            "fov": fov,
            "near": 0.1 * target.units,
            "far": 100.0 * target.units,
        },
        "quads": [_quad(target, quad) for quad in quads],
        "background": background,
    }


def averaged(picture: np.ndarray, oversampling: int) -> np.ndarray:
    """(h, w, 3): the means of an oversampled picture's blocks, as a box filter has them."""
    height, width = (n // oversampling for n in picture.shape[:2])
    blocks = picture.reshape(height, oversampling, width, oversampling, 3)
    return blocks.mean((1, 3), dtype=np.float64)


def _quad(target: Target, quad: Quad) -> dict[str, object]:
    item = bpy.data.objects[quad.name]
    corners = [item.matrix_world @ vertex.co for vertex in item.data.vertices]
    normal = item.matrix_world.to_3x3().inverted().transposed() @ item.data.polygons[0].normal
    return {
        "corners": [_point(target, corner) for corner in corners],
        "normal": _direction(target, normal.normalized()),
        "kind": quad.kind,
        "probe": quad.probe,
        "roughness": quad.roughness,
    }


def _point(target: Target, place: Sequence[float]) -> list[float]:
    return [float(v) for v in target.units * (target.axes.matrix @ np.array(place))]


def _direction(target: Target, way: Sequence[float]) -> list[float]:
    return [float(v) for v in target.axes.matrix @ np.array(way)]
