"""Cubemaps as graphics hardware samples them, with a level for each step of roughness.

OpenGL, Vulkan, Direct3D, Metal and WebGPU agree: faces +X, −X, +Y, −Y, +Z, −Z, the first row of each where t = 0, and
the s and t of a direction by one table (OpenGL 4.6 specification, table 8.19).
"""

from __future__ import annotations

import numpy as np

from .. import equirect
from ..cubemap import bicubic

# For each face: its middle, where s grows to and where t grows to.
SAMPLED_FACES: tuple[tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]], ...] = (
    ((1, 0, 0), (0, 0, -1), (0, -1, 0)),
    ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    ((0, 0, 1), (1, 0, 0), (0, -1, 0)),
    ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
)
FACE_FILES = ("px", "nx", "py", "ny", "pz", "nz")

Level = np.ndarray
"""(6, n, n, 3) float32, the first row on top."""


def texel_directions(width: int) -> np.ndarray:
    """(6, width, width, 3) float64: in the sampler's space, through the texels' centres, not normalised."""
    axis = (np.arange(width) + 0.5) * (2.0 / width) - 1.0
    faces = np.array(SAMPLED_FACES, np.float64)
    middle, right, down = (faces[:, k, None, None, :] for k in range(3))
    return middle + axis[None, None, :, None] * right + axis[None, :, None, None] * down


def sample(level: Level, directions: np.ndarray) -> np.ndarray:
    """The nearest texels (..., 3) that a sampler finds along directions (..., 3) of its space."""
    flat = np.asarray(directions, np.float64).reshape(-1, 3)
    faces = np.array(SAMPLED_FACES, np.float64)
    face = (flat @ faces[:, 0].T).argmax(1)
    depth, s, t = (np.einsum("nk,nk->n", flat, faces[face, k]) for k in range(3))
    width = level.shape[1]
    column, row = (np.clip(((c / depth + 1.0) * 0.5 * width).astype(np.intp), 0, width - 1) for c in (s, t))
    return level[face, row, column].reshape(np.shape(directions))


def level(picture: np.ndarray, to_world: np.ndarray, width: int, *, sharp: bool) -> Level:
    """The faces of an equirectangular picture.

    Args:
        picture: (h, 2h, 3) float32, along Blender's world axes.
        to_world: (3, 3): from the sampler's space to Blender's world.
        width: texels across a face.
        sharp: whether to look it up as sharply as can be; for what is blurred the mean of four texels will do.
    """
    look = bicubic_lookup if sharp else equirect.lookup
    return np.stack([look(picture, face @ to_world.T) for face in texel_directions(width)]).astype(np.float32)


def bicubic_lookup(picture: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """As `equirect.lookup`, but sharp, and across the poles: (..., channels) for directions (..., 3)."""
    height, width = picture.shape[:2]
    over = np.roll(picture, width // 2, 1)  # beyond a pole lies the other side
    tall = np.concatenate([over[_BORDER - 1 :: -1], picture, over[: -_BORDER - 1 : -1]])
    whole = np.concatenate([tall[:, -_BORDER:], tall, tall[:, :_BORDER]], 1)
    flat = np.asarray(directions).reshape(-1, 3)
    u, v = equirect.coordinates(flat)
    found = bicubic(whole, v * height - 0.5 + _BORDER, u * width - 0.5 + _BORDER)
    return found.reshape(*np.shape(directions)[:-1], -1)


_BORDER = 2  # texels that a bicubic lookup reads beyond
