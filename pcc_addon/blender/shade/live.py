"""Keeps twins like their originals while an artist edits: values at once, everything else by building anew."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import bpy

from .. import marks
from ..read.fingerprint import node_lines
from .twin import add_twins, has_twins, remove_twins, shown_probe_groups
from .twin_builder import OF, VALUES, repeat_value
from .twin_order import TwinOrder

_SIGNATURE = "signature"  # note on a material: what its twins were built from


def show(material: bpy.types.Material, order: TwinOrder) -> None:
    """Let a material show what is ordered; twins that show it already only get the values of today."""
    signature = _signature(material, order)
    if marks.noted(material, _SIGNATURE) == signature and has_twins(material):
        copy_values(material.node_tree)
        return
    remove(material)
    add_twins(material, order)
    marks.note(material, _SIGNATURE, signature)


def remove(material: bpy.types.Material) -> bool:
    """Take everything of ours out of a material; True where there was something."""
    removed = remove_twins(material)
    marks.forget(material, _SIGNATURE)
    return removed


def copy_values(tree: bpy.types.ShaderNodeTree) -> None:
    """Let the inputs of twins repeat what the inputs of their originals say now."""
    for node in tree.nodes:
        values = marks.noted(node, VALUES)
        original = tree.nodes.get(marks.noted(node, OF)) if values else None
        if original is None:
            continue
        theirs = {socket.identifier: socket for socket in original.inputs}
        for socket in node.inputs:
            known = values.get(socket.identifier)
            if known in theirs and not socket.is_linked:
                repeat_value(theirs[known], socket)


def showing(groups: Iterable[bpy.types.ShaderNodeTree]) -> list[bpy.types.Material]:
    """The materials that show one of some probe groups."""
    wanted = set(groups)
    return [m for m in bpy.data.materials if not m.library and wanted.intersection(shown_probe_groups(m))]


def _signature(material: bpy.types.Material, order: TwinOrder) -> str:
    """A text that changes when the twins of a material must be built anew; values alone do not change it."""
    lines = node_lines(material.node_tree, values=False)
    lines += [f"{shown.group.name_full} {shown.rungs} {shown.fade}" for shown in order.probes]
    lines += [f"{path} {order.surfaces[path]}" for path in sorted(order.surfaces)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()
