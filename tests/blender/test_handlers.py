"""What happens by itself when something changes, a file is opened or saved, or a step is undone; and what does not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import handlers, marks
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.blender.shade import injection, live, probe_group
from pcc_addon.blender.store import leftovers
from pcc_addon.core.effects.records import Correction, LookupEffects, Outside
from sample_blends.scenes import principled_node
from tests.blender.helpers import ROOM, pretend_bake, put_in, save, small_probe
from tests.blender.materials import shiny, show
from tests.blender.receivers import nested


def update() -> None:
    bpy.context.view_layer.update()


def lookup_node(probe: bpy.types.Object) -> bpy.types.Node:
    return next(node for node in probe.pcc_probe.group.nodes if node.label == "Lookup")


def metallic(material: bpy.types.Material, value: float | None = None) -> float:
    """The metalness of a material's surface, which may be set; returns what its twin repeats."""
    if value is not None:
        principled_node(material).inputs["Metallic"].default_value = value
    return next(n for n in material.node_tree.nodes if n.label == "Reflectance").inputs["Metallic"].default_value


@pytest.fixture
def material(probe) -> bpy.types.Material:
    """A half metal that shows the probe."""
    material = shiny()
    principled_node(material).inputs["Metallic"].default_value = 0.5
    show(material)
    put_in()
    update()
    return material


def test_nothing_follows_in_a_pause_and_all_does_after_it(material) -> None:
    with handlers.paused():
        with handlers.paused():
            pass
        metallic(material, 0.75)
        update()
        assert metallic(material) == 0.5
    with pytest.raises(ZeroDivisionError), handlers.paused():
        raise ZeroDivisionError
    metallic(material, 0.25)
    update()
    assert metallic(material) == 0.25


def link_an_empty(probe: bpy.types.Object) -> None:
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Empty", None))


def move_an_object(probe: bpy.types.Object) -> None:
    bpy.data.objects["Mesh"].location.x += 0.1


def move_a_probe_far_away(probe: bpy.types.Object) -> None:
    probe.location.x += 1e5
    update()
    assert lookup_node(probe).inputs["Padding"].default_value == pytest.approx(probe_spec(probe).influence_padding)


@pytest.mark.parametrize("act", [link_an_empty, move_an_object, move_a_probe_far_away], ids=lambda f: f.__name__)
def test_materials_that_nothing_changes_cost_no_look(material, probe, monkeypatch, act: Callable) -> None:
    show(shiny("Other"), "Second")
    probe.location.x += 0.1
    update()  # it has its general lookup
    seen: list[str] = []
    monkeypatch.setattr(live, "bring_up_to_date", lambda material, _: seen.append(material.name))
    act(probe)
    update()
    assert "Other" not in seen
    if act is not move_a_probe_far_away:
        assert seen == []


def test_an_edit_inside_a_group_reaches_materials_that_nobody_sees_now(probe) -> None:
    material, other = nested(), nested()
    outer, inner = bpy.data.node_groups["Outer"], bpy.data.node_groups["Inner"]
    next(n for n in other.node_tree.nodes if n.bl_idname == "ShaderNodeGroup").node_tree = outer
    show(material), show(other, "Second")
    put_in()
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["Second"])
    update()
    next(n for n in inner.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled").inputs["Metallic"].default_value = 1.0
    update()
    outside = [tree for tree in bpy.data.node_groups if tree.name.startswith("PCC Outer") and tree.users]
    copies = [n.node_tree for tree in outside for n in nodes_of(tree) if n.node_tree.name.startswith("PCC Inner")]
    assert len(copies) == 2
    assert all(any(n.node_tree and "metal alone" in n.node_tree.name for n in nodes_of(copy)) for copy in copies)


@pytest.mark.parametrize(
    "act",
    [lambda probe: bpy.data.objects.remove(probe), lambda probe: probe.users_collection[0].objects.unlink(probe)],
    ids=["deleted", "unlinked"],
)
def test_a_probe_that_goes_is_taken_out_of_materials_that_nobody_sees_now(material, probe, act: Callable) -> None:
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["Mesh"])
    update()
    act(probe)
    update()
    assert not [node for node in material.node_tree.nodes if marks.role(node)]


def nodes_of(tree: bpy.types.ShaderNodeTree) -> list[bpy.types.Node]:
    return [node for node in tree.nodes if node.bl_idname == "ShaderNodeGroup"]


