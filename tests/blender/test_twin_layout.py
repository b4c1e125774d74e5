"""Where a twin's nodes stand, for whoever opens the tree: left to right, none over another, a probe a row."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import bpy
import pytest

from pcc_addon.blender import marks
from pcc_addon.blender.shade.node_layout import height, spread
from sample_blends.scenes import principled, principled_node
from tests.blender.helpers import pretend_bake, put_in, small_probe
from tests.blender.materials import Material, image_texture, link, normal_mapped, shiny, show
from tests.blender.places import check_places, inner_links
from tests.blender.receivers import coated, glossy, mixed, nested, outputs_of_each_engine

WIDEST_HOLE = 400.0  # between what is fed and the nearest of what feeds it: about two nodes


def glass() -> Material:
    return principled("Glass", Transmission_Weight=0.5, Roughness=0.3)


def rough_by_texture() -> Material:
    material = normal_mapped()
    link(material, image_texture(material).outputs["Alpha"], principled_node(material).inputs["Roughness"])
    return material


def placed(tree: bpy.types.ShaderNodeTree) -> list[bpy.types.Node]:
    return [node for node in tree.nodes if marks.role(node) not in (None, "frame")]


def widest_hole(nodes: Sequence[bpy.types.Node]) -> float:
    """How far what is fed stands behind the nearest of what feeds it, at most."""
    ends: dict[bpy.types.Node, float] = {}
    for source, sink in inner_links(nodes):
        ends[sink] = max(ends.get(sink, -math.inf), source.location.x + source.width)
    return max(sink.location.x - end for sink, end in ends.items())


@pytest.fixture
def several(probe: bpy.types.Object) -> tuple[bpy.types.Object, ...]:
    """Three probes of boxes inside each other."""
    inner = [small_probe(name, half_extents=size) for name, size in (("Alcove", (1, 1, 0.75)), ("Niche", (1, 1, 0.5)))]
    for each in inner:
        pretend_bake(each)
    return probe, *inner


MATERIALS = [shiny, glass, coated, glossy, rough_by_texture, mixed, nested, outputs_of_each_engine]


@pytest.mark.parametrize("build", MATERIALS)
def test_nodes_run_left_to_right_and_none_lies_over_another(several, build: Callable[[], Material]) -> None:
    material = build()
    show(material)
    assert put_in().materials
    trees = [material.node_tree, *(t for t in bpy.data.node_groups if marks.role(t) == "copy" and t.users)]
    found = [nodes for nodes in map(placed, trees) if nodes]
    assert sum(map(len, found)) > 10
    for nodes in found:
        check_places(nodes)


@pytest.mark.parametrize("build", [shiny, glass, rough_by_texture])
def test_what_one_probe_needs_is_one_row_without_holes(probe, build: Callable[[], Material]) -> None:
    material = build()
    principled_node(material).location = (120.0, -30.0)
    show(material)
    put_in()
    nodes = placed(material.node_tree)
    columns: dict[float, list[bpy.types.Node]] = {}
    for node in nodes:
        if marks.role(node) != "output":  # which is below the user's
            columns.setdefault(node.location.x, []).append(node)
    [top] = {max(node.location.y for node in column) for column in columns.values()}
    assert top < principled_node(material).location.y
    assert widest_hole(nodes) < WIDEST_HOLE


def test_probes_stand_below_each_other_in_the_order_of_their_rows(several) -> None:
    material = shiny()
    show(material)
    put_in()
    nodes = placed(material.node_tree)
    for row in (
        [n for n in nodes if marks.role(n) == "probe"],
        [n for n in nodes if n.label == "Reflectance"],
        [n for n in nodes if n.bl_idname == "ShaderNodeEmission"],
    ):
        assert len(row) == 3
        heights = [node.location.y for node in row]
        assert heights == sorted(heights, reverse=True) and len({node.location.x for node in row}) == 1
        assert len(set(heights)) == 3
    assert widest_hole(nodes) < WIDEST_HOLE


def test_nodes_that_have_room_stay_where_they_are() -> None:
    tree = bpy.data.node_groups.new("Roomy", "ShaderNodeTree")
    nodes = first, second, *_ = [tree.nodes.new("ShaderNodeMath") for _ in range(4)]
    tree.links.new(first.outputs[0], second.inputs[0])
    space = (first.width + 30.0, height(first) + 30.0)
    places = [(0.0, 0.0), (300.0, -20.0), (-space[0], 0.0), (0.0, -space[1])]
    for node, place in zip(nodes, places, strict=True):
        node.location = place
    for order in (nodes, nodes[::-1]):
        spread(tree, order)
        assert [tuple(node.location) for node in nodes] == places


def test_many_ways_through_a_tree_are_gone_once() -> None:
    """Otherwise this takes 2⁴⁰ steps."""
    tree = bpy.data.node_groups.new("Braid", "ShaderNodeTree")
    nodes = [tree.nodes.new("ShaderNodeMath") for _ in range(41)]
    for before, after in pairwise(nodes):
        for k in range(2):
            tree.links.new(before.outputs[0], after.inputs[k])
    spread(tree, nodes)
    check_places(nodes)


def test_a_node_that_chooses_a_picture_is_higher_than_its_sockets() -> None:
    tree = bpy.data.node_groups.new("Picture", "ShaderNodeTree")
    chooser, combine = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "CombineXYZ"))
    assert len(chooser.inputs) < len(combine.inputs) and height(chooser) > height(combine)


def test_of_two_at_one_place_the_first_stays_and_what_reads_moves_right() -> None:
    tree = bpy.data.node_groups.new("Crowded", "ShaderNodeTree")
    first, second, reader = (tree.nodes.new("ShaderNodeMath") for _ in range(3))
    tree.links.new(second.outputs[0], reader.inputs[1])
    spread(tree, [first, second, reader])
    assert tuple(first.location) == (0.0, 0.0)
    assert second.location.x == 0.0 and second.location.y <= -height(first)
    assert reader.location.x >= second.width and reader.location.y == 0.0
