"""From where a room is looked at, and which box and which capture point are taken."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import replace
from itertools import product

import numpy as np

from ..errors import ProbeError
from ..probe import Box, ProbeSpec
from .capture_point import NOTABLY, is_clear, seen_share, suggested
from .records import Fit
from .room import Fitted, fit_of

_ASIDE = 0.4  # of a half extent: where else is looked from


def chosen(spec: ProbeSpec, look: Callable[[np.ndarray], Generator[str, None, Fitted]]) -> Generator[str, None, Fit]:
    """The fit of a probe; yields what comes next.

    One survey from its capture point and one from that which this suggests; more where the first sees no room. The
    capture point of a probe that follows an object stays, and that of given pictures is the middle of the box.

    Args:
        spec: the probe.
        look: what `room.fit_room` finds from a point (3,), world space; yields what comes next.

    Raises:
        ProbeError: nothing can be seen from the capture point.
    """
    own = yield from look(spec.capture_point)
    first = own
    for point in _elsewhere(spec.box, spec.capture_point) if own.is_lost else ():
        try:
            first = _better(first, (yield from look(point)))
        except ProbeError:  # nothing is seen from there
            continue
        if not first.is_lost:
            break
    yield "capture point"
    if spec.followed is not None:
        return fit_of(spec.name, own, replace(first, cloud=own.cloud), spec.box)
    point = first.box.centre if spec.source.stretched else suggested(first.cloud, first.box)
    if np.array_equal(point, first.cloud.point):
        return fit_of(spec.name, own, first, spec.box)
    second = yield from look(point)
    after = _settled(first, second)
    return fit_of(spec.name, own, replace(after, cloud=second.cloud) if spec.source.stretched else after, spec.box)


def _elsewhere(drawn: Box, point: np.ndarray) -> list[np.ndarray]:
    """Points (3,), world space, to look from where the capture point sees no room: the middle, then around it."""
    places = [np.zeros(3)] + [np.array([x, y, 0.0]) for x, y in product((-_ASIDE, _ASIDE), repeat=2)]
    points = [drawn.centre + drawn.axes @ place for place in places]
    return [each for each in points if np.linalg.norm(each - point) > 1e-3]


def _better(one: Fitted, other: Fitted) -> Fitted:
    """The one that sees more of a room; the first of equals."""
    return max((one, other), key=lambda each: (not each.is_lost, each.found, each.share))


def _settled(one: Fitted, other: Fitted) -> Fitted:
    """What is taken of a survey and of one from the point that it suggests: a box and a capture point, each of either.

    The box of the second, which sees more, unless it finds fewer walls; the point of the first where it is clear of
    furniture and the second does not really see notably more, or is not clear itself.
    """
    box = other if not other.is_lost and other.found >= one.found else one
    seen = [seen_share(each.cloud, box.box) for each in (one, other)]
    enough = is_clear(one.cloud, box.box) and seen[1] < seen[0] + NOTABLY
    stays = not one.is_lost and (enough or not is_clear(other.cloud, box.box))
    return replace(box, cloud=(one if stays else other).cloud)
