"""Flat pictures with alpha, read as Blender's Image Texture node reads them with Clip extension."""

from __future__ import annotations

import numpy as np


def lookup(picture: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Bilinear lookup of (h, w, channels), row 0 at the bottom, at (u, v, …) of 0 … 1; 0 outside."""
    height, width = picture.shape[:2]
    u, v = (np.asarray(place[..., k], np.float64) for k in (0, 1))
    inside = (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0)
    column, row = (np.where(inside, w, 0.0) * size - 0.5 for w, size in ((u, width), (v, height)))
    c0, r0 = np.floor(column).astype(np.intp), np.floor(row).astype(np.intp)
    fc, fr = (column - c0)[..., None], (row - r0)[..., None]
    left, right = (np.clip(c, 0, width - 1) for c in (c0, c0 + 1))
    low, high = (np.clip(r, 0, height - 1) for r in (r0, r0 + 1))
    below = picture[low, left] * (1 - fc) + picture[low, right] * fc
    above = picture[high, left] * (1 - fc) + picture[high, right] * fc
    return (below * (1 - fr) + above * fr) * inside[..., None]
