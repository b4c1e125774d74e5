"""Groups of ours that somebody deletes: bakes and handlers go on, and what is gone is built again."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from pcc_addon.blender import handlers
from sample_blends.scenes import principled_node
from tests.blender.helpers import bake, put_in, save, small_room

DELETED = ["PCC Probe", "PCC Surface", "PCC Lookup", "PCC Off Poles"]


def holes() -> list[str]:
    """Group nodes of any tree that have nothing inside."""
    trees = [*bpy.data.node_groups, *(m.node_tree for m in bpy.data.materials if m.node_tree)]
    return [n.name for tree in trees for n in tree.nodes if n.bl_idname == "ShaderNodeGroup" and n.node_tree is None]


def move() -> None:
    bpy.data.objects["Probe"].location.x += 0.1
    bpy.context.view_layer.update()


def edit() -> None:
    principled_node(bpy.data.materials["Floor"]).inputs["Base Color"].default_value = (0.1, 0.2, 0.3, 1.0)
    bpy.context.view_layer.update()


def set_falloff() -> None:
    bpy.data.objects["Probe"].pcc_probe.falloff = 1.0


def bake_again() -> None:
    [result] = bake(bpy.data.objects["Probe"])
    assert result.error is None


def reopen() -> None:
    save(Path(bpy.data.filepath))
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)


@pytest.mark.sweep
@pytest.mark.parametrize("act", [bake_again, put_in, reopen], ids=lambda f: f.__name__)
@pytest.mark.parametrize("name", DELETED)
def test_what_was_deleted_is_built_again(scene, tmp_path: Path, name, act) -> None:
    small_room()
    save(tmp_path / "room.blend")
    bake(bpy.data.objects["Probe"])
    put_in()
    [tree] = [tree for tree in bpy.data.node_groups if tree.name.startswith(name)]
    bpy.data.node_groups.remove(tree)
    assert holes()
    act()
    assert holes() == []
    floor = bpy.data.materials["Floor"].node_tree
    assert floor.get_output_node("CYCLES").inputs["Surface"].is_linked


@pytest.mark.parametrize("name", DELETED)
def test_edits_and_moves_go_on(scene, monkeypatch, name) -> None:
    """A handler's error is only printed: here the handler is called as Blender calls it."""
    small_room()
    bake(bpy.data.objects["Probe"])
    put_in()
    [tree] = [tree for tree in bpy.data.node_groups if tree.name.startswith(name)]
    bpy.data.node_groups.remove(tree)
    failures = []
    follow = handlers.on_depsgraph_update

    def watched(*arguments: object) -> None:
        try:
            follow(*arguments)
        except Exception as error:
            failures.append(error)

    before = list(bpy.app.handlers.depsgraph_update_post)
    bpy.app.handlers.depsgraph_update_post[:] = [watched]
    try:
        move(), edit(), set_falloff()
    finally:
        bpy.app.handlers.depsgraph_update_post[:] = before
    assert failures == []
