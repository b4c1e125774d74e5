"""What rays meet: the same as Blender's own ray cast, for what renders show."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from pcc_addon.blender.read.rays import Things
from pcc_addon.core.fit.guess import spread_ways

FAR = 50.0


def clutter() -> None:
    """Balls and cubes of all sizes and turns, one mirrored, one of them an instance of a collection."""
    rng = np.random.default_rng(5)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8)
    ball = bpy.context.object.data
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object.data
    bpy.data.batch_remove(list(scene.objects))
    for k in range(12):
        item = bpy.data.objects.new(f"Thing {k}", (ball, cube)[k % 2])
        scene.collection.objects.link(item)
        place, turn, size = rng.uniform(-8, 8, 3), rng.uniform(-3, 3, 3), rng.uniform(0.3, 2.0, 3)
        size[0] *= -1.0 if k == 3 else 1.0
        item.location, item.rotation_euler, item.scale = place, turn, size
    inner = bpy.data.collections.new("Inner")
    inner.objects.link(bpy.data.objects.new("Instanced", ball))
    holder = bpy.data.objects.new("Holder", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", inner
    holder.matrix_world = Matrix.LocRotScale((5.0, 5.0, 1.0), None, (2.0, 1.0, 1.0))
    scene.collection.objects.link(holder)
    bpy.context.view_layer.update()


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.1), (4.0, -3.0, 2.0)])
def test_rays_meet_what_blender_says_that_they_meet(scene, start) -> None:
    clutter()
    ways = spread_ways(300)
    distances, _ = Things(bpy.context.view_layer).met(np.array(start), ways, FAR)
    seen = 0
    for way, distance in zip(ways, distances, strict=True):
        depsgraph = bpy.context.view_layer.depsgraph
        hit, place, *_ = scene.ray_cast(depsgraph, Vector(start), Vector(way), distance=FAR)
        assert hit == np.isfinite(distance)
        if hit:
            seen += 1
            assert distance == pytest.approx((place - Vector(start)).length, abs=1e-4)
    assert 30 < seen < 300


def test_normals_are_those_of_the_world(scene) -> None:
    """Of a cube that leans and is stretched, so that its edges are no normals."""
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    shear = Matrix(((1.0, 0.7, 0.0, 9.0), (0.0, 1.0, 0.3, 0.0), (0.0, 0.0, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
    parent = bpy.data.objects.new("Parent", None)
    scene.collection.objects.link(parent)
    bpy.context.object.parent, bpy.context.object.matrix_parent_inverse = parent, shear
    bpy.context.view_layer.update()
    _, [normal] = Things(bpy.context.view_layer).met(np.zeros(3), np.array([[1.0, 0.0, 0.0]]), FAR)
    expected = np.linalg.inv(np.array(shear)[:3, :3])[0]
    assert abs(normal @ expected) == pytest.approx(np.linalg.norm(expected), rel=1e-5)


def test_nothing_is_met_where_nothing_is(scene) -> None:
    bpy.context.view_layer.update()
    distances, _ = Things(bpy.context.view_layer).met(np.zeros(3), spread_ways(10), FAR)
    assert np.isinf(distances).all()


def test_what_is_farther_than_asked_does_not_count(scene) -> None:
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(10.0, 0.0, 0.0))
    bpy.context.view_layer.update()
    things, way = Things(bpy.context.view_layer), np.array([[1.0, 0.0, 0.0]])
    assert things.met(np.zeros(3), way, 20.0)[0] == pytest.approx([9.0])
    assert np.isinf(things.met(np.zeros(3), way, 8.0)[0]).all()


@pytest.mark.parametrize("how", ["hide_render", "hide_viewport", "display_type"])
def test_what_renders_or_viewports_do_not_show_is_passed(scene, how: str) -> None:
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(10.0, 0.0, 0.0))
    setattr(bpy.context.object, how, "BOUNDS" if how == "display_type" else True)
    bpy.context.view_layer.update()
    distances, _ = Things(bpy.context.view_layer).met(np.zeros(3), np.array([[1.0, 0.0, 0.0]]), FAR)
    assert np.isinf(distances).all()
