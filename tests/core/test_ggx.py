"""The GGX lobe against brute force: light directions all over the hemisphere, in the solid angle measure."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from pcc_addon.core.ggx import (
    Distribution,
    blur_kernel,
    directional_averages,
    hemispherical_average,
    lobe_samples,
    transmitted_samples,
)

CURVES = [np.ones_like, lambda c: (1.0 - c) ** 5, lambda c: c * (1.0 - c) ** 6]


def distribution(normal_cosine: np.ndarray, alpha: float) -> np.ndarray:
    """Walter et al. 2007, equation 33, by the tangent."""
    tangent = np.tan(np.arccos(np.clip(normal_cosine, -1.0, 1.0)))
    return alpha**2 / (np.pi * normal_cosine**4 * (alpha**2 + tangent**2) ** 2)


def visibility(view_cosine: float, light_cosine: np.ndarray, alpha: float) -> np.ndarray:
    """Height-correlated masking and shadowing over 4 n·v n·l, as Lagarde and de Rousiers 2014 write it."""
    a2 = alpha * alpha
    by_light = light_cosine * np.sqrt(view_cosine**2 * (1.0 - a2) + a2)
    by_view = view_cosine * np.sqrt(light_cosine**2 * (1.0 - a2) + a2)
    return 0.5 / (by_light + by_view)


def beckmann(normal_cosine: np.ndarray, alpha: float) -> np.ndarray:
    """Walter et al. 2007, equation 25."""
    cosine = np.clip(normal_cosine, 1e-9, 1.0)
    return np.exp((1.0 - 1.0 / cosine**2) / alpha**2) / (np.pi * alpha**2 * cosine**4)


def exactly_hidden(cosine: np.ndarray | float, alpha: float) -> np.ndarray:
    """Beckmann's masking by the error function (Walter et al. 2007, equation 26), as what Heitz 2014 calls lambda."""
    cosine = np.asarray(cosine, np.float64)
    a = cosine / (alpha * np.sqrt(np.maximum(1.0 - cosine**2, 1e-12)))
    erf = np.vectorize(math.erf, otypes=[float])
    return 0.5 * (np.exp(-(a**2)) / (a * np.sqrt(np.pi)) - 1.0 + erf(a))


def beckmann_visibility(view_cosine: float, light_cosine: np.ndarray, alpha: float) -> np.ndarray:
    hidden = exactly_hidden(view_cosine, alpha) + exactly_hidden(np.maximum(light_cosine, 1e-9), alpha)
    return 0.25 / (view_cosine * np.maximum(light_cosine, 1e-9) * (1.0 + hidden))


def brute_force(
    view_cosine: float, roughness: float, count: int = 400, facets: Callable = distribution, seen: Callable = visibility
) -> np.ndarray:
    """∫ f(v·h) BRDF n·l dω for each of `CURVES`: midpoints in polar coordinates about the mirror direction.

    The rings are spaced by the cube of a uniform variable, finest where the lobe is.
    """
    alpha = roughness * roughness
    sine = np.sqrt(1.0 - view_cosine**2)
    view, mirror = np.array([sine, 0.0, view_cosine]), np.array([-sine, 0.0, view_cosine])
    across = np.array([0.0, 1.0, 0.0])
    x = (np.arange(count) + 0.5) / count
    ring, turn = np.pi * x**3, 2.0 * np.pi * x
    measure = np.sin(ring) * 3.0 * np.pi * x**2 * 2.0 * np.pi / count**2
    around = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(mirror, across)
    light = np.cos(ring)[:, None, None] * mirror + np.sin(ring)[:, None, None] * around
    half = light + view
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    with np.errstate(all="ignore"):
        reflected = facets(half[..., 2], alpha) * seen(view_cosine, light[..., 2], alpha) * light[..., 2]
    reflected = np.where(light[..., 2] > 0.0, reflected, 0.0) * measure[:, None]
    return np.array([(reflected * curve(np.clip(half @ view, 0.0, 1.0))).sum() for curve in CURVES])


@pytest.mark.parametrize("roughness", [0.2, 0.45, 0.7, 1.0])
@pytest.mark.parametrize("cosine", [0.05, 0.3, 0.7, 1.0])
def test_averages_over_the_lobe_are_the_brute_force_integrals(cosine: float, roughness: float) -> None:
    found = directional_averages(np.array([cosine]), roughness, CURVES)[:, 0]
    np.testing.assert_allclose(found, brute_force(cosine, roughness), atol=3e-3)  # 96² points


