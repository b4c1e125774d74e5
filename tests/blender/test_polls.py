"""A button that cannot be pressed says why, and what to do."""

from __future__ import annotations

import bpy
import pytest

from tests.blender.drawn import ours
from tests.blender.helpers import small_probe
from tests.blender.materials import shiny, show


def empty() -> None:
    pass


def edited() -> None:
    """A mesh is edited, and the scene has a probe without a bake."""
    small_probe()
    bpy.context.view_layer.objects.active = show(shiny())
    bpy.ops.object.mode_set(mode="EDIT")


def with_a_mesh() -> None:
    bpy.context.view_layer.objects.active = show(shiny())


def told(operator: object) -> str:
    """Why an operator cannot run now; empty where it can."""
    if operator.poll():
        return ""
    with pytest.raises(RuntimeError) as caught:
        operator()
    return str(caught.value).partition("poll() ")[2].strip()


@pytest.mark.parametrize("state", [empty, with_a_mesh, edited], ids=lambda state: state.__name__)
def test_what_cannot_run_says_why(scene, state) -> None:
    state()
    said = {cls.bl_idname: told(getattr(bpy.ops.pcc, cls.bl_idname[4:])) for cls in ours(bpy.types.Operator)}
    assert len([name for name, why in said.items() if why]) >= 5
    for name, why in said.items():
        assert "context is incorrect" not in why, name
        assert not why or ((why[0].isupper() or why[0] == "'") and not why.endswith(".")), (name, why)


def test_injecting_asks_for_a_bake(scene) -> None:
    assert told(bpy.ops.pcc.inject) == "Scene 'Scene' has no probe; add one and bake it"
    small_probe()
    assert told(bpy.ops.pcc.inject) == "No probe of scene 'Scene' has a bake; bake one to see it"
