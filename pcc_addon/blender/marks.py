"""How data blocks and nodes of ours are told from the user's: the only module that knows the custom properties.

A mark is a custom property whose name and value nobody else has; what does not carry one is never removed. Notes lie
beside it. The first version of the add-on marked with a property called "pcc", which others may use too: such a mark
counts only where more of that version is around it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

import bpy

Item = bpy.types.ID | bpy.types.Node

BY_HAND = "by hand"  # role of a probe's group for shaders made by hand; captures see it black
TWIN_GROUP = "copy"  # role of a user's group copied for a twin
WINDOW = "interior"  # role of a group that shows rooms behind a pane
ROOMS = "rooms"  # note on such a group: where its rooms come from
VERSION = "version"  # note on a group: which version of the code built it
_MARK, _TOKEN = "parallax_probes", "parallax-probes: "
_COPY, _ORIGINAL = "material for some objects", "original"  # role of a copied material, and note of what it stands for
_BEFORE = "before"  # note on a material: what injection changed
_OLD_MARK, _OLD_OUTPUT, _OLD_PREFIX = "pcc", "pcc_twin_of", "PCC "
_OLD_NODE_ROLES = {"twin", "probe", "glow"}
_OLD_GROUP_ROLES = ("probe", "copy", "Lookup, ", "Surface, ", "Off Poles")


def tag(item: Item, role: str) -> None:
    """Mark a group or node as made by the add-on."""
    item[_MARK] = _TOKEN + role


def role(item: Item) -> str | None:
    """The role that `tag` gave, or None for the user's own."""
    mark = item.get(_MARK)
    if isinstance(mark, str) and mark.startswith(_TOKEN):
        return mark.removeprefix(_TOKEN)
    old = item.get(_OLD_MARK)
    return old if isinstance(old, str) and _is_of_version_1(item, old) else None


def note(item: Item, key: str, value: Any) -> None:
    """Write something beside the mark of an item: a number, a text, a list or a dictionary of these."""
    item[f"{_MARK}_{key}"] = value


def noted(item: Item, key: str, default: Any = None) -> Any:
    """What `note` wrote, or `default`."""
    value = item.get(f"{_MARK}_{key}", default)
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value.to_list() if hasattr(value, "to_list") else value


def forget(item: Item, key: str) -> None:
    """Remove a note."""
    item.pop(f"{_MARK}_{key}", None)


def note_original(copy: bpy.types.Material, original: bpy.types.Material) -> None:
    """Mark a material as a copy of ours that stands for another; as long as it does, that one stays in the file."""
    tag(copy, _COPY)
    note(copy, _ORIGINAL, original)


def original(material: bpy.types.Material) -> bpy.types.Material:
    """The user's material that a copy of ours stands for; any other material is its own."""
    found = material.get(f"{_MARK}_{_ORIGINAL}") if role(material) == _COPY else None
    return found if isinstance(found, bpy.types.Material) else material


def is_copy(material: bpy.types.Material) -> bool:
    return original(material) != material


def is_foreign(item: bpy.types.ID) -> bool:
    """Whether nothing of ours can be kept in a data block, as it is another file's: linked, or a library override."""
    return item.library is not None or item.override_library is not None


def forget_original(copy: bpy.types.Material) -> None:
    """Leave a copy to the user as a material of his own."""
    forget(copy, _ORIGINAL)
    copy.pop(_MARK, None)


@dataclass(frozen=True)
class OriginalOutput:
    """One of the user's material outputs as it was before injection.

    Attributes:
        name, index: where to find it again: the index among the user's outputs, should it be renamed.
        target: the engines that it was meant for.
        active: whether it was the active one.
    """

    name: str
    index: int
    target: str
    active: bool


@dataclass(frozen=True)
class Before:
    """What injection changed in a material.

    Attributes:
        outputs: those that were in force.
        sampling: the setting of lamp sampling, "" for unset, None where it was not changed.
    """

    outputs: tuple[OriginalOutput, ...]
    sampling: str | None


def note_before(material: bpy.types.Material, before: Before) -> None:
    """Remember what an injection changes."""
    note(material, _BEFORE, json.dumps(asdict(before)))


def noted_before(material: bpy.types.Material) -> Before | None:
    """What the injection changed that a material shows, or None where it shows none."""
    text = noted(material, _BEFORE)
    if text is None:
        return _before_of_version_1(material)
    found = json.loads(text)
    return Before(tuple(OriginalOutput(**output) for output in found["outputs"]), found["sampling"])


def forget_before(material: bpy.types.Material) -> None:
    forget(material, _BEFORE)


def _is_of_version_1(item: Item, old: str) -> bool:
    if isinstance(item, bpy.types.Node):
        return old in _OLD_NODE_ROLES and _was_injected(item.id_data)
    ours = old.startswith(_OLD_GROUP_ROLES) and item.name.startswith(_OLD_PREFIX)
    return isinstance(item, bpy.types.NodeTree) and ours


def _was_injected(tree: bpy.types.NodeTree) -> bool:
    """Whether the first version put twins into a tree: their output says whose twin it is, copied groups are marked."""
    copied = tree.get(_OLD_MARK) == "copy" and tree.name.startswith(_OLD_PREFIX)
    return copied or any(_old_outputs(tree.nodes))


def _old_outputs(nodes: Iterable[bpy.types.Node]) -> list[bpy.types.Node]:
    return [n for n in nodes if n.bl_idname == "ShaderNodeOutputMaterial" and _OLD_OUTPUT in n and _OLD_MARK in n]


def _before_of_version_1(material: bpy.types.Material) -> Before | None:
    twins = _old_outputs(material.node_tree.nodes) if material.node_tree else []
    if not twins:
        return None
    outputs = tuple(
        OriginalOutput(str(n[_OLD_OUTPUT]), 0, str(n.get("pcc_target", n.target)), bool(n.get("pcc_active", True)))
        for n in twins
    )
    sampling = next((str(n["pcc_emission_sampling"]) for n in twins if "pcc_emission_sampling" in n), None)
    return Before(outputs, sampling)
