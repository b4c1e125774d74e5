"""The list of probes: which it shows, in which order, and that choosing one selects it."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.ui.kept import last_plan
from pcc_addon.ui.panels.probe_list import PCC_UL_probes, shown, source_of, summary
from tests.blender.helpers import pretend_bake, small_probe
from tests.blender.materials import shiny, show


@pytest.fixture
def three(scene) -> dict[str, bpy.types.Object]:
    """Three probes among other things, of which the last is baked and stale."""
    probes = {name: small_probe(name) for name in ("hall", "Attic")}
    show(shiny())
    probes["Cellar"] = small_probe("Cellar")
    pretend_bake(probes["Cellar"])
    bpy.context.view_layer.update()
    return probes


def names(*options: object) -> list[str]:
    scene = bpy.context.scene
    return [scene.objects[k].name for k in shown(scene, *options)]


def test_it_shows_the_probes_by_name(three) -> None:
    assert names() == ["Attic", "Cellar", "hall"]
    assert names("", False, False, True) == ["hall", "Cellar", "Attic"]


@pytest.mark.parametrize(
    ("pattern", "others", "found"),
    [
        ("L", False, ["Cellar", "hall"]),
        ("h*l", False, ["hall"]),
        ("hall", True, ["Attic", "Cellar"]),
        ("[", False, []),
        ("?", False, ["Attic", "Cellar", "hall"]),
    ],
)
def test_names_are_filtered_as_elsewhere_in_blender(three, pattern: str, others: bool, found: list[str]) -> None:
    assert names(pattern, others) == found


def test_what_needs_care_comes_first_where_that_is_asked(three) -> None:
    last_plan.check(bpy.context.scene, bpy.context.view_layer)
    assert names("", False, True) == ["Cellar", "Attic", "hall"]
    assert summary(bpy.context.scene, list(three.values())) == "3 probes: 1 stale, 2 not baked"


def test_blender_gets_a_flag_and_a_place_for_each_object(three, scene) -> None:
    self = type("List", (), {"filter_name": "a", "use_filter_invert": False, "by_state": False})
    self.use_filter_sort_reverse, self.bitflag_filter_item = True, 1 << 30
    flags, places = PCC_UL_probes.filter_items(self, bpy.context, scene, "objects")
    assert sorted(places) == list(range(len(scene.objects))), "each place once"
    there = sorted((place, item.name) for place, item, flag in zip(places, scene.objects, flags, strict=True) if flag)
    assert there == [(0, "hall"), (1, "Cellar"), (2, "Attic")]


def test_choosing_a_probe_selects_it_alone(three, scene) -> None:
    bpy.data.objects["Mesh"].select_set(True)
    scene.pcc_active_probe = scene.objects.find("Cellar")
    assert bpy.context.view_layer.objects.active == three["Cellar"]
    assert [item.name for item in bpy.context.selected_objects] == ["Cellar"]


def test_selecting_in_the_viewport_moves_the_list(three, scene) -> None:
    bpy.context.view_layer.objects.active = three["hall"]
    assert scene.objects[scene.pcc_active_probe].name == "hall"
    bpy.context.view_layer.objects.active = bpy.data.objects["Mesh"]
    assert scene.pcc_active_probe == -1
    bpy.context.view_layer.objects.active = None
    assert scene.pcc_active_probe == -1


def test_choosing_changes_nothing_in_another_mode_nor_what_the_view_layer_lacks(three, scene) -> None:
    mesh = bpy.data.objects["Mesh"]
    bpy.context.view_layer.objects.active = mesh
    bpy.ops.object.mode_set(mode="EDIT")
    scene.pcc_active_probe = scene.objects.find("Cellar")
    assert bpy.context.view_layer.objects.active == mesh and mesh.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    aside = bpy.data.collections.new("Aside")
    scene.collection.children.link(aside)
    aside.objects.link(three["Cellar"])
    scene.collection.objects.unlink(three["Cellar"])
    bpy.context.view_layer.layer_collection.children["Aside"].exclude = True
    for index in (scene.objects.find("Cellar"), -1, 99):
        scene.pcc_active_probe = index
        assert bpy.context.view_layer.objects.active == mesh


def test_probes_of_libraries_are_not_listed(three, scene, tmp_path) -> None:
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {three["hall"]})
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["hall"]
    scene.collection.objects.link(wanted.objects[0])
    assert names() == ["Attic", "Cellar", "hall"]


def test_where_pictures_come_from_is_said_in_a_word(three) -> None:
    hall = three["hall"]
    assert source_of(hall) == "Cycles"
    hall.pcc_probe.source = "WORLD"
    assert source_of(hall) == "World"


def test_probes_to_be_baked_can_be_selected(three, scene) -> None:
    last_plan.check(scene, bpy.context.view_layer)
    assert bpy.ops.pcc.select(which="WAITING") == {"FINISHED"}
    assert {item.name for item in bpy.context.selected_objects} == {"hall", "Attic", "Cellar"}
    bpy.context.view_layer.objects.active = three["Attic"]
    assert bpy.ops.pcc.lock(locked=True) == {"FINISHED"}
    assert all(probe.pcc_probe.locked for probe in three.values())
    for item in bpy.context.selected_objects:
        item.select_set(item == three["hall"])
    bpy.ops.pcc.lock(locked=False)
    assert [name for name, probe in three.items() if probe.pcc_probe.locked] == ["Attic", "Cellar"]
