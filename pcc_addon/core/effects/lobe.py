"""The lobe of a surface as expressions of view cosine and roughness: how much it reflects, and at which angle.

A lobe reflects as a mirror would at an "effective cosine", times its albedo (what the masking of microfacets leaves of
white light): ∫ F dE = E · F(effective cosine), with the exact Fresnel curve F. Both E and the effective cosine are
smooth functions that vanish into E = 1 and the view's cosine for a mirror; here they are fitted for all roughnesses at
once, so that roughness may vary over a surface. Where it does not, Cycles computes the coefficients once.

Source of the lobe: `core.ggx`; the fit minimises the relative error of the reflectance at F0 = 0.02 or the curve's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..expression import Expr, clamp, multiply_add
from ..ggx import Curve, Distribution, lobe_samples, reflected_samples, transmitted_samples
from .fresnel import Facets, fresnel_dielectric

Coefficients = tuple[tuple[float, ...], ...]  # by term, then by power of the roughness, lowest first

_ANGLES = np.pi * (np.arange(20) + 0.5) / 20
_COSINES = np.concatenate([[0.0002, 0.001, 0.002, 0.004, 0.008], 0.5 - 0.5 * np.cos(_ANGLES), [1.0]])
_ROUGHNESSES = np.array([0.01, 0.03, 0.05, 0.08, 0.12, 0.16, 0.2, 0.25, 0.3, 0.36, 0.42, 0.5, 0.6, 0.7, 0.85, 1.0])
_IMPORTANT = 0.65  # roughness up to which the fit must be good
_LEAST_F0 = 0.02  # water
_SAMPLES = {Distribution.GGX: 40, Distribution.BECKMANN: 96}  # to the rim; Beckmann's are not drawn as they are seen
_POWERS = 5  # of roughness in each coefficient
# Of the angle between the mirrored view and the mean direction of the lobe. The mean is right for light that changes
# slowly with the direction; small lamps show where the lobe is densest, which is nearer to the mirrored view.
_TILT = 0.5
# Of the lobe's light in its parts from the most grazing facets to the least; the last are all seen nearly alike.
_SHARES = (0.4, 0.4, 0.2)


@dataclass(frozen=True)
class Lobe:
    """A lobe seen under an angle.

    Attributes:
        cosine: between view and normal, 0 … 1.
        roughness: 0 … 1.
        distribution: of its microfacets.
    """

    cosine: Expr
    roughness: Expr
    distribution: Distribution = Distribution.GGX

    @property
    def alpha(self) -> Expr:
        return self.roughness * self.roughness

    @property
    def grazing(self) -> Expr:
        """alpha / (alpha + cosine): 0 for a mirror, 1 along the surface; what masking depends on."""
        return self.alpha / (self.alpha + self.cosine)

    def albedo(self) -> Expr:
        """What the lobe reflects of white light where every microfacet is a perfect mirror."""
        return self._without(_albedo_fit(self.distribution))

    def average_albedo(self) -> Expr:
        """The cosine-weighted mean of the albedo over all views, an expression of roughness alone."""
        return 1.0 - self.alpha * _by_powers(_average_fit(self.distribution), self.roughness)[0]

    def transmittance(self, eta: float) -> Expr:
        """What the lobe lets through of white light to the other side of an interface that reflects nothing.

        Args:
            eta: index of refraction; below 1 that of its inverse is taken.
        """
        return self._without(_transmittance_fit(max(eta, 1.0 / eta), self.distribution))

    def _without(self, loss_fit: Coefficients) -> Expr:
        """What a loss leaves that is fitted by the first four powers of `grazing`."""
        loss = _by_powers(loss_fit, self.roughness)
        v = self.grazing
        return 1.0 - v * multiply_add(v, multiply_add(v, multiply_add(v, loss[3], loss[2]), loss[1]), loss[0])

    def effective_cosine(self, curve: Curve, f0: float) -> Expr:
        """The angle at which a mirror with this curve would reflect what the lobe does, but for the albedo.

        Args:
            curve: 0 at normal incidence, 1 along the surface; it must not rise with the cosine.
            f0: the least reflectance at normal incidence that it is used with.
        """
        constant, slope, first, second = _by_powers(
            _cosine_fit(curve, max(f0, _LEAST_F0), self.distribution), self.roughness
        )
        v = self.grazing
        shift = multiply_add(v, multiply_add(v, second, first), multiply_add(self.cosine, slope, constant))
        return clamp(multiply_add(self.alpha, shift, self.cosine))

    def facet_cosines(self) -> tuple[tuple[float, Expr], ...]:
        """The lobe's light in three parts, the most grazing first: each one's share and mean view on its facets."""
        v = self.grazing
        found = []
        for share, fit in zip(_SHARES, _facet_fits(self.distribution), strict=True):
            constant, slope, first, second = _by_powers(fit, self.roughness)
            shift = multiply_add(v, multiply_add(v, second, first), multiply_add(self.cosine, slope, constant))
            found.append((share, clamp(multiply_add(self.alpha, shift, self.cosine))))
        return tuple(found)

    def lean(self, facets: Facets) -> Expr:
        """How much of the normal to add to the mirrored view for the direction that most of the light comes from.

        Both are of length 1.

        Args:
            facets: which reflect it.
        """
        first, second, third = _by_powers(lean_fit(facets, self.distribution), self.roughness)
        v = self.grazing
        return self.alpha * v * multiply_add(v, multiply_add(v, third, second), first)

    def average(self, curve: Curve, angles: Curve, at_effective: Expr) -> Expr:
        """The mean of a curve over the lobe that rises and falls, from its value at another's effective cosine.

        Args:
            curve: what is averaged.
            angles: the curve that `effective_cosine` is known for, with F0 = 1.
            at_effective: `curve` at that cosine.
        """
        *powers, first, second = _by_powers(_average_of(curve, angles, self.distribution), self.roughness)
        polynomial = powers[-1]
        for coefficient in powers[-2::-1]:
            polynomial = multiply_add(self.cosine, polynomial, coefficient)
        return at_effective + self.alpha * multiply_add(
            self.grazing, multiply_add(self.grazing, second, first), polynomial
        )


def _by_powers(coefficients: Coefficients, roughness: Expr) -> list[Expr]:
    """Polynomials in the roughness, lowest power first."""
    found = []
    for powers in coefficients:
        value = powers[-1] * roughness + powers[-2]
        for coefficient in powers[-3::-1]:
            value = value * roughness + coefficient
        found.append(value)
    return found


_COSINE, _ROUGHNESS = (values.ravel() for values in np.meshgrid(_COSINES, _ROUGHNESSES))  # of all pairs, (pairs,)
_ALPHA = _ROUGHNESS**2
_GRAZING = _ALPHA / (_ALPHA + _COSINE)
_LOSS = tuple(_GRAZING**k for k in (1, 2, 3, 4))
_SHIFT = (_ALPHA, _ALPHA * _COSINE, _ALPHA * _GRAZING, _ALPHA * _GRAZING**2)  # of a cosine that stands for the view's


@cache
def _samples(distribution: Distribution) -> list[tuple[np.ndarray, np.ndarray]]:
    """The lobe's microfacet cosines and weights at each roughness, (cosines, samples) each."""
    return [lobe_samples(_COSINES, r, _SAMPLES[distribution], distribution) for r in _ROUGHNESSES]


