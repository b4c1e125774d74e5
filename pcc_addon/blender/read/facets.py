"""Which objects with sharp materials are flat, and where: what they can mirror follows from it."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ...core.effects.kinds import KINDS, may_transmit
from ...core.readings import FacetReading, SurfaceReading
from .. import marks
from .moving import is_animated
from .nodes import outputs

_MOST_POLYGONS, _MOST_NORMALS = 4000, 8
_SHARP = 0.1  # roughness; rougher surfaces mix what lies all around
_FLAT = 1e-5  # by which normals of one side may differ
# What is the same at every frame, unless it is animated itself, and in renders as in viewports.
_STEADY = {"BEVEL", "EDGE_SPLIT", "SOLIDIFY", "TRIANGULATE", "WEIGHTED_NORMAL", "WELD"}


def is_sharp(surface: SurfaceReading) -> bool:
    """Whether a surface mirrors more or less one way all over."""
    roughness = surface.scalar("Roughness") if surface.has("Roughness") else 0.0
    return surface.kind in KINDS and not may_transmit(surface) and roughness is not None and roughness <= _SHARP


class FacetReader:
    """Reads the flat sides of the placements of a scene, each mesh once."""

    def __init__(self, scene: bpy.types.Scene, materials: set[bpy.types.Material]) -> None:
        """Args: what is read; and the sharp materials."""
        self._plain = {m for m in materials if not _is_displaced(m)} - _appearing(scene)
        self._sides: dict[tuple[int, frozenset[int]], list[tuple[np.ndarray, np.ndarray]] | None] = {}
        self._found: dict[tuple[str, str], list[FacetReading] | None] = {}

    def add(self, evaluated: bpy.types.Object, matrix: np.ndarray, worn: set[bpy.types.Material], steady: bool) -> None:
        """Note one placement.

        Args:
            evaluated: the object of an evaluated instance.
            matrix: (4, 4), of its placement.
            worn: the sharp ones among its materials.
            steady: whether it is no instance, which others may move.
        """
        steady = steady and _is_steady(evaluated.original)
        for material in worn & self._plain:
            key = (evaluated.original.name_full, material.name_full)
            sides = self._sides_of(evaluated, material) if steady else None
            if sides is None or self._found.get(key, ()) is None:
                self._found[key] = None
            else:
                self._found.setdefault(key, []).append(_placed(*key, sides, matrix))

    def readings(self) -> Iterator[FacetReading]:
        """One for each object and material all of whose placements are flat."""
        for (item, material), found in sorted(self._found.items()):
            if found is not None:
                normals, offsets = (np.concatenate([getattr(f, k) for f in found]) for k in ("normals", "offsets"))
                yield FacetReading(item, material, normals, offsets)

    def _sides_of(
        self, evaluated: bpy.types.Object, material: bpy.types.Material
    ) -> list[tuple[np.ndarray, np.ndarray]] | None:
        mesh = evaluated.data
        if not isinstance(mesh, bpy.types.Mesh) or len(mesh.polygons) > _MOST_POLYGONS:
            return None
        slots = [slot.material for slot in evaluated.material_slots] or list(mesh.materials)
        indices = frozenset(k for k, used in enumerate(slots) if used and marks.original(used.original) == material)
        key = (mesh.as_pointer(), indices)
        if key not in self._sides:
            self._sides[key] = _sides(mesh, indices, max(len(slots) - 1, 0))
        return self._sides[key]


def _sides(mesh: bpy.types.Mesh, indices: frozenset[int], last: int) -> list[tuple[np.ndarray, np.ndarray]] | None:
    """Unit normals (3,) and the points (n, 3) of the sides of polygons with these materials, float64, object space.

    None where they are not flat, or face too many ways; a side that faces the opposite way is the same. Polygons whose
    material has an index beyond the last have that.
    """
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners, loops = np.empty((2, count * 3), np.int32)
    materials, normals = np.empty(count, np.int32), np.empty(count * 3, np.float32)
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    for name, array in (("vertices", corners), ("loops", loops), ("material_index", materials), ("normal", normals)):
        mesh.loop_triangles.foreach_get(name, array)
    mesh.vertices.foreach_get("co", places)
    shading = np.empty(len(mesh.loops) * 3, np.float32)
    mesh.corner_normals.foreach_get("vector", shading)
    chosen = np.isin(np.minimum(materials, last), list(indices))
    normals = normals.reshape(-1, 3)[chosen].astype(np.float64)
    points = places.reshape(-1, 3)[corners.reshape(-1, 3)[chosen]].astype(np.float64)
    shading = shading.reshape(-1, 3)[loops.reshape(-1, 3)[chosen]]
    lengths = np.linalg.norm(normals, axis=-1)
    solid = lengths > 0.5  # triangles without an area have none
    if (np.abs(shading - normals[:, None])[solid] > _FLAT).any():
        return None
    left, found = solid, []
    while left.any():
        normal = normals[left.argmax()] / lengths[left.argmax()]
        same = left & (np.minimum(*(np.abs(normals - sign * normal).max(-1) for sign in (1.0, -1.0))) <= _FLAT)
        if len(found) == _MOST_NORMALS:
            return None
        found.append((normal, np.unique(points[same].reshape(-1, 3), axis=0)))
        left = left & ~same
    return found


def _placed(item: str, material: str, sides: list[tuple[np.ndarray, np.ndarray]], matrix: np.ndarray) -> FacetReading:
    normals = np.array([normal for normal, _ in sides]).reshape(-1, 3) @ np.linalg.pinv(matrix[:3, :3])
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
    return FacetReading.of(item, material, normals, [points @ matrix[:3, :3].T + matrix[:3, 3] for _, points in sides])


def _is_steady(item: bpy.types.Object) -> bool:
    """Whether an object is where it is, and of its shape, at every frame of a render."""
    data = item.data
    if is_animated(item) or data.animation_data is not None or getattr(data, "shape_keys", None):
        return False
    return all(m.type in _STEADY and m.show_render == m.show_viewport for m in item.modifiers)


def _is_displaced(material: bpy.types.Material) -> bool:
    """Whether a material moves its surface or bends its normals by height."""
    return any(output.inputs["Displacement"].is_linked for output in outputs(material))


def _appearing(scene: bpy.types.Scene) -> set[bpy.types.Material]:
    """The materials of objects that are not rendered, but may be at another frame."""
    hidden = [item for item in scene.objects if item.hide_render and is_animated(item)]
    return {marks.original(slot.material) for item in hidden for slot in item.material_slots if slot.material}
