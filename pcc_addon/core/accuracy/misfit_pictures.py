"""A misfit as pictures: all around, and on the six faces."""

from __future__ import annotations

import numpy as np

from .. import equirect
from ..cubemap import CROSS, FACES, face_directions
from ..probe import ProbeSpec
from . import colours
from .lettering import write
from .misfit import ON_THE_BOX, Misfit, at
from .misfit_words import length
from .scales import rounded_up, with_bar
from .unseen import Unseen

NOTHING = (0.30, 0.30, 0.34)
"""sRGB where nothing is seen."""

UNSEEN = (0.85, 0.0, 0.35)
"""sRGB of what the capture point does not see."""

_SHADE = 0.35
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
        column, row = CROSS[face.name]
        drawn = _drawn(found, face_directions(face, n), end)
        write(drawn, face.name, n // 16, n // 16, _INK, scale=max(1, n // 64))
        drawn[[0, -1]] = drawn[:, [0, -1]] = _PAPER
        picture[row * n : (row + 1) * n, column * n : (column + 1) * n] = drawn
    return _with_scale(picture, end)


def unseen_around(found: Misfit, hidden: Unseen) -> np.ndarray:
    """Where the samples lie that the capture point does not see, (h, w, 3) uint8 sRGB, row 0 at the top, with a legend.

    All around, as `all_around`; behind what hides them. What is before the box is darker than the box.
    """
    height, width = found.offsets.shape
    vectors = equirect.directions(width, height)
    plain = np.where(found.offsets < -ON_THE_BOX, -_SHADE, 0.0)
    picture = _edged(found.spec, vectors, np.repeat(0.9 + plain[..., None], 3, -1))
    mark = np.zeros((height, width), bool)
    u, v = equirect.coordinates(hidden.points - found.spec.capture_point)
    mark[np.minimum((v * height).astype(np.intp), height - 1), (u * width).astype(np.intp) % width] = True
    picture[mark] = UNSEEN
    bar = np.array([[0.9] * 3, [0.9 - _SHADE] * 3, UNSEEN])
    marks = [(0.0, "the box"), (0.5, "things"), (1.0, "not seen")]
    return with_bar(colours.as_bytes(picture)[::-1], bar, marks)


def _drawn(found: Misfit, vectors: np.ndarray, end: float) -> np.ndarray:
    """(h, w, 3) uint8, row 0 at the top: misfit and edges of the box in directions (h, w, 3), row 0 at the bottom."""
    return colours.as_bytes(_edged(found.spec, vectors, coloured(at(found.offsets, vectors), end)))[::-1].copy()


def _edged(spec: ProbeSpec, vectors: np.ndarray, picture: np.ndarray) -> np.ndarray:
    """A picture (h, w, 3) of directions (h, w, 3) with the edges of the box darker."""
    wall = wall_of(spec, vectors)
    edge = np.zeros(wall.shape, bool)
    edge[1:] |= wall[1:] != wall[:-1]
    edge[:, 1:] |= wall[:, 1:] != wall[:, :-1]
    return np.where(edge[..., None], picture * _EDGE, picture)


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
