"""Which planes are the six walls of a room, for axes that are given."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from .cloud import FAR, Cloud

_ALONG = np.cos(np.radians(4.0))  # of a normal with its axis, that a wall may be there
_COARSE, _FINE = 0.01, 0.001  # metres, of planes that are told apart, first and at last
_PLANES, _CLEAR = 12, 3.0  # how many are tried for a wall, and how far apart in those
_NEAREST, _FARTHEST = 0.4, 2.2  # where walls are looked for: from the drawn centre, in drawn half extents
_LEAST_OF_FACE, _LEAST_TEXELS = 0.002, 8  # what a plane must have to be tried
_LEAST_CLOSING, _LEAST_OPEN = 0.01, 0.05  # how much of the wall must lie on one that closes the room, and on another
_SHARP = 0.25  # how much of an uneven wall must lie on one plane for that to be the wall
_ON, _ON_SHARP, _ON_FAR = 0.02, 0.002, 0.1  # metres that count as on a plane, first and at last; so much more a metre
_BAND = 0.15  # of a face's size: how wide its border is
_CLOSED_BORDER, _CLOSED_WHOLE = 0.7, 0.5  # how much of a wall must end what passes nothing before it
_CUPBOARD = 0.8  # metres: what lies so little behind a plane is room behind furniture, not another room
_OTHER_ROOM = 0.5  # what counts of things farther behind: they may be seen through a door or a window
_LEAST_BORDER = 0.03  # of a border must be free of furniture to tell anything
_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class Room:
    """A box around a capture point.

    Attributes:
        axes: (3, 3) float64, unit columns, world space.
        ends: (2, 3) float64, metres along the axes from the capture point: low and high.
        found: (2, 3) bool: whether walls are there, as opposed to where the box was drawn.
        sharp: (2, 3) bool: whether walls are so even that things a few millimetres before them are told apart.
        upright: which axis is vertical.
    """

    axes: np.ndarray
    ends: np.ndarray
    found: np.ndarray
    sharp: np.ndarray
    upright: int


@dataclass(frozen=True, eq=False)
class _View:
    """A cloud along the axes of a room: what is (n, 3) is along these, what is (n,) as the cloud has it."""

    ways: np.ndarray
    positions: np.ndarray
    normals: np.ndarray
    distances: np.ndarray
    solid_angles: np.ndarray
    areas: np.ndarray


def room_along(cloud: Cloud, axes: np.ndarray, drawn: np.ndarray) -> Room:
    """The room with these axes: a plane for each wall, or where it was drawn.

    Furniture has planes too, and so has what lies beyond a door. A wall is the innermost plane that closes the room:
    most of what comes by nothing nearer ends on it, above all along its border with the ceiling and the other walls,
    where cupboards leave a gap and where doors and windows are seldom.

    Args:
        axes: (3, 3) unit columns.
        drawn: (2, 3) metres along them from the capture point: the ends of the box that was drawn.
    """
    view = _View(
        cloud.ways @ axes,
        cloud.positions @ axes,
        cloud.normals @ axes,
        cloud.distances,
        cloud.solid_angles,
        cloud.areas,
    )
    upright = int(np.abs(axes[2]).argmax())
    up = 1 if axes[2, upright] > 0.0 else 0
    planes = {wall: _planes(view, wall, drawn) for wall in product(range(2), range(3))}
    room = Room(axes, drawn.copy(), np.zeros((2, 3), bool), np.zeros((2, 3), bool), upright)
    for wall, found in planes.items():
        if found:
            room = _with(room, wall, found[0], False)
    order = sorted(planes, key=lambda wall: (wall[1] != upright, wall[1], wall[0]))
    for _ in range(_ROUNDS):
        before = room
        for wall in order:
            room = _with(room, wall, *_closing(view, room, wall, planes[wall], up))
            if not room.found[wall]:
                room.ends[wall] = drawn[wall]
        if np.array_equal(before.ends, room.ends) and np.array_equal(before.found, room.found):
            break
    return room


def _with(room: Room, wall: tuple[int, int], place: float | None, sharp: bool) -> Room:
    """The room with a wall at a distance from the capture point; None: nowhere."""
    ends, found, sharps = room.ends.copy(), room.found.copy(), room.sharp.copy()
    found[wall], sharps[wall] = place is not None, sharp
    if place is not None:
        ends[wall] = place * _sign(wall)
    return replace(room, ends=ends, found=found, sharp=sharps)


def _sign(wall: tuple[int, int]) -> float:
    return 1.0 if wall[0] else -1.0


def facing(normals: np.ndarray, wall: tuple[int, int]) -> np.ndarray:
    """(n,) bool: which normals (n, 3), along a room's axes, may be those of a wall (end, axis)."""
    return -_sign(wall) * normals[:, wall[1]] > _ALONG


