"""The plan that panels show: kept, not made anew by them, and known to be late."""

from __future__ import annotations

import bpy
import pytest

from pcc_addon.blender import handlers
from pcc_addon.blender.planning import plan_scene
from pcc_addon.ui.kept import last_plan
from sample_blends.scenes import principled_node
from tests.blender.helpers import save, small_probe, small_room
from tests.blender.materials import shiny, show


def update() -> None:
    bpy.context.view_layer.update()


@pytest.fixture
def planned(probe, scene) -> bpy.types.Object:
    """A probe and an object that is to show it, planned."""
    show(shiny())
    update()
    bpy.ops.pcc.plan()
    return probe


def late() -> bool:
    return last_plan.of(bpy.context.scene).late


def waits() -> bool:
    return bpy.app.timers.is_registered(last_plan.plan_again)


@pytest.fixture(autouse=True)
def _nothing_waits():
    yield
    if waits():
        bpy.app.timers.unregister(last_plan.plan_again)


def test_there_is_none_before_one_is_asked_for(scene) -> None:
    small_probe()
    update()
    assert last_plan.of(scene) is None


def test_the_button_keeps_the_plan_of_its_scene_alone(planned, scene) -> None:
    assert last_plan.of(scene).plan == plan_scene(scene, bpy.context.view_layer) and not late()
    assert last_plan.of(bpy.data.scenes.new("Other")) is None


def test_injection_keeps_what_it_obeyed_and_is_not_itself_a_change(probe, scene) -> None:
    show(shiny())
    bpy.ops.pcc.inject()
    assert not late() and last_plan.of(scene).plan.materials[0].probes == ("Probe",)
    update()
    assert not late()


def test_a_bake_plans_anew(scene) -> None:
    probe = small_room()
    bpy.ops.pcc.plan()
    probe.pcc_probe.capture_offset = (0.3, 0.0, 0.0)
    bpy.ops.pcc.bake(scope="ALL")
    assert last_plan.of(scene).plan == plan_scene(scene, bpy.context.view_layer) and not late()
    assert last_plan.of(scene).plan.probes[0].lookup.offset
    update()
    assert not late()


def move() -> None:
    bpy.data.objects["Mesh"].location.x += 0.1


def paint() -> None:
    principled_node(bpy.data.materials["Shiny"]).inputs["Roughness"].default_value = 0.4


def delete() -> None:
    bpy.data.objects.remove(bpy.data.objects["Mesh"])


def add() -> None:
    show(shiny(), "Another")


@pytest.mark.parametrize("change", [move, paint, delete, add])
def test_a_change_makes_it_late_until_it_is_planned_again(planned, change) -> None:
    change()
    update()
    assert late()
    bpy.ops.pcc.plan()
    assert not late()


def test_another_selection_does_not_make_it_late(planned) -> None:
    for item in bpy.context.scene.objects:
        item.select_set(not item.select_get())
    bpy.context.view_layer.objects.active = bpy.data.objects["Mesh"]
    update()
    assert not late()


def test_undo_makes_it_late(probe) -> None:
    show(shiny())
    bpy.ops.ed.undo_push(message="one")
    move()
    bpy.ops.ed.undo_push(message="two")
    bpy.ops.pcc.plan()
    bpy.ops.ed.undo()
    assert late()


def test_another_file_forgets_it(planned, tmp_path) -> None:
    save(tmp_path / "a.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert last_plan.of(bpy.context.scene) is None


@pytest.mark.parametrize("of_material", [True, False])
def test_a_choice_is_planned_as_soon_as_it_is_made(planned, scene, of_material: bool) -> None:
    before = last_plan.of(scene).plan
    if of_material:
        bpy.data.materials["Shiny"].pcc.effects.metal = "ON"
    else:
        planned.pcc_probe.effects.weight = "ON"
    assert waits() and late()
    assert last_plan.plan_again() is None
    assert not late() and last_plan.of(scene).plan == plan_scene(scene, bpy.context.view_layer) != before


def test_a_choice_does_not_plan_what_takes_long_nor_what_nobody_planned(planned, scene, monkeypatch) -> None:
    monkeypatch.setattr(last_plan, "AT_ONCE", -1.0)
    planned.pcc_probe.effects.weight = "ON"
    assert late() and not waits()
    last_plan.forget()
    monkeypatch.undo()
    planned.pcc_probe.effects.weight = "OFF"
    assert last_plan.of(scene) is None and not waits()


def test_nothing_is_planned_while_a_bake_changes_the_scene(planned) -> None:
    planned.pcc_probe.effects.weight = "ON"
    with handlers.paused():
        assert last_plan.plan_again() > 0.0 and late()
