"""The reflection lookup, written once. NumPy evaluates it, the node builder emits it, text can come of it.

All positions and directions are in world space, in metres. The box is given by the rows of the inverse of its
3×3 matrix, so that box coordinates o = rows · (P − C) lie in [−1, 1]³ inside; no row needs unit length and the
rows need not be orthogonal. Subtracting the centre before multiplying keeps digits far from the origin.

Source of the box intersection: the slab method (Kay and Kajiya 1986), for a ray that starts inside.
"""

from __future__ import annotations

import math

from .effects import Correction, LookupEffects, Outside
from .expression import (
    Expr,
    Op,
    absolute,
    clamp,
    combine,
    dot,
    greatest,
    least,
    length,
    lift,
    maximum,
    mix,
    multiply_add,
    normalize,
    operation,
    reflect,
    scalar,
    sign,
    vector,
)

# Smaller than any |d| that can decide an intersection (boxes up to 1e9 m), and 2 / TINY is still finite in float32.
TINY = 1e-30

POSITION = vector("Position")
INCOMING = vector("Incoming")  # unit, from the surface to the eye, as Blender's Geometry node gives it
NORMAL = vector("Normal")  # unit
CENTRE = vector("Box Centre")
ROW_X, ROW_Y, ROW_Z = vector("Box Row X"), vector("Box Row Y"), vector("Box Row Z")
HALF_EXTENTS = vector("Half Extents")
CAPTURE_POINT = vector("Capture Point")
PADDING = scalar("Padding")
FALLOFF = scalar("Falloff")
DIRECTION = vector("Direction")
STEEPEST = scalar("Steepest")


def oriented_coordinates(v: Expr) -> Expr:
    """A world-space offset or direction in box coordinates, for any box (S2, S12)."""
    return combine(dot(ROW_X, v), dot(ROW_Y, v), dot(ROW_Z, v))


def aligned_coordinates(v: Expr) -> Expr:
    """The same where the rows are diagonal (S7)."""
    return v * combine(ROW_X.x, ROW_Y.y, ROW_Z.z)


def exit_distance(o: Expr, back: Expr) -> Expr:
    """How far along a ray its exit from the box [−1, 1]³ lies, in units of the undivided direction.

    `o` and `back` are the origin and the reversed direction in box coordinates. Each axis has one plane ahead, at
    −sign(back), so its distance is (1 + o·sign(back)) / |back|: no infinity for a parallel ray, no 0/0, and 0 for a
    point on the wall that looks out of it.
    """
    ahead = multiply_add(o, sign(back), 1.0) / maximum(absolute(back), TINY)
    return least(ahead)


def influence_weight(o: Expr) -> Expr:
    """1 inside the box and its padding, fading smoothly to 0 over the falloff (S3, S4)."""
    outside = greatest((absolute(o) - 1.0) * HALF_EXTENTS) - PADDING
    linear = clamp(1.0 - outside / maximum(FALLOFF, 1e-9))
    return linear * linear * (3.0 - 2.0 * linear)


def lookup(effects: LookupEffects) -> dict[str, Expr]:
    """Where to look in the probe's picture.

    Returns:
        "Direction": world-space vector, not normalised; "Weight": what to multiply the radiance by, 0 … 1.
    """
    back = reflect(INCOMING, NORMAL)  # the reflected ray, reversed: incoming points to the eye (S1)
    if effects.correction is Correction.NONE:
        return {"Direction": back * -1.0, "Weight": lift(1.0)}
    aligned = effects.correction is Correction.ALIGNED_BOX
    coordinates = aligned_coordinates if aligned else oriented_coordinates
    o, d = coordinates(POSITION - CENTRE), coordinates(back)
    distance = exit_distance(o, d)
    if effects.outside is None:
        return {"Direction": (POSITION - CAPTURE_POINT) - back * distance, "Weight": lift(1.0)}
    corrected = (POSITION - CAPTURE_POINT) - back * maximum(distance, 0.0)  # S5
    weight = influence_weight(o)
    if effects.outside is Outside.BLACK:
        return {"Direction": corrected, "Weight": weight}
    return {"Direction": mix(back * -1.0, normalize(corrected), weight), "Weight": lift(1.0)}


def off_poles() -> dict[str, Expr]:
    """A direction kept half a texel away from the poles of an equirectangular picture.

    Cycles repeats environment textures over the poles: nearer to one it mixes in the row of the other. STEEPEST is
    `steepest_slope` of the picture's height.

    Returns:
        "Direction": world-space vector, not normalised, of the same azimuth.
    """
    aside = operation(Op.ADD, DIRECTION, (1e-15, 0.0, 0.0))  # straight up and down have an azimuth too
    limit = length(aside * (1.0, 1.0, 0.0)) * STEEPEST
    return {
        "Direction": clamp(
            aside, multiply_add(limit, (0.0, 0.0, -1.0), _NO_LOWER), multiply_add(limit, (0.0, 0.0, 1.0), _NO_UPPER)
        )
    }


_NO_UPPER, _NO_LOWER = (1e30, 1e30, 0.0), (-1e30, -1e30, 0.0)  # of the horizontal components


def steepest_slope(height: int) -> float:
    """z over the horizontal length of directions to the first and last row of a picture with `height` rows."""
    return 1.0 / math.tan(math.pi / (2.0 * height))
