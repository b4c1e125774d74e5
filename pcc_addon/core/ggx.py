"""Microfacet lobes: directional albedo by quadrature, and the kernel of GGX that blurs a mirror image.

alpha = roughness² throughout. Sources: Walter et al. 2007 (GGX, Beckmann, and the rational fit of Beckmann's masking
that renderers use), Heitz 2014 (height-correlated Smith masking), Heitz 2018 (sampling of visible normals), Karis 2013
(split sum, view = normal = reflection for the blur).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum

import numpy as np

Curve = Callable[[np.ndarray], np.ndarray]
Parts = tuple[np.ndarray, np.ndarray, np.ndarray]  # of directions: x, y, z


class Distribution(str, Enum):
    """How the normals of microfacets are spread."""

    GGX = "GGX"
    BECKMANN = "BECKMANN"

    @property
    def words(self) -> str:
        """What names of formulas have more than those of GGX."""
        return "" if self is Distribution.GGX else f", {self.value.title()}"

    @property
    def nearest(self) -> float:
        """The roughness of the GGX lobe that is most like one of this distribution, over that one's."""
        return 1.0 if self is Distribution.GGX else _NEAREST_TO_BECKMANN


# Where the squared difference of the lobes is least, up to roughness 0.6 and down to 17° above the surface.
_NEAREST_TO_BECKMANN = 0.96


def _smith_lambda(
    cosine: np.ndarray | float, alpha: float, distribution: Distribution = Distribution.GGX
) -> np.ndarray:
    tan2 = np.maximum(1.0 / np.maximum(cosine, 1e-12) ** 2 - 1.0, 0.0)
    if distribution is Distribution.GGX:
        return 0.5 * (np.sqrt(1.0 + alpha * alpha * tan2) - 1.0)
    a = 1.0 / np.maximum(alpha * np.sqrt(tan2), 1e-12)
    near = np.minimum(a, 1.6)
    return np.where(a < 1.6, (1.0 - 1.259 * near + 0.396 * near**2) / (3.535 * near + 2.181 * near**2), 0.0)


def _facets(
    sine: np.ndarray, cosine: np.ndarray, alpha: float, grid: int, distribution: Distribution
) -> tuple[Parts, np.ndarray | float]:
    """Microfacet normals beside the plane of a view, and by how much more than they are drawn each is seen from it."""
    if distribution is Distribution.GGX:
        return _visible_normals(sine, cosine, alpha, grid), 1.0
    u, angle = _stratified(grid)
    tangent = alpha * np.sqrt(-np.log1p(-u))
    x, y, z = _unit(tangent * np.cos(angle), tangent * np.sin(angle), np.ones_like(tangent))
    seen = 1.0 / (1.0 + _smith_lambda(cosine, alpha, distribution))
    return (x, y, z), np.maximum(x * sine + z * cosine, 0.0) / (z * cosine) * seen


def _stratified(grid: int) -> tuple[np.ndarray, np.ndarray]:
    """From the middle of a lobe to its rim (0 … 1), and half a turn around it: the midpoints of equal cells."""
    around = grid // 2
    outwards, turn = np.meshgrid((np.arange(grid) + 0.5) / grid, np.pi * (np.arange(around) + 0.5) / around)
    return outwards.ravel(), turn.ravel()


def _visible_normals(sine: np.ndarray, cosine: np.ndarray, alpha: float, grid: int) -> Parts:
    """Midpoint-stratified microfacet normals, distributed as seen from a direction in the xz plane."""
    u, angle = _stratified(grid)
    x, _, z = _unit(alpha * sine, np.zeros_like(sine), cosine)
    radius = np.sqrt(u)
    up, across = radius * np.cos(angle), radius * np.sin(angle)
    rest = 1.0 - across * across
    lift = 0.5 * (1.0 + z)
    up = (1.0 - lift) * np.sqrt(rest) + lift * up
    height = np.sqrt(np.maximum(0.0, rest - up * up))
    return _unit(alpha * (height * x - up * z), alpha * across, height * z + up * x)


