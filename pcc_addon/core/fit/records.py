"""What a fit found, as data and in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..probe import Box

WALL_NAMES = ("-X", "+X", "-Y", "+Y", "-Z", "+Z")  # of the box's own axes; wall 2·axis + (1 at the high end)


@dataclass(frozen=True)
class Misfit:
    """How far what is seen is from a box, along the rays from the capture point, weighted by solid angle.

    Attributes:
        median, most: metres; nine tenths of what is seen is nearer to the box than `most`.
        share: of all that is seen, that within a centimetre of the box.
        beyond: share of all that is seen that lies more than five centimetres beyond the box.
    """

    median: float
    most: float
    share: float
    beyond: float

    def __str__(self) -> str:
        return f"median {self.median:.4f} m, 90 % within {self.most:.3f} m, {self.share:.0%} within 1 cm"


@dataclass(frozen=True)
class Wall:
    """What became of one face of the box.

    Attributes:
        name: as in `WALL_NAMES`.
        found: whether there is a wall that it lies on now; otherwise it is as it was drawn.
        moved: how much farther it is from the middle of the drawn box than the drawn face, metres.
        seen, covered, open: shares of its rays by solid angle: that meet it, that meet something before it, that meet
            something beyond it or nothing.
    """

    name: str
    found: bool
    moved: float
    seen: float
    covered: float
    open: float

    def __str__(self) -> str:
        seen = f"{self.seen:.0%} seen, {self.covered:.0%} covered, {self.open:.0%} open"
        if self.found:
            return f"{self.name} found ({self.moved:+.3f} m; {seen})"
        why = "nothing is there" if self.open > 0.5 else "no wall is seen in reach"
        return f"{self.name} kept as drawn: {why} ({seen})"


@dataclass(frozen=True)
class Fit:
    """The box that fits a room, and where to capture it.

    Attributes:
        probe: its name.
        before, after: the boxes; their half extents are along the same axes, as far as they were turned.
        point_before, point_after: capture points, world space, metres.
        misfit_before, misfit_after: of each box as seen from its capture point.
        walls: six, as `WALL_NAMES`.
        turned: degrees between the axes before and after.
        leaning: whether the new box is not upright.
        warnings: what the user should know, in words.
    """

    probe: str
    before: Box
    after: Box
    point_before: tuple[float, float, float]
    point_after: tuple[float, float, float]
    misfit_before: Misfit
    misfit_after: Misfit
    walls: tuple[Wall, ...]
    turned: float
    leaning: bool
    warnings: tuple[str, ...] = ()

    @property
    def found(self) -> int:
        """How many faces lie on walls now."""
        return sum(wall.found for wall in self.walls)

    @property
    def capture_offset(self) -> tuple[float, float, float]:
        """Of the new capture point from the new box's centre, metres along its own axes."""
        return offset_of(self.after, np.array(self.point_after), self.after.centre)


def offset_of(box: Box, point: np.ndarray, origin: np.ndarray) -> tuple[float, float, float]:
    """A capture offset that puts the capture point at `point` (3,), counted from `origin` (3,), world space."""
    unit_axes = box.axes / box.half_extents
    x, y, z = np.linalg.solve(unit_axes, point - origin)
    return float(x), float(y), float(z)
