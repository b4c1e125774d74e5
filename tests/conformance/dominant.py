"""Where rough surfaces are looked up: families of hard cases, the fitted direction, its rounding, the lobe itself."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pcc_addon.core.effects import dominant as formula
from pcc_addon.core.effects.fresnel import METAL, MIRRORS, Facets, dielectric_facets
from pcc_addon.core.effects.lobe import lean_fit
from pcc_addon.core.expression import Formula
from pcc_addon.core.ggx import Distribution
from tests.core.boxes import directions

from . import rounding as r
from .columns import Columns, Families
from .digits import Numbers, float64, inner, unit
from .families import log_uniform, signs, single
from .rounding import ROUNDOFF, Rounded

FACETS: dict[str, tuple[Facets, ...]] = {
    "mirrors": (MIRRORS,),
    "IOR 1.33": (dielectric_facets(1.33),),
    "IOR 1.5": (dielectric_facets(1.5),),
    "IOR 2.4": (dielectric_facets(2.4),),
    "metal over IOR 1.5": (dielectric_facets(1.5), METAL),
}


@dataclass(frozen=True)
class Views(Columns):
    """n rough surfaces that are seen; all arrays are float32.

    Attributes:
        incoming, normal: (n, 3) of length 1 to rounding, the normal on the eye's side.
        roughness, metallic: (n,) 0 … 1.
    """

    incoming: np.ndarray
    normal: np.ndarray
    roughness: np.ndarray
    metallic: np.ndarray

    def inputs(self) -> dict[str, np.ndarray]:
        """By the names of the formula's inputs."""
        return {
            "Incoming": self.incoming,
            "Normal": self.normal,
            "Roughness": self.roughness,
            "Metallic": self.metallic,
        }


def dominant(facets: str) -> Formula:
    return formula.dominant(FACETS[facets])


def exact(views: Views, facets: str, numbers: Numbers = float64) -> np.ndarray:
    """(n, 3) unit: the mirrored view and as much of the normal as the fitted coefficients say."""
    view, normal = (unit(numbers(v)) for v in (views.incoming, views.normal))
    roughness = numbers(views.roughness)[:, None]
    cosine = np.minimum(np.maximum(inner(view, normal), numbers(np.array(1e-12))), 1)
    grazing = roughness**2 / (roughness**2 + cosine)

    def lean(part: Facets) -> np.ndarray:
        fit = lean_fit(part, Distribution.GGX)
        powers = [(roughness**k, numbers(np.array(c))) for term in fit for k, c in enumerate(term)]
        each = len(fit[0])
        terms = (sum(p * c for p, c in powers[j * each : (j + 1) * each]) for j in range(len(fit)))
        return roughness**2 * sum(term * grazing ** (j + 1) for j, term in enumerate(terms))

    first, *metal = (lean(part) for part in FACETS[facets])
    share = numbers(views.metallic)[:, None]
    added = first * (1 - share) + metal[0] * share if metal else first
    return unit(2 * inner(view, normal) * normal - view + added * normal)


def bound(views: Views, facets: str, truth: np.ndarray) -> np.ndarray:
    """The largest angle in radians (n,) between what float32 finds and the exact direction; at most π."""
    view, normal = r.of_length_one(views.incoming), r.of_length_one(views.normal)
    roughness = Rounded.given(views.roughness)
    alpha = roughness * roughness
    grazing = (alpha / (alpha + r.dot(normal, view).within(1e-12, 1.0))).within(0.0, 1.0)

    def lean(part: Facets) -> Rounded:
        first, second, third = (_polynomial(c, roughness) for c in lean_fit(part, Distribution.GGX))
        return alpha * grazing * (grazing * (grazing * third + second) + first)

    parts = [lean(part) for part in FACETS[facets]]
    added = r.mix(*parts, Rounded.given(views.metallic)) if len(parts) == 2 else parts[0]
    found = r.normalize(normal * r.scalar(added) - r.reflect(view, normal))
    off = np.linalg.norm(found.off(truth), axis=-1)
    return np.where(off < 1.0, np.arcsin(np.minimum(off, 1.0)), np.pi)


def _polynomial(coefficients: tuple[float, ...], x: Rounded) -> Rounded:
    constants = [Rounded.given(c, ROUNDOFF * abs(c)) for c in coefficients]
    value = constants[-1]
    for constant in constants[-2::-1]:
        value = value * x + constant
    return value


# The lobe ------------------------------------------------------------------------------------------------------------

FIT = 0.016  # radians by which the fitted direction may miss; a tenth of a lobe's width or less


