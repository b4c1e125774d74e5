"""Settings for three purposes, from what accuracy costs (docs/accuracy.md).

Half precision changed no error that was measured, denoised faces of 4 samples are as good as raw ones of 16, and twelve
steps of relief found all that 24 did; the width of faces is what counts where the box fits.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


@dataclass(frozen=True)
class PresetSettings:
    """What a preset sets of a probe; names and units are those of `Object.pcc_probe`."""

    resolution: int
    samples: int
    denoise: bool
    half_float: bool
    relief_steps: int
    relief_refinements: int


class Preset(Enum):
    """A purpose.

    Attributes:
        label: in words.
        purpose: a phrase.
        settings: for it.
    """

    def __init__(self, label: str, purpose: str, settings: PresetSettings) -> None:
        self.label, self.purpose, self.settings = label, purpose, settings

    PREVIEW = "Preview", "To see where reflections go, in seconds", PresetSettings(128, 4, True, True, 8, 3)
    MEDIUM = "Medium", "For most pictures", PresetSettings(512, 16, True, True, 12, 4)
    FINAL = "Final", "Where mirrors are large in the picture", PresetSettings(1024, 64, True, True, 12, 4)
