"""The six faces: their axes, that they cover the sphere once, and the lookup between their texels."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.cubemap import FACES, Face, face_directions, sample_faces

from . import boxes

OVERSCAN = 3
EACH_FACE = pytest.mark.parametrize("face", FACES, ids=lambda f: f.name)


def shoot(resolution: int, radiance: object, overscan: int = OVERSCAN) -> list[np.ndarray]:
    """Six pictures of a function of unit directions (..., 3) -> (..., channels)."""
    pictures = []
    for face in FACES:
        d = face_directions(face, resolution, overscan)
        pictures.append(radiance(d / np.linalg.norm(d, axis=-1, keepdims=True)).astype(np.float32))
    return pictures


def smooth(d: np.ndarray) -> np.ndarray:
    x, y, z = np.moveaxis(d, -1, 0)
    return np.stack([1.0 + x * y + z, np.exp(x - 0.5 * z), np.sin(2.0 * y) + z * z], -1)


def project(face: Face, d: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A Blender camera (looks along its −Z, +X right, +Y up): picture coordinates in [−1, 1] at 90°, and depth."""
    x, y, z = np.linalg.solve(face.rotation, d.reshape(-1, 3).T)
    with np.errstate(divide="ignore"):
        return x / -z, y / -z, -z


@EACH_FACE
def test_a_face_is_a_right_handed_camera_along_its_axis(face: Face) -> None:
    np.testing.assert_array_equal(face.rotation.T @ face.rotation, np.eye(3))
    assert np.linalg.det(face.rotation) == pytest.approx(1.0)
    np.testing.assert_array_equal(face.rotation @ [0.0, 0.0, -1.0], face.forward)
    sign, axis = face.name
    assert face.forward["XYZ".index(axis)] == int(sign + "1")


def test_upright_faces_have_the_worlds_up() -> None:
    for face in FACES[:4]:
        assert face.up == (0, 0, 1)


def test_the_upper_and_the_lower_face_are_the_plus_y_camera_pitched_by_a_right_angle() -> None:
    front, above, below = FACES[2], FACES[4], FACES[5]
    assert (above.forward, above.right, above.up) == (front.up, front.right, tuple(-c for c in front.forward))
    assert (below.forward, below.right, below.up) == (tuple(-c for c in front.up), front.right, front.forward)


@EACH_FACE
@pytest.mark.parametrize("overscan", [0, 2])
def test_texels_lie_where_a_camera_would_put_their_directions(face: Face, overscan: int) -> None:
    """Texel (row, column) from the lower left has its centre at (column + ½, row + ½) texels."""
    resolution = 8
    a, b, depth = project(face, face_directions(face, resolution, overscan))
    rows, columns = np.indices((resolution + 2 * overscan,) * 2) - overscan
    np.testing.assert_allclose((a + 1.0) / 2.0 * resolution - 0.5, columns.ravel(), atol=1e-12)
    np.testing.assert_allclose((b + 1.0) / 2.0 * resolution - 0.5, rows.ravel(), atol=1e-12)
    assert (depth > 0.0).all()


def test_the_faces_cover_the_sphere_exactly_once() -> None:
    d = boxes.directions(20000, np.random.default_rng(1))
    seen = np.zeros(len(d), int)
    for face in FACES:
        a, b, depth = project(face, d)
        seen += (depth > 0.0) & (np.abs(a) < 1.0) & (np.abs(b) < 1.0)
    np.testing.assert_array_equal(seen, 1)


def test_the_texels_solid_angles_sum_to_the_sphere() -> None:
    def sphere(n: int) -> float:
        lengths = np.stack([np.linalg.norm(face_directions(face, n), axis=-1) for face in FACES])
        return float((lengths**-3.0).sum() * (2.0 / n) ** 2)  # area over distance squared, times the cosine

    richardson = (4.0 * sphere(64) - sphere(32)) / 3.0  # the midpoint rule's error falls with the square
    assert richardson == pytest.approx(4.0 * np.pi, rel=1e-7)


def test_a_direction_is_looked_up_in_the_face_whose_picture_holds_it() -> None:
    d = boxes.directions(5000, np.random.default_rng(2))
    numbered = [np.full((12, 12, 1), k, np.float32) for k in range(6)]
    found = sample_faces(numbered, 2, d)[:, 0]
    for k, face in enumerate(FACES):
        a, b, depth = project(face, d)
        holds = (depth > 0.0) & (np.abs(a) < 1.0) & (np.abs(b) < 1.0)
        np.testing.assert_array_equal(found == k, holds)


