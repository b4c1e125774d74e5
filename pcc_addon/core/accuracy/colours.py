"""Colours that stand for numbers: equal steps of a number look like equal steps of colour.

A ramp goes through a few anchors in OKLab (B. Ottosson, "A perceptual color space for image processing", 2020), a space
in which distance is how different two colours look; it is walked at a constant speed there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_STEPS = 512
_TO_ROOTS = np.array(
    [
        [1.0, 0.3963377774, 0.2158037573],
        [1.0, -0.1055613458, -0.0638541728],
        [1.0, -0.0894841775, -1.2914855480],
    ]
)
_TO_LINEAR = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)
# Lightness 0 … 1, chroma and hue in degrees, of OKLab.
_HEAT = (
    (0.20, 0.06, 300),
    (0.36, 0.12, 285),
    (0.50, 0.10, 240),
    (0.64, 0.11, 175),
    (0.79, 0.17, 135),
    (0.93, 0.17, 105),
)
_BEFORE = ((0.94, 0.0, 60), (0.78, 0.11, 65), (0.60, 0.16, 45), (0.42, 0.15, 30))
_BEYOND = ((0.94, 0.0, 240), (0.76, 0.10, 230), (0.57, 0.13, 250), (0.40, 0.14, 265))


def heat(values: np.ndarray) -> np.ndarray:
    """(…, 3) float64 sRGB, 0 … 1, of values (…) from 0, dark, to 1, bright; what is beyond is as the end."""
    return _looked_up(_HEAT_RAMP, values)


def signed(values: np.ndarray) -> np.ndarray:
    """(…, 3) float64 sRGB of values (…) from −1, red, by 0, nearly white, to 1, blue."""
    values = np.asarray(values, np.float64)
    before, beyond = _looked_up(_BEFORE_RAMP, -values), _looked_up(_BEYOND_RAMP, values)
    return np.where((values < 0.0)[..., None], before, beyond)


def as_bytes(colours: np.ndarray) -> np.ndarray:
    """Colours 0 … 1 as uint8."""
    return np.round(np.clip(colours, 0.0, 1.0) * 255.0).astype(np.uint8)


def from_linear(radiance: np.ndarray) -> np.ndarray:
    """Linear values as sRGB (IEC 61966-2-1), clipped to 0 … 1."""
    linear = np.clip(np.asarray(radiance, np.float64), 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)


def linear_of(lab: np.ndarray) -> np.ndarray:
    """(…, 3) linear sRGB of OKLab colours (…, 3); outside 0 … 1 where no screen shows them."""
    return (lab @ _TO_ROOTS.T) ** 3 @ _TO_LINEAR.T


def ramp(anchors: Sequence[tuple[float, float, float]]) -> np.ndarray:
    """(512, 3) OKLab colours along straight lines between anchors (lightness, chroma, degrees), evenly spaced."""
    lightness, chroma, degrees = np.array(anchors, np.float64).T
    lab = np.stack([lightness, chroma * np.cos(np.radians(degrees)), chroma * np.sin(np.radians(degrees))], -1)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(lab, axis=0), axis=-1))])
    at = np.linspace(0.0, along[-1], _STEPS)
    return np.stack([np.interp(at, along, lab[:, k]) for k in range(3)], -1)


def _looked_up(colours: np.ndarray, values: np.ndarray) -> np.ndarray:
    index = np.nan_to_num(np.clip(values, 0.0, 1.0)) * (len(colours) - 1)
    return colours[np.round(index).astype(np.intp)]


_HEAT_RAMP, _BEFORE_RAMP, _BEYOND_RAMP = (from_linear(linear_of(ramp(a))) for a in (_HEAT, _BEFORE, _BEYOND))
