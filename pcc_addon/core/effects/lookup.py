"""The reflection lookup, written once. NumPy evaluates it, the node builder emits it, text can come of it.

All positions and directions are in world space, in metres. A box is three pairs of parallel planes: along each unit
face normal n the coordinate n · (P − C) lies in [−h, h] inside. Subtracting the centre first keeps digits far from
the origin. The normals need not be orthogonal.

Source of the box intersection: the slab method (Kay and Kajiya 1986) for a ray that starts inside, by the reciprocal
of the distance, so that nothing overflows or is undefined.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache, reduce
from operator import mul

from ..expression import (
    Expr,
    Formula,
    Op,
    Operand,
    Sample,
    Section,
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
    sqrt,
    vector,
)
from . import relief
from .records import Correction, LookupEffects, Outside

# Metres; a point nearer to a wall than this is on it. Below the spacing of float32 in any box larger than 0.1 mm, and
# its reciprocal times any distance up to 10⁷ m can still be squared.
ON_WALL = 1e-12
# Metres; what counts as infinitely deep outside. Its square is still a float32.
FAR = 1e6

POSITION = vector("Position")
INCOMING = vector("Incoming")  # unit, from the surface to the eye, as Blender's Geometry node gives it
NORMAL = vector("Normal")  # unit
DIRECTION = vector("Direction")  # unit, of the ray that leaves the surface
OFFSET = vector("Offset")  # from the surface to where the ray leaves a thing that it passed through
CENTRE = vector("Box Centre")
NORMAL_X, NORMAL_Y, NORMAL_Z = vector("Face Normal X"), vector("Face Normal Y"), vector("Face Normal Z")
TURN_MIRROR = vector("Turn Mirror")  # unit, horizontal: the mirror in its plane takes the box's axes to the world's
HALF_WIDTHS = vector("Half Widths")  # from the centre to each pair of faces
CAPTURE_POINT = vector("Capture Point")
PADDING = scalar("Padding")
FALLOFF = scalar("Falloff")  # above 0: `ProbeSpec.influence_falloff`
BOUNDARY = scalar("Boundary")  # metres that positions on a wall may be off by rounding: `ProbeSpec.boundary`
STEEPEST = scalar("Steepest")
# Of an influence whose faces differ, for the faces that the coordinates below and above the centre meet.
REACH_LOW, REACH_HIGH = vector("Reach Low"), vector("Reach High")  # metres beyond the box's faces, padding included
STEEPNESS_LOW, STEEPNESS_HIGH = vector("Steepness Low"), vector("Steepness High")  # the falloff over each face's own
NORMAL_FADE = scalar("Normal Fade")  # metres, above 0
PROBE_WEIGHT = scalar("Probe Weight")


def along_face_normals(correction: Correction, v: Expr) -> Expr:
    """A world-space vector by its components along the box's face normals, of either sign.

    A box is its own mirror image, so where its axes are turned about the vertical only, one reflection stands for the
    rotation (Householder 1958).
    """
    if correction is Correction.ALIGNED_BOX:
        return v
    if correction is Correction.TURNED_BOX:
        return reflect(v, TURN_MIRROR)
    return combine(dot(NORMAL_X, v), dot(NORMAL_Y, v), dot(NORMAL_Z, v))


MIRRORED = Section("Reflected ray", reflect(INCOMING, NORMAL) * -1.0)  # incoming points to the eye
MIRROR = Formula("Mirror", {"Direction": MIRRORED})
"""The direction in which a mirror sends the view."""


def nearness(to_centre: Expr, d: Expr, *, on_walls: bool = True) -> Expr:
    """The reciprocal of how far along a ray from inside its exit from the box lies, in 1/metres; never negative.

    Given are the way from the origin to the box's centre and the unit direction, both along the face normals. Each axis
    has one plane ahead, on the side of sign(d), at the distance (h + to_centre·sign(d)) / |d|. Its reciprocal is 0 for
    a parallel ray and large, not infinite, for a point on the wall that looks out of it, which needs
    no guard where no ray leaves from a wall or from beyond.
    """
    ahead = multiply_add(to_centre, sign(d), HALF_WIDTHS)
    return greatest(absolute(d) / (maximum(ahead, ON_WALL) if on_walls else ahead))


PARALLAX = Formula("Parallax", {"Direction": operation(Op.SUBTRACT, DIRECTION, vector("Aside"))})
"""The direction from the capture point to what a ray meets, of any length; without it, the ray's own.

