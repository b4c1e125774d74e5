"""How several probes share a point: families of hard cases, compositing in plain words, the bound of rounding.

The reference covers each probe over those before it and never divides by what is covered, as shaders must to mix two
at a time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core.effects import choice
from pcc_addon.core.expression import Expr, Formula, lift, scalar

from . import rounding as r
from .columns import Columns, Families
from .digits import Numbers, float64
from .families import log_uniform, nudged, signs, single
from .rounding import ROUNDOFF, Rounded

Apart = tuple[tuple[int, ...], ...]
HANDOVER = 0.2  # of the fade

LAYOUTS: dict[str, Apart] = {
    "rooms": ((), (0,), (0, 1), (0, 1, 2)),
    "boxes over each other": ((), (), (), ()),
    "two rooms, in each a box": ((), (0,), (1,), (0, 2)),
}
"""For each probe those before it that its box keeps out of, from the lowest to the highest; it is over the others."""


@dataclass(frozen=True)
class Shared(Columns):
    """n points and their probes; all arrays are float32.

    Attributes:
        depth: (n, probes) metres of the point below the nearest wall of each box; negative outside.
        weight: (n, probes) of the point that each probe has where it is the only one, 0 … 1.
        fade: (n, probes) metres over which it fades, above 0.
        diffuse: (n,) 1 on paths that left a diffuse surface, else 0.
    """

    depth: np.ndarray
    weight: np.ndarray
    fade: np.ndarray
    diffuse: np.ndarray

    def inputs(self) -> dict[str, np.ndarray]:
        """By the names of the formula's inputs."""
        named = {"Depth": self.depth, "Weight": self.weight, "Fade": self.fade}
        each = {f"{name} {k}": part[:, k] for name, part in named.items() for k in range(part.shape[1])}
        return each | {"Diffuse Depth": self.diffuse, "Captured": np.zeros_like(self.diffuse)}


def sharing(layout: str) -> Formula:
    """What each probe and the own lobe have of a point in the end, as twins mix them; "Part 0" … and "Own"."""
    apart = LAYOUTS[layout]
    depths = [scalar(f"Depth {k}") for k in range(len(apart))]
    outside = [choice.OUTSIDE(Depth=depth)["Distance"] for depth in depths]
    covered: Expr = scalar("Weight 0")
    parts: list[Expr] = [lift(1.0)]
    for k in range(1, len(apart)):
        given = {"Depth": depths[k], "Weight": scalar(f"Weight {k}"), "Coverage": covered, "Fade": scalar(f"Fade {k}")}
        if apart[k]:
            given["Distance"] = outside[apart[k][0]]
        for other in apart[k][1:]:
            given["Distance"] = choice.NEARER(Distance=given["Distance"], Other_Distance=outside[other])["Distance"]
        step = (choice.BESIDE if apart[k] else choice.OVER)(**given)
        parts = [part * (1.0 - step["Share"]) for part in parts] + [step["Share"]]
        covered = step["Coverage"]
    last = choice.own_share(None)(Coverage=covered)
    shown = {f"Part {k}": part * last["Covered"] for k, part in enumerate(parts)}
    return Formula(f"Sharing, {layout}", shown | {"Own": last["Share"]})


def parts_of(found: dict[str, np.ndarray]) -> np.ndarray:
    """(n, probes + 1) of what `sharing` finds; the own lobe is last."""
    return np.stack(np.broadcast_arrays(*found.values()), -1)


def exact(shared: Shared, layout: str, numbers: Numbers = float64) -> np.ndarray:
    """(n, probes + 1): what each probe covers, less what those over it do; the own lobe has what is left."""
    depth, weight, fade = (numbers(a) for a in (shared.depth, shared.weight, shared.fade))
    outside = np.maximum(-depth, 0)
    covers = []
    for k, apart in enumerate(LAYOUTS[layout]):
        if k == 0:
            covers.append(weight[:, 0])
        elif not apart:
            inside = np.minimum(np.maximum(1 + depth[:, k] / fade[:, k], 0), 1)
            covers.append(np.minimum(weight[:, k], inside * inside * (3 - 2 * inside)))
        else:
            before, own = outside[:, list(apart)].min(-1), outside[:, k]
            squares = before**2 + own**2
            share = np.where(squares > 0, before**2 / np.where(squares > 0, squares, 1), 0)
            handed_over = np.minimum(before / (numbers(np.float32(HANDOVER)[None]) * fade[:, k]), 1)
            covers.append(share * handed_over * weight[:, k])
    left, parts = 1 + 0 * depth[:, 0], []
    for covered in covers[::-1]:
        parts.append(left * covered)
        left = left * (1 - covered)
    seen = 1 - numbers(shared.diffuse)
    return np.stack([*(part * seen for part in parts[::-1]), 1 - (1 - left) * seen], -1)


