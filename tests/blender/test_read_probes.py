"""Probe objects as records: which there are, what they leave out, whether their place is known, what may move them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import pytest
from mathutils import Matrix

from pcc_addon.blender.read import probes
from pcc_addon.core.effects.records import Outside
from pcc_addon.core.errors import PccError, ProbeError
from pcc_addon.core.probe import Engine
from sample_blends.scenes import empty_scene
from tests.blender.helpers import pretend_bake, save, small_probe

pytestmark = pytest.mark.usefixtures("scene")


def empty(name: str = "Empty") -> bpy.types.Object:
    item = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(item)
    return item


def linked_probe(folder: Path) -> bpy.types.Object:
    """A new scene's probe called "Linked", from the library that the present file becomes."""
    small_probe("Linked")
    save(folder / "library.blend")
    empty_scene()
    with bpy.data.libraries.load(str(folder / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Linked"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    return wanted.objects[0]


def place_fault(probe: bpy.types.Object) -> str:
    """What `check_place` says of it; empty: nothing."""
    bpy.context.view_layer.update()
    try:
        probes.check_place(probe, bpy.context.view_layer)
    except ProbeError as error:
        return str(error)
    return ""


def test_every_setting_reaches_the_record() -> None:
    probe = small_probe()
    before = probes.probe_spec(probe)
    wanted = {
        "capture_offset": (0.5, -0.25, 0.125), "resolution": 48, "samples": 3, "engine": Engine.EEVEE, "denoise": False,
        "clip_start": 0.25, "clip_end": 8.0, "padding": 0.5, "falloff": 0.75, "outside": Outside.BLACK,
    }  # fmt: skip
    for name, value in wanted.items():
        setattr(probe.pcc_probe, name, getattr(value, "value", value))
    probe.pcc_probe.correction = "NONE"
    probe.pcc_probe.hidden_objects.add().object = empty("Ball")
    probe.keyframe_insert("location", frame=1)
    assert (before.corrected, before.hidden, before.animated) == (True, (), False)
    assert probes.probe_spec(probe) == replace(before, **wanted, corrected=False, hidden=("Ball",), animated=True)


def test_the_probes_of_a_scene_are_its_own_by_name(tmp_path: Path) -> None:
    linked_probe(tmp_path)
    small_probe("B"), empty("C"), small_probe("A")
    scene = bpy.context.scene
    assert [probe.name for probe in probes.all_probes(scene)] == ["A", "B"]
    assert [probe.name for probe in probes.named_probes(scene, ["B", "A", "B"])] == ["B", "A", "B"]
    with pytest.raises(PccError, match=r"no probe is called 'C' in scene 'Scene'; its probes: 'A', 'B'$"):
        probes.named_probes(scene, ["A", "C"])
    with pytest.raises(PccError, match=r"its probes: none$"):
        probes.named_probes(bpy.data.scenes.new("Other"), ["A"])


def test_what_is_hidden_from_a_capture_is_listed_once_by_name() -> None:
    probe, hidden = small_probe(), bpy.data.collections.new("Hidden")
    inner = bpy.data.collections.new("Inner")
    hidden.children.link(inner)
    b, a, deep = empty("B"), empty("A"), empty("Deep")
    hidden.objects.link(a), inner.objects.link(deep)
    for item in (b, None, a):
        probe.pcc_probe.hidden_objects.add().object = item
    assert probes.hidden_objects(probe) == [a, b]
    probe.pcc_probe.hidden_collection = hidden
    assert probes.hidden_objects(probe) == [a, b, deep]


def test_a_probe_outside_the_view_layer_has_no_place() -> None:
    probe, attic = small_probe(), bpy.data.collections.new("Attic")
    bpy.context.scene.collection.children.link(attic)
    attic.objects.link(probe)
    bpy.context.scene.collection.objects.unlink(probe)
    assert place_fault(probe) == ""
    bpy.context.view_layer.layer_collection.children["Attic"].exclude = True
    fault = place_fault(probe)
    assert fault.startswith("probe 'Probe': view layer 'ViewLayer' leaves its collection out")
    assert "include the collection" in fault


def test_a_disabled_probe_has_a_place_until_it_is_moved() -> None:
    probe, parent = small_probe(), empty("Parent")
    parent.location, parent.rotation_euler = (1.0, 2.0, 3.0), (0.1, 0.2, 0.3)
    bpy.context.view_layer.update()
    probe.parent, probe.matrix_parent_inverse = parent, Matrix.Translation((0.0, 0.0, 1.0))
    bpy.context.view_layer.update()
    probe.hide_viewport = True
    assert place_fault(probe) == ""
    probe.location.x += 1e-6
    assert place_fault(probe) == "", "rounding is no move"
    probe.location.x += 1e-3
    assert place_fault(probe).startswith("probe 'Probe' was moved while it is disabled in viewports")
    probe.hide_viewport = False
    assert place_fault(probe) == "", "it is up to date again"


def test_where_animation_puts_a_disabled_probe_is_not_compared() -> None:
    probe = small_probe()
    probe.constraints.new("COPY_LOCATION").target = empty()
    bpy.context.view_layer.update()
    probe.hide_viewport = True
    probe.location.x += 5.0
    assert place_fault(probe) == ""


def by_keyframes(item: bpy.types.Object) -> None:
    item.keyframe_insert("location", frame=1)


def by_a_driver(item: bpy.types.Object) -> None:
    item.driver_add("location", 0)


def by_a_strip(item: bpy.types.Object) -> None:
    by_keyframes(item)
    action = item.animation_data.action
    item.animation_data.nla_tracks.new().strips.new("Strip", 1, action)
    item.animation_data.action = None


def by_a_driver_and_a_strip(item: bpy.types.Object) -> None:
    by_a_strip(item), by_a_driver(item)


def by_a_constraint(item: bpy.types.Object) -> None:
    item.constraints.new("COPY_LOCATION")


def by_a_vertex(item: bpy.types.Object) -> None:
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata([(0, 0, 0)], [], [])
    item.parent, item.parent_type = bpy.data.objects.new("Mesh", mesh), "VERTEX"


MOVERS = [by_keyframes, by_a_driver, by_a_strip, by_a_driver_and_a_strip, by_a_constraint, by_a_vertex]


@pytest.mark.parametrize("move", MOVERS, ids=lambda f: f.__name__)
@pytest.mark.parametrize("of_parent", [False, True], ids=["itself", "its parent"])
def test_whatever_may_move_an_object_animates_it(of_parent: bool, move: Callable[[bpy.types.Object], None]) -> None:
    item, parent = empty("Item"), empty("Parent")
    item.parent = parent
    assert probes.is_animated(item) is False
    move(parent if of_parent else item)
    assert probes.is_animated(item) is True


def test_animation_data_that_moves_nothing_animates_nothing() -> None:
    item = empty()
    item.animation_data_create()
    assert probes.is_animated(item) is False and probes.is_animated(None) is False


def test_a_probe_has_a_record_from_its_bake_on() -> None:
    probe = small_probe()
    assert probes.bake_record(probe) is None
    pretend_bake(probe)
    assert probes.bake_record(probe).probe == "Probe"
    probe.pcc_probe.bake_record = "{"
    with pytest.raises(PccError, match=r"bake record of 'Probe'"):
        probes.bake_record(probe)


def test_a_library_override_cannot_keep_a_bake(tmp_path: Path) -> None:
    probe = linked_probe(tmp_path)
    probes.check_own(probe)
    with pytest.raises(ProbeError, match=r"'Linked' is a library override .*library\.blend.*Make Local"):
        probes.check_own(probe.override_create(remap_local_usages=True))
