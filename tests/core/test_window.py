"""Rooms seen through a wall of a probe's box, and rooms unfolded into a map: nothing is upside down or mirrored."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core import equirect, room_map
from pcc_addon.core.effects.interior import RoomPicture
from pcc_addon.core.errors import PccError
from pcc_addon.core.probe import Box, ProbeSpec
from pcc_addon.core.room_map import Corner
from pcc_addon.core.sidecar import Sidecar
from pcc_addon.core.window import Side, room_of

LEFT, RIGHT, BACK, FLOOR, CEILING = (np.array(c, float) for c in np.eye(5))


def baked(matrix: np.ndarray, offset: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Sidecar:
    spec = ProbeSpec("Hall", Box.from_matrix("Hall", matrix), capture_offset=offset)
    return Sidecar.of_bake(spec, "1" * 32, seconds=0.0, content_hash="", blender="", addon="")


@pytest.mark.parametrize(
    ("side", "across", "away"),
    [
        (Side.MINUS_Y, (2.0, 0.0, 0.0), (0.0, 3.0, 0.0)),
        (Side.PLUS_Y, (-2.0, 0.0, 0.0), (0.0, -3.0, 0.0)),
        (Side.MINUS_X, (0.0, -3.0, 0.0), (2.0, 0.0, 0.0)),
        (Side.PLUS_X, (0.0, 3.0, 0.0), (-2.0, 0.0, 0.0)),
    ],
)
def test_a_window_may_be_in_any_upright_wall(side: Side, across: tuple, away: tuple) -> None:
    matrix = np.diag([2.0, 3.0, 1.0, 1.0])
    matrix[:3, 3] = (7.0, 8.0, 9.0)
    room = room_of(baked(matrix, (0.5, -0.25, 0.125)), side, 64)
    assert room == RoomPicture((across, away, (0.0, 0.0, 1.0)), (0.5, -0.25, 0.125), 64)


@pytest.mark.parametrize("mirror", [(-1.0, 1.0, 1.0), (1.0, 1.0, -1.0), (-1.0, -1.0, -1.0)])
@pytest.mark.parametrize("side", Side)
def test_mirrored_boxes_and_boxes_on_their_heads_show_upright_unmirrored_rooms(mirror: tuple, side: Side) -> None:
    room = room_of(baked(np.diag([*np.array((2.0, 3.0, 1.0)) * mirror, 1.0])), side, 64)
    across, away, up = (np.array(edge) for edge in room.half_edges)
    assert up[2] > 0.0 and across @ np.cross(away, up) > 0.0


def marked(size: int = 60) -> np.ndarray:
    """A room map whose tiles have colours of their own, brighter towards their upper right corners."""
    picture = np.zeros((size, size, 6))
    third = size // 3
    for (column, row), color in (
        ((0, 1), LEFT),
        ((2, 1), RIGHT),
        ((1, 1), BACK),
        ((1, 0), FLOOR),
        ((1, 2), CEILING),
    ):
        picture[row * third : (row + 1) * third, column * third : (column + 1) * third, :5] = color
    picture[..., 5] = np.linspace(0.0, 1.0, size)[:, None] + 10.0 * np.linspace(0.0, 1.0, size)
    return picture


def test_each_wall_of_a_room_map_is_where_it_was() -> None:
    """Looking in through the window is along +X; −Y is then to the right."""
    picture = room_map.equirectangular(marked())
    for direction, color in (
        ((1.0, 0.0, 0.0), BACK),
        ((0.0, 1.0, 0.0), LEFT),
        ((0.0, -1.0, 0.0), RIGHT),
        ((0.0, 0.0, 1.0), CEILING),
        ((0.0, 0.0, -1.0), FLOOR),
        ((-1.0, 0.0, 0.0), np.full(5, 0.2)),
    ):
        np.testing.assert_allclose(equirect.lookup(picture, np.array(direction))[:5], color, atol=1e-6)


def test_walls_of_a_room_map_meet_at_the_back_wall_without_a_step() -> None:
    """The last channel is a ramp over the whole map, so it has no step where tiles that touch in the map meet."""
    picture = room_map.equirectangular(marked(300))
    edges = np.linspace(-0.8, 0.8, 9)
    for axis, sign in ((1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)):
        for along in edges:
            spot = np.array((1.0, along, along))
            spot[axis] = sign
            inside, beyond = spot.copy(), spot.copy()
            inside[axis] *= 0.97
            beyond[0] *= 0.97
            values = equirect.lookup(picture, np.stack([inside, beyond]))[:, 5]
            assert abs(values[0] - values[1]) < 0.2


def test_corners_of_a_room_map_are_cut_out_whole() -> None:
    picture = np.zeros((9, 12, 1))
    picture[:3, :4], picture[6:, 8:] = 1.0, 2.0
    assert room_map.corner(picture, Corner.BOTTOM_LEFT).shape == (3, 4, 1)
    assert (room_map.corner(picture, Corner.BOTTOM_LEFT) == 1.0).all()
    assert (room_map.corner(picture, Corner.TOP_RIGHT) == 2.0).all()
    assert (
        not room_map.corner(picture, Corner.TOP_LEFT).any() and not room_map.corner(picture, Corner.BOTTOM_RIGHT).any()
    )


@pytest.mark.parametrize("axis", [0, 1])
def test_walls_of_a_room_map_are_read_between_their_texels(axis: int) -> None:
    rng = np.random.default_rng(2)
    picture = marked(96)
    picture[..., 5] = np.mgrid[0:96, 0:96][axis]  # a ramp, which lines between texels repeat
    found = room_map.equirectangular(picture)
    y, z = rng.uniform(-0.7, 0.7, (2, 50))
    values = equirect.lookup(found, np.stack([np.ones(50), -y, z], -1))[:, 5]
    np.testing.assert_allclose(values, 32.0 + 16.0 * (1.0 + (z, y)[axis]) - 0.5, atol=0.05)


def test_the_smallest_room_map_has_a_pixel_a_tile() -> None:
    room_map.check_room_map("Dots", 3, 3)
    assert room_map.equirectangular(marked(3)).shape == (4, 8, 6)


@pytest.mark.parametrize(("size", "why"), [((2048, 1024), "equirectangular"), ((2, 2), "3 × 3")])
def test_what_is_no_room_map_is_refused(size: tuple[int, int], why: str) -> None:
    with pytest.raises(PccError, match=why):
        room_map.check_room_map("Sky", *size)
