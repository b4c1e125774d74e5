"""The settings of a probe by subject: which can be copied or preset together, and which belong to one probe alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from enum import Enum

import bpy

from ..core.presets import Preset

OF_ONE = frozenset(
    {"is_probe", "size", "locked", "capture_offset", "follow", "uid", "group", "levels", "advice", "bake_record"}
)
"""What is never copied: where a probe is, what it follows, and its bake."""


_OF_A_NEIGHBOUR = [
    "engine",
    "resolution",
    "samples",
    "adaptive",
    "denoise",
    "half_float",
    "clip_start",
    "clip_end",
    "correction",
    "relief_steps",
    "relief_refinements",
    "contact_hardening",
    "outside",
    "weight",
    "padding",
    "falloff",
    "falloff_per_face",
    "falloff_low",
    "falloff_high",
    "normal_fade",
    "effects",
]
"""Settings that a room's neighbour has as well; not which pictures, reach, capture point or objects."""


class Group(Enum):
    """Settings of one subject.

    Attributes:
        label: in a word or two.
        meaning: a phrase.
        names: of the properties of `Object.pcc_probe`.
    """

    def __init__(self, label: str, meaning: str, names: str) -> None:
        self.label, self.meaning, self.names = label, meaning, tuple(names.split())

    CAPTURE = (
        "Capture",
        "Where pictures come from, how they are rendered and kept, and what is hidden from them",
        "source picture engine resolution samples denoise adaptive half_float clip_start clip_end hidden_collection "
        "hidden_objects",
    )
    BOX = (
        "Box Correction",
        "How a reflection finds its place in the picture; not the size of the box",
        "correction relief_steps relief_refinements contact_hardening padding",
    )
    INFLUENCE = (
        "Influence",
        "How far, how much and by which objects a probe is shown",
        "weight priority receivers excluded influence_low influence_high falloff falloff_per_face falloff_low "
        "falloff_high normal_fade outside",
    )
    EFFECTS = "Effects", "Which effects are forced on or off", "effects"


def copy_settings(source: bpy.types.Object, target: bpy.types.Object, groups: Iterable[Group]) -> None:
    """Give a probe the settings of another; what is alike already is not touched."""
    for group in groups:
        for name in group.names:
            _copy(source.pcc_probe, target.pcc_probe, name)


def take_over(probe: bpy.types.Object, other: bpy.types.Object) -> None:
    """Give a probe the settings of another that are no matter of the place where it stands."""
    for name in _OF_A_NEIGHBOUR:
        _copy(other.pcc_probe, probe.pcc_probe, name)


def apply_preset(probe: bpy.types.Object, preset: Preset) -> None:
    """Set a probe for a purpose; what is so already is not touched."""
    for name, value in asdict(preset.settings).items():
        if getattr(probe.pcc_probe, name) != value:
            setattr(probe.pcc_probe, name, value)


def _copy(source: bpy.types.PropertyGroup, target: bpy.types.PropertyGroup, name: str) -> None:
    """Copy one property; a group of properties is copied one by one, a collection is made anew."""
    value = getattr(source, name)
    if isinstance(value, bpy.types.PropertyGroup):
        for key in _names(value):
            _copy(value, getattr(target, name), key)
    elif hasattr(value, "add"):
        items = getattr(target, name)
        items.clear()
        for item in value:
            new = items.add()
            for key in _names(item):
                _copy(item, new, key)
    elif _plain(value) != _plain(getattr(target, name)):
        setattr(target, name, value)


def _names(group: bpy.types.PropertyGroup) -> list[str]:
    return [prop.identifier for prop in group.bl_rna.properties if prop.identifier not in {"rna_type", "name"}]


def _plain(value: object) -> object:
    return tuple(value) if hasattr(value, "foreach_get") else value
