"""Which room a probe's picture shows behind a window: its box, seen through one of its walls."""

from __future__ import annotations

from enum import Enum

import numpy as np

from .effects.interior import RoomPicture
from .sidecar import Sidecar


class Side(str, Enum):
    """The wall of a box, by its own axes, that the window is in."""

    MINUS_Y = "-Y"
    PLUS_Y = "+Y"
    MINUS_X = "-X"
    PLUS_X = "+X"


def room_of(record: Sidecar, side: Side, rows: int) -> RoomPicture:
    """The room that a bake shows through a wall of its box; `rows` is its picture's height.

    Up is the end of the box's own Z that is higher, so that boxes which stand on their heads show no room that does.
    """
    matrix = np.array(record.matrix, np.float64).reshape(4, 4)
    axes = dict(zip("XYZ", matrix[:3, :3].T, strict=True))
    away = axes[side.value[1]] * (1.0 if side.value[0] == "-" else -1.0)
    up = axes["Z"] * (-1.0 if axes["Z"][2] < 0.0 else 1.0)
    across = axes["XY".replace(side.value[1], "")]
    across = across * (-1.0 if across @ np.cross(away, up) < 0.0 else 1.0)
    capture = np.array(record.capture_point) - matrix[:3, 3]
    half_edges = tuple((float(x), float(y), float(z)) for x, y, z in (across, away, up))
    x, y, z = (float(c) for c in capture)
    return RoomPicture((half_edges[0], half_edges[1], half_edges[2]), (x, y, z), rows)
