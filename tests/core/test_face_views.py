"""Which boxes a face may show: never one too few, and not simply all."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.cubemap import FACE_NAMES, FACES
from pcc_addon.core.face_views import may_show


def box(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    return np.array([[(low, high)[bit][axis] for axis, bit in enumerate(bits)] for bits in np.ndindex(2, 2, 2)])


def seen(corners: np.ndarray, place: tuple[float, ...] = (0.0, 0.0, 0.0), resolution: int = 256) -> tuple[str, ...]:
    [met] = may_show(corners[None], place, resolution, 8)
    return tuple(name for name, is_met in zip(FACE_NAMES, met, strict=True) if is_met)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([16, 64, 1024]),
    st.integers(2, 16),
    st.sampled_from([0.0, 100.0, 1e4]),
)
def test_whatever_a_face_shows_of_a_box_its_overscan_included_counts(
    seed: int, resolution: int, overscan: int, far: float
) -> None:
    random = np.random.default_rng(seed)
    place = random.normal(size=3) * far
    spread = random.normal(size=(3, 3)) * 10.0 ** random.uniform(-2.0, 1.0, (3, 1))
    corners = place + random.normal(size=3) * 3.0 + box((-1.0,) * 3, (1.0,) * 3) @ spread
    shares = random.dirichlet(np.full(8, 0.2), 400)
    towards = np.concatenate([corners, shares @ corners]) - place
    edge = 1.0 + 2.0 * overscan / resolution
    [met] = may_show(corners[None], place, resolution, overscan)
    for face, is_met in zip(FACES, met, strict=True):
        depth, a, b = (towards @ np.array(axis, np.float64) for axis in (face.forward, face.right, face.up))
        inside = (depth > 0.0) & (np.abs(a) <= edge * depth) & (np.abs(b) <= edge * depth)
        assert is_met or not inside.any()


@pytest.mark.parametrize("face", FACES, ids=lambda face: face.name)
def test_a_small_box_counts_in_the_face_before_which_it_is(face) -> None:
    for distance in (0.1, 1.0, 1000.0):
        centre = np.array(face.forward) * distance
        half = 0.3 * distance
        assert seen(box(tuple(centre - half), tuple(centre + half))) == (face.name,)
        far = (100.0, 50.0, -20.0)
        assert seen(box(tuple(centre + far - half), tuple(centre + far + half)), far) == (face.name,)


def test_a_box_counts_on_both_sides_of_an_edge_and_in_the_overscan() -> None:
    assert seen(box((1.0, 0.9, -0.1), (1.1, 1.2, 0.1))) == ("+X", "+Y")
    assert seen(box((1.0, 0.9, -0.1), (1.1, 0.98, 0.1))) == ("+X", "+Y"), "eight texels of 128 are 6 %"
    assert seen(box((1.0, 0.7, -0.1), (1.1, 0.9, 0.1))) == ("+X",)
    assert seen(box((1.0, 0.7, -0.1), (1.1, 0.9, 0.1)), resolution=64) == ("+X", "+Y")


def test_a_large_box_behind_a_face_does_not_count_and_one_around_the_place_does() -> None:
    assert "+X" not in seen(box((-2.0, -9.0, -9.0), (-1.0, 9.0, 9.0)))
    assert seen(box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))) == FACE_NAMES
    assert seen(box((-1.0, -1.0, 0.0), (1.0, 1.0, 0.0))) == FACE_NAMES, "a plane through the place"


def test_no_boxes_are_none() -> None:
    assert may_show(np.zeros((0, 8, 3)), (0.0, 0.0, 0.0), 64, 8).shape == (0, 6)
