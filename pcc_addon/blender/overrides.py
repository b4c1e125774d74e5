"""Settings changed for a while: each remembers what it was and comes back when the stack closes."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Any

import bpy


def override(stack: ExitStack, owner: Any, name: str, value: Any) -> None:
    """Set `owner.name` to `value` until `stack` closes; nothing happens where it already has that value."""
    before = getattr(owner, name)
    if before == value:
        return
    was_default = isinstance(owner, bpy.types.bpy_struct) and not owner.is_property_set(name)
    stack.callback(_restore, owner, name, before, was_default)
    setattr(owner, name, value)


def _restore(owner: Any, name: str, value: Any, was_default: bool) -> None:
    try:
        if was_default:
            owner.property_unset(name)
        else:
            setattr(owner, name, value)
    except ReferenceError:  # the owner was deleted meanwhile: there is nothing left to restore
        return


def temporary(stack: ExitStack, collection: bpy.types.bpy_prop_collection, item: bpy.types.ID) -> Any:
    """Remove the data block `item` from its `bpy.data` collection when `stack` closes."""
    stack.callback(collection.remove, item)
    return item
