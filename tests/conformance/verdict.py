"""How computed results fare against the exact ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .bound import direction_bound
from .cases import Cases
from .reference import angle, exact

VISIBLE = 1e-3  # radians; a third of a pixel of a face of 512
WELL_CONDITIONED = 1e-5  # radians: what float32 cannot exceed there


@dataclass(frozen=True)
class Verdict:
    """The errors of n cases.

    Attributes:
        error, bound: (n,), or (n, k) where a case has several results; radians for directions.
        finite: (n,) whether all components are finite.
    """

    error: np.ndarray
    bound: np.ndarray
    finite: np.ndarray

    @property
    def within(self) -> np.ndarray:
        """(n,) finite and within the bound."""
        return self.finite & self._of_all(self.error <= self.bound)

    @property
    def visibly_wrong(self) -> np.ndarray:
        """(n,) not finite, or off by more than the bound and than anyone could overlook."""
        return ~self.finite | ~self._of_all(self.error <= np.maximum(self.bound, VISIBLE))

    def bound_at_most(self, promised: float = WELL_CONDITIONED) -> np.ndarray:
        """(n,) where the bound is no more than `promised`."""
        return self._of_all(self.bound <= promised)

    def _of_all(self, holds: np.ndarray) -> np.ndarray:
        return holds.reshape(len(self.finite), -1).all(-1)


def side_by_side(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """Results of n cases as one array (n, k)."""
    return np.concatenate([array.reshape(len(array), -1) for array in arrays], -1)


def judge(cases: Cases, direction: np.ndarray) -> Verdict:
    """Compare computed directions (n, 3) with the exact ones."""
    truth = exact(cases)
    return Verdict(angle(direction, truth.direction), direction_bound(cases, truth), np.isfinite(direction).all(-1))
