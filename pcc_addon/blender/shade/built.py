"""Groups that still are what was built: they need not be built again, and others of their kind are copies of them.

Building a probe's group takes some hundred calls, each slower the more trees a file has; a copy takes a few.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection

import bpy

from .. import marks
from . import playback

_RECIPE, _RESULT = "recipe", "result"  # notes on a group: what it was built from, and what came of that
_SETTINGS = ("operation", "interpolation", "projection")


def note_built(tree: bpy.types.ShaderNodeTree, recipe: str, changing: Collection[str]) -> None:
    """Remember how a group was built.

    Args:
        tree: the group.
        recipe: all that its nodes and links depend on.
        changing: names of nodes and inputs whose values are no part of that.
    """
    marks.note(tree, _RECIPE, recipe)
    marks.note(tree, _RESULT, _result(tree, changing))


def is_whole(tree: bpy.types.ShaderNodeTree) -> bool:
    """Whether no group that it calls and no picture that it shows was deleted."""
    shown = {"ShaderNodeGroup": "node_tree", "ShaderNodeTexEnvironment": "image"}
    return all(getattr(node, shown[node.bl_idname]) for node in tree.nodes if node.bl_idname in shown)


def is_built(tree: bpy.types.ShaderNodeTree, recipe: str, changing: Collection[str]) -> bool:
    """Whether a group was built by this recipe and nobody has changed it; pictures and places of nodes do not count."""
    return marks.noted(tree, _RECIPE) == recipe and marks.noted(tree, _RESULT) == _result(tree, changing)


def built_alike(role: str, recipe: str, changing: Collection[str]) -> bpy.types.ShaderNodeTree | None:
    """A group of this file that `is_built` by a recipe."""
    alike = (t for t in bpy.data.node_groups if marks.noted(t, _RECIPE) == recipe and marks.role(t) == role)
    return next((tree for tree in alike if not tree.library and is_built(tree, recipe, changing)), None)


def _result(tree: bpy.types.ShaderNodeTree, changing: Collection[str]) -> str:
    drivers = [
        curve for curve in (tree.animation_data.drivers if tree.animation_data else ()) if not playback.is_ours(curve)
    ]
    lines = [repr([(curve.data_path, curve.array_index, curve.driver.expression) for curve in drivers])]
    lines += [repr((item.in_out, item.name, item.bl_socket_idname)) for item in tree.interface.items_tree]
    for node in tree.nodes:
        inner = getattr(node, "node_tree", None)
        settings = [getattr(node, name, None) for name in _SETTINGS]
        sockets = () if node.name in changing else node.inputs
        values = [_value(socket) for socket in sockets if socket.name not in changing]
        lines.append(repr((node.bl_idname, node.name, node.mute, inner and inner.name_full, settings, values)))
    for link in tree.links:
        ends = (link.from_node.name, link.from_socket.identifier, link.to_node.name, link.to_socket.identifier)
        lines.append(repr((ends, link.is_muted)))
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _value(socket: bpy.types.NodeSocket) -> object:
    value = getattr(socket, "default_value", None)
    return tuple(value) if hasattr(value, "__len__") else value
