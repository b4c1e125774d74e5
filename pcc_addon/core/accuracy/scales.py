"""Where a colour scale ends, and the bar under a picture that says what its colours mean."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .colours import as_bytes
from .lettering import HEIGHT, write, written

_PAPER, _INK = (24, 24, 24), (235, 235, 235)
_NARROW = 400  # pixels: wider pictures have larger letters


def rounded_up(value: float) -> float:
    """The least of 1, 2 and 5 times a power of ten that is not below a value above 0."""
    power = 10.0 ** math.floor(math.log10(value))
    return next((step * power for step in (1.0, 2.0, 5.0) if value <= step * power * (1.0 + 1e-9)), 10.0 * power)


def with_bar(picture: np.ndarray, colours: np.ndarray, marks: Sequence[tuple[float, str]]) -> np.ndarray:
    """A picture (h, w, 3) uint8, row 0 at the top, with a bar of colours and words under it, (h + k, w, 3).

    Args:
        colours: (n, 3), 0 … 1, from left to right.
        marks: where along the bar, 0 … 1, and what stands there.
    """
    width = picture.shape[1]
    scale = 2 if width >= _NARROW else 1
    gap = 4 * scale
    bar = 8 * scale
    strip = np.empty((bar + HEIGHT * scale + 3 * gap, width, 3), np.uint8)
    strip[:] = _PAPER
    left, right = gap, width - gap
    index = np.linspace(0, len(colours) - 1, right - left).round().astype(np.intp)
    strip[gap : gap + bar, left:right] = as_bytes(colours[index])
    for place, words in marks:
        room = written(words, scale).shape[1]
        centre = left + place * (right - 1 - left)
        column = min(max(round(centre - 0.5 * room), left), max(right - room, left))
        strip[gap + bar : gap + bar + gap // 2, round(centre)] = _INK
        write(strip, words, 2 * gap + bar, column, _INK, scale=scale)
    return np.concatenate([picture, strip])
