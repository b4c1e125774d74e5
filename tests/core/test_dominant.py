"""Where rough surfaces are looked up: near the mean direction of the light that their lobe sends to the eye."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.dominant import dominant
from pcc_addon.core.effects.fresnel import METAL, MIRRORS, Facets, dielectric_facets, fresnel_dielectric
from pcc_addon.core.effects.glossy import Glossy
from pcc_addon.core.effects.lookup import MIRROR
from pcc_addon.core.effects.metal import Metal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.surface import SurfaceEffects
from pcc_addon.core.effects.transmission import Transmission
from pcc_addon.core.ggx import Distribution
from pcc_addon.core.readings import MaterialReading, SurfaceReading
from pcc_addon.core.surface_plan import plan_surfaces
from tests.core.boxes import directions

UP = np.array([0.0, 0.0, 1.0])


def seen(cosines: np.ndarray, roughness: float, *facets: Facets, metallic: float = 0.0) -> np.ndarray:
    """The angles from the normal at which views by their cosines are looked up, radians."""
    incoming = np.stack([np.sqrt(1.0 - cosines**2), 0.0 * cosines, cosines], -1)
    inputs = {"Normal": UP, "Incoming": incoming, "Roughness": roughness, "Metallic": metallic}
    direction = evaluate(dominant(facets).outputs, inputs, np.float64)["Direction"]
    np.testing.assert_allclose(np.linalg.norm(direction, axis=-1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(direction[:, 1], 0.0, atol=1e-15)
    return np.arctan2(-direction[:, 0], direction[:, 2])


def mean_angle(cosine: float, roughness: float, ior: float | None) -> float:
    """The angle of the mean direction from the normal, by summing D G F over all directions of the light."""
    alpha = roughness**2
    z = (np.arange(600) + 0.5) / 600
    turn = np.pi * (np.arange(600) + 0.5) / 600  # the other half mirrors this one
    z, turn = (a.ravel() for a in np.meshgrid(z, turn))
    sine = np.sqrt(1.0 - z * z)
    light = np.stack([-sine * np.cos(turn), sine * np.sin(turn), z], -1)
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    half = light + view
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    distribution = alpha**2 / (half[:, 2] ** 2 * (alpha**2 - 1.0) + 1.0) ** 2

    def hidden(c: np.ndarray | float) -> np.ndarray:
        return 0.5 * (np.sqrt(1.0 + alpha**2 * (1.0 / np.square(c) - 1.0)) - 1.0)

    reflected = 1.0 if ior is None else fresnel_dielectric(half @ view, ior)
    x, _, up = (distribution * reflected / (1.0 + hidden(cosine) + hidden(z))) @ light
    return float(np.arctan2(-x, up))


@pytest.mark.sweep
@pytest.mark.parametrize("roughness", [0.2, 0.3, 0.45, 0.6])
@pytest.mark.parametrize("ior", [None, 1.33, 1.5, 2.4])
def test_the_direction_is_halfway_to_the_mean_of_the_lobes_light(ior: float | None, roughness: float) -> None:
    """To 0.016 radians, a tenth of the lobe's width or less."""
    cosines = np.array([0.03, 0.08, 0.15, 0.3, 0.5, 0.75])
    found = seen(cosines, roughness, MIRRORS if ior is None else dielectric_facets(ior))
    mirrored = np.arccos(cosines)
    mean = np.array([mean_angle(cosine, roughness, ior) for cosine in cosines])
    np.testing.assert_allclose(found, mirrored + 0.5 * (mean - mirrored), atol=0.016)


def test_a_mirror_is_looked_up_along_the_mirrored_view_and_nearly_so_what_is_nearly_one() -> None:
    cosines = np.array([1e-6, 0.001, 0.05, 0.4, 1.0])
    np.testing.assert_allclose(seen(cosines, 0.0, MIRRORS), np.arccos(cosines), atol=1e-7)
    np.testing.assert_allclose(seen(cosines[1:], 0.02, MIRRORS), np.arccos(cosines[1:]), atol=1e-3)


