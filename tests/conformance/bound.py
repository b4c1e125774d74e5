"""How far float32 may lead the lookup astray: the bound that docs/numerics.md derives, evaluated for each case.

Backward errors, forward consequences: rounding amounts to slightly different origins and directions along the face
normals. These let the reciprocal distance u lie anywhere in an interval; the looked-up direction u (P − B) + R then
lies on the segment between its ends. What the last two operations round is added. Constants are in units of the
roundoff 2⁻²⁴ and counted operation by operation; there is no factor that was fitted.
"""

from __future__ import annotations

import numpy as np

from pcc_addon.core.effects.lookup import ON_WALL
from pcc_addon.core.effects.records import Correction

from .cases import Cases
from .reference import Exact, angle, own_way_round

ROUNDOFF = 2.0**-24
SMALLEST = 2.0**-126  # what is smaller may be flushed to zero

# Normalising: squares and their sum 3, halved by the root, root 1, reciprocal 1, product 1: below 5.
# Reflecting a − 2 (a·n) n: the dot product 3 + 5, doubled; its product with n 2 (5 + 1); the subtraction 1.
REFLECT = 2 * (3 + 5) + 2 * (5 + 1) + 1
DOT = 3

# Errors of the origin (relative to its length) and of the unit direction along the face normals.
ALONG = {Correction.ALIGNED_BOX: 0, Correction.TURNED_BOX: REFLECT, Correction.ORIENTED_BOX: DOT * 3**0.5}


def direction_bound(cases: Cases, exact: Exact) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and `exact.direction`; at most π."""
    along = ALONG[cases.correction]
    length = np.linalg.norm(exact.ray, axis=-1)
    from_centre = cases.position.astype(np.float64) - cases.centre
    from_capture = cases.position.astype(np.float64) - cases.capture_point
    d_speed = ROUNDOFF * (REFLECT + along) * length[:, None] + SMALLEST
    d_origin = ROUNDOFF * ((1 + along) * np.linalg.norm(from_centre, axis=-1, keepdims=True)) + SMALLEST
    least, most = _reciprocal_distances(cases, exact, d_speed, d_origin)

    with np.errstate(over="ignore", invalid="ignore"):
        ends = [from_capture * u[:, None] + exact.ray for u in (least, most)]
        swept = np.maximum(*(angle(end, exact.direction) for end in ends))
        shortest = np.maximum(_distance_from_zero(*ends), 1e-300)
        # P − B, the division in u and the product of both round by 3 u |P − B|, which is at most 3 (|D| + |R|); then
        # come the ray's own error and the last subtraction.
        relative = ROUNDOFF * (3 + 1 + (3 + REFLECT) * length / shortest) + SMALLEST / shortest
    return np.minimum(swept + np.where(relative < 1.0, np.arcsin(np.minimum(relative, 1.0)), np.pi), np.pi)


def stretched_bound(cases: Cases, exact: Exact) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and `exact.stretched`; at most π."""
    along = ALONG[cases.correction]
    length = np.linalg.norm(exact.ray, axis=-1)
    from_centre = cases.position.astype(np.float64) - cases.centre
    d_speed = ROUNDOFF * (REFLECT + along) * length[:, None] + SMALLEST
    d_origin = ROUNDOFF * ((1 + along) * np.linalg.norm(from_centre, axis=-1, keepdims=True)) + SMALLEST
    least, most = _reciprocal_distances(cases, exact, d_speed, d_origin)
    half = cases.half_widths.astype(np.float64)
    scale = half.min(-1, keepdims=True) / half

    with np.errstate(over="ignore", invalid="ignore"):
        ends = [(exact.origin * u[:, None] + exact.speed) * scale * own_way_round(cases) for u in (least, most)]
        swept = np.maximum(*(angle(end, exact.stretched) for end in ends))
        shortest = np.maximum(_distance_from_zero(*ends), 1e-300)
        # Before it is stretched the direction D is off by what the ray and the origin are, by the division in u, the
        # product and the subtraction; nothing of that is stretched by more than 1, while D may shrink by the least
        # scale. u |P − C| is at most |D| + |R|.
        longest = np.maximum(*(np.linalg.norm(from_centre * u[:, None] + exact.ray, axis=-1) for u in (least, most)))
        shrunk = np.minimum(longest / shortest, 1.0 / scale.min(-1))
        own = (REFLECT + along + 3 + along) * length / shortest + (3 + along + 3**0.5) * shrunk
        relative = ROUNDOFF * (2 + own) + 3 * SMALLEST / shortest  # 2: the ratio of widths and its product
    return np.minimum(swept + np.where(relative < 1.0, np.arcsin(np.minimum(relative, 1.0)), np.pi), np.pi)


def _reciprocal_distances(
    cases: Cases, exact: Exact, d_speed: np.ndarray, d_origin: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most that 1 / distance can come out as, (n,) each."""
    half = cases.half_widths.astype(np.float64)
    speed, ahead = np.abs(exact.speed), half - exact.origin * np.sign(exact.speed)
    d_ahead = d_origin + ROUNDOFF * np.abs(ahead)
    unsure = speed <= d_speed  # either wall may be taken for the one ahead
    nearest = np.where(unsure, half - np.abs(exact.origin), ahead)
    least = np.maximum(speed - d_speed, 0.0) / np.maximum(ahead + d_ahead, ON_WALL)
    most = (speed + d_speed) / np.maximum(nearest - d_ahead, ON_WALL)
    return least.max(-1), most.max(-1)


def _distance_from_zero(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """How near to the origin the segments between points (n, 3) come."""
    along = end - start
    square = (along * along).sum(-1)
    share = np.clip(-(start * along).sum(-1) / np.maximum(square, 1e-300), 0.0, 1.0)
    return np.linalg.norm(start + share[:, None] * along, axis=-1)
