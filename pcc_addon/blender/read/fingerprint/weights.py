"""Vertex groups by what they weigh."""

from __future__ import annotations

import bpy
import numpy as np

from .digests import numbers


class Weights:
    """The vertex groups of meshes and lattices, each read once: Blender gives them a vertex at a time."""

    def __init__(self) -> None:
        self._known: dict[int, np.ndarray] = {}

    def of(self, item: bpy.types.Object, name: str) -> bytes:
        """How much of an object a group has; nothing where there is no such group."""
        group = item.vertex_groups.find(name) if name else -1
        if group < 0:
            return b""
        found = self._read(item)
        return numbers(found[found[:, 1] == group][:, [0, 2]])

    def _read(self, item: bpy.types.Object) -> np.ndarray:
        """(n, 3) float64 of vertex, group, weight."""
        key = item.data.as_pointer()
        if key not in self._known:
            points = item.data.vertices if isinstance(item.data, bpy.types.Mesh) else item.data.points
            found = [(k, g.group, g.weight) for k, point in enumerate(points) for g in point.groups]
            self._known[key] = np.array(found, np.float64).reshape(-1, 3)
        return self._known[key]
