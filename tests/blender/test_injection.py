"""Which materials an injection, a removal and the mending of what was deleted touch, and what they report."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import handlers, marks
from pcc_addon.blender.read.scene import read_scene
from pcc_addon.blender.shade import injection
from pcc_addon.blender.shade.probe_group import shown_probe
from pcc_addon.blender.shade.twin import is_torn, shown_probe_groups
from pcc_addon.core.errors import PccError
from pcc_addon.core.material_plan import MaterialPlan
from pcc_addon.core.parts import Division
from sample_blends.scenes import principled_node
from tests.blender.helpers import pretend_bake, put_in, save, small_probe
from tests.blender.materials import shiny, show


def injected() -> list[str]:
    """The materials that hold anything of ours."""
    return [m.name for m in bpy.data.materials if m.node_tree and any(marks.role(n) for n in m.node_tree.nodes)]


def mend() -> None:
    """As opening a file does, with nothing that follows edits meanwhile."""
    with handlers.paused():
        injection.mend(bpy.context.scene, bpy.context.view_layer)


def tear(material: bpy.types.Material) -> None:
    """Delete a group that its twin needs, as if the add-on were not there to see it."""
    with handlers.paused():
        next(n for n in material.node_tree.nodes if n.label == "Reflectance").node_tree = None
        bpy.context.view_layer.update()
    assert is_torn(material)


def linked_from(folder: Path, name: str) -> bpy.types.Material:
    """A material of another file that shows a probe, as the library has it."""
    path = folder / "library.blend"
    if not path.exists():
        save(path)
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.materials = [name]
    return wanted.materials[0]


def test_without_a_baked_probe_the_first_reason_is_given(scene) -> None:
    with pytest.raises(PccError, match=r"^scene 'Scene' has no probe; add one and bake it$"):
        put_in()
    small_probe("B"), small_probe("A")
    with pytest.raises(PccError, match=r"^probe 'A' has no bake; bake it to see it$"):
        put_in()


def test_the_report_names_who_shows_what_and_what_was_left_alone(probe) -> None:
    small_probe("Other")
    show(shiny())
    rough = shiny("Rough")
    principled_node(rough).inputs["Roughness"].default_value = 1.0
    show(rough, "Second")
    report = put_in()
    assert report.materials == (("Shiny", "Probe"),)
    bake_it, left = report.notes
    assert bake_it == "probe 'Other' has no bake; bake it to see it" and "material 'Rough'" in left
    [only] = [item for item in bpy.data.objects if item.name == "Mesh"]
    assert injection.inject(bpy.context.scene, bpy.context.view_layer, [only]).notes == (bake_it,)


def test_only_the_materials_of_chosen_objects_are_touched(probe) -> None:
    near, far = show(shiny("Near"), "Near"), show(shiny("Far"), "Far")
    put_in()
    assert injected() == ["Far", "Near"]
    near.location.x += 50.0
    far.location.x += 50.0
    bpy.context.view_layer.update()
    injection.inject(bpy.context.scene, bpy.context.view_layer, [near])
    assert injected() == ["Far"], "no probe reaches either; one was asked for"
    assert injection.remove([near]) == [] and injection.remove([far]) == ["Far"] and injected() == []


def test_removing_takes_the_formula_groups_along(probe) -> None:
    show(shiny())
    put_in()
    assert injection.remove() == ["Shiny"] and injection.remove() == []
    assert not [t for t in bpy.data.node_groups if (marks.role(t) or "").startswith("formula: Surface")]


def test_materials_of_objects_are_listed_once_by_name(scene) -> None:
    b, a = shiny("B"), shiny("A")
    one, other = show(b, "One"), show(a, "Other")
    one.data.materials.append(None), one.data.materials.append(a)
    assert injection.materials_of([one, other]) == [a, b]


def test_the_largest_box_comes_first_and_equal_ones_by_name(scene) -> None:
    sizes = {"Cupboard": 0.5, "B Room": 2.0, "A Room": 2.0, "Hall": 9.0, "Missing": 4.0}
    probes = {name: small_probe(name, half_extents=(1.0, size, 1.0)) for name, size in sizes.items()}
    for probe in probes.values():
        pretend_bake(probe)
    shown = {name: shown_probe(probe.pcc_probe.group) for name, probe in probes.items() if name != "Missing"}
    reading = read_scene(scene, bpy.context.view_layer)
    order = injection.order_of(MaterialPlan("Floor", Division(tuple(sizes)), (), (), ()), tuple(sizes), shown, reading)
    assert [probe.group for probe in order.probes] == [
        shown[name].group for name in ("Hall", "A Room", "B Room", "Cupboard")
    ]


def test_mending_builds_again_what_was_deleted_and_touches_nothing_else(probe, monkeypatch) -> None:
    torn, spared, left = shiny("Torn"), shiny("Spared"), shiny("Left")
    show(torn, "Torn"), show(spared, "Spared")
    small_probe("Unbaked"), setattr(small_probe("Flat").scale, "z", 0.0)
    put_in()
    show(left, "Left")  # no injection has seen it
    before = [node.as_pointer() for node in spared.node_tree.nodes]
    tear(torn)
    mend()
    assert not is_torn(torn) and shown_probe_groups(torn) == (probe.pcc_probe.group,)
    assert injected() == ["Spared", "Torn"] and [n.as_pointer() for n in spared.node_tree.nodes] == before

    def unexpected(*_: object) -> None:
        raise AssertionError("the scene was read for nothing")

    monkeypatch.setattr(injection, "read_and_plan", unexpected)
    mend()


def test_what_no_probe_serves_any_more_and_what_is_linked_is_not_mended(probe, tmp_path: Path) -> None:
    material = shiny("Torn")
    item = show(material)
    put_in()
    tear(material)
    with handlers.paused():
        linked = linked_from(tmp_path, "Torn")
        second = show(linked, "Second")
        item.location.x += 50.0
        bpy.context.view_layer.update()
    mend()
    assert is_torn(linked) and is_torn(material)
    injection.remove()
    assert [n for n in linked.node_tree.nodes if marks.role(n)], "it is its file's"
    assert injection.inject(bpy.context.scene, bpy.context.view_layer, [second]).materials == ()
