"""The layouts: which direction a picture keeps where, and how a shader finds that place."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACES
from pcc_addon.core.effects.lookup import DIRECTION, OFF_POLES, steepest_slope
from pcc_addon.core.expression import (
    Expr,
    absolute,
    combine,
    dot,
    greatest,
    maximum,
    multiply_add,
    sign,
)

GUTTER = 4  # texels of real picture beyond each edge of the atlas's faces and of the octahedral square
SEAM_REACH = 2.0  # texels: what counts as being at a seam


class Layout(ABC):
    """Where a picture keeps which direction."""

    label: ClassVar[str]
    node_type: ClassVar[str]

    @property
    @abstractmethod
    def size(self) -> tuple[int, int]:
        """Width and height, texels."""

    @abstractmethod
    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        """(rows, oversampling · width, 3): directions through a grid of points, `oversampling` across a texel."""

    @abstractmethod
    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        """Distances (...) from directions (..., 3) to each kind of place where the layout is cut, in texels."""

    def coordinates(self) -> Expr | None:
        """What the texture node is asked for, from the input DIRECTION; None where it takes the direction itself."""
        return None

    def constants(self) -> dict[str, float]:
        """Values of the other inputs of `coordinates`, by name."""
        return {}


@dataclass(frozen=True)
class Equirectangular(Layout):
    """4N × 2N, read by the Environment Texture node alone."""

    resolution: int
    label = "equirectangular"
    node_type = "ShaderNodeTexEnvironment"

    @property
    def size(self) -> tuple[int, int]:
        return 4 * self.resolution, 2 * self.resolution

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        width, height = self.size
        return equirect.directions(oversampling * width, oversampling * height, rows)

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        u, v = equirect.coordinates(directions)
        width, height = self.size
        pole = np.minimum(v, 1.0 - v) * height
        meridian = np.minimum(u, 1.0 - u) * width
        return {"−X meridian": np.where(pole > SEAM_REACH, meridian, np.inf), "poles": pole}


@dataclass(frozen=True)
class GuardedEquirectangular(Equirectangular):
    """The same picture as the add-on reads it: no nearer to a pole than the centres of its first and last rows."""

    label = "equirectangular, poles guarded"

    def coordinates(self) -> Expr:
        return OFF_POLES.outputs["Direction"]

    def constants(self) -> dict[str, float]:
        return {"Steepest": steepest_slope(self.size[1])}


@dataclass(frozen=True)
class Atlas(Layout):
    """Faces with gutters: a column for each axis, its positive face below its negative one."""

    face: int
    label = "3×2 face atlas"
    node_type = "ShaderNodeTexImage"

    @property
    def cell(self) -> int:
        """Width of a face with its gutters, texels."""
        return self.face + 2 * GUTTER

    @property
    def size(self) -> tuple[int, int]:
        return 3 * self.cell, 2 * self.cell

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        k = oversampling
        axis = (np.arange(-k * GUTTER, k * (self.face + GUTTER)) + 0.5) * (2.0 / (k * self.face)) - 1.0
        cell_row, points = np.divmod(np.arange(2 * len(axis))[rows], len(axis))
        lines = []
        for row in range(2):
            b = axis[points[cell_row == row], None, None]
            frames = [[np.array(v, float) for v in (f.forward, f.right, f.up)] for f in FACES[row::2]]
            lines.append(np.concatenate([forward + axis[:, None] * right + b * up for forward, right, up in frames], 1))
        return np.concatenate(lines)

    def coordinates(self) -> Expr:
        size = absolute(DIRECTION)
        depth = greatest(size)
        longest = 1.0 - sign(depth - size)  # 1 for the longest components; of equal ones the first counts
        on_x = longest.x
        on_y = longest.y * (1.0 - on_x)
        on_z = 1.0 - on_x - on_y
        side = sign(dot(DIRECTION, combine(on_x, on_y, on_z)))
        right = combine(multiply_add(side, on_y, on_z), (0.0 - side) * on_x, 0.0)
        up = combine(0.0, (0.0 - side) * on_z, 1.0 - on_z)
        reach = self.face / self.cell / 2.0  # of a face's half width, in cells
        column = multiply_add(on_z, 2.0, on_y)
        u = multiply_add(dot(DIRECTION, right) / depth, reach / 3.0, multiply_add(column, 1.0 / 3.0, 1.0 / 6.0))
        v = multiply_add(dot(DIRECTION, up) / depth, reach / 2.0, multiply_add(side, -0.25, 0.5))
        return combine(u, v, 0.0)

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        ordered = np.sort(np.abs(directions), -1)
        return {"face edges": (1.0 - ordered[..., 1] / ordered[..., 2]) * (0.5 * self.face)}


@dataclass(frozen=True)
class Octahedral(Layout):
    """The sphere unfolded to a square by way of the octahedron; −Z is at its corners. Source: Engelhardt and
    Dachsbacher, "Octahedron Environment Maps", 2008."""

    inner: int
    label = "octahedral"
    node_type = "ShaderNodeTexImage"

    @property
    def size(self) -> tuple[int, int]:
        return self.inner + 2 * GUTTER, self.inner + 2 * GUTTER

    def directions(self, oversampling: int, rows: slice) -> np.ndarray:
        k = oversampling
        axis = (np.arange(-k * GUTTER, k * (self.inner + GUTTER)) + 0.5) * (2.0 / (k * self.inner)) - 1.0
        x, y = np.meshgrid(axis, axis[rows])
        beyond_x, beyond_y = np.abs(x) > 1.0, np.abs(y) > 1.0  # past an edge the square goes on half turned
        x, y = np.where(beyond_x, np.sign(x) * 2.0 - x, x), np.where(beyond_x, -y, y)
        x, y = np.where(beyond_y, -x, x), np.where(beyond_y, np.sign(y) * 2.0 - y, y)
        z = 1.0 - np.abs(x) - np.abs(y)
        fold = np.maximum(-z, 0.0)
        return np.stack([x - np.sign(x) * fold, y - np.sign(y) * fold, z], -1)

    def coordinates(self) -> Expr:
        unit = DIRECTION / dot(absolute(DIRECTION), (1.0, 1.0, 1.0))
        fold = maximum(unit.z * -1.0, 0.0)
        side = sign(multiply_add(sign(unit), 2.0, 1.0))  # never 0
        square = multiply_add(side, fold, unit)
        return multiply_add(square, 0.5 * self.inner / self.size[0], 0.5)

    def seams(self, directions: np.ndarray) -> dict[str, np.ndarray]:
        """The square's edges are the half planes x = 0 and y = 0 below z = 0."""
        unit = directions / np.abs(directions).sum(-1, keepdims=True)
        fold = np.maximum(-unit[..., 2:], 0.0)
        square = np.abs(unit[..., :2]) + fold
        return {"square's edges": (1.0 - square.max(-1)) * (0.5 * self.inner)}


def layouts_of(resolution: int) -> tuple[Layout, ...]:
    """The layouts with as near to 8·N² texels as they come."""
    texels = 8 * resolution**2
    return (
        Equirectangular(resolution),
        GuardedEquirectangular(resolution),
        Atlas(round((texels / 6) ** 0.5) - 2 * GUTTER),
        Octahedral(round(texels**0.5) - 2 * GUTTER),
    )
