"""Of several surveys of a room, which box and which capture point are taken."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from ..probe import Box
from .capture_point import NOTABLY, is_clear, seen_share
from .room import Fitted

_ASIDE = 0.4  # of a half extent: where else is looked from


def elsewhere(drawn: Box, point: np.ndarray) -> list[np.ndarray]:
    """Points (3,), world space, to look from where the capture point sees no room: the middle, then around it."""
    places = [np.zeros(3)] + [np.array([x, y, 0.0]) for x, y in product((-_ASIDE, _ASIDE), repeat=2)]
    points = [drawn.centre + drawn.axes @ place for place in places]
    return [each for each in points if np.linalg.norm(each - point) > 1e-3]


def better(one: Fitted, other: Fitted) -> Fitted:
    """The one that sees more of a room; the first of equals."""
    return max((one, other), key=lambda each: (not each.is_lost, each.found, each.share))


def settled(one: Fitted, other: Fitted) -> Fitted:
    """What is taken of a survey and of one from the point that it suggests: a box and a capture point, each of either.

    The box of the second, which begins where the first ended, unless it finds fewer walls; the point of the first where
    it is clear of furniture and the second does not really see notably more.
    """
    box = other if not other.is_lost and other.found >= one.found else one
    seen = [seen_share(each.cloud, box.box) for each in (one, other)]
    stays = not one.is_lost and is_clear(one.cloud, box.box) and seen[1] < seen[0] + NOTABLY
    return replace(box, cloud=(one if stays or not is_clear(other.cloud, box.box) else other).cloud)
