"""Light through glass: Snell's law, spheres, panes and rough interfaces against independent computations."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.fresnel import fresnel_dielectric
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.surface import SurfaceEffects, surface
from pcc_addon.core.effects.transmission import Interface, Transmission, seen_through
from pcc_addon.core.ggx import lobe_samples, transmitted_samples
from pcc_addon.core.readings import MaterialReading, SurfaceReading, WallReading
from pcc_addon.core.surface_plan import plan_surfaces
from tests.core.boxes import directions, unit

COSINES = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0])
INTERFACES = [Interface.ONCE, Interface.SOLID, Interface.PANE]
IORS = [1.0, 1.1, 1.33, 1.45, 1.8, 2.4]
AXES = {f"Axis {name}": row for name, row in zip("XYZ", np.eye(3), strict=True)}


def seen(interface: Interface, ior: float, count: int = 500, back: float = 0.0, **more: np.ndarray) -> tuple:
    """(views, normals, what the ray's formula says) for random surfaces; views lead to the eye."""
    rng = np.random.default_rng(1)
    views, normals = directions(count, rng), directions(count, rng)
    normals *= np.sign((views * normals).sum(-1, keepdims=True))
    formula = seen_through(interface, ior)
    given = {"Incoming": views, "Normal": normals, "Backfacing": back, **more}
    return views, normals, evaluate(formula.outputs, given, np.float64)


@pytest.mark.parametrize("ior", [1.0, 1.33, 1.5, 2.4])
def test_one_interface_bends_as_snell_says(ior: float) -> None:
    views, normals, found = seen(Interface.ONCE, ior)
    d = found["Direction"]
    np.testing.assert_allclose(np.linalg.norm(d, axis=-1), 1.0, rtol=1e-12)
    sine_in, sine_out = (np.linalg.norm(np.cross(v, normals), axis=-1) for v in (views, d))
    np.testing.assert_allclose(sine_in, ior * sine_out, atol=1e-12)
    assert ((d * normals).sum(-1) < 0.0).all(), "it goes on behind the surface"
    np.testing.assert_allclose(np.linalg.det(np.stack([views, normals, d], -1)), 0.0, atol=1e-12)  # in one plane


@pytest.mark.parametrize("ior", [1.33, 2.4])
def test_the_inner_side_bends_the_other_way_and_mirrors_all_beyond_the_critical_angle(ior: float) -> None:
    views, normals, found = seen(Interface.ONCE, ior, back=1.0)
    sine = np.linalg.norm(np.cross(views, normals), axis=-1)
    passes = sine < 1.0 / ior - 1e-9
    assert 0.05 < passes.mean() < 0.9
    out = np.linalg.norm(np.cross(found["Direction"], normals), axis=-1)
    np.testing.assert_allclose(out[passes], ior * sine[passes], atol=1e-9)
    shares = shown(Transmission(ior, Interface.ONCE, whole=True), (views * normals).sum(-1), back=1.0)
    np.testing.assert_allclose(shares[~passes], np.broadcast_to([1.0, 0.0], shares[~passes].shape), atol=1e-6)


def traced_through_an_ellipsoid(
    half: np.ndarray, axes: np.ndarray, views: np.ndarray, normals: np.ndarray, ior: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ways inside, ways out and whether there is one, by vectors and the quadratic equation; axes in rows."""
    into = snell(-views, normals, ior)[0]
    place = (half**2 * (normals @ axes.T)) / np.linalg.norm(half * (normals @ axes.T), axis=-1, keepdims=True)
    np.testing.assert_allclose(((place / half) ** 2).sum(-1), 1.0, rtol=1e-12)
    way = into @ axes.T
    a, b = ((way / half) ** 2).sum(-1), 2.0 * (place * way / half**2).sum(-1)
    length = -b / a
    far = unit(((place + way * length[:, None]) / half**2) @ axes)
    out, passes = snell(into, -far, 1.0 / ior)
    return into * length[:, None], out, passes


def snell(way: np.ndarray, normal: np.ndarray, ior: float) -> tuple[np.ndarray, np.ndarray]:
    """The bent ray by its components along and across the normal, and whether there is one."""
    along = (way * normal).sum(-1, keepdims=True)
    across = (way - along * normal) / ior
    rest = 1.0 - (across**2).sum(-1, keepdims=True)
    return across - np.sqrt(np.maximum(rest, 0.0)) * normal, rest[:, 0] > 0.0


@pytest.mark.parametrize("half", [(0.5, 0.5, 0.5), (0.3, 0.8, 1.1)])
def test_a_solid_is_seen_through_as_an_ellipsoid(half: tuple) -> None:
    axes = np.linalg.qr(np.random.default_rng(7).normal(size=(3, 3)))[0]
    given = {f"Axis {name}": row for name, row in zip("XYZ", axes, strict=True)}
    size = np.array(half)
    views, normals, found = seen(Interface.SOLID, 1.45, Dimensions=2.0 * size, **given)
    offset, out, passes = traced_through_an_ellipsoid(size, axes, views, normals, 1.45)
    np.testing.assert_allclose(found["Offset"], offset, atol=1e-9)
    np.testing.assert_allclose(found["Direction"][passes], out[passes], atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(found["Direction"], axis=-1), 1.0, rtol=1e-6)
    assert passes.all() == (half[0] == half[1]), "a ball lets all out that came in"


def test_a_solid_of_unknown_size_gives_finite_rays() -> None:
    _, _, found = seen(Interface.SOLID, 1.5, Dimensions=np.zeros(3), **AXES)
    assert all(np.isfinite(value).all() for value in found.values())


def test_a_pane_is_seen_straight_through() -> None:
    views, _, found = seen(Interface.PANE, 1.5)
    np.testing.assert_array_equal(found["Direction"], -views)


def shown(
    transmission: Transmission,
    cosines: np.ndarray = COSINES,
    roughness: float = 0.0,
    color: tuple = (1.0, 1.0, 1.0),
    keeps_energy: bool = False,
    back: float = 0.0,
    **more: object,
) -> np.ndarray:
    """(n, 2): what is seen of light along the reflected ray and of light along the ray behind, the first channel."""
    effects = SurfaceEffects((Multiscatter(),) * keeps_energy + (transmission,), leaves_base=False)
    sine = np.sqrt(1.0 - np.minimum(cosines, 1.0) ** 2)
    inputs = {
        "Color": np.array(color),
        "Base Color": np.array(color),
        "Specular Tint": np.ones(3),
        "Roughness": roughness,
        "Normal": np.array([0.0, 0.0, 1.0]),
        "Incoming": np.stack([sine, 0.0 * sine, cosines], -1),
        "Backfacing": back,
        **more,
    }
    both = []
    for lit in ((1.0, 0.0), (0.0, 1.0)):
        light = {"Radiance": np.full(3, lit[0]), "Transmitted Radiance": np.full(3, lit[1])}
        found = evaluate(surface(effects), inputs | light, np.float64)["Reflection"]
        both.append(np.broadcast_to(found, (len(cosines), 3))[:, 0])
    return np.stack(both, -1)


@pytest.mark.parametrize("ior", IORS)
@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("keeps_energy", [False, True])
def test_an_interface_shares_light_as_its_microfacets_do(ior: float, roughness: float, keeps_energy: bool) -> None:
    found = shown(Transmission(ior, Interface.ONCE, True, True), COSINES, roughness, keeps_energy=keeps_energy)
    if ior == 1.0:
        expected = np.broadcast_to([0.0, 1.0], found.shape)
    elif roughness == 0.0:
        mirrored = fresnel_dielectric(COSINES, ior)
        expected = np.stack([mirrored, 1.0 - mirrored], -1)
    else:
        expected = np.array([integrated(c, roughness, ior) for c in COSINES])
        if keeps_energy:
            expected /= expected.sum(-1, keepdims=True)
    np.testing.assert_allclose(found, expected, atol=0.023 if ior == 1.1 else 0.011)


@pytest.mark.parametrize("weight", [0.0, 0.25, 1.0])
def test_what_is_partly_glass_is_a_mixture_of_the_opaque_and_the_glass(weight: float) -> None:
    rng = np.random.default_rng(3)
    normal = np.array([0.0, 0.0, 1.0])
    incoming = directions(200, rng)
    incoming[:, 2] = np.abs(incoming[:, 2])
    inputs = {
        "Radiance": rng.random((200, 3)),
        "Transmitted Radiance": rng.random((200, 3)),
        "Base Color": rng.random((200, 3)),
        "Specular Tint": np.ones(3),
        "Specular IOR Level": 0.5,
        "Roughness": 0.2,
        "Normal": normal,
        "Incoming": incoming,
        "Transmission Weight": weight,
    }

    def sent(*effects: object) -> dict[str, np.ndarray]:
        return evaluate(surface(SurfaceEffects(effects, leaves_base=True)), inputs, np.float64)

    opaque, clear = sent(Dielectric.of(1.5, None)), sent(Transmission(1.5, whole=True))
    mixed = sent(Dielectric.of(1.5, None), Transmission(1.5))
    for name, value in mixed.items():
        np.testing.assert_allclose(value, (1.0 - weight) * opaque[name] + weight * clear[name], atol=1e-12)
    assert not clear["Diffuse Color"].any() and opaque["Diffuse Color"].any()


def integrated(cosine: float, roughness: float, ior: float) -> list[float]:
    facets, mirrored = lobe_samples(cosine, roughness, 64)
    bending, passed = transmitted_samples(cosine, roughness, ior, 64)
    share = fresnel_dielectric(bending, ior)
    return [float(np.mean(mirrored * fresnel_dielectric(facets, ior))), float(np.mean(passed * (1.0 - share)))]


def test_a_varying_index_gives_what_a_constant_one_does() -> None:
    for interface in INTERFACES:
        for principled in (True, False):
            constant = shown(Transmission(1.5, interface, True, not principled), COSINES, 0.2)
            varying = shown(Transmission(None, interface, True, not principled), COSINES, 0.2, IOR=1.5)
            np.testing.assert_allclose(varying, constant, atol=1e-9)


@pytest.mark.parametrize("colored", [True, False])
def test_the_sides_of_a_pane_add_up_as_a_series_of_mirrors(colored: bool) -> None:
    color = 0.49
    tint, mirror_tint = (color, color) if colored else (np.sqrt(color), 1.0)
    found = shown(Transmission(1.5, Interface.PANE, True, colored), COSINES, 0.0, (color,) * 3)
    f = fresnel_dielectric(COSINES, 1.5)
    reflected, through, light = mirror_tint * f, np.zeros_like(f), (1.0 - f) * tint
    for bounce in range(200):
        if bounce % 2 == 0:
            through = through + light * (1.0 - f) * tint
        else:
            reflected = reflected + light * (1.0 - f) * tint
        light = light * f * mirror_tint
    np.testing.assert_allclose(found, np.stack([reflected, through], -1), atol=2e-6)


def test_clear_things_lose_no_light_and_tints_count_each_side() -> None:
    for interface in INTERFACES:
        for roughness in (0.0, 0.3):
            whole = shown(Transmission(1.45, interface, True), COSINES, roughness, keeps_energy=True)
            np.testing.assert_allclose(whole.sum(-1), 1.0, atol=2e-3)
    for interface, power in ((Interface.ONCE, 0.5), (Interface.SOLID, 1.0)):
        clear, tinted = (shown(Transmission(1.45, interface, True), color=(c,) * 3) for c in (1.0, 0.25))
        np.testing.assert_allclose(tinted[:, 1], clear[:, 1] * 0.25**power, rtol=1e-6)
        np.testing.assert_allclose(tinted[:, 0], clear[:, 0], rtol=1e-6)


def test_a_rough_pane_spreads_less_than_a_mirror_and_more_than_one_interface() -> None:
    once, pane = (Transmission(1.45, interface).narrowing for interface in (Interface.ONCE, Interface.PANE))
    assert 0.3 < once < pane < 0.7 and Transmission(1.0, Interface.PANE).narrowing == 0.0


def glass(kind: str = "ShaderNodeBsdfPrincipled", **inputs: object) -> SurfaceReading:
    given = {"Roughness": 0.1, "IOR": 1.45, "Metallic": 0.0, "Specular IOR Level": 0.5, "Transmission Weight": 1.0}
    given |= {"Specular Tint": (1.0, 1.0, 1.0, 1.0), **{key.replace("_", " "): value for key, value in inputs.items()}}
    return SurfaceReading(("Glass",), kind, tuple(given.items()), "GGX")


@pytest.mark.parametrize("kind", ["ShaderNodeBsdfPrincipled", "ShaderNodeBsdfGlass", "ShaderNodeBsdfRefraction"])
@pytest.mark.parametrize("interface", INTERFACES)
def test_glass_of_every_kind_is_served(kind: str, interface: Interface) -> None:
    [plan] = plan_surfaces(MaterialReading("Glass", (glass(kind),)), 0.6, interface)
    assert plan.effects is not None and plan.captured_whole and interface.words in ", ".join(plan.reasons)
    rays = [ray.radiance for ray in plan.effects.rays]
    assert rays == ["Radiance", "Transmitted Radiance"][kind.endswith("Refraction") :]


def test_opaque_and_metal_parts_of_a_surface_stay_beside_what_passes() -> None:
    for weight, metallic, transmits in ((0.0, 0.0, False), (0.5, 0.0, True), (None, 0.5, True), (1.0, 1.0, False)):
        [plan] = plan_surfaces(MaterialReading("G", (glass(Transmission_Weight=weight, Metallic=metallic),)), 0.6)
        assert plan.effects is not None and plan.effects.transmits == transmits


def shell(outer: float, inner: float, cut: float = -2.0) -> np.ndarray:
    """Triangles of a ball, hollow where `inner` is above 0, without what lies below z = `cut` times its radius."""
    steps = np.linspace(0.0, np.pi, 25)
    turns = np.linspace(0.0, 2.0 * np.pi, 49)
    found = []
    for radius, sign in ((outer, 1), (inner, -1)):
        if radius == 0.0:
            continue
        t, p = np.meshgrid(steps, turns, indexing="ij")
        points = radius * np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1)
        a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
        each = np.concatenate([np.stack([a, b, c], -2), np.stack([a, c, d], -2)]).reshape(-1, 3, 3)
        found.append(each[:, ::sign])
    triangles = np.concatenate(found)
    return triangles[triangles[..., 2].mean(-1) > cut * outer]


def test_walls_are_told_by_their_thickness() -> None:
    ball, bulb, bowl = (WallReading.of("Glass", shell(*sizes)) for sizes in ((1.0, 0.0), (1.0, 0.95), (1.0, 0.0, 0.0)))
    assert ball.thinness == pytest.approx(1.0 / 3.0, rel=0.01) and not ball.is_open
    assert ball.area == pytest.approx(4.0 * np.pi, rel=0.01)
    assert bulb.thinness == pytest.approx(0.025, rel=0.1) and not bulb.is_open
    assert bowl.is_open
    moved = WallReading.of("Glass", shell(1.0, 0.95) + np.array([100.0, -50.0, 3.0]))
    assert moved.thinness == pytest.approx(bulb.thinness, rel=1e-6)
    flat = WallReading.of("Glass", np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]]], float))
    assert flat.is_open and flat.thinness == 0.0
    assert WallReading.of("Glass", np.zeros((1, 3, 3))) == WallReading("Glass", 0.0, 0.0, True)
