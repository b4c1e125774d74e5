"""The box of the room around a point where nobody has drawn one, from some rays: a first guess, at once."""

from __future__ import annotations

from itertools import product

import numpy as np

from ..probe import Box
from .cloud import FAR, Cloud
from .frames import upright_frames
from .room import box_of, fitted, most_seen
from .walls import Room, facing

_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))  # radians from one direction to the next
_GRAZING = 0.05  # cosine below which a surface counts as seen at this one
_LEAST = 3  # walls that make a room
_OPEN = 1.0  # metres to where nothing says how far the room reaches
_ON = 0.01  # metres from a wall that count as on it
_UP = np.array([0.0, 0.0, 1.0])


def spread_ways(count: int) -> np.ndarray:
    """(count, 3) unit directions all around, as evenly as a spiral has them."""
    steps = np.arange(count)
    z = 1.0 - (2.0 * steps + 1.0) / count
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(_GOLDEN * steps), across * np.sin(_GOLDEN * steps), z], -1)


def cloud_of_rays(point: np.ndarray, ways: np.ndarray, distances: np.ndarray, normals: np.ndarray) -> Cloud:
    """The cloud of rays that are spread evenly over all directions.

    Args:
        point: (3,) world space, metres: where they start.
        ways: (n, 3) unit.
        distances: (n,) metres; infinite where nothing is met.
        normals: (n, 3) unit, of what is met, to either side.
    """
    seen = np.isfinite(distances)
    reached = np.where(seen, distances, FAR)
    against = (normals * ways).sum(-1, keepdims=True)
    towards = np.where(seen[:, None], -np.sign(against) * normals, 0.0)
    solid_angles = np.full(len(ways), 4.0 * np.pi / len(ways))
    areas = np.where(seen, solid_angles * reached**2 / np.maximum(np.abs(against[:, 0]), _GRAZING), 0.0)
    return Cloud(np.asarray(point, np.float64), ways, reached, solid_angles, towards, areas)


def guessed_room(cloud: Cloud, axes: np.ndarray | None = None) -> Box | None:
    """The box of an upright room around a cloud's point; None where fewer than three walls say that there is one.

    An open side ends where the walls beside it do.

    Args:
        cloud: what is seen.
        axes: (3, 3) unit columns that the box's are named after; None: the world's.
    """
    start = np.eye(3) if axes is None else axes
    rooms = [fitted(cloud, frame, _first_ends(cloud, frame), False) for frame in upright_frames(cloud, start, _UP)]
    room = most_seen(cloud, rooms)
    if room.found.sum() < _LEAST:
        return None
    for end, axis in product(range(2), range(3)):
        if not room.found[end, axis]:
            room.ends[end, axis] = (1.0 if end else -1.0) * _reach_of_walls(cloud, room, end, axis)
    return box_of(cloud, room)


def _first_ends(cloud: Cloud, axes: np.ndarray) -> np.ndarray:
    """(2, 3) metres along axes: where half of the surface that faces the point each way is nearer."""
    normals, positions = cloud.normals @ axes, cloud.positions @ axes
    ends = np.array([[-_OPEN] * 3, [_OPEN] * 3])
    for end, axis in product(range(2), range(3)):
        chosen = facing(normals, (end, axis))
        if chosen.any():
            order = np.argsort(np.abs(positions[chosen, axis]))
            below = np.cumsum(cloud.areas[chosen][order])
            ends[end, axis] = positions[chosen, axis][order][np.searchsorted(below, 0.5 * below[-1])]
    return ends


def _reach_of_walls(cloud: Cloud, room: Room, end: int, axis: int) -> float:
    """How far the upright walls beside an open side reach that way, metres from the point."""
    normals, positions = cloud.normals @ room.axes, cloud.positions @ room.axes
    reach = 0.0
    for other_end, other in product(range(2), range(3)):
        if other in (axis, room.upright) or not room.found[other_end, other]:
            continue
        on = facing(normals, (other_end, other)) & (np.abs(positions[:, other] - room.ends[other_end, other]) < _ON)
        if on.any():
            reach = max(reach, float((positions[on, axis] * (1.0 if end else -1.0)).max()))
    return reach if reach > 0.0 else _OPEN
