"""Windows of flat panes against rooms that stand behind them, path-traced, far from the origin and turned."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from benchmarks.interior import FAR_FRONT, glowing_house, rooms_behind, seen_panes, show_rooms
from benchmarks.measure import covered, relative_rmse, render
from pcc_addon.blender.shade.interior import Window, interior_node, room_of_probe, window_material
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room, principled


@pytest.fixture
def house(addon: None) -> bpy.types.Scene:
    scene, _ = glowing_house()
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    return scene


def _truth(scene: bpy.types.Scene) -> np.ndarray:
    with rooms_behind(FAR_FRONT, bpy.data.collections["Room"]):
        return render(scene).pixels


@pytest.mark.heavy
def test_panes_show_the_rooms_that_could_be_there_and_a_flat_picture_does_not(house: bpy.types.Scene) -> None:
    material = show_rooms(128, 4)
    truth, mask = _truth(house), seen_panes(house)
    assert mask.mean() > 0.1
    assert relative_rmse(render(house).pixels, truth, mask) <= 0.05
    interior_node(material).inputs["Depth"].default_value = 0.001
    assert relative_rmse(render(house).pixels, truth, mask) >= 0.5


def test_an_instance_shows_what_the_object_would_show_there(house: bpy.types.Scene) -> None:
    """Instances and linked copies have the same rooms, wherever they are, as panes are measured in their own axes."""
    show_rooms(32, 1)
    panes = bpy.data.objects["Far Panes"]
    expected = render(house).pixels
    assert expected.any()
    collection = bpy.data.collections.new("Panes")
    collection.objects.link(panes)
    house.collection.objects.unlink(panes)
    panes.matrix_world = Matrix.Rotation(1.0, 4, "X")
    copy = bpy.data.objects.new("Copy", None)
    copy.instance_type, copy.instance_collection = "COLLECTION", collection
    copy.matrix_world = FAR_FRONT.matrix @ panes.matrix_world.inverted()
    house.collection.objects.link(copy)
    found = render(house).pixels
    assert np.abs(found - expected).max(-1).mean() < 2e-3


@pytest.mark.heavy
def test_errors_stay_below_what_the_docs_promise(house: bpy.types.Scene) -> None:
    house.render.resolution_x, house.render.resolution_y = 320, 240
    show_rooms(512, 8)
    truth, mask = _truth(house), seen_panes(house)
    cycles = relative_rmse(render(house).pixels, truth, mask)
    assert cycles <= 0.015
    assert relative_rmse(render(house, Engine.EEVEE).pixels, truth, mask) <= cycles + 0.004


def test_glass_over_a_room_shows_a_probe_as_the_path_tracer_shows_the_surroundings(addon: None) -> None:
    scene = emissive_room()
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    settings = add_room_probe(EMISSIVE_ROOM).pcc_probe
    settings.resolution, settings.samples, settings.denoise = 128, 4, False
    bpy.data.objects["Wall -Z"].active_material = principled("Dark", Base_Color=(0, 0, 0, 1), Specular_IOR_Level=0.0)
    bpy.ops.pcc.bake(scope="ALL")
    window = Window((room_of_probe(bpy.data.objects["Room"]),))
    material = window_material("Window", window, {"Strength": 0.2, "IOR": 2.0})
    glass = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    glass.inputs["IOR"].default_value = 2.0
    wall = bpy.data.objects["Wall +Y"]
    wall.active_material = material
    scene.camera.matrix_world.translation = EMISSIVE_ROOM.world(-3.5, -1.0, 0.0)
    traced, mask = render(scene).pixels, covered(scene, wall)
    glass.inputs["Specular IOR Level"].default_value = 0.0
    without = render(scene).pixels
    glass.inputs["Specular IOR Level"].default_value = 0.5
    assert mask.mean() > 0.05 and relative_rmse(without, traced, mask) > 0.3, "the glass reflects"
    bpy.ops.pcc.inject()
    assert relative_rmse(render(scene).pixels, traced, mask) < 0.12
