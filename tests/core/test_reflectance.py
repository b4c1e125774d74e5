"""How much a surface reflects: Fresnel by mpmath, integrals by quadrature, furnaces for energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mpmath
import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.fresnel import f0_from_ior, fresnel_dielectric, ior_from_f0
from pcc_addon.core.effects.glossy import Glossy
from pcc_addon.core.effects.metal import Metal, TintedMetal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.surface import SurfaceEffects, surface
from pcc_addon.core.ggx import directional_averages

COSINES = np.concatenate([[0.0, 1e-6, 0.001], np.linspace(0.02, 1.0, 29)])
WHITE = (1.0, 1.0, 1.0)
ROUGHNESSES = [0.0, 0.05, 0.2, 0.5, 1.0]


def fresnel(cosine: float, eta: float) -> float:
    """Mean of the squared amplitudes of both polarisations; beyond the critical angle the root is imaginary."""
    with mpmath.workdps(30):
        c, n = mpmath.mpf(float(cosine)), mpmath.mpf(float(eta))
        root = mpmath.sqrt(n * n - 1 + c * c)
        s = (c - root) / (c + root)
        p = (n * n * c - root) / (n * n * c + root)
        return float((abs(s) ** 2 + abs(p) ** 2) / 2)


def lobe(ior: float, level: float | None = 0.5, tinted: bool = False) -> Dielectric:
    found = Dielectric.of(ior, level, tinted)
    assert found is not None
    return found


@dataclass(frozen=True)
class Surface:
    """The effects of a surface, and its roughness."""

    effects: SurfaceEffects
    roughness: float


def light(
    case: Surface,
    cosines: np.ndarray = COSINES,
    base: tuple = WHITE,
    metallic: float = 0.0,
    level: float = 0.5,
    tint: tuple = WHITE,
    dtype: type = np.float64,
    ior: float = 1.5,
    captured: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Reflectance (n, 3) and the colour left for the diffuse part (n, 3), by the cosine of the view."""
    sine = np.sqrt(np.maximum(1.0 - cosines**2, 0.0))
    inputs = {
        "Radiance": np.ones(3),
        "Base Color": np.array(base),
        "Metallic": metallic,
        "Captured": captured,
        "Roughness": case.roughness,
        "Specular IOR Level": level,
        "IOR": ior,
        "Specular Tint": np.array(tint),
        "Normal": np.array([0.0, 0.0, 1.0]),
        "Incoming": np.stack([sine, np.zeros_like(sine), cosines], -1),
    }
    found = evaluate(surface(case.effects), inputs, dtype)
    shape = (len(cosines), 3)
    return np.broadcast_to(found["Reflection"], shape), np.broadcast_to(found["Diffuse Color"], shape)


def test_captures_see_half_of_a_metals_colour_as_a_matt_surface() -> None:
    for metallic in (0.0, 0.25, 1.0):
        lobes = (Dielectric(1.5, 1.5, None), Metal())
        for captured in (0.0, 1.0):
            _, left = light(surface_of(0.3, *lobes), base=(0.8, 0.4, 0.2), metallic=metallic, captured=captured)
            _, over_none = light(surface_of(0.3, *lobes), base=(0.8, 0.4, 0.2), captured=captured)
            matt = 0.5 * captured * metallic * np.array([0.8, 0.4, 0.2])
            np.testing.assert_allclose(left, over_none * (1.0 - metallic) + matt, rtol=1e-12)


def surface_of(roughness: float, *lobes: Dielectric | Metal, multiscatter: bool = False) -> Surface:
    return Surface(SurfaceEffects(((Multiscatter(),) if multiscatter else ()) + lobes), roughness)


def dielectric(
    roughness: float, ior: float = 1.5, level: float | None = 0.5, multiscatter: bool = False, tinted: bool = False
) -> Surface:
    return surface_of(roughness, lobe(ior, level, tinted), multiscatter=multiscatter)


def metal(roughness: float, multiscatter: bool = False, tinted: bool = False) -> Surface:
    return surface_of(roughness, Metal(tinted, pure=True), multiscatter=multiscatter)


def test_the_reflectance_at_normal_incidence_and_the_index_are_inverses() -> None:
    assert f0_from_ior(1.5) == pytest.approx(0.04)
    assert f0_from_ior(1.0) == 0.0
    for ior in (1.0, 1.1, 1.5, 2.4, 10.0):
        assert ior_from_f0(f0_from_ior(ior)) == pytest.approx(ior)
        assert f0_from_ior(1.0 / ior) == pytest.approx(f0_from_ior(ior))