Given are the ray's direction and the way to the capture point, over that to what is met. It is a formula of its own so
that one node takes the parallax out of all lookups.
"""


def stretch(correction: Correction) -> Expr:
    """By what to multiply directions along the face normals to look them up in a picture that is stretched to the box.

    Along each axis that is the least of the half widths over its own, so that the box becomes the cube that every
    cubemap is of. Nothing is multiplied by more than 1, which keeps the products finite. The mirror that stands for a
    turn about the vertical leaves the second axis the wrong way round.
    """
    least = greatest(HALF_WIDTHS * -1.0) * -1.0
    ratios = least / HALF_WIDTHS
    return ratios * _OWN_WAY_ROUND if correction is Correction.TURNED_BOX else ratios


_OWN_WAY_ROUND = (1.0, -1.0, 1.0)


def depth(to_centre: Expr, normal: Expr | None = None, *, per_face: bool = False) -> Expr:
    """How far a point lies below the nearest of the box's walls and their padding, metres; negative outside.

    Given is the way from the point to the box's centre, along the face normals. Where faces differ, walls are those of
    the influence box, and a distance from one counts as many times as its falloff goes into the longest of all, so that
    whatever follows knows one falloff only. With a normal along the face normals,
    surfaces that lie on a wall or beyond it and face away from the box, such as the outer side of a house's wall, count
    as far outside. Half of the way to facing away is still inside, so that a bumpy floor under a doorway stays what it
    is.
    """
    beyond = absolute(to_centre) - HALF_WIDTHS
    below = _depth_by_face(to_centre) if per_face else PADDING - greatest(beyond)
    if normal is None:
        return below
    facing_away = maximum(multiply_add(normal * -1.0, sign(to_centre), -0.5), 0.0)
    on_wall = clamp(beyond / BOUNDARY + 2.0)  # 1 from one boundary's width below the wall on
    return below - greatest(facing_away * on_wall) * FAR


def _depth_by_face(to_centre: Expr) -> Expr:
    low = (to_centre - HALF_WIDTHS - REACH_LOW) * STEEPNESS_LOW
    high = (to_centre * -1.0 - HALF_WIDTHS - REACH_HIGH) * STEEPNESS_HIGH
    return greatest(maximum(low, high)) * -1.0


def fade_by_normal(below: Expr, from_capture: Expr) -> Expr:
    """How much of a surface its normal leaves: all of it deep in the influence, or where it faces the capture point.

    As Unity's HDRP has it ("Blend Normal Distance"): surfaces start to fade where the cosine of their normal with the
    way from the capture point exceeds 0.2 and are gone at 0.6. There that begins at a border within the influence; here
    it grows from there to the influence's own border, so that nothing steps. Near the capture point the way is as short
    as it is, so that its direction does not step either.
    """
    cosine = dot(NORMAL, from_capture) / maximum(length(from_capture), NORMAL_FADE)
    facing_away = clamp(multiply_add(cosine, 2.5, -0.5))
    near_border = clamp(1.0 - below / NORMAL_FADE)
    return 1.0 - facing_away * near_border


def faded(below: Expr, falloff: Expr) -> Expr:
    """1 inside an influence volume, fading smoothly to 0 over the falloff outside it; from the depth in metres."""
    linear = clamp(1.0 + below / falloff)
    return linear * linear * (3.0 - 2.0 * linear)


LEAST_SPREAD, MOST_SPREAD = 0.35, 1.5


def spread(way: Expr) -> Expr:
    """The roughness of the level to be shown, over the surface's: things near a rough surface are reflected sharper.

    A narrow lobe of GGX alpha covers alpha times the distance of what it meets, and a level's covers alpha times the
    distance from the capture point; so alpha, the square of the roughness, counts as often as one goes into the other.

    Args:
        way: from the capture point to what the ray meets, over the ray's length.
    """
    return clamp(sqrt(1.0 / maximum(length(way), _NEAR_CAPTURE)), LEAST_SPREAD, MOST_SPREAD)


_NEAR_CAPTURE = 1e-6  # of the ray's length


def lookup(effects: LookupEffects, direction: Expr = MIRRORED, position: Expr = POSITION) -> dict[str, Expr]:
    """Where to look in the probe's picture for what a ray from a surface meets.

    Args:
        effects: what is computed.
        direction: of the ray, world space, unit; by default the reflected view.
        position: where the ray starts, world space, metres.

    Returns:
        "Direction": in world space, or along the box's axes where the picture is stretched to it; not normalised;
        "Weight": how much the influence leaves of the probe, 0 … 1; where its weight or normals count too, "Presence":
        how much these leave; where it hardens, "Spread" of `spread`. With relief what is to be found out first instead
        of a direction: "Exit" and "Aside" of `relief.met`; `relieved` gives the rest.
    """
    presence: list[Expr] = [PROBE_WEIGHT] if effects.weighted else []
    if effects.correction is Correction.NONE:
        along = Section("Along the box's axes", along_face_normals(Correction.ORIENTED_BOX, direction))
        return {"Direction": along if effects.stretched else direction, "Weight": lift(1.0), **_presence(presence)}
    to_centre = CENTRE - position
    to_capture = CAPTURE_POINT - position if effects.offset else to_centre
    q = Section("Along the box's axes", along_face_normals(effects.correction, to_centre))
    d = Section("Along the box's axes", along_face_normals(effects.correction, direction))
    near = Section("Exit from the box", nearness(q, d, on_walls=effects.on_walls))
    # (hit − B) / t with hit = P + t·direction
    if effects.stretched:
        way: Expr = PARALLAX(Direction=d, Aside=q * near)["Direction"]
        corrected = Section("Stretched to the box", way * stretch(effects.correction))
        uncorrected = d * _OWN_WAY_ROUND if effects.correction is Correction.TURNED_BOX else d
    else:
        met = PARALLAX(Direction=direction, Aside=to_capture * near)["Direction"]
        way = corrected = Section("Direction from the capture point", met)
        uncorrected = direction
    sharpness: dict[str, Expr] = {}
    if effects.hardening and not effects.steps:
        sharpness["Spread"] = Section("Contact hardening", spread(way))
    normal = along_face_normals(effects.correction, NORMAL) if effects.facing else None
    below = depth(q, normal, per_face=effects.per_face)
    if effects.by_normal:
        presence.append(Section("Influence", fade_by_normal(below, to_capture * -1.0)))
    if effects.steps:
        aside = Section("Way to the capture point", to_capture * near)
        fading = lift(1.0) if effects.outside is None else Section("Influence", faded(below, FALLOFF))
        return {"Exit": near, "Aside": aside, "Weight": fading, **_presence(presence)}
    if effects.outside is None:
        return {"Direction": corrected, "Weight": lift(1.0), **_presence(presence), **sharpness}
    weight = Section("Influence", faded(below, FALLOFF))
    if effects.outside is not Outside.UNCORRECTED:
        return {"Direction": corrected, "Weight": weight, **_presence(presence), **sharpness}
    turned = Section("Influence", mix(uncorrected, normalize(corrected), weight))
    sharpness = {name: mix(1.0, value, weight) for name, value in sharpness.items()}
    return {"Direction": turned, "Weight": lift(1.0), **_presence(presence), **sharpness}


def relieved(effects: LookupEffects, found: Mapping[str, Expr], direction: Expr) -> dict[str, Expr]:
    """What a lookup with relief is without: `lookup` gives what is found, and the ray's direction is that of there."""
    met = relief.met(direction, found["Aside"], found["Exit"], effects.steps, effects.refinements)
    place = met["Place"]
    seen = PARALLAX(Direction=direction * place, Aside=found["Aside"])["Direction"]
    way = Section("Direction from the capture point", seen)
    kept = {name: found[name] for name in ("Weight", "Presence") if name in found} | {"Seen": met["Seen"]}
    hardened: dict[str, Expr] = {}
    if effects.hardening:
        hardened["Spread"] = Section("Contact hardening", spread(way * (1.0 / place)))
    if effects.outside is not Outside.UNCORRECTED:
        return {"Direction": way, **kept, **hardened}
    turned = Section("Influence", mix(direction, normalize(way), found["Weight"]))
    hardened = {name: mix(1.0, value, found["Weight"]) for name, value in hardened.items()}
    return {**kept, "Direction": turned, "Weight": lift(1.0), **hardened}


