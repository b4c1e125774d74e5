"""Where a lookup should look, from geometry alone: the six planes of the box one by one, in float64 or 50 digits."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from pcc_addon.core.effects.records import Correction
from tests.core.boxes import unit as unit_in_float64

from .cases import Cases
from .digits import Numbers, float64, inner, unit


@dataclass(frozen=True)
class Exact:
    """What the float32 inputs of n cases mean.

    Attributes:
        start: (n, 3) where the ray starts, metres.
        ray: (n, 3) its direction, metres a unit of distance.
        origin: (n, 3) its start from the box's centre, along the face normals, metres.
        speed: (n, 3) its direction along the face normals.
        distance: (n,) along the ray to its exit from the box; 0 from a wall or from beyond it.
        direction: (n, 3) unit, from the capture point to the exit.
        stretched: (n, 3) unit, from the centre to the exit in the space where the box is a cube, along its own axes.
        spread: (n,) the root of the distance over that from the capture point to the exit, from 0.35 to 1.5.
    """

    start: np.ndarray
    ray: np.ndarray
    origin: np.ndarray
    speed: np.ndarray
    distance: np.ndarray
    direction: np.ndarray
    stretched: np.ndarray
    spread: np.ndarray


def mirrored(cases: Cases, numbers: Numbers = float64) -> np.ndarray:
    """(n, 3) the reflected ray."""
    incoming, normal = numbers(cases.incoming), unit(numbers(cases.normal))
    return 2 * inner(incoming, normal) * normal - incoming


def exact(
    cases: Cases,
    numbers: Numbers = float64,
    *,
    ray: np.ndarray | None = None,
    offset: np.ndarray | float = 0.0,
) -> Exact:
    """Meet every plane that the ray approaches from inside, take the first.

    Args:
        cases: the box and the point.
        numbers: to compute with.
        ray: (n, 3); None: the mirrored view.
        offset: (n, 3) from the shaded point to where it starts.
    """
    centre, capture, half = (numbers(a) for a in (cases.centre, cases.capture_point, cases.half_widths))
    normals = cases.exact_face_normals(numbers)
    ray = mirrored(cases, numbers) if ray is None else ray
    start = numbers(cases.position) + offset
    origin, speed = ((normals * v[:, None, :]).sum(-1) for v in (start - centre, ray))
    distance = np.full(len(cases), np.inf)
    for axis, side in itertools.product(range(3), (-1, 1)):
        towards, gap = side * speed[:, axis], half[:, axis] - side * origin[:, axis]
        with np.errstate(over="ignore"):
            met = np.maximum(gap, 0) / np.where(towards > 0, towards, 1)
        distance = np.minimum(distance, np.where(towards > 0, met, np.inf))
    unmet = (distance == np.inf)[:, None]  # the ray is zero
    along = np.where(unmet, 0, distance[:, None])
    way = np.where(unmet, ray, start - capture + along * ray)
    local = np.where(unmet, speed, origin + along * speed) / half
    apart = inner(way, way)[:, 0] ** 0.5
    share = np.where(apart > 0, distance / np.where(apart > 0, apart, 1), np.inf)
    spread = np.minimum(np.maximum(share, LEAST_SPREAD**2), MOST_SPREAD**2) ** 0.5
    return Exact(start, ray, origin, speed, distance, unit(way), unit(local * own_way_round(cases)), spread)


LEAST_SPREAD, MOST_SPREAD = 0.35, 1.5


def own_way_round(cases: Cases) -> tuple[float, float, float]:
    """Signs that face normals need to be the box's own axes: a mirror that stands for a turn reverses the second."""
    return (1.0, -1.0, 1.0) if cases.correction is Correction.TURNED_BOX else (1.0, 1.0, 1.0)


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Radians (n,) between vectors (n, 3) of any length, accurate for small angles too.

    Half a turn, the worst there is, where only one of them is zero or not finite; 0 where both are.
    """
    with np.errstate(invalid="ignore"):
        a, b = unit_in_float64(a.astype(np.float64)), unit_in_float64(b.astype(np.float64))
        found = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))
    nothing_a, nothing_b = (~np.isfinite(v).all(-1) | ~v.any(-1) for v in (a, b))
    return np.where(nothing_a | nothing_b, np.where(nothing_a & nothing_b, 0.0, np.pi), found)
