"""Where nodes stand, as somebody sees it who opens the tree."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from pcc_addon.blender.shade.node_layout import height

GAP = 25.0  # at least, between what stands beside or below each other


def inner_links(nodes: Sequence[bpy.types.Node]) -> list[tuple[bpy.types.Node, bpy.types.Node]]:
    """The links from one of some nodes of a tree to another."""
    tree = nodes[0].id_data
    return [(each.from_node, each.to_node) for each in tree.links if {each.from_node, each.to_node} <= set(nodes)]


def check_places(nodes: Sequence[bpy.types.Node]) -> None:
    """Nodes of a tree stand right of what feeds them, and none over another."""
    place = {node: node.location_absolute.copy() for node in nodes}
    for source, sink in inner_links(nodes):
        assert place[source].x + source.width + GAP <= place[sink].x, (source.name, sink.name)
    for k, one in enumerate(nodes):
        for other in nodes[:k]:
            left, right = sorted((one, other), key=lambda node: place[node].x)
            upper, lower = sorted((one, other), key=lambda node: -place[node].y)
            beside = place[left].x + left.width + GAP <= place[right].x
            below = place[upper].y - height(upper) - GAP >= place[lower].y
            assert beside or below, (one.name, other.name)


def drawn(tree: bpy.types.ShaderNodeTree) -> list[bpy.types.Node]:
    """All nodes of a tree but frames."""
    return [node for node in tree.nodes if node.bl_idname != "NodeFrame"]
