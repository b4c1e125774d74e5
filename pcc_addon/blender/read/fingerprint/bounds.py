"""Where things are: boxes around what renders show of them, wherever that can be told."""

from __future__ import annotations

import bpy
import numpy as np

from ..moving import is_animated
from ..probes import is_disabled

_RIGID = {"OBJECT", "BONE", "VERTEX", "VERTEX_3"}  # parents that move an object and leave its shape
_CORNERS = np.array(list(np.ndindex(2, 2, 2)), np.float64)


class Bounds:
    """Boxes around the objects of a view layer, each mesh read once."""

    def __init__(self, view_layer: bpy.types.ViewLayer) -> None:
        self._view_layer = view_layer
        self._known: dict[int, np.ndarray] = {}

    def of(self, item: bpy.types.Object, placed: np.ndarray | None) -> np.ndarray | None:
        """(8, 3) float64: the corners of a box around an object, world space; None where nobody can tell.

        Shapes that renders may make otherwise than viewports do are not asked for: only meshes as they are have bounds.

        Args:
            item: the object.
            placed: (4, 4): where the space is that its own matrix leads to; None where nobody can tell.
        """
        if placed is None or item.type != "MESH" or item.modifiers or item.data.shape_keys or item.data.is_editmode:
            return None
        if item.parent is not None and item.parent_type not in _RIGID:
            return None
        matrix = self._matrix(item)
        if matrix is None:
            return None
        whole = placed @ matrix
        return self._box(item.data) @ whole[:3, :3].T + whole[:3, 3]

    def of_instances(self, item: bpy.types.Object, placed: np.ndarray) -> np.ndarray | None:
        """(4, 4): where the matrices lead to of what an object makes instances of; arguments and result as in `of`."""
        matrix, offset = self._matrix(item), np.eye(4)
        offset[:3, 3] = np.negative(item.instance_collection.instance_offset)
        return None if matrix is None else placed @ matrix @ offset

    def _matrix(self, item: bpy.types.Object) -> np.ndarray | None:
        """(4, 4) float64: where renders show an object; None where viewports leave it out, so that nobody knows."""
        evaluated = item.evaluated_get(self._view_layer.depsgraph)
        if not evaluated.is_evaluated or (is_disabled(item, self._view_layer) and is_animated(item)):
            return None
        return np.array(evaluated.matrix_world, np.float64)

    def _box(self, mesh: bpy.types.Mesh) -> np.ndarray:
        """(8, 3) float64, object space."""
        key = mesh.as_pointer()
        if key not in self._known:
            places = np.zeros(max(len(mesh.vertices), 1) * 3, np.float32)
            if len(mesh.vertices):
                mesh.vertices.foreach_get("co", places)
            places = places.reshape(-1, 3).astype(np.float64)
            self._known[key] = np.where(_CORNERS == 1.0, places.max(0), places.min(0))
        return self._known[key]
