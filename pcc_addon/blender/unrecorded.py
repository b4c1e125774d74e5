"""Data blocks that an undo frees, as handlers made them after the step that it goes back to was taken.

What undo keeps, because the user's own steps did not change it, would go on pointing to what is gone: a probe's group
that was built anew for its moved box, say, to a formula's new group. Reading that ends Blender
(`std::bad_optional_access`). So before an undo or a redo all users let go of these blocks, and are mended afterwards as
if the user had deleted them.

Undo takes for unchanged what has the same bytes in both steps, and a pointer's bytes are an address. So no block of
ours lies where another one of ours did: what points to the one in one step and to the other in the next would not be
read again, and go on pointing to what is gone. And while it reads a group, an address in it that nothing has may by
chance be that of the memory it reads into, and is taken for the group itself, which then holds itself. So blocks that a
step may know are not removed while there are steps: they stay without users, and Blender does not save them.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TypeVar

import bpy

Block = bpy.types.NodeTree | bpy.types.Material | bpy.types.Image
B = TypeVar("B", bound=Block)

_made: dict[int, tuple[str, int]] = {}  # by session uid: in which of `bpy.data`, and when, in operators
_addresses: set[int] = set()
_following = 0
_operators, _last = 0, None  # how many were seen to have taken a step, and the last of them


@contextlib.contextmanager
def following() -> Iterator[None]:
    """What is made meanwhile follows a change whose undo step may have been taken."""
    global _following
    _following += 1
    try:
        yield
    finally:
        _following -= 1


def new(make: Callable[[], B]) -> B:
    """A new data block of ours from `make`, at an address that none of ours had since the file was opened."""
    if not _addresses:
        remember_addresses()
    block, spoiled = make(), []
    while block.as_pointer() in _addresses:
        spoiled.append(block)
        block = make()
    if spoiled:
        name = spoiled[0].name
        bpy.data.batch_remove(spoiled)
        block.name = name
    _addresses.add(block.as_pointer())
    if _following:
        _made[block.session_uid] = (_KINDS[block.id_type], _operators)
    return block


def new_group(name: str) -> bpy.types.ShaderNodeTree:
    """`new`, for an empty node group."""
    return new(lambda: bpy.data.node_groups.new(name, "ShaderNodeTree"))


def remember_addresses() -> None:
    """Note where everything is that an undo has just read."""
    for kind in _KINDS.values():
        _addresses.update(block.as_pointer() for block in getattr(bpy.data, kind))


def settle() -> None:
    """Forget what even the step before the last has: an undo to that frees nothing of it."""
    global _operators, _last
    last = _last_operator()
    if last in (None, _last):  # an undo clears them
        return
    _operators, _last = _operators + 1, last
    for uid in [uid for uid, (_, when) in _made.items() if when < _operators - 1]:
        del _made[uid]


def let_go(stand_in: Callable[[bpy.types.Material], bpy.types.Material]) -> set[bpy.types.Material]:
    """Let nothing point to what no undo step has.

    Args:
        stand_in: which material objects wear instead of one that is removed.

    Returns:
        The materials that stand in.
    """
    instead = set()
    uids = {uid: kind for uid, (kind, _) in _made.items()}
    _made.clear()
    for kind in set(uids.values()):
        blocks = getattr(bpy.data, kind)
        going = [block for block in blocks if uids.get(block.session_uid) == kind]
        for block in going:
            if isinstance(block, bpy.types.Material):
                original = stand_in(block)
                block.user_remap(original)
                instead.add(original)
            else:
                _unlink(block)
    return instead


def _unlink(block: bpy.types.NodeTree | bpy.types.Image) -> None:
    """Let whatever points to a block point to nothing, as if it were removed."""
    is_picture = isinstance(block, bpy.types.Image)
    nothing = new(lambda: bpy.data.images.new("PCC", 1, 1)) if is_picture else new_group("PCC")
    block.user_remap(nothing)
    bpy.data.batch_remove([nothing])


def forget() -> None:
    """Another file is open."""
    _made.clear()
    _addresses.clear()


_KINDS = {"NODETREE": "node_groups", "MATERIAL": "materials", "IMAGE": "images"}


def _last_operator() -> object:
    """Tells one operator that took an undo step from the next."""
    operators = bpy.context.window_manager.operators
    return (len(operators), operators[-1].as_pointer()) if operators else None