def _planes(view: _View, wall: tuple[int, int], drawn: np.ndarray) -> list[float]:
    """Distances from the capture point at which much lies that faces as a wall would; the one with most area first."""
    _, axis = wall
    half, centre = 0.5 * (drawn[1] - drawn[0]), 0.5 * (drawn[1] + drawn[0])
    chosen = facing(view.normals, wall) & (view.areas > 0.0)
    along, areas = _sign(wall) * view.positions[chosen, axis], view.areas[chosen]
    reach = along - _sign(wall) * centre[axis]
    within = (reach >= _NEAREST * half[axis]) & (reach <= _FARTHEST * half[axis])
    others = [k for k in range(3) if k != axis]
    least = _LEAST_OF_FACE * 4.0 * half[others[0]] * half[others[1]]
    return _heaps(along[within], areas[within], _COARSE, least)


def _heaps(along: np.ndarray, areas: np.ndarray, bin_width: float, least: float) -> list[float]:
    """Places (n,) around which many are, the heaviest first, each heavier than `least`."""
    if not len(along):
        return []
    start = along.min() - 2.0 * bin_width
    bins = ((along - start) / bin_width).astype(np.intp)
    found = []
    for _ in range(_PLANES):
        counts = np.bincount(bins, areas, bins.max() + 3)
        counts = counts + np.roll(counts, 1) + np.roll(counts, -1)
        place = start + (counts.argmax() + 0.5) * bin_width
        for width in (1.5 * bin_width, bin_width):
            near = (np.abs(along - place) <= width) & (areas > 0.0)
            if areas[near].sum() > 0.0:
                place = float((along[near] * areas[near]).sum() / areas[near].sum())
        if areas[near].sum() < least or not near.any():
            break
        if near.sum() >= _LEAST_TEXELS:
            found.append(place)
        areas = np.where(np.abs(along - place) <= _CLEAR * bin_width, 0.0, areas)
    return found


def _closing(view: _View, room: Room, wall: tuple[int, int], planes: list[float], up: int) -> tuple[float | None, bool]:
    """The distance of the innermost plane that closes the room; else of that which most of it is on, if any.

    And whether that is sharp: of all that is within a few centimetres, so much is within two millimetres of one plane
    that closes the room that this is the wall, and the rest a rug, a frame or a skirting.
    """
    place, share = _innermost(view, room, wall, planes, up, _ON, _LEAST_CLOSING)
    if place is None:
        return None, False
    along = _sign(wall) * view.positions[:, wall[1]]
    near = facing(view.normals, wall) & (view.areas > 0.0) & (np.abs(along - place) <= _CLEAR * _COARSE)
    areas = view.areas[near]
    fine = _heaps(along[near], areas, _FINE, _SHARP * float(areas.sum()))
    exact, _ = _innermost(view, room, wall, fine, up, _ON_SHARP, _SHARP * share)
    return (place, False) if exact is None else (exact, True)


def _innermost(
    view: _View, room: Room, wall: tuple[int, int], planes: list[float], up: int, tolerance: float, least: float
) -> tuple[float | None, float]:
    """Of some planes, the innermost that closes the room and has at least this share of the wall, and its share."""
    best, most = None, max(_LEAST_OPEN, least)
    for place in sorted(planes):
        closed, share = _judged(view, room, wall, place, up, tolerance)
        if closed and share >= least:
            return place, share
        if share > most:
            best, most = place, share
    return best, most


def _judged(
    view: _View, room: Room, wall: tuple[int, int], place: float, up: int, tolerance: float
) -> tuple[bool, float]:
    """Whether a plane closes the room, and how much of the wall that it would be is on it."""
    _, axis = wall
    toward = _sign(wall) * view.ways[:, axis]
    ahead = toward > 1e-9
    meets = place / np.where(ahead, toward, 1.0)  # metres along the ray to the plane
    inside, border = ahead.copy(), np.zeros(len(toward), bool)
    for other in range(3):
        if other == axis:
            continue
        where = view.ways[:, other] * meets
        low, high = room.ends[0, other], room.ends[1, other]
        inside &= (where > low) & (where < high)
        for k, edge in enumerate((where - low, high - where)):
            on_floor = other == room.upright and k != up  # where furniture stands
            if not on_floor:
                border |= edge < _BAND * (high - low)
    weights = np.where(inside, view.solid_angles * meets**2 / np.where(ahead, toward, 1.0), 0.0)
    reaches = toward * view.distances
    thick = tolerance * (1.0 + _ON_FAR * view.distances)
    on = (np.abs(reaches - place) <= thick) & facing(view.normals, wall)
    behind = reaches > place + thick
    counts = np.where(reaches <= place + _CUPBOARD, 1.0, _OTHER_ROOM)
    if axis == room.upright:  # no doors and windows there, but tables below eyes
        counts = np.where(view.distances < FAR, 1.0, _OTHER_ROOM)
    counts = np.where(on, 1.0, np.where(behind, counts, 0.0))

    def closed(among: np.ndarray) -> float:
        free = float((counts * weights)[among].sum())
        return float(weights[among & on].sum()) / free if free > 0.0 else 0.0

    band, whole = inside & border, weights.sum()
    free = weights[band & (on | behind)].sum()
    tells = free >= _LEAST_BORDER * max(weights[band].sum(), 1e-300)
    share = float(weights[on].sum() / max(whole, 1e-300))
    return closed(inside) >= _CLOSED_WHOLE and (not tells or closed(band) >= _CLOSED_BORDER), share
