"""What becomes of pixels that no picture should hold: NaN, infinite, negative, too bright.

The rule: NaN, −inf and negative values become 0; +inf and values from 65504 on become 65504. Each such pixel counts.

The renderers have rules of their own, and what they replace before there is a picture cannot be counted. Cycles turns
samples that are NaN or infinite (an emission of 3e38 too) into black. Its denoiser turns negative pixels into black and
spreads too bright ones over their neighbours; where a denoised face shows no fault, the bake looks for one in a glimpse
of one sample a pixel without denoising. That tells that there is such light and about where, not how much of it is in
the picture, and may miss what is smaller than a pixel. EEVEE turns NaN, infinite and negative pixels into black and
cuts off at 65504, which is why that value itself counts as too bright.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cubemap import FACES

BRIGHTEST = 65504.0  # largest half float: EEVEE keeps textures as half floats


@dataclass(frozen=True)
class BadPixels:
    """Pixels of one face that were replaced.

    Attributes:
        face: the face's name.
        not_finite, negative, too_bright: how many were NaN or infinite (now 0, or `BRIGHTEST` for +inf), below 0
            (now 0), finite but `BRIGHTEST` or more (now that).
        first: (column, row) of the first of them, from the lower left of the face's 90°.
        glimpsed: whether they are not of the picture but of a glimpse before denoising.
    """

    face: str
    not_finite: int
    negative: int
    too_bright: int
    first: tuple[int, int]
    glimpsed: bool = False

    def __str__(self) -> str:
        counts = {"not finite": self.not_finite, "negative": self.negative, "too bright": self.too_bright}
        parts = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
        fate = "at one sample a pixel, hidden by denoising" if self.glimpsed else "were replaced"
        return f"face {self.face}: {parts} pixels {fate}, the first at column {self.first[0]}, row {self.first[1]}"


def clean(face_index: int, picture: np.ndarray, overscan: int = 0) -> tuple[np.ndarray, BadPixels | None]:
    """A face (n, n, 3) float32 without bad pixels, and what was replaced (None: nothing).

    Pixels of the overscan are replaced too, but counted in the face within whose 90° they lie.
    """
    cleaned, masks = _replaced(picture)
    bad = np.any(masks, 0)
    if not bad.any():
        return picture, None
    inside = np.s_[overscan : len(picture) - overscan, overscan : len(picture) - overscan]
    places = np.argwhere(bad[inside])
    if not len(places):
        return cleaned, None
    row, column = (int(k) for k in places[0])
    unfit, dark, bright = (int(mask[inside].sum()) for mask in masks)
    return cleaned, BadPixels(FACES[face_index].name, unfit, dark, bright, (column, row))


def clean_whole(name: str, picture: np.ndarray) -> tuple[np.ndarray, str]:
    """A picture (h, w, 3) float32 that a user gave, without bad pixels; and what was replaced, empty for nothing."""
    cleaned, masks = _replaced(picture)
    counts = zip(masks, ("not finite", "negative", "too bright"), strict=True)
    parts = [f"{int(mask.sum())} {what}" for mask, what in counts if mask.any()]
    if not parts:
        return picture, ""
    return cleaned, f"picture '{name}': {', '.join(parts)} pixels were replaced"


def linear_of_srgb(values: np.ndarray) -> np.ndarray:
    """Light of sRGB's encoded values 0 … 1, of any shape, float32 (IEC 61966-2-1)."""
    dark = values <= 0.04045
    return np.where(dark, values / 12.92, ((values + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _replaced(picture: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """(h, w, 3) without bad pixels; and where they were (h, w): not finite, negative, too bright."""
    not_finite = ~np.isfinite(picture)
    with np.errstate(invalid="ignore"):
        negative = ~not_finite & (picture < 0.0)
        too_bright = ~not_finite & (picture >= BRIGHTEST)
    cleaned = np.clip(np.nan_to_num(picture, nan=0.0, posinf=BRIGHTEST, neginf=0.0), 0.0, BRIGHTEST).astype(np.float32)
    return cleaned, (not_finite.any(-1), negative.any(-1), too_bright.any(-1))


def as_half(picture: np.ndarray) -> np.ndarray:
    """A picture of float32 whose numbers are those of half precision; what is above 65504 is that."""
    return np.minimum(picture, _LARGEST_HALF).astype(np.float16).astype(np.float32)


_LARGEST_HALF = float(np.finfo(np.float16).max)
