"""How far a picture is from the truth, as numbers, over the pixels that a probe serves.

Pictures are (h, w, 3) linear radiance of any floating type, masks (h, w) bool. Sums are made in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum

import numpy as np

from ..errors import PccError

_CLEAR = 3.0  # times the noise: from here on noise makes up less than 6 % of an error, as √(1 − 1/9) = 0.943
_LOST = 1.1  # times the noise: up to here more than 80 % of an error's square is noise


def relative_rmse(picture: np.ndarray, truth: np.ndarray, mask: np.ndarray) -> float:
    """√(Σ (picture − truth)² / Σ truth²) over all channels of the mask's pixels; what lies elsewhere does not count.

    Raises:
        PccError: the mask is empty, a value in it is not finite, or the truth is black there.
        ValueError: the shapes do not fit.
    """
    shown, true = _served(picture, mask, "the picture"), _served(truth, mask, "the truth")
    return _ratio(shown - true, _not_black(true))


def flicker(pictures: Sequence[np.ndarray], truths: Sequence[np.ndarray], masks: Sequence[np.ndarray]) -> float | None:
    """Relative RMSE of the change from each frame to the next against the truth's change.

    √(Σ ((pₖ₊₁ − pₖ) − (tₖ₊₁ − tₖ))² / Σ (tₖ₊₁ − tₖ)²) over pixels that are served in both frames. An error that stays
    where it is costs nothing here; one that swims or flickers does.

    Args:
        pictures, truths, masks: one of each for each frame, in their order.

    Returns:
        None where there are fewer than two frames, no pixel is served in two successive ones, or the truth stands
        still.

    Raises:
        PccError: a served value is not finite.
        ValueError: there are not as many of each, or shapes do not fit.
    """
    if not len(pictures) == len(truths) == len(masks):
        raise ValueError(f"{len(pictures)} pictures, {len(truths)} truths and {len(masks)} masks")
    wrong, change = 0.0, 0.0
    for k in range(len(pictures) - 1):
        both = masks[k] & masks[k + 1]
        if not both.any():
            continue
        shown = _served(pictures[k + 1], both, "the picture") - _served(pictures[k], both, "the picture")
        true = _served(truths[k + 1], both, "the truth") - _served(truths[k], both, "the truth")
        wrong += float(np.sum((shown - true) ** 2))
        change += float(np.sum(true**2))
    return math.sqrt(wrong / change) if change > 0.0 else None


def noise_of_halves(first: np.ndarray, second: np.ndarray, mask: np.ndarray) -> float:
    """The relative RMSE of the noise of (first + second) / 2, where both are renders of the same number of samples.

    Where each half has the variance σ², their difference has 2σ² and their mean σ²/2: RMS(first − second) / 2 is the
    standard deviation of the mean. The halves need seeds of their own. A firefly that neither half caught is in no
    estimate.

    Raises:
        PccError, ValueError: as `relative_rmse`.
    """
    a, b = _served(first, mask, "the first half"), _served(second, mask, "the second half")
    return _ratio((a - b) / 2.0, _not_black((a + b) / 2.0))


def without_noise(rmse: float, noise: float) -> float:
    """An error without what the truth's own noise adds: √max(rmse² − noise², 0).

    Right in the mean where the picture's error and the truth's noise are independent, so for pictures of other seeds.
    """
    return math.sqrt(max(rmse * rmse - noise * noise, 0.0))


def least_error(noise: float) -> float:
    """The smallest error that can be told against a truth with this noise: what is left where trust ends."""
    return math.sqrt(_LOST * _LOST - 1.0) * noise


class Trust(str, Enum):
    """How much of a measured error may be the truth's own noise."""

    CLEAR = "CLEAR"  # less than 6 %
    BLURRED = "BLURRED"  # some; what remains after the correction is less certain
    LOST = "LOST"  # nearly all: the error is smaller than what can be seen against this truth


def trust(rmse: float, noise: float) -> Trust:
    """How far an error measured against a truth with this noise can be believed."""
    if rmse >= _CLEAR * noise:
        return Trust.CLEAR
    return Trust.BLURRED if rmse > _LOST * noise else Trust.LOST


def trust_words(rmse: float, noise: float) -> str:
    """The same for people; empty where there is nothing to warn of."""
    judged = trust(rmse, noise)
    if judged is Trust.CLEAR:
        return ""
    if judged is Trust.BLURRED:
        share = (noise / rmse) ** 2
        return (
            f"{share:.0%} of the measured error's square is noise of the truth itself ({noise:.4f}); it has been taken "
            "off, and four times the truth's samples would halve it"
        )
    return (
        f"the measured error {rmse:.4f} is hardly more than the noise of the truth itself ({noise:.4f}): it is small, "
        "but how small only a truth with more samples can tell"
    )


def _served(picture: np.ndarray, mask: np.ndarray, name: str) -> np.ndarray:
    """(n, 3) float64: the values under the mask."""
    if picture.shape != (*mask.shape, 3) or mask.dtype != np.bool_:
        raise ValueError(f"{name} is {picture.shape} for a mask {mask.shape} of {mask.dtype}")
    values = picture[mask].astype(np.float64)
    if not len(values):
        raise PccError("the probe serves no pixel of this picture: choose a camera that sees surfaces which show it")
    if not np.isfinite(values).all():
        raise PccError(f"{name} has pixels that are not finite: look for a material or a light that makes them")
    return values


def _not_black(true: np.ndarray) -> np.ndarray:
    if not true.any():
        raise PccError(
            "the truth is black wherever the probe is seen: there is no light to compare, so light the scene"
        )
    return true


def _ratio(part: np.ndarray, whole: np.ndarray) -> float:
    return math.sqrt(float(np.sum(part**2)) / float(np.sum(whole**2)))
