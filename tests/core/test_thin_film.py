"""Thin films against the spectrum: the exact sum of all paths at each wavelength, seen by the eye's three channels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.fresnel import fresnel_dielectric
from pcc_addon.core.effects.metal import Metal, TintedMetal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.surface import SurfaceEffects, surface, surface_effects
from pcc_addon.core.effects.thin_film import FILM_OVER_DIELECTRIC, FILM_OVER_METAL, METAL_INDEX, ThinFilm
from pcc_addon.core.ggx import lobe_samples
from tests.core import scenes

WAVELENGTHS = np.linspace(360.0, 830.0, 941)
TO_RGB = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.969266, 1.8760108, 0.041556], [0.0556434, -0.2040259, 1.0572252]]
)
COSINES = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0])
THICKNESSES = np.linspace(100.0, 1000.0, 19)


def channels() -> np.ndarray:
    """(3, wavelengths) sensitivities of linear Rec. 709 of area 1 (Wyman, Sloan and Shirley 2013)."""

    def bell(height: float, mean: float, below: float, above: float) -> np.ndarray:
        off = WAVELENGTHS - mean
        return height * np.exp(-0.5 * (off * np.where(off < 0.0, below, above)) ** 2)

    x = bell(0.362, 442.0, 0.0624, 0.0374) + bell(1.056, 599.8, 0.0264, 0.0323) + bell(-0.065, 501.1, 0.049, 0.0382)
    y = bell(0.821, 568.8, 0.0213, 0.0247) + bell(0.286, 530.9, 0.0613, 0.0322)
    z = bell(1.217, 437.0, 0.0845, 0.0278) + bell(0.681, 459.0, 0.0385, 0.0725)
    rgb = TO_RGB @ np.stack([x, y, z])
    return rgb / rgb.sum(1, keepdims=True)


def by_spectrum(cosine: float, thickness: float, film: float, base: np.ndarray) -> np.ndarray:
    """(3,) what the film reflects: |(r12 + r23 e^iδ) / (1 + r12 r23 e^iδ)|², the mean of both polarisations.

    Args:
        cosine: of the view.
        thickness: nm.
        film: its index.
        base: (3,) complex index of what is under it, by the channel.
    """
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / film**2 + 0j)
    below = np.sqrt(1.0 - (film / base) ** 2 * (1.0 - inside**2))
    turn = np.exp(4j * np.pi * film * thickness * inside / WAVELENGTHS)
    total = np.zeros((3, len(WAVELENGTHS)))
    for r12, r23 in (
        (
            (cosine - film * inside) / (cosine + film * inside),
            (film * inside - base * below) / (film * inside + base * below),
        ),
        (
            (film * cosine - inside) / (film * cosine + inside),
            (base * inside - film * below) / (base * inside + film * below),
        ),
    ):
        amplitude = (r12 + r23[:, None] * turn) / (1.0 + r12 * r23[:, None] * turn)
        total += 0.5 * np.abs(amplitude) ** 2
    return (total * channels()).sum(1)


@pytest.mark.parametrize("base", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("film", [1.2, 1.33, 1.6, 2.0])
def test_a_film_over_a_dielectric_reflects_what_its_spectrum_looks_like(film: float, base: float) -> None:
    inputs = {"Cosine": COSINES[:, None], "Thickness": THICKNESSES, "Film IOR": film, "Base IOR": base}
    found = evaluate(FILM_OVER_DIELECTRIC.outputs, inputs, np.float64)["Reflectance"]
    expected = np.array([[by_spectrum(c, d, film, np.full(3, base + 0j)) for d in THICKNESSES] for c in COSINES])
    assert np.ptp(expected) > 0.04
    # Grazing light is mirrored more than three times inside a bubble.
    np.testing.assert_allclose(found, np.clip(expected, 0.0, 1.0), atol=0.07 if base == 1.0 else 0.02)


@pytest.mark.parametrize("film", [1.33, 2.0])
@pytest.mark.parametrize("index", [(0.2 + 3.0j, 0.4 + 2.4j, 1.4 + 1.8j), (2.9 + 3.1j, 2.9 + 2.9j, 2.6 + 2.8j)])
def test_a_film_over_a_metal_reflects_what_its_spectrum_looks_like(index: tuple, film: float) -> None:
    """Near the normal, where F82's curve is the metal's own; gold and iron or so."""
    base = np.array(index)
    edge = np.full(3, 0.9)
    inputs = {"Cosine": np.array([[0.9], [1.0]]), "Thickness": THICKNESSES, "Film IOR": film, "Edge": edge}
    inputs |= {"Index": base.real, "Extinction": base.imag}
    found = evaluate(FILM_OVER_METAL.outputs, inputs, np.float64)["Reflectance"]
    expected = np.array([[by_spectrum(c, d, film, base) for d in THICKNESSES] for c in (0.9, 1.0)])
    assert np.ptp(expected) > 0.2
    np.testing.assert_allclose(found, np.clip(expected, 0.0, 1.0), atol=0.03)


def test_a_metals_index_reflects_its_colour_head_on() -> None:
    color = np.array([0.9, 0.5, 0.1])
    for edge in (np.zeros(3), np.full(3, 0.5), np.ones(3)):
        found = evaluate(METAL_INDEX.outputs, {"Color": color, "Edge": edge}, np.float64)
        n = found["Index"] + 1j * found["Extinction"]
        np.testing.assert_allclose(np.abs((n - 1.0) / (n + 1.0)) ** 2, color, atol=1e-12)


def reflected(
    effects: SurfaceEffects, cosines: np.ndarray, thickness: float, film: float, **inputs: object
) -> np.ndarray:
    sine = np.sqrt(1.0 - cosines**2)
    given = {
        "Radiance": np.ones(3),
        "Base Color": np.array([0.9, 0.5, 0.1]),
        "Edge Tint": np.ones(3),
        "Specular IOR Level": 0.5,
        "Specular Tint": np.ones(3),
        "Metallic": 0.0,
        "Captured": 0.0,
        "IOR": 1.5,
        "Thin Film Thickness": thickness,
        "Thin Film IOR": film,
        "Normal": np.array([0.0, 0.0, 1.0]),
        "Incoming": np.stack([sine, 0.0 * sine, cosines], -1),
        **inputs,
    }
    return evaluate(surface(effects), given, np.float64)["Reflection"]


@pytest.mark.parametrize("roughness", [0.1, 0.2, 0.4, 0.6])
@pytest.mark.parametrize("film", [1.2, 1.33, 2.0])
def test_rough_surfaces_reflect_the_mean_over_their_facets(film: float, roughness: float) -> None:
    """To 0.03 from 6° above the surface on, by every facet of the lobe."""
    effects = SurfaceEffects((ThinFilm(), Dielectric.of(1.5, 0.5)))
    for thickness in (150.0, 400.0, 900.0):
        found = reflected(effects, COSINES, thickness, film, Roughness=roughness)
        for cosine, ours in zip(COSINES, found, strict=True):
            facets, leaving = lobe_samples(cosine, roughness, 64)
            inputs = {"Cosine": facets, "Thickness": thickness, "Film IOR": film, "Base IOR": 1.5}
            curve = evaluate(FILM_OVER_DIELECTRIC.outputs, inputs, np.float64)["Reflectance"]
            np.testing.assert_allclose(ours, (curve * leaving[:, None]).mean(0), atol=0.03)


@pytest.mark.parametrize("thickness", [0.0, 1e-3])
def test_a_film_without_thickness_is_none(thickness: float) -> None:
    bare = SurfaceEffects((Dielectric.of(1.5, 0.5),))
    coated = SurfaceEffects((ThinFilm(smooth=True), *bare.effects))
    found = reflected(coated, COSINES, thickness, 2.0, Roughness=0.0)
    np.testing.assert_allclose(found, reflected(bare, COSINES, 0.0, 2.0, Roughness=0.0), atol=1e-3)
    np.testing.assert_allclose(found[:, 0], fresnel_dielectric(COSINES, 1.5), atol=1e-3)
    metal = SurfaceEffects((TintedMetal(False),), leaves_base=False)
    coated = SurfaceEffects((ThinFilm(smooth=True), *metal.effects), leaves_base=False)
    found = reflected(coated, COSINES, thickness, 2.0, Roughness=0.0)
    np.testing.assert_allclose(found, reflected(metal, COSINES, 0.0, 2.0, Roughness=0.0), atol=5e-3)


def test_a_film_that_keeps_off_metal_leaves_it_as_it_is() -> None:
    bare = SurfaceEffects((Metal(pure=True),))
    coated = SurfaceEffects((ThinFilm(on_metal=False), *bare.effects))
    found, expected = (
        reflected(effects, COSINES, 400.0, 1.6, Metallic=1.0, Roughness=0.3) for effects in (coated, bare)
    )
    np.testing.assert_array_equal(found, expected)


def test_a_film_gives_no_more_than_it_gets() -> None:
    for roughness in (0.0, 0.3, 0.6):
        effects = SurfaceEffects((Multiscatter(), ThinFilm(roughness == 0.0), Metal(pure=True)))
        for film in (1.2, 2.0):
            found = reflected(effects, COSINES, 300.0, film, Roughness=roughness, Metallic=1.0)
            assert found.min() >= 0.0 and found.max() <= 1.0 + 2e-3


def test_a_film_is_wanted_where_it_may_be_somewhere() -> None:
    def film(**inputs: object) -> list[ThinFilm]:
        found = surface_effects(scenes.surface(**inputs))
        return [e for e in found.effects if isinstance(e, ThinFilm)]

    assert film(Thin_Film_Thickness=0.0) == film(Thin_Film_Thickness=0.05) == []
    assert film(Thin_Film_Thickness=300.0) == film(Thin_Film_Thickness=None) == [ThinFilm()]
    assert film(Thin_Film_Thickness=300.0, Roughness=0.0) == [ThinFilm(smooth=True)]


def test_a_film_keeps_off_metal_where_a_renderer_shows_none_or_has_no_room() -> None:
    def on_metal(metallic: float | None, **renderer: bool) -> list[bool]:
        reading = replace(scenes.surface(Thin_Film_Thickness=300.0, Metallic=metallic), **renderer)
        return [e.on_metal for e in surface_effects(reading).effects if isinstance(e, ThinFilm)]

    for metallic in (0.0, 0.5, None, 1.0):
        assert on_metal(metallic) == [True]
        assert on_metal(metallic, films_on_both=False) == [metallic in (0.0, 1.0)]
        assert on_metal(metallic, films_on_metal=False) == ([] if metallic == 1.0 else [False])


def test_a_film_reflects_over_what_reflects_nothing() -> None:
    for inputs in ({"IOR": 1.0}, {"Specular_IOR_Level": 0.0}):
        assert surface_effects(scenes.surface(**inputs)) is None
        assert surface_effects(scenes.surface(Thin_Film_Thickness=300.0, **inputs)) is not None
