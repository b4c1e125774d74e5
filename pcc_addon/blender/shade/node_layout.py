"""Where nodes of ours stand: left to right by what they need, none over another, sections of groups in framed lanes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain

import bpy

_COLUMN_GAP, _GAP, _LANE = 60.0, 30.0, 90.0
_HEIGHTS = {
    "ShaderNodeMath": 150.0,
    "ShaderNodeVectorMath": 150.0,
    "ShaderNodeTexEnvironment": 240.0,
}
_HEAD, _SOCKET = 50.0, 22.0


class NodeLayout:
    """Collects the nodes of a group as they are made, then puts each in its place."""

    def __init__(self, tree: bpy.types.ShaderNodeTree) -> None:
        self._tree = tree
        self._lanes: dict[str, dict[int, list[bpy.types.Node]]] = {"": {}}

    def add(self, node: bpy.types.Node, depth: int, section: str) -> int:
        """Note a node that needs outputs of this depth; returns the depth of its own."""
        self._lanes.setdefault(section, {}).setdefault(depth, []).append(node)
        return depth + 1

    def arrange(self) -> None:
        """Give every node its place, and every section its frame; what is not noted here stands before all others."""
        starts = self._columns()
        noted = {node for columns in self._lanes.values() for nodes in columns.values() for node in nodes}
        before = [node for node in self._tree.nodes if node not in noted and node.bl_idname != "NodeFrame"]
        spread(self._tree, before)
        end = max((node.location.x + node.width for node in before), default=0.0)
        for node in before:
            node.location.x += min(starts.values()) - _COLUMN_GAP - end
        top = 0.0
        places: dict[bpy.types.Node, tuple[float, float]] = {}
        frames = {section: self._frame(section) for section in self._lanes if section}
        for columns in self._lanes.values():
            lowest = top
            for depth, nodes in columns.items():
                y = top
                for node in nodes:
                    places[node] = (starts[depth], y)
                    y -= height(node) + _GAP
                lowest = min(lowest, y)
            top = lowest - _LANE
        _place(self._tree, places)
        for section, frame in frames.items():
            for node in chain.from_iterable(self._lanes[section].values()):
                node.parent = frame

    def _columns(self) -> dict[int, float]:
        """Where each column begins: wide enough for its widest node."""
        widths: dict[int, float] = {}
        for lane in self._lanes.values():
            for depth, nodes in lane.items():
                widths[depth] = max([widths.get(depth, 0.0), *(node.width for node in nodes)])
        x = -(widths.get(-1, 0.0) + _COLUMN_GAP)
        starts = {}
        for depth in sorted(widths):
            starts[depth] = x
            x += widths[depth] + _COLUMN_GAP
        return starts

    def _frame(self, section: str) -> bpy.types.Node:
        frame = self._tree.nodes.new("NodeFrame")
        frame.name = frame.label = section
        return frame


def _place(tree: bpy.types.ShaderNodeTree, places: Mapping[bpy.types.Node, tuple[float, float]]) -> None:
    """Move nodes at once: each place that is set by itself has Blender look through the whole tree."""
    located = [places.get(node) or node.location for node in tree.nodes]
    tree.nodes.foreach_set("location", list(chain.from_iterable(located)))


def spread(tree: bpy.types.ShaderNodeTree, nodes: Sequence[bpy.types.Node]) -> None:
    """Move nodes of a tree as far right and down as it takes to have each right of what feeds it and none over another.

    What stands higher stays; of two at one height, the one that comes first.
    """
    feeding: dict[bpy.types.Node, list[bpy.types.Node]] = {node: [] for node in nodes}
    for link in tree.links:
        if link.to_node in feeding and link.from_node in feeding:
            feeding[link.to_node].append(link.from_node)
    lefts: dict[bpy.types.Node, float] = {}

    def left(node: bpy.types.Node) -> float:
        if node not in lefts:
            lefts[node] = max([node.location.x, *(left(n) + n.width + _COLUMN_GAP for n in feeding[node])])
        return lefts[node]

    places: dict[bpy.types.Node, tuple[float, float]] = {}
    taken: list[tuple[float, float, float, float]] = []  # top, bottom, left, right, with the gaps beside them
    for node in sorted(nodes, key=lambda node: -node.location.y):
        start, end, top, high = left(node), left(node) + node.width + _GAP, node.location.y, height(node) + _GAP
        for upper, lower, first, last in sorted(taken, reverse=True):
            if first < end and start < last and lower < top and top - high < upper:
                top = lower
        taken.append((top, top - high, start, end))
        places[node] = (start, top)
    _place(tree, places)


def height(node: bpy.types.Node) -> float:
    """About how high a node is drawn; Blender knows only once a window shows it."""
    sockets = sum(s.enabled for s in (*node.inputs, *node.outputs))
    return _HEIGHTS.get(node.bl_idname, _HEAD + _SOCKET * sockets)
