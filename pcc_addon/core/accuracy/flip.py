"""HDR-FLIP: how much one would notice when a picture and the truth are shown in turn, at all exposures.

P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild: "FLIP: A Difference Evaluator for
Alternating Images", HPG 2020 (called LDR-FLIP here), and P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Möller:
"Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021. The numbers of equations below are those
of the first paper unless they say otherwise. Written from the papers; `tests/core/test_flip.py` holds it to the
authors' own `flip-evaluator`.
"""

from __future__ import annotations

import math

import numpy as np

from ..errors import PccError

PIXELS_PER_DEGREE = 67.0
"""Of a 0.7 m wide 4K screen, 0.7 m away: the papers' default."""

# CIE XYZ of linear Rec. 709 primaries with white D65, and its white.
_XYZ = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
_WHITE = _XYZ.sum(axis=1)
_RGB = np.linalg.inv(_XYZ)
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

# Contrast sensitivity as sums of Gaussians, a √(π/b) exp(−π² x²/b), x in degrees: (a, b) of each. Table 1.
_ACHROMATIC = ((1.0, 0.0047),)
_RED_GREEN = ((1.0, 0.0053),)
_BLUE_YELLOW = ((34.1, 0.04), (13.5, 0.025))
_WIDEST = 0.04
_COLOUR_POWER, _KNEE, _KNEE_VALUE = 0.7, 0.4, 0.95  # q_c, p_c and p_t of section 4.1
_FEATURE_WIDTH, _FEATURE_POWER = 0.082, 0.5  # w in degrees and q_f of section 4.2

# Narkowicz's fit of the ACES curve, (ax² + bx + c) / (dx² + ex + f), with its exposure of 0.6 undone; second paper.
_ACES = (0.36 * 2.51, 0.6 * 0.03, 0.0, 0.36 * 2.43, 0.6 * 0.59, 0.14)
_NEARLY_WHITE = 0.85  # the tone-mapped value that bounds the exposures; second paper, section 4.1


def flip(picture: np.ndarray, truth: np.ndarray, mask: np.ndarray) -> float:
    """The mean HDR-FLIP over the mask's pixels, 0 … 1.

    Raises:
        PccError, ValueError: as `flip_map`; and PccError where the mask is empty.
    """
    if not mask.any():
        raise PccError("the probe serves no pixel of this picture: choose a camera that sees surfaces which show it")
    return float(flip_map(picture, truth, mask)[mask].mean())


def flip_map(picture: np.ndarray, truth: np.ndarray, mask: np.ndarray | None = None) -> np.ndarray:
    """HDR-FLIP pixel by pixel: the largest LDR-FLIP of all exposures.

    Pixels outside the mask show the truth in both pictures, so that an error there reaches no neighbour, and do not
    count for the exposures.

    Args:
        picture, truth: (h, w, 3) linear radiance; what is negative counts as 0.
        mask: (h, w) bool, the pixels that count; None: all.

    Returns:
        (h, w) float64, 0 … 1; 0 outside the mask.

    Raises:
        PccError: a value that counts is not finite.
        ValueError: the shapes do not fit.
    """
    mask = np.ones(truth.shape[:2], bool) if mask is None else mask
    if truth.shape != (*mask.shape, 3) or picture.shape != truth.shape or mask.dtype != np.bool_:
        raise ValueError(f"picture {picture.shape}, truth {truth.shape}, mask {mask.shape} of {mask.dtype}")
    if not (np.isfinite(picture[mask]).all() and np.isfinite(truth[mask]).all()):
        raise PccError("a picture has pixels that are not finite: look for a material or a light that makes them")
    finite = np.where(np.isfinite(truth), truth, 0.0).astype(np.float64)
    true = np.maximum(finite, 0.0)
    shown = np.where(mask[..., None], np.maximum(np.where(mask[..., None], picture, 0.0), 0.0), true)
    error = np.zeros(mask.shape)
    if mask.any():
        for exposure in exposures(true[mask]):
            error = np.maximum(error, ldr_flip(_tone_mapped(shown, exposure), _tone_mapped(true, exposure)))
    return np.where(mask, error, 0.0)


