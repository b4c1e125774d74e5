"""What becomes of pixels that no picture should hold: NaN, infinite, negative, too bright."""

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
            (now 0), above `BRIGHTEST` (now that).
        first: (column, row) of the first of them, from the lower left.
    """

    face: str
    not_finite: int
    negative: int
    too_bright: int
    first: tuple[int, int]

    def __str__(self) -> str:
        counts = {"not finite": self.not_finite, "negative": self.negative, "too bright": self.too_bright}
        parts = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
        return (
            f"face {self.face}: {parts} pixels were replaced, the first at column {self.first[0]}, row {self.first[1]}"
        )


def clean(face_index: int, picture: np.ndarray) -> tuple[np.ndarray, BadPixels | None]:
    """A face (n, n, 3) float32 without bad pixels, and what was replaced (None: nothing).

    The rule: NaN, −inf and negative values become 0; +inf and values above 65504 become 65504.
    """
    not_finite = ~np.isfinite(picture)
    with np.errstate(invalid="ignore"):
        negative = ~not_finite & (picture < 0.0)
        too_bright = ~not_finite & (picture > BRIGHTEST)
    bad = (not_finite | negative | too_bright).any(-1)
    if not bad.any():
        return picture, None
    row, column = (int(k) for k in np.argwhere(bad)[0])
    cleaned = np.clip(np.nan_to_num(picture, nan=0.0, posinf=BRIGHTEST, neginf=0.0), 0.0, BRIGHTEST)
    counts = [int(mask.any(-1).sum()) for mask in (not_finite, negative, too_bright)]
    return cleaned.astype(np.float32), BadPixels(FACES[face_index].name, *counts, (column, row))
