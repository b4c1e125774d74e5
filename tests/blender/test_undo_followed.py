"""Undo right after materials followed an edit: what they were given no undo step has, and Blender ended by it.

Blender takes the step of an edit before handlers follow the edit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender import marks, unrecorded
from sample_blends.scenes import Room, add_wall, principled, principled_node
from tests.blender.filing import seen, shown, status
from tests.blender.helpers import pretend_bake, put_in, small_probe
from tests.blender.snapshots import settled
from tests.rna_dump import difference


def probe() -> bpy.types.Object:
    return bpy.data.objects["Probe"]


def floor() -> bpy.types.Material:
    return bpy.data.materials["Floor"]


def move() -> None:
    probe().location.x += 0.1


def grow() -> None:
    probe().scale.x *= 1.2


def turn() -> None:
    probe().rotation_euler = (0.2, 0.1, 0.4)


def take_apart() -> None:
    """The capture point stays where it was, so that it is off the box's middle."""
    probe().location.z += 0.2
    probe().pcc_probe.capture_offset.z -= 0.2


def roughen() -> None:
    """To a level that the bake has not."""
    principled_node(floor()).inputs["Roughness"].default_value = 0.45


def make_glassy() -> None:
    node = principled_node(floor())
    node.inputs["Transmission Weight"].default_value, node.inputs["Metallic"].default_value = 0.7, 0.3


def make_vary() -> None:
    tree = floor().node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], principled_node(floor()).inputs["Roughness"])


def duplicate() -> None:
    copy = probe().copy()
    bpy.context.scene.collection.objects.link(copy)
    copy.location.x += 0.3


def delete() -> None:
    bpy.data.objects.remove(probe())


EDITS = (move, grow, turn, take_apart, roughen, make_glassy, make_vary, duplicate)


def blocks(used: bool = False) -> set[tuple[str, int]]:
    kinds = ("node_groups", "materials", "images")
    found = [(kind, block) for kind in kinds for block in getattr(bpy.data, kind)]
    return {(kind, block.session_uid) for kind, block in found if block.users or not used}


_unrecorded: set[tuple[str, int]] = set()  # what no undo step has


class PCC_OT_test_edit(bpy.types.Operator):
    """Edits; its step is taken before handlers follow."""

    bl_idname, bl_label, bl_options = "pcc.test_edit", "Edit", {"REGISTER", "UNDO"}
    act: Callable[[], None]

    def execute(self, context: bpy.types.Context) -> set[str]:
        PCC_OT_test_edit.act()
        _unrecorded.clear()
        _unrecorded.update(blocks())
        return {"FINISHED"}


def edit(act: Callable[[], None]) -> bool:
    """Edit as a panel does: the step is taken, then handlers follow. Returns whether they made anything."""
    PCC_OT_test_edit.act = staticmethod(act)
    bpy.ops.pcc.test_edit("EXEC_DEFAULT", True)
    recorded = set(_unrecorded)
    _unrecorded.clear()
    _unrecorded.update(blocks() - recorded)
    return bool(_unrecorded)


@pytest.fixture(scope="module", autouse=True)
def _operator() -> Iterator[None]:
    bpy.utils.register_class(PCC_OT_test_edit)
    yield
    bpy.utils.unregister_class(PCC_OT_test_edit)


@pytest.fixture(autouse=True)
def _nothing_is_pointed_to_that_undo_frees() -> Iterator[None]:
    """Such a pointer is read without harm as long as its memory is not used again, so each undo is looked at before."""
    left: list[set[tuple[str, int]]] = []

    @bpy.app.handlers.persistent
    def look(*_: object) -> None:
        left.append(_unrecorded & blocks(used=True))
        _unrecorded.clear()

    bpy.app.handlers.undo_pre.append(look)
    yield
    bpy.app.handlers.undo_pre.remove(look)
    assert left and not any(left)


@pytest.mark.parametrize("act", [*EDITS, delete])
def test_undo_and_redo_after_an_edit_that_materials_followed(home: Path, act: Callable[[], None]) -> None:
    bpy.ops.ed.undo_push(message="before")
    picture, made = seen(), []
    for _ in range(3):
        made.append(edit(act))
        bpy.ops.ed.undo()
        np.testing.assert_allclose(seen(), picture, rtol=1e-4, atol=1e-5)
        bpy.ops.ed.redo()
        bpy.context.view_layer.update()
        bpy.ops.ed.undo()
    assert shown() == ["Probe"] and status().state == "baked" and status().outdated == ()
    assert made[0] is (act is not delete), "otherwise this tries nothing"


@pytest.mark.parametrize("first", EDITS)
@pytest.mark.parametrize("second", [turn, roughen])
def test_two_edits_are_undone_one_by_one(home: Path, first: Callable[[], None], second: Callable[[], None]) -> None:
    bpy.ops.ed.undo_push(message="before")
    picture = seen()
    edit(first)
    between = seen()
    edit(second)
    bpy.ops.ed.undo()
    np.testing.assert_allclose(seen(), between, rtol=1e-4, atol=1e-5)
    bpy.ops.ed.undo()
    np.testing.assert_allclose(seen(), picture, rtol=1e-4, atol=1e-5)


def test_objects_wear_their_copies_again(scene: bpy.types.Scene) -> None:
    """Copies of a material that is built otherwise are made anew, after the step of the edit."""
    shared = principled("Floor", Roughness=0.1)
    for k in range(4):
        room = Room((2.0, 1.5, 1.0), (5.0 * k, 0.0, 0.0), 0.0)
        add_wall(room, "-Z", shared).name = f"Floor {k}"
        pretend_bake(small_probe(f"Room {k}", room.centre, room.half_extents))
    put_in()
    bpy.ops.ed.undo_push(message="before")
    before = settled()
    for act in (make_vary, make_glassy, make_vary):
        edit(act)
        bpy.ops.ed.undo()
        assert difference(before, settled()) == []
    worn = [bpy.data.objects[f"Floor {k}"].material_slots[0].material for k in range(4)]
    assert [shown(material) for material in worn] == [[f"Room {k}"] for k in range(4)]
    assert all(marks.original(material).name == "Floor" and marks.is_copy(material) for material in worn)


def test_what_was_made_before_a_step_stays(home: Path) -> None:
    assert edit(turn), "handlers made groups"
    unrecorded.forget()  # as the next operator's step has them
    bpy.ops.ed.undo_push(message="next")
    known = blocks()
    edit(move)
    unrecorded.let_go(marks.original)
    assert known <= blocks()
    bpy.ops.ed.undo()
