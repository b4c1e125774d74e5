"""How far float32 may lead the lookup astray: the bound that docs/numerics.md derives, evaluated for each case.

Backward errors, forward consequences: rounding amounts to slightly different origins and directions along the face
normals. These let the reciprocal distance u lie anywhere in an interval; the looked-up direction u (P − B) + R then
lies on the segment between its ends. What the last two operations round is added. Constants are in units of the
roundoff 2⁻²⁴ and counted operation by operation; there is no factor that was fitted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pcc_addon.core.effects.lookup import ON_WALL
from pcc_addon.core.effects.records import Correction

from .cases import Cases
from .reference import LEAST_SPREAD, MOST_SPREAD, Exact, angle, own_way_round
from .rounding import ROUNDOFF, SMALLEST

# Normalising: squares and their sum 3, halved by the root, root 1, reciprocal 1, product 1: below 5.
# Reflecting a − 2 (a·n) n: the dot product 3 + 5, doubled; its product with n 2 (5 + 1); the subtraction 1.
REFLECT = 2 * (3 + 5) + 2 * (5 + 1) + 1
DOT = 3

# Errors of the origin (relative to its length) and of the unit direction along the face normals.
ALONG = {Correction.ALIGNED_BOX: 0, Correction.TURNED_BOX: REFLECT, Correction.ORIENTED_BOX: DOT * 3**0.5}


@dataclass(frozen=True)
class Off:
    """How far off the ray that a lookup is given may be, (n,) each.

    Attributes:
        ray: its direction, in units of its length.
        start: where it starts, metres.
    """

    ray: np.ndarray
    start: np.ndarray

    @classmethod
    def mirrored(cls, exact: Exact) -> Off:
        """The mirrored view from the surface itself."""
        return cls(ROUNDOFF * REFLECT * np.linalg.norm(exact.ray, axis=-1), np.zeros(len(exact.ray)))


def direction_bound(cases: Cases, exact: Exact, off: Off | None = None) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and `exact.direction`; at most π."""
    off = off or Off.mirrored(exact)
    from_capture = exact.start - cases.capture_point
    least, most = _reciprocal_distances(cases, exact, off)
    with np.errstate(over="ignore", invalid="ignore"):
        ends = [from_capture * u[:, None] + exact.ray for u in (least, most)]
        swept = np.maximum(*(angle(end, exact.direction) for end in ends))
        lost = _lost(exact, off, most) / _shortest(ends)
    return _at_most_half_a_turn(swept, lost + 4 * ROUNDOFF)


def spread_bound(cases: Cases, exact: Exact, off: Off | None = None) -> np.ndarray:
    """How far what float32 finds may be from `exact.spread`, (n,)."""
    off = off or Off.mirrored(exact)
    from_capture = exact.start - cases.capture_point
    least, most = _reciprocal_distances(cases, exact, off)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        ends = [from_capture * u[:, None] + exact.ray for u in (least, most)]
        lost = _lost(exact, off, most)
        longest = np.maximum(*(np.linalg.norm(end, axis=-1) for end in ends))
        # The difference rounds once and the length by 3, of which the root leaves half; then come the reciprocal and
        # the root.
        nearest = np.maximum(_shortest(ends) * (1 - 4 * ROUNDOFF) - lost, 0.0)
        farthest = longest * (1 + 4 * ROUNDOFF) + lost
        found = [np.clip(v**-0.5, LEAST_SPREAD, MOST_SPREAD) for v in (farthest, nearest)]
    return np.maximum(*(np.abs(value - exact.spread) for value in found)) + 3 * ROUNDOFF * MOST_SPREAD


