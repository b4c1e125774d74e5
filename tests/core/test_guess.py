"""The room around a point from a few hundred rays: rooms whose walls are known."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.fit.guess import cloud_of_rays, guessed_room, spread_ways
from pcc_addon.core.probe import Box
from tests.core.rooms import Place, about_z, box, furnished, rays, wall_errors

WAYS = spread_ways(800)
ROOM = box((0.0, 0.0, 0.0), (4.0, 3.0, 1.4))
MILLIMETRE = 1e-3


def guessed(place: Place, point: np.ndarray | None = None) -> Box | None:
    """The guess from a point; None: from the middle of the room."""
    point = place.room.centre if point is None else np.asarray(point, float)
    return guessed_room(cloud_of_rays(point, WAYS, *rays(place, point, WAYS)))


def test_the_ways_are_spread_evenly() -> None:
    assert np.allclose(np.linalg.norm(WAYS, axis=1), 1.0)
    assert np.abs(WAYS.mean(0)).max() < 1e-3
    nearest = np.sort(WAYS @ WAYS.T, axis=1)[:, -2]
    assert np.degrees(np.arccos(nearest)).min() > 0.5 * np.degrees(np.sqrt(4.0 * np.pi / len(WAYS)))


@pytest.mark.parametrize("seed", range(12))
def test_a_furnished_room_that_is_turned_is_found_from_anywhere_in_it(seed: int) -> None:
    random = np.random.default_rng(seed)
    place = furnished(ROOM, seed, 8, keep=1.2).turned(about_z(random.uniform(-180.0, 180.0)), (30.0, -20.0, 5.0))
    point = place.room.centre + place.room.axes @ random.uniform(-0.2, 0.2, 3)
    assert wall_errors(place.room, guessed(place, point)).max() < MILLIMETRE


def test_a_turned_room_that_is_drawn_along_other_axes_keeps_their_names() -> None:
    place = Place((ROOM,)).turned(about_z(24.0), (0.0, 0.0, 0.0))
    found = guessed(place)
    assert np.allclose(found.axes / found.half_extents, about_z(24.0), atol=1e-6)
    assert found.half_extents == pytest.approx(ROOM.half_extents)


def test_an_open_side_ends_where_the_walls_beside_it_do() -> None:
    outdoors, ground = box((54.0, 0.0, 0.0), (50.0, 500.0, 500.0)), box((54.0, 0.0, -1.5), (50.0, 500.0, 0.1))
    found = guessed(Place((ROOM, outdoors), (ground,), outside=(1,)))
    assert found.centre == pytest.approx(ROOM.centre, abs=0.15) and found.half_extents[0] == pytest.approx(
        4.0, abs=0.15
    )
    assert found.half_extents[1:] == pytest.approx(ROOM.half_extents[1:], abs=MILLIMETRE)


def test_a_corridor_is_found() -> None:
    corridor = Place((box((0.0, 0.0, 0.0), (9.0, 0.9, 1.25)),))
    assert wall_errors(corridor.room, guessed(corridor, (1.0, 0.1, 0.0))).max() < 0.25


def test_through_a_door_the_room_is_still_that_around_the_point() -> None:
    door, other = box((4.3, 0.5, -0.4), (0.4, 0.45, 1.0)), box((8.6, 0.0, 0.0), (4.0, 3.0, 1.4))
    assert wall_errors(ROOM, guessed(Place((ROOM, door, other)), (0.5, 0.3, 0.1))).max() < MILLIMETRE


def test_a_floor_alone_or_nothing_is_no_room() -> None:
    ground = box((0.0, 0.0, 49.0), (500.0, 500.0, 50.0))
    assert guessed(Place((ground,), outside=()), (0.0, 0.0, 0.5)) is not None, "six walls, however far"
    distances = np.full(len(WAYS), np.inf)
    assert guessed_room(cloud_of_rays(np.zeros(3), WAYS, distances, np.zeros_like(WAYS))) is None
    down = WAYS[:, 2] < -0.05
    floor = np.where(down, 1.5 / np.maximum(-WAYS[:, 2], 0.05), np.inf)
    normals = np.where(down[:, None], (0.0, 0.0, 1.0), 0.0)
    assert guessed_room(cloud_of_rays(np.zeros(3), WAYS, floor, normals)) is None


def corner(*planes: tuple[int, float]) -> Box | None:
    """The guess from the origin amid walls across an axis each, 4 m along the others, as (axis, metres)."""
    distances, normals = np.full(len(WAYS), np.inf), np.zeros_like(WAYS)
    for axis, place in planes:
        with np.errstate(divide="ignore"):
            meets = place / WAYS[:, axis]
        others = np.delete(WAYS * meets[:, None], axis, axis=1)
        hit = (meets > 0.0) & (meets < distances) & (np.abs(others) <= 4.0).all(-1)
        distances, normals[hit] = np.where(hit, meets, distances), np.eye(3)[axis]
    return guessed_room(cloud_of_rays(np.zeros(3), WAYS, distances, normals))


def test_three_walls_are_a_room_and_two_are_none() -> None:
    found = corner((2, -1.2), (0, 3.0), (1, 2.0))
    high = found.centre + found.half_extents
    assert high[:2] == pytest.approx([3.0, 2.0], abs=MILLIMETRE)
    assert (found.centre - found.half_extents)[2] == pytest.approx(-1.2, abs=MILLIMETRE)
    assert (found.centre - found.half_extents)[:2] == pytest.approx([-4.0, -4.0], abs=0.5), "as far as the walls reach"
    assert corner((2, -1.2), (0, 3.0)) is None
