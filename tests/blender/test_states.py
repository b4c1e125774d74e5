"""How bakes stand, as panels know it: what was found, what has changed since, and what nobody knows."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import pytest

from pcc_addon.ui.kept import last_plan, running_bake, states
from pcc_addon.ui.kept.states import State
from tests.blender.helpers import bake, paint_wall, pretend_bake, put_in, save, small_probe, small_room
from tests.blender.materials import shiny, show


def known(name: str = "Probe") -> states.Known:
    return states.of(bpy.context.scene, bpy.data.objects[name])


def check() -> None:
    last_plan.check(bpy.context.scene, bpy.context.view_layer)


def test_before_a_check_only_what_has_no_bake_is_known(probe) -> None:
    small_probe("Other")
    assert known().state is State.UNASKED and known("Other").state is State.UNBAKED
    assert states.all_late(bpy.context.scene) and states.seconds(bpy.context.scene) is None


def test_a_check_says_how_each_stands_and_why(probe, scene) -> None:
    small_probe("Attic", (50.0, 0.0, 0.0))
    assert bpy.ops.pcc.status() == {"FINISHED"}
    assert known().state is State.STALE and known().words.startswith("the scene or the probe changed since its bake")
    assert known("Attic").sentence == "Not baked and needs none: no object is in its influence"
    assert not states.all_late(scene) and states.seconds(scene) is None, "the first time says nothing"
    check()
    assert states.seconds(scene) > 0.0


def test_a_bake_and_a_change_show_before_the_next_check(scene) -> None:
    probe = small_room()
    check()
    assert known().state is State.UNBAKED and not known().late
    bake(probe)
    assert known().state is State.BAKED and known().late, "it was baked since"
    check()
    assert known() == states.Known(State.BAKED)
    paint_wall()
    bpy.context.view_layer.update()
    assert known().state is State.BAKED and known().late
    assert known().sentence == "Baked. Not checked since the last change" and known().icon == State.UNASKED.icon
    check()
    assert known().state is State.STALE and not known().late


def test_a_plan_does_not_make_states_new(probe, scene) -> None:
    check()
    probe.location.x += 0.1
    bpy.context.view_layer.update()
    bpy.ops.pcc.plan()
    assert not last_plan.of(scene).late and known().late


def test_what_was_found_of_a_probe_is_not_that_of_another_of_its_name(probe, scene) -> None:
    check()
    probe.name = "Renamed"
    assert known("Renamed").state is State.STALE
    pretend_bake(small_probe("Probe"))
    assert known("Probe").state is State.UNASKED


def test_an_injection_is_not_asked_for_again(scene) -> None:
    probe = small_probe()
    show(shiny())
    pretend_bake(probe)
    put_in()
    probe.pcc_probe.weight = 0.5
    probe.pcc_probe.priority = 3
    small_probe("Other", half_extents=(1.0, 1.0, 1.0)).pcc_probe.priority = 9
    pretend_bake(bpy.data.objects["Other"])
    check()
    assert "inject again" in known().words + known("Other").words
    bpy.ops.pcc.inject()
    assert "inject again" not in known().words + known("Other").words


def test_a_bake_that_went_is_none(probe) -> None:
    check()
    probe.pcc_probe.bake_record = ""
    assert known().state is State.UNBAKED


@pytest.mark.parametrize("gone", ["file", "all"])
def test_what_was_known_is_forgotten_with_the_file(probe, scene, tmp_path, gone: str) -> None:
    check()
    if gone == "file":
        save(tmp_path / "a.blend")
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    else:
        last_plan.forget()
    assert known().state is State.UNASKED


def test_a_bake_of_stale_probes_tells_of_those_that_need_none(scene, capfd) -> None:
    small_probe("Attic", (50.0, 0.0, 0.0))
    assert bpy.ops.pcc.bake(scope="STALE") == {"FINISHED"}
    said = capfd.readouterr().out
    assert "probe 'Attic' is left as it is" in said and "; 1 is left as nothing shows it" in said
    assert "needs none" in known("Attic").words


def test_the_sign_of_a_state_says_it_and_checks_again(probe, scene) -> None:
    operator = bpy.types.PCC_OT_state
    asked = type("Asked", (), {"probe": "Probe"})
    assert "Not checked" in operator.description(bpy.context, asked)
    assert bpy.ops.pcc.state(probe="Probe") == {"FINISHED"}
    assert operator.description(bpy.context, asked).startswith("Stale: the scene or the probe changed")
    with pytest.raises(RuntimeError, match="no probe is called 'Gone'"):
        bpy.ops.pcc.state(probe="Gone")


@pytest.mark.parametrize("scope", ["ALL", "STALE"])
def test_bakes_of_many_leave_locked_probes_and_tell(scene, renders, capfd, scope: str) -> None:
    small_room()
    small_probe("Locked").pcc_probe.locked = True
    bpy.ops.pcc.bake(scope=scope)
    assert set(renders) == {"Probe"}
    assert "probe 'Locked' is left as it is: it is locked" in capfd.readouterr().out


def test_a_locked_probe_is_baked_where_it_is_selected(scene, renders) -> None:
    small_room()
    locked = small_probe("Locked")
    locked.pcc_probe.locked = True
    locked.select_set(True)
    bpy.ops.pcc.bake(scope="SELECTED")
    assert set(renders) == {"Locked"}


def test_a_probe_that_is_being_baked_says_so_until_it_has_its_bake(probe, monkeypatch) -> None:
    check()
    small_probe("Other")
    bake = SimpleNamespace(being_baked=frozenset({probe.session_uid}))
    monkeypatch.setattr(running_bake, "_running", bake)
    assert known().state is State.BAKING and known("Other").state is State.UNBAKED
    bake.being_baked = frozenset()
    assert known().state is State.STALE
