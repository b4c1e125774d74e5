"""How a computed direction fares against the exact one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bound import direction_bound
from .cases import Cases
from .reference import angle, exact

VISIBLE = 1e-3  # radians; a third of a pixel of a face of 512
WELL_CONDITIONED = 1e-5  # radians: what float32 cannot exceed there


@dataclass(frozen=True)
class Verdict:
    """The errors of one family.

    Attributes:
        error, bound: (n,) radians.
        finite: (n,) whether all three components are finite.
    """

    error: np.ndarray
    bound: np.ndarray
    finite: np.ndarray

    @property
    def within(self) -> np.ndarray:
        """(n,) finite and within the bound."""
        return self.finite & (self.error <= self.bound)

    @property
    def visibly_wrong(self) -> np.ndarray:
        """(n,) not finite, or off by more than the bound and than anyone could overlook."""
        return ~self.finite | (self.error > np.maximum(self.bound, VISIBLE))

    @property
    def well_conditioned(self) -> np.ndarray:
        """(n,) where the bound is no more than `WELL_CONDITIONED`."""
        return self.bound <= WELL_CONDITIONED


def judge(cases: Cases, direction: np.ndarray) -> Verdict:
    """Compare computed directions (n, 3) with the exact ones."""
    truth = exact(cases)
    return Verdict(angle(direction, truth.direction), direction_bound(cases, truth), np.isfinite(direction).all(-1))
