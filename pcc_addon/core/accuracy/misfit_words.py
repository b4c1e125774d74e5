"""A misfit in words."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from ..words import named
from .misfit import ON_THE_BOX, Fit, Misfit, Sightings, at

_MOST_NAMES = 3
_LEAST = 0.0005  # of all directions: less is not told


def lines(found: Misfit, sightings: Sightings) -> Iterator[str]:
    """Sentences on where a box lies to what the capture point sees, the best directions first."""
    on = found.share(Fit.ON)
    yield f"The box is on what is seen, within {ON_THE_BOX * 100.0:.0f} cm, in {per_cent(on.share)} of directions"
    for fit, words in ((Fit.BEFORE, "before the box"), (Fit.BEYOND, "beyond the box")):
        share = found.share(fit)
        if share.share >= _LEAST:
            names = seen_there(found, sightings, fit)
            who = f" ({_few(names)})" if names else ""
            yield (
                f"{length(share.metres)} {words} in {per_cent(share.share)} of directions{who}: "
                f"mirrored through the box, that is off by {degrees(share.degrees)} on average"
            )
    nothing = found.share(Fit.NOTHING)
    if nothing.share >= _LEAST:
        yield (
            f"Nothing is there in {per_cent(nothing.share)} of directions: the world is mirrored as if it were on the "
            f"box, off by {degrees(nothing.degrees)} on average"
        )


def seen_there(found: Misfit, sightings: Sightings, fit: Fit) -> tuple[str, ...]:
    """Names of the objects that lie so to the box, those first that put most of the reflections off most."""
    weights: dict[str, float] = defaultdict(float)
    lying = at(found.fits[fit], sightings.vectors)
    angles = at(found.angles, sightings.vectors)
    for name, there, angle in zip(sightings.names, lying, angles, strict=True):
        if name and there:
            weights[name] += float(angle)
    return tuple(sorted(weights, key=lambda name: (-weights[name], name)))


def length(metres: float) -> str:
    """Such as "1.3 m", "4 cm" and "2 mm"."""
    if metres >= 0.995:
        return f"{metres:.1f} m"
    return f"{metres * 100.0:.0f} cm" if metres >= 0.0095 else f"{metres * 1000.0:.0f} mm"


def degrees(angle: float) -> str:
    """Such as "14°" and "0.4°"."""
    return f"{angle:.0f}°" if angle >= 9.95 else f"{angle:.1f}°"


def per_cent(share: float) -> str:
    """Such as "12 %" and "0.4 %"; "all" and "none" are never rounded to."""
    hundredths = 100.0 * share
    if 0.0 < hundredths < 0.1:
        return "less than 0.1 %"
    if 99.95 <= hundredths < 100.0 - 1e-9:
        return "more than 99.9 %"
    return (
        f"{hundredths:.1f} %" if 0.0 < hundredths < 1.0 or 99.0 < hundredths < 100.0 - 1e-9 else f"{hundredths:.0f} %"
    )


def _few(names: tuple[str, ...]) -> str:
    left = len(names) - _MOST_NAMES
    if left <= 0:
        return named(names)
    shown = [f"'{name}'" for name in names[:_MOST_NAMES]]
    return f"{', '.join(shown)} and {left} more"
