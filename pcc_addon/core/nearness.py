"""How near the walls of a box are, as a survey would see them."""

from __future__ import annotations

import numpy as np

from . import equirect
from .cubemap import FACES, OVERSCAN, face_directions
from .probe import Box, ProbeSpec


def distances(box: Box, points: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """(…) float64: metres along vectors (…, 3) of any length from points (…, 3) in a box to its walls; world space.

    Points beyond a wall count as on it.
    """
    ways = vectors @ box.face_normals.T
    ahead = np.maximum(box.half_widths - (points - box.centre) @ box.face_normals.T * np.sign(ways), 0.0)
    steep = np.abs(ways) / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(
        ahead, steep, out=np.full(np.broadcast_shapes(ahead.shape, steep.shape), np.inf), where=steep > 0.0
    ).min(-1)


def along(spec: ProbeSpec, directions: np.ndarray) -> np.ndarray:
    """1/metres along world-space directions (..., 3), of any length but 0, from a probe's capture point to its box.

    Infinite where the way to the box is 0, as where the capture point is not in it.
    """
    with np.errstate(divide="ignore"):
        return 1.0 / distances(spec.box, spec.capture_point, directions)


def of_walls(spec: ProbeSpec) -> np.ndarray:
    """(2n, 4n) float32, 1/metres: the survey of a probe's empty box, put together from faces as surveys are."""
    faces = [
        along(spec, face_directions(face, spec.resolution, OVERSCAN))[..., None].astype(np.float32) for face in FACES
    ]
    return equirect.from_faces(faces, OVERSCAN)[..., 0]