@pytest.mark.parametrize("roughness", [0.2, 0.45, 0.7])
@pytest.mark.parametrize("cosine", [0.1, 0.3, 0.7, 1.0])
def test_beckmanns_facets_reflect_the_brute_force_integrals(cosine: float, roughness: float) -> None:
    """To the error of the rational fit of their masking, which renderers use."""
    facets, leaving = lobe_samples(cosine, roughness, 300, Distribution.BECKMANN)
    found = [np.mean(curve(facets) * leaving) for curve in CURVES]
    expected = brute_force(cosine, roughness, 300, beckmann, beckmann_visibility)
    np.testing.assert_allclose(found, expected, atol=5e-3)


@pytest.mark.parametrize("kind", Distribution)
def test_facets_that_bend_nothing_let_through_what_their_shadows_leave(kind: Distribution) -> None:
    """Light that goes straight on leaves at the view's own angle, so it is masked as much on both sides."""
    for cosine in (0.1, 0.2, 1.0):
        facets, passed = transmitted_samples(cosine, 0.3, 1.0 + 1e-9, 200, kind)
        view = lobe_samples(cosine, 0.3, 200, kind)[0]
        np.testing.assert_array_equal(facets, view)
        hidden = 0.5 * (math.sqrt(1.0 + 0.3**4 * (1.0 / cosine**2 - 1.0)) - 1.0)
        if kind is Distribution.BECKMANN:
            hidden = float(exactly_hidden(cosine, 0.09))
        assert passed.mean() == pytest.approx((1.0 + hidden) / (1.0 + 2.0 * hidden), abs=0.01)


@pytest.mark.parametrize("roughness", [0.0, 0.01, 0.1, 0.3, 0.6, 1.0])
def test_the_lobe_never_reflects_more_than_arrives(roughness: float) -> None:
    cosines = np.linspace(1e-3, 1.0, 40)
    albedo = directional_averages(cosines, roughness, [np.ones_like])[0]
    assert (albedo <= 1.0 + 1e-12).all()
    assert (albedo > 0.0).all()


def test_rougher_lobes_lose_more_to_single_scattering_in_normal_view() -> None:
    lost = [1.0 - directional_averages(np.array([0.9]), r, [np.ones_like])[0, 0] for r in (0.0, 0.3, 0.6, 1.0)]
    assert lost == sorted(lost)
    assert lost[0] == 0.0
    assert lost[-1] > 0.2


def test_towards_roughness_0_the_lobe_becomes_the_mirror() -> None:
    cosines = np.linspace(0.2, 1.0, 9)
    mirror = directional_averages(cosines, 0.0, CURVES)
    np.testing.assert_array_equal(mirror, [curve(cosines) for curve in CURVES])
    errors = [np.abs(directional_averages(cosines, r, CURVES) - mirror).max() for r in (0.2, 0.1, 0.05, 0.01)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-3


def test_averages_are_linear_in_the_curve() -> None:
    cosines = np.array([0.1, 0.6])
    one, schlick, both = directional_averages(cosines, 0.5, [*CURVES[:2], lambda c: 3.0 - 2.0 * (1.0 - c) ** 5])
    np.testing.assert_allclose(both, 3.0 * one - 2.0 * schlick, rtol=1e-12)


def test_the_quadrature_has_converged() -> None:
    cosines = np.array([0.05, 0.7, 1.0])
    for roughness in (0.1, 0.2, 1.0):
        coarse, fine = (directional_averages(cosines, roughness, CURVES, grid) for grid in (96, 250))
        np.testing.assert_allclose(coarse, fine, atol=3e-3)


def test_the_hemispherical_average_weighs_by_the_cosine() -> None:
    cosines = 0.5 - 0.5 * np.cos(np.pi * (np.arange(48) + 0.5) / 48)
    assert hemispherical_average(cosines, np.ones(48)) == pytest.approx(1.0, abs=1e-12)
    assert hemispherical_average(cosines, cosines) == pytest.approx(2.0 / 3.0, abs=1e-3)
    assert hemispherical_average(cosines[::-1], cosines[::-1] ** 2) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("roughness", [0.1, 0.4, 0.7, 1.0])
def test_the_blur_kernel_is_the_lobe_seen_along_the_normal(roughness: float) -> None:
    """BRDF times n·l for a view along the normal, up to a constant."""
    angle = np.linspace(0.0, 1.55, 60)
    alpha, light = roughness * roughness, np.cos(angle)
    expected = distribution(np.cos(angle / 2.0), alpha) * visibility(1.0, light, alpha) * light
    found = blur_kernel(angle, roughness)
    np.testing.assert_allclose(found / found[0], expected / expected[0], rtol=1e-9, atol=1e-15)


def test_the_blur_kernel_takes_no_light_from_below_the_surface() -> None:
    np.testing.assert_array_equal(blur_kernel(np.array([np.pi / 2 + 1e-6, 2.0, np.pi]), 0.8), 0.0)
