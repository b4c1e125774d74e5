"""What baked pictures show: the radiance that reflections would see from the probe."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest

from pcc_addon.blender.shade.twin import capture_inputs, has_twins
from pcc_addon.core import equirect
from sample_blends.scenes import add_wall, principled
from tests.blender.helpers import ROOM, bake, glow, picture, small_probe, small_room


def towards(probe: bpy.types.Object, *direction: float) -> np.ndarray:
    return equirect.lookup(picture(probe), np.array(direction))


def test_a_hidden_object_and_a_hidden_collection_are_not_captured(scene) -> None:
    probe = small_room()
    collection = bpy.data.collections.new("Hidden")
    scene.collection.children.link(collection)
    collection.objects.link(bpy.data.objects["Wall +Y"])
    bake(probe)
    before = picture(probe).copy()
    probe.pcc_probe.hidden_objects.add().object = bpy.data.objects["Wall +X"]
    probe.pcc_probe.hidden_collection = collection
    bake(probe)
    for direction, wall in (((1, 0, 0), 0), ((0, 1, 0), 2)):
        assert equirect.lookup(before, np.array(direction, float))[wall] == pytest.approx(1.0, abs=0.02)
        assert towards(probe, *direction).max() == pytest.approx(0.0, abs=0.02)
    assert towards(probe, -1, 0, 0).max() == pytest.approx(1.0, abs=0.02)
    assert not bpy.data.objects["Wall +X"].hide_render and not bpy.data.objects["Wall +Y"].hide_render


@pytest.mark.parametrize("visible_glossy", [True, False])
def test_lamps_are_captured_as_reflections_see_them(scene, visible_glossy) -> None:
    probe = small_probe()
    light = bpy.data.lights.new("Lamp", "AREA")
    light.size, light.energy = 2.0, 40.0
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.location = ROOM.world(1.0, 0.0, 0.0)
    lamp.rotation_euler = (0.0, math.radians(90.0), 0.0)  # shines along −X, at the probe
    lamp.visible_camera, lamp.visible_glossy = False, visible_glossy
    scene.collection.objects.link(lamp)
    bake(probe)
    radiance = 40.0 / (math.pi * 4.0)
    assert towards(probe, 1, 0, 0) == pytest.approx([radiance if visible_glossy else 0.0] * 3, rel=0.02, abs=1e-3)
    assert towards(probe, -1, 0, 0).max() == pytest.approx(0.0, abs=1e-3)
    assert not lamp.visible_camera


def floor_of(material: bpy.types.Material) -> bpy.types.Material:
    bpy.data.objects["Wall -Z"].data.materials[0] = material
    return material


def downwards(probe: bpy.types.Object) -> np.ndarray:
    """The mean radiance of the floor."""
    height = picture(probe).shape[0]
    return picture(probe)[: height // 4].mean((0, 1))


def lobe_alone(name: str, node: str) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    bsdf, output = nodes.new(node), nodes.new("ShaderNodeOutputMaterial")
    bsdf.inputs[0].default_value, bsdf.inputs["Roughness"].default_value = (1.0, 0.5, 0.0, 1.0), 0.0
    links.new(bsdf.outputs[0], output.inputs["Surface"])
    return material


@pytest.mark.sweep
@pytest.mark.parametrize("kind", ["Principled", "Glossy"])
@pytest.mark.parametrize("injected", [False, True])
def test_metals_are_captured_matt_in_half_their_colour(scene, injected: bool, kind: str) -> None:
    probe = small_room()
    probe.pcc_probe.samples = 64
    half = (0.5, 0.25, 0.0, 1.0)
    floor_of(principled("Matt", Base_Color=half, Roughness=0.0, Specular_IOR_Level=0.0))
    bake(probe)
    expected = downwards(probe)
    if kind == "Principled":
        mirror = floor_of(principled("Mirror", Base_Color=(1.0, 0.5, 0.0, 1.0), Metallic=1.0, Roughness=0.0))
    else:
        mirror = floor_of(lobe_alone("Mirror", "ShaderNodeBsdfAnisotropic"))
    if injected:
        bake(probe)
        assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"} and has_twins(mirror)
    bake(probe)
    np.testing.assert_allclose(downwards(probe), expected, rtol=0.05, atol=1e-3)
    assert towards(probe, 0, 0, 1).max() == pytest.approx(1.0, abs=0.02)


@pytest.mark.sweep
@pytest.mark.parametrize("injected", [False, True])
def test_walls_are_captured_with_the_light_that_lobes_throw_on_them(scene, injected: bool) -> None:
    probe = small_probe()
    probe.pcc_probe.samples = 256
    matt = principled("Matt", Base_Color=(0.8, 0.8, 0.8, 1.0), Roughness=1.0, Specular_IOR_Level=0.0)
    add_wall(ROOM, "+Z", matt)
    metal = principled("Metal", Base_Color=(0.9, 0.9, 0.9, 1.0), Metallic=1.0, Roughness=0.4)
    add_wall(ROOM, "-Z", metal)
    light = bpy.data.lights.new("Lamp", "AREA")
    light.size, light.energy = 1.0, 100.0
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.location = ROOM.world(0.0, 0.0, 0.9 * ROOM.half_extents[2])
    scene.collection.objects.link(lamp)
    nobody = bpy.data.collections.new("Nobody")
    probe.pcc_probe.receivers = nobody
    up = (0.7, 0.0, 1.0)
    bake(probe)
    expected = towards(probe, *up)
    assert expected.min() > 0.1
    probe.pcc_probe.receivers = None
    if injected:
        bake(probe)
        assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"} and has_twins(metal)
    bake(probe)
    np.testing.assert_allclose(towards(probe, *up), expected, rtol=0.1)
    assert all(socket.default_value == 0.0 for socket in capture_inputs(metal))


def test_a_mirror_out_of_the_probes_reach_is_captured_with_its_reflections(scene) -> None:
    probe = small_room()
    bpy.data.objects["Wall -Z"].data.materials[0] = principled(
        "Mirror", Base_Color=(1, 1, 1, 1), Metallic=1.0, Roughness=0.0
    )
    probe.scale = (0.3, 0.3, 0.3)
    bpy.context.view_layer.update()
    bake(probe)
    assert towards(probe, 0, 0, -1).max() > 0.5


def test_walls_are_captured_with_their_own_radiance(scene) -> None:
    probe = small_room()
    bpy.data.materials["Glow +X"].node_tree.nodes["Principled BSDF"].inputs["Emission Strength"].default_value = 1234.5
    bake(probe)
    assert towards(probe, 1, 0, 0) == pytest.approx((1234.5, 0.0, 0.0), rel=1e-4, abs=1e-3)


def test_what_lies_beyond_the_clip_planes_is_not_captured(scene) -> None:
    probe = small_probe()
    mesh = bpy.data.meshes.new("Near")
    mesh.from_pydata([(0.5, -2, -2), (0.5, 2, -2), (0.5, 2, 2), (0.5, -2, 2)], [], [(0, 1, 2, 3)])
    mesh.materials.append(glow("Near", (1.0, 1.0, 1.0)))
    near = bpy.data.objects.new("Near", mesh)
    near.location = ROOM.centre
    scene.collection.objects.link(near)
    bake(probe)
    assert towards(probe, 1, 0, 0) == pytest.approx((1.0, 1.0, 1.0), abs=0.02)
    probe.pcc_probe.clip_start = 0.75
    bake(probe)
    assert towards(probe, 1, 0, 0).max() == 0.0
