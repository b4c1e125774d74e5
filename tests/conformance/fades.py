"""The fade beyond the box: paddings and falloffs for cases, and the exact weight with the bound of its rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pcc_addon.core.effects.records import Correction
from pcc_addon.core.probe import STEEPEST_FALLOFF

from .bound import ALONG
from .cases import Cases
from .families import at, on_boundary, room
from .reference import Exact
from .rounding import ROUNDOFF


def fades(cases: Cases, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Paddings and falloffs in metres; a tenth of the falloffs are edges."""
    least = cases.half_widths.min(-1)
    falloff = np.where(rng.random(len(cases)) < 0.1, 0.0, least * 10.0 ** rng.uniform(-3.0, 0.5, len(cases)))
    padding = least * 10.0 ** rng.uniform(-5.0, -2.0, len(cases))
    return {"Padding": padding.astype(np.float32), "Falloff": np.maximum(falloff, STEEPEST_FALLOFF).astype(np.float32)}


def exact_weight(cases: Cases, truth: Exact, fade: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The weight (n,) in float64, and how far rounding may lead it astray."""
    padding, falloff = (fade[name].astype(np.float64) for name in ("Padding", "Falloff"))
    half = cases.half_widths.astype(np.float64)
    outside = (np.abs(truth.origin) - half).max(-1) - padding
    steps = 1.0 - outside / falloff
    reach = np.linalg.norm(cases.position.astype(np.float64) - cases.centre, axis=-1)
    # P − C, the dot products; then |q| − h, its difference from the padding, the division and 1 − x
    lost = ROUNDOFF * ((1 + ALONG[cases.correction]) * reach + (reach + half.max(-1)) + np.abs(outside))
    lost = lost / falloff + 2 * ROUNDOFF
    weight = _smooth(steps)
    off = np.maximum(_smooth(steps + lost) - weight, weight - _smooth(steps - lost))
    return weight, off + 6 * ROUNDOFF * weight


def _smooth(steps: np.ndarray) -> np.ndarray:
    cut = np.clip(steps, 0.0, 1.0)
    return cut * cut * (3.0 - 2.0 * cut)


def beyond_walls(count: int, correction: Correction) -> tuple[Cases, dict[str, np.ndarray]]:
    """Points from below a wall to beyond the fade, the same every time."""
    rng = np.random.default_rng(53)
    cases = room(rng, count, correction)
    fade = fades(cases, rng)
    lengths = fade["Padding"] + fade["Falloff"] * rng.uniform(-0.3, 1.5, count)
    local = on_boundary(rng, count)
    outward = np.where(np.abs(local) == 1.0, np.sign(local), 0.0)
    return replace(cases, position=at(cases, local + outward * lengths[:, None] / cases.half_widths)), fade