def exposures(truth: np.ndarray) -> np.ndarray:
    """The exposures that bring the brightest and the median luminance to nearly white; second paper, section 4.1.

    Args:
        truth: (n, 3) linear radiance, not negative.

    Returns:
        (k,) stops, ascending, at most one stop apart, at least two of them.
    """
    numerator, denominator = _ACES[:3], _ACES[3:]
    a, b, c = (numerator[i] - _NEARLY_WHITE * denominator[i] for i in range(3))
    white = (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    luminance = np.sort(truth @ _LUMINANCE)
    darkest = float(np.finfo(np.float32).eps)  # a picture that is black for the most part still has an end
    first, last = (
        math.log2(white / max(float(bright), darkest)) for bright in (luminance[-1], luminance[luminance.size // 2])
    )
    return np.linspace(first, last, max(2, math.ceil(last - first)))


def ldr_flip(picture: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """LDR-FLIP pixel by pixel of two (h, w, 3) linear pictures in 0 … 1. Returns (h, w), 0 … 1; equation 6."""
    shown, true = _opponent(picture), _opponent(truth)
    return _colour_difference(shown, true) ** (1.0 - _feature_difference(shown[..., 0], true[..., 0]))


def _tone_mapped(picture: np.ndarray, exposure: float) -> np.ndarray:
    a, b, c, d, e, f = _ACES
    x = picture * 2.0**exposure
    return np.clip(((a * x + b) * x + c) / ((d * x + e) * x + f), 0.0, 1.0)


def _opponent(rgb: np.ndarray) -> np.ndarray:
    """YCxCz of linear RGB: as CIELAB without its cube roots."""
    x, y, z = np.moveaxis(rgb @ _XYZ.T / _WHITE, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _linear(opponent: np.ndarray) -> np.ndarray:
    y = (opponent[..., 0] + 16.0) / 116.0
    x, z = y + opponent[..., 1] / 500.0, y - opponent[..., 2] / 200.0
    return np.stack([x, y, z], axis=-1) * _WHITE @ _RGB.T


def _hunted(rgb: np.ndarray) -> np.ndarray:
    """CIELAB with its colours dimmed in the dark: a and b times L / 100, after Hunt."""
    relative = rgb @ _XYZ.T / _WHITE
    edge = 6.0 / 29.0
    root = np.where(relative > edge**3, np.cbrt(relative), relative / (3.0 * edge**2) + 4.0 / 29.0)
    x, y, z = np.moveaxis(root, -1, 0)
    light = 116.0 * y - 16.0
    return np.stack([light, 5.0 * light * (x - y), 2.0 * light * (y - z)], axis=-1)


def _distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """HyAB to the power q_c; equation 3."""
    apart = one - other
    return (np.abs(apart[..., 0]) + np.hypot(apart[..., 1], apart[..., 2])) ** _COLOUR_POWER


def _colour_difference(shown: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Of what the eye resolves, 0 … 1; section 4.1."""
    seen = [np.clip(_linear(_blurred(picture)), 0.0, 1.0) for picture in (shown, true)]
    apart = _distance(_hunted(seen[0]), _hunted(seen[1]))
    largest = float(_distance(_hunted(np.array([0.0, 1.0, 0.0])), _hunted(np.array([0.0, 0.0, 1.0]))))
    knee = _KNEE * largest
    above = _KNEE_VALUE + (apart - knee) / (largest - knee) * (1.0 - _KNEE_VALUE)
    return np.where(apart < knee, apart * _KNEE_VALUE / knee, above)


def _blurred(opponent: np.ndarray) -> np.ndarray:
    """Each channel of YCxCz without what the eye does not resolve in it."""
    radius = math.ceil(3.0 * math.sqrt(_WIDEST / (2.0 * math.pi**2)) * PIXELS_PER_DEGREE)
    degrees = np.arange(-radius, radius + 1) / PIXELS_PER_DEGREE
    channels = []
    for channel, gaussians in enumerate((_ACHROMATIC, _RED_GREEN, _BLUE_YELLOW)):
        total, weights = np.zeros(opponent.shape[:2]), 0.0
        for a, b in gaussians:
            kernel = np.exp(-(math.pi**2) * degrees**2 / b)
            weight = a * math.sqrt(math.pi / b)
            total += weight * _along(_along(opponent[..., channel], kernel, 0), kernel, 1)
            weights += weight * float(kernel.sum()) ** 2
        channels.append(total / weights)
    return np.stack(channels, axis=-1)


def _feature_difference(shown: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Of edges and points in the achromatic channel, 0 … 1; section 4.2."""
    deviation = 0.5 * _FEATURE_WIDTH * PIXELS_PER_DEGREE
    radius = math.ceil(3.0 * deviation)
    x = np.arange(-radius, radius + 1, dtype=np.float64)
    bell = np.exp(-(x**2) / (2.0 * deviation**2))
    across, edge, point = bell / bell.sum(), _balanced(-x * bell), _balanced((x**2 / deviation**2 - 1.0) * bell)

    def strength(picture: np.ndarray, kernel: np.ndarray) -> np.ndarray:
        horizontal = _along(_along(picture, kernel, 1), across, 0)
        vertical = _along(_along(picture, kernel, 0), across, 1)
        return np.hypot(horizontal, vertical)

    light = [(picture + 16.0) / 116.0 for picture in (shown, true)]
    edges, points = (np.abs(strength(light[0], kernel) - strength(light[1], kernel)) for kernel in (edge, point))
    return (np.maximum(edges, points) / math.sqrt(2.0)) ** _FEATURE_POWER


def _balanced(kernel: np.ndarray) -> np.ndarray:
    """With positive weights that sum to 1 and negative ones that sum to −1."""
    positive, negative = kernel[kernel > 0.0].sum(), -kernel[kernel < 0.0].sum()
    return np.where(kernel > 0.0, kernel / positive, kernel / negative)


def _along(picture: np.ndarray, kernel: np.ndarray, axis: int) -> np.ndarray:
    """A correlation along one axis; beyond an edge the edge goes on."""
    radius, length = kernel.size // 2, picture.shape[axis]
    padded = np.pad(picture, [(radius, radius) if i == axis else (0, 0) for i in range(2)], mode="edge")
    result = np.zeros_like(picture)
    for tap, weight in enumerate(kernel):
        result += weight * (padded[tap : tap + length] if axis == 0 else padded[:, tap : tap + length])
    return result
