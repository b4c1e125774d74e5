"""A material shared by many rooms: its objects wear copies that show the probes of their rooms, and give them back."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.fingerprint import SceneFingerprint
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.shade import copies
from pcc_addon.blender.shade.twin import shown_probe_groups
from sample_blends.scenes import Room, add_wall, principled, principled_node
from tests.blender.helpers import pretend_bake, put_in, small_probe
from tests.blender.snapshots import settled
from tests.rna_dump import difference

ROOMS = 4


@pytest.fixture
def rooms(addon, scene) -> bpy.types.Material:
    """Rooms in a row, their probes, and floors that share a material."""
    floor = principled("Floor", Roughness=0.1)
    for k in range(ROOMS):
        room = Room((2.0, 1.5, 1.0), (5.0 * k, 0.0, 0.0), 0.0)
        add_wall(room, "-Z", floor).name = f"Floor {k}"
        pretend_bake(small_probe(f"Room {k}", room.centre, room.half_extents))
    return floor


def floors() -> list[bpy.types.Object]:
    return [bpy.data.objects[f"Floor {k}"] for k in range(ROOMS)]


def floors_left() -> list[bpy.types.Object]:
    return [item for item in bpy.data.objects if item.name.startswith("Floor")]


def worn() -> list[bpy.types.Material]:
    return [item.material_slots[0].material for item in floors()]


def shows(material: bpy.types.Material) -> list[str]:
    return [group.name.removeprefix("PCC Probe ") for group in shown_probe_groups(material)]


def remove() -> None:
    bpy.ops.pcc.remove()


def test_each_floor_wears_a_copy_that_shows_its_room_and_the_material_stays_as_it_was(rooms) -> None:
    put_in()
    assert [shows(material) for material in worn()] == [[f"Room {k}"] for k in range(ROOMS)]
    assert shows(rooms) == [] and len({*worn(), rooms}) == ROOMS + 1
    assert all(marks.original(material) == rooms for material in worn())
    [plan] = [p for p in plan_scene(bpy.context.scene, bpy.context.view_layer).materials if p.material == "Floor"]
    assert len(plan.objects) == ROOMS and "is shown as 4 copies" in plan.reasons[0]


def test_removing_brings_slots_data_and_materials_back_exactly(rooms) -> None:
    """Slots linked to data and to the object, one that hides another material, and data that two objects share."""
    first, second, third, fourth = floors()
    first.material_slots[0].link = "OBJECT"
    first.material_slots[0].material = rooms
    second.material_slots[0].link = "OBJECT"
    second.material_slots[0].material = principled("Hidden")
    second.material_slots[0].link = "DATA"
    fourth.data = third.data
    before = settled()
    put_in()
    assert len({*worn()}) == ROOMS
    remove()
    assert difference(before, settled()) == []
    assert not copies.all_copies() and [slot.link for i in floors() for slot in i.material_slots] == (
        ["OBJECT", "DATA", "DATA", "DATA"]
    )


def test_injecting_again_uses_the_copies_and_leaves_nothing_behind(rooms) -> None:
    put_in()
    before = [material.name for material in bpy.data.materials]
    put_in()
    assert [material.name for material in bpy.data.materials] == before
    bpy.data.objects.remove(floors()[3])
    put_in()
    assert len(copies.all_copies()[rooms]) == ROOMS - 1


def test_copies_that_no_room_calls_for_any_more_are_taken_back(rooms) -> None:
    put_in()
    for k in range(2, ROOMS):
        bpy.data.objects.remove(bpy.data.objects[f"Room {k}"])
    for item in floors()[2:]:
        item.data = item.data.copy()
        bpy.data.objects.remove(item)
    put_in()
    assert not copies.all_copies() and [m.name for m in bpy.data.materials] == ["Floor"]
    assert [item.material_slots[0].material for item in floors_left()] == [rooms] * 2 and len(shows(rooms)) == 2


def test_a_file_opened_without_knowledge_keeps_slots_and_original(rooms, tmp_path: Path) -> None:
    put_in()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rooms.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "rooms.blend"))
    assert [shows(material) for material in worn()] == [[f"Room {k}"] for k in range(ROOMS)]
    remove()
    assert {material.name for material in worn()} == {"Floor"}


@pytest.mark.parametrize("where", ["original", "copy"])
def test_a_value_that_is_edited_anywhere_counts_everywhere(rooms, where: str) -> None:
    put_in()
    edited = rooms if where == "original" else worn()[1]
    principled_node(edited).inputs["Roughness"].default_value = 0.3
    bpy.context.view_layer.update()
    for material in (rooms, *worn()):
        assert principled_node(material).inputs["Roughness"].default_value == pytest.approx(0.3)
    assert [shows(material) for material in worn()] == [[f"Room {k}"] for k in range(ROOMS)]


def test_copies_follow_an_original_that_is_built_differently(rooms) -> None:
    put_in()
    noise = rooms.node_tree.nodes.new("ShaderNodeTexNoise")
    rooms.node_tree.links.new(noise.outputs[0], principled_node(rooms).inputs["Roughness"])
    bpy.context.view_layer.update()
    assert [shows(material) for material in worn()] == [[f"Room {k}"] for k in range(ROOMS)]
    assert all(principled_node(material).inputs["Roughness"].is_linked for material in worn())
    remove()
    assert [material.name for material in bpy.data.materials] == ["Floor"]


def test_a_copy_that_is_built_differently_stays_where_it_is(rooms) -> None:
    slot = floors()[1].material_slots[0]
    slot.link = "OBJECT"
    slot.material = principled("Hidden")
    slot.link = "DATA"
    before = [{*item.keys()} for item in floors()]
    put_in()
    own = worn()[1]
    noise = own.node_tree.nodes.new("ShaderNodeTexNoise")
    own.node_tree.links.new(noise.outputs[0], principled_node(own).inputs["Roughness"])
    bpy.context.view_layer.update()
    remove()
    assert worn() == [rooms, own, rooms, rooms] and not marks.is_copy(own)
    assert not any(marks.role(node) for node in own.node_tree.nodes)
    left = [{*item.keys()} - {"pcc"} for item in floors()]  # where Blender 4.5 keeps settings that were read
    assert left == before, "no note is left on the objects"


def test_injecting_does_not_make_a_bake_stale(rooms) -> None:
    def content() -> str:
        spec = probe_spec(bpy.data.objects["Room 0"])
        return SceneFingerprint(bpy.context.scene, bpy.context.view_layer).content_hash(spec)

    before = content()
    put_in()
    assert content() == before


def test_one_floor_through_all_rooms_shows_as_many_as_fit_by_place(rooms) -> None:
    for item in floors():
        bpy.data.objects.remove(item)
    whole = Room((2.5 * ROOMS, 1.5, 1.0), (2.5 * (ROOMS - 1), 0.0, 0.0), 0.0)
    floor = add_wall(whole, "-Z", rooms)
    put_in()
    assert floor.material_slots[0].material == rooms and len(shows(rooms)) == ROOMS


def test_excluded_objects_do_not_show_the_probe_and_receivers_alone_do(rooms) -> None:
    """Two objects in one room that share a material."""
    vase = floors()[0].copy()
    vase.name = "Vase"
    collection = bpy.data.collections.new("Not these")
    collection.objects.link(vase)
    bpy.context.scene.collection.children.link(collection)
    settings = bpy.data.objects["Room 0"].pcc_probe
    for name, expected in (("excluded", (["Room 0"], [])), ("receivers", ([], ["Room 0"]))):
        settings.excluded = settings.receivers = None
        setattr(settings, name, collection)
        bpy.context.view_layer.update()
        put_in()
        assert (shows(worn()[0]), shows(vase.material_slots[0].material)) == expected
    plan = plan_scene(bpy.context.scene, bpy.context.view_layer).probe("Room 0")
    assert "'Floor 0' in its influence are not to show it" in plan.reasons
    settings.receivers = None
    put_in()
    assert shows(vase.material_slots[0].material) == ["Room 0"]


def test_undo_brings_slots_back(rooms, tmp_path: Path) -> None:
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.pcc.inject()
    bpy.ops.ed.undo_push(message="injected")
    bpy.ops.ed.undo()
    assert {material.name for material in worn()} == {"Floor"} and not copies.all_copies()
    bpy.ops.ed.redo()
    assert [shows(material) for material in worn()] == [[f"Room {k}"] for k in range(ROOMS)]
