"""Bakes are checked by themselves: once nothing is going on, where that takes no time, and only then."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import pytest

from pcc_addon.blender import handlers
from pcc_addon.ui.kept import idle, last_plan, states
from tests.blender.helpers import small_probe
from tests.blender.materials import shiny, show


@pytest.fixture
def checks(monkeypatch) -> list[str]:
    """The scenes that were checked."""
    found = []

    def counted(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> list[object]:
        found.append(scene.name)
        return check(scene, view_layer)

    check = last_plan.check
    monkeypatch.setattr(last_plan, "check", counted)
    return found


@pytest.fixture
def now(monkeypatch) -> SimpleNamespace:
    """A clock that is set by hand."""
    clock = SimpleNamespace(monotonic=lambda: clock.seconds, seconds=1000.0)
    monkeypatch.setattr(idle, "time", clock)
    monkeypatch.setattr(idle, "_changed", 0.0)
    return clock


@pytest.fixture
def changed(probe, now) -> bpy.types.Object:
    """A probe and a thing, which has just been moved."""
    item = show(shiny())
    bpy.context.view_layer.update()
    item.location.x += 0.1
    bpy.context.view_layer.update()
    return item


def test_a_change_is_waited_out_and_then_checked_once(changed, checks, now) -> None:
    assert 0.0 < idle.check_when_idle() <= idle.QUIET and not checks
    now.seconds += idle.QUIET
    assert idle.check_when_idle() is None and checks == ["Scene"]
    assert not states.all_late(bpy.context.scene)
    assert idle.check_when_idle() is None and len(checks) == 1, "nothing has changed since"


def test_a_check_is_itself_no_change(changed, checks, now) -> None:
    now.seconds += idle.QUIET
    idle.check_when_idle()
    now.seconds += 5.0
    bpy.context.view_layer.update()
    assert idle.check_when_idle() is None and len(checks) == 1


def test_another_change_puts_it_off(changed, checks, now) -> None:
    now.seconds += 0.9 * idle.QUIET
    changed.location.x += 0.1
    bpy.context.view_layer.update()
    now.seconds += 0.2 * idle.QUIET
    assert idle.check_when_idle() > 0.0 and not checks


def test_another_selection_is_no_change(changed, checks, now) -> None:
    now.seconds += idle.QUIET
    changed.select_set(True)
    bpy.context.view_layer.objects.active = changed
    bpy.context.view_layer.update()
    assert idle.check_when_idle() is None and len(checks) == 1


def test_nothing_is_checked_while_a_bake_changes_the_scene_or_in_another_mode(changed, checks, now) -> None:
    now.seconds += idle.QUIET
    with handlers.paused():
        assert idle.check_when_idle() > 0.0
    bpy.context.view_layer.objects.active = changed
    bpy.ops.object.mode_set(mode="EDIT")
    now.seconds += idle.QUIET
    assert idle.check_when_idle() > 0.0 and not checks
    bpy.ops.object.mode_set(mode="OBJECT")
    now.seconds += idle.QUIET
    assert idle.check_when_idle() is None and len(checks) == 1


def test_what_took_long_is_not_checked_unasked_but_when_it_is_asked(changed, checks, now, monkeypatch) -> None:
    monkeypatch.setattr(idle, "UNNOTICED", 0.0)
    for known in (1, 2, 2):
        now.seconds += idle.QUIET
        assert idle.check_when_idle() is None and len(checks) == known
        changed.location.x += 0.1
        bpy.context.view_layer.update()
    assert states.all_late(bpy.context.scene)


@pytest.mark.parametrize("limit", ["MOST_POLYGONS", "MOST_OBJECTS"])
def test_a_large_scene_is_not_tried(changed, checks, now, monkeypatch, limit: str) -> None:
    monkeypatch.setattr(idle, limit, 0)
    now.seconds += idle.QUIET
    assert idle.check_when_idle() is None and not checks


def test_a_scene_without_probes_is_left_alone(scene, checks, now) -> None:
    show(shiny())
    now.seconds += idle.QUIET
    assert idle.check_when_idle() is None and not checks


def test_sequences_are_not_gone_through_unasked(changed, checks, now, monkeypatch) -> None:
    small_probe("Film")
    monkeypatch.setattr(idle, "frames_of", lambda probe: (1, 2) if probe.name == "Film" else ())
    now.seconds += idle.QUIET
    assert idle.check_when_idle() is None and not checks


def test_undo_is_a_change(probe, checks, now) -> None:
    bpy.ops.ed.undo_push(message="one")
    probe.location.x += 0.1
    bpy.ops.ed.undo_push(message="two")
    now.seconds += 10.0
    idle.check_when_idle()
    now.seconds += 10.0
    bpy.ops.ed.undo()
    assert 0.0 < idle.check_when_idle() <= idle.QUIET