def _mean(curve: Curve, distribution: Distribution) -> np.ndarray:
    """(pairs,) how much the lobe reflects where its facets follow a curve. A roughness at a time stays in the cache."""
    return np.concatenate([(weights * curve(facets)).mean(-1) for facets, weights in _samples(distribution)])


@cache
def _albedo(distribution: Distribution) -> np.ndarray:
    return _mean(np.ones_like, distribution)


def _fitted(terms: Sequence[np.ndarray], target: np.ndarray, weight: np.ndarray) -> Coefficients:
    """Coefficients by term and power of roughness, by weighted least squares."""
    basis = np.stack([term * _ROUGHNESS**j for term in terms for j in range(_POWERS)], -1)
    weight = weight * np.where(_ROUGHNESS <= _IMPORTANT, 1.0, 0.2)
    solution = np.linalg.lstsq(basis * weight[:, None], target * weight, rcond=None)[0]
    return tuple(tuple(float(k) for k in row) for row in solution.reshape(-1, _POWERS))


@cache
def _albedo_fit(distribution: Distribution) -> Coefficients:
    albedo = _albedo(distribution)
    return _fitted(_LOSS, 1.0 - albedo, 1.0 / albedo)


@cache
def _transmittance_fit(eta: float, distribution: Distribution) -> Coefficients:
    passed = np.concatenate([_passed(r, eta, distribution) for r in _ROUGHNESSES])
    left = 1.0 - _mean(lambda facets: fresnel_dielectric(facets, eta), distribution) / _albedo(distribution)
    return _fitted(_LOSS, 1.0 - passed / np.maximum(left, 1e-6), left + 1e-3)


def _passed(roughness: float, eta: float, distribution: Distribution) -> np.ndarray:
    """(cosines,) how much a lobe lets through to the other side."""
    facets, weights = transmitted_samples(_COSINES, roughness, eta, _SAMPLES[distribution], distribution)
    return (weights * (1.0 - fresnel_dielectric(facets, eta))).mean(-1)


