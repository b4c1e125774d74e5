"""Builds the twin of one node tree, as it is ordered: what is no surface is copied, surfaces are lit by probes."""

from __future__ import annotations

import bpy

from .. import marks, unrecorded
from ..read.nodes import Scope, group_output, source
from . import groups
from .node_layout import spread
from .sketch import Sketch, placed
from .surface_builder import PROBE, SurfaceBuilder
from .twin_order import TwinOrder


class TwinBuilder:
    """Builds the twins of one node tree."""

    def __init__(self, tree: bpy.types.ShaderNodeTree, scope: Scope, order: TwinOrder, material: str) -> None:
        self.sketch, self.order, self.material = Sketch(tree, scope), order, material
        self._twins: dict[tuple[int, str], bpy.types.NodeSocket] = {}

    def keep_probes(self, beside: bpy.types.Node) -> None:
        """Remember the probes where no surface can show them at present."""
        for row, shown in enumerate(self.order.probes):
            probe = self.sketch.new("ShaderNodeGroup", beside, right=-240.0, row=row)
            probe.node_tree = shown.group
            marks.tag(probe, PROBE)

    def twin(self, socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
        """The output that does for a twin what the source of `socket` does for the original."""
        feeding = source(socket)
        if feeding is None or feeding.type != "SHADER":
            return feeding
        key = (feeding.node.as_pointer(), feeding.identifier)
        if key not in self._twins:
            self._twins[key] = self._twin_of(feeding)
        return self._twins[key]

    def _twin_of(self, feeding: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        node = feeding.node
        if node.mute:
            return feeding
        plan = self.order.surfaces.get(self.sketch.scope.path(node))
        if plan is not None:
            return SurfaceBuilder(self.sketch, node, plan, self.order.probes).build()
        is_group = node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None
        if not is_group and not any(s.type == "SHADER" for s in node.inputs):
            return feeding
        if is_group:
            copy = self.sketch.new(node.bl_idname, node)
            copy.node_tree = self._group(node)
        else:
            copy = self.sketch.copy(node)
        self.sketch.repeat_all(node, copy)
        for old, new in zip(node.inputs, copy.inputs, strict=True):
            shader = self.twin(old) if old.type == "SHADER" else None
            if shader is not None:
                self.sketch.link(shader, new)
        return copy.outputs[list(node.outputs).index(feeding)]

    def _group(self, node: bpy.types.ShaderNodeGroup) -> bpy.types.ShaderNodeTree:
        """A copy of a group's tree whose shaders are twins."""
        inside = self.sketch.scope.inside(node)
        groups.drop_oldest_copies()
        tree = unrecorded.new(node.node_tree.copy)
        tree.rename(f"PCC {node.node_tree.name}, {self.material}", mode="ALWAYS")  # one without users may have it
        marks.tag(tree, marks.TWIN_GROUP)
        sink = group_output(tree)
        if sink is None:
            return tree
        builder = TwinBuilder(tree, Scope(tree, inside.nodes), self.order, self.material)
        fed = [(builder.twin(socket), socket) for socket in sink.inputs if socket.type == "SHADER"]
        builder.sketch.join()
        for feeding, socket in fed:
            if feeding is not None:
                tree.links.new(feeding, socket)
        spread(tree, placed(tree))
        return tree
