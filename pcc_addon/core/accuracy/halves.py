"""A path-traced picture in two halves of different seeds, so that it can tell how noisy it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Halves:
    """Two pictures of the same thing with noises of their own.

    Attributes:
        first, second: (h, w, 3) float64, linear radiance.
        samples: per pixel, of each.
        seconds: that both took.
    """

    first: np.ndarray
    second: np.ndarray
    samples: int
    seconds: float

    @property
    def mean(self) -> np.ndarray:
        """(h, w, 3) float32: the best picture there is."""
        return ((self.first + self.second) / 2.0).astype(np.float32)

    def deepened(self, more: Halves) -> Halves:
        """With the samples of another pair, of other seeds, for each half."""
        samples = self.samples + more.samples
        share = more.samples / samples
        first = (1.0 - share) * self.first + share * more.first
        second = (1.0 - share) * self.second + share * more.second
        return Halves(first, second, samples, self.seconds + more.seconds)
