"""Straight lines through measured times and squared errors: neither end nor slope is ever negative."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Line:
    """y = start + slope · x, both not negative."""

    start: float
    slope: float

    def at(self, x: float) -> float:
        """y at some x."""
        return self.start + self.slope * x


def fitted(points: Sequence[tuple[float, float]], *, through_zero: bool = False) -> Line:
    """The line with the least sum of squared relative misfits, Σ ((start + slope x − y) / y)².

    Where all points have the same x it goes through zero, so that more work takes more time.

    Args:
        points: (x, y) with x, y > 0, at least one.
        through_zero: whether start is 0.
    """
    x, y = np.array(points, dtype=np.float64).T
    if through_zero or np.ptp(x) == 0.0:
        return Line(0.0, _scale(x / y))
    columns = np.stack([1.0 / y, x / y], axis=1)
    start, slope = np.linalg.lstsq(columns, np.ones(len(y)), rcond=None)[0]
    if start >= 0.0 and slope >= 0.0:
        return Line(float(start), float(slope))
    flat, steep = Line(_scale(1.0 / y), 0.0), Line(0.0, _scale(x / y))
    return min(flat, steep, key=lambda line: _misfit(line, x, y))


def _scale(ratio: np.ndarray) -> float:
    """The factor k with the least Σ (k · ratio − 1)²."""
    return float(ratio.sum() / (ratio @ ratio))


def _misfit(line: Line, x: np.ndarray, y: np.ndarray) -> float:
    return float(np.sum(((line.start + line.slope * x) / y - 1.0) ** 2))
