"""Where drags lead: lines and planes under the pointer, snapping, precision, how far walls may go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core.dragging import LEAST, Travel, Wall, along_line, farthest_in, on_plane, place_of, snapped, way_of
from pcc_addon.core.influence import Influence
from pcc_addon.core.probe import ProbeSpec
from tests.core.rooms import box

SPEC = ProbeSpec("Probe", box((1.0, 2.0, 3.0), (4.0, 3.0, 1.4), 24.0))
EYE = np.array([5.0, -9.0, 6.0])


@pytest.mark.parametrize("metres", [-3.0, 0.0, 7.5])
def test_the_place_on_a_line_that_is_looked_at_is_found(metres: float) -> None:
    point, way = SPEC.box.centre, way_of(SPEC, Wall(0, True))
    look = point + metres * way - EYE
    assert along_line(point, way, EYE, look / np.linalg.norm(look)) == pytest.approx(metres)


def test_of_a_ray_that_misses_the_line_the_nearest_place_counts() -> None:
    found = along_line(np.zeros(3), np.array([1.0, 0, 0]), np.array([2.0, -5.0, 1.0]), np.array([0.0, 1.0, 0.0]))
    assert found == pytest.approx(2.0)


def test_a_view_along_the_line_or_the_plane_tells_nothing() -> None:
    x = np.array([1.0, 0.0, 0.0])
    assert along_line(np.zeros(3), x, EYE, -x) is None
    assert on_plane(np.zeros(3), x, EYE, np.array([0.0, 1.0, 0.0])) is None


def test_the_place_on_a_plane_is_found() -> None:
    look = np.array([1.0, 2.0, 0.0]) - EYE
    found = on_plane(np.zeros(3), np.array([0.0, 0.0, 1.0]), EYE, look / np.linalg.norm(look))
    assert found == pytest.approx([1.0, 2.0, 0.0])


def test_a_precise_drag_goes_a_tenth_of_the_way_and_does_not_jump_when_it_ends() -> None:
    travel = Travel(np.zeros(1), np.array([5.0])).to(np.array([6.0]), precise=False)
    travel = travel.to(np.array([8.0]), precise=True)
    assert travel.gone == pytest.approx([1.2])
    assert travel.to(np.array([8.0]), precise=False).gone == pytest.approx([1.2])
    assert travel.to(np.array([7.0]), precise=False).gone == pytest.approx([0.2])


def test_snapping_takes_the_nearest_step() -> None:
    assert snapped(np.array([0.26, -0.26, 1.0]), 0.5) == pytest.approx([0.5, -0.5, 1.0])


@pytest.mark.parametrize("high", [False, True])
@pytest.mark.parametrize("axis", range(3))
def test_places_and_ways_are_those_of_the_faces(axis: int, high: bool) -> None:
    wall = Wall(axis, high)
    outwards = SPEC.box.axes[:, axis] * (1.0 if high else -1.0)
    expected = SPEC.box.centre + outwards
    for each in (wall, Wall(axis, high, influence=True)):
        assert way_of(SPEC, each) == pytest.approx(outwards / np.linalg.norm(outwards))
        assert place_of(SPEC, each) == pytest.approx(expected)
    assert place_of(SPEC, wall, 0.5) == pytest.approx(expected + 0.5 * outwards / np.linalg.norm(outwards))
    aside = SPEC.box.coordinates(place_of(SPEC, wall, aside=0.5)[None])[0]
    beside = 0 if axis else 1
    assert aside[beside] == pytest.approx(0.5 * SPEC.box.half_widths[beside])


def test_walls_leave_something_of_the_box_and_of_the_influence() -> None:
    wall = Wall(1, False)
    assert farthest_in(SPEC, wall) == pytest.approx(LEAST - 6.0)
    short = replace(SPEC, influence=Influence(low=(0.0, -1.0, 0.0), high=(0.0, -2.0, 0.0)))
    assert farthest_in(short, wall) == pytest.approx(3.0 + LEAST - 6.0)
    assert farthest_in(short, replace(wall, influence=True)) == pytest.approx(LEAST - 3.0)
    wide = replace(SPEC, influence=Influence(low=(0.0, 1.0, 0.0)))
    assert farthest_in(wide, wall) == pytest.approx(LEAST - 6.0)
    assert farthest_in(wide, replace(wall, influence=True)) == pytest.approx(LEAST - 7.0)
