"""What an artist forces: for each effect of a probe or a material, whether it is on, off, or as the scene needs it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy

from ..core.decisions import OF_MATERIALS, OF_PROBES, Effect, Forced

_STATES = (
    ("AUTO", "Auto", "On where the scene needs it"),
    ("ON", "On", "On, whether the scene needs it or not"),
    ("OFF", "Off", "Off, even where the picture needs it"),
)


def settings_class(
    name: str, effects: Sequence[Effect], update: Callable[[Any, bpy.types.Context], None] | None = None
) -> type[bpy.types.PropertyGroup]:
    """A property group with one choice for each effect, called by its key."""
    choices = {
        effect.key: bpy.props.EnumProperty(
            name=effect.label, description=effect.meaning, items=_STATES, options=set(), update=update
        )
        for effect in effects
    }
    return type(name, (bpy.types.PropertyGroup,), {"__doc__": "Effects by key.", "__annotations__": choices})


def forced_of_probe(probe: bpy.types.Object) -> Forced:
    """What is forced for a probe."""
    return _forced(probe.pcc_probe.effects, OF_PROBES)


def forced_of_material(material: bpy.types.Material) -> Forced:
    """What is forced for a material."""
    return _forced(material.pcc.effects, OF_MATERIALS)


def _forced(settings: bpy.types.PropertyGroup, effects: Sequence[Effect]) -> Forced:
    return Forced.of({effect: getattr(settings, effect.key) for effect in effects})
