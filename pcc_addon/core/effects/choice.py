"""Which of several probes a point shows: where rooms share a material, each point shows the room that it is in.

Probes come from the largest to the smallest. A point inside one box only shows that probe alone; one inside several
shows the smallest, which fades in from its walls; one between boxes, as in a doorway, is shared by the squared
distances (Shepard 1968). Each probe covers its share by its weight, over those before it (Porter and Duff 1984), and
what no probe covers keeps the surface's own lobe; so the shares and the rest add up to one, and no place has a step but
where a wall of one box cuts another.
"""

from __future__ import annotations

from functools import cache

from ..expression import Expr, Formula, clamp, lift, maximum, minimum, scalar
from .shading import ROUGHNESS

DEPTH = scalar("Depth")  # metres of the point below the nearest wall of this probe's box; negative outside
WEIGHT = scalar("Weight")  # of this probe where it is the only one, 0 … 1
DISTANCE = scalar("Distance")  # metres of the point outside the nearest of the larger boxes; 0 inside one
COVERAGE = scalar("Coverage")  # how much of the point the probes before this one have together, 0 … 1
FADE = scalar("Fade")  # metres over which a box within another fades in, above 0
DIFFUSE_RAY = scalar("Diffuse Ray")  # 1 for rays that left a diffuse surface, else 0

START = Formula("First Probe", {"Distance": maximum(DEPTH * -1.0, 0.0)})
"""The distance for the next probe, from the depth in the first."""


def _step() -> Formula:
    outside = maximum(DEPTH * -1.0, 0.0)
    linear = clamp(DEPTH / FADE)
    inside = linear * linear * (3.0 - 2.0 * linear)
    farther = DISTANCE * DISTANCE
    covers = clamp(inside + farther / (farther + outside * outside)) * WEIGHT
    # In this order nothing is lost where the probes before have nothing: the share is then exactly one.
    coverage = covers + COVERAGE * (1.0 - covers)
    return Formula(
        "Next Probe",
        {"Share": covers / coverage, "Coverage": coverage, "Distance": minimum(DISTANCE, outside)},
    )


NEXT = _step()
"""What share the next smaller probe has of all that is covered, how much that is, and the distance for the one after.

Covered is what the probes before have, and over it this one."""


@cache
def own_share(roughness_limit: float | None) -> Formula:
    """How much of a surface keeps its own lobe, "Share": all for diffuse rays, else what no probe covers.

    The rest is "Covered".

    Args:
        roughness_limit: where the roughness varies, that from which on a surface is left to its own lobe.
    """
    covered: Expr = COVERAGE * (1.0 - DIFFUSE_RAY)
    if roughness_limit is None:
        return Formula("Own Lobe", {"Share": 1.0 - covered, "Covered": covered})
    width = _FADE_OF_ROUGHNESS * roughness_limit
    smooth = clamp((lift(roughness_limit) - ROUGHNESS) * (1.0 / width)) if width > 0.0 else lift(0.0)
    covered = covered * smooth
    title = f"Own Lobe, rougher than {roughness_limit:.6g}"
    return Formula(title, {"Share": 1.0 - covered, "Covered": covered})


_FADE_OF_ROUGHNESS = 0.1  # of the limit, over which a surface that grows rougher is handed over
