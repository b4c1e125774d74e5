"""Which of several probes a point shows: where rooms share a material, each point shows the room that it is in.

Probes come from the largest to the smallest. A point inside one box only shows that probe alone; one inside several
shows the smallest, which fades in from its walls; one between boxes, as in a doorway, is shared by the squared
distances (Shepard 1968). So the shares add up to one and no place has a step but where a wall of one box cuts another.
"""

from __future__ import annotations

from ..expression import Formula, clamp, maximum, minimum, scalar

DEPTH = scalar("Depth")  # metres of the point below the nearest wall of this probe's box; negative outside
DISTANCE = scalar("Distance")  # metres of the point outside the nearest of the larger boxes; 0 inside one
FADE = scalar("Fade")  # metres over which a box within another fades in, above 0

START = Formula("First Probe", {"Distance": maximum(DEPTH * -1.0, 0.0)})
"""The distance for the next probe, from the depth in the first."""


def _step() -> Formula:
    outside = maximum(DEPTH * -1.0, 0.0)
    linear = clamp(DEPTH / FADE)
    inside = linear * linear * (3.0 - 2.0 * linear)
    farther = DISTANCE * DISTANCE
    share = clamp(inside + farther / (farther + outside * outside))
    return Formula("Next Probe", {"Share": share, "Distance": minimum(DISTANCE, outside)})


NEXT = _step()
"""What share of a point the next smaller probe has over those before it, and the distance for the one after."""
