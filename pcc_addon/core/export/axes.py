"""Axes as signed names: which of one space's directions the X, Y and Z of another are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SIDES: dict[str, tuple[int, int, int]] = {
    "+X": (1, 0, 0), "-X": (-1, 0, 0), "+Y": (0, 1, 0), "-Y": (0, -1, 0), "+Z": (0, 0, 1), "-Z": (0, 0, -1)
}  # fmt: skip


@dataclass(frozen=True)
class Axes:
    """Where the axes of a space point to, in another space."""

    x: str
    y: str
    z: str

    @property
    def matrix(self) -> np.ndarray:
        """(3, 3) float64: from the other space to this one."""
        return np.array([SIDES[side] for side in self.names], np.float64)

    @property
    def names(self) -> tuple[str, str, str]:
        return (self.x, self.y, self.z)

    @property
    def mirrors(self) -> bool:
        """Whether one of the spaces is left-handed and the other is not."""
        return bool(np.linalg.det(self.matrix) < 0.0)


AS_IT_IS = Axes("+X", "+Y", "+Z")
