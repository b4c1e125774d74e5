"""The lookup of one probe as a formula for engines, and the numbers that it is given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum
from functools import reduce
from itertools import pairwise
from operator import mul

import numpy as np

from ..effects import lookup
from ..effects.records import Correction, LookupEffects, Outside
from ..effects.shading import ROUGHNESS
from ..expression import Expr, Formula, clamp, lift
from ..lookup_plan import Receivers, lookup_effects
from ..probe import STEEPEST_FALLOFF, ProbeSpec
from .target import Target

TITLE = "Parallax Probe Lookup"
OF_SURFACE = ("Position", "Incoming", "Normal", "Roughness")
"""The inputs that differ from point to point; all others are the same for all of a probe."""


class _Kind(Enum):
    """How a number changes with axes and units."""

    POINT = "point"
    DIRECTION = "direction"
    LENGTH = "length"
    NUMBER = "number"


def effects_of(spec: ProbeSpec, captured_at: Sequence[float]) -> LookupEffects:
    """What the lookup of a probe computes where nothing is known of the surfaces that show it.

    The box is any, so that it may be moved. Relief is not among it: engines are given no distances. Pictures that are
    stretched to the box are exported along the world's axes, and looked up as those that were captured.
    """
    found = lookup_effects(spec, Receivers(), captured_at)
    corrected = found.correction is not Correction.NONE
    return replace(
        found,
        correction=Correction.ORIENTED_BOX if corrected else Correction.NONE,
        offset=corrected,
        stretched=False,
        hardening=corrected and spec.contact_hardening,
    )


def formula(effects: LookupEffects, roughnesses: Sequence[float]) -> Formula:
    """Where to look in a cubemap with levels, and how much of the surface the probe has.

    Args:
        effects: of the lookup.
        roughnesses: of the cubemap's levels, ascending from 0.

    Returns:
        A formula of `OF_SURFACE` and the probe's numbers: "Direction", of any length; "Level", whose fraction mixes two
        levels as hardware mixes them; "Brightness", by which to multiply what is found; and "Weight".
    """
    found = lookup.lookup(effects, lookup.MIRRORED)
    corrected = effects.correction is not Correction.NONE
    blackens = corrected and effects.outside is Outside.BLACK
    kept = [found["Weight"]] if corrected and effects.outside is Outside.OWN else []
    kept += [found["Presence"]] if "Presence" in found else []
    outputs = {
        "Direction": found["Direction"],
        "Level": _level(roughnesses, ROUGHNESS * found["Spread"] if "Spread" in found else ROUGHNESS),
        "Brightness": found["Weight"] if blackens else lift(1.0),
        "Weight": reduce(mul, kept) if kept else lift(1.0),
    }
    return Formula(TITLE, outputs)


def _level(roughnesses: Sequence[float], roughness: Expr) -> Expr:
    level: Expr = lift(0.0)
    for below, above in pairwise(roughnesses):
        level = level + clamp((roughness - below) * (1.0 / (above - below)))
    return level


def numbers(spec: ProbeSpec, captured_at: Sequence[float], target: Target) -> dict[str, tuple[float, ...]]:
    """All that the lookup of a probe may be given but for `OF_SURFACE`, in an engine's axes and units."""
    box = spec.box
    known = {
        "Box Centre": (_Kind.POINT, box.centre),
        **{f"Face Normal {axis}": (_Kind.DIRECTION, box.face_normals[k]) for k, axis in enumerate("XYZ")},
        "Half Widths": (_Kind.LENGTH, box.half_widths),
        "Capture Point": (_Kind.POINT, captured_at),
        "Padding": (_Kind.LENGTH, spec.influence_padding),
        "Falloff": (_Kind.LENGTH, spec.influence_falloff),
        "Boundary": (_Kind.LENGTH, spec.boundary),
        "Normal Fade": (_Kind.LENGTH, max(spec.influence.normal_fade, STEEPEST_FALLOFF)),
        "Probe Weight": (_Kind.NUMBER, spec.influence.weight),
        **{
            name: (_Kind.NUMBER if name.startswith("Steepness") else _Kind.LENGTH, value)
            for name, value in spec.shown_faces(Correction.ORIENTED_BOX).items()
        },
    }
    return {name: in_engine(kind, value, target) for name, (kind, value) in known.items()}


def in_engine(kind: _Kind, value: np.ndarray | Sequence[float] | float, target: Target) -> tuple[float, ...]:
    """A number, or three, of Blender's world in an engine's."""
    found = np.atleast_1d(np.asarray(value, np.float64))
    if kind in (_Kind.POINT, _Kind.DIRECTION):
        found = target.axes.matrix @ found
    if kind in (_Kind.POINT, _Kind.LENGTH):
        found = found * target.units
    return tuple(float(component) + 0.0 for component in found)  # -0.0 is 0.0


def point(place: Sequence[float] | np.ndarray, target: Target) -> tuple[float, ...]:
    """A place in an engine's world."""
    return in_engine(_Kind.POINT, np.asarray(place, np.float64), target)


def length(metres: np.ndarray | Sequence[float] | float, target: Target) -> tuple[float, ...]:
    """Lengths in an engine's units."""
    return in_engine(_Kind.LENGTH, metres, target)
