"""The radiance at a roughness, between the rungs of a ladder: families of hard cases, interpolation, its rounding."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core.effects.roughness import level_name, mixed_formula
from pcc_addon.core.expression import Formula
from pcc_addon.core.pictures import LADDER

from . import rounding as r
from .columns import Columns, Families
from .digits import Numbers, float64
from .families import log_uniform, nudged, signs, single
from .reference import LEAST_SPREAD, MOST_SPREAD
from .rounding import ROUNDOFF, Rounded

Rungs = tuple[float, ...]


def _in_float32(rungs: tuple[float, ...]) -> Rungs:
    return tuple(float(np.float32(rung)) for rung in rungs)


LADDERS: dict[str, Rungs] = {
    "the ladder of probes": _in_float32(LADDER),
    "two rungs": _in_float32((0.1, 0.16)),
    "rungs from 1e-4 on, 1e-4 apart": _in_float32((0.0, 1e-4, 2e-4, 0.5)),
}
"""As float32 numbers, which a shader's constants are."""


@dataclass(frozen=True)
class Mixed(Columns):
    """n surfaces; all arrays are float32.

    Attributes:
        roughness: (n,) of the surface.
        spread: (n,) of the level to be shown, over the surface's roughness: 1 but where contacts are hardened.
        levels: (n, rungs, 3) radiance of each level there.
    """

    roughness: np.ndarray
    spread: np.ndarray
    levels: np.ndarray

    def inputs(self) -> dict[str, np.ndarray]:
        """By the names of the formula's inputs."""
        levels = {level_name(k): self.levels[:, k] for k in range(self.levels.shape[1])}
        return {"Roughness": self.roughness, "Spread": self.spread, **levels}


def mixing(ladder: str, hardening: bool) -> Formula:
    return mixed_formula(LADDERS[ladder], hardening)


def exact(mixed: Mixed, ladder: str, hardening: bool, numbers: Numbers = float64) -> np.ndarray:
    """(n, 3): between the two rungs that the roughness lies between; the ends beyond them."""
    rungs, levels = numbers(np.array(LADDERS[ladder], np.float32)), numbers(mixed.levels)
    roughness = numbers(mixed.roughness) * (numbers(mixed.spread) if hardening else 1)
    roughness = np.minimum(np.maximum(roughness, rungs[0]), rungs[-1])
    found = levels[:, 0]
    for k in range(len(rungs) - 1):
        share = ((roughness - rungs[k]) / (rungs[k + 1] - rungs[k]))[:, None]
        between = levels[:, k] * (1 - share) + levels[:, k + 1] * share
        found = np.where((roughness > rungs[k])[:, None], between, found)
    return found


def bound(mixed: Mixed, ladder: str, hardening: bool, truth: np.ndarray) -> np.ndarray:
    """(n, 3) how far from the exact radiance float32 may end that adds a difference of two levels for each rung."""
    rungs = LADDERS[ladder]
    roughness, levels = Rounded.given(mixed.roughness), Rounded.given(mixed.levels)
    if hardening:
        roughness = roughness * Rounded.given(mixed.spread)
    found = levels[:, 0]
    for k in range(len(rungs) - 1):
        per_roughness = 1.0 / (rungs[k + 1] - rungs[k])
        share = ((roughness - rungs[k]) * Rounded.given(per_roughness, ROUNDOFF * per_roughness)).within(0.0, 1.0)
        found = found + (levels[:, k + 1] - levels[:, k]) * r.scalar(share)
    return found.off(truth)


# The families --------------------------------------------------------------------------------------------------------

FAMILIES: Families[Mixed] = Families("levels")
family = FAMILIES.family


@family("anywhere")
def anywhere(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    rungs = LADDERS[ladder]
    return Mixed(
        roughness=single(rng.uniform(0.0, 1.1 * rungs[-1], n)),
        spread=single(rng.uniform(LEAST_SPREAD, MOST_SPREAD, n)),
        levels=single(log_uniform(rng, 0.01, 10.0, (n, len(rungs), 3))),
    )


@family("on rungs ±4 ulp")
def on_rungs(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    rungs = single(rng.choice(LADDERS[ladder], n))
    return replace(anywhere(rng, n, ladder), roughness=nudged(rungs, rng.integers(-4, 5, n)), spread=np.ones(n, "f4"))


@family("hardened onto rungs")
def hardened(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    """The product of roughness and spread is a rung, or next to it."""
    mixed = anywhere(rng, n, ladder)
    return replace(mixed, roughness=single(rng.choice(LADDERS[ladder], n) / mixed.spread.astype(np.float64)))


@family("ends of the spread")
def cut_off(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    return replace(anywhere(rng, n, ladder), spread=single(rng.choice([LEAST_SPREAD, 1.0, MOST_SPREAD], n)))


@family("beyond the ladder, and 0")
def beyond(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    rungs = LADDERS[ladder]
    roughness = np.where(rng.random(n) < 0.5, signs(rng, (n,)) * 0.0, rungs[-1] * rng.uniform(1.0, 2.0, n))
    return replace(anywhere(rng, n, ladder), roughness=single(roughness))


@family("next to no roughness, 1e-45 … 1e-6")
def smooth(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    return replace(anywhere(rng, n, ladder), roughness=single(log_uniform(rng, 1e-45, 1e-6, (n,))))


@family("lamps beside the dark, 1e-6 … 65504")
def lamps(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    levels = log_uniform(rng, 1e-6, 65504.0, (n, len(LADDERS[ladder]), 3))
    return replace(anywhere(rng, n, ladder), levels=single(np.where(rng.random(levels.shape) < 0.2, 0.0, levels)))


@family("all levels alike")
def alike(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    mixed = anywhere(rng, n, ladder)
    return replace(mixed, levels=np.repeat(mixed.levels[:, :1], mixed.levels.shape[1], 1))


@family("radiance of 1e-45 … 1e-30")
def dark(rng: np.random.Generator, n: int, ladder: str) -> Mixed:
    return replace(
        anywhere(rng, n, ladder), levels=single(log_uniform(rng, 1e-45, 1e-30, (n, len(LADDERS[ladder]), 3)))
    )