@pytest.mark.parametrize(
    "act",
    [lambda probe: setattr(probe, "empty_display_size", 0.25), lambda probe: setattr(probe.scale, "x", 0.25)],
    ids=["drawn smaller", "scaled"],
)
def test_a_box_that_shrinks_gets_the_lookup_of_surfaces_outside(material, probe, act: Callable) -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = ROOM.centre
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    update()
    put_in()
    inside = LookupEffects(Correction.ALIGNED_BOX, None, False, on_walls=False)
    assert probe_group.shown_effects(probe.pcc_probe.group) == inside.label
    act(probe)
    update()
    general = LookupEffects(Correction.ALIGNED_BOX, Outside.OWN, False, facing=True)
    assert probe_group.shown_effects(probe.pcc_probe.group) == general.label


def test_a_copy_without_a_bake_keeps_the_group_that_it_came_with(material, probe) -> None:
    copy = probe.copy()
    copy.pcc_probe.bake_record = ""
    bpy.context.scene.collection.objects.link(copy)
    update()
    assert copy.pcc_probe.group == probe.pcc_probe.group


def test_a_box_without_volume_is_followed_again_once_it_has_one(material, probe, capfd) -> None:
    probe.scale.z = 0.0
    update()
    probe.pcc_probe.padding = 0.125
    assert "Error" not in "".join(capfd.readouterr())
    probe.rotation_euler.x, probe.scale.z = 0.5, 1.0
    update()
    assert probe_group.shown_effects(probe.pcc_probe.group).startswith("oriented box")
    probe.pcc_probe.padding = 0.25
    assert lookup_node(probe).inputs["Padding"].default_value == pytest.approx(0.25, rel=1e-4)


def test_undo_and_redo_bring_twins_along_at_once(material) -> None:
    name = material.name
    for value in (0.25, 0.75):
        bpy.ops.ed.undo_push(message=str(value))
        metallic(bpy.data.materials[name], value)
    bpy.ops.ed.undo_push(message="last")  # taken before the twin follows
    for step, expected in ((bpy.ops.ed.undo, 0.25), (bpy.ops.ed.redo, 0.75)):
        step()
        assert metallic(bpy.data.materials[name]) == expected


@pytest.mark.parametrize("goes", [injection.remove, lambda: handlers.on_load("")])
def test_groups_of_formulas_that_nothing_uses_stay_as_long_as_undo_may_know_them(material, goes) -> None:
    unused = next(t for t in bpy.data.node_groups if (marks.role(t) or "").startswith("formula: ")).copy()
    assert unused.users == 0
    name = unused.name
    handlers.bring_all_up_to_date(bpy.context.scene)
    assert name in bpy.data.node_groups
    goes()
    assert name not in bpy.data.node_groups


def test_opening_a_file_builds_old_groups_again_in_every_scene_past_a_faulty_probe(material, probe, tmp_path) -> None:
    other = small_probe("Other")
    pretend_bake(other)
    bpy.data.scenes.new("Second").collection.objects.link(other)
    bpy.context.scene.collection.objects.unlink(other)
    faulty = small_probe("A Faulty One")
    pretend_bake(faulty)
    faulty.pcc_probe.bake_record = "{"
    for item in (probe, other, faulty):
        marks.note(item.pcc_probe.group, marks.VERSION, probe_group.VERSION - 1)
    save(tmp_path / "old.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "old.blend"))
    current = {name: probe_group.is_current(bpy.data.objects[name]) for name in ("Probe", "Other", "A Faulty One")}
    assert current == {"Probe": True, "Other": True, "A Faulty One": False}


def test_a_file_that_is_left_and_an_add_on_that_is_switched_off_forget_their_bakes(scene, tmp_path: Path) -> None:
    path = tmp_path / "picture.exr"
    path.touch()
    leftovers.wrote([path])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert leftovers.unsaved() == []
    leftovers.wrote([path])
    handlers.unregister()
    handlers.register()
    assert leftovers.unsaved() == []


def test_a_save_tidies_up_after_the_file_that_it_wrote(scene, tmp_path: Path, monkeypatch) -> None:
    saved: list[Path] = []
    monkeypatch.setattr(leftovers, "after_save", saved.append)
    save(tmp_path / "a.blend")
    handlers.on_save("")
    assert saved == [tmp_path / "a.blend"]