def _presence(factors: list[Expr]) -> dict[str, Expr]:
    return {"Presence": reduce(mul, factors)} if factors else {}


def _off_poles() -> Expr:
    aside = operation(Op.ADD, DIRECTION, (1e-15, 0.0, 0.0))  # straight up and down have an azimuth too
    limit = length(aside * (1.0, 1.0, 0.0)) * STEEPEST
    lowest, highest = multiply_add(limit, (0.0, 0.0, -1.0), _NO_LOWER), multiply_add(limit, (0.0, 0.0, 1.0), _NO_UPPER)
    return clamp(aside, lowest, highest)


_COSINE_ERROR = 2.25 * 2.0**-24  # z / length in float32: a division and a length of half an ulp each, and a little more
_NO_UPPER, _NO_LOWER = (1e30, 1e30, 0.0), (-1e30, -1e30, 0.0)  # of the horizontal components


OFF_POLES = Formula("Off Poles", {"Direction": _off_poles()})
"""A direction kept out of the first and last half texel of an equirectangular picture, of the same azimuth.

Cycles repeats environment textures over the poles: nearer to one it mixes in the row of the other. "Steepest" is
`steepest_slope` of the picture's height; the direction is in world space and not normalised.
"""


def steepest_slope(height: int) -> float:
    """z over the horizontal length of the steepest directions that read only their own side of a picture.

    Cycles finds the angle θ from the pole by an arc cosine. Where that is off by δ, θ² is off by 2 δ: so θ² must exceed
    that of half a texel, in a picture of `height` rows, by as much.
    """
    return 1.0 / math.tan(math.hypot(math.pi / (2.0 * height), math.sqrt(2.0 * _COSINE_ERROR)))


