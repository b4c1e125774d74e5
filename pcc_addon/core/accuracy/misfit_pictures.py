"""A misfit as pictures: all around, and on the six faces."""

from __future__ import annotations

import numpy as np

from .. import equirect
from ..cubemap import FACES, face_directions
from ..probe import ProbeSpec
from . import colours
from .lettering import write
from .misfit import Misfit, at
from .misfit_words import length
from .scales import rounded_up, with_bar

NOTHING = (0.30, 0.30, 0.34)
"""sRGB where nothing is seen."""

# Columns and rows in which each face has its neighbours beside it.
_CROSS = {"+Z": (1, 0), "-X": (0, 1), "+Y": (1, 1), "+X": (2, 1), "-Y": (3, 1), "-Z": (1, 2)}
_PAPER, _INK = (24, 24, 24), (20, 20, 20)
_EDGE = 0.72  # of the brightness elsewhere
_MOST, _LEAST = 98.0, 0.01  # per cent of the texels that the scale holds; metres of the shortest scale


def scale_end(found: Misfit) -> float:
    """Metres at the ends of the colour scale: what 98 % of the texels need, rounded up, at least a centimetre."""
    there = np.abs(found.offsets[np.isfinite(found.offsets)])
    return rounded_up(max(float(np.percentile(there, _MOST)) if there.size else 0.0, _LEAST))


def coloured(offsets: np.ndarray, end: float) -> np.ndarray:
    """(…, 3) float64 sRGB of metres (…) from the box: red before it, nearly white on it, blue beyond, grey: nothing."""
    shown = colours.signed(np.where(np.isinf(offsets), 0.0, offsets) / end)
    return np.where(np.isinf(offsets)[..., None], NOTHING, shown)


def all_around(found: Misfit) -> np.ndarray:
    """The equirectangular picture of a misfit, (h, w, 3) uint8 sRGB, row 0 at the top, with its scale under it."""
    end = scale_end(found)
    height, width = found.offsets.shape
    vectors = equirect.directions(width, height)
    return _with_scale(_drawn(found, vectors, end), end)


def cross(found: Misfit) -> np.ndarray:
    """The six faces along the world's axes, unfolded and named, (h, w, 3) uint8 sRGB, row 0 at the top, with the scale.

    The sides stand in a row as one sees them when one turns to the right; above and below +Y the ceiling and the floor.
    """
    end, n = scale_end(found), found.spec.resolution
    picture = np.empty((3 * n, 4 * n, 3), np.uint8)
    picture[:] = _PAPER
    for face in FACES:
        column, row = _CROSS[face.name]
        drawn = _drawn(found, face_directions(face, n), end)
        write(drawn, face.name, n // 16, n // 16, _INK, scale=max(1, n // 64))
        drawn[[0, -1]] = drawn[:, [0, -1]] = _PAPER
        picture[row * n : (row + 1) * n, column * n : (column + 1) * n] = drawn
    return _with_scale(picture, end)


def _drawn(found: Misfit, vectors: np.ndarray, end: float) -> np.ndarray:
    """(h, w, 3) uint8, row 0 at the top: the misfit in directions (h, w, 3), row 0 at the bottom, and the box's edges."""
    picture = coloured(at(found.offsets, vectors), end)
    wall = wall_of(found.spec, vectors)
    edge = np.zeros(wall.shape, bool)
    edge[1:] |= wall[1:] != wall[:-1]
    edge[:, 1:] |= wall[:, 1:] != wall[:, :-1]
    picture[edge] *= _EDGE
    return colours.as_bytes(picture)[::-1].copy()


def wall_of(spec: ProbeSpec, vectors: np.ndarray) -> np.ndarray:
    """(…) int 0 … 5: which wall of the box rays along (…, 3) from the capture point meet, +X, −X, +Y … of its own."""
    ways = vectors @ spec.box.face_normals.T
    start = spec.box.coordinates(spec.capture_point[None])[0]
    ahead = spec.box.half_widths - start * np.sign(ways)
    far = np.divide(ahead, np.abs(ways), out=np.full(ways.shape, np.inf), where=ways != 0.0)
    axis = far.argmin(-1)
    return 2 * axis + (np.take_along_axis(ways, axis[..., None], -1)[..., 0] < 0.0)


def _with_scale(picture: np.ndarray, end: float) -> np.ndarray:
    marks = [(0.0, f"{length(end)} before"), (0.5, "on the box"), (1.0, f"{length(end)} beyond")]
    bar = colours.signed(np.linspace(-1.0, 1.0, 513))
    return with_bar(picture, bar, marks)
