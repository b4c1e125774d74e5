"""What each face of a capture may show: its pyramid against boxes around things."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .cubemap import FACES

_ROUNDING = 1e-5  # of the greatest coordinate: renderers place things in single precision
_FILTER = 2  # texels: what a pixel's filter takes of its neighbours, and one more


def may_show(
    corners: np.ndarray, capture_point: Sequence[float] | np.ndarray, resolution: int, overscan: int
) -> np.ndarray:
    """Which faces may show anything within some boxes; errs towards all.

    A box is left out only where it lies whole on the outer side of one of the planes of a face's pyramid.

    Args:
        corners: (n, k, 3) world space, metres: points whose convex hull holds what may be shown.
        capture_point: (3,) world space, metres.
        resolution: texels across the 90° of a face.
        overscan: texels that are rendered beyond them on each side.

    Returns:
        (n, 6) bool, in the order of `FACES`.
    """
    opening = 1.0 + 2.0 * (overscan + _FILTER) / resolution  # the half width of the pyramid at depth 1
    place = np.asarray(capture_point, np.float64)
    corners = np.asarray(corners, np.float64)
    axes = np.array([(face.forward, face.right, face.up) for face in FACES], np.float64)
    forward = axes[:, 0]
    planes = np.stack([forward, *(opening * forward + sign * axes[:, k] for k in (1, 2) for sign in (-1.0, 1.0))], 1)
    near = _ROUNDING * (np.abs(corners).max((1, 2), initial=0.0) + np.abs(place).max())
    heights = np.einsum("fpk,nck->nfpc", planes, corners - place).max(-1)  # of the highest corner over each plane
    return (heights >= -near[:, None, None] * np.linalg.norm(planes, axis=-1)).all(-1)
