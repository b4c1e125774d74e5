"""How data blocks and nodes of ours are told from the user's: the only module that knows the custom properties."""

from __future__ import annotations

import bpy

_TAG = "pcc"


def tag(item: bpy.types.ID | bpy.types.Node, role: str) -> None:
    """Mark a group or node as made by the add-on."""
    item[_TAG] = role


def role(item: bpy.types.ID | bpy.types.Node) -> str | None:
    """The role that `tag` gave, or None for the user's own."""
    return item.get(_TAG)
