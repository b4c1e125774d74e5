"""Which objects are read as flat, and where they lie; whatever else makes nothing known of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from pcc_addon.blender.read import facets
from pcc_addon.blender.read.scene import read_scene
from pcc_addon.core.readings import FacetReading
from sample_blends.scenes import principled
from tests.blender.helpers import small_probe
from tests.blender.materials import link, new, output_of

pytestmark = pytest.mark.usefixtures("scene")

PLACE = Matrix.Translation((3.0, -2.0, 1.0)) @ Euler((0.3, -0.4, 0.9)).to_matrix().to_4x4()
SHEARED = PLACE @ Matrix.Diagonal((1.0, -2.0, 3.0, 1.0)) @ Matrix.Shear("XY", 4, (0.3, 0.2))
SQUARE = ([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])


def read() -> dict[tuple[str, str], FacetReading]:
    if not bpy.data.objects.get("Probe"):
        small_probe()
    bpy.context.view_layer.update()
    found = read_scene(bpy.context.scene, bpy.context.view_layer).facets
    return {(reading.object, reading.material): reading for reading in found}


def add(
    name: str = "Mirror",
    points: Sequence = SQUARE[0],
    polygons: Sequence = SQUARE[1],
    material: bpy.types.Material | None = None,
    place: Matrix = PLACE,
) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], polygons)
    mesh.materials.append(material or bpy.data.materials.get("Steel") or principled("Steel", Roughness=0.0))
    item = bpy.data.objects.new(name, mesh)
    item.matrix_world = place
    bpy.context.scene.collection.objects.link(item)
    return item


def cube(name: str = "Box", place: Matrix = PLACE) -> bpy.types.Object:
    points = list(np.ndindex(2, 2, 2))
    polygons = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return add(name, points, polygons, place=place)


@pytest.mark.parametrize("place", [Matrix(), PLACE, SHEARED], ids=["plain", "turned", "sheared"])
def test_each_side_of_a_flat_object_is_where_its_points_are(place: Matrix) -> None:
    item = cube(place=place)
    [reading] = read().values()
    corners = np.array([item.matrix_world @ vertex.co for vertex in item.data.vertices])
    assert (reading.object, reading.material) == ("Box", "Steel") and len(reading.normals) == 6
    np.testing.assert_allclose(np.linalg.norm(reading.normals, axis=1), 1.0)
    heights = corners @ reading.normals.T
    np.testing.assert_allclose(heights.min(0), reading.offsets, atol=1e-5)
    assert ((np.abs(heights - heights.max(0)) < 1e-5).sum(0) == 4).all(), "each is normal to a side"


def test_both_sides_of_a_polygon_are_seen() -> None:
    add(place=Matrix.Translation((0.0, 0.0, 0.7)))
    [reading] = read().values()
    order = np.argsort(reading.normals[:, 2])
    np.testing.assert_allclose(reading.normals[order], [[0, 0, -1], [0, 0, 1]], atol=1e-7)
    np.testing.assert_allclose(reading.offsets[order], [-0.7, 0.7], atol=1e-6)


def test_only_polygons_of_the_material_count() -> None:
    item = cube()
    item.data.materials.append(principled("Wool", Roughness=0.9))
    item.data.polygons.foreach_set("material_index", [1, 1, 1, 1, 1, 0])
    assert [(key, len(reading.normals)) for key, reading in read().items()] == [(("Box", "Steel"), 2)]
    item.data.polygons.foreach_set("material_index", [1] * 6)
    item.data.update()
    [reading] = read().values()
    assert len(reading.normals) == len(reading.offsets) == 0, "it is worn and covers nothing"
    item.data.polygons.foreach_set("material_index", [0] * 5 + [7])
    item.data.materials.pop(index=1)
    assert len(read()["Box", "Steel"].normals) == 6, "what is beyond the last is the last"


def test_smooth_polygons_count_where_they_lie_in_one_plane() -> None:
    grid = [(x, y, 0) for y in range(3) for x in range(3)]
    item = add("Grid", grid, [(k, k + 1, k + 4, k + 3) for k in (0, 1, 3, 4)])
    item.data.shade_smooth()
    assert len(read()["Grid", "Steel"].normals) == 2
    item.data.vertices[4].co.z = 0.01
    item.data.update()
    assert read() == {}, "it is shaded as a hill"
    item.data.shade_flat()
    assert read() == {}, "its quads are bent"


def test_placements_of_one_mesh_are_read_apart_and_their_mesh_once(monkeypatch) -> None:
    first = add()
    second = bpy.data.objects.new("Second", first.data)
    second.location = (0.0, 0.0, 5.0)
    bpy.context.scene.collection.objects.link(second)
    calls, sides = [], facets._sides
    monkeypatch.setattr(facets, "_sides", lambda *given: (calls.append(1), sides(*given))[1])
    found = read()
    assert set(found) == {("Mirror", "Steel"), ("Second", "Steel")} and len(calls) == 1
    assert np.abs(found["Second", "Steel"].offsets).max() == pytest.approx(5.0)


def smooth(item: bpy.types.Object) -> None:
    item.data.shade_smooth()


def own_normals(item: bpy.types.Object) -> None:
    item.data.normals_split_custom_set([(0.1, 0.0, 1.0)] * len(item.data.loops))


def round_it(item: bpy.types.Object) -> None:
    item.modifiers.new("Round", "SUBSURF").levels = 2
    item.modifiers["Round"].render_levels = 2


def round_it_in_renders(item: bpy.types.Object) -> None:
    item.modifiers.new("Round", "SUBSURF").levels = 0


def bevel_in_renders(item: bpy.types.Object) -> None:
    item.modifiers.new("Round", "BEVEL").show_viewport = False


def many_polygons(item: bpy.types.Object) -> None:
    count = 70
    grid = [(x, y, 0) for y in range(count) for x in range(count)]
    quads = [(k, k + 1, k + count + 1, k + count) for k in range(count * (count - 1)) if (k + 1) % count]
    item.data = bpy.data.meshes.new("Grid")
    item.data.from_pydata(grid, [], quads)
    item.data.materials.append(bpy.data.materials["Steel"])


def wave(item: bpy.types.Object) -> None:
    item.modifiers.new("Wave", "WAVE")


def keyed(item: bpy.types.Object) -> None:
    item.keyframe_insert("location", frame=1)


def held(item: bpy.types.Object) -> None:
    item.constraints.new("COPY_LOCATION")


def shape_key(item: bpy.types.Object) -> None:
    item.shape_key_add(name="Basis")


def animated_mesh(item: bpy.types.Object) -> None:
    item.data.vertices[0].keyframe_insert("co", frame=1)


def displaced(item: bpy.types.Object) -> None:
    material = item.active_material
    link(material, new(material, "ShaderNodeDisplacement").outputs[0], output_of(material).inputs["Displacement"])


def rough(item: bpy.types.Object) -> None:
    node = next(n for n in item.active_material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    node.inputs["Roughness"].default_value = 0.2


def clear(item: bpy.types.Object) -> None:
    node = next(n for n in item.active_material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    node.inputs["Transmission Weight"].default_value = 1.0


def appearing(item: bpy.types.Object) -> None:
    """Another object with its material is shown at another frame."""
    other = add("Later")
    other.hide_render = True
    other.keyframe_insert("hide_render", frame=1)


def instanced(item: bpy.types.Object) -> None:
    room = bpy.data.collections.new("Room")
    bpy.context.scene.collection.objects.unlink(item)
    room.objects.link(item)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", room
    bpy.context.scene.collection.objects.link(instance)


UNKNOWN = [
    smooth, own_normals, round_it, round_it_in_renders, bevel_in_renders, many_polygons, wave, keyed, held, shape_key,
    animated_mesh, displaced, rough, clear, appearing, instanced,
]  # fmt: skip


@pytest.mark.parametrize("change", UNKNOWN, ids=lambda f: f.__name__)
def test_nothing_is_known_of_what_is_not_flat_steady_and_sharp(change: Callable[[bpy.types.Object], None]) -> None:
    item = cube()
    assert set(read()) == {("Box", "Steel")}
    change(item)
    assert read() == {}


def test_an_object_with_a_placement_that_is_unknown_is_unknown() -> None:
    item = cube()
    room = bpy.data.collections.new("Room")
    room.objects.link(item)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", room
    bpy.context.scene.collection.objects.link(instance)
    assert read() == {}


@pytest.mark.parametrize(
    ("kind", "sides"),
    [("SOLIDIFY", 6), ("BEVEL", 2), ("EDGE_SPLIT", 2), ("TRIANGULATE", 2), ("WEIGHTED_NORMAL", 2), ("WELD", 2)],
)
def test_modifiers_that_keep_an_object_steady_do_not_matter(kind: str, sides: int) -> None:
    add().modifiers.new("Kept", kind)
    assert len(read()["Mirror", "Steel"].normals) == sides


def test_a_hidden_object_that_nothing_shows_again_does_not_matter() -> None:
    cube()
    add("Off").hide_render = True
    assert set(read()) == {("Box", "Steel")}
