"""What a probe's capture may show, as triangles, and whose surface it sees in which direction. Writes nothing."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Vector

from ...core.accuracy.misfit import Sightings, at
from ...core.accuracy.sampling import Triangles, make_of
from ...core.accuracy.sequences import sphere
from ...core.accuracy.unseen import SLACK
from ...core.probe import ProbeSpec
from .. import marks
from ..bake.survey import is_seen_through

_SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}
_AT_ONCE = 200  # rays that are cast between two moments at which one can cancel
_RAYS, _MOST_PANES = 2048, 8
_SAME = 0.02  # of a distance, and metres: what a ray meets there is what the survey shows


def read_triangles(spec: ProbeSpec, view_layer: bpy.types.ViewLayer) -> Triangles:
    """The surfaces around a probe that its capture shows, but for hair and point clouds; at once, as Blender needs."""
    view_layer.update()
    parts: list[tuple[np.ndarray, int, int]] = []
    names: dict[tuple[str, str], int] = {}
    margin = SLACK + spec.influence_padding
    for instance in view_layer.depsgraph.object_instances:
        item = instance.object
        if item.type in _SURFACES and _is_captured(item.original, spec):
            matrix = np.array(instance.matrix_world, np.float64)
            bounds = np.array(item.bound_box, np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            if spec.nears(bounds, margin):
                with _mesh(item) as mesh:
                    for corners, make, material in _read(mesh, item, matrix, spec.capture_point):
                        owner = names.setdefault((item.original.name_full, material), len(names))
                        parts.append((corners, owner, make))
    if not parts:
        return Triangles(np.zeros((0, 3, 3)), np.zeros(0, np.intp), np.zeros(0, np.intp), ())
    counts = [len(corners) for corners, _, _ in parts]
    owners, makes = (np.repeat(np.array([part[k] for part in parts], np.intp), counts) for k in (1, 2))
    return Triangles(np.concatenate([corners for corners, _, _ in parts]), owners, makes, tuple(names))


def sightings(
    spec: ProbeSpec, nearness: np.ndarray, scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer
) -> Generator[None, None, Sightings]:
    """Whose surface a survey shows, in directions evenly all around; yields now and then.

    What viewports leave out has no name.
    """
    vectors = sphere(_RAYS)
    distances = 1.0 / np.maximum(at(nearness, vectors), 1e-9)
    names = []
    view_layer.update()
    for k, (vector, distance) in enumerate(zip(vectors, distances, strict=True)):
        names.append(_met(scene, view_layer, Vector(spec.capture_point), Vector(vector), float(distance)))
        if k % _AT_ONCE == _AT_ONCE - 1:
            yield
    return Sightings(vectors, tuple(names))


def _met(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, origin: Vector, way: Vector, distance: float) -> str:
    """The object at a distance along a ray, behind what the survey sees through; empty: none is."""
    slack, start = _SAME * (1.0 + distance), 0.0
    for _ in range(_MOST_PANES):
        hit, place, _, _, item, _ = scene.ray_cast(view_layer.depsgraph, origin + start * way, way)
        if not hit:
            return ""
        reached = (place - origin).length
        if reached >= distance - slack:
            return item.original.name_full if reached <= distance + slack else ""
        start = reached + 1e-4 * (1.0 + reached)
    return ""


def _is_captured(item: bpy.types.Object, spec: ProbeSpec) -> bool:
    return not item.hide_render and item.visible_glossy and item.name not in spec.hidden and not is_seen_through(item)


@contextmanager
def _mesh(item: bpy.types.Object) -> Iterator[bpy.types.Mesh]:
    """The mesh of an evaluated object, while it is needed."""
    if item.type == "MESH":
        yield item.data
        return
    try:
        yield item.to_mesh()
    finally:
        item.to_mesh_clear()


def _read(
    mesh: bpy.types.Mesh | None, item: bpy.types.Object, matrix: np.ndarray, eye: np.ndarray
) -> Iterator[tuple[np.ndarray, int, str]]:
    """World-space corners (t, 3, 3) of each material's triangles, the mesh's make, and the material's name."""
    if mesh is None or not len(mesh.vertices):
        return
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    vertices, materials = np.empty(count * 3, np.int32), np.empty(count, np.int32)
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.loop_triangles.foreach_get("vertices", vertices)
    mesh.loop_triangles.foreach_get("material_index", materials)
    mesh.vertices.foreach_get("co", places)
    if not count:
        return
    vertices = vertices.reshape(-1, 3)
    corners = places.reshape(-1, 3).astype(np.float64)[vertices] @ matrix[:3, :3].T + matrix[:3, 3]
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        corners, vertices = corners[:, ::-1], vertices[:, ::-1]
    make, over = make_of(corners, vertices, eye)
    corners = corners[:, ::-1] if over else corners
    slots = [slot.material for slot in item.material_slots] or list(mesh.materials) or [None]
    materials = np.minimum(materials, len(slots) - 1)
    for k in np.unique(materials):
        worn = slots[k]
        name = marks.original(worn.original).name_full if worn else ""
        yield corners[materials == k], int(make), name
