"""Points that fill a space evenly, the same ones each time."""

from __future__ import annotations

import numpy as np


def evenly(count: int, dimensions: int) -> np.ndarray:
    """(count, dimensions) float64 in [0, 1).

    The k-th point is the fraction of ½ + k·(1/g, 1/g², …), where g is the root above 1 of g^(dimensions + 1) = g + 1
    (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
    """
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    return (0.5 + np.arange(count)[:, None] * root ** -np.arange(1.0, dimensions + 1.0)) % 1.0


def sphere(count: int) -> np.ndarray:
    """(count, 3) float64 unit vectors, each of which stands for the same solid angle."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    azimuth = 2.0 * np.pi * evenly(count, 1)[:, 0]
    across = np.sqrt(1.0 - height * height)
    return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), height], -1)
