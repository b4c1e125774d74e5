"""How far a probe's box is from what its capture point sees, and how wrong reflections are by that."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from .. import equirect
from .. import nearness as nearness_of_box
from ..errors import ProbeError
from ..probe import Box, ProbeSpec
from .sequences import evenly

ON_THE_BOX = 0.01
"""Metres: what is no farther from the box counts as on it."""

_VIEWERS = 16
_GRAZING = 1e-3  # sine: what is nearer to its own plane a flat surface does not mirror
_READ = 2  # texels around one that bicubic reading asks
_ROOM = 0.9  # of the half widths: where viewers stand by default


class Fit(Enum):
    """How what is seen in a direction lies to the box."""

    ON = "on"
    BEFORE = "before"
    BEYOND = "beyond"
    NOTHING = "nothing"


@dataclass(frozen=True, eq=False)
class Viewers:
    """Points that mirror what is around them.

    Attributes:
        points: (m, 3) float64, world space, metres.
        normals: (m, 3) float64, unit: what is behind a point it does not mirror; None: they mirror all around.
    """

    points: np.ndarray
    normals: np.ndarray | None = None


@dataclass(frozen=True)
class Share:
    """What some directions have in common.

    Attributes:
        share: of all directions, by solid angle, 0 … 1.
        metres: mean distance from the box along the ray; 0 where nothing is seen.
        degrees: by how much their reflections are off, on average over directions and viewers.
    """

    share: float
    metres: float
    degrees: float


@dataclass(frozen=True, eq=False)
class Misfit:
    """What a survey says of a box; pictures are equirectangular, (2n, 4n) float64, row 0 at the bottom.

    Attributes:
        spec: the probe.
        walls: metres from the capture point to the box.
        offsets: metres from the box to what is seen, along the ray: below 0 before it, above 0 beyond it, inf: nothing.
        angles: radians by which what is seen there is shown elsewhere, on average over the viewers that it faces.
    """

    spec: ProbeSpec
    walls: np.ndarray
    offsets: np.ndarray
    angles: np.ndarray

    @cached_property
    def fits(self) -> dict[Fit, np.ndarray]:
        """(2n, 4n) bool each: the directions that lie so to the box."""
        nothing = np.isinf(self.offsets)
        before, beyond = self.offsets < -ON_THE_BOX, (self.offsets > ON_THE_BOX) & ~nothing
        return {
            Fit.ON: ~(before | beyond | nothing),
            Fit.BEFORE: before,
            Fit.BEYOND: beyond,
            Fit.NOTHING: nothing,
        }

    def share(self, fit: Fit) -> Share:
        """What is said of the directions that lie so to the box."""
        height, width = self.offsets.shape
        weights = np.broadcast_to(equirect.solid_angles(width, height)[:, None], (height, width))[self.fits[fit]]
        total = float(weights.sum())
        if not total:
            return Share(0.0, 0.0, 0.0)
        metres = 0.0 if fit is Fit.NOTHING else float(weights @ np.abs(self.offsets[self.fits[fit]])) / total
        degrees = float(np.degrees(weights @ self.angles[self.fits[fit]])) / total
        return Share(total / (4.0 * np.pi), metres, degrees)

    @property
    def degrees(self) -> float:
        """By how much reflections are off, on average over all directions."""
        return sum(self.share(fit).share * self.share(fit).degrees for fit in Fit)


def misfit(spec: ProbeSpec, nearness: np.ndarray, viewers: Viewers | None = None) -> Misfit:
    """Compare a box with a survey.

    The distance to the box is read through the same six faces as the survey, so that an edge of a room that lies
    between two texels is no misfit.

    Args:
        spec: the probe; its resolution is that of the survey, n.
        nearness: (2n, 4n) 1/metres from the capture point, 0 where nothing is.
        viewers: who mirrors; None: 16 points all over the box that mirror all around.

    Raises:
        ProbeError: as `check`.
        ValueError: the survey has another size.
    """
    n = spec.resolution
    if nearness.shape != (2 * n, 4 * n):
        raise ValueError(f"a survey of {n} texels a face is {2 * n}×{4 * n}, not {nearness.shape}")
    check(spec)
    vectors = equirect.directions(4 * n, 2 * n)
    walls = nearness_of_box.distances(spec.box, spec.capture_point, vectors)
    offsets = _reciprocal(nearness) - _reciprocal(nearness_of_box.of_walls(spec))
    offsets = np.where(_rings(offsets, walls, 2.0 / n), 0.0, np.maximum(offsets, -walls))
    angles = _angles(spec, vectors, walls + offsets, viewers or _everywhere(spec.box))
    return Misfit(spec, walls, offsets, angles)


def check(spec: ProbeSpec) -> None:
    """Refuse a probe whose box cannot be compared with what it sees.

    Raises:
        ProbeError: its picture is from elsewhere, or its capture point is not inside its box.
    """
    if spec.source.stretched:
        raise ProbeError(
            f"probe '{spec.name}' shows a picture from elsewhere, stretched to its box, so there is nothing that the "
            "box could miss; set its source to Bake"
        )
    if (np.abs(spec.box.coordinates(spec.capture_point[None])) >= spec.box.half_widths).any():
        raise ProbeError(
            f"probe '{spec.name}': its capture point is not inside its box; move the box or its capture offset"
        )


def _rings(offsets: np.ndarray, walls: np.ndarray, texel: float) -> np.ndarray:
    """(2n, 4n) bool: texels beyond a wall only as bicubic reading overshoots beside what is before it."""
    small = texel * walls
    jump = offsets < -small
    near = jump.copy()
    for dr in range(-_READ, _READ + 1):
        rows = slice(max(dr, 0), len(jump) + min(dr, 0)), slice(max(-dr, 0), len(jump) + min(-dr, 0))
        for dc in range(-_READ, _READ + 1):
            near[rows[0]] |= np.roll(jump, dc, 1)[rows[1]]
    return near & (offsets > 0.0) & (offsets <= small)


def _reciprocal(values: np.ndarray) -> np.ndarray:
    """1/x as float64, inf for 0."""
    values = values.astype(np.float64)
    return np.divide(1.0, values, out=np.full(values.shape, np.inf), where=values > 0.0)


def _everywhere(box: Box) -> Viewers:
    metres = (2.0 * evenly(_VIEWERS, 3) - 1.0) * _ROOM * box.half_widths
    return Viewers(box.centre + metres @ np.linalg.inv(box.face_normals).T)


def _angles(spec: ProbeSpec, vectors: np.ndarray, distances: np.ndarray, viewers: Viewers) -> np.ndarray:
    """Radians, on average over viewers, between where a thing was captured and where a lookup that aims at it reads.

    A viewer at P that mirrors a thing at X reads the picture where the ray from P to X leaves the box. What may stand
    between the two is not asked for.
    """
    endless = np.isinf(distances)[..., None]
    reach = np.where(endless, 0.0, vectors * np.where(endless, 0.0, distances[..., None]))  # from the capture point
    total, count = np.zeros(distances.shape), np.zeros(distances.shape)
    normals = viewers.normals if viewers.normals is not None else [None] * len(viewers.points)
    for point, normal in zip(viewers.points, normals, strict=True):
        away = point - spec.capture_point
        rays = np.where(endless, vectors, reach - away)
        lengths = np.linalg.norm(rays, axis=-1)
        faced = lengths > 0.0
        if normal is not None:
            faced &= rays @ normal > _GRAZING * lengths
        safe = np.where(faced[..., None], rays, 1.0)
        far = nearness_of_box.distances(spec.box, point, safe)[..., None] / np.linalg.norm(safe, axis=-1, keepdims=True)
        total += np.where(faced, _between(vectors, away + safe * far), 0.0)
        count += faced
    return total / np.maximum(count, 1.0)


def _between(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(…) radians between vectors (…, 3)."""
    return np.arctan2(np.linalg.norm(np.cross(first, second), axis=-1), (first * second).sum(-1))


def at(picture: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """The texels (…) of an equirectangular picture (h, 2h) in which directions (…, 3) of any length lie."""
    height, width = picture.shape[:2]
    u, v = equirect.coordinates(vectors)
    return picture[np.minimum((v * height).astype(np.intp), height - 1), (u * width).astype(np.intp) % width]


@dataclass(frozen=True, eq=False)
class Sightings:
    """Whose surface is seen in some directions.

    Attributes:
        vectors: (k, 3) float64, unit, evenly all around.
        names: (k,) of objects; empty where nobody knows.
    """

    vectors: np.ndarray
    names: tuple[str, ...]
