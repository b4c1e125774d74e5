"""The layouts that cubemaps come in, and the equirectangular picture made of each.

Engines (OpenGL, DirectX) call a cubemap's faces px nx py ny pz nz: its space is left-handed with Y up, so that px is to
the right of pz, py above it and nz behind. Seen from inside nothing is mirrored, and that is kept: px is +X here, py is
+Z, and pz, straight ahead, is +Y, as in Blender's front view. Their faces then are those of `cubemap.FACES`, none of
them turned. Of equirectangular pictures the middle is +X, as in Blender's worlds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from . import equirect
from .cubemap import FACES, face_directions, find_faces, sample_faces
from .errors import ProbeError

ENGINE_FACES: dict[str, int] = {"px": 0, "nx": 1, "py": 4, "ny": 5, "pz": 2, "nz": 3}
"""Engines' names of faces in their order, with the place of each in `FACES`."""

_BORDER = 2  # texels that bicubic lookups read beyond a face


class Layout(Enum):
    """How a picture holds a whole surrounding: its name, and how many squares it is wide and high."""

    EQUIRECTANGULAR = ("equirectangular", 2, 1)
    HORIZONTAL_CROSS = ("horizontal cross", 4, 3)
    VERTICAL_CROSS = ("vertical cross", 3, 4)
    HORIZONTAL_STRIP = ("horizontal strip", 6, 1)
    VERTICAL_STRIP = ("vertical strip", 1, 6)

    def __init__(self, words: str, columns: int, rows: int) -> None:
        self.words, self.columns, self.rows = words, columns, rows

    @property
    def ratio(self) -> str:
        return f"{self.columns}:{self.rows}"


@dataclass(frozen=True)
class _Cell:
    """Where a face lies: squares from the left and from the top; and whether it stands on its head."""

    column: int
    row: int
    upside_down: bool = False


_MIDDLE = {"py": _Cell(1, 0), "nx": _Cell(0, 1), "pz": _Cell(1, 1), "px": _Cell(2, 1), "ny": _Cell(1, 2)}
_CELLS = {
    Layout.HORIZONTAL_CROSS: {**_MIDDLE, "nz": _Cell(3, 1)},
    Layout.VERTICAL_CROSS: {**_MIDDLE, "nz": _Cell(1, 3, upside_down=True)},
    Layout.HORIZONTAL_STRIP: {name: _Cell(k, 0) for k, name in enumerate(ENGINE_FACES)},
    Layout.VERTICAL_STRIP: {name: _Cell(0, k) for k, name in enumerate(ENGINE_FACES)},
}

ACCEPTED = (
    ", ".join(f"{layout.words} {layout.ratio}" for layout in Layout)
    + ", or six square files whose names end in px nx py ny pz nz (posx negx …, +x -x …, right left top bottom front "
    "back)"
)


def layout_of(name: str, width: int, height: int) -> Layout:
    """The layout of a picture of so many pixels, called `name` in errors.

    Raises:
        ProbeError: it has none that is known, or its faces would not be square.
    """
    for layout in Layout:
        if width * layout.rows == height * layout.columns:
            return layout
    nearest = min(Layout, key=lambda layout: abs(math.log(width * layout.rows / (height * layout.columns))))
    across, down = width / nearest.columns, height / nearest.rows
    why = f"{width}×{height} pixels is no layout of a cubemap"
    if 0.9 < across / down < 1.1:
        why += f" (as {nearest.words} its squares would be {across:.6g}×{down:.6g} pixels)"
    raise ProbeError(f"picture '{name}': {why}; accepted are {ACCEPTED}")


def unfold(picture: np.ndarray, layout: Layout) -> tuple[np.ndarray, ...]:
    """The six faces (n, n, channels) of a picture with faces, in the order of `FACES`; row 0 is at the bottom."""
    n = picture.shape[1] // layout.columns
    faces: dict[int, np.ndarray] = {}
    for name, cell in _CELLS[layout].items():
        bottom = (layout.rows - 1 - cell.row) * n
        face = picture[bottom : bottom + n, cell.column * n : (cell.column + 1) * n]
        faces[ENGINE_FACES[name]] = face[::-1, ::-1] if cell.upside_down else face
    return tuple(faces[k] for k in range(len(FACES)))


