"""What baked pictures show: the radiance that reflections would see from the probe."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest

from pcc_addon.core import equirect
from sample_blends.scenes import principled
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


@pytest.mark.parametrize("injected", [False, True])
def test_receivers_are_captured_without_their_reflections(scene, injected) -> None:
    probe = small_room()
    bpy.data.objects["Wall -Z"].data.materials[0] = principled(
        "Mirror", Base_Color=(1, 1, 1, 1), Metallic=1.0, Roughness=0.0
    )
    if injected:
        bake(probe)
        assert bpy.ops.pcc.inject(scope="SCENE") == {"FINISHED"}
    bake(probe)
    assert towards(probe, 0, 0, -1).max() == pytest.approx(0.0, abs=1e-3), "a mirror has no diffuse light"
    assert towards(probe, 0, 0, 1).max() == pytest.approx(1.0, abs=0.02)


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