def test_head_on_nothing_is_tilted() -> None:
    for facets in (MIRRORS, METAL, dielectric_facets(1.5)):
        assert seen(np.array([1.0]), 0.5, facets) == pytest.approx(0.0, abs=1e-7)


def test_a_ray_that_leaves_the_face_still_does() -> None:
    """Normals are bent until the mirrored view leaves the face; the dominant direction never goes below it."""
    rng = np.random.default_rng(4)
    count = 20000
    face, normal, incoming = (directions(count, rng) for _ in range(3))
    normal *= np.sign((normal * face).sum(-1, keepdims=True))
    incoming *= np.sign((incoming * normal).sum(-1, keepdims=True))
    mirrored = 2.0 * (normal * incoming).sum(-1, keepdims=True) * normal - incoming
    for facets in (MIRRORS, dielectric_facets(1.5)):
        inputs = {"Normal": normal, "Incoming": incoming, "Roughness": rng.uniform(0.0, 0.6, count)}
        found = evaluate(dominant((facets,)).outputs, inputs, np.float64)["Direction"]
        above = (mirrored * face).sum(-1) > 0.05
        assert ((found * face).sum(-1)[above] > 0.0).all()


def test_metal_over_a_dielectric_tilts_as_its_share_says() -> None:
    cosines = np.array([0.1, 0.3])
    facets = (dielectric_facets(1.5), METAL)
    for metallic, alone in ((0.0, facets[0]), (1.0, facets[1])):
        np.testing.assert_allclose(seen(cosines, 0.4, *facets, metallic=metallic), seen(cosines, 0.4, alone))
    half, bare, metal = (seen(cosines, 0.4, *facets, metallic=m) for m in (0.5, 0.0, 1.0))
    assert ((metal < half) & (half < bare)).all()


DIELECTRIC, METALLIC = Dielectric.of(1.5, 0.5), Metal()
GLASS = Transmission(1.5, whole=True)


@pytest.mark.parametrize(
    ("effects", "facets"),
    [
        ((Multiscatter(), Glossy()), (MIRRORS,)),
        ((Multiscatter(), DIELECTRIC), (dielectric_facets(1.5),)),
        ((DIELECTRIC, METALLIC), (dielectric_facets(1.5), METAL)),
        ((Metal(pure=True),), (METAL,)),
        ((GLASS,), (dielectric_facets(1.5),)),
        ((DIELECTRIC, GLASS, METALLIC), (dielectric_facets(1.5), METAL)),
    ],
)
def test_each_lobe_is_looked_up_as_its_facets_reflect(effects: tuple, facets: tuple) -> None:
    rough, smooth = SurfaceEffects(effects), SurfaceEffects(effects, smooth=True)
    assert rough.rays[0].formula is dominant(facets, Distribution.GGX) and smooth.rays[0].formula is MIRROR
    assert [ray.radiance for ray in rough.rays] == [ray.radiance for ray in smooth.rays]


@pytest.mark.parametrize(("roughness", "smooth"), [(0.0, True), (0.2, False), (None, False)])
def test_smooth_is_what_is_known_to_be(roughness: float | None, smooth: bool) -> None:
    glossy = SurfaceReading(("G",), "ShaderNodeBsdfAnisotropic", (("Color", None), ("Roughness", roughness)), "GGX")
    [plan] = plan_surfaces(MaterialReading("G", (glossy,)), 0.6)
    assert plan.effects is not None and plan.effects.smooth == smooth


def test_a_title_says_which_lobe_lies_over_which() -> None:
    below = dielectric_facets(1.5)
    assert dominant((below, METAL)).title.endswith(f" {METAL.label} over {below.label}")
    assert len({dominant(f).title for f in ((below,), (METAL,), (below, METAL), (METAL, below))}) == 4
