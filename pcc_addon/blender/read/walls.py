"""How thick the things are that light passes through: panes, shells and solids, from their meshes."""

from __future__ import annotations

import bpy
import numpy as np

from ...core.readings import WallReading
from .. import marks


def read_wall(evaluated: bpy.types.Object, matrix: np.ndarray, material: bpy.types.Material) -> WallReading | None:
    """What a material covers of one placement; None where it is no mesh or covers nothing.

    Args:
        evaluated: the object of an evaluated instance.
        matrix: (4, 4), of its placement.
        material: one that it shows.
    """
    mesh = evaluated.data
    if not isinstance(mesh, bpy.types.Mesh) or not len(mesh.polygons):
        return None
    triangles = _triangles(mesh, _indices(evaluated, mesh, material)) @ matrix[:3, :3].T
    if not len(triangles):
        return None
    return WallReading.of(material.name_full, triangles)


def _indices(evaluated: bpy.types.Object, mesh: bpy.types.Mesh, material: bpy.types.Material) -> set[int]:
    slots = [slot.material for slot in evaluated.material_slots] or list(mesh.materials)
    return {k for k, used in enumerate(slots) if used is not None and marks.original(used.original) == material}


def _triangles(mesh: bpy.types.Mesh, indices: set[int]) -> np.ndarray:
    """(n, 3, 3) float64 corners of a mesh's triangles with these materials, object space."""
    mesh.calc_loop_triangles()
    corners = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    materials = np.empty(len(mesh.loop_triangles), np.int32)
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    mesh.loop_triangles.foreach_get("material_index", materials)
    mesh.vertices.foreach_get("co", places)
    chosen = np.isin(materials, list(indices))
    return places.reshape(-1, 3)[corners.reshape(-1, 3)[chosen]].astype(np.float64)
