"""The GGX lobe, written out once more for tests, in other terms than the product's."""

from __future__ import annotations

import numpy as np


def lobe(angle: np.ndarray, roughness: float) -> np.ndarray:
    """Normal distribution times the light's masking at `angle` from the mirror direction; not normalised.

    By tangents: Walter et al. 2007, equations 33 and 34.
    """
    alpha2 = roughness**4
    tangent2 = np.tan(np.minimum(angle, 1.5707)) ** 2
    distribution = alpha2 / (np.cos(0.5 * angle) ** 4 * (alpha2 + np.tan(0.5 * angle) ** 2) ** 2)
    return np.where(angle < 0.5 * np.pi, distribution * 2.0 / (1.0 + np.sqrt(1.0 + alpha2 * tangent2)), 0.0)


def quadrature(roughness: float, nodes: int = 20_000) -> tuple[np.ndarray, np.ndarray]:
    """(angles, weights) of an integral over the lobe; the weights sum to the whole of it, per radian of azimuth."""
    edges = np.linspace(0.0, 1.0, nodes + 1) ** 3 * (0.5 * np.pi)
    angle = 0.5 * (edges[1:] + edges[:-1])
    return angle, lobe(angle, roughness) * np.sin(angle) * np.diff(edges)


def both_sides(ways: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(2n, 3) directions and (2n,) weights of a whole lobe, from those on one side of it that `core.ggx` gives."""
    return np.concatenate([ways, ways * (1.0, -1.0, 1.0)]), np.tile(weights, 2)
