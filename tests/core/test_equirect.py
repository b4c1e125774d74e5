"""The equirectangular picture: directions, solid angles, orientation, lookup."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACES, face_directions

from . import boxes


@pytest.mark.parametrize(("width", "height"), [(8, 4), (64, 32), (33, 17)])
def test_coordinates_and_directions_are_inverses(width: int, height: int) -> None:
    d = equirect.directions(width, height)
    np.testing.assert_allclose(np.linalg.norm(d, axis=-1), 1.0)
    u, v = equirect.coordinates(d * 7.0)
    rows, columns = np.indices((height, width))
    np.testing.assert_allclose(u * width - 0.5, columns, atol=1e-9)
    np.testing.assert_allclose(v * height - 0.5, rows, atol=1e-9)


def test_a_part_of_the_rows_is_that_part() -> None:
    np.testing.assert_array_equal(equirect.directions(16, 8, slice(3, 6)), equirect.directions(16, 8)[3:6])


@pytest.mark.parametrize(
    ("vector", "u", "v"),
    [
        ((1, 0, 0), 0.5, 0.5),
        ((0, 1, 0), 0.25, 0.5),
        ((0, -1, 0), 0.75, 0.5),
        ((1, 1, 0), 0.375, 0.5),
        ((1, 0, 1), 0.5, 0.75),
        ((1, 0, -1), 0.5, 0.25),
    ],
)
def test_the_picture_is_oriented_as_cycles_reads_it(vector: tuple, u: float, v: float) -> None:
    assert equirect.coordinates(np.array(vector)) == (pytest.approx(u), pytest.approx(v))


def test_the_seam_lies_at_minus_x_and_the_poles_at_the_first_and_last_row() -> None:
    (first, last), _ = equirect.coordinates(np.array([[-1.0, 1e-9, 0.0], [-1.0, -1e-9, 0.0]]))
    assert (first, last) == (pytest.approx(0.0, abs=1e-9), pytest.approx(1.0, abs=1e-9))
    _, (bottom, top) = equirect.coordinates(np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))
    assert (bottom, top) == (0.0, 1.0)


@pytest.mark.parametrize("height", [1, 7, 512])
def test_solid_angles_sum_to_the_sphere(height: int) -> None:
    width = 2 * height
    assert (equirect.solid_angles(width, height) * width).sum() == pytest.approx(4.0 * np.pi, rel=1e-12)


def test_a_rows_solid_angle_is_the_share_of_directions_that_fall_into_it() -> None:
    d = boxes.directions(200_000, np.random.default_rng(1))
    _, v = equirect.coordinates(d)
    share = np.bincount((v * 8).astype(int), minlength=8) / len(d)
    expected = equirect.solid_angles(16, 8) * 16 / (4.0 * np.pi)
    np.testing.assert_allclose(share, expected, atol=5.0 * np.sqrt(0.25 / len(d)))  # five standard deviations


def test_a_texel_centre_gives_that_texel() -> None:
    picture = np.random.default_rng(2).random((8, 16, 3))
    np.testing.assert_allclose(equirect.lookup(picture, equirect.directions(16, 8)), picture, atol=1e-9)


def test_half_way_between_two_texels_is_their_mean_across_the_seam_too() -> None:
    picture = np.random.default_rng(3).random((8, 16, 1))
    halfway = np.pi - 2.0 * np.pi * np.arange(16) / 16  # between columns k − 1 and k
    elevation = np.pi * (3.5 / 8 - 0.5)
    d = np.stack([np.cos(elevation) * np.cos(halfway), np.cos(elevation) * np.sin(halfway)], -1)
    d = np.concatenate([d, np.full((16, 1), np.sin(elevation))], -1)
    expected = 0.5 * (picture[3] + np.roll(picture[3], 1, axis=0))
    np.testing.assert_allclose(equirect.lookup(picture, d), expected, atol=1e-9)


def test_the_lookup_is_continuous_around_the_seam() -> None:
    picture = np.random.default_rng(4).random((8, 16, 3))
    z = np.linspace(-2.0, 2.0, 40)
    one, other = (np.stack([-np.ones(40), np.full(40, y), z], -1) for y in (1e-9, -1e-9))
    np.testing.assert_allclose(equirect.lookup(picture, one), equirect.lookup(picture, other), atol=1e-6)


def test_poles_read_the_outermost_rows() -> None:
    rows = np.broadcast_to(np.arange(8.0)[:, None, None], (8, 16, 1))
    found = equirect.lookup(rows, np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))[:, 0]
    np.testing.assert_allclose(found, [0.0, 7.0], atol=1e-12)


def test_faces_become_the_picture_of_the_same_world() -> None:
    """An asymmetric world proves orientation: the colour is the direction itself."""
    faces = [face_directions(face, 32, 2) for face in FACES]
    faces = [(d / np.linalg.norm(d, axis=-1, keepdims=True)).astype(np.float32) for d in faces]
    picture = equirect.from_faces(faces, 2, rows_at_once=10)
    assert picture.shape == (64, 128, 3)
    error = np.abs(picture - equirect.directions(128, 64))
    assert error.mean() < 2e-5
    assert error.max() < 1e-3, "each peaks at a face's centre, between four texels whose range no value leaves"
    d = boxes.directions(500, np.random.default_rng(5))
    np.testing.assert_allclose(equirect.lookup(picture, d), d, atol=2e-3)


def world_faces(n: int = 32, overscan: int = 4) -> list[np.ndarray]:
    """The colour is the direction itself, plus 2, so that nothing is black."""
    faces = [face_directions(face, n, overscan) for face in FACES]
    return [(d / np.linalg.norm(d, axis=-1, keepdims=True) + 2.0).astype(np.float32) for d in faces]


@pytest.mark.parametrize("missing", [{5}, {0}, {1, 2, 4}, {0, 1, 2, 3, 4}])
def test_where_faces_are_missing_the_picture_has_a_guess_and_is_the_same_elsewhere(
    missing: set[int],
) -> None:
    faces = world_faces()
    whole = equirect.from_faces(faces, 4)
    picture = equirect.from_faces([None if k in missing else face for k, face in enumerate(faces)], 4, rows_at_once=10)
    d = equirect.directions(128, 64)
    axis = np.abs(d).argmax(-1)
    index = 2 * axis + (np.take_along_axis(d, axis[..., None], -1)[..., 0] < 0.0)
    there = ~np.isin(index, list(missing))
    assert 0 < there.sum() < there.size
    assert np.array_equal(picture[there], whole[there])
    for k in missing:
        [guess] = np.unique(picture[index == k], axis=0)
        if len(missing) == 1:  # from its edges, 45 degrees off its axis, and corners, 55, to 4 of 32 texels within
            assert guess == pytest.approx(2.0 + 0.69 * np.array(FACES[k].forward), abs=0.01)
    rest = [face if k in missing else None for k, face in enumerate(faces)]
    assert np.array_equal(equirect.from_faces(rest, 4, rows_at_once=10, before=picture), whole)


def test_a_picture_has_a_face_at_least() -> None:
    with pytest.raises(ValueError, match="at least one face"):
        equirect.from_faces([None] * 6, 4)
