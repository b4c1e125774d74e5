"""The operator that adds probes, without a window."""

from __future__ import annotations

import math

import bpy
import pytest
from mathutils import Euler, Matrix, Vector

from pcc_addon.blender import setting_groups
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.ui.operators import probe_add
from tests.blender.helpers import ROOM, small_probe, small_room
from tests.core.rooms import box

ARGUMENTS = {
    "name": "Hall",
    "location": (1.5, -2.25, 3.0),
    "rotation": (0.25, -0.5, 1.0),
    "half_extents": (4.0, 3.0, 2.0),
    "capture_offset": (0.5, -0.25, 1.0),
}


def add(**arguments: object) -> bpy.types.Object:
    """Add a probe as a script does; returns it, made active."""
    assert bpy.ops.pcc.probe_add(**arguments) == {"FINISHED"}
    return bpy.context.view_layer.objects.active


def test_a_probe_has_the_place_turn_and_size_that_were_asked_for(scene) -> None:
    probe = add(**ARGUMENTS)
    assert probe.name == "Hall"
    assert tuple(probe.location) == ARGUMENTS["location"]
    assert probe.rotation_mode == "XYZ" and tuple(probe.rotation_euler) == ARGUMENTS["rotation"]
    assert tuple(probe.scale) == ARGUMENTS["half_extents"]
    assert tuple(probe.pcc_probe.capture_offset) == ARGUMENTS["capture_offset"]
    bpy.context.view_layer.update()
    turn = Euler(ARGUMENTS["rotation"], "XYZ").to_matrix().to_4x4()
    expected = Matrix.Translation(ARGUMENTS["location"]) @ turn @ Matrix.Diagonal((4.0, 3.0, 2.0, 1.0))
    assert all((a - b).length < 1e-6 for a, b in zip(probe.matrix_world, expected, strict=True))


def test_the_capture_offset_counts_in_metres_along_the_box_axes(scene) -> None:
    probe = add(**ARGUMENTS)
    bpy.context.view_layer.update()
    offset = Euler(ARGUMENTS["rotation"], "XYZ").to_matrix() @ Vector(ARGUMENTS["capture_offset"])
    expected = Vector(ARGUMENTS["location"]) + offset
    assert (Vector(probe_spec(probe).capture_point) - expected).length < 1e-5


def test_a_probe_is_shown_as_a_cube_whose_local_box_is_the_unit_cube(scene) -> None:
    probe = add(**ARGUMENTS)
    assert (probe.type, probe.empty_display_type, probe.empty_display_size) == ("EMPTY", "CUBE", 1.0)
    assert probe.name in scene.collection.objects


def test_a_probe_has_the_defaults_that_are_documented(scene) -> None:
    settings = add(name="Plain").pcc_probe
    assert settings.is_probe
    assert (settings.resolution, settings.samples, settings.engine, settings.denoise) == (512, 64, "CYCLES", True)
    assert settings.clip_start == pytest.approx(0.01) and settings.clip_end == pytest.approx(1000.0)
    assert settings.padding == pytest.approx(0.01) and settings.falloff == pytest.approx(0.25)
    assert (settings.outside, settings.correction) == ("OWN", "BOX")
    assert settings.group is None and not settings.bake_record and len(settings.levels) == 0


def test_other_objects_are_no_probes(scene) -> None:
    assert not bpy.data.objects.new("Empty", None).pcc_probe.is_probe


def test_a_probe_without_arguments_stands_at_the_origin_with_a_volume(scene) -> None:
    probe = add()
    assert probe.name == "Probe" and tuple(probe.location) == (0.0, 0.0, 0.0) and all(s > 0 for s in probe.scale)


def test_a_second_probe_of_a_name_gets_a_number(scene) -> None:
    assert [add(name="Hall").name for _ in range(3)] == ["Hall", "Hall.001", "Hall.002"]


def test_the_new_probe_alone_is_selected_and_active(scene) -> None:
    first, second = add(name="First"), add(name="Second")
    assert bpy.context.view_layer.objects.active == second
    assert second.select_get() and not first.select_get()


def test_a_probe_can_be_added_where_no_object_is_active(scene) -> None:
    assert bpy.context.view_layer.objects.active is None
    assert add(name="Lonely").name == "Lonely"


def test_a_probe_goes_into_the_active_collection(scene) -> None:
    room = bpy.data.collections.new("Room")
    scene.collection.children.link(room)
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children["Room"]
    assert add(name="Inner").users_collection == (room,)


