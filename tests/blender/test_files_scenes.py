"""Scenes that are copied, view layers, instances of collections: each scene's probes are told and shown as they are."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.status import statuses
from tests.blender.filing import check, check_nothing_pink, look, opened, seen, shown, status, works_again
from tests.blender.helpers import contents, save


def new_scene(kind: str) -> bpy.types.Scene:
    before = {*bpy.data.scenes}
    assert bpy.ops.scene.new(type=kind) == {"FINISHED"}
    [scene] = {*bpy.data.scenes} - before
    enter(scene)
    return scene


def enter(scene: bpy.types.Scene) -> None:
    bpy.context.window.scene = scene
    bpy.context.view_layer.update()


def again(blend: Path) -> None:
    """Save, and open again with the same scene on show."""
    save(blend)
    opened(blend)


@pytest.mark.parametrize("kind", ["NEW", "EMPTY"])
def test_a_new_scene_has_no_probes_and_leaves_those_of_others_alone(home: Path, kind: str) -> None:
    before = seen()
    scene = new_scene(kind)
    assert not all_probes(scene) and not statuses(scene, scene.view_layers[0])
    with pytest.raises(RuntimeError, match="has no probe; add one and bake it"):
        bpy.ops.pcc.inject()
    again(home)
    enter(bpy.data.scenes["Scene"])
    check()
    assert np.array_equal(seen(), before)


def test_a_linked_copy_of_a_scene_has_the_same_probes(home: Path) -> None:
    scene = new_scene("LINK_COPY")
    assert all_probes(scene) == all_probes(bpy.data.scenes["Scene"])
    check()
    again(home)
    check()
    works_again()
    enter(bpy.data.scenes["Scene"])
    bpy.ops.pcc.inject()
    check()


def test_a_full_copy_of_a_scene_gets_probes_of_its_own_and_shares_materials(home: Path) -> None:
    """A material shows the probes of the scene in which it was injected last, and status says so in the other."""
    first, before = contents(home.parent), seen()
    new_scene("FULL_COPY")
    [copied] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert (copied.probe, copied.copy_of) == ("Probe.001", "Probe")
    again(home)
    assert status("Probe.001").copy_of == "Probe"
    for _ in range(2):
        assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"} and bpy.ops.pcc.inject() == {"FINISHED"}
        check()
    assert shown() == shown("Wood") == ["Probe.001"]
    enter(bpy.data.scenes["Scene"])
    assert status().outdated == ("'Floor' and 'Wood' would show it otherwise",)
    assert bpy.ops.pcc.inject() == {"FINISHED"} and shown() == ["Probe"]
    check()
    assert np.allclose(seen(), before, atol=1e-5)
    again(home)
    check_nothing_pink()
    after = contents(home.parent)
    pictures = {name: data for name, data in first.items() if name.endswith(".exr")}
    assert {name: after[name] for name in pictures} == pictures


def test_a_scene_that_is_deleted_takes_its_own_probes_along(home: Path) -> None:
    new_scene("FULL_COPY")
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    bpy.ops.scene.delete()
    bpy.context.view_layer.update()
    assert bpy.context.scene.name == "Scene"
    check()
    for _ in range(3):
        again(home)
    assert [item.name for item in bpy.data.objects if item.pcc_probe.is_probe] == ["Probe"]
    check()
    works_again()


def test_a_view_layer_without_the_probe_says_so_and_another_shows_it(home: Path) -> None:
    collection = bpy.data.collections.new("Probes")
    bpy.context.scene.collection.children.link(collection)
    probe = bpy.data.objects["Probe"]
    collection.objects.link(probe)
    bpy.context.scene.collection.objects.unlink(probe)
    layer = bpy.context.scene.view_layers.new("Without")
    layer.layer_collection.children["Probes"].exclude = True
    again(home)
    scene = bpy.context.scene
    for name, state in (("Without", "error"), ("ViewLayer", "baked")):
        bpy.context.window.view_layer = scene.view_layers[name]
        bpy.context.view_layer.update()
        [found] = statuses(scene, bpy.context.view_layer)
        assert found.state == state, found
        assert shown() == ["Probe"]
    works_again()


def test_instances_of_a_collection_show_the_probes_around_them(home: Path) -> None:
    """The room's things are instanced once where they were; the probe stays."""
    collection = bpy.data.collections.new("Things")
    for item in bpy.context.scene.objects[:]:
        if item.type == "MESH":
            bpy.context.scene.collection.objects.unlink(item)
            collection.objects.link(item)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    assert bpy.ops.pcc.bake(scope="ALL") == {"FINISHED"} and bpy.ops.pcc.inject() == {"FINISHED"}
    assert shown() == shown("Wood") == ["Probe"]
    before = seen()
    again(home)
    assert shown() == ["Probe"] and np.array_equal(seen(), before)
    check()
    bpy.data.objects["Table"].pcc.show_probes = False
    assert shown() == ["Probe"] and shown("Wood") == []


def test_an_instanced_probe_is_none_of_the_scene(home: Path) -> None:
    """An instance has no settings of its own: what shows the probe's place is the probe, in its own scene."""
    collection = bpy.data.collections.new("All")
    for item in bpy.context.scene.objects[:]:
        bpy.context.scene.collection.objects.unlink(item)
        collection.objects.link(item)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    look()
    again(home)
    assert not all_probes(bpy.context.scene)
    check_nothing_pink()
    with pytest.raises(RuntimeError, match="has no probe; add one and bake it"):
        bpy.ops.pcc.inject()
