"""Following shader nodes: what feeds an input, through reroutes and out of groups, whatever a user has linked."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ...core.readings import Value
from .. import compat, marks


@dataclass(frozen=True)
class Scope:
    """A node tree as one material uses it: with the chain of group nodes that led there, innermost last."""

    tree: bpy.types.ShaderNodeTree
    nodes: tuple[bpy.types.ShaderNodeGroup, ...] = ()

    def inside(self, node: bpy.types.ShaderNodeGroup) -> Scope:
        return Scope(node.node_tree, (*self.nodes, node))

    def outside(self) -> Scope:
        """The scope of the group node that this one is the inside of."""
        return Scope(self.nodes[-1].id_data, self.nodes[:-1])

    def path(self, node: bpy.types.Node) -> tuple[str, ...]:
        """Names of the group nodes that lead to a node, then its own."""
        return (*(group.name for group in self.nodes), node.name)


def source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The output socket that feeds an input, through reroutes, or None where nothing does."""
    if not socket.is_linked:  # as most are
        return None
    passed = set()
    while socket.is_linked and not socket.links[0].is_muted:
        feeding = socket.links[0].from_socket
        if feeding.node.bl_idname != "NodeReroute":
            return feeding
        if feeding.node.name in passed:  # a reroute that feeds itself
            return None
        passed.add(feeding.node.name)
        socket = feeding.node.inputs[0]
    return None


def outer_socket(feeding: bpy.types.NodeSocket, scope: Scope) -> bpy.types.NodeSocket | None:
    """The input of the group node that an output of a group's input node stands for, or None where it is none."""
    if feeding.node.bl_idname != "NodeGroupInput" or not scope.nodes:
        return None
    return scope.nodes[-1].inputs[list(feeding.node.outputs).index(feeding)]


def is_given(socket: bpy.types.NodeSocket, scope: Scope) -> bool:
    """Whether something is linked to an input; one that a group exposes and nothing is linked to counts as free."""
    feeding = source(socket)
    if feeding is None:
        return False
    outer = outer_socket(feeding, scope)
    return outer is None or is_given(outer, scope.outside())


def constant(socket: bpy.types.NodeSocket, scope: Scope) -> Value:
    """The value of an input that is the same all over the surface and at all times, or None where it varies."""
    feeding = source(socket)
    if feeding is None:
        return None if _is_animated(socket) else _plain(getattr(socket, "default_value", None))
    if feeding.node.bl_idname == "ShaderNodeValue":
        return None if _is_animated(feeding) else float(feeding.default_value)
    outer = outer_socket(feeding, scope)
    return None if outer is None else constant(outer, scope.outside())


def outputs(material: bpy.types.Material) -> list[bpy.types.ShaderNodeOutputMaterial]:
    """The user's output nodes that engines read, without our own: one for both, or Cycles' and then EEVEE's."""
    own = own_outputs(material.node_tree)
    before = marks.noted_before(material)
    twinned = {output.name for output in before.outputs if output.active} if before else set()
    chosen = []
    for engine in ("CYCLES", "EEVEE"):
        # As Blender chooses: one for this engine before one for all, then the active one, then the first.
        candidates = [n for n in own if n.target in {engine, "ALL"}]
        ranks = [(n.target == engine, n.is_active_output or n.name in twinned) for n in candidates]
        if candidates and candidates[ranks.index(max(ranks))] not in chosen:
            chosen.append(candidates[ranks.index(max(ranks))])
    return chosen


def output_of(material: bpy.types.Material, engine: str) -> bpy.types.ShaderNodeOutputMaterial | None:
    """The user's output node that one engine reads, as it was before twins stood in for it; None where there is none.

    Args:
        material: whose.
        engine: "CYCLES" or "EEVEE".
    """
    own = own_outputs(material.node_tree)
    targets = {n.name: (n.target, n.is_active_output) for n in own}
    before = marks.noted_before(material)
    for original in before.outputs if before else ():
        name = original.name
        if name not in targets and original.index < len(own):  # renamed since
            name = own[original.index].name
        targets[name] = original.target, original.active
    candidates = [n for n in own if targets[n.name][0] in {engine, "ALL"}]
    return max(candidates, key=lambda n: (targets[n.name][0] == engine, targets[n.name][1]), default=None)


def own_outputs(tree: bpy.types.ShaderNodeTree) -> list[bpy.types.ShaderNodeOutputMaterial]:
    """The user's output nodes, whether engines read them or not."""
    return [n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial" and not marks.role(n)]


def group_output(tree: bpy.types.ShaderNodeTree) -> bpy.types.Node | None:
    """The output node of a group that is in force."""
    candidates = [n for n in tree.nodes if n.bl_idname == "NodeGroupOutput"]
    return next((n for n in candidates if n.is_active_output), candidates[0] if candidates else None)


def _plain(value: object) -> Value:
    if isinstance(value, float):  # as most are
        return value
    if value is None or isinstance(value, str):
        return None
    return tuple(float(v) for v in value) if hasattr(value, "__len__") else float(value)


def _is_animated(socket: bpy.types.NodeSocket) -> bool:
    paths = compat.animated_paths(socket.id_data)
    return bool(paths) and socket.path_from_id("default_value") in paths
