"""Rooms made of boxes, and what is seen in them: rays by the slab method, in float64."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core import equirect
from pcc_addon.core.probe import Box


def box(centre: Sequence[float], half_extents: Sequence[float], rotation: np.ndarray | float = 0.0) -> Box:
    """A box turned by a (3, 3) rotation, or by degrees about the vertical."""
    turn = about_z(rotation) if np.ndim(rotation) == 0 else rotation
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn * np.array(half_extents), centre
    return Box(tuple(float(v) for v in matrix.ravel()))


def about_z(degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def about_x(degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


@dataclass(frozen=True)
class Place:
    """What can be seen.

    Attributes:
        inside: boxes whose union is the air: the room, and what it opens to. The first is the room that is asked for.
        things: boxes in it.
        outside: those of `inside` (by number) at whose far ends nothing is.
    """

    inside: tuple[Box, ...]
    things: tuple[Box, ...] = ()
    outside: tuple[int, ...] = ()

    @property
    def room(self) -> Box:
        return self.inside[0]

    def turned(self, rotation: np.ndarray, to: Sequence[float]) -> Place:
        """The same, turned about the origin and then moved."""
        return replace(
            self,
            inside=tuple(_moved(each, rotation, to) for each in self.inside),
            things=tuple(_moved(each, rotation, to) for each in self.things),
        )


def _moved(each: Box, rotation: np.ndarray, to: Sequence[float]) -> Box:
    matrix = np.array(each.matrix).reshape(4, 4)
    matrix[:3, :3] = rotation @ matrix[:3, :3]
    matrix[:3, 3] = rotation @ matrix[:3, 3] + to
    return Box(tuple(float(v) for v in matrix.ravel()))


def nearness(place: Place, point: np.ndarray, height: int = 128) -> np.ndarray:
    """(h, 2h) float32: 1/metres from a point, along `equirect.directions`, as a survey gives it."""
    ways = equirect.directions(2 * height, height).reshape(-1, 3)
    reached, nothing = _leave(place, point, ways)
    for thing in place.things:
        enters, leaves = _slabs(thing, point, ways)
        hit = (leaves > enters) & (leaves > 0.0)
        first = np.where(enters > 0.0, enters, leaves)
        closer = hit & (first < reached)
        reached, nothing = np.where(closer, first, reached), nothing & ~closer
    return np.where(nothing, 0.0, 1.0 / reached).reshape(height, 2 * height).astype(np.float32)


def _slabs(each: Box, point: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) metres along rays to where they enter and leave a box."""
    start, along = each.coordinates(np.asarray(point)[None])[0], ways @ each.face_normals.T
    with np.errstate(divide="ignore"):
        one, two = (-each.half_widths - start) / along, (each.half_widths - start) / along
    return np.minimum(one, two).max(-1), np.maximum(one, two).min(-1)


def _leave(place: Place, point: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) metres to where rays leave the air, and whether nothing is there."""
    spans = [_slabs(each, point, ways) for each in place.inside]
    reached = np.zeros(len(ways))
    nothing = np.zeros(len(ways), bool)
    for _ in range(len(spans) + 1):
        for k, (enters, leaves) in enumerate(spans):
            goes_on = (enters <= reached + 1e-9) & (leaves > reached + 1e-9)
            reached = np.where(goes_on, leaves, reached)
            nothing = np.where(goes_on, k in place.outside, nothing)
    return reached, nothing


def furnished(room: Box, seed: int, pieces: int, tall: float = 0.9, keep: float = 0.9) -> Place:
    """A room along the axes with furniture at its walls, most of it square to them, and some in the middle.

    Args:
        tall: how high furniture may be, as a share of the room's height.
        keep: metres around the centre that stay free.
    """
    random = np.random.default_rng(seed)
    half, things = room.half_extents, []
    while len(things) < pieces:
        size = random.uniform((0.2, 0.2, 0.15), (0.9, 0.45, tall * half[2]))
        wall, end = random.integers(2), random.choice([-1.0, 1.0])
        turn = 90.0 * (wall == 0) + (0.0 if random.random() < 0.75 else random.uniform(-40.0, 40.0))
        footprint = np.abs(about_z(turn)[:2, :2]) @ size[:2]
        if (footprint > half[:2]).any():
            continue
        centre = random.uniform(-half[:2] + footprint, half[:2] - footprint)
        if random.random() < 0.7:
            centre[wall] = end * (half[wall] - footprint[wall] - random.uniform(0.0, 0.05))
        if np.linalg.norm(np.maximum(np.abs(centre) - footprint, 0.0)) < keep:
            continue
        lift = 0.0 if random.random() < 0.8 else random.uniform(0.0, 2.0 * (half[2] - size[2]))
        things.append(box((*centre, -half[2] + size[2] + lift), size, turn))
    return Place((room,), tuple(things))


def drawn_wrong(room: Box, seed: int, size: float = 0.2, centre: float = 0.2, turn: float = 45.0) -> Box:
    """The room's box as a hurried artist draws it: each size, the centre and the turn are off by up to so much."""
    random = np.random.default_rng(1000 + seed)
    half = room.half_extents * (1.0 + random.choice([-size, size], 3))
    axes = room.axes / room.half_extents
    middle = room.centre + axes @ (room.half_extents * random.uniform(-centre, centre, 3))
    matrix = np.eye(4)
    matrix[:3, :3] = about_z(random.uniform(-turn, turn)) @ axes * half
    matrix[:3, 3] = middle
    return Box(tuple(float(v) for v in matrix.ravel()))


def wall_errors(room: Box, fitted: Box) -> np.ndarray:
    """(6,) metres: how far the walls of a box are from a room's, at its farthest corner of each wall."""
    corners = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0
    places = room.centre + corners @ room.axes.T
    likeness = np.abs(fitted.face_normals @ (room.axes / room.half_extents))
    errors = []
    for axis in range(3):
        own = int(likeness[:, axis].argmax())
        along = fitted.coordinates(places)[:, own]
        for end in (-1.0, 1.0):
            wall = corners[:, axis] == end
            errors.append(np.abs(np.abs(along[wall]) - fitted.half_widths[own]).max())
    return np.array(errors)


def rays(place: Place, point: np.ndarray, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What rays from a point meet: (n,) metres, infinite where nothing is; (n, 3) unit normals, to either side."""
    reached, nothing = _leave(place, point, ways)
    normals = np.zeros_like(ways)
    for each in place.inside:
        _note_faces(each, point + reached[:, None] * ways, normals)
    for thing in place.things:
        enters, leaves = _slabs(thing, point, ways)
        closer = (leaves > enters) & (enters > 0.0) & (enters < reached)
        reached, nothing = np.where(closer, enters, reached), nothing & ~closer
        _note_faces(thing, np.where(closer[:, None], point + enters[:, None] * ways, np.inf), normals)
    return np.where(nothing, np.inf, reached), normals


def _note_faces(each: Box, points: np.ndarray, normals: np.ndarray) -> None:
    """Write the normals of the faces that points (n, 3) lie on into (n, 3)."""
    places = np.abs(each.coordinates(np.where(np.isfinite(points), points, 1e9)))
    off = np.abs(places - each.half_widths)
    axis = off.argmin(-1)
    on = (off.min(-1) < 1e-6) & (places <= each.half_widths + 1e-6).all(-1)
    normals[on] = each.face_normals[axis[on]]
