"""Where the nodes of a group stand: left to right by what they need, each section in a framed lane of its own."""

from __future__ import annotations

import bpy

_COLUMN_GAP, _GAP, _LANE = 60.0, 30.0, 90.0
_HEIGHTS = {
    "ShaderNodeMath": 150.0,
    "ShaderNodeVectorMath": 150.0,
    "ShaderNodeSeparateXYZ": 130.0,
    "ShaderNodeCombineXYZ": 130.0,
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
        """Give every node its place, and every section its frame."""
        starts = self._columns()
        top = 0.0
        for section, columns in self._lanes.items():
            lowest = top
            frame = self._frame(section) if section else None
            for depth, nodes in columns.items():
                y = top
                for node in nodes:
                    node.location = (starts[depth], y)
                    node.parent = frame
                    y -= height(node) + _GAP
                lowest = min(lowest, y)
            top = lowest - _LANE

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


def height(node: bpy.types.Node) -> float:
    """About how high a node is drawn; Blender knows only once a window shows it."""
    sockets = sum(s.enabled for s in (*node.inputs, *node.outputs))
    return _HEIGHTS.get(node.bl_idname, _HEAD + _SOCKET * sockets)
