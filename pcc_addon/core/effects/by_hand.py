"""What shaders made by hand get of a probe: the radiance along any direction, the influence, how far the box is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

from ..expression import (
    Expr,
    Formula,
    Operand,
    Section,
    length,
    multiply_add,
    normalize,
    reflect,
    scalar,
    sign,
    vector,
)
from .lookup import (
    CENTRE,
    DIRECTION,
    INCOMING,
    MIRRORED,
    NORMAL,
    OFFSET,
    POSITION,
    along_face_normals,
    found_along,
    nearness,
    read_picture,
)
from .records import Correction, LookupEffects, Outside
from .roughness import level_name, mixed_formula

SHOWN = scalar("Shown")  # 1, and 0 while probes are captured: they must not see what they show
SURFACE_NORMAL = vector("Surface Normal")  # unit


def given_or(given: Expr, own: Expr) -> Expr:
    """A vector of length 1 along the given one; `own` where that is zero, as sockets are that nothing is linked to."""
    return multiply_add(own, 1.0 - sign(length(given)), normalize(given))


MIRRORED_VIEW = Formula("Mirrored View", {"Direction": reflect(INCOMING, given_or(NORMAL, SURFACE_NORMAL)) * -1.0})
"""The direction in which a mirror of the normal "Normal" sends the view; where that is zero, of the surface's own."""


@cache
def distance_formula(correction: Correction) -> Formula:
    """How far along the unit input "Direction", from "Offset" beside the surface, the box's wall lies, metres.

    Next to nothing where the point is on the wall or beyond it and the ray does not return.
    """
    q, d = (along_face_normals(correction, v) for v in (CENTRE - (POSITION + OFFSET), DIRECTION))
    return Formula(f"Distance, {correction.words}", {"Distance": 1.0 / nearness(q, d)})


def by_hand(
    effects: LookupEffects,
    heights: Mapping[str, int],
    rungs: Sequence[float],
    known: Mapping[str, Operand] | None = None,
) -> Formula:
    """What a probe gives to any shader, along the input "Direction", or the mirrored view where that is zero.

    Args:
        effects: of the lookup; whatever the probe does outside its influence, here "Weight" tells.
        heights: the rows of its pictures, sharpest first, by the names that it reads them under.
        rungs: their roughnesses.
        known: values of inputs that are the same for all points, as for `lookup.probe`.

    Returns:
        A formula with "Radiance" at the input "Roughness", times the input "Shown"; "Weight", the influence, 0 … 1;
        "Distance" of `distance_formula`.
    """
    corrected = effects.correction is not Correction.NONE
    shown = replace(effects, outside=Outside.OWN) if corrected else effects
    direction = Section("Direction", given_or(DIRECTION, MIRRORED))
    values = {**(known or {}), "Direction": direction}
    found = found_along(shown, direction, known)
    weight = found["Weight"]
    if "Presence" in found:
        weight = weight * found["Presence"]
    levels: dict[str, Expr] = {
        level_name(k): Section("Pictures", read_picture(name, rows, found["Direction"]))
        for k, (name, rows) in enumerate(heights.items())
    }
    if shown.hardening:
        levels["Spread"] = found["Spread"]
    mixed = mixed_formula(tuple(rungs), shown.hardening).at(levels)["Radiance"]
    box = effects.correction if corrected else Correction.ORIENTED_BOX
    return Formula(
        "By Hand",
        {
            "Radiance": mixed * SHOWN,
            "Weight": weight,
            "Distance": distance_formula(box).at(values)["Distance"],
        },
    )
