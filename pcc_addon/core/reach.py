"""Which of a capture's faces lookups can read, from where the surfaces lie that show it and which way they face.

A surface mirrors into the half space that it faces: with its unit normal n and all its points P at P·n ≥ p, what a
reflected ray meets lies at x·n ≥ p too. A face can be read where that half space meets the part of the box's boundary
that the face sees from the capture point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .cubemap import FACE_NAMES, FACES
from .probe import ProbeSpec

_TILT = 2e-5  # radians by which normals may be off; who sees a surface under a smaller angle is not thought of
_UNSURE = 1e-3  # radians: renderers find rows by an arc cosine, which near the poles is off by half as much
_GAP = 0.01  # of a box's half width: between a wall and what faces it so near nobody stands
_CORNERS = np.array(list(np.ndindex(2, 2, 2)))
_EDGES = np.array([(j, k) for j in range(8) for k in range(j) if np.abs(_CORNERS[j] - _CORNERS[k]).sum() == 1])


@dataclass(frozen=True, eq=False)
class Facets:
    """Flat parts of surfaces, world space.

    Attributes:
        normals: (n, 3) float64, unit, on the side of the eye.
        offsets: (n,) float64, metres: the least of P·normal over the points P of each.
    """

    normals: np.ndarray
    offsets: np.ndarray


def reachable(
    spec: ProbeSpec, capture_point: np.ndarray, facets: Facets, beyond: float, widening: float
) -> frozenset[str]:
    """The faces, by name, that lookups from some facets may read; errs towards all.

    What lies on a wall of the box, but for its padding, and faces out of it is left out: only from outside is it seen.

    Args:
        spec: the probe; its lookup is corrected by its box.
        capture_point: (3,) world space, metres.
        facets: flat parts of surfaces.
        beyond: how far these reach out of the box at most, metres.
        widening: how far from a lookup's direction lie texels that it mixes, radians.
    """
    box, rounding = spec.box, spec.boundary
    at = box.coordinates(np.asarray(capture_point, np.float64)[None])[0]
    clearance = float((box.half_widths - np.abs(at)).min())
    if clearance <= rounding:
        return EVERY_FACE
    opening = _opening(widening + _UNSURE + 4.0 * rounding / clearance)
    if opening is None:
        return EVERY_FACE
    walls = np.concatenate([box.face_normals, -box.face_normals])
    wall_offsets = walls @ box.centre + np.tile(box.half_widths, 2)
    outward = np.abs(facets.normals[:, None] - walls).max(-1) <= _TILT
    gaps = np.minimum(spec.padding, _GAP * np.tile(box.half_widths, 2))
    hidden = outward & (facets.offsets[:, None] >= wall_offsets - gaps - rounding)
    seen = ~hidden.any(-1)
    normals, offsets = facets.normals[seen], facets.offsets[seen]
    places, met = _met(spec, np.asarray(capture_point, np.float64), max(beyond, rounding), opening)
    heights = np.where(met[..., None], places @ normals.T, -np.inf).max(2)  # (faces, walls, facets)
    behind = np.abs(normals[:, None] + walls).max(-1) <= _TILT  # no ray that leaves the facet meets that wall
    margin = 2.0 * rounding + _TILT * 2.0 * float(np.linalg.norm(box.half_extents) + beyond)
    read = ((heights >= offsets - margin) & ~behind.T).any((1, 2))
    return frozenset(name for name, found in zip(FACE_NAMES, read, strict=True) if found)


EVERY_FACE = frozenset(FACE_NAMES)


def _opening(widening: float) -> float | None:
    """The half width of a pyramid, at depth 1, that holds all within an angle of a face; None: none is so wide.

    Near a corner of the face, where the pyramid's side is farthest from its axis, the angle counts √(3/2) times.
    """
    aside = math.sqrt(1.5) * math.sin(min(widening, 0.5 * math.pi))
    angle = 0.25 * math.pi + math.asin(min(aside, 1.0))
    return math.tan(angle) if angle < _WIDEST else None


_WIDEST = math.radians(89.0)


def _met(spec: ProbeSpec, origin: np.ndarray, beyond: float, opening: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of what each face's pyramid has in common with each of the box's walls, which are as thick as points are
    unsure or may lie outside: (6 faces, 6 walls, n, 3) world space, metres; and (6, 6, n) bool: which are any.
    """
    box, h = spec.box, spec.box.half_widths
    low, high = np.tile(-h - beyond, (6, 1)), np.tile(h + beyond, (6, 1))  # along the face normals
    for axis in range(3):
        low[axis, axis] = h[axis] - spec.boundary
        high[3 + axis, axis] = -low[axis, axis]
    to_world = np.linalg.inv(box.face_normals).T
    corners = box.centre + np.where(_CORNERS == 1, high[:, None], low[:, None]) @ to_world - origin  # (walls, 8, 3)
    forward, right, up = (np.array([getattr(face, name) for face in FACES], np.float64) for name in _FACE_AXES)
    sides = np.stack([opening * forward + sign * axis for axis in (right, up) for sign in (-1.0, 1.0)], 1)  # (6, 4, 3)
    above = np.einsum("fsk,wck->fwcs", sides, corners)
    near = 1e-9 * float(np.abs(corners).max())
    first, last = above[:, :, _EDGES[:, 0]], above[:, :, _EDGES[:, 1]]  # (faces, walls, 12 edges, 4 sides)
    crossing = (first > 0.0) != (last > 0.0)
    share = np.where(crossing, first, 0.0) / np.where(crossing, first - last, 1.0)
    cut = (
        corners[:, _EDGES[:, 0], None]
        + share[..., None] * (corners[:, _EDGES[:, 1]] - corners[:, _EDGES[:, 0]])[:, :, None]
    )
    within = (np.einsum("fsk,fwejk->fwejs", sides, cut) >= -near).all(-1)
    rays = np.stack([forward + opening * (a * right + b * up) for a in (-1.0, 1.0) for b in (-1.0, 1.0)], 1)
    reached, pierced = _pierced(box.coordinates(origin[None])[0], rays @ box.face_normals.T, low, high)
    along = rays[:, None, :, None] * reached[..., None]
    places = [np.broadcast_to(corners, (6, *corners.shape)), cut.reshape(6, 6, -1, 3), along.reshape(6, 6, -1, 3)]
    met = [(above >= -near).all(-1), (crossing & within).reshape(6, 6, -1), pierced.reshape(6, 6, -1)]
    return np.concatenate(places, 2) + origin, np.concatenate(met, 2)


_FACE_AXES = ("forward", "right", "up")


def _pierced(origin: np.ndarray, rays: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far along rays (faces, r, 3) each wall begins and ends, (faces, walls, r, 2); and whether it is met."""
    steep = np.where(np.abs(rays) < 1e-300, 1e-300, rays)[:, None]
    to_low, to_high = ((end - origin)[None, :, None] / steep for end in (low, high))
    enter = np.minimum(to_low, to_high).max(-1)
    leave = np.maximum(to_low, to_high).min(-1)
    reached = np.stack([enter, leave], -1)
    met = (enter <= leave) & (leave > 0.0)
    reached = np.where(met[..., None], np.maximum(reached, 0.0), 0.0)
    return reached, np.broadcast_to(met[..., None], reached.shape)
