"""How far what is seen is from a box, along the rays that see it."""

from __future__ import annotations

import numpy as np

from ..probe import Box
from .cloud import Cloud
from .records import Misfit

_CLOSE, _BEYOND = 0.01, 0.05  # metres


def exits(box: Box, cloud: Cloud) -> tuple[np.ndarray, np.ndarray]:
    """Where each ray of a cloud leaves a box.

    Returns:
        (n,) metres along the ray, 0 where it never meets the box; (n,) the wall there, 2·axis + (1 at the high end).
    """
    start = box.coordinates(cloud.point[None])[0]
    ways = cloud.ways @ box.face_normals.T
    with np.errstate(divide="ignore"):
        ahead = (box.half_widths - start * np.sign(ways)) / np.abs(ways)
        enters = (-box.half_widths - start * np.sign(ways)) / np.abs(ways)
    axis = ahead.argmin(-1)
    leaves = ahead.min(-1)
    high = np.take_along_axis(ways, axis[:, None], 1)[:, 0] > 0.0
    return np.where(leaves >= np.maximum(enters.max(-1), 0.0), leaves, 0.0), 2 * axis + high


def misfit(box: Box, cloud: Cloud) -> Misfit:
    """The misfit of a box; of a ray that misses it, what it sees counts as off by its whole distance."""
    leaves, _ = exits(box, cloud)
    seen = cloud.seen
    off, weights = (cloud.distances - leaves)[seen], cloud.solid_angles[seen]
    median, most = _quantiles(np.abs(off), weights, (0.5, 0.9))
    total = weights.sum()
    share, beyond = weights[np.abs(off) <= _CLOSE].sum() / total, weights[off > _BEYOND].sum() / total
    return Misfit(median, most, float(share), float(beyond))


def _quantiles(values: np.ndarray, weights: np.ndarray, shares: tuple[float, ...]) -> list[float]:
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weights[order])
    places = np.searchsorted(below, np.array(shares) * below[-1])
    return [float(values[order[min(k, len(order) - 1)]]) for k in places]
