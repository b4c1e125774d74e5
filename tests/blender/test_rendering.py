"""The door to a render: a picture comes out, and the scene and what the user looks at are as before."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender.rendering import RenderSettings, render
from pcc_addon.core.errors import BakeError, Cancelled
from pcc_addon.core.probe import Engine
from sample_blends.scenes import add_camera, empty_scene
from tests.blender.helpers import ROOM, small_room
from tests.rna_dump import difference, dump

SMALL = RenderSettings(Engine.CYCLES, samples=1, denoise=False, width=12, height=8)


@pytest.fixture
def lit(scene: bpy.types.Scene) -> bpy.types.Scene:
    """A small room with a camera in it."""
    small_room()
    add_camera(ROOM.world(-1.0, 0.0, 0.0), ROOM.world(1.0, 0.2, 0.1), 20.0, 320, 200)
    return scene


def result_image() -> bpy.types.Image:
    return next(image for image in bpy.data.images if image.type == "RENDER_RESULT")


def test_a_picture_comes_out_in_the_size_asked_for(lit) -> None:
    frame = render(lit, SMALL)
    assert frame.pixels.shape == (8, 12, 3) and frame.pixels.dtype == np.float32
    assert frame.pixels.max() > 0.5 and frame.seconds > 0.0


def test_the_scene_is_as_before(lit) -> None:
    lit.render.resolution_percentage = 37
    lit.render.image_settings.file_format = "JPEG"
    render(lit, SMALL)
    dump()
    before = dump()
    render(lit, RenderSettings(Engine.CYCLES, samples=2, denoise=True, width=8, height=8))
    assert difference(before, dump()) == []


def test_settings_that_are_not_asked_for_are_the_scenes(lit) -> None:
    lit.render.resolution_percentage = 10
    lit.cycles.samples = 1
    assert render(lit).pixels.shape == (20, 32, 3)


def test_without_a_camera_the_error_says_so(scene) -> None:
    with pytest.raises(BakeError, match=r"scene 'Scene' cannot be rendered .*camera"):
        render(scene, SMALL)


def test_a_stopped_render_is_told(lit, monkeypatch) -> None:
    class Stopped:
        class render:
            @staticmethod
            def render(**_: object) -> set[str]:
                return {"CANCELLED"}

    monkeypatch.setattr(bpy, "ops", Stopped)
    with pytest.raises(Cancelled, match="stopped"):
        render(lit, SMALL)


def test_the_users_slot_stays_chosen_and_keeps_its_picture(lit, tmp_path: Path) -> None:
    render(lit, SMALL)
    image = result_image()
    while len(image.render_slots) < 3:
        image.render_slots.new()
    image.render_slots.active_index = 1
    used = []
    handler = lambda *_: used.append(result_image().render_slots.active_index)  # noqa: E731
    bpy.app.handlers.render_init.append(handler)
    try:
        render(lit, SMALL)
    finally:
        bpy.app.handlers.render_init.remove(handler)
    assert used == [len(image.render_slots) - 1] and image.render_slots.active_index == 1


def test_a_result_of_another_name_is_found_and_keeps_it(lit) -> None:
    expected = render(lit, SMALL).pixels
    result_image().name = "Mine"
    assert np.array_equal(render(lit, SMALL).pixels, expected)
    assert result_image().name == "Mine"


def test_the_picture_on_show_is_written_as_well(lit, tmp_path: Path) -> None:
    render(lit, SMALL, shown=tmp_path / "shown.png")
    image = bpy.data.images.load(str(tmp_path / "shown.png"))
    assert tuple(image.size) == (12, 8)


def test_another_scene_than_the_open_one_can_be_rendered() -> None:
    first = empty_scene()
    second = bpy.data.scenes.new("Second")
    second.collection.objects.link(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    second.camera = second.collection.objects["Camera"]
    second.camera.location = Vector((0.0, 0.0, 1.0))
    second.world = first.world
    assert render(second, SMALL).pixels.max() == 0.0