@pytest.mark.parametrize("eta", [0.4, 0.75, 1.01, 1.33, 1.5, 2.4, 8.0])
def test_the_fresnel_curve_is_fresnels(eta: float) -> None:
    cosines = COSINES[1:]
    expected = [fresnel(c, eta) for c in cosines]
    np.testing.assert_allclose(fresnel_dielectric(cosines, eta), expected, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 1e-8), (np.float32, 1e-5)])
@pytest.mark.parametrize("ior", [0.5, 0.75, 1.01, 1.33, 1.5, 2.4, 8.0])
def test_a_mirror_dielectric_reflects_what_fresnel_says(ior: float, dtype: type, tolerance: float) -> None:
    """At cosine 0 too, where perturbed normals that face away from the eye end."""
    critical = np.sqrt(max(0.0, 1.0 - ior * ior))
    cosines = COSINES[np.abs(COSINES - critical) > 1e-3] if critical else COSINES  # the curve is vertical there
    reflected, left = light(dielectric(0.0, ior), cosines, dtype=dtype)
    expected = np.array([[fresnel(c, ior)] * 3 for c in cosines])
    np.testing.assert_allclose(reflected, expected, atol=tolerance)
    np.testing.assert_allclose(left, 1.0 - expected, atol=tolerance)


def lobe_integral(roughness: float, eta: float, curve: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    return directional_averages(COSINES[3:], roughness, [curve])[0]


VIEWS = np.concatenate([[0.0005, 0.002, 0.01, 0.03], np.linspace(0.06, 1.0, 24)])
SERVED = [0.02, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6]  # up to the scene's usual limit


@pytest.mark.sweep
@pytest.mark.parametrize("roughness", SERVED)
@pytest.mark.parametrize(("ior", "level"), [(1.33, 0.5), (1.5, 0.25), (1.5, 0.5), (1.5, 1.0), (2.0, 0.5), (3.5, 0.5)])
def test_a_rough_dielectric_reflects_the_fresnel_curve_averaged_over_its_lobe(
    ior: float, level: float, roughness: float
) -> None:
    """To 2 % of the reflectance from water to diamond and beyond, at all angles."""
    found = lobe(ior, level)
    reflected, left = light(dielectric(roughness, ior, level), VIEWS, level=level)
    start = f0_from_ior(found.eta)

    def curve(cosine: np.ndarray) -> np.ndarray:
        return found.f0 + (1.0 - found.f0) * (fresnel_dielectric(cosine, found.eta) - start) / (1.0 - start)

    expected = directional_averages(VIEWS, roughness, [curve], grid=160)[0]
    np.testing.assert_allclose(reflected, expected[:, None].repeat(3, 1), rtol=0.02)
    np.testing.assert_allclose(left, 1.0 - reflected, atol=1e-12)


@pytest.mark.sweep
@pytest.mark.parametrize("roughness", SERVED)
@pytest.mark.parametrize("base", [0.02, 0.1, 0.5, 1.0])
def test_a_rough_metal_reflects_schlicks_curve_averaged_over_its_lobe(base: float, roughness: float) -> None:
    reflected, _ = light(metal(roughness), VIEWS, base=(base,) * 3, metallic=1.0)
    expected = directional_averages(VIEWS, roughness, [lambda c: base + (1.0 - base) * (1.0 - c) ** 5], grid=160)[0]
    np.testing.assert_allclose(reflected, expected[:, None].repeat(3, 1), rtol=0.02)


@pytest.mark.parametrize("roughness", [0.8, 1.0])
def test_the_fits_hold_above_the_usual_limit_too(roughness: float) -> None:
    reflected, _ = light(dielectric(roughness), VIEWS)
    expected = directional_averages(VIEWS, roughness, [lambda c: fresnel_dielectric(c, 1.5)], grid=160)[0]
    np.testing.assert_allclose(reflected, expected[:, None].repeat(3, 1), rtol=0.04)


def test_roughness_has_no_step_at_the_mirror() -> None:
    for make, metallic in ((dielectric, 0.0), (metal, 1.0)):
        mirror, _ = light(make(0.0), COSINES[3:], metallic=metallic)
        nearly, _ = light(make(1e-4), COSINES[3:], metallic=metallic)
        np.testing.assert_allclose(nearly, mirror, atol=1e-5)


@pytest.mark.parametrize("multiscatter", [False, True])
@pytest.mark.parametrize("roughness", ROUGHNESSES)
@pytest.mark.parametrize("ior", [0.75, 1.01, 1.5, 4.0])
def test_a_white_dielectric_in_a_white_furnace_gives_no_more_than_it_gets(
    ior: float, roughness: float, multiscatter: bool
) -> None:
    for level, tint in ((0.5, WHITE), (1.0, WHITE), (0.5, (1.0, 0.2, 0.0)), (0.0, WHITE)):
        effects = dielectric(roughness, ior, None, multiscatter)
        reflected, left = light(effects, level=level, tint=tint)
        overshoot = 1e-9 if roughness == 0.0 else 2e-3  # of the fitted polynomials
        assert (reflected + left).max() <= 1.0 + overshoot
        assert reflected.min() >= 0.0
        assert left.min() >= 0.0


@pytest.mark.parametrize("roughness", ROUGHNESSES)
def test_a_white_metal_in_a_white_furnace_gives_all_back(roughness: float) -> None:
    reflected, left = light(metal(roughness, multiscatter=True), COSINES[3:], metallic=1.0)
    np.testing.assert_allclose(reflected, 1.0, atol=0.01)
    np.testing.assert_allclose(left, 0.0, atol=1e-12)


@pytest.mark.parametrize("roughness", [0.3, 0.6, 1.0])
def test_multiple_scattering_gives_back_what_single_scattering_loses(roughness: float) -> None:
    for make, metallic in ((metal, 1.0), (dielectric, 0.0)):
        base = (0.9, 0.5, 0.1)
        once, _ = light(make(roughness), COSINES[3:], base=base, metallic=metallic)
        often, _ = light(make(roughness, multiscatter=True), COSINES[3:], base=base, metallic=metallic)
        assert (often >= once - 1e-3).all()  # two fits, each within its own error
        assert (often - once).max() > 0.001
    once, _ = light(metal(roughness), COSINES[3:], base=(0.9, 0.5, 0.1), metallic=1.0)
    often, _ = light(metal(roughness, multiscatter=True), COSINES[3:], base=(0.9, 0.5, 0.1), metallic=1.0)
    gain = (often / once)[-1]
    assert gain[0] > gain[1] > gain[2], "each bounce takes on the metal's colour again"


def test_a_mirror_metal_starts_at_its_colour_and_ends_white() -> None:
    base = (0.9, 0.5, 0.1)
    reflected, _ = light(metal(0.0), np.array([1.0, 0.0]), base=base, metallic=1.0)
    np.testing.assert_allclose(reflected, [base, WHITE], atol=1e-12)


@pytest.mark.parametrize("roughness", [0.0, 0.3])
def test_a_glossy_surface_has_its_colour_at_every_angle(roughness: float) -> None:
    color = np.array([0.9, 0.5, 0.1])
    inputs = {"Radiance": np.ones(3), "Color": color, "Roughness": roughness, "Normal": np.array([0.0, 0.0, 1.0])}
    cosines = VIEWS
    inputs["Incoming"] = np.stack([np.sqrt(1.0 - cosines**2), 0.0 * cosines, cosines], -1)
    once, often = (
        evaluate(surface(SurfaceEffects(effects, leaves_base=False)), inputs, np.float64)
        for effects in ((Glossy(),), (Multiscatter(), Glossy()))
    )
    assert once.keys() == {"Reflection"}
    albedo = directional_averages(VIEWS, roughness, [np.ones_like], grid=160)[0] if roughness else np.ones(len(VIEWS))
    np.testing.assert_allclose(np.broadcast_to(once["Reflection"], (len(VIEWS), 3)), albedo[:, None] * color, rtol=0.01)
    assert (often["Reflection"] >= once["Reflection"] - 1e-3).all() and (often["Reflection"] <= color + 2e-3).all()


def glossy(roughness: float, color: float, multiscatter: bool) -> np.ndarray:
    """(n,) what a grey Glossy BSDF reflects, from straight above to along it."""
    cosines = np.linspace(0.0, 1.0, 401)[1:]
    inputs = {"Radiance": np.ones(3), "Base Color": np.ones(3), "Color": np.full(3, color), "Roughness": roughness}
    inputs["Normal"] = np.array([0.0, 0.0, 1.0])
    inputs["Incoming"] = np.stack([np.sqrt(1.0 - cosines**2), 0.0 * cosines, cosines], -1)
    effects = ((Multiscatter(),) if multiscatter else ()) + (Glossy(),)
    found = evaluate(surface(SurfaceEffects(effects, leaves_base=True)), inputs, np.float64)
    assert not found["Diffuse Color"].any(), "nothing lies under it"
    return found["Reflection"][:, 0]


@pytest.mark.parametrize("color", [0.2, 0.6])
def test_what_a_glossy_surface_gets_back_was_coloured_at_each_bounce_and_by_no_curve(color: float) -> None:
    """Each further bounce meets the colour and leaves by the mean albedo: a geometric series (Turquin 2019)."""
    cosines = np.linspace(0.0, 1.0, 401)[1:]
    albedo = glossy(1.0, 1.0, multiscatter=False)
    mean = (2.0 * cosines * albedo).mean()
    expected = color * color * mean / (1.0 - color * (1.0 - mean)) * (1.0 - albedo)
    gain = glossy(1.0, color, multiscatter=True) - glossy(1.0, color, multiscatter=False)
    np.testing.assert_allclose(gain[20:], expected[20:], rtol=0.02)


def test_a_metals_tint_is_its_colour_at_82_degrees_and_nowhere_else() -> None:
    """F82: at a cosine of 1/7 the tint multiplies Schlick's curve; both ends stay."""
    base, tint = (0.9, 0.5, 0.1), (0.25, 0.5, 1.0)
    cosines = np.array([1.0, 1.0 / 7.0, 0.0])
    plain, _ = light(metal(0.0), cosines, base=base, metallic=1.0)
    tinted, _ = light(metal(0.0, tinted=True), cosines, base=base, metallic=1.0, tint=tint)
    np.testing.assert_allclose(tinted / plain, [WHITE, tint, WHITE], atol=1e-9)


def test_the_metallic_bsdf_is_a_metal_that_is_tinted_by_its_edge_tint_alone() -> None:
    base, tint = np.array([0.9, 0.5, 0.1]), np.array([0.25, 0.5, 1.0])
    for tinted in (False, True):
        cosines = np.array([1.0, 1.0 / 7.0, 0.0])
        incoming = np.stack([np.sqrt(1.0 - cosines**2), 0.0 * cosines, cosines], -1)
        inputs = {"Radiance": np.ones(3), "Base Color": base, "Edge Tint": tint, "Roughness": 0.0, "Incoming": incoming}
        inputs["Normal"] = np.array([0.0, 0.0, 1.0])
        found = evaluate(surface(SurfaceEffects((TintedMetal(tinted),), leaves_base=True)), inputs, np.float64)
        plain, _ = light(metal(0.0), cosines, base=tuple(base), metallic=1.0)
        expected = plain * ([np.ones(3), tint, np.ones(3)] if tinted else 1.0)
        np.testing.assert_allclose(found["Reflection"], expected, atol=1e-9)
        assert not found["Diffuse Color"].any(), "nothing lies under it"


@pytest.mark.parametrize("roughness", [0.0, 0.3, 0.8])
def test_the_specular_tint_colours_a_dielectric_in_normal_view(roughness: float) -> None:
    face_on, grazing = np.array([1.0]), np.array([0.0])
    tint = (1.0, 0.5, 0.0)
    plain, _ = light(dielectric(roughness, tinted=True), face_on)
    tinted, _ = light(dielectric(roughness, tinted=True), face_on, tint=tint)
    black = tinted[0, 2]
    np.testing.assert_allclose((tinted[0] - black) / (plain[0] - black), tint, atol=1e-9)
    assert black < 0.02
    if roughness == 0.0:
        assert black == pytest.approx(0.0, abs=1e-12)
        reflected, _ = light(dielectric(0.0, tinted=True), grazing, tint=tint)
        np.testing.assert_allclose(reflected, 1.0, atol=1e-9)


def test_the_brightest_channel_decides_what_is_left_for_the_diffuse_part() -> None:
    base = (0.8, 0.4, 0.2)
    reflected, left = light(dielectric(0.0, tinted=True), base=base, tint=(0.2, 0.5, 1.0))
    np.testing.assert_allclose(left, np.multiply(base, 1.0 - reflected.max(-1, keepdims=True)), atol=1e-12)


@pytest.mark.parametrize("level", [0.1, 0.5, 0.8, 1.0])
def test_the_specular_level_scales_the_reflectance_in_normal_view(level: float) -> None:
    reflected, _ = light(dielectric(0.0, 1.5, level), np.array([1.0]), level=level)
    np.testing.assert_allclose(reflected, 2.0 * level * 0.04, rtol=1e-9)
    varying, _ = light(dielectric(0.0, 1.5, None), np.array([1.0]), level=level)
    np.testing.assert_allclose(varying, 2.0 * level * 0.04, rtol=1e-9)


def test_a_constant_specular_level_follows_the_fresnel_curve_of_its_own_index() -> None:
    level = 0.9
    own = ior_from_f0(f0_from_ior(1.5) * 2.0 * level)
    reflected, _ = light(dielectric(0.0, 1.5, level), COSINES, level=level)
    np.testing.assert_allclose(reflected[:, 0], [fresnel(c, own) for c in COSINES], atol=1e-9)
    assert Dielectric.of(0.8, 0.9).eta < 0.8 < 1.0 < Dielectric.of(1.25, 0.9).eta


def test_what_reflects_nothing_has_no_lobe() -> None:
    assert Dielectric.of(1.5, 0.0) is None
    assert Dielectric.of(1.0, 0.5) is None
    assert Dielectric.of(1.0, None) is None
    assert Dielectric.of(1.5, None) == Dielectric(1.5, 1.5, None)


@pytest.mark.parametrize("roughness", [0.0, 0.4])
@pytest.mark.parametrize("metallic", [0.0, 0.3, 1.0])
def test_metallic_mixes_a_dielectric_with_a_metal(metallic: float, roughness: float) -> None:
    base = (0.8, 0.4, 0.2)
    both = surface_of(roughness, lobe(1.5), Metal(), multiscatter=True)
    reflected, left = light(both, base=base, metallic=metallic)
    plastic, plastic_left = light(dielectric(roughness, multiscatter=True), base=base)
    steel, _ = light(metal(roughness, multiscatter=True), base=base, metallic=1.0)
    np.testing.assert_allclose(reflected, (1.0 - metallic) * plastic + metallic * steel, atol=1e-12)
    np.testing.assert_allclose(left, (1.0 - metallic) * plastic_left, atol=1e-12)


@pytest.mark.parametrize("roughness", [0.0, 0.4])
@pytest.mark.parametrize("metallic", [0.0, 0.3, 1.0])
def test_metallic_counts_where_the_dielectric_part_reflects_nothing(metallic: float, roughness: float) -> None:
    """Specular level 0, or an IOR of 1, under a metallic map: the unmetallic part is plain diffuse."""
    base = (0.8, 0.4, 0.2)
    reflected, left = light(metal(roughness), base=base, metallic=metallic)
    full, _ = light(metal(roughness), base=base, metallic=1.0)
    np.testing.assert_allclose(reflected, metallic * full, atol=1e-12)
    np.testing.assert_allclose(left, np.broadcast_to((1.0 - metallic) * np.array(base), left.shape), atol=1e-12)


def test_a_normal_that_faces_away_counts_as_grazing() -> None:
    for effects in (dielectric(0.0), dielectric(0.3), metal(0.0), metal(0.3)):
        away, _ = light(effects, np.array([-0.5, -1.0]), metallic=1.0)
        grazing, _ = light(effects, np.array([0.0, 0.0]), metallic=1.0)
        np.testing.assert_allclose(away, grazing)


def test_reflection_is_radiance_times_reflectance() -> None:
    effects = dielectric(0.3).effects
    inputs = {
        "Base Color": np.array(WHITE),
        "Roughness": 0.3,
        "Specular IOR Level": 0.5,
        "Specular Tint": np.array(WHITE),
        "Normal": np.array([0.0, 0.0, 1.0]),
        "Incoming": np.array([0.6, 0.0, 0.8]),
    }
    one, many = (
        evaluate(surface(effects), {**inputs, "Radiance": np.array(v)}, np.float64)
        for v in ([1.0, 1.0, 1.0], [3.0, 0.0, 500.0])
    )
    np.testing.assert_allclose(many["Reflection"], one["Reflection"] * [3.0, 0.0, 500.0])
    np.testing.assert_array_equal(many["Diffuse Color"], one["Diffuse Color"])


@pytest.mark.parametrize("ior", [1.2, 1.33, 1.5, 1.8, 2.4])
@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.3, 0.6])
def test_an_index_that_varies_reflects_what_it_would_everywhere(ior: float, roughness: float) -> None:
    """Its lobe is that of a usual index: worst at grazing angles of small ones."""
    case = surface_of(roughness, Dielectric(None, 1.5, None))
    cosines = COSINES[3:]
    found, left = light(case, cosines, ior=ior)
    curve = lambda c: fresnel_dielectric(c, ior)  # noqa: E731
    expected = lobe_integral(roughness, ior, curve) if roughness else curve(cosines)
    np.testing.assert_allclose(found[:, 0], expected, atol=0.025 if ior == 1.2 else 0.012)
    np.testing.assert_allclose(left[:, 0], 1.0 - found[:, 0], atol=1e-9)
