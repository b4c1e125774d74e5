"""Points on surfaces, evenly by area and the same ones each time."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from .sequences import evenly


class Make(IntEnum):
    """What a mesh is made like, which says which of its sides anybody may see."""

    SOLID = 0  # closed: the outer sides, or the inner ones of a room in which one stands
    SHELL = 1  # open: the sides that its normals say, or the others of walls that are turned out
    SHEET = 2  # open and flat: both


@dataclass(frozen=True, eq=False)
class Place:
    """The points P with P·normal ≤ offset for each of some planes.

    Attributes:
        normals: (p, 3) float64, unit, world space.
        offsets: (p,) float64, metres.
    """

    normals: np.ndarray
    offsets: np.ndarray


@dataclass(frozen=True, eq=False)
class Triangles:
    """Surfaces as triangles, world space.

    Attributes:
        corners: (t, 3, 3) float64, metres; counter-clockwise as seen from the side that counts.
        owners: (t,) int: whose they are, as indices of `names`.
        makes: (t,) int: the `Make` of their mesh.
        names: object and material.
    """

    corners: np.ndarray
    owners: np.ndarray
    makes: np.ndarray
    names: tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class Samples:
    """Points on surfaces, each of which stands for the same area.

    Attributes:
        points: (n, 3) float64, world space, metres.
        normals: (n, 3) float64, unit, on the side that counts.
        owners: (n,) int: as in `Triangles`.
        makes: (n,) int: as in `Triangles`.
        area: square metres that each stands for.
        names: object and material.
    """

    points: np.ndarray
    normals: np.ndarray
    owners: np.ndarray
    makes: np.ndarray
    area: float
    names: tuple[tuple[str, str], ...]


def make_of(corners: np.ndarray, triangles: np.ndarray, eye: np.ndarray) -> tuple[Make, bool]:
    """What a mesh is made like, and whether the sides that count are those opposite to its triangles' order.

    Args:
        corners: (t, 3, 3) float64.
        triangles: (t, 3) int: their vertices, by which edges are found that two triangles share.
        eye: (3,) the capture point, in the same space.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    count = int(triangles.max()) + 1 if len(triangles) else 1
    forth, back = edges @ (count, 1), edges @ (1, count)
    if len(triangles) and len(np.unique(forth)) == len(forth) and np.array_equal(np.sort(forth), np.sort(back)):
        outward = (
            np.einsum("tk,tk->t", corners[:, 0] - eye, np.cross(corners[:, 1] - eye, corners[:, 2] - eye)).sum() >= 0
        )
        inside = abs(_turns_around(corners - eye)) > 0.5
        return Make.SOLID, bool(outward) == inside
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=-1)
    units = normals[lengths > 0.0] / lengths[lengths > 0.0, None]
    flat = bool(len(units)) and bool((np.abs(units @ units[0]) > 1.0 - 1e-6).all())
    return (Make.SHEET if flat else Make.SHELL), False


def _turns_around(corners: np.ndarray) -> float:
    """How often triangles (t, 3, 3) go around the origin: 0 outside a closed mesh, ±1 in it.

    The solid angle of each is as A. van Oosterom and J. Strackee have it, "The Solid Angle of a Plane Triangle", 1983.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    la, lb, lc = (np.linalg.norm(k, axis=-1) for k in (a, b, c))
    volume = np.einsum("tk,tk->t", a, np.cross(b, c))
    scale = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    return float(2.0 * np.arctan2(volume, scale).sum() / (4.0 * np.pi))


def sample(triangles: Triangles, count: int, place: Place) -> Samples:
    """Points on what of some triangles lies in a place, exactly clipped.

    Args:
        triangles: what is sampled.
        count: of points.
        place: where.
    """
    corners, owners, makes = _clipped(triangles, place)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=-1)
    edges = np.concatenate([[0.0], np.cumsum(0.5 * lengths)])
    if not edges[-1] > 0.0:
        nothing = np.zeros((0, 3))
        return Samples(nothing, nothing, owners[:0], makes[:0], 0.0, triangles.names)
    area = float(edges[-1]) / count
    chosen = np.searchsorted(edges, (np.arange(count) + 0.5) * area, side="right") - 1
    across, along = evenly(count, 2).T
    root = np.sqrt(across)
    weights = np.stack([1.0 - root, root * (1.0 - along), root * along], -1)
    points = np.einsum("nk,nkj->nj", weights, corners[chosen])
    units = normals[chosen] / lengths[chosen, None]
    return Samples(points, units, owners[chosen], makes[chosen], area, triangles.names)


def _clipped(triangles: Triangles, place: Place) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners, owners and makes of what lies in a place: as I. Sutherland and G. Hodgman clip, one plane at a time."""
    corners, owners, makes = triangles.corners, triangles.owners, triangles.makes
    for normal, offset in zip(place.normals, place.offsets, strict=True):
        above = corners @ normal - offset
        inside = (above <= 0.0).sum(-1)
        odd = np.where(inside == 1, (above <= 0.0).argmax(-1), (above > 0.0).argmax(-1))
        order = (odd[:, None] + np.arange(3)) % 3
        turned, height = np.take_along_axis(corners, order[..., None], 1), np.take_along_axis(above, order, 1)
        one, two = inside == 1, inside == 2
        p, q = (_crossing(turned, height, k) for k in (1, 2))
        pieces = (
            (corners, inside == 3),
            (np.stack([turned[:, 0], p, q], 1), one),
            (np.stack([p, turned[:, 1], turned[:, 2]], 1), two),
            (np.stack([p, turned[:, 2], q], 1), two),
        )
        owners, makes = (np.concatenate([whose[chosen] for _, chosen in pieces]) for whose in (owners, makes))
        corners = np.concatenate([piece[chosen] for piece, chosen in pieces])
    return corners, owners, makes


def _crossing(corners: np.ndarray, height: np.ndarray, k: int) -> np.ndarray:
    """(t, 3): where the edge from the first corner to the k-th crosses the plane; anywhere where it does not."""
    rise = height[:, 0] - height[:, k]
    share = np.divide(height[:, 0], rise, out=np.zeros(len(rise)), where=rise != 0.0)[:, None]
    return corners[:, 0] + share * (corners[:, k] - corners[:, 0])