def steepest(shared: Shared, layout: str) -> np.ndarray:
    """(n,) how much any part may change, at most, for each metre by which depths change, if weights fade by 1.5 / fade.

    Parts are products of what probes cover and of what those over them leave, so that slopes add up.
    """
    fade = shared.fade.astype(np.float64)
    beside = np.array([bool(apart) for apart in LAYOUTS[layout]])
    return ((1.5 + beside * choice.steepness(1.0)) / fade).sum(-1)


# The bound -----------------------------------------------------------------------------------------------------------


def bound(shared: Shared, layout: str, truth: np.ndarray) -> np.ndarray:
    """(n, probes + 1) how far from the exact parts float32 may end."""
    return np.stack([part.off(truth[:, k]) for k, part in enumerate(_rounded(shared, layout))], -1)


def _rounded(shared: Shared, layout: str) -> Sequence[Rounded]:
    """What float32 may find, operation by operation; shares are from 0 to 1, since none of their sums loses a part."""
    depth, weight, fade = (Rounded.given(a) for a in (shared.depth, shared.weight, shared.fade))
    one = Rounded.given(np.ones(len(shared)))
    parts, coverage = [one], weight[:, 0]
    outside = [(-depth[:, k]).within(0.0, np.inf) for k in range(shared.depth.shape[1])]
    for k, apart in enumerate(LAYOUTS[layout]):
        if k == 0:
            continue
        if apart:
            before = outside[apart[0]]
            for other in apart[1:]:
                before = r.minimum(before, outside[other])
            farther = before * before
            share = (farther / (farther + outside[k] * outside[k])).within(0.0, 1.0)
            covers = share * (before / (fade[:, k] * _HANDOVER_IN_FLOAT32)).within(0.0, 1.0) * weight[:, k]
        else:
            covers = r.minimum(weight[:, k], r.smooth(depth[:, k] / fade[:, k] + 1.0))
        coverage = covers + coverage * (-covers + 1.0)
        share = (covers / coverage).within(0.0, 1.0)
        parts = [part * (-share + 1.0) for part in parts] + [share]
    covered = coverage * (-Rounded.given(shared.diffuse) + 1.0)
    return [*(part * covered for part in parts), -covered + 1.0]


_HANDOVER_IN_FLOAT32 = float(np.float32(HANDOVER))


def sum_bound(probes: int) -> float:
    """How far from 1 the parts of so many probes and of the own lobe may add up: 4 ulp a probe.

    One share is 1 to begin with. Each probe more takes s and leaves 1 − s of the others, which rounds by ε, as does
    the product; so what is shared stays 1 to 2 ε a probe. Its product with what is covered and the own lobe's
    difference from that round by ε each.
    """
    return 4 * probes * ROUNDOFF


# The families --------------------------------------------------------------------------------------------------------

FAMILIES: Families[Shared] = Families("sharing")
family = FAMILIES.family
PROBES = 4


def _of(rng: np.random.Generator, depth: np.ndarray, fade: np.ndarray, full: float = 0.5) -> Shared:
    """Weights that fade as probes do outside, times one of their own for all but a share of the cases."""
    depth, fade = single(depth), single(fade)
    steps = np.clip(1.0 + depth.astype(np.float64) / fade, 0.0, 1.0)
    own = np.where(rng.random(depth.shape) < full, 1.0, rng.random(depth.shape))
    diffuse = single(rng.random(len(depth)) < 0.1)
    return Shared(depth, single(steps * steps * (3.0 - 2.0 * steps) * own), fade, diffuse)


def _fades(rng: np.random.Generator, n: int) -> np.ndarray:
    return log_uniform(rng, 0.05, 1.0, (n, PROBES))


@family("anywhere")
def anywhere(rng: np.random.Generator, n: int) -> Shared:
    return _of(rng, rng.uniform(-0.5, 0.5, (n, PROBES)), _fades(rng, n))


