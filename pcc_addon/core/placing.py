"""Boxes around things."""

from __future__ import annotations

import numpy as np

from .probe import Box

_FLAT = 1e-3  # of the largest size: what is thinner is one wall
_STANDS = 2.0  # metres that a box reaches from what is flat
_PART = 0.25  # of a room's volume: what takes up less, and is not looked out of, stands in it
_SPARE = 0.05  # of a half width: so far things may reach into walls
_THICK = 0.3  # of a half extent: walls are not thicker


def around(points: np.ndarray, axes: np.ndarray, side: np.ndarray) -> Box:
    """The box along some axes around points; from what is flat it reaches 2 m to one side.

    Args:
        points: (n, 3) world space, metres.
        axes: (3, 3) unit columns.
        side: (3,) world space: a point on the side that is meant.
    """
    along = points @ axes
    low, high = along.min(0), along.max(0)
    flat = high - low <= _FLAT * (high - low).max()
    below = flat & (side @ axes < low - _FLAT)
    low, high = np.where(below, low - _STANDS, low), np.where(flat & ~below, high + _STANDS, high)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes * (0.5 * (high - low)), axes @ (0.5 * (high + low))
    return Box(tuple(float(v) for v in matrix.ravel()))


def stands_in(thing: Box, room: Box, eyes: np.ndarray) -> bool:
    """Whether a box is that of something in a room, such as a chair, and no room by itself.

    Args:
        thing, room: their boxes.
        eyes: (n, 3) world space: from where the scene is looked at.
    """
    corners = thing.centre + (np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0) @ thing.axes.T
    small = np.prod(thing.half_extents) < _PART * np.prod(room.half_extents)
    return bool(small and _within(corners, room, _SPARE).all() and not _within(eyes, thing, 0.0).any())


def contains(box: Box, place: np.ndarray) -> bool:
    """Whether a place, (3,) in world space, is in a box or on its sides."""
    return bool(_within(np.atleast_2d(place), box, _SPARE).all())


def _within(places: np.ndarray, box: Box, spare: float) -> np.ndarray:
    """(n,) bool, of places (n, 3) in world space; `spare` is a share of the box's half widths."""
    return (np.abs(box.coordinates(places)) <= (1.0 + spare) * box.half_widths).all(-1)


def lines(inner: Box, bounds: Box) -> bool:
    """Whether a box lies within bounds and comes so near to all their sides that walls may fill what is between."""
    corners = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0
    places = bounds.coordinates(inner.centre + corners @ inner.axes.T) / bounds.half_widths
    reach = np.minimum(places.max(0), -places.min(0))
    return bool((np.abs(places) <= 1.0 + _FLAT).all() and (reach >= 1.0 - _THICK).all())
