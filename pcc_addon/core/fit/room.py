"""The box that fits a room, from what is seen from a point."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from ..errors import ProbeError
from ..probe import Box
from ..words import listed
from .cloud import Cloud, cloud_of
from .frames import leaning_frame, own_axes, upright_frames
from .misfit import exits, misfit
from .records import WALL_NAMES, Fit, Wall
from .refine import area_on_walls, refined
from .walls import Room, room_along

_LEANS = np.cos(np.radians(0.3))  # of an axis that counts as upright
_CLEARLY = 1.15  # how much more wall a leaning room must have than an upright one
_LOST, _LOST_IN = 3, 0.1  # walls, and how much of the box: who sees less of them is not in the room
_MUCH_BEYOND, _MUCH_EMPTY = 0.03, 0.1  # shares of what is seen that are worth a word
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Fitted:
    """A box from one survey.

    Attributes:
        box: it.
        cloud: what was seen.
        walls: six, as `records.WALL_NAMES`.
        leaning: whether it is not upright.
        area: square metres of what is seen that lie on it.
    """

    box: Box
    cloud: Cloud
    walls: tuple[Wall, ...]
    leaning: bool
    area: float

    @property
    def found(self) -> int:
        """How many walls there are."""
        return sum(wall.found for wall in self.walls)

    @property
    def share(self) -> float:
        """Of the box's surface, how much is seen to be wall."""
        x, y, z = self.box.half_extents
        return self.area / (8.0 * float(x * y + y * z + z * x))

    @property
    def is_lost(self) -> bool:
        """Whether so little of a room is seen that the point may be in furniture or outside."""
        return self.found < _LOST or self.share < _LOST_IN or not self.holds(self.cloud.point)

    def holds(self, point: np.ndarray) -> bool:
        """Whether a point (3,), world space, is in the box."""
        return bool((np.abs(self.box.coordinates(point[None])[0]) <= self.box.half_widths).all())


def fit_room(probe: str, drawn: Box, nearness: np.ndarray, point: np.ndarray) -> Fitted:
    """The box of the room around a point, near the one that was drawn.

    Walls are looked for from 0.4 to 2.2 drawn half extents from the drawn centre, turned however about the vertical; a
    room that leans is fitted as such where far more of what is seen lies on it then.

    Args:
        probe: its name, for errors.
        drawn: the box to start from.
        nearness: (h, 2h) 1/metres, as `bake.faces.survey` gives it.
        point: (3,) world space, metres: from where.

    Raises:
        ProbeError: nothing is seen at all.
    """
    cloud = cloud_of(nearness, point)
    if not cloud.seen.any():
        x, y, z = point
        raise ProbeError(
            f"probe '{probe}': nothing is seen from its capture point ({x:.2f}, {y:.2f}, {z:.2f}); move the probe into "
            "the room, or show the room in renders"
        )
    start = own_axes(drawn.axes)
    upright = [_fitted(cloud, drawn, axes, False) for axes in upright_frames(cloud, start, _UP)]
    best = most_seen(cloud, upright)
    own_up = start[:, np.abs(start[2]).argmax()]
    leaning = [leaning_frame(cloud, best.axes)]
    if abs(own_up[2]) < _LEANS:
        leaning += [leaning_frame(cloud, axes) for axes in upright_frames(cloud, start, own_up)]
    leaning = [axes for axes in leaning if np.abs(axes[2]).max() < _LEANS]
    if leaning:
        other = most_seen(cloud, [_fitted(cloud, drawn, axes, True) for axes in leaning])
        if area_on_walls(cloud, other) > _CLEARLY * area_on_walls(cloud, best):
            best = other
    box = box_of(cloud, best)
    leans = bool(np.abs(best.axes[2]).max() < _LEANS)
    return Fitted(box, cloud, _walls(cloud, drawn, box, best), leans, area_on_walls(cloud, best))


def fit_of(probe: str, before: Fitted, after: Fitted, drawn: Box) -> Fit:
    """The record of a fit.

    Args:
        before: from the drawn capture point.
        after: from the one that was chosen.
        drawn: the box before.
    """
    turn = float(np.degrees(np.arccos(np.clip((np.trace(_turn(drawn, after.box)) - 1.0) / 2.0, -1.0, 1.0))))
    return Fit(
        probe,
        drawn,
        after.box,
        _triple(before.cloud.point),
        _triple(after.cloud.point),
        misfit(drawn, before.cloud),
        misfit(after.box, after.cloud),
        after.walls,
        turn,
        after.leaning,
        tuple(_warnings(before, after)),
    )


