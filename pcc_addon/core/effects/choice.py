"""Which of several probes a point shows: where rooms share a material, each point shows the room that it is in.

Probes come from the lowest priority to the highest, of the same from the largest to the smallest. Each covers what its
weight says, over those before it (Porter and Duff 1984): a box within another, or that overlaps it, is shown in all of
itself and fades beyond. Boxes that are apart or touch, as rooms do, keep out of each other: a point inside one box only
shows that probe alone, one between them, as in a doorway, is shared by the squared distances (Shepard 1968). What no
probe covers keeps the surface's own lobe; so the shares and the rest add up to one.

Shepard's shares have no limit where both distances vanish, as where boxes touch. A probe therefore takes over from
those before it by and by, over a part of its fade beyond their walls. No place has a step: what a probe covers changes
by at most `steepness` a metre.
"""

from __future__ import annotations

import math
from functools import cache

from ..expression import Expr, Formula, clamp, lift, maximum, minimum, mix, scalar
from .lookup import faded
from .shading import CAPTURED, ROUGHNESS

DEPTH = scalar("Depth")  # metres of the point below the nearest wall of this probe's box; negative outside
WEIGHT = scalar("Weight")  # of this probe where it is the only one, 0 … 1
SEEN = scalar("Seen")  # whether its capture point sees what the ray meets, 0 … 1
SEEN_BEFORE = scalar("Seen Before")  # the same of the probes before
SHARE = scalar("Share")  # of this probe among what is covered so far
DISTANCE = scalar("Distance")  # metres of the point outside the nearest of the boxes before that are apart; 0 inside
OTHER = scalar("Other Distance")
COVERAGE = scalar("Coverage")  # how much of the point the probes before this one have together, 0 … 1
FADE = scalar("Fade")  # metres over which this probe fades, above 0
DIFFUSE_DEPTH = scalar("Diffuse Depth")  # how many diffuse surfaces the path to here has left
_HANDOVER = 0.2  # of the fade

OUTSIDE = Formula("Outside", {"Distance": maximum(DEPTH * -1.0, 0.0)})
"""How far outside a box a point is, from its depth in it."""

NEARER = Formula("Nearer", {"Distance": minimum(DISTANCE, OTHER)})
"""The smaller of two distances."""


def _over(covers: Expr) -> dict[str, Expr]:
    # In this order nothing is lost where the probes before have nothing: the share is then exactly one.
    coverage = covers + COVERAGE * (1.0 - covers)
    return {"Share": covers / coverage, "Coverage": coverage}


def _beside() -> Formula:
    outside = maximum(DEPTH * -1.0, 0.0)
    farther = DISTANCE * DISTANCE
    handed_over = clamp(DISTANCE / (FADE * _HANDOVER))
    return Formula("Probe Beside", _over(farther / (farther + outside * outside) * handed_over * WEIGHT))


OVER = Formula("Probe Over", _over(minimum(WEIGHT, faded(DEPTH, FADE))))
"""What share a probe has of all that is covered, and how much that is: what those before have, and over it this one.

Its weight has the fade already where it keeps surfaces their own lobe outside; else the depth says where it fades.
"""

BESIDE = _beside()
"""The same where boxes before are apart from this one."""


def handover(fade: float) -> float:
    """Metres outside the boxes before over which a box takes over: a wall of this thickness parts them."""
    return fade * _HANDOVER


def steepness(fade: float) -> float:
    """How much what a probe covers may change a metre, at most, apart from its weight.

    Depths and distances change by a metre a metre, or faster where the falloffs of faces differ. With e the distance
    from the boxes before, o that from its own, tan θ = o/e and h the handover, s = e²/(e² + o²)·min(e/h, 1) changes
    with e by at most cos²θ (1 + 2 sin²θ) ≤ 9/8 and with o by at most 2 cos³θ sin θ ≤ 3√3/8, times 1/h; beyond the
    handover by less.
    """
    return (9.0 / 8.0 + 3.0 * math.sqrt(3.0) / 8.0) / handover(fade)


YIELDING = Formula("Probe Yields", {"Weight": WEIGHT * (1.0 - (1.0 - SEEN) * SEEN_BEFORE * COVERAGE)})
"""The weight of a probe with relief: where its capture point does not see what the ray meets, it yields to those before
it what they cover and see, so that a second probe shows what the first one cannot."""

SEEN_BY_BOTH = Formula("Seen by Both", {"Seen": mix(SEEN_BEFORE, SEEN, SHARE)})
"""The same of a probe and those before it, mixed as their pictures are."""


@cache
def own_share(roughness_limit: float | None) -> Formula:
    """How much of a surface keeps its own lobe, "Share": all on paths that left a diffuse surface, else what no probe
    covers, and nothing in captures.

    The rest is "Covered".

    Args:
        roughness_limit: where the roughness varies, that from which on a surface is left to its own lobe.
    """
    covered: Expr = COVERAGE
    title = "Own Lobe"
    if roughness_limit is not None:
        width = _FADE_OF_ROUGHNESS * roughness_limit
        smooth = clamp((lift(roughness_limit) - ROUGHNESS) * (1.0 / width)) if width > 0.0 else lift(0.0)
        covered, title = covered * smooth, f"{title}, rougher than {roughness_limit:.6g}"
    covered = maximum(covered, CAPTURED) * clamp(1.0 - DIFFUSE_DEPTH)
    return Formula(title, {"Share": 1.0 - covered, "Covered": covered})


_FADE_OF_ROUGHNESS = 0.1  # of the limit, over which a surface that grows rougher is handed over
