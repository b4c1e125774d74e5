"""Levels: the capture blurred by the GGX lobe of one roughness, on the sphere and without faces.

The blur is a convolution with a kernel that depends only on the angle to the mirror direction. On an
equirectangular grid it is a plain convolution along each pair of rows, which the FFT does exactly; so a level has
no seams, no sampling noise, the same blur at poles, edges and corners. Constants and energy are kept to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from . import equirect
from .ggx import blur_kernel

_KEPT_ENERGY = 0.999
_TEXELS_PER_LOBE = 6.0
MINIMUM_HEIGHT = 128


def _lobe_angle(roughness: float, energy: float) -> float:
    """The angle from the mirror direction within which `energy` of the lobe falls (before masking)."""
    # ∫D cos over half angles up to x is tan²x / (tan²x + alpha²).
    return 2.0 * np.arctan(roughness**2 * np.sqrt(energy / (1.0 - energy)))


def level_height(source_height: int, roughness: float) -> int:
    """Rows that a level needs: six texels across the half-energy lobe, at most the source's own.

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


def mixed_within(source_height: int, roughness: float) -> float:
    """The angle, radians, from a direction within which lie all texels of a capture that its lookup in a level mixes.

    Args:
        source_height: rows of the capture's equirectangular picture.
        roughness: of the level, 0 … 1; 0 for the capture itself.
    """
    if roughness == 0.0:
        return 2.0 * np.pi / source_height  # to the farthest of four texels, half a texel off a pole
    texel = np.pi / level_height(source_height, roughness)
    return _lobe_angle(roughness, _KEPT_ENERGY) + 4.0 * texel  # of these the kernel has one, and `shrink` a half


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
    blur, gain = _blur(roughness, height)
    weight = gain * equirect.solid_angles(width, height)
    spectrum = np.fft.rfft(np.moveaxis(shrink(picture, height), -1, 0) * weight[:, None])
    parts = np.stack([spectrum.real, spectrum.imag])
    result = np.empty((height, width, picture.shape[2]))
    for i in range((height + 1) // 2):
        rows, kernel = blur.zone(i)
        transfer = np.fft.hfft(kernel, n=width)[:, : height + 1]
        for row, sources in ((i, parts), (height - 1 - i, parts[:, :, ::-1])):
            real, imaginary = np.einsum("rk,pcrk->pck", transfer, sources[:, :, rows])
            result[row] = gain[row] * np.fft.irfft(real + 1j * imaginary, n=width).T
        if progress is not None and i % 8 == 0:
            progress(2 * i / height)
    return np.maximum(result, 0.0).astype(np.float32)


@lru_cache(maxsize=64)
def _blur(roughness: float, height: int) -> tuple[_Blur, np.ndarray]:
    """A blur and its gain, kept for the next probe of a bake: some tens of kilobytes for each level."""
    blur = _Blur(roughness, height)
    gain = blur.gain()
    gain.setflags(write=False)
    return blur, gain


class _Blur:
    """The kernel between the rows of an equirectangular grid; the south's is the north's, mirrored."""

    def __init__(self, roughness: float, height: int) -> None:
        texel = np.pi / height
        reach = min(_lobe_angle(roughness, _KEPT_ENERGY) + texel, np.pi)
        self._height = height
        self._elevation = texel * (np.arange(height) + 0.5) - 0.5 * np.pi
        self._around = np.sin(0.5 * texel * np.arange(height + 1)) ** 2
        self._reach = np.sin(0.5 * reach) ** 2
        self._rows = int(reach / texel)
        self._table = _KernelTable(roughness, texel, reach)

    def zone(self, i: int) -> tuple[slice, np.ndarray]:
        """The rows that give light to row `i`, and the kernel there at 0, 1 … texels around the axis, while not 0."""
        rows = slice(max(0, i - self._rows), min(self._height, i + self._rows + 1))
        up = np.sin(0.5 * (self._elevation[rows] - self._elevation[i])) ** 2
        across = np.cos(self._elevation[rows]) * np.cos(self._elevation[i])
        furthest = ((self._reach - up) / across).max()
        around = self._around[: np.searchsorted(self._around, furthest, side="right") + 1]
        return rows, self._table(up[:, None] + across[:, None] * around)

    def gain(self) -> np.ndarray:
        """(height,) a factor for each row, on light that leaves it and on light that reaches it.

        Scaled on both sides the kernel stays symmetric (Sinkhorn's balancing). With these factors every texel receives
        weights whose sum is 1, which keeps constants, and so hands on all the light that it has, which keeps energy.
        They differ near the poles, where texels are slivers, the more the narrower the lobe.
        """
        fold = np.full(self._height + 1, 2.0)  # the other half of the circle mirrors this one
        fold[[0, -1]] = 1.0
        totals = np.zeros((self._height, self._height))
        for i in range((self._height + 1) // 2):
            rows, kernel = self.zone(i)
            totals[i, rows] = totals[::-1, ::-1][i, rows] = kernel @ fold[: kernel.shape[1]]
        totals *= equirect.solid_angles(2 * self._height, self._height)
        gain = np.ones(self._height)
        for _ in range(50):  # the error halves each time, or better
            gain = np.sqrt(gain / (totals @ gain))
        return gain


class _KernelTable:
    """The blur kernel by the angle, averaged over one texel so that a narrow lobe is not missed; 0 beyond `reach`."""

    def __init__(self, roughness: float, texel: float, reach: float) -> None:
        # Finest near the mirror direction: the table is spaced evenly in sqrt(sin(angle / 2)).
        self._last = 4095
        angle = 2.0 * np.arcsin(np.linspace(0.0, 1.0, self._last + 1) ** 2)
        offsets = ((np.arange(8) + 0.5) / 8 - 0.5) * texel
        x, y = np.meshgrid(offsets, offsets)
        around = np.hypot(angle[:, None] + x.ravel(), y.ravel())
        self._values = blur_kernel(np.minimum(around, np.pi), roughness).mean(1)
        self._values[:-1][angle[1:] > reach] = 0.0

    def __call__(self, haversine: np.ndarray) -> np.ndarray:
        """The kernel where sin² of half the angle is `haversine`, which tells small angles apart as a cosine cannot."""
        position = np.sqrt(np.sqrt(np.minimum(haversine, 1.0))) * self._last
        index = np.minimum(position.astype(np.intp), self._last - 1)
        fraction = position - index
        return self._values[index] * (1.0 - fraction) + self._values[index + 1] * fraction
