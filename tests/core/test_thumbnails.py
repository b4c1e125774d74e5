"""Small pictures of a bake: where each direction is in them, and that nothing is mirrored, lost or cut off."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core import equirect
from pcc_addon.core.cubemap import FACE_NAMES, FACES
from pcc_addon.core.thumbnails import chrome_ball, reduced, unfolded

SIZE = 33
CELLS = {"+Z": (2, 1), "-X": (1, 0), "+Y": (1, 1), "+X": (1, 2), "-Y": (1, 3), "-Z": (0, 1)}  # row, column from below


def lamp(direction: tuple[float, float, float], height: int = 128) -> np.ndarray:
    """A grey surrounding with a spot of light in one direction."""
    seen = equirect.directions(2 * height, height) @ (np.array(direction) / np.linalg.norm(direction))
    return np.repeat(np.where(seen > np.cos(0.12), 20.0, 0.05)[..., None], 3, -1).astype(np.float32)


def brightest(image: np.ndarray) -> np.ndarray:
    """(row, column) of the middle of what is bright, in shares of the picture, from the bottom left."""
    light = image[..., 0] * image[..., 3]
    found = np.argwhere(light > 0.8 * light.max())
    return (found.mean(0) + 0.5) / light.shape


@pytest.mark.parametrize(
    ("direction", "row", "column"),
    [
        ((0, -1, 0), 0.5, 0.5),  # who looks sees what is behind him in the middle
        ((1, 0, 0), 0.5, 0.5 + 0.5**1.5),  # the normal is half-way, at 45°
        ((-1, 0, 0), 0.5, 0.5 - 0.5**1.5),
        ((0, 0, 1), 0.5 + 0.5**1.5, 0.5),
        ((0, 0, -1), 0.5 - 0.5**1.5, 0.5),
    ],
)
def test_a_ball_mirrors_as_chrome_does(direction, row: float, column: float) -> None:
    assert brightest(chrome_ball(lamp(direction), 65)) == pytest.approx([row, column], abs=0.02)


def test_what_is_behind_a_ball_is_at_its_rim() -> None:
    ball = chrome_ball(lamp((0, 1, 0)), 65)
    light = ball[..., 0] * ball[..., 3]
    rows, columns = np.nonzero(light > 0.8 * light.max())
    distance = np.hypot(rows - 32.0, columns - 32.0) / 32.5
    assert len(distance) > 20 and distance.min() > 0.9


def test_a_ball_is_round_and_clear_around() -> None:
    opacity = chrome_ball(lamp((1, 0, 0)), SIZE)[..., 3]
    assert opacity.sum() / opacity.size == pytest.approx(np.pi / 4.0, abs=0.01)
    assert opacity[0, 0] == 0.0 and opacity[SIZE // 2, SIZE // 2] == 1.0
    assert ((opacity > 0.0) & (opacity < 1.0)).any(), "its rim has no steps"


@pytest.mark.parametrize("face", FACES, ids=lambda face: face.name)
def test_each_face_of_the_cross_has_its_own_directions_the_right_way_round(face) -> None:
    place = CELLS[face.name]
    for a, b in ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (-0.5, -0.5)):
        direction = np.array(face.forward) + a * np.array(face.right) + b * np.array(face.up)
        row, column = brightest(unfolded(lamp(tuple(direction)), SIZE))
        assert (3.0 * row, 4.0 * column) == pytest.approx(
            (place[0] + (b + 1.0) / 2.0, place[1] + (a + 1.0) / 2.0), abs=0.05
        )


@pytest.mark.parametrize(
    ("left_below", "right_above", "beside"),
    [("-X", "+Y", True), ("+Y", "+X", True), ("+X", "-Y", True), ("+Y", "+Z", False), ("-Z", "+Y", False)],
)
def test_neighbours_in_the_cross_meet_at_their_edges(left_below: str, right_above: str, beside: bool) -> None:
    cross, n = unfolded(equirect.directions(256, 128).astype(np.float32) + 1.5, SIZE), SIZE
    cells = [CELLS[left_below], CELLS[right_above]]
    first, second = (cross[row * n : (row + 1) * n, column * n : (column + 1) * n, :3] for row, column in cells)
    edges = (first[:, -1], second[:, 0]) if beside else (first[-1], second[0])
    np.testing.assert_allclose(*edges, atol=0.03)


def test_what_was_not_captured_is_faint_and_around_the_cross_is_nothing() -> None:
    opacity = unfolded(lamp((1, 0, 0)), 4, [name for name in FACE_NAMES if name != "-Z"])[..., 3]
    assert (opacity[:4, 4:8] < 0.5).all() and (opacity[:4, 4:8] > 0.0).all()
    assert (opacity[4:, 4:8] == 1.0).all() and (opacity[4:8] == 1.0).all()
    assert (opacity[:4, :4] == 0.0).all() and (opacity[8:, 8:] == 0.0).all()


@pytest.mark.parametrize(("rows", "height"), [(96, 32), (90, 32), (33, 32), (128, 128), (16, 32)])
def test_a_reduced_picture_keeps_the_light_of_the_whole(rows: int, height: int) -> None:
    picture = np.random.default_rng(rows).random((rows, 2 * rows, 3)).astype(np.float32)
    small = reduced(picture, height)
    assert small.shape == (min(rows, height), 2 * min(rows, height), 3)
    light = [
        (p * equirect.solid_angles(p.shape[1], p.shape[0])[:, None, None]).sum((0, 1)) / (4.0 * np.pi)
        for p in (picture, small)
    ]
    np.testing.assert_allclose(*light, rtol=0.02 if rows % height else 1e-5)


@pytest.mark.parametrize("factor", [1e-4, 1.0, 1e4])
def test_how_bright_a_scene_is_does_not_matter(factor: float) -> None:
    scene = equirect.directions(64, 32).astype(np.float32) + 1.5
    seen = unfolded(scene * np.float32(factor), 8)
    np.testing.assert_allclose(seen, unfolded(scene, 8), atol=1e-4)
    shown = seen[..., :3][seen[..., 3] > 0.0]
    assert 0.3 < shown.mean() < 0.6 and shown.max() <= 1.0


def test_black_stays_black() -> None:
    black = np.zeros((8, 16, 3), np.float32)
    assert (chrome_ball(black, 8)[..., :3] == 0.0).all() and (unfolded(black, 8)[..., :3] == 0.0).all()


def test_an_even_surrounding_is_an_even_ball_to_its_very_rim() -> None:
    ball = chrome_ball(np.full((8, 16, 3), 0.7, np.float32), SIZE)
    shown = ball[ball[..., 3] > 0.0][:, :3]
    np.testing.assert_allclose(shown, shown[0, 0], atol=1e-6)


def test_what_is_four_times_a_white_wall_is_white_and_what_is_less_is_not() -> None:
    """In a scene whose mean is middle grey."""
    scene = np.full((64, 128, 3), 0.18, np.float32)
    scene[30:34, :8], scene[30:34, 64:72] = 4.4, 3.2
    cross = unfolded(scene, 64)
    middle, behind = cross[64:128, 64 * 2 : 64 * 3, 0], cross[64:128, :, 0]
    assert behind.max() == 1.0 and 0.9 < middle.max() < 0.995
