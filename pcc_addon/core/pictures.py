"""Which pictures a probe may have: each has a key, whatever its file is called."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

LADDER: tuple[float, ...] = (0.0, 0.05, 0.1, 0.16, 0.23, 0.32, 0.44, 0.6)
"""GGX roughnesses of the radiance levels, sharpest first; a roughness between two is mixed from both."""


class PictureKind(str, Enum):
    """What a picture holds."""

    RADIANCE = "radiance"  # linear radiance, prefiltered by the GGX lobe of its level


@dataclass(frozen=True, order=True)
class PictureKey:
    """A picture of a probe.

    Attributes:
        kind: what it holds.
        level: which step of its kind's ladder, 0 for the capture itself.
    """

    kind: PictureKind
    level: int

    @property
    def text(self) -> str:
        """The key as sidecars and file names have it, such as "radiance-2"."""
        return f"{self.kind.value}-{self.level}"

    @classmethod
    def parse(cls, text: str) -> PictureKey:
        """The key of a text.

        Raises:
            ValueError: it is none.
        """
        kind, _, level = text.rpartition("-")
        return cls(PictureKind(kind), int(level))
