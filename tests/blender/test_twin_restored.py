"""Injecting into materials of many kinds, and taking it back: nothing of the user's changes."""

from __future__ import annotations

from contextlib import ExitStack

import bpy
import pytest

from pcc_addon.blender import compat, marks
from pcc_addon.blender.shade.injection import remove
from sample_blends.scenes import principled_node
from tests.blender.helpers import put_in, shown_group
from tests.blender.materials import new, output_of, shiny, show, textured
from tests.blender.receivers import RECEIVERS, nested
from tests.blender.snapshots import material_lines, of_the_user, settled
from tests.rna_dump import difference


@pytest.mark.parametrize("build", RECEIVERS, ids=lambda f: f.__name__)
def test_removing_brings_back_exactly_what_was_there(probe, build) -> None:
    material = build()
    show(material)
    before = settled()
    assert put_in().materials == ((material.name, probe.name),)
    assert shown_group(material) == probe.pcc_probe.group
    assert remove() == [material.name]
    assert difference(before, of_the_user()) == []
    assert remove() == [], "removing twice finds nothing"
    assert difference(before, of_the_user()) == []


@pytest.mark.skipif(bpy.app.version < (5, 2), reason="before 5.2 links ask no other tree")
def test_links_come_and_nodes_go_while_no_input_is_unused(probe, monkeypatch) -> None:
    """Else Blender asks all trees of the file at each of them."""
    material, while_it_changes = shiny(), []
    show(material)
    node = principled_node(material)
    use = compat.use_all_inputs

    def unused() -> list[str]:
        return [socket.name for socket in node.inputs if socket.is_unavailable and socket.name != "Weight"]

    def noted(stack: ExitStack, tree: bpy.types.NodeTree) -> None:
        use(stack, tree)
        while_it_changes.append(unused())

    monkeypatch.setattr(compat, "use_all_inputs", noted)
    assert unused() == ["Subsurface IOR"]
    put_in()
    assert while_it_changes == [[]] and unused() == ["Subsurface IOR"]
    remove()
    assert while_it_changes == [[], []] and unused() == ["Subsurface IOR"]


@pytest.mark.parametrize("method", ["BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN"])
def test_a_twin_scatters_light_as_its_original(probe, method) -> None:
    material = shiny()
    show(material)
    principled_node(material).subsurface_method = method
    put_in()
    kinds = [n.subsurface_method for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled"]
    assert kinds == [method] * 2


def test_the_comparison_sees_an_injection_and_a_lost_link(probe) -> None:
    material = textured()
    show(material)
    before = settled()
    put_in()
    assert any(line.startswith("materials[") for line in difference(before, of_the_user()))
    remove()
    material.node_tree.links.remove(principled_node(material).inputs["Metallic"].links[0])
    assert difference(before, of_the_user()) != []


@pytest.mark.parametrize("build", RECEIVERS, ids=lambda f: f.__name__)
def test_injecting_twice_is_injecting_once(probe, build) -> None:
    material = build()
    show(material)
    put_in()
    put_in()
    once = material_lines(material)
    put_in()
    assert difference(once, material_lines(material)) == []


@pytest.mark.parametrize("build", RECEIVERS, ids=lambda f: f.__name__)
def test_the_users_nodes_and_links_stay_while_a_probe_is_shown(probe, build) -> None:
    def own(tree: bpy.types.NodeTree) -> tuple[list[str], list[tuple[str, ...]]]:
        nodes = [node.name for node in tree.nodes if not marks.role(node)]
        ends = [
            (e.from_node.name, e.from_socket.identifier, e.to_node.name, e.to_socket.identifier) for e in tree.links
        ]
        return nodes, [end for end in ends if {end[0], end[2]} <= set(nodes)]

    material = build()
    show(material)
    before = own(material.node_tree)
    put_in()
    assert own(material.node_tree) == before
    for engine in ("CYCLES", "EEVEE"):
        assert marks.role(material.node_tree.get_output_node(engine)), f"{engine} shows no probe"


def test_a_material_that_left_the_room_is_restored_by_the_next_injection(probe) -> None:
    material = shiny()
    item = show(material)
    before = settled()
    put_in()
    item.location.x += 50.0
    put_in()
    item.location.x -= 50.0
    assert shown_group(material) is None
    remove()
    assert [line for line in difference(before, of_the_user()) if line.startswith("materials[")] == []


def test_removing_keeps_what_the_user_changed_meanwhile(probe) -> None:
    material = shiny()
    show(material)
    put_in()
    principled_node(material).inputs["Roughness"].default_value = 0.5
    mine = new(material, "ShaderNodeValue")
    mine.name = "Mine"
    remove()
    assert principled_node(material).inputs["Roughness"].default_value == 0.5
    assert "Mine" in material.node_tree.nodes


def test_removing_copes_with_an_output_that_the_user_deleted(probe) -> None:
    material = shiny()
    show(material)
    put_in()
    material.node_tree.nodes.remove(output_of(material))
    remove()
    assert not [n for n in material.node_tree.nodes if marks.role(n)]


def test_a_copy_of_an_injected_material_is_restored_too(probe) -> None:
    material = nested()
    show(material)
    before = {n.name for n in material.node_tree.nodes}
    put_in()
    copy = material.copy()
    show(copy, "Copy")
    put_in()
    assert shown_group(material) and shown_group(copy)
    remove()
    for restored in (material, copy):
        assert {n.name for n in restored.node_tree.nodes} == before
        assert restored.node_tree.get_output_node("CYCLES") is not None
    assert [t.name for t in bpy.data.node_groups if marks.role(t) == "copy"] == []
