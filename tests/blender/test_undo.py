"""A bake is a step that undo takes back, with the pictures that belong to the record before."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.status import statuses
from tests.blender.helpers import paint_wall, picture, pictures_of, save, small_room


def bake_step() -> np.ndarray:
    """Bake as a button does; returns the picture."""
    assert bpy.ops.pcc.bake("EXEC_DEFAULT", True, scope="ALL") == {"FINISHED"}
    return picture(bpy.data.objects["Probe"]).copy()


def shown() -> np.ndarray | None:
    probe = bpy.data.objects["Probe"]
    return picture(probe) if len(probe.pcc_probe.levels) else None


def state() -> str:
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    return status.state


@pytest.mark.parametrize("packed", [True, False])
def test_undo_and_redo_go_through_bakes_with_their_pictures(scene, tmp_path: Path, packed: bool) -> None:
    small_room()
    if not packed:
        save(tmp_path / "room.blend")
    bpy.ops.ed.undo_push(message="room")
    first = bake_step()
    paint_wall()
    bpy.ops.ed.undo_push(message="painted")
    second = bake_step()
    assert not np.array_equal(first, second)
    bpy.ops.pcc.inject("EXEC_DEFAULT", True)
    expected = [(second, "baked"), (first, "stale"), (first, "baked"), (None, "unbaked")]
    for picture_then, state_then in expected:
        bpy.ops.ed.undo()
        assert np.array_equal(shown(), picture_then) if picture_then is not None else shown() is None
        assert state() == state_then
    for picture_then, state_then in reversed(expected[:-1]):
        bpy.ops.ed.redo()
        assert np.array_equal(shown(), picture_then) and state() == state_then


def test_settings_made_before_a_bake_survive_undoing_the_injection(scene) -> None:
    probe = small_room()
    bpy.ops.ed.undo_push(message="room")
    probe.pcc_probe.resolution = 24  # no step of its own, as a script sets it
    bake_step()
    bpy.ops.pcc.inject("EXEC_DEFAULT", True)
    bpy.ops.ed.undo()
    settings = bpy.data.objects["Probe"].pcc_probe
    assert settings.resolution == 24 and settings.bake_record and state() == "baked"


def test_where_undo_goes_back_to_pictures_that_a_save_removed_status_says_so(scene, tmp_path: Path) -> None:
    small_room()
    save(tmp_path / "room.blend")
    bpy.ops.ed.undo_push(message="room")
    bake_step()
    gone = pictures_of(bpy.data.objects["Probe"])
    paint_wall()
    bake_step()
    save(tmp_path / "room.blend")
    bpy.ops.ed.undo()
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    assert status.state == "stale" and str(gone[0]) in status.why and "missing" in status.why
