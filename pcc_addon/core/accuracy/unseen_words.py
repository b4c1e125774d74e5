"""What a capture point does not see, in words."""

from __future__ import annotations

from collections.abc import Iterator

from ..words import named
from .misfit_words import per_cent
from .unseen import Part, Unseen, UnseenPart

_MOST_TOLD = 8
_LEAST_TOLD = 1e-3  # of the surfaces


def lines(found: Unseen, most: int = _MOST_TOLD) -> Iterator[str]:
    """Sentences on what is not seen, the largest part first; smaller ones than the first `most` are counted."""
    if not found.area:
        yield "No surface is in the probe's influence"
        return
    least = _LEAST_TOLD * found.area
    told = [part for part in found.parts if part.area >= least]
    if not told:
        yield "The capture point sees all surfaces in the probe's influence"
    else:
        share = per_cent(found.unseen_area / found.area)
        areas = f"{square_metres(found.unseen_area)} of {square_metres(found.area)}"
        yield f"The capture point does not see {areas} ({share}):"
    yield from map(words, told[:most])
    rest = told[most:]
    if rest:
        yield f"and {len(rest)} more, {square_metres(sum(part.area for part in rest))}"
    if found.idle >= least:
        yield f"{square_metres(found.idle)} more face nothing, such as the underside of what stands on the floor"


def words(part: UnseenPart) -> str:
    """Such as "the underside of 'Table', 1.2 m², which 'Floor' faces" and "4 % of 'Floor', 0.9 m²"."""
    where = f"{per_cent(part.share)} of" if part.part is Part.HIDDEN else f"the {part.part.value} of"
    facing = f", which {named(part.facing)} may mirror" if part.facing else ""
    return f"{where} '{part.name}', {square_metres(part.area)}{facing}"


def square_metres(area: float) -> str:
    """Such as "12 m²" and "0.04 m²"."""
    return f"{area:.0f} m²" if area >= 9.95 else f"{area:.1f} m²" if area >= 0.95 else f"{area:.2f} m²"
