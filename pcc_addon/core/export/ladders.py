"""Which roughness each level of a cubemap has, where engines have no say in it."""

from __future__ import annotations

from ..pictures import LADDER

_WIDEST = 512  # texels a face, at which each of our levels has two or more across the radius of half its lobe's energy
OWN_LEVELS = len(LADDER)


def own(level: int, width: int) -> float:
    """Our ladder's; smaller cubemaps begin farther up it, so that each level has the texels that its lobe needs."""
    skipped = max(_WIDEST.bit_length() - width.bit_length(), 0)
    return LADDER[min(level + skipped, len(LADDER) - 1)]
