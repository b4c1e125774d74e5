"""Room maps: one picture of 3 × 3 tiles that holds a room unfolded, as JIWindowBox and wParallax have it.

The middle tile is the back wall as one sees it through the window. The tiles around it are the walls that meet it
there: ceiling above, floor below, left and right wall beside it. Corners may hold flat pictures with alpha of what
stands in the room and of what hangs at the window; which corner holds which differs between authors.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

from .equirect import directions
from .errors import PccError


class Corner(str, Enum):
    """A corner tile."""

    TOP_LEFT = "top left"
    TOP_RIGHT = "top right"
    BOTTOM_LEFT = "bottom left"
    BOTTOM_RIGHT = "bottom right"


def tile(picture: np.ndarray, column: int, row: int) -> np.ndarray:
    """The tile in a column from the left and a row from the bottom of a room map (h, w, channels)."""
    height, width = picture.shape[:2]
    columns, rows = (np.round(np.linspace(0, n, 4)).astype(int) for n in (width, height))
    return picture[rows[row] : rows[row + 1], columns[column] : columns[column + 1]]


def corner(picture: np.ndarray, which: Corner) -> np.ndarray:
    """A corner tile."""
    vertical, _, horizontal = which.value.partition(" ")
    return tile(picture, 2 if horizontal == "right" else 0, 2 if vertical == "top" else 0)


def check_room_map(name: str, width: int, height: int) -> None:
    """Refuse what is no room map.

    Raises:
        PccError: it is too small to have 3 × 3 tiles, or an equirectangular picture.
    """
    if width == 2 * height:
        raise PccError(f"picture '{name}' has twice the width of its height: take it as an equirectangular one")
    if min(width, height) < 3:
        raise PccError(f"picture '{name}' of {width} × {height} pixels has no 3 × 3 tiles; choose a room map")


def equirectangular(picture: np.ndarray) -> np.ndarray:
    """A room map (h, w, channels), row 0 at the bottom, as an equirectangular picture of the room as a cube.

    The back wall is in its middle, as `RoomPicture` has it by default. The wall with the window, which no room map has,
    is the mean of the others. Height and width give each tile about as many texels as it has.
    """
    rows = 2 * max(2, round(max(picture.shape[:2]) / 3))
    found = np.empty((rows, 2 * rows, picture.shape[2]), np.float32)
    walls = [tile(picture, c, r) for c, r in ((1, 1), (0, 1), (2, 1), (1, 0), (1, 2))]
    mean = np.mean([wall.mean((0, 1)) for wall in walls], 0)
    for start in range(0, rows, 64):
        part = slice(start, start + 64)
        found[part] = _colors(walls, mean, directions(2 * rows, rows, part))
    return found


def _colors(walls: list[np.ndarray], mean: np.ndarray, looked: np.ndarray) -> np.ndarray:
    """What directions of the picture see; x is away from the window, −y to the right, z up."""
    away, right, up = looked[..., 0], -looked[..., 1], looked[..., 2]
    most = np.maximum(np.maximum(abs(away), abs(right)), abs(up))
    a, r, u = away / most, right / most, up / most
    back, left, to_right, floor, ceiling = walls
    # Across each tile, 0 … 1 from its left and from its bottom; the side that meets the back wall is a = 1.
    inward, outward = (1.0 + a) / 2.0, (1.0 - a) / 2.0
    x, y = (1.0 + r) / 2.0, (1.0 + u) / 2.0
    choices = [
        (a >= 1.0, back, x, y),
        (r <= -1.0, left, inward, y),
        (r >= 1.0, to_right, outward, y),
        (u <= -1.0, floor, x, inward),
        (u >= 1.0, ceiling, x, outward),
    ]
    found = np.broadcast_to(mean.astype(np.float32), (*looked.shape[:-1], len(mean))).copy()
    for on_wall, wall, s, t in reversed(choices):
        found[on_wall] = _read(wall, s[on_wall], t[on_wall])
    return found


def _read(wall: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Bilinear, the edges extended."""
    height, width = wall.shape[:2]
    column, row = np.clip(s * width - 0.5, 0, width - 1), np.clip(t * height - 0.5, 0, height - 1)
    c0, r0 = column.astype(np.intp), row.astype(np.intp)
    c1, r1 = np.minimum(c0 + 1, width - 1), np.minimum(r0 + 1, height - 1)
    fc, fr = (column - c0)[..., None], (row - r0)[..., None]
    below = wall[r0, c0] * (1 - fc) + wall[r0, c1] * fc
    return below * (1 - fr) + (wall[r1, c0] * (1 - fc) + wall[r1, c1] * fc) * fr
