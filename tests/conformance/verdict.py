"""How a computed direction fares against the exact one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bound import direction_bound
from .cases import Cases
from .reference import angle, exact

VISIBLE = 1e-3  # radians; a third of a pixel of a face of 512
WELL_CONDITIONED = 2e-5  # radians: what the bound is there


@dataclass(frozen=True)
class Verdict:
    """The errors of one family.

    Attributes:
        error, bound: (n,) radians.
        finite: (n,) whether all three components are finite; a zero vector out of a ray counts as not.
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
        """(n,) where float32 can do well."""
        return self.bound <= WELL_CONDITIONED


def judge(cases: Cases, direction: np.ndarray) -> Verdict:
    """Compare computed directions (n, 3) with the exact ones."""
    truth = exact(cases)
    defined = np.linalg.norm(truth.direction, axis=-1) > 0
    with np.errstate(invalid="ignore"):
        finite = np.isfinite(direction).all(-1) & ((np.abs(direction).max(-1) > 0) | ~defined)
        error = np.where(finite, angle(np.nan_to_num(direction), truth.direction), np.pi)
    return Verdict(error, direction_bound(cases, truth), finite)
