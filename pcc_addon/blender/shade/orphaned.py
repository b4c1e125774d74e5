"""Materials that lose a deleted probe, for the undo that brings it back.

Undo takes for unchanged what is the same in both of its steps, as a material is that handlers change after the step of
the deletion; Blender before 5.2 then keeps it without the probe.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .. import marks
from ..read.probes import all_probes
from .probe_group import ROLE, probe_of
from .twin import shown_probe_groups

_lost: dict[int, set[int]] = {}  # by the session uids of users' materials: those of the groups of deleted probes


def groups() -> list[bpy.types.ShaderNodeTree]:
    """The groups of deleted probes that materials still use."""
    ours = [tree for tree in bpy.data.node_groups if marks.role(tree) == ROLE and tree.users]
    return [tree for tree in ours if probe_of(tree) is None]


def note() -> None:
    """Note who is about to lose them."""
    uids = {tree.session_uid for tree in groups()}
    for material in bpy.data.materials if uids else ():
        if shown := uids & _shown(material):
            _lost.setdefault(marks.original(material).session_uid, set()).update(shown)


def came_back(scene: bpy.types.Scene) -> Iterator[bpy.types.Material]:
    """The materials that do not show a probe of the scene which they lost and which is there again; each once."""
    there = {probe.pcc_probe.group.session_uid for probe in all_probes(scene) if probe.pcc_probe.group}
    lost = dict(_lost)
    _lost.clear()
    for material in list(bpy.data.materials):
        if lost.get(material.session_uid, set()) & there - _shown(material):
            yield material


def forget() -> None:
    """Another file is open."""
    _lost.clear()


def _shown(material: bpy.types.Material) -> set[int]:
    return {group.session_uid for group in shown_probe_groups(material)}