@cache
def _average_fit(distribution: Distribution) -> Coefficients:
    albedo = _albedo(distribution).reshape(len(_ROUGHNESSES), -1)
    mu, values = np.concatenate([[0.0], _COSINES]), np.concatenate([albedo[:, :1], albedo], 1)
    products = 2.0 * mu * values
    means = (0.5 * (products[:, 1:] + products[:, :-1]) * np.diff(mu)).sum(1)
    means = means / (mu[-1] ** 2)
    basis = np.stack([_ROUGHNESSES ** (2 + j) for j in range(_POWERS)], -1)
    return (tuple(float(k) for k in np.linalg.lstsq(basis, 1.0 - means, rcond=None)[0]),)


@cache
def _cosine_fit(curve: Curve, f0: float, distribution: Distribution) -> Coefficients:
    mean = _mean(curve, distribution) / _albedo(distribution)
    x = np.linspace(0.0, 1.0, 4001)
    values = curve(x)
    slope = np.abs(np.gradient(values, x))
    effective = np.interp(mean, values[::-1], x[::-1])
    weight = (1.0 - f0) * np.interp(effective, x, slope) / (f0 + (1.0 - f0) * mean) + 1e-3
    return _fitted(_SHIFT, effective - _COSINE, weight)


@cache
def _facet_fits(distribution: Distribution) -> tuple[Coefficients, ...]:
    """Of the mean view on the facets of each part of the lobe's light."""
    means = np.concatenate([_by_share(facets, weights) for facets, weights in _samples(distribution)]).T
    return tuple(_fitted(_SHIFT, mean - _COSINE, np.ones_like(_COSINE)) for mean in means)


def _by_share(facets: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """(cosines, shares) the mean view on the facets of each part of a lobe's light, from (cosines, samples) each."""
    order = np.argsort(facets, -1)
    facets, weights = (np.take_along_axis(values, order, -1) for values in (facets, weights))
    weights = weights / weights.sum(-1, keepdims=True)
    light, moment = (np.pad(np.cumsum(values, -1), ((0, 0), (1, 0))) for values in (weights, weights * facets))
    edges = np.cumsum((0.0, *_SHARES))
    moments = np.stack([np.interp(edges, *row) for row in zip(light, moment, strict=True)])
    return np.diff(moments) / _SHARES


@cache
def lean_fit(facets: Facets, distribution: Distribution) -> Coefficients:
    """The coefficients of `Lobe.lean`: of `grazing`, its square and its cube, each times alpha."""
    tilts = [mean_tilt(_COSINES, r, facets, _SAMPLES[distribution], distribution) for r in _ROUGHNESSES]
    angle = np.arccos(np.minimum(_COSINE, 1.0 - 1e-4))  # head-on there is nothing to tilt
    lean = np.sin(angle) / np.tan(angle - _TILT * np.concatenate(tilts)) - np.cos(angle)
    weight = np.where(_COSINE < 1.0, 1.0 / (_ALPHA + 0.03), 0.0)  # narrow lobes must not be missed by as much
    return _fitted([_ALPHA * _GRAZING**k for k in (1, 2, 3)], lean, weight)


def mean_tilt(
    cosine: np.ndarray | float,
    roughness: float,
    facets: Facets,
    grid: int = 40,
    distribution: Distribution = Distribution.GGX,
) -> np.ndarray:
    """By which angle the mean direction of a lobe's light lies nearer to the normal than the mirrored view.

    Args:
        cosine: (…) between view and normal, in (0, 1].
        roughness: above 0.
        facets: which reflect the light.
        grid: of quadrature points, as for `lobe_samples`.
        distribution: of them.

    Returns:
        (…) float64, radians.
    """
    view_half, light, leaving = reflected_samples(cosine, roughness, grid, distribution)
    mean = ((leaving * facets.curve(view_half))[..., None, :] @ light)[..., 0, :]
    return np.arccos(cosine) - np.arctan2(-mean[..., 0], mean[..., 2])


@cache
def _average_of(curve: Curve, angles: Curve, distribution: Distribution) -> Coefficients:
    mean = _mean(curve, distribution) / _albedo(distribution)
    shift = np.stack([term * _ROUGHNESS**j for term in _SHIFT for j in range(_POWERS)])
    effective = np.clip(_COSINE + np.ravel(_cosine_fit(angles, 1.0, distribution)) @ shift, 0.0, 1.0)
    terms = [_ALPHA * _COSINE**k for k in range(6)] + [_ALPHA * _GRAZING, _ALPHA * _GRAZING**2]
    return _fitted(terms, mean - curve(effective), np.ones_like(_COSINE))
