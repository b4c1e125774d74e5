"""Copies of a material for objects that are to show other probes: worn in their slots, and taken back exactly.

Each object's own slot is switched to the copy, never the slot of data that objects share. A copy follows its original
and the original follows a value that was changed in a copy, so that it stays one material to the user. A copy that the
user builds differently becomes a material of his own and stays where it is.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Sequence
from operator import attrgetter

import bpy

from ...core.decisions import Effect
from ...core.parts import MaterialPart
from .. import marks, unrecorded
from ..read.node_lines import material_lines, node_lines
from . import twin
from .sketch import repeat_value

_STATE = "state"  # note on a copy: what of the user's its original and itself were made of when they were the same
_LINK, _HIDDEN = "link_{}", "hidden_{}"  # notes on an object: what a slot was linked to, and what it held unseen


Copies = dict[bpy.types.Material, list[bpy.types.Material]]


def all_copies() -> Copies:
    """The copies of each material that has some."""
    found: Copies = {}
    for material in bpy.data.materials:
        if marks.is_copy(material):
            found.setdefault(marks.original(material), []).append(material)
    return found


def divide(
    original: bpy.types.Material, parts: Sequence[MaterialPart], known: Sequence[bpy.types.Material]
) -> list[bpy.types.Material]:
    """Let the objects of each part wear a copy of `original`, as far as its nodes and settings are the user's.

    Args:
        original: the user's material.
        parts: which objects, and the probes that their copy is named after.
        known: the copies that there are: those that do are used again, the others are taken back.

    Returns:
        The copies, in the order of the parts; they have the twins that they had before, or none.
    """
    if not parts and not known:
        return []
    objects = {item.name_full: item for item in bpy.data.objects}
    state = _state(original)
    usable = {copy.name: copy for copy in known if _state(copy) == state}
    worn, wearers = [], set()
    for part in parts:
        wanted = f"{original.name} in {' and '.join(part.probes) or 'no probe'}"[:60]
        copy = usable.pop(wanted, None) or _new_copy(original, wanted)
        worn.append(copy)
        for name in part.objects:
            _wear(objects[name], original, copy)
        wearers.update(part.objects)
    _undress([item for name, item in objects.items() if name not in wearers], original, worn)
    _take_back(original, [copy for copy in known if copy not in worn])
    return worn


def unite(original: bpy.types.Material, known: Sequence[bpy.types.Material]) -> None:
    """Give all objects that wear these copies of `original` back what they had."""
    _take_back(original, known)


Shown = tuple[bpy.types.ShaderNodeTree, ...]


def follow(original: bpy.types.Material, known: Sequence[bpy.types.Material]) -> list[tuple[bpy.types.Material, Shown]]:
    """Let an edit of a material or of one of its copies show in the others.

    Returns:
        What is to be brought up to date, and the probe groups that it is to show; copies of a material that was built
        differently are made anew.
    """
    changed, copies = [(original, twin.shown_probe_groups(original))], []
    if not known:
        return changed
    for copy in known:
        if _is_edited(copy) and marks.noted(copy, _STATE) == _state(original):
            _transfer(copy, original)
            if _state(copy) != _state(original):
                _release(copy)
                changed.append((copy, twin.shown_probe_groups(copy)))
                continue
        copies.append(copy)
    state = _state(original)
    for copy in copies:
        groups = twin.shown_probe_groups(copy)
        _transfer(original, copy)
        followed = copy if _state(copy) == state else _renewed(copy, original)
        _note_state(followed, state)
        changed.append((followed, groups))
    return changed


def repeat_choice(chosen: bpy.types.Material, original: bpy.types.Material, effect: Effect) -> None:
    """Give a material and all its copies the choice of an effect that was made for one of them."""
    _repeat(chosen, original, attrgetter("pcc.effects"), effect.key)


def repeat_chosen_probes(chosen: bpy.types.Material, original: bpy.types.Material) -> None:
    """Give a material and all its copies what was chosen for one of them of the probes that it shows."""
    for name in ("show_probes", "probe"):
        _repeat(chosen, original, attrgetter("pcc"), name)


def _repeat(
    chosen: bpy.types.Material,
    original: bpy.types.Material,
    settings: Callable[[bpy.types.Material], bpy.types.PropertyGroup],
    name: str,
) -> None:
    choice = getattr(settings(chosen), name)
    for material in (original, *all_copies().get(original, ())):
        if getattr(settings(material), name) != choice and not marks.is_foreign(material):
            setattr(settings(material), name, choice)


def _renewed(copy: bpy.types.Material, original: bpy.types.Material) -> bpy.types.Material:
    """A copy of what `original` is now, without twins, wherever the old one was, which is gone."""
    name = copy.name
    new = _new_copy(original, name)
    copy.user_remap(new)
    twin.remove_twins(copy)
    bpy.data.materials.remove(copy)
    new.name = name
    return new


def _new_copy(original: bpy.types.Material, name: str) -> bpy.types.Material:
    copy = unrecorded.new(original.copy)
    copy.name = name
    copy.use_fake_user = False
    twin.remove_twins(copy)
    marks.note_original(copy, original)
    _note_state(copy, _state(copy))
    return copy


def _wear(item: bpy.types.Object, original: bpy.types.Material, copy: bpy.types.Material) -> None:
    for index, slot in enumerate(item.material_slots):
        worn = slot.material
        if worn is None or worn == copy or marks.original(worn) != original:
            continue
        if worn == original:  # the first copy here
            marks.note(item, _LINK.format(index), slot.link)
            if slot.link == "DATA":
                slot.link = "OBJECT"
                if slot.material is not None:
                    marks.note(item, _HIDDEN.format(index), slot.material)
        slot.material = copy


def _take_back(original: bpy.types.Material, copies: Sequence[bpy.types.Material]) -> None:
    """Remove copies of `original` from all slots and then from the file; edited ones stay, the user's own."""
    edited = [copy for copy in copies if _is_edited(copy)]
    for copy in edited:
        _release(copy)
    going = [copy for copy in copies if copy not in edited]
    if going:
        _undress(bpy.data.objects, original, going)
    for copy in going:
        twin.remove_twins(copy)
        bpy.data.materials.remove(copy)


