"""Probes, materials and collections that are appended, linked or overridden from another file."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.shade.twin import has_twins
from pcc_addon.blender.status import statuses
from sample_blends.scenes import empty_scene, principled
from tests.blender.filing import check, check_nothing_pink, look, opened, seen, shown, works_again
from tests.blender.helpers import ROOM, contents, save
from tests.blender.materials import show


@pytest.fixture
def shot(home: Path, tmp_path: Path) -> Path:
    """Another file in a folder of its own, open, with a camera; "Room" of the first is a collection of all in it."""
    collection = bpy.data.collections.new("Room")
    for item in bpy.context.scene.collection.objects[:]:
        if item.type != "CAMERA":
            collection.objects.link(item)
            bpy.context.scene.collection.objects.unlink(item)
    bpy.context.scene.collection.children.link(collection)
    save(home)
    empty_scene()
    look()
    blend = tmp_path / "shots" / "shot.blend"
    blend.parent.mkdir()
    save(blend)
    return blend


def take(home: Path, kind: str, name: str, *, link: bool) -> bpy.types.ID:
    """What the window does: append or link something of a file."""
    directory = f"{home}/{kind}/"
    operator = bpy.ops.wm.link if link else bpy.ops.wm.append
    options = {"instance_collections": False} if kind == "Collection" else {}
    assert operator(filepath=directory + name, directory=directory, filename=name, **options) == {"FINISHED"}
    bpy.context.view_layer.update()
    return next(i for i in getattr(bpy.data, f"{kind.lower()}s") if i.name == name and bool(i.library) == link)


def untouched(home: Path, before: dict[str, bytes]) -> None:
    after = contents(home.parent)
    assert {name: after[name] for name in before if "used-by" not in name} == before


def again(blend: Path) -> None:
    save(blend)
    opened(blend)


# Appended.


def test_an_appended_collection_brings_probe_pictures_and_materials(home: Path, shot: Path) -> None:
    before = contents(home.parent)
    take(home, "Collection", "Room", link=False)
    check()
    assert shown() == shown("Wood") == ["Probe"]
    again(shot)
    check()
    assert shown() == shown("Wood") == ["Probe"]
    works_again()
    save(shot)
    untouched(home, before)


def test_an_appended_probe_is_stale_and_is_baked_for_its_new_scene(home: Path, shot: Path) -> None:
    before = contents(home.parent)
    take(home, "Object", "Probe", link=False)
    show(principled("Own"))
    [found] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert found.state == "stale"
    bpy.ops.pcc.inject()
    assert shown("Own") == ["Probe"]
    again(shot)
    check_nothing_pink()
    bpy.data.objects["Probe"].pcc_probe.resolution = 24
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"}
    save(shot)
    untouched(home, before)


def test_an_appended_material_brings_the_probe_that_it_shows_and_is_itself_without_it(home: Path, shot: Path) -> None:
    before = contents(home.parent)
    show(take(home, "Material", "Wood", link=False))
    again(shot)
    check_nothing_pink()
    [found] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert (found.probe, found.state) == ("Probe", "stale") and shown("Wood") == ["Probe"]
    bpy.data.objects.remove(bpy.data.objects["Probe"])
    bpy.context.view_layer.update()
    assert not has_twins(bpy.data.materials["Wood"])
    again(shot)
    untouched(home, before)


def test_appending_twice_gives_a_copy_of_the_probe_that_is_told_as_one(home: Path, shot: Path) -> None:
    for _ in range(2):
        take(home, "Collection", "Room", link=False)
    copies = [s.copy_of for s in statuses(bpy.context.scene, bpy.context.view_layer)]
    assert copies == ["", "Probe"]
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"} and bpy.ops.pcc.inject() == {"FINISHED"}
    assert not any(s.copy_of for s in statuses(bpy.context.scene, bpy.context.view_layer))
    again(shot)
    check()


# Linked.


@pytest.mark.parametrize("instanced", [False, True])
def test_a_linked_collection_shows_what_its_own_file_shows(home: Path, shot: Path, instanced: bool) -> None:
    before = contents(home.parent)
    collection = take(home, "Collection", "Room", link=True)
    scene = bpy.context.scene
    if instanced:
        if collection.name in scene.collection.children:
            scene.collection.children.unlink(collection)
        empty = bpy.data.objects.new("Instance", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    linked = next(m for m in bpy.data.materials if m.name == "Floor")
    for _ in range(2):
        assert shown(linked) == ["Probe [room.blend]"] and not all_probes(scene)
        check_nothing_pink()
        with pytest.raises(RuntimeError, match="has no probe"):
            bpy.ops.pcc.inject()
        bpy.ops.pcc.remove()
        again(shot)
        scene, linked = bpy.context.scene, next(m for m in bpy.data.materials if m.name == "Floor")
    untouched(home, before)


def test_a_linked_collection_looks_the_same_as_at_home(home: Path, shot: Path) -> None:
    opened(home)
    expected = seen()
    opened(shot)
    take(home, "Collection", "Room", link=True)
    assert np.allclose(seen(), expected, atol=1e-5)


def test_a_linked_material_shows_the_probe_of_its_own_file(home: Path, shot: Path) -> None:
    before = contents(home.parent)
    show(take(home, "Material", "Floor", link=True), "Slab")
    for _ in range(2):
        linked = bpy.data.objects["Slab"].material_slots[0].material
        assert linked.library and shown(linked) == ["Probe [room.blend]"]
        check_nothing_pink()
        bpy.ops.pcc.remove()
        again(shot)
    untouched(home, before)


def test_own_materials_are_not_served_by_a_linked_probe_and_the_plan_does_not_know_it(home: Path, shot: Path) -> None:
    take(home, "Object", "Probe", link=True)
    show(principled("Own"))
    assert not all_probes(bpy.context.scene)
    assert not statuses(bpy.context.scene, bpy.context.view_layer)
    with pytest.raises(RuntimeError, match="has no probe"):
        bpy.ops.pcc.inject()


# Overridden.


@pytest.fixture
def overridden(home: Path, shot: Path) -> bpy.types.Object:
    """The probe of the other file, overridden with all that is in its collection."""
    collection = take(home, "Collection", "Room", link=True)
    if collection.name in bpy.context.scene.collection.children:
        bpy.context.scene.collection.children.unlink(collection)
    collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, do_fully_editable=True)
    bpy.context.view_layer.update()
    return next(o for o in bpy.data.objects if o.name == "Probe" and o.override_library)


def test_an_overridden_probe_cannot_keep_a_bake_and_says_where_to_bake_it(overridden, shot: Path) -> None:
    with pytest.raises(RuntimeError, match="is a library override and cannot keep a bake; bake it in"):
        bpy.ops.pcc.bake(scope="ALL")
    assert overridden.pcc_probe.levels and overridden.pcc_probe.bake_record
    [found] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert found.state == "baked", found.why
    overridden.location.x += 0.1
    [found] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert found.state == "stale" and "or the probe changed since its bake; it is a library override" in found.why


def test_own_materials_show_an_overridden_probe_and_go_on_after_loading(overridden, shot: Path) -> None:
    show(principled("Own", Roughness=0.3))
    bpy.ops.pcc.inject()
    groups = [t.name for t in bpy.data.node_groups if not t.library]
    expected = seen()
    for _ in range(3):
        again(shot)
        assert shown("Own") == ["Probe"] and [t.name for t in bpy.data.node_groups if not t.library] == groups
        assert np.allclose(seen(), expected, atol=1e-5)
        check_nothing_pink()
    bpy.ops.pcc.remove()
    assert not has_twins(bpy.data.materials["Own"])


def test_an_overridden_material_is_left_to_its_own_file(home: Path, shot: Path) -> None:
    take(home, "Collection", "Room", link=True)
    material = take(home, "Material", "Wood", link=True).override_create(remap_local_usages=True)
    item = show(material)
    item.name = "Shelf"
    show(principled("Own"))
    small = bpy.data.objects.new("Local", None)
    bpy.context.scene.collection.objects.link(small)
    small.location, small.scale, small.empty_display_type = ROOM.centre, ROOM.half_extents, "CUBE"
    small.pcc_probe.is_probe, small.pcc_probe.resolution, small.pcc_probe.samples = True, 16, 1
    bpy.context.view_layer.update()
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"} and bpy.ops.pcc.inject() == {"FINISHED"}
    nodes = len(material.node_tree.nodes)
    for _ in range(2):
        again(shot)
        material = next(m for m in bpy.data.materials if m.override_library)
        assert len(material.node_tree.nodes) == nodes and shown("Own") == ["Local"]
        [plan] = [p for p in plan_scene(bpy.context.scene, bpy.context.view_layer).materials if p.material == "Wood"]
        assert plan.reasons[0].startswith("is a library override") and "room.blend" in plan.reasons[0]
        bpy.ops.pcc.remove()
        assert len(material.node_tree.nodes) == nodes and not has_twins(bpy.data.materials["Own"])
        bpy.ops.pcc.inject()


def test_an_overridden_room_shows_its_probe_and_goes_on_after_loading(overridden, home: Path, shot: Path) -> None:
    before = contents(home.parent)
    for _ in range(2):
        check_nothing_pink()
        materials = [m for m in bpy.data.materials if m.name == "Floor"]
        assert any(shown(m) for m in materials)
        again(shot)
    bpy.ops.pcc.inject()
    check_nothing_pink()
    bpy.ops.pcc.remove()
    again(shot)
    check_nothing_pink()
    untouched(home, before)


def test_an_overridden_probe_that_is_made_local_is_baked_in_its_new_file(overridden, home: Path, shot: Path) -> None:
    before = contents(home.parent)
    for item in [o for o in bpy.data.objects if o.override_library]:
        item.make_local()
    for material in [m for m in bpy.data.materials if m.override_library or m.library]:
        material.make_local()
    bpy.context.view_layer.update()
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"} and bpy.ops.pcc.inject() == {"FINISHED"}
    again(shot)
    check()
    untouched(home, before)
    assert not any(marks.is_copy(m) for m in bpy.data.materials)
