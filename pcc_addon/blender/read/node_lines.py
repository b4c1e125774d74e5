"""Lines that say how a shader is made, names included: other lines mean that its twins or copies must follow."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

from .. import marks

_ID_BOOKKEEPING = {p.identifier for p in bpy.types.ID.bl_rna.properties}
_NODE_BOOKKEEPING = {p.identifier for p in bpy.types.Node.bl_rna.properties} - {"mute"}
_DRAWN = {"color_ramp", "mapping"}  # values of a node that are no inputs
_MATERIAL_BOOKKEEPING = _ID_BOOKKEEPING | {
    "cycles",
    "grease_pencil",
    "lineart",
    "paint_active_slot",
    "paint_clone_slot",
}


def material_lines(material: bpy.types.Material) -> list[str]:
    """Lines that change when a material changes, its name apart; what is ours in it is left out."""
    cycles = _properties(material.cycles, {"name", "emission_sampling"})
    return [*_properties(material, _MATERIAL_BOOKKEEPING), *cycles, *node_lines(material.node_tree)]


def node_lines(tree: bpy.types.NodeTree | None, seen: set[str] | None = None, *, values: bool = True) -> list[str]:
    """Lines that change when a shader changes; our own nodes and the choice of the output are left out.

    Args:
        tree: the shader's nodes; None gives no line.
        seen: names of trees that have had their lines.
        values: whether the values, ramps and curves of the tree's own nodes count; those within groups always do.
    """
    seen = set() if seen is None else seen
    if tree is None or tree.name_full in seen:
        return []
    seen.add(tree.name_full)
    lines = []
    for node in tree.nodes:
        if marks.role(node):
            continue
        lines.append(f"node {node.name} {node.bl_idname}")
        skipped = _NODE_BOOKKEEPING | {"is_active_output", "target"} | (set() if values else _DRAWN)
        lines += _properties(node, skipped)
        for socket in node.inputs if values else ():
            value = getattr(socket, "default_value", None)
            lines.append(f"  {socket.identifier} {_plain(value)}")
        inner = getattr(node, "node_tree", None)
        if inner is None or marks.role(inner) != marks.BY_HAND:  # captures see that black, whatever is in it
            lines += node_lines(inner, seen)
    lines += [
        f"link {link.from_node.name}.{link.from_socket.identifier} {link.to_node.name}.{link.to_socket.identifier}"
        f"{' muted' * link.is_muted}"
        for link in tree.links
        if not marks.role(link.from_node) and not marks.role(link.to_node)
    ]
    return lines


def _properties(struct: Any, without: Iterable[str]) -> list[str]:
    skipped = set(without) | {"rna_type"}
    return [
        f"  {p.identifier} {_plain(getattr(struct, p.identifier))}"
        for p in struct.bl_rna.properties
        if p.identifier not in skipped and p.type != "COLLECTION"
    ]


def _contents(struct: Any) -> list[str]:
    """The properties of a colour ramp or of curves, and those of their points."""
    lines = _properties(struct, {"select"})
    for p in struct.bl_rna.properties:
        if p.type == "COLLECTION":
            lines += [line for part in getattr(struct, p.identifier) for line in _contents(part)]
    return lines


def _plain(value: Any) -> str:
    if isinstance(value, bpy.types.ID):
        return value.name_full
    if isinstance(value, (bpy.types.ColorRamp, bpy.types.CurveMapping)):
        return repr(_contents(value))
    if isinstance(value, bpy.types.bpy_struct):
        return type(value).__name__
    if hasattr(value, "__len__") and not isinstance(value, (str, set)):
        return repr([round(v, 7) if isinstance(v, float) else str(v) for v in value])
    if isinstance(value, set):
        return repr(sorted(value))
    return repr(value)
