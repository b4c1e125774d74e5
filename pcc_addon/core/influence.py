"""Where a probe is shown, how much and by whom, as far as it differs from "in its box, by all"."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .errors import ProbeError

Triple = tuple[float, float, float]

_ENDS = ("low", "high")


@dataclass(frozen=True)
class Influence:
    """What an artist says about a probe's influence. Lows are the faces at the box's own −X, −Y, −Z, highs the others.

    Attributes:
        low, high: how far the influence box reaches beyond the faces of the proxy box, metres; below 0: stays short.
        falloff_low, falloff_high: over which distance it fades beyond each face, metres; None: as over all.
        normal_fade: how deep below the border of the influence surfaces that face away from the capture point still
            fade, metres.
        weight: how much of a surface the probe has where it is shown in full, 0 … 1.
        priority: where boxes overlap, the probe with the higher one is shown.
        receivers: names of the only objects that show it; None: all do.
        excluded: names of objects that do not show it.
    """

    low: Triple = (0.0, 0.0, 0.0)
    high: Triple = (0.0, 0.0, 0.0)
    falloff_low: Triple | None = None
    falloff_high: Triple | None = None
    normal_fade: float = 0.0
    weight: float = 1.0
    priority: int = 0
    receivers: frozenset[str] | None = None
    excluded: frozenset[str] = frozenset()

    def check(self, name: str, half_widths: np.ndarray) -> None:
        """Refuse what no shader can show, for a probe called `name` with a box of these half widths (3,).

        Raises:
            ProbeError: says what is wrong.
        """
        for end in _ENDS:
            if not np.isfinite(getattr(self, end)).all():
                raise ProbeError(f"probe '{name}': its influence is not finite; reset it")
            falloff = getattr(self, f"falloff_{end}")
            if falloff is not None and not (np.isfinite(falloff).all() and min(falloff) >= 0.0):
                raise ProbeError(f"probe '{name}': falloffs of its faces must be finite and not below 0")
        left = 2.0 * np.asarray(half_widths) + self.low + self.high
        if not (left > 0.0).all():
            axes = ", ".join(axis for axis, width in zip("XYZ", left, strict=True) if not width > 0.0)
            raise ProbeError(f"probe '{name}': its influence box has no size along {axes}; let its faces reach farther")
        if not (np.isfinite(self.normal_fade) and self.normal_fade >= 0.0):
            raise ProbeError(f"probe '{name}': normal fade {self.normal_fade:g} m must be finite and not below 0")
        if not 0.0 <= self.weight <= 1.0:
            raise ProbeError(f"probe '{name}': weight {self.weight:g} is not between 0 and 1")

    def accepts(self, item: str) -> bool:
        """Whether the object of this name may show the probe."""
        return item not in self.excluded and (self.receivers is None or item in self.receivers)

    def falloffs(self, plain: float) -> np.ndarray:
        """(2, 3) metres: how far it fades beyond the low and the high faces; `plain` where nothing is said."""
        given = (self.falloff_low, self.falloff_high)
        return np.array([(plain,) * 3 if falloff is None else falloff for falloff in given], np.float64)
