"""How near the walls of a box are, as a survey would see them."""

from __future__ import annotations

import numpy as np

from . import equirect
from .cubemap import FACES, OVERSCAN, face_directions
from .probe import ProbeSpec


def along(spec: ProbeSpec, directions: np.ndarray) -> np.ndarray:
    """1/metres along world-space directions (..., 3), of any length but 0, from a probe's capture point to its box.

    Negative or infinite where the capture point is not in the box.
    """
    box = spec.box
    start = box.coordinates(spec.capture_point[None])[0]
    ways = directions @ box.face_normals.T
    lengths = np.linalg.norm(directions, axis=-1)
    with np.errstate(divide="ignore"):
        return (np.abs(ways) / (box.half_widths - start * np.sign(ways))).max(-1) / lengths


def of_walls(spec: ProbeSpec) -> np.ndarray:
    """(2n, 4n) float32, 1/metres: the survey of a probe's empty box, put together from faces as surveys are."""
    faces = [
        along(spec, face_directions(face, spec.resolution, OVERSCAN))[..., None].astype(np.float32) for face in FACES
    ]
    return equirect.from_faces(faces, OVERSCAN)[..., 0]
