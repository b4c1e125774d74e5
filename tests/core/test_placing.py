"""Boxes around things."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.placing import around, lines
from tests.core.rooms import about_z, box

CORNERS = np.array(list(np.ndindex(2, 2, 2))) * 2.0 - 1.0


def corners(each: object) -> np.ndarray:
    return each.centre + CORNERS @ each.axes.T


@pytest.mark.parametrize("degrees", [0.0, 24.0, -70.0])
def test_a_box_is_around_all_points_along_the_axes(degrees: float) -> None:
    one = box((1.0, 2.0, 3.0), (4.0, 3.0, 1.4), degrees)
    found = around(corners(one), about_z(degrees), np.zeros(3))
    assert np.allclose(found.matrix, one.matrix)


@pytest.mark.parametrize(("cursor", "middle"), [(0.0, 1.0), (5.0, 1.0), (-5.0, -1.0)])
def test_from_a_floor_the_box_stands_on_the_side_that_is_meant(cursor: float, middle: float) -> None:
    floor = np.array([(x, y, 0.0) for x in (-3.0, 3.0) for y in (-2.0, 2.0)])
    found = around(floor, np.eye(3), np.array([0.0, 0.0, cursor]))
    assert found.centre == pytest.approx((0.0, 0.0, middle)) and found.half_extents == pytest.approx((3.0, 2.0, 1.0))


def test_a_point_has_a_box_with_volume() -> None:
    assert (around(np.zeros((1, 3)), np.eye(3), np.zeros(3)).half_extents > 0.0).all()


def test_the_lining_of_walls_is_told_from_what_is_smaller_or_reaches_beyond() -> None:
    outside = box((0.0, 0.0, 0.0), (4.2, 3.2, 1.6))
    assert lines(box((0.0, 0.0, 0.0), (4.0, 3.0, 1.4)), outside)
    assert not lines(box((0.0, 0.0, 0.0), (2.0, 3.0, 1.4)), outside)
    assert not lines(box((0.0, 0.0, 0.5), (4.0, 3.0, 1.4)), outside)
    turned = box((0.0, 0.0, 0.0), (4.0, 3.0, 1.4), 24.0)
    assert lines(turned, around(corners(turned), np.eye(3), np.zeros(3)))
