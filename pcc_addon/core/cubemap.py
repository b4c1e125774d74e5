"""The six faces of a capture: where each looks, and how a direction finds its colour in them.

Convention (written into every sidecar): faces look along the world axes; rows run from the bottom up, as in
Blender's images; a texel of face f at (a, b) ∈ [−1, 1]² lies in the direction forward + a·right + b·up.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Face:
    """One 90° picture; world-space unit axes."""

    name: str
    forward: tuple[int, int, int]
    right: tuple[int, int, int]
    up: tuple[int, int, int]

    @property
    def rotation(self) -> np.ndarray:
        """(3, 3) camera-to-world matrix: columns right, up, −forward, as a Blender camera has its axes."""
        return np.array([self.right, self.up, [-c for c in self.forward]], np.float64).T


FACES: tuple[Face, ...] = (
    Face("+X", (1, 0, 0), (0, -1, 0), (0, 0, 1)),
    Face("-X", (-1, 0, 0), (0, 1, 0), (0, 0, 1)),
    Face("+Y", (0, 1, 0), (1, 0, 0), (0, 0, 1)),
    Face("-Y", (0, -1, 0), (-1, 0, 0), (0, 0, 1)),
    Face("+Z", (0, 0, 1), (1, 0, 0), (0, -1, 0)),
    Face("-Z", (0, 0, -1), (1, 0, 0), (0, 1, 0)),
)

FACE_NAMES: tuple[str, ...] = tuple(face.name for face in FACES)

CROSS = {"+Z": (1, 0), "-X": (0, 1), "+Y": (1, 1), "+X": (2, 1), "-Y": (3, 1), "-Z": (1, 2)}
"""Columns from the left and rows from the top in which each face of an unfolded cube has its neighbours beside it."""

OVERSCAN = 8
"""Pixels rendered on each side of a face, so that denoising and filtering at an edge have real neighbours."""


def face_directions(face: Face, resolution: int, overscan: int = 0) -> np.ndarray:
    """World-space directions through the texel centres of a face, not normalised.

    Args:
        resolution: texels across the 90° face.
        overscan: further texels on each side.

    Returns:
        (resolution + 2·overscan, same, 3) float64, row 0 at the bottom.
    """
    axis = (np.arange(-overscan, resolution + overscan) + 0.5) * (2.0 / resolution) - 1.0
    right, up, forward = (np.array(v, np.float64) for v in (face.right, face.up, face.forward))
    return forward + axis[None, :, None] * right + axis[:, None, None] * up


def sample_faces(
    faces: Sequence[np.ndarray | None], overscan: int, directions: np.ndarray, otherwise: np.ndarray | None = None
) -> np.ndarray:
    """Bicubic (Catmull-Rom) lookup of directions in six faces; a value never leaves the range of its 4 neighbours.

    Args:
        faces: six arrays (n, n, channels) in the order of `FACES`, n = resolution + 2·overscan, row 0 at the bottom;
            None for those that are not there, at least one is; `otherwise` says what they have.
        overscan: texels that each face holds beyond its 90°, at least 2: lookups at an edge read real pixels.
        directions: (..., 3), world space, not zero.
        otherwise: (..., channels): what directions have whose faces are not there; None where all are.

    Returns:
        (..., channels) float32.

    Raises:
        ValueError: the overscan is below 2 texels, or there is no face, or one that is asked for is not there.
    """
    if overscan < 2:
        raise ValueError(f"bicubic lookup needs an overscan of at least 2 texels, not {overscan}")
    size, channels = face_shape(faces)
    resolution = size - 2 * overscan
    flat = np.asarray(directions, np.float64).reshape(-1, 3)
    result = np.empty((len(flat), channels), np.float32)
    for k, chosen, a, b in find_faces(flat):
        picture = faces[k]
        if picture is None:
            if otherwise is None:
                raise ValueError(f"face {FACES[k].name} is not there, and nothing is given otherwise")
            result[chosen] = otherwise.reshape(-1, channels)[chosen]
            continue
        column = (a + 1.0) * (0.5 * resolution) - 0.5 + overscan
        row = (b + 1.0) * (0.5 * resolution) - 0.5 + overscan
        result[chosen] = bicubic(picture, row, column)
    return result.reshape(*np.shape(directions)[:-1], -1)


def beyond_edges(faces: Sequence[np.ndarray | None], overscan: int, k: int) -> np.ndarray:
    """(channels,) float32: the mean of what the others' overscan shows of a face that is not there; 0 if none does."""
    size, channels = face_shape(faces)
    seen = np.zeros((0, channels), np.float32)
    for face, picture in zip(FACES, faces, strict=True):
        if picture is not None:
            directions = face_directions(face, size - 2 * overscan, overscan).reshape(-1, 3)
            for found, chosen, _, _ in find_faces(directions):
                if found == k:
                    seen = np.concatenate([seen, picture.reshape(-1, channels)[chosen]])
    return seen.mean(0, dtype=np.float64).astype(np.float32) if len(seen) else np.zeros(channels, np.float32)


def face_shape(faces: Sequence[np.ndarray | None]) -> tuple[int, int]:
    """How many texels faces have across, and how many channels.

    Raises:
        ValueError: there is none.
    """
    there = next((face for face in faces if face is not None), None)
    if there is None:
        raise ValueError("a picture needs at least one face")
    return there.shape[0], there.shape[2]


def find_faces(directions: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray, np.ndarray]]:
    """Which faces directions (n, 3) float64 meet, and where.

    Yields:
        For each face that is met: its place in `FACES`, the indices (k,) of its directions, and their a and b (k,).
    """
    axis = np.abs(directions).argmax(-1)
    index = 2 * axis + (np.take_along_axis(directions, axis[:, None], -1)[:, 0] < 0)
    for k, face in enumerate(FACES):
        chosen = np.flatnonzero(index == k)
        if not len(chosen):
            continue
        d = directions[chosen]
        depth = d @ np.array(face.forward, np.float64)
        yield k, chosen, *(d @ np.array(axis, np.float64) / depth for axis in (face.right, face.up))


def bicubic(image: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """(k, channels) float32 between texels of an image (h, w, channels), Catmull-Rom within the 4 neighbours' range.

    Args:
        image: of float32.
        row, column: (k,) where the centre of the first texel is at 0; two texels lie around each on all sides.
    """
    r0, c0 = np.floor(row).astype(np.intp), np.floor(column).astype(np.intp)
    row_weights = _catmull_rom((row - r0).astype(np.float32))
    column_weights = _catmull_rom((column - c0).astype(np.float32))
    total = np.zeros((len(row), image.shape[2]), np.float32)
    low = np.full_like(total, np.inf)
    high = np.full_like(total, -np.inf)
    for i in range(4):
        line = np.zeros_like(total)
        for j in range(4):
            texel = image[r0 + i - 1, c0 + j - 1]
            line += texel * column_weights[j][:, None]
            if i in (1, 2) and j in (1, 2):
                np.minimum(low, texel, out=low)
                np.maximum(high, texel, out=high)
        total += line * row_weights[i][:, None]
    return np.clip(total, low, high)


def _catmull_rom(t: np.ndarray) -> tuple[np.ndarray, ...]:
    return (
        0.5 * t * (t * (2.0 - t) - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
        0.5 * t * t * (t - 1.0),
    )
