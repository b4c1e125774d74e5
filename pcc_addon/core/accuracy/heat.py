"""Where a picture is wrong, as a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import colours
from .png import png_of_bytes
from .scales import rounded_up, with_bar

_DIM = 0.35  # of what is not measured
_MOST = 99.0  # per cent of the pixels that the scale holds: single specks do not set it
_LEAST = 0.01  # end of the scale where nothing is wrong


@dataclass(frozen=True, eq=False)
class Heat:
    """A map of errors.

    Attributes:
        picture: (h + k, w, 3) uint8 sRGB, row 0 at the top, with the scale under it.
        end: the relative error at the bright end of the scale; worse pixels look the same.
    """

    picture: np.ndarray
    end: float

    @property
    def png(self) -> bytes:
        """The file."""
        return png_of_bytes(self.picture)


def relative_errors(picture: np.ndarray, truth: np.ndarray, served: np.ndarray) -> np.ndarray:
    """(h, w) float64: the error of each pixel over the truth's root mean square in the served ones, 0 in others.

    Their root mean square over the served pixels is the picture's relative RMSE.

    Args:
        picture, truth: (h, w, 3) linear radiance.
        served: (h, w) bool.

    Raises:
        ValueError: the shapes differ.
    """
    if picture.shape != truth.shape or picture.shape[:2] != served.shape:
        raise ValueError(f"pictures of {picture.shape}, {truth.shape} and a mask of {served.shape} do not fit")
    error = np.sqrt(np.square(picture.astype(np.float64) - truth).mean(-1))
    scale = np.sqrt(np.square(truth[served].astype(np.float64)).mean()) if served.any() else 0.0
    return np.where(served, error / scale, 0.0) if scale > 0.0 else np.zeros(served.shape)


def heat_map(picture: np.ndarray, truth: np.ndarray, served: np.ndarray, end: float | None = None) -> Heat:
    """A picture's errors in colours over the served pixels; the others are the truth in dark grey.

    Args:
        picture, truth: (h, w, 3) linear radiance, row 0 at the bottom.
        served: (h, w) bool: the pixels that are measured.
        end: of the scale, such as that of a map to compare with; None: what 99 % of the served pixels need.

    Raises:
        ValueError: the shapes differ.
    """
    errors = relative_errors(picture, truth, served)
    if end is None:
        end = rounded_up(max(float(np.percentile(errors[served], _MOST)) if served.any() else 0.0, _LEAST))
    grey = np.maximum(truth.astype(np.float64), 0.0) @ (0.2126, 0.7152, 0.0722)
    dimmed = _DIM * colours.from_linear(grey / (1.0 + grey))
    drawn = np.where(served[..., None], colours.heat(errors / end), dimmed[..., None])
    marks = [(share, f"{100.0 * share * end:.3g} %") for share in (0.0, 0.5)] + [(1.0, f"{100.0 * end:.3g} % or more")]
    bar = colours.heat(np.linspace(0.0, 1.0, 256))
    return Heat(with_bar(colours.as_bytes(drawn[::-1]), bar, marks), end)
