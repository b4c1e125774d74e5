"""Levels: the capture blurred by the GGX lobe of one roughness, on the sphere and without faces.

The blur is a convolution with a kernel that depends only on the angle to the mirror direction. On an
equirectangular grid it is a plain convolution along each pair of rows, which the FFT does exactly; so a level has
no seams, no sampling noise, the same blur at poles, edges and corners, and a constant stays constant.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import equirect
from .ggx import blur_kernel

_KEPT_ENERGY = 0.999
_TEXELS_PER_LOBE = 8.0
MINIMUM_HEIGHT = 64


def _lobe_angle(roughness: float, energy: float) -> float:
    """The angle from the mirror direction within which `energy` of the lobe falls (before masking)."""
    # ∫D cos over half angles up to x is tan²x / (tan²x + alpha²).
    return 2.0 * np.arctan(roughness**2 * np.sqrt(energy / (1.0 - energy)))


def level_height(source_height: int, roughness: float) -> int:
    """Rows that a level needs: eight texels across the half-energy lobe, at most the source's own.

    Args:
        source_height: rows of the capture's equirectangular picture.
        roughness: 0 … 1.

    Returns:
        A power-of-two fraction of `source_height`, at least `MINIMUM_HEIGHT` where the source has as many.
    """
    height = source_height
    wanted = _TEXELS_PER_LOBE * np.pi / max(2.0 * _lobe_angle(roughness, 0.5), 1e-9)
    while height % 2 == 0 and height // 2 >= max(wanted, MINIMUM_HEIGHT):
        height //= 2
    return height


def shrink(picture: np.ndarray, height: int) -> np.ndarray:
    """Area-weighted reduction (by solid angle, so energy is kept) of (h, 2h, c) to (height, 2·height, c) float64.

    Raises:
        ValueError: `height` does not divide the picture's height.
    """
    source = picture.shape[0]
    if source % height:
        raise ValueError(f"cannot reduce {source} rows to {height}: not a whole factor")
    factor = source // height
    weights = equirect.solid_angles(2 * source, source)
    weighted = picture.astype(np.float64) * weights[:, None, None]
    summed = weighted.reshape(height, factor, 2 * height, factor, -1).sum((1, 3))
    return summed / (factor * weights.reshape(height, factor).sum(1))[:, None, None]


def prefilter(picture: np.ndarray, roughness: float, progress: Callable[[float], None] | None = None) -> np.ndarray:
    """The level of a picture for one roughness.

    Args:
        picture: (h, 2h, channels), equirectangular radiance, row 0 at the bottom.
        roughness: 0 … 1; 0 returns the picture itself.
        progress: told the fraction done, now and then; may raise to stop.

    Returns:
        (k, 2k, channels) float32 with k = `level_height(h, roughness)`.
    """
    if roughness == 0.0:
        return np.asarray(picture, np.float32)
    height = level_height(picture.shape[0], roughness)
    width = 2 * height
    source = shrink(picture, height)
    solid_angle = equirect.solid_angles(width, height)
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)
    spectrum = np.fft.rfft(source, axis=1)
    reach = int(np.ceil(_lobe_angle(roughness, _KEPT_ENERGY) / np.pi * height)) + 1
    table = _KernelTable(roughness, np.pi / height)
    shift = np.cos(2.0 * np.pi * np.arange(width // 2 + 1) / width)
    result = np.empty_like(source)
    for i in range(height):
        low, high = max(0, i - reach), min(height, i + reach + 1)
        across = np.cos(elevation[i]) * np.cos(elevation[low:high])
        along = np.sin(elevation[i]) * np.sin(elevation[low:high])
        kernel = table(along[:, None] + across[:, None] * shift) * solid_angle[low:high, None]
        total = 2.0 * kernel.sum() - kernel[:, 0].sum() - kernel[:, -1].sum()  # the other half mirrors this one
        transfer = np.fft.hfft(kernel, n=width, axis=1)[:, : width // 2 + 1]
        blurred = (transfer[:, :, None] * spectrum[low:high]).sum(0)
        result[i] = np.fft.irfft(blurred, n=width, axis=0) / total
        if progress is not None and i % 16 == 0:
            progress(i / height)
    return np.maximum(result, 0.0).astype(np.float32)


class _KernelTable:
    """The blur kernel by the cosine of the angle, averaged over one texel so that a narrow lobe is not missed."""

    def __init__(self, roughness: float, texel: float) -> None:
        # Finest near the mirror direction: the table is spaced evenly in sqrt(angle).
        self._count = 4096
        root = np.linspace(0.0, np.sqrt(np.pi), self._count)
        offsets = (np.arange(8) + 0.5) / 8 - 0.5
        x, y = np.meshgrid(offsets * texel, offsets * texel)
        angle = np.hypot(root[:, None] ** 2 + x.ravel(), y.ravel())
        self._values = blur_kernel(np.minimum(angle, np.pi), roughness).mean(1)
        self._scale = (self._count - 1) / np.sqrt(np.pi)

    def __call__(self, cosine: np.ndarray) -> np.ndarray:
        position = np.sqrt(np.arccos(np.clip(cosine, -1.0, 1.0))) * self._scale
        index = np.minimum(position.astype(np.intp), self._count - 2)
        fraction = position - index
        return self._values[index] * (1.0 - fraction) + self._values[index + 1] * fraction
