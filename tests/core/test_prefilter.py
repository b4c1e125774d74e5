"""Levels: what a blur of the sphere must keep, and how wide it must be."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core import equirect
from pcc_addon.core.prefilter import MINIMUM_HEIGHT, level_height, prefilter, shrink

from . import boxes
from .lobes import lobe, quadrature

ROUGHNESSES = [0.02, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0]


def energy(picture: np.ndarray) -> np.ndarray:
    height, width = picture.shape[:2]
    return np.einsum("rcx,r->x", picture.astype(np.float64), equirect.solid_angles(width, height))


def one_lit(height: int, row: int, column: int) -> tuple[np.ndarray, np.ndarray]:
    picture = np.zeros((height, 2 * height, 1))
    picture[row, column] = 1.0
    return picture, equirect.directions(2 * height, height)[row, column]


def mean_cosine(roughness: float) -> float:
    """Of light and mirror direction, seen along the normal: ∫ D cosθₕ G₁ cos 2θₕ over microfacet normals.

    With u uniform in 0 … 1, tan²θₕ = α² u / (1 − u) is distributed as D cosθₕ, and θ = 2θₕ; the density of light
    is then D/4 and needs the light's masking only.
    """
    u = (np.arange(200_000) + 0.5) / 200_000
    alpha = roughness * roughness
    angle = 2.0 * np.arctan(alpha * np.sqrt(u / (1.0 - u)))
    angle = angle[angle < np.pi / 2]
    masking = 2.0 / (1.0 + np.sqrt(1.0 + (alpha * np.tan(angle)) ** 2))
    return float((masking * np.cos(angle)).sum() / masking.sum())


@pytest.mark.parametrize("roughness", [0.01, 0.04, 0.08, *np.linspace(0.1, 1.0, 10)])
@pytest.mark.parametrize("height", [1, 2, 3, 7, 33, 64, 96, 256])
def test_a_constant_stays_constant(height: int, roughness: float) -> None:
    picture = np.full((height, 2 * height, 3), [0.25, 1.0, 60000.0])
    level = prefilter(picture, roughness)
    np.testing.assert_allclose(level, np.broadcast_to(picture[0, 0], level.shape), rtol=1e-6)


@pytest.mark.parametrize("roughness", ROUGHNESSES)
@pytest.mark.parametrize("height", [3, 33, 64, 256])
def test_a_picture_keeps_its_energy(height: int, roughness: float) -> None:
    picture = np.random.default_rng(1).random((height, 2 * height, 3)) ** 8
    np.testing.assert_allclose(energy(prefilter(picture, roughness)), energy(picture), rtol=1e-6)


@pytest.mark.parametrize("roughness", [0.01, 0.05, 0.1, 0.2, 0.5, 1.0])
@pytest.mark.parametrize("height", [8, 33])
def test_one_lit_texel_keeps_its_energy_in_every_row(height: int, roughness: float) -> None:
    """A sun may shine anywhere, at the poles too, where a texel is a sliver."""
    lit = [one_lit(height, row, 5)[0] for row in range(height)]
    level = prefilter(np.concatenate(lit, axis=-1), roughness)
    np.testing.assert_allclose(energy(level), energy(np.concatenate(lit, axis=-1)), rtol=1e-6)


@pytest.mark.parametrize("roughness", [0.05, 0.1, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("column", [0, 45, 127])
@pytest.mark.parametrize("row", [0, 1, 20, 32, 63])
def test_one_lit_texel_spreads_alike_to_the_left_and_to_the_right(row: int, column: int, roughness: float) -> None:
    level = prefilter(one_lit(64, row, column)[0], roughness)
    steps = np.arange(64)
    left, right = level[:, (column - steps) % 128], level[:, (column + steps) % 128]
    np.testing.assert_allclose(left, right, atol=1e-7 * level.max())


def spread(height: int, row: int, column: int, roughness: float) -> np.ndarray:
    """(height, 2·height) float64: one lit texel as the lobe on the sphere sees it, by quadrature over that texel."""
    _, weights = quadrature(roughness)
    inside = (np.arange(8) + 0.5) / 8
    elevation = np.pi * ((row + inside) / height - 0.5)
    azimuth = np.pi * (1.0 - (column + inside) / height)
    towards = equirect.directions(2 * height, height)
    result = np.zeros(towards.shape[:2])
    for e in elevation:
        for a in azimuth:
            light = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
            angle = np.arccos(np.clip(towards @ light, -1.0, 1.0))
            result += np.cos(e) * (np.pi / height / 8) ** 2 * lobe(angle, roughness)
    return result / (2.0 * np.pi * weights.sum())


@pytest.mark.parametrize(
    ("row", "column", "bound"),
    [(0, 77, 0.06), (1, 0, 0.03), (5, 127, 0.015), (13, 45, 0.01), (32, 0, 0.001), (58, 127, 0.015), (63, 0, 0.06)],
)
@pytest.mark.parametrize("roughness", [0.3, 0.5, 1.0])
def test_one_lit_texel_spreads_as_the_lobe_on_the_sphere(roughness: float, row: int, column: int, bound: float) -> None:
    """Everywhere within `bound` of the brightest texel; the lobe of 0.3 is eight texels wide here, as in any level.

    The bound grows towards the poles: the kernel is averaged over a square texel, and there they are slivers.
    """
    level = prefilter(one_lit(64, row, column)[0], roughness)[..., 0]
    expected = spread(64, row, column, roughness)
    assert np.abs(level - expected).max() < bound * expected.max()


@pytest.mark.parametrize("roughness", [0.08, 0.1, 0.15, 0.2])
def test_a_lobe_narrower_than_a_texel_is_averaged_over_it(roughness: float) -> None:
    """Taken at texel centres alone, it would leave nearly all light in the texel where it was."""
    level = prefilter(one_lit(64, 32, 7)[0], roughness)[..., 0]
    expected = spread(64, 32, 7, roughness)
    assert np.abs(level - expected).max() < 0.01 * expected.max()


@pytest.mark.parametrize("roughness", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("row", [32, 50, 13, 61])
def test_light_spreads_alike_in_all_directions(row: int, roughness: float) -> None:
    """Texels at equal angles from the lit one are equal: at the equator, at mid latitudes and near a pole."""
    picture, towards = one_lit(64, row, 77)
    level = prefilter(picture, roughness)[..., 0].astype(np.float64).ravel()
    angle = np.arccos(np.clip(equirect.directions(128, 64) @ towards, -1.0, 1.0)).ravel()
    order = np.argsort(angle)
    equal = np.diff(angle[order]) < 5e-4  # radians; a texel is 0.05 high
    assert equal.sum() > 5000
    assert np.abs(np.diff(level[order]))[equal].max() < 0.02 * level.max()


@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.7])
@pytest.mark.parametrize("row", [32, 50, 13, 61])
def test_light_stays_about_its_direction(row: int, roughness: float) -> None:
    picture, towards = one_lit(64, row, 77)
    level = prefilter(picture, roughness)
    mean = energy(level * equirect.directions(level.shape[1], level.shape[0]))
    assert mean @ towards / np.linalg.norm(mean) > np.cos(np.radians(0.2))


@pytest.mark.parametrize("roughness", [0.2, 0.4, 0.6, 0.8, 1.0])
def test_a_world_that_is_linear_in_the_direction_shrinks_by_the_kernels_mean_cosine(roughness: float) -> None:
    """Funk and Hecke: any blur that depends on the angle only multiplies x, y and z by its mean cosine."""
    world = equirect.directions(128, 64) + 2.0  # radiance is not negative
    level = prefilter(world, roughness) - 2.0
    height = level.shape[0]
    expected = mean_cosine(roughness) * equirect.directions(2 * height, height)
    np.testing.assert_allclose(level, expected, atol=3e-3)


@pytest.mark.parametrize("roughness", [0.2, 0.3, 0.5, 0.7, 1.0])
def test_the_mean_cosine_of_the_spread_is_the_lobes(roughness: float) -> None:
    picture, towards = one_lit(64, 32, 3)
    level = prefilter(picture, roughness)
    found = energy(level * (equirect.directions(128, 64) @ towards)[..., None]) / energy(level)
    assert 1.0 - found == pytest.approx(1.0 - mean_cosine(roughness), rel=0.03, abs=5e-4)


def test_rougher_is_wider() -> None:
    picture, towards = one_lit(64, 32, 3)
    cosine = (equirect.directions(128, 64) @ towards)[..., None]
    means = [energy(level * cosine) / energy(level) for level in (prefilter(picture, r) for r in ROUGHNESSES)]
    assert (np.diff(means, axis=0) < 0.0).all()


@pytest.mark.parametrize("columns", [1, 40, -3])
@pytest.mark.parametrize("roughness", [0.1, 0.6])
def test_turning_the_world_by_texels_turns_the_level(columns: int, roughness: float) -> None:
    picture = np.random.default_rng(2).random((64, 128, 3))
    turned = prefilter(np.roll(picture, columns, axis=1), roughness)
    np.testing.assert_array_max_ulp(turned, np.roll(prefilter(picture, roughness), columns, axis=1))


@pytest.mark.parametrize("roughness", [0.1, 0.6])
def test_mirroring_the_world_mirrors_the_level(roughness: float) -> None:
    picture = np.random.default_rng(3).random((128, 256, 1))
    for axis in (0, 1):
        flipped = prefilter(np.flip(picture, axis), roughness)
        np.testing.assert_array_max_ulp(flipped, np.flip(prefilter(picture, roughness), axis))


def test_roughness_0_is_the_picture_itself() -> None:
    picture = np.random.default_rng(4).random((16, 32, 3)).astype(np.float32)
    np.testing.assert_array_equal(prefilter(picture, 0.0), picture)


@pytest.mark.parametrize("roughness", [0.02, 0.3])
def test_levels_are_float32_and_never_negative(roughness: float) -> None:
    picture, _ = one_lit(64, 20, 3)
    level = prefilter(picture * 60000.0, roughness)
    assert level.dtype == np.float32
    assert (level >= 0.0).all()


def test_channels_do_not_mix() -> None:
    picture = np.random.default_rng(5).random((32, 64, 3))
    level = prefilter(picture, 0.4)
    for k in range(3):
        np.testing.assert_allclose(level[..., k], prefilter(picture[..., k : k + 1], 0.4)[..., 0], rtol=1e-6)


@pytest.mark.parametrize("source", [16, 64, 96, 512, 1024, 2048])
def test_a_level_is_the_source_halved_whole_times_and_never_too_small(source: int) -> None:
    heights = [level_height(source, r) for r in np.linspace(0.0, 1.0, 41)]
    assert heights[0] == source
    assert heights == sorted(heights, reverse=True), "a rougher level never needs more"
    for height in heights:
        assert source % height == 0
        assert (source // height).bit_count() == 1
        assert height >= min(source, MINIMUM_HEIGHT)
    assert level_height(2048, 1.0) == MINIMUM_HEIGHT


def test_a_smaller_level_is_the_larger_one_with_fewer_texels() -> None:
    """A source four times as fine gives the same level: the reduction loses nothing that the blur keeps."""
    coarse = np.random.default_rng(6).random((128, 256, 1))
    fine = coarse.repeat(4, axis=0).repeat(4, axis=1)
    assert level_height(512, 0.6) == 128
    np.testing.assert_allclose(prefilter(fine, 0.6), prefilter(coarse, 0.6), atol=1e-5)


def test_shrinking_keeps_energy_constants_and_place() -> None:
    picture = np.random.default_rng(7).random((48, 96, 2))
    small = shrink(picture, 12)
    np.testing.assert_allclose(energy(small), energy(picture), rtol=1e-12)
    np.testing.assert_allclose(shrink(np.full((48, 96, 1), 0.7), 12), 0.7)
    dot, _ = one_lit(48, 21, 50)
    assert np.argwhere(shrink(dot, 12)).tolist() == [[5, 12, 0]]


def test_a_picture_that_cannot_be_divided_is_refused() -> None:
    with pytest.raises(ValueError, match="48 rows to 32"):
        shrink(np.zeros((48, 96, 1)), 32)


def test_progress_grows_and_may_stop_the_work() -> None:
    told: list[float] = []
    picture = boxes.directions(64 * 128, np.random.default_rng(8)).reshape(64, 128, 3)
    prefilter(picture, 0.3, told.append)
    assert len(told) >= 2
    assert told == sorted(set(told))
    assert all(0.0 <= fraction <= 1.0 for fraction in told)

    class Enough(Exception):
        pass

    def stop(fraction: float) -> None:
        told.append(fraction)
        raise Enough

    told.clear()
    with pytest.raises(Enough):
        prefilter(picture, 0.3, stop)
    assert len(told) == 1
