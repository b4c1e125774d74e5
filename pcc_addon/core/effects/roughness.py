"""The radiance at a roughness: mixed from the two nearest levels of a probe's ladder."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from functools import cache

from ..expression import Expr, Formula, clamp, scalar, vector
from ..pictures import LADDER
from .shading import ROUGHNESS

SPREAD = scalar("Spread")  # the roughness of the level to be shown, over the surface's


def level_name(k: int) -> str:
    """The name of an input here for level `k`, and of a probe's output for that of the ladder."""
    return f"Level {k}"


def rung_name(roughness: float) -> str:
    """The name of a probe's output at a roughness, whatever other levels it has."""
    step = next((k for k, rung in enumerate(LADDER) if abs(rung - roughness) < 1e-4), None)
    return f"Roughness {roughness:.4g}" if step is None else level_name(step)


def neighbours(rungs: Sequence[float], low: float, high: float) -> range:
    """The levels that surfaces of roughness `low` … `high` read, of a ladder of ascending roughnesses.

    A roughness that is a rung but for rounding reads that alone.
    """
    first = max(bisect_right(rungs, low * (1.0 + _ROUNDING)) - 1, 0)
    last = min(bisect_left(rungs, high * (1.0 - _ROUNDING)), len(rungs) - 1)
    return range(first, max(first, last) + 1)


_ROUNDING = 1e-6  # what sockets in single precision, and a product with a narrowing, may add


def mixed(rungs: Sequence[float], roughness: Expr) -> Expr:
    """The radiance of levels given as inputs, with the ladder's ends beyond its ends."""
    levels = [vector(level_name(k)) for k in range(len(rungs))]
    radiance: Expr = levels[0]
    for k in range(len(rungs) - 1):
        share = clamp((roughness - rungs[k]) * (1.0 / (rungs[k + 1] - rungs[k])))
        radiance = radiance + (levels[k + 1] - levels[k]) * share
    return radiance


@cache
def mixed_formula(rungs: tuple[float, ...], hardening: bool = False) -> Formula:
    """`mixed` at the input "Roughness", to be shared by all surfaces that read these rungs; output "Radiance".

    Args:
        rungs: ascending.
        hardening: whether the roughness is multiplied by the input "Spread" first.
    """
    title = " ".join(f"{rung:.3g}" for rung in rungs) + ", hardening" * hardening
    return Formula(f"Levels, {title}", {"Radiance": mixed(rungs, ROUGHNESS * SPREAD if hardening else ROUGHNESS)})
