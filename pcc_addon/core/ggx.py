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
    view: np.ndarray, alpha: float, grid: int, distribution: Distribution
) -> tuple[np.ndarray, np.ndarray | float]:
    """Microfacet normals (grid², 3), and by how much more than they are drawn each is seen from a direction."""
    if distribution is Distribution.GGX:
        return _visible_normals(view[2], alpha, grid), 1.0
    u1, u2 = _stratified(grid)
    tangent, angle = alpha * np.sqrt(-np.log1p(-u1)), 2.0 * np.pi * u2
    z = 1.0 / np.sqrt(1.0 + tangent**2)
    half = np.stack([tangent * np.cos(angle) * z, tangent * np.sin(angle) * z, z], -1)
    seen = 1.0 / (1.0 + _smith_lambda(view[2], alpha, distribution))
    return half, np.maximum(half @ view, 0.0) / (z * view[2]) * seen


def _stratified(grid: int) -> tuple[np.ndarray, np.ndarray]:
    """The midpoints of grid² cells of the unit square."""
    u = (np.arange(grid) + 0.5) / grid
    first, second = np.meshgrid(u, u, indexing="ij")
    return first.ravel(), second.ravel()


def _visible_normals(view_cosine: float, alpha: float, grid: int) -> np.ndarray:
    """Midpoint-stratified microfacet normals (grid², 3), distributed as seen from a direction in the xz plane."""
    u1, u2 = _stratified(grid)
    view = np.array([np.sqrt(max(0.0, 1.0 - view_cosine**2)) * alpha, 0.0, view_cosine])
    view /= np.linalg.norm(view)
    across = np.array([0.0, 1.0, 0.0])
    up = np.cross(view, across)
    radius, angle = np.sqrt(u1), 2.0 * np.pi * u2
    t1, t2 = radius * np.cos(angle), radius * np.sin(angle)
    lift = 0.5 * (1.0 + view[2])
    t2 = (1.0 - lift) * np.sqrt(np.maximum(0.0, 1.0 - t1 * t1)) + lift * t2
    height = np.sqrt(np.maximum(0.0, 1.0 - t1 * t1 - t2 * t2))
    normal = t1[:, None] * across + t2[:, None] * up + height[:, None] * view
    normal *= (alpha, alpha, 1.0)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def lobe_samples(
    cosine: float, roughness: float, grid: int = 96, distribution: Distribution = Distribution.GGX
) -> tuple[np.ndarray, np.ndarray]:
    """Microfacets as a view sees them, each as likely as any other.

    Args:
        cosine: between view and normal, in (0, 1].
        roughness: above 0.
        grid: samples on each side.
        distribution: of the microfacets.

    Returns:
        (grid²,) float64 each: the cosine between view and microfacet, and how much of the light that the microfacet
        mirrors leaves the surface.
    """
    facets, _, leaving = reflected_samples(cosine, roughness, grid, distribution)
    return facets, leaving


def reflected_samples(
    cosine: float, roughness: float, grid: int = 96, distribution: Distribution = Distribution.GGX
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`lobe_samples` with the way that the mirrored light takes.

    The normal is z, and the view lies over the x axis.

    Returns:
        (grid²,) the cosine between view and microfacet, (grid², 3) the unit direction in which the microfacet mirrors
        the view, and (grid²,) how much of the light leaves the surface.
    """
    alpha = roughness * roughness
    view = np.array([np.sqrt(1.0 - cosine * cosine), 0.0, cosine])
    half, seen = _facets(view, alpha, grid, distribution)
    view_half = np.clip(half @ view, 0.0, 1.0)
    light = 2.0 * view_half[:, None] * half - view
    return view_half, light, seen * _leaving(cosine, light[:, 2], alpha, distribution)


def _leaving(cosine: float, light_cosine: np.ndarray, alpha: float, distribution: Distribution) -> np.ndarray:
    """How much of the light of facets that the view sees is not shadowed."""
    lambda_view, lambda_light = (_smith_lambda(c, alpha, distribution) for c in (cosine, light_cosine))
    return np.where(light_cosine > 0.0, (1.0 + lambda_view) / (1.0 + lambda_view + lambda_light), 0.0)


def transmitted_samples(
    cosine: float, roughness: float, eta: float, grid: int = 96, distribution: Distribution = Distribution.GGX
) -> tuple[np.ndarray, np.ndarray]:
    """`lobe_samples` for light that the microfacets bend to the other side, by an index of refraction `eta`."""
    alpha = roughness * roughness
    view = np.array([np.sqrt(1.0 - cosine * cosine), 0.0, cosine])
    half, seen = _facets(view, alpha, grid, distribution)
    view_half = np.clip(half @ view, 0.0, 1.0)
    root = 1.0 - (1.0 - view_half**2) / eta**2  # negative under total internal reflection
    light_cosine = cosine / eta - (view_half / eta - np.sqrt(np.maximum(root, 0.0))) * half[:, 2]
    leaving = _leaving(cosine, light_cosine, alpha, distribution)
    return view_half, seen * np.where(root > 0.0, leaving, 0.0)


def directional_averages(cosines: np.ndarray, roughness: float, curves: Sequence[Curve], grid: int = 96) -> np.ndarray:
    """∫ f(v·h) dE over a GGX lobe with F = f, by the cosine of the view direction.

    Args:
        cosines: (n,) cosines between view and normal, in (0, 1].
        roughness: 0 … 1; 0 is the mirror, whose averages are the curves themselves.
        curves: functions of v·h, such as a Fresnel curve; the constant 1 gives the lobe's albedo.
        grid: quadrature points on each side.

    Returns:
        (len(curves), n) float64.
    """
    cosines = np.asarray(cosines, np.float64)
    if roughness == 0.0:
        return np.stack([curve(cosines) * np.ones_like(cosines) for curve in curves])
    samples = [lobe_samples(cosine, roughness, grid) for cosine in cosines]
    return np.array([[np.mean(weight * curve(facet)) for facet, weight in samples] for curve in curves])


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