@pytest.mark.parametrize("argument", ["location", "rotation", "half_extents", "capture_offset"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused_by_name(scene, argument, value) -> None:
    wrong = ARGUMENTS | {argument: (1.0, value, 1.0)}
    with pytest.raises(RuntimeError, match=r"probe 'Hall': .*must be finite"):
        bpy.ops.pcc.probe_add(**wrong)
    assert len(bpy.data.objects) == 0


@pytest.mark.parametrize("axis", range(3))
def test_half_extents_of_zero_are_refused_by_name(scene, axis) -> None:
    half_extents = [1.0, 1.0, 1.0]
    half_extents[axis] = 0.0
    with pytest.raises(RuntimeError, match=r"probe 'Hall': .*0.*give lengths above 0 m"):
        bpy.ops.pcc.probe_add(**(ARGUMENTS | {"half_extents": half_extents}))
    assert len(bpy.data.objects) == 0


def test_negative_half_extents_make_a_mirrored_box_that_can_be_baked(scene) -> None:
    probe = add(**(ARGUMENTS | {"half_extents": (-4.0, 3.0, 2.0)}))
    bpy.context.view_layer.update()
    assert tuple(probe.scale) == (-4.0, 3.0, 2.0)
    assert probe_spec(probe).box.half_extents == pytest.approx((4.0, 3.0, 2.0))


def test_the_operator_says_why_it_cannot_run_in_edit_mode(scene) -> None:
    mesh = bpy.data.objects.new("Mesh", bpy.data.meshes.new("Mesh"))
    scene.collection.objects.link(mesh)
    bpy.context.view_layer.objects.active = mesh
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Object Mode"):
        bpy.ops.pcc.probe_add(**ARGUMENTS)
    bpy.ops.object.mode_set(mode="OBJECT")


def test_the_box_is_what_is_drawn_when_the_scale_is_applied_or_the_size_edited(scene) -> None:
    """Applying an uneven scale makes Blender draw another cube: the box follows the drawing."""
    probe = small_probe(half_extents=(2.0, 1.0, 0.5))
    probe.select_set(True)
    bpy.context.view_layer.objects.active = probe
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    bpy.context.view_layer.update()
    assert tuple(probe.scale) == (1.0, 1.0, 1.0)
    assert probe_spec(probe).box.half_extents == pytest.approx([probe.empty_display_size] * 3)
    probe.empty_display_size = 0.25
    probe.scale = (4.0, 8.0, 2.0)
    bpy.context.view_layer.update()
    assert probe_spec(probe).box.half_extents == pytest.approx([1.0, 2.0, 0.5])


def test_a_script_can_lay_the_box_around_the_selection_or_the_room(scene) -> None:
    small_room()
    bpy.data.objects.remove(bpy.data.objects["Probe"])
    scene.cursor.location = ROOM.centre
    found = add(name="In Room", around="ROOM")
    assert tuple(found.location) == pytest.approx(ROOM.centre, abs=1e-4)
    assert tuple(found.scale) == pytest.approx(ROOM.half_extents, abs=1e-4)
    for item in scene.objects:
        item.select_set(item.type == "MESH")
    assert tuple(add(name="In Walls", around="SELECTION").scale) == pytest.approx(ROOM.half_extents, abs=1e-4)
    assert tuple(add(name="Small", around="CURSOR").scale) == (1.0, 1.0, 1.0)


def test_a_room_that_has_a_probe_is_left_to_it(scene, monkeypatch) -> None:
    small_room()
    bpy.context.view_layer.update()
    rooms = [box(ROOM.centre, ROOM.half_extents), box((20.0, 0.0, 0.0), (1.0, 2.0, 1.0))]
    monkeypatch.setattr(probe_add, "_rooms", lambda *_: iter(rooms))
    assert add(around="ROOM").location.x == pytest.approx(20.0)
    assert add(around="ROOM").location.x == pytest.approx(ROOM.centre[0]), "all have one"


def test_the_room_around_the_eye_of_the_view_counts_where_the_cursor_is_in_none(scene, monkeypatch) -> None:
    small_room()
    bpy.context.view_layer.update()
    scene.cursor.location = (500.0, 0.0, 0.0)
    for eye, found in ((Vector(ROOM.centre), 1), (Vector((500.0, 0.0, 3.0)), 0), (None, 0)):
        monkeypatch.setattr(probe_add, "_eye", lambda _, eye=eye: eye)
        assert len(list(probe_add._rooms(bpy.context, None))) == found


def test_where_no_room_is_found_the_values_count(scene) -> None:
    probe = add(around="ROOM", location=(1.0, 2.0, 3.0))
    assert tuple(probe.location) == (1.0, 2.0, 3.0) and tuple(probe.scale) == (2.0, 2.0, 1.5)


def test_a_probe_takes_over_the_settings_of_another_and_not_its_place(scene) -> None:
    first = add(name="First", capture_offset=(0.1, 0.2, 0.3)).pcc_probe
    first.resolution, first.engine, first.falloff, first.correction = 128, "EEVEE", 0.5, "RELIEF"
    first.effects.weight, first.influence_low, first.priority = "ON", (1.0, 0.0, 0.0), 3
    second = add(name="Second", like="First").pcc_probe
    assert (second.resolution, second.engine, second.falloff, second.correction) == (128, "EEVEE", 0.5, "RELIEF")
    assert second.effects.weight == "ON"
    assert tuple(second.capture_offset) == (0.0, 0.0, 0.0) and tuple(second.influence_low) == (0.0, 0.0, 0.0)
    assert second.priority == 0 and not second.uid and not second.bake_record
    assert add(name="Third").pcc_probe.resolution == 512, "a script that does not ask gets the defaults"


def test_what_is_taken_over_are_settings_that_there_are(scene) -> None:
    settings = add().pcc_probe
    assert all(hasattr(settings, name) for name in setting_groups._OF_A_NEIGHBOUR)
