"""Probes that are duplicated, deleted and renamed, with what belongs to them, and files that keep that."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.shade.twin import has_twins
from pcc_addon.blender.status import statuses
from tests.blender.filing import check, check_nothing_pink, opened, seen, shown, status, works_again
from tests.blender.helpers import contents, pictures_of, save
from tests.blender.snapshots import settled
from tests.rna_dump import difference

NAMES = ["Büro 二階 🏠", "ü" * 31, "x" * 63, "a/b\\c:d*e?", "  "]


def probe() -> bpy.types.Object:
    return next(item for item in bpy.data.objects if item.pcc_probe.is_probe)


def again(blend: Path) -> None:
    save(blend)
    opened(blend)


def select(*names: str) -> None:
    for item in bpy.context.scene.objects:
        item.select_set(item.name in names)
    bpy.context.view_layer.objects.active = bpy.data.objects[names[0]]


# Renamed.


@pytest.mark.parametrize("name", NAMES)
def test_a_renamed_probe_keeps_pictures_and_materials_under_any_name(home: Path, name: str) -> None:
    before = seen()
    probe().name = name
    given = probe().name
    bpy.context.view_layer.update()
    check()
    again(home)
    check()
    assert shown() == [given] and np.array_equal(seen(), before)
    works_again()
    again(home)
    check()


@pytest.mark.parametrize("name", NAMES)
def test_renamed_materials_pictures_and_groups_stay_what_they_are(home: Path, name: str) -> None:
    before = seen()
    for blocks in (bpy.data.materials, bpy.data.images, bpy.data.node_groups):
        for block in list(blocks):
            block.name = name
    bpy.context.view_layer.update()
    check()
    again(home)
    check()
    assert np.array_equal(seen(), before)
    works_again()


def test_two_probes_that_exchange_their_names_keep_their_own(home: Path) -> None:
    select("Probe")
    bpy.ops.object.duplicate()
    bpy.data.objects["Probe.001"].location.x += 20.0
    bpy.ops.pcc.bake(scope="ALL")
    pictures = {name: pictures_of(bpy.data.objects[name]) for name in ("Probe", "Probe.001")}
    first, second = (bpy.data.objects[name] for name in pictures)
    first.name, second.name, first.name = "Away", "Probe", "Probe.001"
    bpy.ops.pcc.inject()
    again(home)
    check()
    assert pictures_of(bpy.data.objects["Probe.001"]) == pictures["Probe"]
    assert pictures_of(bpy.data.objects["Probe"]) == pictures["Probe.001"]
    assert shown() == ["Probe.001"]


# Duplicated.


@pytest.mark.parametrize("linked", [False, True], ids=["Shift+D", "Alt+D"])
def test_a_duplicated_probe_leaves_all_to_the_original_until_it_is_baked(home: Path, linked: bool) -> None:
    before, first = seen(), contents(home.parent)
    select("Probe")
    bpy.ops.object.duplicate(linked=linked)
    bpy.context.view_layer.update()
    assert status("Probe.001").copy_of == "Probe" and shown() == ["Probe"]
    bpy.data.objects["Probe.001"].location.x += 20.0
    again(home)
    assert status("Probe.001").copy_of == "Probe" and status("Probe.001").state == "stale"
    bpy.ops.pcc.inject()
    assert shown() == ["Probe"] and np.array_equal(seen(), before)
    select("Probe.001")
    bpy.ops.pcc.bake(scope="SELECTED")
    assert not status("Probe.001").copy_of and np.array_equal(seen(), before)
    again(home)
    check()
    after = contents(home.parent)
    assert {name: after[name] for name in first if ".exr" in name} == {n: b for n, b in first.items() if ".exr" in n}


@pytest.mark.parametrize("linked", [False, True], ids=["Shift+D", "Alt+D"])
def test_duplicated_objects_show_what_their_originals_show(home: Path, linked: bool) -> None:
    select("Table", "Wall -Z")
    bpy.ops.object.duplicate(linked=linked)
    again(home)
    check_nothing_pink()
    assert shown() == shown("Wood") == ["Probe"]
    works_again()


def test_a_duplicated_material_shows_the_probe_and_is_restored_like_its_original(home: Path) -> None:
    bpy.ops.pcc.remove()
    clean = {node.name for node in bpy.data.materials["Floor"].node_tree.nodes}
    bpy.ops.pcc.inject()
    copy = bpy.data.materials["Floor"].copy()
    bpy.data.objects["Wall -Z"].data.materials[0], name = copy, copy.name
    again(home)
    copy = bpy.data.materials[name]
    assert shown(copy) == ["Probe"]
    check()
    bpy.ops.pcc.remove()
    assert {node.name for node in copy.node_tree.nodes} == clean and not has_twins(copy)


def test_a_room_that_is_duplicated_whole_is_a_room_of_its_own(home: Path) -> None:
    before = seen(64).mean()
    bpy.ops.object.select_all(action="SELECT")
    bpy.context.scene.camera.select_set(False)
    bpy.ops.object.duplicate()
    for item in bpy.context.selected_objects:
        item.location.x += 30.0
    bpy.context.view_layer.update()
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"} and bpy.ops.pcc.inject() == {"FINISHED"}
    again(home)
    check()
    assert sorted(shown()) == ["Probe", "Probe.001"]
    assert seen(64).mean() == pytest.approx(before, rel=0.02)


# Deleted.


def test_a_deleted_probe_leaves_materials_as_they_were_without_and_no_picture(home: Path) -> None:
    bpy.ops.pcc.remove()
    before = {path: value for path, value in settled().items() if not path.startswith("objects")}
    bpy.ops.pcc.inject()
    select("Probe")
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    after = {path: value for path, value in settled().items() if not path.startswith("objects")}
    assert difference(before, after) == []
    for _ in range(3):
        again(home)
        check_nothing_pink()
    assert not [image.name for image in bpy.data.images if image.name.startswith("PCC")]
    assert not [tree.name for tree in bpy.data.node_groups if marks.role(tree) == probe_group.ROLE]


def test_the_original_of_a_copy_may_be_deleted(home: Path) -> None:
    select("Probe")
    bpy.ops.object.duplicate()
    bpy.context.view_layer.update()
    bpy.data.objects.remove(bpy.data.objects["Probe"])
    bpy.context.view_layer.update()
    again(home)
    [found] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert (found.probe, found.state, found.copy_of) == ("Probe.001", "baked", "")
    bpy.ops.pcc.inject()
    check()
    assert shown() == ["Probe.001"]
    for _ in range(3):
        again(home)
        check()


def test_a_deleted_picture_is_named_and_made_again_by_a_bake(home: Path) -> None:
    bpy.data.images.remove(probe().pcc_probe.levels[0].image)
    assert status().why == "its picture of roughness 0 is missing from the file; bake it again"
    works_again()
