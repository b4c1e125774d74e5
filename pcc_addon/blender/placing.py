"""Where a new probe goes: around what is selected, or on the walls around the 3D cursor, found by rays at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import bpy
import numpy as np
from mathutils import Vector

from ..core.fit.frames import own_axes
from ..core.fit.guess import cloud_of_rays, guessed_room, spread_ways
from ..core.placing import around, contains, lines, stands_in
from ..core.probe import Box
from .read.rays import Things

_RAYS = 800  # a wall of a plain room gets a hundred of them
_FAR = 60.0  # metres: what is farther is no wall of the room
_LEAST_HEIGHT = 1.0  # metres above something that one can stand in
_EYE = 1.5  # metres above a floor without a ceiling
_BESIDE, _STEPS = 8, (1.0, 2.0)  # directions, and metres along them, where else one may look from
_ON = 1e-4  # metres: what is so near to a surface is on it
_STOREYS = 4  # things over and under a point that are looked at
_AGREE = 1e-4  # of unit axes that are the same


def selection_box(
    scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, objects: Iterable[bpy.types.Object]
) -> Box | None:
    """The box that some objects stand around: on the inner sides of walls, else on their bounds.

    Its axes are those of the active object where that is turned and the others are turned as it is, else the world's.
    What is flat is one wall: the box then stands on the side where the 3D cursor is.

    Returns:
        None where none of them has a size.
    """
    depsgraph = view_layer.depsgraph
    shown = [item for item in (each.evaluated_get(depsgraph) for each in objects) if _has_size(item)]
    if not shown:
        return None
    corners = np.concatenate([_corners(item) for item in shown])
    bounds = around(corners, _common_axes(shown, view_layer.objects.active), np.array(scene.cursor.location))
    room = _room_from(Things(view_layer), bounds.centre, own_axes(bounds.axes))
    return room if room is not None and lines(room, bounds) else bounds


def room_box(view_layer: bpy.types.ViewLayer, point: Vector, without: Iterable[bpy.types.Object] = ()) -> Box | None:
    """The box of the room around a point, which may be on its floor or in a thing that stands there.

    Args:
        view_layer: whose objects count.
        point: world space.
        without: objects that do not count.

    Returns:
        None where fewer than three walls are met.
    """
    things, found = Things(view_layer, without), None
    for eye in _eyes(things, _eye(things, point)):
        room = _room_from(things, eye)
        if room is None:
            break
        again = _room_from(things, _eye(things, Vector(room.centre))) or room
        if contains(again, np.array(point)):
            return again
        found = found or again  # near a doorway walls of both rooms are seen: the box's middle may be in one of them
    return found


def _eyes(things: Things, eye: np.ndarray) -> Iterator[np.ndarray]:
    """A place, and others beside it from which it is seen."""
    yield eye
    angles = np.arange(_BESIDE) * 2.0 * np.pi / _BESIDE
    ways = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], -1)
    free, _ = things.met(eye, ways, _FAR)
    for step in _STEPS:
        yield from (eye + step * way for way, far in zip(ways, free, strict=True) if far > 1.5 * step)


def stands_in_room(
    scene: bpy.types.Scene,
    view_layer: bpy.types.ViewLayer,
    objects: Sequence[bpy.types.Object],
    box: Box,
    eye: Vector | None,
) -> bool:
    """Whether objects, whose `selection_box` is given, are things in a room and not what is around one.

    They are where rays that pass them find a room around them that is far larger, and neither a camera nor the eye of
    the view, which may be None, is among them.
    """
    room = room_box(view_layer, Vector(box.centre), objects)
    if room is None:
        return False
    eyes = [item.matrix_world.translation for item in scene.objects if item.type == "CAMERA"]
    eyes += [eye] * (eye is not None)
    return stands_in(box, room, np.array(eyes).reshape(-1, 3))


def _room_from(things: Things, eye: np.ndarray, axes: np.ndarray | None = None) -> Box | None:
    ways = spread_ways(_RAYS)
    return guessed_room(cloud_of_rays(eye, ways, *things.met(eye, ways, _FAR)), axes)


def _eye(things: Things, point: Vector) -> np.ndarray:
    """(3,) world space: a place over or under a point from where the room is seen: halfway between floor and ceiling.

    Where it is low around the point, as under a table, that is above what the point is under.
    """
    heights = [*_heights(things, point, -1.0)[::-1], *_heights(things, point, 1.0)]
    spans = [(low, high) for low, high in pairwise(heights) if high - low >= _LEAST_HEIGHT]
    around = [span for span in spans if span[0] - _ON <= point.z <= span[1] + _ON]
    over = [span for span in spans if span[0] > point.z]
    floors = [height for height in heights if height <= point.z + _ON]
    if around:
        middle = 0.5 * sum(around[-1])
    elif over:
        middle = 0.5 * sum(over[0])
    else:
        middle = floors[-1] + _EYE if floors else point.z
    return np.array([point.x, point.y, middle])


def _heights(things: Things, point: Vector, sign: float) -> list[float]:
    """At which heights things are over a point (+1), or at it and under it (−1), the nearest first."""
    start, found = point + Vector((0.0, 0.0, _ON)), []
    for _ in range(_STOREYS):
        [away], _ = things.met(np.array(start), np.array([[0.0, 0.0, sign]]), _FAR)
        if not np.isfinite(away):
            break
        found.append(start.z + sign * float(away))
        start.z = found[-1] + sign * _ON
    return found


def _has_size(item: bpy.types.Object) -> bool:
    return item.type != "EMPTY" and item.dimensions.length > 0.0


def _corners(item: bpy.types.Object) -> np.ndarray:
    """(8, 3) world space, metres."""
    matrix = np.array(item.matrix_world)
    return np.array(item.bound_box) @ matrix[:3, :3].T + matrix[:3, 3]


def _common_axes(items: list[bpy.types.Object], active: bpy.types.Object | None) -> np.ndarray:
    """(3, 3) columns: the axes of the active one, else of the first, where the others have the same, in any order."""
    frames = [_axes(item) for item in sorted(items, key=lambda item: item.original != active)]
    agree = all(np.abs(np.abs(frames[0].T @ other).max(0) - 1.0).max() < _AGREE for other in frames)
    return frames[0] if agree else np.eye(3)


def _axes(item: bpy.types.Object) -> np.ndarray:
    """(3, 3) columns: unit axes of an object, right-handed; the world's where it has none."""
    edges = np.array(item.matrix_world)[:3, :3]
    if not np.linalg.norm(edges, axis=0).all():
        return np.eye(3)
    axes = own_axes(edges)
    return axes * np.array([np.sign(np.linalg.det(axes)), 1.0, 1.0])
