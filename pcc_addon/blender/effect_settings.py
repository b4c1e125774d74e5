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
    name: str, effects: Sequence[Effect], chosen: Callable[[bpy.types.ID, Effect], None]
) -> type[bpy.types.PropertyGroup]:
    """A property group with one choice for each effect, called by its key.

    Args:
        name: of the class.
        effects: which.
        chosen: called with the object or material whose choice of an effect was set.
    """
    choices = {effect.key: _choice(effect, chosen) for effect in effects}
    return type(name, (bpy.types.PropertyGroup,), {"__doc__": "Effects by key.", "__annotations__": choices})


def _choice(effect: Effect, chosen: Callable[[bpy.types.ID, Effect], None]) -> Any:
    return bpy.props.EnumProperty(
        name=effect.label,
        description=effect.meaning,
        items=_STATES,
        options=set(),
        update=lambda settings, context: chosen(settings.id_data, effect),
    )


def forced_of_probe(probe: bpy.types.Object) -> Forced:
    """What is forced for a probe."""
    return _forced(probe.pcc_probe.effects, OF_PROBES)


def forced_of_material(material: bpy.types.Material) -> Forced:
    """What is forced for a material."""
    return _forced(material.pcc.effects, OF_MATERIALS)


def _forced(settings: bpy.types.PropertyGroup, effects: Sequence[Effect]) -> Forced:
    return Forced.of({effect: getattr(settings, effect.key) for effect in effects})