def _undress(
    items: Iterable[bpy.types.Object], original: bpy.types.Material, copies: Sequence[bpy.types.Material]
) -> None:
    for item in items:
        for index, slot in enumerate(item.material_slots) if item.library is None else ():
            if slot.material in copies:
                _restore(item, index, slot, original)


def _restore(item: bpy.types.Object, index: int, slot: bpy.types.MaterialSlot, original: bpy.types.Material) -> None:
    link = marks.noted(item, _LINK.format(index), "OBJECT")
    slot.material = marks.noted(item, _HIDDEN.format(index)) if link == "DATA" else original
    slot.link = link
    for note in (_LINK, _HIDDEN):
        marks.forget(item, note.format(index))


def _release(copy: bpy.types.Material) -> None:
    """Leave an edited copy to the user, in the slots where it is."""
    marks.forget_original(copy)
    marks.forget(copy, _STATE)
    for item in bpy.data.objects:
        for index, slot in enumerate(item.material_slots) if item.library is None else ():
            if slot.material == copy:
                marks.forget(item, _LINK.format(index))
                marks.forget(item, _HIDDEN.format(index))


def _state(material: bpy.types.Material) -> str:
    return hashlib.sha256("\n".join(material_lines(material)).encode()).hexdigest()


def _note_state(copy: bpy.types.Material, state: str) -> None:
    if marks.noted(copy, _STATE) != state:
        marks.note(copy, _STATE, state)


def _is_edited(copy: bpy.types.Material) -> bool:
    return marks.noted(copy, _STATE) != _state(copy)


def _transfer(source: bpy.types.Material, target: bpy.types.Material) -> None:
    """Give the inputs of the user's nodes in one material the values of another that is built the same."""
    if node_lines(source.node_tree, values=False) != node_lines(target.node_tree, values=False):
        return
    for node in source.node_tree.nodes:
        if not marks.role(node):
            for theirs, ours in zip(node.inputs, target.node_tree.nodes[node.name].inputs, strict=True):
                if hasattr(theirs, "default_value"):
                    repeat_value(theirs, ours)