def test_axes_edges_and_corners_of_the_cube_are_looked_up_too() -> None:
    d = np.array([v for v in np.ndindex(3, 3, 3) if v != (1, 1, 1)], float) - 1.0
    faces = shoot(32, smooth)
    np.testing.assert_allclose(
        sample_faces(faces, OVERSCAN, d), smooth(d / np.linalg.norm(d, axis=-1, keepdims=True)), atol=2e-3
    )


@EACH_FACE
def test_a_texel_centre_gives_that_texel(face: Face) -> None:
    rng = np.random.default_rng(3)
    faces = [rng.random((8 + 2 * OVERSCAN, 8 + 2 * OVERSCAN, 3)).astype(np.float32) for _ in FACES]
    found = sample_faces(faces, OVERSCAN, face_directions(face, 8))
    expected = faces[FACES.index(face)][OVERSCAN:-OVERSCAN, OVERSCAN:-OVERSCAN]
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_a_smooth_picture_is_reproduced_with_an_error_that_falls_fast() -> None:
    d = boxes.directions(4000, np.random.default_rng(4))
    errors = [np.sqrt(((sample_faces(shoot(n, smooth), OVERSCAN, d) - smooth(d)) ** 2).mean()) for n in (8, 16, 32)]
    assert errors[2] < 3e-4
    assert errors[0] / errors[1] > 5.0, "faster than bilinear, which gains 4"
    assert errors[1] / errors[2] > 5.0


def test_nothing_jumps_where_two_faces_meet() -> None:
    """Each side reads its own pictures' pixels beyond 90°, so only the interpolation error differs."""
    rng = np.random.default_rng(5)
    faces = shoot(64, smooth)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        edge = rng.uniform(-1.0, 1.0, (200, 3))
        edge[:, i], edge[:, j] = rng.choice([-1.0, 1.0], (2, 200))
        aside = np.zeros((200, 3))
        aside[:, i] = 1e-7 * edge[:, i]
        one, other = sample_faces(faces, OVERSCAN, edge + aside), sample_faces(faces, OVERSCAN, edge - aside)
        assert np.abs(one - other).max() < 5e-4


def test_a_value_never_leaves_the_range_of_its_four_neighbours() -> None:
    rng = np.random.default_rng(6)
    resolution, face = 16, FACES[0]
    size = resolution + 2 * OVERSCAN
    picture = (rng.random((size, size, 1)) ** 8 * 1000.0).astype(np.float32)  # fireflies on black
    a, b = rng.uniform(-1.0, 1.0, (2, 5000))
    d = face.rotation @ np.stack([a, b, -np.ones_like(a)])
    found = sample_faces([picture] * 6, OVERSCAN, d.T)[:, 0]
    column, row = ((v + 1.0) / 2.0 * resolution - 0.5 + OVERSCAN for v in (a, b))
    left, below = np.floor(column).astype(int), np.floor(row).astype(int)
    four = np.stack([picture[below + i, left + j, 0] for i in (0, 1) for j in (0, 1)])
    assert (found >= four.min(0)).all()
    assert (found <= four.max(0)).all()
    assert (found >= 0.0).all()


def test_the_length_of_a_direction_does_not_matter_and_its_shape_is_kept() -> None:
    d = boxes.directions(60, np.random.default_rng(7)).reshape(3, 4, 5, 3)
    faces = shoot(16, smooth)
    found = sample_faces(faces, OVERSCAN, d)
    assert found.shape == (3, 4, 5, 3)
    assert found.dtype == np.float32
    np.testing.assert_array_equal(sample_faces(faces, OVERSCAN, d * 1024.0), found)


def test_an_overscan_too_small_for_the_lookup_is_refused() -> None:
    with pytest.raises(ValueError, match="overscan of at least 2"):
        sample_faces([np.zeros((10, 10, 3), np.float32)] * 6, 1, np.array([1.0, 0.0, 0.0]))


def test_a_face_that_is_not_there_needs_something_given_otherwise() -> None:
    faces = [None, *[np.ones((8 + 2 * OVERSCAN, 8 + 2 * OVERSCAN, 3), np.float32)] * 5]
    d = np.array([[1.0, 0.1, 0.2], [-1.0, 0.1, 0.2]])
    with pytest.raises(ValueError, match=r"face \+X is not there"):
        sample_faces(faces, OVERSCAN, d)
    assert sample_faces(faces, OVERSCAN, d, np.full((2, 3), 7.0)).tolist() == [[7.0] * 3, [1.0] * 3]