def _triple(point: np.ndarray) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])


def _turn(before: Box, after: Box) -> np.ndarray:
    return own_axes(after.axes) @ own_axes(before.axes).T


def _fitted(cloud: Cloud, drawn: Box, axes: np.ndarray, leaning: bool) -> Room:
    middle = (drawn.centre - cloud.point) @ axes
    return fitted(cloud, axes, np.stack([middle - drawn.half_widths, middle + drawn.half_widths]), leaning)


def fitted(cloud: Cloud, axes: np.ndarray, ends: np.ndarray, leaning: bool) -> Room:
    """The walls of a room along axes that are nearly its own, near where they were drawn.

    Args:
        axes: (3, 3) unit columns.
        ends: (2, 3) metres along them from the cloud's point: of the box that was drawn.
        leaning: as for `refined`.
    """
    room = room_along(cloud, axes, ends)
    if _LOST <= room.found.sum() < 6:  # the others say better than the drawing where it may be
        room = room_along(cloud, axes, room.ends)
    return refined(cloud, room, leaning)


def most_seen(cloud: Cloud, rooms: list[Room]) -> Room:
    """The room that most of what is seen lies on; the first of equals."""
    return max(rooms, key=lambda room: area_on_walls(cloud, room))


def box_of(cloud: Cloud, room: Room) -> Box:
    """The box of a room."""
    matrix = np.eye(4)
    matrix[:3, :3] = room.axes * (0.5 * (room.ends[1] - room.ends[0]))
    matrix[:3, 3] = cloud.point + room.axes @ room.ends.mean(0)
    return Box(tuple(float(v) for v in matrix.ravel()))


def _walls(cloud: Cloud, drawn: Box, box: Box, room: Room) -> tuple[Wall, ...]:
    leaves, which = exits(box, cloud)
    off = cloud.distances - leaves
    tolerance = 0.01 + 0.001 * leaves
    found = []
    for axis, end in product(range(3), range(2)):
        name = WALL_NAMES[2 * axis + end]
        rays = which == 2 * axis + end
        total = max(float(cloud.solid_angles[rays].sum()), 1e-300)
        seen, covered, beyond = (
            float(cloud.solid_angles[rays & chosen].sum()) / total
            for chosen in (np.abs(off) <= tolerance, off < -tolerance, off > tolerance)
        )
        sign = 1.0 if end else -1.0
        away = room.axes[:, axis] @ (cloud.point - drawn.centre) + room.ends[end, axis]
        moved = sign * away - drawn.half_widths[axis]
        found.append(Wall(name, bool(room.found[end, axis]), float(moved), seen, covered, beyond))
    return tuple(found)


def _warnings(before: Fitted, after: Fitted) -> list[str]:
    said = []
    kept = [wall for wall in after.walls if not wall.found]
    if after.is_lost:
        near = float(np.median(after.cloud.distances[after.cloud.seen]))
        said.append(
            f"{after.found} walls are found, {after.share:.0%} of the box is seen to be wall, half of what is seen is "
            f"nearer than {near:.2f} m: the capture point may be in furniture or outside of the room; move it and fit "
            "again"
        )
    elif before.is_lost or not after.holds(before.cloud.point):
        moved = not np.array_equal(before.cloud.point, after.cloud.point)
        said.append(
            "the capture point was in furniture or outside of the room; the new one is not"
            if moved
            else "the capture point sees little of the room: the box was found from elsewhere"
        )
    for sort, why in ((True, "open"), (False, "out of reach or behind furniture")):
        names = [wall.name for wall in kept if (wall.open > 0.5) == sort]
        if names:
            said.append(f"{listed(names)} {'is' if len(names) == 1 else 'are'} as drawn: {why}")
    beyond = misfit(after.box, after.cloud).beyond
    if beyond > _MUCH_BEYOND:
        said.append(
            f"{beyond:.0%} of what is seen lies beyond the box: the room is no box (as an L-shaped one), or doors are "
            "open"
        )
    empty = 1.0 - float(after.cloud.solid_angles[after.cloud.seen].sum()) / float(after.cloud.solid_angles.sum())
    if empty > _MUCH_EMPTY:
        said.append(f"nothing is seen in {empty:.0%} of all directions: the room is open there")
    if after.leaning:
        said.append("the walls are not upright: the box leans with them")
    return said
