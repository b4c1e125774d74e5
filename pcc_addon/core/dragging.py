"""Where a drag in a view leads, and how far walls may go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .probe import ProbeSpec

LEAST = 1e-3  # metres that are left of a box
_ALONG = 1e-4  # sine of the angle below which a view looks along a line or a plane
_PRECISE = 0.1  # what a precise move is of the pointer's


@dataclass(frozen=True)
class Wall:
    """A face of a probe's box, or of its influence.

    Attributes:
        axis: 0, 1, 2: which of the box's own axes it closes.
        high: whether at that axis's positive end.
        influence: whether that of the influence.
    """

    axis: int
    high: bool
    influence: bool = False

    @property
    def sign(self) -> float:
        return 1.0 if self.high else -1.0


@dataclass(frozen=True)
class Travel:
    """How far a drag has gone, whose pointer may have gone another way while it was precise.

    Attributes:
        gone: metres, (n,) or one number.
        pointer: where the pointer is, likewise.
    """

    gone: np.ndarray
    pointer: np.ndarray

    def to(self, pointer: np.ndarray, *, precise: bool) -> Travel:
        """Further, to another place of the pointer."""
        return Travel(self.gone + (pointer - self.pointer) * (_PRECISE if precise else 1.0), pointer)


def snapped(metres: np.ndarray, step: float) -> np.ndarray:
    """The nearest multiples of a step."""
    return np.round(np.asarray(metres) / step) * step


def along_line(point: np.ndarray, way: np.ndarray, eye: np.ndarray, look: np.ndarray) -> float | None:
    """How far along a line the place is that is nearest to a ray of the view; None where the view looks along it.

    Args:
        point, eye: (3,) metres; way, look: (3,) unit.
    """
    cosine = float(way @ look)
    if 1.0 - cosine * cosine < _ALONG * _ALONG:
        return None
    apart = eye - point
    return float(apart @ way - cosine * (apart @ look)) / (1.0 - cosine * cosine)


def on_plane(point: np.ndarray, normal: np.ndarray, eye: np.ndarray, look: np.ndarray) -> np.ndarray | None:
    """(3,) where a ray of the view meets a plane; None where it looks along it.

    Args:
        point, eye: (3,) metres; normal, look: (3,) unit.
    """
    toward = float(look @ normal)
    return None if abs(toward) < _ALONG else eye + look * (float((point - eye) @ normal) / toward)


def farthest_in(spec: ProbeSpec, wall: Wall) -> float:
    """How far a wall may move outwards at the least, metres, below 0: something of the box and the influence stays."""
    width = 2.0 * float(spec.box.half_widths[wall.axis])
    reach = spec.influence.low[wall.axis] + spec.influence.high[wall.axis]
    if wall.influence:
        return LEAST - (width + reach)
    smallest = LEAST + max(0.0, -reach)
    return 2.0 * float(spec.box.half_extents[wall.axis]) * (min(smallest / width, 1.0) - 1.0)


def place_of(spec: ProbeSpec, wall: Wall, beyond: float = 0.0, aside: float = 0.0) -> np.ndarray:
    """(3,) world space, metres: over the middle of a face of the box.

    Args:
        beyond: metres outside the face.
        aside: how far beside the middle, as a share of the half width that way: along Y of walls at X, else along X.
    """
    coordinates = np.zeros(3)
    coordinates[wall.axis] = wall.sign * (spec.box.half_widths[wall.axis] + beyond)
    beside = 1 if wall.axis == 0 else 0
    coordinates[beside] = aside * spec.box.half_widths[beside]
    return spec.box.centre + np.linalg.solve(spec.box.face_normals, coordinates)


def way_of(spec: ProbeSpec, wall: Wall) -> np.ndarray:
    """(3,) unit, world space: where a wall goes when it moves outwards; the box's along its edges."""
    if wall.influence:
        return spec.box.face_normals[wall.axis] * wall.sign
    return spec.box.axes[:, wall.axis] / spec.box.half_extents[wall.axis] * wall.sign
