"""Windows of flat panes against rooms that stand behind them, path-traced, far from the origin and turned."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from benchmarks.interior import FAR_FRONT, glowing_house, rooms_behind, seen_panes, show_rooms
from benchmarks.measure import relative_rmse, render
from pcc_addon.blender.shade.interior import interior_node
from pcc_addon.core.probe import Engine


@pytest.fixture
def house(addon: None) -> bpy.types.Scene:
    scene, _ = glowing_house()
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    return scene


def _truth(scene: bpy.types.Scene) -> np.ndarray:
    with rooms_behind(FAR_FRONT, bpy.data.collections["Room"]):
        return render(scene).pixels


def test_panes_show_the_rooms_that_could_be_there_and_a_flat_picture_does_not(house: bpy.types.Scene) -> None:
    material = show_rooms(128, 4)
    truth, mask = _truth(house), seen_panes(house)
    assert mask.mean() > 0.1
    assert relative_rmse(render(house).pixels, truth, mask) <= 0.12
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
    assert cycles <= 0.04
    assert relative_rmse(render(house, Engine.EEVEE).pixels, truth, mask) <= cycles + 0.01
