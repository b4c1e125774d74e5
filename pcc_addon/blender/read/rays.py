"""What rays meet in a scene: Blender's own ray cast asks every object for every ray, this one asks those in its way."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector

_AT_ONCE = 64  # rays that are held against all bounds together
_PARALLEL = 1e-9  # of a unit vector: a component that counts as so much
_RIM = 1e-4  # metres that bounds may be off by rounding


@dataclass(frozen=True, eq=False)
class _Thing:
    """A mesh.

    Attributes:
        mesh: the evaluated object that has it.
        to_world, to_mesh: (4, 4) matrices between its axes and the world's.
    """

    mesh: bpy.types.Object
    to_world: Matrix
    to_mesh: Matrix


class Things:
    """The meshes of a view layer that renders show and viewports do not hide, instances included."""

    def __init__(self, view_layer: bpy.types.ViewLayer, without: Iterable[bpy.types.Object] = ()) -> None:
        left_out = set(without)
        self._things: list[_Thing] = []
        corners = []
        for instance in view_layer.depsgraph.object_instances:
            item = instance.instance_object if instance.is_instance else instance.object
            shown = instance.parent if instance.is_instance else item
            if item.type != "MESH" or item.hide_render or shown.hide_render or item.display_type in {"WIRE", "BOUNDS"}:
                continue
            if shown.original in left_out:
                continue
            to_world = instance.matrix_world.copy()
            if to_world.determinant() == 0.0 or not len(item.data.polygons):  # rays pass it
                continue
            self._things.append(_Thing(item, to_world, to_world.inverted()))
            corners.append(np.array(item.bound_box) @ np.array(to_world)[:3, :3].T + np.array(to_world)[:3, 3])
        bounds = np.array(corners).reshape(-1, 8, 3)
        self._low, self._high = bounds.min(1, initial=np.inf), bounds.max(1, initial=-np.inf)

    def met(self, start: np.ndarray, ways: np.ndarray, far: float) -> tuple[np.ndarray, np.ndarray]:
        """What is met first along rays from one place.

        Args:
            start: (3,) world space, metres.
            ways: (n, 3) unit.
            far: metres beyond which nothing counts.

        Returns:
            (n,) metres, infinite where nothing is; (n, 3) unit normals of what is met, to either side.
        """
        distances, normals = np.full(len(ways), np.inf), np.zeros((len(ways), 3))
        for first in range(0, len(ways), _AT_ONCE):
            some = ways[first : first + _AT_ONCE]
            enters = self._enters(start, some)
            for k, (way, near) in enumerate(zip(some, enters, strict=True), first):
                distances[k], normals[k] = self._first(Vector(start), Vector(way), near, far)
        return distances, normals

    def _enters(self, start: np.ndarray, ways: np.ndarray) -> np.ndarray:
        """(n, m) metres along rays (n, 3) to the bounds of each thing; infinite where they miss these."""
        per_metre = 1.0 / np.where(np.abs(ways) < _PARALLEL, _PARALLEL, ways)
        enters, leaves = np.zeros((len(ways), len(self._things))), np.full((len(ways), len(self._things)), np.inf)
        for axis in range(3):  # Kay and Kajiya's slabs
            one, other = (np.outer(per_metre[:, axis], end[:, axis] - start[axis]) for end in (self._low, self._high))
            np.maximum(enters, np.minimum(one, other), out=enters)
            np.minimum(leaves, np.maximum(one, other), out=leaves)
        return np.where(leaves >= enters - _RIM, enters, np.inf)

    def _first(self, start: Vector, way: Vector, enters: np.ndarray, far: float) -> tuple[float, tuple]:
        best, facing = far, None
        in_the_way = np.flatnonzero(enters <= far)
        for index in in_the_way[np.argsort(enters[in_the_way], kind="stable")]:
            if enters[index] > best:
                break
            thing = self._things[index]
            hit, place, normal, _ = thing.mesh.ray_cast(thing.to_mesh @ start, thing.to_mesh.to_3x3() @ way)
            gone = (thing.to_world @ place - start).dot(way)
            if hit and gone < best:
                best, facing = gone, (thing.to_mesh.to_3x3().transposed() @ normal).normalized()
        return (float("inf"), (0.0, 0.0, 0.0)) if facing is None else (best, tuple(facing))