@family("deep inside one, outside the others")
def inside_one(rng: np.random.Generator, n: int) -> Shared:
    own = np.eye(PROBES)[rng.integers(0, PROBES, n)]
    depth = np.where(own > 0, 1.0, -1.0) * rng.uniform(0.0, 3.0, (n, PROBES))
    return _of(rng, depth, _fades(rng, n), full=1.0)


@family("through a doorway")
def doorway(rng: np.random.Generator, n: int) -> Shared:
    """Pairs of rooms a wall's thickness apart: as deep in one as outside the other, but for the wall."""
    wall, x = rng.uniform(0.0, 0.3, n), rng.uniform(-0.3, 0.5, n)
    depth = np.stack([-x, x - wall, -x - rng.random(n), x - wall - rng.random(n)], -1)
    return _of(rng, depth, _fades(rng, n), full=0.8)


@family("where boxes touch, ±0 … 1e-3")
def touching(rng: np.random.Generator, n: int) -> Shared:
    """The borders of all boxes are next to the point, as in a corner of rooms."""
    depth = signs(rng, (n, PROBES)) * log_uniform(rng, 1e-30, 1e-3, (n, PROBES))
    return _of(rng, np.where(rng.random((n, PROBES)) < 0.4, depth * 0.0, depth), _fades(rng, n), full=0.8)


@family("ends of fades and handovers ±4 ulp")
def ends(rng: np.random.Generator, n: int) -> Shared:
    fade = single(_fades(rng, n))
    depth = single(-fade * rng.choice([0.0, HANDOVER, 0.5, 1.0], (n, PROBES)))
    return _of(rng, nudged(depth, rng.integers(-4, 5, (n, PROBES))), fade, full=0.8)


@family("a hair apart")
def hair(rng: np.random.Generator, n: int) -> Shared:
    """Outside of all, by nearly the same distance."""
    away = log_uniform(rng, 1e-6, 0.3, (n, 1))
    return _of(rng, -away * (1.0 + rng.uniform(-1e-6, 1e-6, (n, PROBES))), _fades(rng, n))


@family("far outside of all")
def far_outside(rng: np.random.Generator, n: int) -> Shared:
    """Metres and, for surfaces that face away, a thousand kilometres; some probes have a weight outside as well."""
    shared = _of(rng, -log_uniform(rng, 1.0, 1e6, (n, PROBES)), _fades(rng, n))
    return replace(shared, weight=single(np.where(rng.random((n, PROBES)) < 0.5, 1.0, shared.weight)))


@family("fades of a nanometre and of a kilometre")
def abrupt(rng: np.random.Generator, n: int) -> Shared:
    fade = rng.choice([1e-9, 1e3], (n, PROBES))
    return _of(rng, fade * rng.uniform(-1.5, 0.5, (n, PROBES)), fade)


@family("next to no weight, 1e-45 … 1e-6")
def weightless(rng: np.random.Generator, n: int) -> Shared:
    shared = anywhere(rng, n)
    weight = np.where(rng.random((n, PROBES)) < 0.3, 0.0, log_uniform(rng, 1e-45, 1e-6, (n, PROBES)))
    return replace(shared, weight=single(weight))


@family("a step of a hundredth of the fade")
def stepped(rng: np.random.Generator, n: int) -> Shared:
    """Pairs: every second point is beside the one before, its depths up to a step deeper or less deep."""
    half = (n + 1) // 2
    fade = np.repeat(log_uniform(rng, 0.05, 1.0, (half, 1)), PROBES, 1)
    reach = np.where(rng.random((half, 1)) < 0.5, 1.1, 0.02)  # all over the fade, or where boxes touch
    depth = fade * reach * rng.uniform(-1.0, 0.3, (half, PROBES))
    moved = depth + 0.01 * fade * rng.uniform(-1.0, 1.0, (half, PROBES))
    pairs = np.stack([depth, moved], 1).reshape(-1, PROBES)[:n]
    shared = _of(rng, pairs, np.repeat(fade, 2, 0)[:n], full=1.0)
    return replace(shared, diffuse=np.zeros(n, np.float32))


STEPPED = "a step of a hundredth of the fade"


def steps(shared: Shared, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far every second point of `STEPPED` is from the one before, metres, and the most that a part changes."""
    count = len(shared) // 2 * 2
    metres = np.abs(np.diff(shared.depth[:count].astype(np.float64).reshape(-1, 2, PROBES), axis=1)).max((1, 2))
    return metres, np.abs(np.diff(parts[:count].reshape(-1, 2, PROBES + 1), axis=1)).max((1, 2))
