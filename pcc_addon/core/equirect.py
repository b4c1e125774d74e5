"""The picture that shaders read: equirectangular, as Blender's Environment Texture node maps directions.

Row 0 is the bottom (−Z); u = ½ − atan2(y, x) / 2π, v = ½ + asin(z) / π.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .cubemap import beyond_edges, face_shape, sample_faces


def directions(width: int, height: int, rows: slice = slice(None)) -> np.ndarray:
    """(rows, width, 3) float64 unit vectors through the texel centres, world space, row 0 at the bottom."""
    azimuth = np.pi - 2.0 * np.pi * (np.arange(width) + 0.5) / width
    elevation = np.pi * ((np.arange(height)[rows] + 0.5) / height - 0.5)
    across = np.cos(elevation)[:, None]
    z = np.broadcast_to(np.sin(elevation)[:, None], (len(elevation), width))
    return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), z], -1)


def coordinates(vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(u, v) in [0, 1] of world-space vectors (..., 3) of any length."""
    x, y, z = np.moveaxis(np.asarray(vectors, np.float64), -1, 0)
    return 0.5 - np.arctan2(y, x) / (2.0 * np.pi), 0.5 + np.arctan2(z, np.hypot(x, y)) / np.pi


def solid_angles(width: int, height: int) -> np.ndarray:
    """(height,) steradians of one texel in each row; all texels together make 4π exactly."""
    edges = np.sin(np.pi * (np.arange(height + 1) / height - 0.5))
    return np.diff(edges) * (2.0 * np.pi / width)


def from_faces(
    faces: Sequence[np.ndarray | None],
    overscan: int,
    rows_at_once: int = 64,
    axes: np.ndarray | None = None,
    before: np.ndarray | None = None,
) -> np.ndarray:
    """The equirectangular picture (2n, 4n, channels) float32 of six faces with n texels across 90°.

    Args:
        faces, overscan: as `sample_faces` has them; texels whose face is None are `cubemap.beyond_edges`.
        rows_at_once: of the picture; more take more memory.
        axes: (3, 3), columns: where the picture's axes point to, in the space of the faces; None: the same space.
        before: (2n, 4n, channels): texels whose face is None are as they are here instead.

    Raises:
        ValueError: there is no face.
    """
    resolution = face_shape(faces)[0] - 2 * overscan
    width, height = 4 * resolution, 2 * resolution
    whole = faces if before is not None else _guessed(faces, overscan)
    blocks = []
    for start in range(0, height, rows_at_once):
        rows = slice(start, start + rows_at_once)
        otherwise = None if before is None else before[rows]
        blocks.append(sample_faces(whole, overscan, _turned(directions(width, height, rows), axes), otherwise))
    return np.concatenate(blocks)


def _guessed(faces: Sequence[np.ndarray | None], overscan: int) -> list[np.ndarray]:
    """Faces with those that are not there in one colour."""
    size, channels = face_shape(faces)
    return [
        np.broadcast_to(beyond_edges(faces, overscan, k), (size, size, channels)) if face is None else face
        for k, face in enumerate(faces)
    ]


def _turned(vectors: np.ndarray, axes: np.ndarray | None) -> np.ndarray:
    return vectors if axes is None else vectors @ axes.T


def lookup(picture: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Bilinear lookup: (..., channels) for vectors (..., 3). Rows end at the poles (see `effects.lookup.OFF_POLES`)."""
    height, width = picture.shape[:2]
    u, v = coordinates(vectors)
    column, row = u * width - 0.5, v * height - 0.5
    c0, r0 = np.floor(column).astype(np.intp), np.floor(row).astype(np.intp)
    fc, fr = (column - c0)[..., None], (row - r0)[..., None]
    left, right = c0 % width, (c0 + 1) % width
    low, high = np.clip(r0, 0, height - 1), np.clip(r0 + 1, 0, height - 1)
    below = picture[low, left] * (1 - fc) + picture[low, right] * fc
    above = picture[high, left] * (1 - fc) + picture[high, right] * fc
    return below * (1 - fr) + above * fr
