"""The reflection lookup, written once. NumPy evaluates it, the node builder emits it, text can come of it.

All positions and directions are in world space, in metres. A box is three pairs of parallel planes: along each unit
face normal n the coordinate n · (P − C) lies in [−h, h] inside. Subtracting the centre first keeps digits far from
the origin. The normals need not be orthogonal.

Source of the box intersection: the slab method (Kay and Kajiya 1986) for a ray that starts inside, by the reciprocal
of the distance, so that nothing overflows or is undefined.
"""

from __future__ import annotations

import math

from ..expression import (
    Expr,
    Op,
    absolute,
    clamp,
    combine,
    dot,
    greatest,
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
from .records import Correction, LookupEffects, Outside

# Metres; a point nearer to a wall than this is on it. Below the spacing of float32 in any box larger than 0.1 mm, and
# its reciprocal times any distance up to 10⁷ m can still be squared.
ON_WALL = 1e-12

POSITION = vector("Position")
INCOMING = vector("Incoming")  # unit, from the surface to the eye, as Blender's Geometry node gives it
NORMAL = vector("Normal")  # unit
CENTRE = vector("Box Centre")
NORMAL_X, NORMAL_Y, NORMAL_Z = vector("Face Normal X"), vector("Face Normal Y"), vector("Face Normal Z")
TURN_MIRROR = vector("Turn Mirror")  # unit, horizontal: the mirror in its plane takes the box's axes to the world's
HALF_WIDTHS = vector("Half Widths")  # from the centre to each pair of faces
CAPTURE_POINT = vector("Capture Point")
PADDING = scalar("Padding")
FALLOFF = scalar("Falloff")  # above 0: `ProbeSpec.influence_falloff`
DIRECTION = vector("Direction")
STEEPEST = scalar("Steepest")


def along_face_normals(correction: Correction, v: Expr) -> Expr:
    """A world-space vector by its components along the box's face normals, of either sign.

    A box is its own mirror image, so where its axes are turned about the vertical only, one reflection stands for the
    rotation (Householder 1958).
    """
    if correction is Correction.ALIGNED_BOX:
        return v  # S7
    if correction is Correction.TURNED_BOX:
        return reflect(v, TURN_MIRROR)
    return combine(dot(NORMAL_X, v), dot(NORMAL_Y, v), dot(NORMAL_Z, v))  # S2, S12


def nearness(q: Expr, back: Expr) -> Expr:
    """The reciprocal of how far along a ray from inside its exit from the box lies, in 1/metres; never negative.

    `q` and `back` are the origin and the reversed unit direction along the face normals. Each axis has one plane
    ahead, on the side of −sign(back), at the distance (h + q·sign(back)) / |back|. Its reciprocal is 0 for a parallel
    ray and large, not infinite, for a point on the wall that looks out of it.
    """
    return greatest(absolute(back) / maximum(multiply_add(q, sign(back), HALF_WIDTHS), ON_WALL))


def influence_weight(q: Expr) -> Expr:
    """1 inside the box and its padding, fading smoothly to 0 over the falloff (S3, S4)."""
    outside = greatest(absolute(q) - HALF_WIDTHS) - PADDING
    linear = clamp(1.0 - outside / FALLOFF)
    return linear * linear * (3.0 - 2.0 * linear)


def lookup(effects: LookupEffects) -> dict[str, Expr]:
    """Where to look in the probe's picture.

    Returns:
        "Direction": world-space vector, not normalised; "Weight": what to multiply the radiance by, 0 … 1.
    """
    back = reflect(INCOMING, NORMAL)  # the reflected ray, reversed: incoming points to the eye (S1)
    if effects.correction is Correction.NONE:
        return {"Direction": back * -1.0, "Weight": lift(1.0)}
    from_centre = POSITION - CENTRE
    from_capture = POSITION - CAPTURE_POINT if effects.offset else from_centre  # S5
    q, d = along_face_normals(effects.correction, from_centre), along_face_normals(effects.correction, back)
    corrected = from_capture * nearness(q, d) - back  # (hit − B) / t with hit = P − t·back; its length does not count
    if effects.outside is None:
        return {"Direction": corrected, "Weight": lift(1.0)}
    weight = influence_weight(q)
    if effects.outside is Outside.BLACK:
        return {"Direction": corrected, "Weight": weight}
    return {"Direction": mix(back * -1.0, normalize(corrected), weight), "Weight": lift(1.0)}


def off_poles() -> dict[str, Expr]:
    """A direction kept out of the first and last half texel of an equirectangular picture.

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


_COSINE_ERROR = 2.25 * 2.0**-24  # z / length in float32: a division and a length of half an ulp each, and a little more
_NO_UPPER, _NO_LOWER = (1e30, 1e30, 0.0), (-1e30, -1e30, 0.0)  # of the horizontal components


def steepest_slope(height: int) -> float:
    """z over the horizontal length of the steepest directions that read only their own side of a picture.

    Cycles finds the angle θ from the pole by an arc cosine. Where that is off by δ, θ² is off by 2 δ: so θ² must exceed
    that of half a texel, in a picture of `height` rows, by as much.
    """
    return 1.0 / math.tan(math.hypot(math.pi / (2.0 * height), math.sqrt(2.0 * _COSINE_ERROR)))