def _unit(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> Parts:
    length = np.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def lobe_samples(
    cosine: np.ndarray | float, roughness: float, grid: int = 96, distribution: Distribution = Distribution.GGX
) -> tuple[np.ndarray, np.ndarray]:
    """Microfacets as views see them, each as likely as any other.

    They lie on one side of the plane of view and normal; those on the other side mirror them.

    Args:
        cosine: (…) between view and normal, in (0, 1].
        roughness: above 0.
        grid: samples from the middle of the lobe to its rim; half as many lie around it.
        distribution: of the microfacets.

    Returns:
        (…, grid · (grid // 2)) float64 each: the cosine between view and microfacet, and how much of the light that the
        microfacet mirrors leaves the surface.
    """
    facets, _, leaving = _reflected(cosine, roughness, grid, distribution)
    return facets, leaving


def reflected_samples(
    cosine: np.ndarray | float, roughness: float, grid: int = 96, distribution: Distribution = Distribution.GGX
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`lobe_samples` with the way that the mirrored light takes.

    The normal is z, and the view lies over the x axis.

    Returns:
        (…, n) the cosine between view and microfacet, (…, n, 3) the unit direction in which the microfacet mirrors the
        view, its y above 0, and (…, n) how much of the light leaves the surface.
    """
    facets, light, leaving = _reflected(cosine, roughness, grid, distribution)
    return facets, np.stack(light, -1), leaving


def _reflected(
    cosine: np.ndarray | float, roughness: float, grid: int, distribution: Distribution
) -> tuple[np.ndarray, Parts, np.ndarray]:
    """`reflected_samples`, the direction by its parts."""
    alpha = roughness * roughness
    sine, cosine = _view(cosine)
    (x, y, z), seen = _facets(sine, cosine, alpha, grid, distribution)
    view_half = np.clip(x * sine + z * cosine, 0.0, 1.0)
    twice = 2.0 * view_half
    light = twice * x - sine, twice * y, twice * z - cosine
    return view_half, light, seen * _leaving(cosine, light[2], alpha, distribution)


def _view(cosine: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """The sine and the cosine of views, (…, 1) each."""
    cosine = np.asarray(cosine, np.float64)[..., None]
    return np.sqrt(1.0 - cosine * cosine), cosine


def _leaving(cosine: np.ndarray, light_cosine: np.ndarray, alpha: float, distribution: Distribution) -> np.ndarray:
    """How much of the light of facets that the view sees is not shadowed."""
    lambda_view, lambda_light = (_smith_lambda(c, alpha, distribution) for c in (cosine, light_cosine))
    return np.where(light_cosine > 0.0, (1.0 + lambda_view) / (1.0 + lambda_view + lambda_light), 0.0)


def transmitted_samples(
    cosine: np.ndarray | float,
    roughness: float,
    eta: float,
    grid: int = 96,
    distribution: Distribution = Distribution.GGX,
) -> tuple[np.ndarray, np.ndarray]:
    """`lobe_samples` for light that the microfacets bend to the other side, by an index of refraction `eta`."""
    alpha = roughness * roughness
    sine, cosine = _view(cosine)
    (x, _, z), seen = _facets(sine, cosine, alpha, grid, distribution)
    view_half = np.clip(x * sine + z * cosine, 0.0, 1.0)
    root = 1.0 - (1.0 - view_half**2) / eta**2  # negative under total internal reflection
    light_cosine = cosine / eta - (view_half / eta - np.sqrt(np.maximum(root, 0.0))) * z
    leaving = _leaving(cosine, light_cosine, alpha, distribution)
    return view_half, seen * np.where(root > 0.0, leaving, 0.0)


def directional_averages(cosines: np.ndarray, roughness: float, curves: Sequence[Curve], grid: int = 96) -> np.ndarray:
    """∫ f(v·h) dE over a GGX lobe with F = f, by the cosine of the view direction.

    Args:
        cosines: (n,) cosines between view and normal, in (0, 1].
        roughness: 0 … 1; 0 is the mirror, whose averages are the curves themselves.
        curves: functions of v·h, such as a Fresnel curve; the constant 1 gives the lobe's albedo.
        grid: of quadrature points, as for `lobe_samples`.

    Returns:
        (len(curves), n) float64.
    """
    cosines = np.asarray(cosines, np.float64)
    if roughness == 0.0:
        return np.stack([curve(cosines) * np.ones_like(cosines) for curve in curves])
    facets, weights = lobe_samples(cosines, roughness, grid)
    return np.array([(weights * curve(facets)).mean(-1) for curve in curves])


def hemispherical_average(cosines: np.ndarray, values: np.ndarray) -> float:
    """2 ∫ values · µ dµ over 0 … 1 (the cosine-weighted mean of a directional albedo)."""
    order = np.argsort(cosines)
    mu = np.concatenate([[0.0], np.asarray(cosines)[order], [1.0]])
    v = np.asarray(values)[order]
    v = np.concatenate([v[:1], v, v[-1:]])
    products = 2.0 * v * mu
    return float((0.5 * (products[1:] + products[:-1]) * np.diff(mu)).sum())


def blur_kernel(angle: np.ndarray, roughness: float) -> np.ndarray:
    """Relative weight of light arriving at `angle` (radians) from the mirror direction, viewed along the normal.

    D(h) · G1(l) with h halfway: the lobe that the split sum assumes. Not normalised.
    """
    alpha2 = roughness**4
    half_cosine2 = np.cos(0.5 * angle) ** 2
    light_cosine = np.cos(angle)
    distribution = 1.0 / (half_cosine2 * (alpha2 - 1.0) + 1.0) ** 2
    masking = 1.0 / (1.0 + _smith_lambda(np.maximum(light_cosine, 0.0), roughness * roughness))
    return np.where(light_cosine > 0.0, distribution * masking, 0.0)
