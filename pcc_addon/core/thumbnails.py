"""Small pictures of a bake, to be looked at: a chrome ball, and the six faces unfolded.

They are made of the equirectangular picture, so their axes are its own: those of the world for a bake, those of the
box for pictures that are stretched to it. Values are sRGB with alpha, 0 … 1, row 0 at the bottom, as Blender's images.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from . import equirect
from .accuracy.colours import from_linear
from .cubemap import CROSS, FACE_NAMES, FACES, face_directions

_GUESSED = 0.35  # opacity of faces that were not captured
_MIDDLE_GREY, _WHITE = 0.18, 4.0  # of the mean in stops; the least value that is shown white, in units of the first
_DARKEST = 1e-6  # radiance that counts as black
_FINER = 2  # rays a pixel of the ball, up and across


def reduced(picture: np.ndarray, height: int) -> np.ndarray:
    """A picture (h, 2h, 3) of about so many rows, each texel the mean of those it stands for, weighted by solid angle.

    One that is not larger stays as it is.
    """
    rows, columns = picture.shape[:2]
    if rows <= height:
        return picture
    low = np.arange(height) * rows // height
    left = np.arange(2 * height) * columns // (2 * height)
    weights = equirect.solid_angles(columns, rows).astype(np.float32)
    narrow = np.add.reduceat(picture, left, axis=1) / np.diff(left, append=columns)[:, None].astype(np.float32)
    total = np.add.reduceat(narrow * weights[:, None, None], low, axis=0)
    return total / np.add.reduceat(weights, low)[:, None, None]


def chrome_ball(picture: np.ndarray, size: int) -> np.ndarray:
    """(size, size, 4) float32: a mirror ball at the capture point, as one sees it from far in front (from −Y).

    Its middle shows what is behind the one who looks, its rim what is behind the ball; +X is to the right.

    Args:
        picture: (h, 2h, 3) linear, equirectangular.
    """
    n = size * _FINER
    axis = (np.arange(n) + 0.5) * (2.0 / n) - 1.0
    x, z = np.broadcast_to(axis, (n, n)), np.broadcast_to(axis[:, None], (n, n))
    nearer = 1.0 - x * x - z * z
    on = nearer > 0.0
    normals = np.stack([x, -np.sqrt(np.where(on, nearer, 0.0)), z], -1)
    mirrored = np.array([0.0, 1.0, 0.0]) - 2.0 * normals[..., 1:2] * normals
    seen = np.where(on[..., None], equirect.lookup(picture, mirrored), 0.0)
    seen, share = _coarser(seen), _coarser(on[..., None].astype(np.float64))
    return _shown(seen / np.maximum(share, 1e-9), share, _exposure(picture))


def unfolded(picture: np.ndarray, size: int, captured: Collection[str] = FACE_NAMES) -> np.ndarray:
    """(3·size, 4·size, 4) float32: the six faces as a cross, +Y in the middle, +X to its right and +Z above.

    The four sides stand in a row as one sees them when one turns to the right. Nothing is mirrored.

    Args:
        picture: (h, 2h, 3) linear, equirectangular.
        size: pixels across a face.
        captured: the faces that were; others were guessed, and are faint.
    """
    cross, exposure = np.zeros((3 * size, 4 * size, 4), np.float32), _exposure(picture)
    for face in FACES:
        column, row = CROSS[face.name][0], 2 - CROSS[face.name][1]
        seen = equirect.lookup(picture, face_directions(face, size))
        opacity = np.full((size, size, 1), 1.0 if face.name in captured else _GUESSED)
        cross[row * size : (row + 1) * size, column * size : (column + 1) * size] = _shown(seen, opacity, exposure)
    return cross


def _coarser(values: np.ndarray) -> np.ndarray:
    n = len(values) // _FINER
    return values.reshape(n, _FINER, n, _FINER, -1).mean((1, 3))


def _exposure(picture: np.ndarray) -> float:
    """What radiance is multiplied by, so that the mean of its logarithm is middle grey; 1 where all is black."""
    luminance = np.maximum(picture, 0.0) @ np.array([0.2126, 0.7152, 0.0722])
    lit = luminance > _DARKEST
    if not lit.any():
        return 1.0
    weights = np.broadcast_to(equirect.solid_angles(picture.shape[1], picture.shape[0])[:, None], luminance.shape)
    return float(_MIDDLE_GREY / np.exp(np.average(np.log(luminance[lit]), weights=weights[lit])))


def _shown(radiance: np.ndarray, opacity: np.ndarray, exposure: float) -> np.ndarray:
    """Radiance (…, 3) tone-mapped (Reinhard's curve, with a white) and encoded, with opacity (…, 1) behind it."""
    x = np.maximum(radiance, 0.0) * exposure
    mapped = x * (1.0 + x / _WHITE**2) / (1.0 + x)
    return np.concatenate([from_linear(mapped), opacity], -1).astype(np.float32)
