"""Relief: where a ray meets what was captured, and not only the box around it.

Beside its radiance a probe has its nearness, 1/metres from the capture point to what it sees. A ray is followed from
where it starts to the box's wall, in steps that grow from its start. Seen from the capture point a place on it is
behind something where it is farther than what was captured that way. The first step that goes behind something is
halved some times; what is found there is shown. Where none does the box's wall is, as without relief. Nothing is drawn
by chance, so that nothing swims from frame to frame.

Places on a ray are told as shares of its way to the wall: 0 where it starts, 1 on the wall. With d the ray's unit
direction, t its way to the wall, c the way from the start to the capture point, a place s looks s·d − c/t from there,
over t; it is behind what was captured with the nearness n where that vector's length times n exceeds 1/t. So nothing is
divided by what may be 0.

Source: relief mapping's linear and then binary search (Policarpo, Oliveira and Comba 2005), in an image of distances
from a point (Szirmay-Kalos et al. 2005).
"""

from __future__ import annotations

import numpy as np

from ..expression import (
    Expr,
    Formula,
    Op,
    Sample,
    Section,
    clamp,
    length,
    lift,
    maximum,
    minimum,
    mix,
    multiply_add,
    operation,
    scalar,
    sign,
    vector,
)

PICTURE = "Nearness"
"""The picture that a probe's shader reads under this name: 1/metres, three times the same."""

DEPARTS = 1e-3
"""What was captured departs from the box where its nearness does by more than this share of the box's."""

RAY = vector("Ray")  # unit, world space
ASIDE = vector("Aside")  # from where the ray starts to the capture point, over the ray's way to the wall
EXIT = scalar("Exit")  # 1 over the ray's way to the wall, 1/metres
PLACE = scalar("Place")
WAY = vector("Way")
CAPTURED = scalar("Captured")  # nearness of what was captured that way, 1/metres
BEFORE, BEHIND = (
    scalar("Before"),
    scalar("Behind"),
)  # whether the place before is behind something, and this one; 0 or 1
LAST = scalar("Last Place")
LOW, HIGH = scalar("Low"), scalar("High")

_GROWTH = 1.5  # the power of the share of steps: steps near the start are short, as most that matters is near
_HIDDEN = 0.1  # of the distance, beyond `_START`, from which on a place is hidden for certain
_START = 0.02  # of the distance: what starts on a surface that the capture point sees is not behind it by rounding
_BEYOND = 0.02  # of the distance, by which a ray is followed on to tell a surface from the edge of something nearer


def _behind(slack: float = 0.0) -> Expr:
    limit = EXIT * (1.0 + slack) if slack else EXIT
    return maximum(sign(operation(Op.SUBTRACT, length(WAY) * CAPTURED, limit)), 0.0)


def _way() -> Expr:
    # Straight onto the capture point there is no direction; to look up anything at all is right.
    return multiply_add(RAY, PLACE, operation(Op.SUBTRACT, (1e-15, 0.0, 0.0), ASIDE))


LOOK = Formula("Relief Look", {"Way": _way()})
"""Where a place on the ray lies, seen from the capture point, over the ray's way to the wall."""

START = Formula("Relief Start", {"Behind": _behind(), "Hidden": _behind(_START)})
"""Whether the ray starts behind something, were it by rounding, and whether by more than that.

Between two texels of a corner the walls seem nearer than they are. What starts there must not seem to go behind them.
"""


def _step() -> Formula:
    behind = _behind()
    enters = maximum(behind - BEFORE, 0.0)
    low, high = (minimum(known, mix(1.0, place, enters)) for known, place in ((LOW, LAST), (HIGH, PLACE)))
    return Formula("Relief Step", {"Behind": behind, "Low": low, "High": high})


STEP = _step()
"""One more place: whether it is behind something, and between which two places the ray first goes there."""


