"""New nodes beside a user's own: what twins of trees and of surfaces are drawn with."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack

import bpy

from ...core.expression import Formula
from .. import compat, marks
from ..read.nodes import Scope, source
from . import groups
from .animation import repeat_animation

VALUES = "values"  # note on a twin's node: which of its inputs repeat which of the original's
OF = "of"  # note on a twin's node: the name of the original
ROW = 320.0  # between what is drawn below each other, such as the probes of one surface
_DROP = -700.0  # how far below the original its twin is drawn


class Sketch:
    """Draws nodes of ours into one tree, each beside one of the user's; `join` links them once they are there.

    They have labels and no names: Blender looks through all animations of a file for the old name of a renamed node.

    Attributes:
        tree: the node tree.
        scope: which group nodes lead to it.
    """

    def __init__(self, tree: bpy.types.ShaderNodeTree, scope: Scope) -> None:
        self.tree, self.scope = tree, scope
        self._frame: bpy.types.Node | None = None
        self._geometry: bpy.types.Node | None = None
        self._links: list[tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]] = []

    def new(self, kind: str, beside: bpy.types.Node, right: float = 0.0, row: float = 0.0) -> bpy.types.Node:
        """A node of ours, drawn below `beside`, so far to its right and so many rows down; `spread` makes room."""
        node = self.tree.nodes.new(kind)
        node.select = False
        marks.tag(node, "twin")
        place = beside.location_absolute
        node.location = (place.x + right, place.y + _DROP - ROW * row)
        node.parent = self._framed()
        return node

    def link(self, feeding: bpy.types.NodeSocket, socket: bpy.types.NodeSocket) -> None:
        """Let an output feed an input of ours from `join` on."""
        self._links.append((feeding, socket))

    def join(self) -> None:
        """Make the links; before what was drawn feeds an output, or each would be a change of the material."""
        with ExitStack() as stack:
            compat.use_all_inputs(stack, self.tree)
            for feeding, socket in self._links:
                self.tree.links.new(feeding, socket)
        self._links.clear()

    def call(
        self,
        formula: Formula,
        beside: bpy.types.Node,
        right: float,
        row: float = 0.0,
        given: Mapping[str, bpy.types.NodeSocket | float] | None = None,
    ) -> bpy.types.Node:
        """A node of a formula's group, some of its inputs given."""
        call = self.new("ShaderNodeGroup", beside, right, row)
        call.node_tree = groups.formula_group(formula)
        call.label = formula.title
        for name, value in (given or {}).items():
            self.give(call.inputs[name], value)
        return call

    def give(self, socket: bpy.types.NodeSocket, value: bpy.types.NodeSocket | float) -> None:
        """Feed an input by an output, or set its number."""
        if isinstance(value, float):
            socket.default_value = value
        else:
            self.link(value, socket)

    def repeat(self, old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
        """Let an input of ours read what an input of the original reads, or repeat its value."""
        feeding = source(old)
        if feeding is not None:
            self.link(feeding, new)
            return
        repeat_value(old, new)
        repeat_animation(old, new)
        marks.note(new.node, OF, old.node.name)
        marks.note(new.node, VALUES, {**dict(marks.noted(new.node, VALUES, {})), new.identifier: old.identifier})

    def repeat_all(self, node: bpy.types.Node, copy: bpy.types.Node, without: frozenset[str] = frozenset()) -> None:
        """`repeat` for all inputs of a copied node but shaders and those named."""
        for old, new in zip(node.inputs, copy.inputs, strict=True):
            known = hasattr(old, "default_value") or source(old) is not None
            if old.type != "SHADER" and old.name not in without and known:
                self.repeat(old, new)

    def copy(self, node: bpy.types.Node, row: float = 0.0) -> bpy.types.Node:
        """A node of the same type with the same settings, its inputs as they come."""
        copy = self.new(node.bl_idname, node, row=row)
        common = {p.identifier for p in bpy.types.Node.bl_rna.properties}
        for prop in node.bl_rna.properties:
            value = getattr(node, prop.identifier)
            chosen = prop.type != "ENUM" or value != ""  # "": a choice that only later Blenders know
            if prop.identifier not in common and not prop.is_readonly and chosen:
                setattr(copy, prop.identifier, value)
        return copy

    def geometry(self, output: str, beside: bpy.types.Node) -> bpy.types.NodeSocket:
        """An output of the tree's Geometry node of ours."""
        if self._geometry is None:
            self._geometry = self.new("ShaderNodeNewGeometry", beside, right=-1480.0)
        return self._geometry.outputs[output]

    def _framed(self) -> bpy.types.Node:
        """The frame around all that is ours in the tree."""
        if self._frame is None:
            self._frame = self.tree.nodes.new("NodeFrame")
            self._frame.select = False
            self._frame.label = "PCC Parallax Probes"
            marks.tag(self._frame, "frame")
        return self._frame


def placed(tree: bpy.types.ShaderNodeTree) -> list[bpy.types.Node]:
    """The nodes of ours in a tree, without their frames."""
    return [node for node in tree.nodes if marks.role(node) not in (None, "frame")]


def repeat_value(old: bpy.types.NodeSocket, new: bpy.types.NodeSocket) -> None:
    """Give an input the value of another, which may be of another width; nothing happens where it has it already."""
    value = old.default_value
    if hasattr(new.default_value, "__len__"):
        wide = len(new.default_value)
        value = tuple(value)[:wide] if hasattr(value, "__len__") else (value,) * wide
        if tuple(new.default_value) != value:
            new.default_value = value
    elif new.default_value != value:
        new.default_value = value
