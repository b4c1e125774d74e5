"""What the viewport shows of a misfit, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...core.accuracy.misfit import Misfit, at
from ...core.accuracy.misfit_pictures import coloured, scale_end
from ...core.accuracy.unseen import Unseen

_CELLS = 64  # across a wall
_INSET = 0.995  # of the half widths: the walls of the room lie there too
_FAINT, _STRONG, _SOON = 0.15, 0.75, 0.2  # opacity on the box and off it, from which share of the scale on
_LIFT = 0.002  # of the box's size: patches over their surfaces
_COVER = 0.3  # half a patch's side over the distance between samples


@dataclass(frozen=True, eq=False)
class Walls:
    """The inner sides of a box.

    Attributes:
        points: (n, 3) float32, world space, metres.
        colours: (n, 4) float32, sRGB and alpha.
        triangles: (t, 3) int32, counter-clockwise as seen from within.
    """

    points: np.ndarray
    colours: np.ndarray
    triangles: np.ndarray


def walls(found: Misfit) -> Walls:
    """The walls of a box, in the colours of its pictures."""
    box = found.spec.box
    line = np.linspace(-1.0, 1.0, _CELLS + 1)
    across, along = (grid.ravel() for grid in np.meshgrid(line, line, indexing="ij"))
    first = np.arange(_CELLS * (_CELLS + 1)).reshape(_CELLS, _CELLS + 1)[:, :-1].ravel()
    corners = np.stack([first, first + _CELLS + 1, first + _CELLS + 2, first + 1], -1)  # counter-clockwise
    handed = np.linalg.det(box.face_normals) > 0.0
    places, triangles = [], []
    for axis in range(3):
        for sign in (1.0, -1.0):
            unit = np.empty((len(across), 3))
            unit[:, axis], unit[:, (axis + 1) % 3], unit[:, (axis + 2) % 3] = sign, across, along
            turned = corners[:, ::-1] if (sign > 0.0) == handed else corners
            whole = np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])
            triangles.append(whole + len(places) * len(across))
            places.append(unit * box.half_widths * _INSET)
    points = box.centre + np.concatenate(places) @ np.linalg.inv(box.face_normals).T
    offsets, end = at(found.offsets, points - found.spec.capture_point), scale_end(found)
    off = np.minimum(np.abs(offsets) / (_SOON * end), 1.0)
    alpha = _FAINT + (_STRONG - _FAINT) * off
    colours = np.concatenate([coloured(offsets, end), alpha[:, None]], -1)
    return Walls(
        np.ascontiguousarray(points, np.float32),
        np.ascontiguousarray(colours, np.float32),
        np.ascontiguousarray(np.concatenate(triangles), np.int32),
    )


@dataclass(frozen=True, eq=False)
class Patches:
    """A square on each sample that is not seen.

    Attributes:
        points: (4k, 3) float32, world space, metres.
        triangles: (2k, 3) int32, counter-clockwise as seen from the side that is not seen.
    """

    points: np.ndarray
    triangles: np.ndarray


def patches(found: Misfit, hidden: Unseen) -> Patches:
    """Squares that lie a little over the surfaces and cover a third of them."""
    normals = hidden.normals
    helper = np.where(np.abs(normals[:, 2:]) < 0.9, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    across = np.cross(helper, normals)
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    along = np.cross(normals, across)
    lift = _LIFT * float(found.spec.box.half_extents.max())
    half = _COVER * np.sqrt(hidden.sample_area)
    middle = hidden.points + lift * normals
    corners = [middle + half * (a * across + b * along) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    first = 4 * np.arange(len(middle))[:, None]
    triangles = np.concatenate([first + np.array(corner) for corner in ((0, 1, 2), (0, 2, 3))])
    points = np.stack(corners, 1).reshape(-1, 3)
    return Patches(np.ascontiguousarray(points, np.float32), np.ascontiguousarray(triangles, np.int32))