def _halve() -> Formula:
    behind = _behind()
    return Formula("Relief Halve", {"Low": mix(PLACE, LOW, behind), "High": mix(HIGH, PLACE, behind)})


HALVE = _halve()
"""The half of an interval in which the ray goes behind something."""

MIDDLE = Formula("Relief Middle", {"Place": (LOW + HIGH) * 0.5})


BEYOND = Formula("Relief Beyond", {"Way": operation(Op.MULTIPLY_ADD, RAY, length(WAY) * _BEYOND, WAY)})
"""A little farther along the ray than where it ends.

Within one texel of an edge nearness goes from that of what is nearer to that of what is behind it, and a ray that
passes behind the edge ends somewhere between. Beyond the edge it is deep behind what was captured, beyond a surface
hardly.
"""


def _seen() -> Expr:
    hidden = operation(Op.SUBTRACT, length(WAY) * CAPTURED, EXIT * (1.0 + _START + _BEYOND))
    return (1.0 - clamp(hidden / (EXIT * _HIDDEN))) * (1.0 - BEHIND)


SEEN = Formula("Relief Seen", {"Seen": _seen()})
"""Whether the capture point sees the place that a ray ends at, 0 … 1, judged a little beyond it; 0 where something
before it was captured.

What starts behind something may meet whatever is hidden there, before it comes out.
"""


def places(steps: int) -> list[float]:
    """(steps) of 0 … 1, ascending, the last one 1: where a ray is looked at."""
    return [((k + 1) / steps) ** _GROWTH for k in range(steps)]


def met(ray: Expr, aside: Expr, leaves: Expr, steps: int, refinements: int) -> dict[str, Expr]:
    """Where a ray meets what was captured.

    Args:
        ray: its unit direction, world space.
        aside: from where it starts to the capture point, over its way to the wall.
        leaves: 1 over its way to the wall, 1/metres.
        steps: places that are looked at.
        refinements: how often the interval between two of them is halved.

    Returns:
        "Place": which share of its way to the wall it goes, 0 … 1; 1 where it meets nothing. "Seen": whether the
        capture point sees that place, and the start, 0 … 1.
    """

    def seen(place: Expr) -> dict[str, Expr]:
        way = LOOK(Ray=ray, Aside=aside, Place=place)["Way"]
        return {"Way": way, "Captured": Sample(PICTURE, way).x, "Exit": leaves}

    with_start = START(**seen(lift(0.0)))
    behind, low, high, last = with_start["Behind"], lift(1.0), lift(1.0), lift(0.0)
    for share in places(steps):
        place = lift(share)
        found = STEP(**seen(place), Before=behind, Low=low, High=high, Place=place, Last_Place=last)
        behind, low, high, last = found["Behind"], found["Low"], found["High"], place
    for _ in range(refinements):
        place = MIDDLE(Low=low, High=high)["Place"]
        found = HALVE(**seen(place), Low=low, High=high, Place=place)
        low, high = found["Low"], found["High"]
    way = BEYOND(Ray=ray, Way=LOOK(Ray=ray, Aside=aside, Place=high)["Way"])["Way"]
    shown = SEEN(Way=way, Captured=Sample(PICTURE, way).x, Exit=leaves, Behind=with_start["Hidden"])["Seen"]
    return {"Place": Section("Relief", high), "Seen": Section("Relief", shown)}


def departure(nearness: np.ndarray, of_box: np.ndarray) -> float:
    """The largest departure of captured nearness from that of a box's walls, over the latter; at most 10⁶.

    Args:
        nearness, of_box: (h, 2h), 1/metres, put together from faces in the same way. Where the capture point is on a
            wall or beyond it the latter is infinite or not above 0.
    """
    known = np.isfinite(nearness) & np.isfinite(of_box) & (of_box > 0.0)
    off = np.abs(np.where(known, nearness, _MOST) - np.where(known, of_box, 0.0)) / np.where(known, of_box, 1.0)
    return float(min(off.max(), _MOST))


_MOST = 1e6
