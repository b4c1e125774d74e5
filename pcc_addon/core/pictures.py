"""Which pictures a probe may have: each has a key, whatever its file is called."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

LADDER: tuple[float, ...] = (0.0, 0.05, 0.1, 0.16, 0.23, 0.32, 0.44, 0.6)
"""GGX roughnesses of the radiance levels, sharpest first; a roughness between two is mixed from both."""

NEARNESS = -1.0
"""What stands for a roughness where pictures are kept by it, for the one that tells how near things are."""

STILL = -1
"""The number of a picture that is no part of a sequence."""


class PictureKind(str, Enum):
    """What a picture holds."""

    RADIANCE = "radiance"  # linear radiance, prefiltered by the GGX lobe of its level
    NEARNESS = "nearness"  # 1/metres from the capture point to what it sees, three times the same


@dataclass(frozen=True, order=True)
class PictureKey:
    """A picture of a probe.

    Attributes:
        kind: what it holds.
        level: which step of its kind's ladder, 0 for the capture itself.
        number: which picture of a sequence, from 0; `STILL` for the only one.
    """

    kind: PictureKind
    level: int
    number: int = STILL

    @property
    def text(self) -> str:
        """The key as sidecars have it, such as "radiance-2", or "radiance-2@17" in a sequence."""
        return self.family if self.number == STILL else f"{self.family}@{self.number}"

    @property
    def family(self) -> str:
        """What it has in common with the other pictures of its sequence, such as "radiance-2"."""
        return f"{self.kind.value}-{self.level}"

    @classmethod
    def parse(cls, text: str) -> PictureKey:
        """The key of a text.

        Raises:
            ValueError: it is none.
        """
        family, found, number = text.partition("@")
        kind, _, level = family.rpartition("-")
        if found and not (number.isascii() and number.isdigit()):
            raise ValueError(f"'{number}' is no number of a picture")
        return cls(PictureKind(kind), int(level), int(number) if found else STILL)
