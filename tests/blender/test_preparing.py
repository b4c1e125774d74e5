"""What materials will call is ready before they show a plan, and whatever happens meanwhile leaves it whole."""

from __future__ import annotations

import time
from collections.abc import Iterator

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.shade import groups, node_builder
from pcc_addon.blender.shade.preparing import Preparation
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.surface import SurfaceEffects, surface_formula
from pcc_addon.core.expression import Formula
from sample_blends.scenes import add_wall, principled
from tests.blender.helpers import ROOM, pretend_bake, put_in, small_probe

FLOOR: Formula = surface_formula(SurfaceEffects((Dielectric.of(1.5, 0.5),)))
LARGE = 25  # nodes; a smaller group takes a few milliseconds


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of large groups of formulas that are built at once."""
    found: list[str] = []
    emit = node_builder.emit

    def emitting(tree: bpy.types.ShaderNodeTree, *rest: object) -> None:
        emit(tree, *rest)
        if len(tree.nodes) >= LARGE:
            found.append(tree.name)

    monkeypatch.setattr(node_builder, "emit", emitting)
    return found


def room() -> None:
    """A probe among surfaces of all kinds, not baked yet."""
    noise = principled("Worn", Roughness=0.2)
    texture = noise.node_tree.nodes.new("ShaderNodeTexNoise")
    noise.node_tree.links.new(texture.outputs[0], noise.node_tree.nodes["Principled BSDF"].inputs["Roughness"])
    kinds = (
        principled("Floor", Roughness=0.2),
        principled("Metal", Roughness=0.3, Metallic=1.0, Anisotropic=0.7),
        principled("Glass", Roughness=0.1, Transmission_Weight=1.0),
        principled("Film", Roughness=0.2, Thin_Film_Thickness=400.0),
        noise,
    )
    for side, material in zip(("-Z", "+X", "-X", "+Y", "-Y"), kinds, strict=True):
        add_wall(ROOM, side, material)
    small_probe()


def prepare() -> Preparation:
    return Preparation(plan_scene(bpy.context.scene, bpy.context.view_layer))


def finish(work: Preparation) -> None:
    end = time.monotonic() + 60.0
    while work.step():
        assert time.monotonic() < end
        time.sleep(0.001)


def some_of(work: Iterator[None], count: int = 20) -> Iterator[None]:
    for _ in range(count):
        next(work)
    return work


def content(tree: bpy.types.ShaderNodeTree) -> list[tuple[str, ...]]:
    nodes = sorted((node.bl_idname, *map(str, node.location)) for node in tree.nodes)
    links = sorted((link.from_socket.path_from_id(), link.to_socket.path_from_id()) for link in tree.links)
    return [*nodes, *links]


def of_floor() -> list[bpy.types.ShaderNodeTree]:
    return [tree for tree in bpy.data.node_groups if tree.name.startswith(f"PCC {FLOOR.title}")]


@pytest.mark.parametrize("prepared", [True, False])
def test_no_large_group_is_built_where_what_will_be_shown_was_prepared(scene, built, prepared: bool) -> None:
    room()
    if prepared:
        finish(prepare())
    pretend_bake(bpy.data.objects["Probe"])
    assert len(put_in().materials) == 5
    own = {"PCC Probe Probe"}
    assert not {*built} - own if prepared else len(built) > 5


def test_what_is_prepared_is_what_is_built_at_once(scene) -> None:
    grown, nodes = [], 0
    for _ in groups.preparing(FLOOR):
        count = sum(len(tree.nodes) for tree in bpy.data.node_groups)
        grown.append(count - nodes)
        nodes = count
    assert len(grown) > 50 and max(grown) <= 3, "a step adds a node, and one that it reads"
    prepared = content(groups.formula_group(FLOOR))
    bpy.data.batch_remove(bpy.data.node_groups)
    assert content(groups.formula_group(FLOOR)) == prepared
    assert list(groups.preparing(FLOOR)) == []


def test_what_is_not_whole_is_nobodys(scene) -> None:
    work = some_of(groups.preparing(FLOOR))
    assert not of_floor()
    tree = groups.formula_group(FLOOR)
    assert list(work) and of_floor() == [tree]
    assert len([t for t in bpy.data.node_groups if marks.role(t) == marks.role(tree)]) == 1


def test_what_is_removed_meanwhile_ends_it(scene) -> None:
    work = some_of(groups.preparing(FLOOR))
    groups.drop_unused_groups()
    with pytest.raises(ReferenceError):
        next(work)
    finish(prepare())


def test_after_an_undo_it_begins_anew(scene) -> None:
    bpy.ops.ed.undo_push(message="opened")
    room()
    bpy.ops.ed.undo_push(message="room")
    work = prepare()
    while not bpy.data.node_groups:
        assert work.step()
        time.sleep(0.001)
    bpy.context.scene.frame_current = 7
    bpy.ops.ed.undo_push(message="edit")
    work.start_over()
    bpy.ops.ed.undo()
    finish(work)
    bpy.ops.ed.undo()
    bpy.ops.ed.redo()
    pretend_bake(bpy.data.objects["Probe"])
    assert len(put_in().materials) == 5
    bpy.ops.ed.undo_push(message="shown")
    bpy.ops.ed.undo()
    bpy.ops.ed.redo()
    whole = [tree for tree in bpy.data.node_groups if tree.users]
    assert whole and all(node.node_tree for t in whole for node in t.nodes if node.bl_idname == "ShaderNodeGroup")
