"""Anisotropic lobes against the integral over their visible microfacets."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.anisotropy import Anisotropy
from pcc_addon.core.effects.glossy import Glossy
from pcc_addon.core.effects.surface import Ray, SurfaceEffects, surface, surface_effects
from pcc_addon.core.ggx import reflected_samples
from tests.core import scenes
from tests.core.lobes import both_sides

UP, TANGENT = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
AZIMUTHS = np.radians([0.0, 30.0, 60.0, 90.0])


def views(cosine: float) -> np.ndarray:
    """(4, 3) directions to the eye around the normal."""
    sine = np.sqrt(1.0 - cosine * cosine)
    return np.stack([sine * np.cos(AZIMUTHS), sine * np.sin(AZIMUTHS), np.full(4, cosine)], -1)


def lobe(view: np.ndarray, along: float, across: float, grid: int = 96) -> tuple[np.ndarray, np.ndarray]:
    """Light (n, 3) that facets of GGX with these alphas mirror to the eye, and how much of it leaves (Heitz 2018)."""
    u = (np.arange(grid) + 0.5) / grid
    first, second = (part.ravel() for part in np.meshgrid(u, u, indexing="ij"))
    stretch = np.array([along, across, 1.0])
    stretched = view * stretch / np.linalg.norm(view * stretch)
    aside = np.cross(UP, stretched)
    aside = aside / np.linalg.norm(aside) if np.linalg.norm(aside) > 1e-6 else TANGENT
    radius, angle = np.sqrt(first), 2.0 * np.pi * second
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    lift = 0.5 * (1.0 + stretched[2])
    y = (1.0 - lift) * np.sqrt(1.0 - x * x) + lift * y
    height = np.sqrt(np.maximum(0.0, 1.0 - x * x - y * y))
    facet = x[:, None] * aside + y[:, None] * np.cross(stretched, aside) + height[:, None] * stretched
    facet *= stretch
    facet /= np.linalg.norm(facet, axis=-1, keepdims=True)
    light = 2.0 * (facet @ view)[:, None] * facet - view

    def hidden(d: np.ndarray) -> np.ndarray:
        sloped = (np.square(d[..., :2] * stretch[:2])).sum(-1) / np.maximum(d[..., 2], 1e-9) ** 2
        return 0.5 * (np.sqrt(1.0 + sloped) - 1.0)

    leaving = np.where(light[:, 2] > 0.0, (1.0 + hidden(view)) / (1.0 + hidden(view) + hidden(light)), 0.0)
    return light, leaving


def given(view: np.ndarray, roughness: float, **more: object) -> dict:
    return {"Normal": UP, "Incoming": view, "Tangent": TANGENT, "Roughness": roughness, **more}


def effects(wide: Anisotropy | None) -> SurfaceEffects:
    return SurfaceEffects((*([wide] if wide else []), Glossy()), leaves_base=False)


@pytest.mark.parametrize(("ratio", "error"), [(0.46, 0.04), (0.2, 0.14)])
def test_a_wide_lobe_reflects_nearly_as_a_round_one(ratio: float, error: float) -> None:
    """From 17° above the surface on, up to roughness 0.5: the wider, the less of what facets mirror leaves."""
    for roughness in (0.2, 0.35, 0.5):
        case = effects(Anisotropy(ratio))
        lit = {ray.radiance: np.ones(3) for ray in case.rays}
        for cosine in (0.3, 0.6, 0.95):
            found = evaluate(surface(case), given(views(cosine), roughness, Color=np.ones(3), **lit), np.float64)
            alphas = roughness**2 / np.sqrt(ratio), roughness**2 * np.sqrt(ratio)
            expected = [lobe(view, *alphas)[1].mean() for view in views(cosine)]
            np.testing.assert_allclose(found["Reflection"][:, 0], expected, atol=error)


def radiance(direction: np.ndarray) -> np.ndarray:
    """A room with bright spots about 30° wide, here and there."""
    spots = np.array([[0.5, 0.0, 0.85], [-0.6, 0.4, 0.7], [0.0, -0.7, 0.7], [-0.9, -0.2, 0.4]])
    spots /= np.linalg.norm(spots, axis=-1, keepdims=True)
    return 0.1 + np.exp(15.0 * (direction @ spots.T - 1.0)).sum(-1)


def level(direction: np.ndarray, roughness: float) -> float:
    """The mean of the room over the lobe that a level is blurred by."""
    around, leaving = both_sides(*reflected_samples(1.0, roughness, 64)[1:])
    aside = np.cross(direction, [0.3, -0.8, 0.5])
    aside /= np.linalg.norm(aside)
    frame = np.stack([aside, np.cross(direction, aside), direction])
    return float((radiance(around @ frame) * leaving).sum() / leaving.sum())


def shown(case: SurfaceEffects, view: np.ndarray, roughness: float) -> float:
    """What a surface shows of the room, over its reflectance."""

    def seen(ray: Ray) -> np.ndarray:
        direction = evaluate(ray.formula.outputs, given(view, roughness), np.float64)["Direction"]
        return np.full(3, level(direction, roughness * ray.narrowing))

    lit = {ray.radiance: seen(ray) for ray in case.rays}
    white = {ray.radiance: np.ones(3) for ray in case.rays}
    both = [
        evaluate(surface(case), given(view, roughness, Color=np.ones(3), **one), np.float64)["Reflection"]
        for one in (lit, white)
    ]
    return float((both[0] / both[1]).ravel()[0])


@pytest.mark.parametrize("roughness", [0.3, 0.45])
@pytest.mark.parametrize("ratio", [0.15, 0.4])
def test_looks_along_the_wide_axis_show_what_the_lobe_sees(ratio: float, roughness: float) -> None:
    """Nearer to it than a round lobe, from all sides."""
    errors = []
    for cosine in (0.4, 0.7, 0.95):
        for view in views(cosine):
            light, leaving = lobe(view, roughness**2 / np.sqrt(ratio), roughness**2 * np.sqrt(ratio))
            expected = (radiance(light) * leaving).sum() / leaving.sum()
            errors.append([shown(effects(w), view, roughness) - expected for w in (Anisotropy(ratio), None)])
    ours, as_round = np.sqrt(np.square(errors).mean(0))
    assert ours < 0.8 * as_round


@pytest.mark.parametrize(
    ("turns", "axis"), [(0.0, (1, 0, 0)), (0.25, (0, 1, 0)), (0.5, (-1, 0, 0)), (0.125, (1, 1, 0))]
)
def test_the_tangent_turns_about_the_normal(turns: float, axis: tuple) -> None:
    wide = Anisotropy(0.5, rotation="Rotation")
    slanted = {"Tangent": np.array([2.0, 0.0, 1.5]), "Normal": UP, "Rotation": turns}
    found = evaluate({"Axis": wide.wide_axis()}, slanted, np.float64)["Axis"]
    np.testing.assert_allclose(found, np.array(axis) / np.linalg.norm(axis), atol=1e-12)
    across = evaluate({"Axis": Anisotropy(0.5, True, "Rotation").wide_axis()}, slanted, np.float64)["Axis"]
    np.testing.assert_allclose(across, np.cross(UP, found), atol=1e-12)


def test_the_shares_of_the_looks_add_up() -> None:
    for ratio in (0.1, 0.3, 0.7, 0.82):
        wide = Anisotropy(ratio)
        shares = {str(k): share for k, share in enumerate(wide.shares())}
        found = evaluate(shares, given(views(0.3), 0.4), np.float64)
        np.testing.assert_allclose(sum(found.values()), 1.0, atol=1e-12)
        assert len(wide.places) == len(shares)


def test_anisotropy_is_wanted_where_it_is_seen() -> None:
    def wide(**inputs: object) -> Anisotropy | None:
        return surface_effects(scenes.surface(**inputs)).anisotropy

    assert wide(Anisotropic=0.5) == Anisotropy(pytest.approx(0.55))
    assert wide(Anisotropic=0.2) is wide(Anisotropic=-0.5) is wide(Anisotropic=0.5, Roughness=0.0) is None
    assert wide(Anisotropic=0.5, Transmission_Weight=1.0) is None, "glass is drawn with round lobes"
    assert wide(Anisotropic=0.5, Transmission_Weight=0.5) is not None
    assert wide(Anisotropic=0.5, Anisotropic_Rotation=None).rotation == "Anisotropic Rotation"
    assert wide(Anisotropic=0.5, Anisotropic_Rotation=0.0).rotation == ""
