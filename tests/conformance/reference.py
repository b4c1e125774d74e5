"""Where a lookup should look, from geometry alone: the six planes of the box one by one, in float64 or more."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import mpmath
import numpy as np

from pcc_addon.core.effects.records import Correction
from tests.core.boxes import unit

from .cases import Cases


@dataclass(frozen=True)
class Exact:
    """What the float32 inputs of n cases mean, computed in float64.

    Attributes:
        ray: (n, 3) the reflected ray.
        origin: (n, 3) the shaded point from the box's centre, along the face normals, metres.
        speed: (n, 3) the ray along the face normals.
        distance: (n,) along the ray to its exit from the box, metres; 0 from a wall or from beyond it.
        direction: (n, 3) unit, from the capture point to the exit.
        stretched: (n, 3) unit, from the centre to the exit in the space where the box is a cube, along its own axes.
    """

    ray: np.ndarray
    origin: np.ndarray
    speed: np.ndarray
    distance: np.ndarray
    direction: np.ndarray
    stretched: np.ndarray


def exact(cases: Cases) -> Exact:
    """Reflect, meet every plane that the ray approaches from inside, take the first."""
    position, centre, capture = (a.astype(np.float64) for a in (cases.position, cases.centre, cases.capture_point))
    half, normals = cases.half_widths.astype(np.float64), cases.exact_face_normals()
    incoming, normal = cases.incoming.astype(np.float64), unit(cases.normal.astype(np.float64))
    ray = 2.0 * (incoming * normal).sum(-1, keepdims=True) * normal - incoming
    origin = np.einsum("nij,nj->ni", normals, position - centre)
    speed = np.einsum("nij,nj->ni", normals, ray)
    distance = np.full(len(cases), np.inf)
    for axis, side in itertools.product(range(3), (-1.0, 1.0)):
        towards, gap = side * speed[:, axis], half[:, axis] - side * origin[:, axis]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            met = np.where(towards > 0.0, np.maximum(gap, 0.0) / towards, np.inf)
        distance = np.minimum(distance, met)
    with np.errstate(invalid="ignore"):
        direction = unit(np.where(np.isinf(distance)[:, None], ray, position - capture + distance[:, None] * ray))
        local = np.where(np.isinf(distance)[:, None], speed, origin + distance[:, None] * speed) / half
    return Exact(ray, origin, speed, distance, direction, unit(local * own_way_round(cases)))


def own_way_round(cases: Cases) -> tuple[float, float, float]:
    """Signs that face normals need to be the box's own axes: a mirror that stands for a turn reverses the second."""
    return (1.0, -1.0, 1.0) if cases.correction is Correction.TURNED_BOX else (1.0, 1.0, 1.0)


def exact_direction_in_50_digits(cases: Cases, k: int, *, stretched: bool = False) -> np.ndarray:
    """The unit direction (3,) of case k, by the same planes in 50 digits; for face normals that are given.

    From the capture point to the exit; or, stretched, from the centre in the space where the box is a cube.
    """
    with mpmath.workdps(50):
        position, incoming, normal, centre, half, capture = (
            mpmath.matrix([mpmath.mpf(float(v)) for v in array[k]])
            for array in (
                cases.position,
                cases.incoming,
                cases.normal,
                cases.centre,
                cases.half_widths,
                cases.capture_point,
            )
        )
        length = mpmath.norm(normal)
        normal = normal / length if length else normal
        ray = 2 * _dot(incoming, normal) * normal - incoming
        distances, faces = [], [mpmath.matrix([mpmath.mpf(float(v)) for v in row]) for row in cases.face_normals[k]]
        for axis, side in itertools.product(range(3), (-1, 1)):
            face = faces[axis] * side
            towards, gap = _dot(face, ray), half[axis] - _dot(face, position - centre)
            if towards > 0:
                distances.append(max(gap, 0) / towards)
        spot = position + min(distances) * ray - (centre if stretched else capture)
        if stretched:
            spot = mpmath.matrix([_dot(face, spot) / half[axis] for axis, face in enumerate(faces)])
        return np.array([float(c / mpmath.norm(spot)) for c in spot])


def _dot(a: mpmath.matrix, b: mpmath.matrix) -> mpmath.mpf:
    return mpmath.fdot(a, b)


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Radians (n,) between vectors (n, 3) of any length, accurate for small angles too.

    Half a turn, the worst there is, where only one of them is zero or not finite; 0 where both are.
    """
    with np.errstate(invalid="ignore"):
        a, b = unit(a.astype(np.float64)), unit(b.astype(np.float64))
        found = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))
    nothing_a, nothing_b = (~np.isfinite(v).all(-1) | ~v.any(-1) for v in (a, b))
    return np.where(nothing_a | nothing_b, np.where(nothing_a & nothing_b, 0.0, np.pi), found)
