"""Blocks of ours that undo may free: where they lie, and that nothing points to them."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from pcc_addon.blender import unrecorded
from pcc_addon.blender.shade import groups
from pcc_addon.core.expression import Formula, scalar


def group() -> bpy.types.ShaderNodeTree:
    return bpy.data.node_groups.new("Same", "ShaderNodeTree")


def addresses(make: Callable[[], bpy.types.ShaderNodeTree], count: int) -> set[int]:
    found = set()
    for _ in range(count):
        tree = make()
        assert tree.name == "Same"
        found.add(tree.as_pointer())
        bpy.data.node_groups.remove(tree)
    return found


def test_no_block_lies_where_another_one_did(scene: bpy.types.Scene) -> None:
    """Undo tells by addresses whether what points to a block has changed."""
    assert len(addresses(group, 2000)) < 2000, "otherwise this tries nothing"  # Blender may have much free memory
    assert len(addresses(lambda: unrecorded.new(group), 50)) == 50
    assert not bpy.data.node_groups


def test_groups_without_users_become_others(scene: bpy.types.Scene) -> None:
    """They are not removed, as an undo step may know them; yet dragging a slider leaves few behind."""
    user = bpy.data.node_groups.new("User", "ShaderNodeTree").nodes.new("ShaderNodeGroup")
    for k in range(3 * groups.SPARE):
        user.node_tree = groups.formula_group(Formula(f"{k}", {f"Sum {k}": scalar("S") + float(k)}))
        assert user.node_tree.name == f"PCC {k}" and [s.name for s in user.outputs] == [f"Sum {k}"]
    ours = [tree.name for tree in bpy.data.node_groups if tree.name != "User"]
    assert set(ours) == {f"PCC {k}" for k in range(2 * groups.SPARE - 2, 3 * groups.SPARE)}


def test_what_is_let_go_stays_without_users(scene: bpy.types.Scene) -> None:
    """An undo step may know it after all: Blender cannot tell which it has."""
    with unrecorded.following():
        tree, picture = unrecorded.new(group), unrecorded.new(lambda: bpy.data.images.new("Picture", 1, 1))
    outer = bpy.data.node_groups.new("User", "ShaderNodeTree")
    node, texture = outer.nodes.new("ShaderNodeGroup"), outer.nodes.new("ShaderNodeTexImage")
    node.node_tree, texture.image = tree, picture
    unrecorded.let_go(lambda material: material)
    assert node.node_tree is None and texture.image is None
    assert tree.users == picture.users == 0
    assert {*bpy.data.node_groups} == {tree, outer} and [*bpy.data.images] == [picture]