def six_faces(pictures: Sequence[np.ndarray], names: Sequence[str]) -> tuple[np.ndarray, ...]:
    """Six pictures in the engines' order as faces in the order of `FACES`.

    Args:
        pictures: (n, n, channels) each, row 0 at the bottom.
        names: of their files, for errors.

    Raises:
        ProbeError: one is not square, or not of the size of the others.
    """
    size = pictures[0].shape[1]
    for picture, name in zip(pictures, names, strict=True):
        height, width = picture.shape[:2]
        if width != height:
            raise ProbeError(f"picture '{name}': {width}×{height} pixels is no square, as each of six faces must be")
        if width != size:
            raise ProbeError(
                f"picture '{name}': {width}×{height} pixels, but '{names[0]}' has {size}×{size}; give all six one size"
            )
    by_place = dict(zip(ENGINE_FACES.values(), pictures, strict=True))
    return tuple(by_place[k] for k in range(len(FACES)))


def from_picture(picture: np.ndarray, layout: Layout, resolution: int) -> np.ndarray:
    """The equirectangular picture (2n, 4n, channels) float32 that a probe of n texels a face shows.

    One that is equirectangular and of that size already stays as it is; larger ones are averaged by solid angle.

    Args:
        picture: (height, width, channels), row 0 at the bottom, of a layout's shape.
    """
    if layout is not Layout.EQUIRECTANGULAR:
        return from_faces(unfold(picture, layout), resolution)
    if picture.shape[0] == 2 * resolution:
        return np.asarray(picture, np.float32)
    factor = math.ceil(picture.shape[0] / (2 * resolution))
    return _averaged(lambda vectors: equirect.lookup(picture, vectors), resolution, factor)


def from_faces(faces: Sequence[np.ndarray], resolution: int) -> np.ndarray:
    """As `from_picture`, of six faces (m, m, channels) in the order of `FACES`, none with anything beyond its 90°."""
    bordered = [_bordered(faces, k) for k in range(len(FACES))]
    factor = math.ceil(faces[0].shape[0] / resolution)
    return _averaged(lambda vectors: sample_faces(bordered, _BORDER, vectors), resolution, factor)


def _averaged(look: Callable[[np.ndarray], np.ndarray], resolution: int, factor: int) -> np.ndarray:
    """What `look` finds along the directions of a picture's texels, each the mean over its solid angle.

    Args:
        look: values (..., channels) of directions (..., 3).
        resolution: n of a picture (2n, 4n, channels).
        factor: a texel is sampled so many times up and across.
    """
    height, width = 2 * resolution, 4 * resolution
    weights = equirect.solid_angles(width * factor, height * factor).reshape(height, factor)
    weights /= factor * weights.sum(1, keepdims=True)
    rows = max(1, 2**20 // (width * factor * factor))  # of the result at once
    blocks = []
    for start in range(0, height, rows):
        end = min(start + rows, height)
        seen = look(equirect.directions(width * factor, height * factor, slice(start * factor, end * factor)))
        parts = seen.reshape(end - start, factor, width, factor, -1)
        blocks.append(np.einsum("rfwgc,rf->rwc", parts, weights[start:end]).astype(np.float32))
    return np.concatenate(blocks)


def _bordered(faces: Sequence[np.ndarray], index: int) -> np.ndarray:
    """A face with what its neighbours show beyond its edges, looked up between their texels."""
    n = faces[index].shape[0]
    vectors = face_directions(FACES[index], n, _BORDER)
    result = np.empty((*vectors.shape[:2], faces[index].shape[2]), np.float32)
    beyond = np.ones(vectors.shape[:2], bool)
    beyond[_BORDER : _BORDER + n, _BORDER : _BORDER + n] = False
    result[~beyond] = faces[index].reshape(n * n, -1)
    result[beyond] = _bilinear(faces, vectors[beyond])
    return result


def _bilinear(faces: Sequence[np.ndarray], vectors: np.ndarray) -> np.ndarray:
    """Lookup of directions (k, 3) in faces, each as if it went on beyond its edges as it ends there."""
    n = faces[0].shape[0]
    result = np.empty((len(vectors), faces[0].shape[2]), np.float32)
    for k, chosen, a, b in find_faces(vectors):
        column, row = (np.clip((c + 1.0) * (0.5 * n) - 0.5, 0.0, n - 1.0) for c in (a, b))
        left, low = (np.minimum(c.astype(np.intp), max(n - 2, 0)) for c in (column, row))
        right, high = np.minimum(left + 1, n - 1), np.minimum(low + 1, n - 1)
        fc, fr = (column - left)[:, None], (row - low)[:, None]
        below = faces[k][low, left] * (1.0 - fc) + faces[k][low, right] * fc
        above = faces[k][high, left] * (1.0 - fc) + faces[k][high, right] * fc
        result[chosen] = below * (1.0 - fr) + above * fr
    return result