def _lost(exact: Exact, off: Off, most: np.ndarray) -> np.ndarray:
    """What is added to u (P − B) + R after u is known, but for errors relative to the sum.

    P − B, the division in u and the product of both round by 3 u |P − B|, which is at most 3 (|D| + |R|); of that 3 |D|
    is relative to the sum, as is its own rounding. Then come the ray's own error and the start's, u times.
    """
    length = np.linalg.norm(exact.ray, axis=-1)
    start = off.start + np.where(off.start > 0.0, ROUNDOFF * np.linalg.norm(exact.start, axis=-1), 0.0)
    return ROUNDOFF * 3 * length + off.ray + SMALLEST + most * start


def _at_most_half_a_turn(swept: np.ndarray, relative: np.ndarray) -> np.ndarray:
    return np.minimum(swept + np.where(relative < 1.0, np.arcsin(np.minimum(relative, 1.0)), np.pi), np.pi)


def stretched_bound(cases: Cases, exact: Exact) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and `exact.stretched`; at most π."""
    along = ALONG[cases.correction]
    length = np.linalg.norm(exact.ray, axis=-1)
    from_centre = exact.start - cases.centre
    least, most = _reciprocal_distances(cases, exact, Off.mirrored(exact))
    half = cases.half_widths.astype(np.float64)
    scale = half.min(-1, keepdims=True) / half

    with np.errstate(over="ignore", invalid="ignore"):
        ends = [(exact.origin * u[:, None] + exact.speed) * scale * own_way_round(cases) for u in (least, most)]
        swept = np.maximum(*(angle(end, exact.stretched) for end in ends))
        shortest = _shortest(ends)
        # Before it is stretched the direction D is off by what the ray and the origin are, by the division in u, the
        # product and the subtraction; nothing of that is stretched by more than 1, while D may shrink by the least
        # scale. u |P − C| is at most |D| + |R|.
        longest = np.maximum(*(np.linalg.norm(from_centre * u[:, None] + exact.ray, axis=-1) for u in (least, most)))
        shrunk = np.minimum(longest / shortest, 1.0 / scale.min(-1))
        own = (REFLECT + along + 3 + along) * length / shortest + (3 + along + 3**0.5) * shrunk
        relative = ROUNDOFF * (2 + own) + 3 * SMALLEST / shortest  # 2: the ratio of widths and its product
    return _at_most_half_a_turn(swept, relative)


def _reciprocal_distances(cases: Cases, exact: Exact, off: Off) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most that 1 / distance can come out as, (n,) each."""
    along = ALONG[cases.correction]
    length = np.linalg.norm(exact.ray, axis=-1)
    reach = np.linalg.norm(exact.start - cases.centre, axis=-1)
    moved = off.start + np.where(off.start > 0.0, ROUNDOFF * np.linalg.norm(exact.start, axis=-1), 0.0)
    d_speed = (ROUNDOFF * along * length + off.ray)[:, None] + SMALLEST
    d_origin = (ROUNDOFF * (1 + along) * reach + moved)[:, None] + SMALLEST
    half = cases.half_widths.astype(np.float64)
    speed, ahead = np.abs(exact.speed), half - exact.origin * np.sign(exact.speed)
    d_ahead = d_origin + ROUNDOFF * np.abs(ahead)
    unsure = speed <= d_speed  # either wall may be taken for the one ahead
    nearest = np.where(unsure, half - np.abs(exact.origin), ahead)
    least = np.maximum(speed - d_speed, 0.0) / np.maximum(ahead + d_ahead, ON_WALL)
    most = (speed + d_speed) / np.maximum(nearest - d_ahead, ON_WALL)
    return least.max(-1), most.max(-1)


def _shortest(ends: list[np.ndarray]) -> np.ndarray:
    return np.maximum(distance_from_zero(*ends), 1e-300)


def distance_from_zero(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """How near to the origin the segments between points (n, 3) come."""
    along = end - start
    square = (along * along).sum(-1)
    share = np.clip(-(start * along).sum(-1) / np.maximum(square, 1e-300), 0.0, 1.0)
    return np.linalg.norm(start + share[:, None] * along, axis=-1)
