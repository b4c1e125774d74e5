"""A wall that lies on a probe's box shows the room on its inner side and keeps its own lobe on the other."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import render
from sample_blends.scenes import add_camera, principled_node
from tests.blender.helpers import ROOM, bake, put_in, small_room


@pytest.fixture
def glossy_room(scene: bpy.types.Scene) -> bpy.types.Object:
    """A room under a blue sky whose floor is a mirror, seen from inside and from below."""
    probe = small_room()
    background = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (0.0, 0.0, 1.0, 1.0)
    background.inputs["Strength"].default_value = 1.0
    inputs = principled_node(bpy.data.materials["Floor"]).inputs
    inputs["Metallic"].default_value, inputs["Base Color"].default_value = 1.0, (1.0, 1.0, 1.0, 1.0)
    return probe


def seen(height: float) -> np.ndarray:
    """(3,) mean of what a camera that far above the floor sees in it."""
    floor = ROOM.centre[2] - ROOM.half_extents[2]
    target = Vector((ROOM.centre[0], ROOM.centre[1], floor))
    camera = add_camera(target + Vector((0.3, 0.2, height)), target, 100.0, 8, 8)
    bpy.context.view_layer.update()
    pixels = render(bpy.context.scene, samples=4).pixels.mean((0, 1))
    bpy.data.objects.remove(camera)
    return pixels


def test_the_outer_side_of_a_floor_shows_the_sky_and_the_inner_side_the_room(glossy_room) -> None:
    add_camera(Vector((0.0, 0.0, -20.0)), Vector(), 30.0, 8, 8)  # somebody may look at it from below
    truth = [seen(height) for height in (0.5, -0.5)]
    bake(glossy_room)
    put_in()
    inside, outside = (seen(height) for height in (0.5, -0.5))
    np.testing.assert_allclose(outside, (0.0, 0.0, 1.0), atol=0.01)
    np.testing.assert_allclose(outside, truth[1], atol=0.01)
    assert np.abs(inside - outside).max() > 0.3
    np.testing.assert_allclose(inside, truth[0], atol=0.1)


def test_where_no_camera_leaves_the_box_nothing_is_tested(glossy_room) -> None:
    add_camera(Vector(ROOM.centre), Vector((4.0, -2.0, 0.5)), 30.0, 8, 8)
    bpy.context.view_layer.update()
    bake(glossy_room)
    put_in()
    assert "Weight" not in {item.name for item in glossy_room.pcc_probe.group.interface.items_tree}
