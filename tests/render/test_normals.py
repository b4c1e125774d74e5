"""A mirror whose normals lean shows what the path tracer shows, where reflections would go below it too."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import relative_rmse, render
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, principled_node
from tests.blender.helpers import ROOM, bake, put_in, small_room


@pytest.fixture
def leaning(scene: bpy.types.Scene) -> bpy.types.Object:
    """A room whose mirror floor has one normal all over, leaning by 50°; returns the probe."""
    probe = small_room()
    probe.pcc_probe.resolution = 256  # bent reflections end a finger's breadth above a floor that captures show black
    material = bpy.data.materials["Floor"]
    inputs = principled_node(material).inputs
    inputs["Metallic"].default_value, inputs["Base Color"].default_value = 1.0, (1.0, 1.0, 1.0, 1.0)
    normal = material.node_tree.nodes.new("ShaderNodeCombineXYZ")
    normal.inputs[0].default_value, normal.inputs[2].default_value = math.sin(0.9), math.cos(0.9)
    material.node_tree.links.new(normal.outputs[0], inputs["Normal"])
    return probe


def seen(engine: Engine, side: float) -> np.ndarray:
    """The floor from one side, (18, 32, 3)."""
    floor = ROOM.centre[2] - ROOM.half_extents[2]
    target = Vector((ROOM.centre[0], ROOM.centre[1], floor))
    camera = add_camera(target + Vector((1.2 * side, 0.1, 0.7)), target, 60.0, 32, 18)
    bpy.context.view_layer.update()
    picture = render(bpy.context.scene, engine, samples=16).pixels
    bpy.data.objects.remove(camera)
    return picture


@pytest.mark.sweep
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_leaning_normals_mirror_as_the_path_tracer_does(leaning, side) -> None:
    truth = seen(Engine.CYCLES, side)
    bake(leaning)
    put_in()
    assert relative_rmse(seen(Engine.CYCLES, side), truth) < 0.05


def test_without_the_correction_they_are_taken_as_they_are(leaning) -> None:
    """The material's own switch counts."""
    bpy.data.materials["Floor"].cycles.use_bump_map_correction = False
    bake(leaning)
    put_in()
    assert not [group.name for group in bpy.data.node_groups if "Valid Normal" in group.name]