def read_picture(picture: str, height: int, direction: Expr) -> Expr:
    """The radiance of a picture of `height` rows along a world-space direction, right at the poles too."""
    return Sample(picture, OFF_POLES(Direction=direction, Steepest=steepest_slope(height))["Direction"])


@cache
def depth_formula(correction: Correction, per_face: bool = False) -> Formula:
    """`depth` of a surface that has neighbours in other boxes."""
    q, normal = (along_face_normals(correction, v) for v in (CENTRE - POSITION, NORMAL))
    title = f"Depth, {correction.words}" + ", per face" * per_face
    return Formula(title, {"Depth": depth(q, normal, per_face=per_face)})


@cache
def lookup_formula(effects: LookupEffects) -> Formula:
    """`lookup` along the input "Direction", from the input "Offset" beside the surface, to be shared by all probes."""
    return Formula(f"Lookup, {effects.label}", lookup(effects, DIRECTION, POSITION + OFFSET))


def found_along(effects: LookupEffects, direction: Expr, known: Mapping[str, Operand] | None = None) -> dict[str, Expr]:
    """The outputs of `lookup` by name, of a shared formula, which a direction and known values are given to.

    With relief they read the picture `relief.PICTURE`.
    """
    calls = lookup_formula(effects).at({**(known or {}), "Direction": direction})
    found: dict[str, Expr] = {name: calls[name] for name in calls.formula.outputs}
    return relieved(effects, found, direction) if effects.steps else found


def probe(
    effects: LookupEffects,
    heights: Mapping[str, int],
    known: Mapping[str, Operand] | None = None,
    *,
    shares: bool = False,
) -> Formula:
    """What a probe shows along a ray from a point, the input "Direction": from the point to the radiance.

    Args:
        effects: of the lookup.
        heights: the rows of its pictures, by the name of the output that reads them.
        known: values of inputs that are the same for all points, such as "Padding"; the others stay inputs.
        shares: whether a surface chooses between this probe and others, which requires to know how deep it lies in it.

    Returns:
        A formula with a radiance for each picture, which it samples under the output's name; with "Weight" where
        surfaces keep some of their own lobe; with "Depth" of `depth_formula` where it shares, and with "Seen" of
        `relief.met` where it has relief too; and with "Spread" of `spread` where it hardens.
    """
    found = found_along(effects, lift((known or {}).get("Direction", DIRECTION)), known)
    corrected = effects.correction is not Correction.NONE
    outputs = {}
    for name, height in heights.items():
        radiance = Section("Pictures", read_picture(name, height, found["Direction"]))
        blackens = corrected and effects.outside is Outside.BLACK
        outputs[name] = radiance * found["Weight"] if blackens else radiance
    left = [found["Weight"]] if corrected and effects.outside is Outside.OWN else []
    left += [found["Presence"]] if effects.weighted or (corrected and effects.by_normal) else []
    if left:
        outputs["Weight"] = reduce(mul, left)
    if corrected and effects.hardening:
        outputs["Spread"] = found["Spread"]
    if shares:
        box = Correction.ORIENTED_BOX if effects.correction is Correction.NONE else effects.correction
        outputs["Depth"] = depth_formula(box, effects.per_face).at(known or {})["Depth"]
        if effects.steps:
            outputs["Seen"] = found["Seen"]
    return Formula("Probe", outputs)