def halfway_to_the_mean(cosine: float, roughness: float, ior: float | None, grid: int = 160) -> float:
    """The angle from the normal halfway between the mirrored view and the mean direction of the lobe's light, radians.

    The mean of the directions into which GGX facets mirror the view, weighted by their number, the Smith masking of
    both ways (height-correlated) and Fresnel's reflectance; facets are drawn by their number as seen from above.

    Args:
        cosine: between view and normal, above 0.
        roughness: above 0; its square is GGX's alpha.
        ior: of the facets; None: perfect mirrors.
        grid: facets on each side.
    """
    alpha = roughness**2
    left, turn = np.meshgrid((np.arange(grid) + 0.5) / grid, np.pi * (np.arange(grid) + 0.5) / grid)
    steep = np.sqrt(1.0 + (alpha**2 - 1.0) * (1.0 - left**2))  # 1 − left² of the facets lie flatter
    up = left / steep
    aside = np.sqrt(1.0 - up**2)
    sine = np.sqrt(1.0 - cosine**2)
    on_facet = np.maximum(sine * aside * np.cos(turn) + cosine * up, 0.0)
    x, z = 2.0 * on_facet * aside * np.cos(turn) - sine, 2.0 * on_facet * up - cosine
    above = (z > 0.0) & (on_facet > 0.0)

    def hidden(c: np.ndarray | float) -> np.ndarray:
        return 0.5 * (np.sqrt(1.0 + alpha**2 * (1.0 / np.square(c) - 1.0)) - 1.0)

    masking = 1.0 / (1.0 + hidden(cosine) + hidden(np.where(above, z, 1.0)))
    weight = np.where(above, masking * on_facet * steep * _fresnel(on_facet, ior), 0.0)
    mean = np.arctan2(-(weight * x).sum(), (weight * z).sum())
    return float(0.5 * (np.arccos(cosine) + mean))


def _fresnel(cosine: np.ndarray, ior: float | None) -> np.ndarray:
    """The mean of both polarisations, by Snell's angles."""
    if ior is None:
        return np.ones_like(cosine)
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / ior**2)
    across, along = (cosine - ior * inside) / (cosine + ior * inside), (inside - ior * cosine) / (inside + ior * cosine)
    return 0.5 * (across**2 + along**2)


def towards(views: Views, angle: np.ndarray) -> np.ndarray:
    """(n, 3) unit: in the plane of view and normal, on the other side, by angles from the normal (n,)."""
    view, normal = (unit(v.astype(np.float64)) for v in (views.incoming, views.normal))
    across = unit(inner(view, normal) * normal - view)
    return np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * across


# The families --------------------------------------------------------------------------------------------------------

FAMILIES: Families[Views] = Families("dominant")
family = FAMILIES.family


def _seen_at(rng: np.random.Generator, cosine: np.ndarray, roughness: np.ndarray) -> Views:
    normal = directions(len(cosine), rng)
    across = unit(np.cross(normal, directions(len(cosine), rng)))
    incoming = cosine[:, None] * normal + np.sqrt(1.0 - cosine**2)[:, None] * across
    return Views(single(incoming), single(normal), single(roughness), single(rng.random(len(cosine))))


@family("anywhere")
def anywhere(rng: np.random.Generator, n: int) -> Views:
    return _seen_at(rng, rng.uniform(0.01, 1.0, n), rng.uniform(0.0, 0.6, n))


@family("grazing views, 1e-8 … 1e-2")
def grazing(rng: np.random.Generator, n: int) -> Views:
    return _seen_at(rng, log_uniform(rng, 1e-8, 1e-2, (n,)), rng.uniform(0.0, 0.6, n))


@family("head-on, ±1e-7")
def head_on(rng: np.random.Generator, n: int) -> Views:
    views = anywhere(rng, n)
    return replace(views, incoming=single(unit(views.normal + rng.uniform(-1e-7, 1e-7, (n, 3)))))


@family("mirrors, and roughness of 1e-30 … 1e-3")
def smooth(rng: np.random.Generator, n: int) -> Views:
    roughness = np.where(rng.random(n) < 0.2, 0.0, log_uniform(rng, 1e-30, 1e-3, (n,)))
    return _seen_at(rng, log_uniform(rng, 1e-8, 1.0, (n,)), roughness)


@family("as rough as can be")
def rough(rng: np.random.Generator, n: int) -> Views:
    return _seen_at(rng, rng.uniform(0.0, 1.0, n), rng.choice([0.6, 0.9, 1.0], n))


@family("along the axes, ±0")
def along_axes(rng: np.random.Generator, n: int) -> Views:
    views = anywhere(rng, n)
    axis = np.eye(3)[rng.integers(0, 3, n)] * signs(rng, (n, 1))
    facing = single(np.where(axis != 0.0, axis, signs(rng, (n, 3)) * 0.0))
    return replace(views, incoming=facing, normal=facing)


@family("normals that turn away from the eye")
def turned_away(rng: np.random.Generator, n: int) -> Views:
    """As bumps may; by up to 1e-2."""
    return _seen_at(rng, -log_uniform(rng, 1e-8, 1e-2, (n,)), rng.uniform(0.0, 0.6, n))
