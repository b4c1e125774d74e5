"""Interior mapping by NumPy: what one sees through a pane, against geometry; what varies, against counting."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core import equirect, flat
from pcc_addon.core.backends.arrays import evaluate
from pcc_addon.core.effects.interior import Cells, Interior, RoomPicture, chance, interior, pane
from pcc_addon.core.expression import scalar
from tests.core.boxes import directions, unit

SIZE = np.array((4.0, 5.0, 3.0))  # width, depth, height of the rooms, metres
PLAIN = {
    "Width": SIZE[0],
    "Depth": SIZE[1],
    "Height": SIZE[2],
    "Offset": (0.0, 0.0, 0.0),
    "Up": (0.0, 0.0, 1.0),
    "Real Size": 0.0,
    "Object Scale": (1.0, 1.0, 1.0),
    "Object Random": 0.3,
    "Per Object": 1.0,
    "Seed": 0.0,
    "Turns": 0.0,
    "Mirrored": 0.0,
    "Lit": 1.0,
    "Strength": 1.0,
    "Dark Strength": 0.0,
    "Tint A": (1.0, 1.0, 1.0),
    "Tint B": (1.0, 1.0, 1.0),
    "IOR": 1.0,
    "Middle": 1.0,
    "Middle Depth": 0.5,
    "Curtains": 1.0,
    "Curtain Depth": 0.0,
}
HEIGHT = 64
COORDINATES = equirect.directions(2 * HEIGHT, HEIGHT)  # a picture whose colour is the direction


def seen(
    record: Interior, position: np.ndarray, eye: np.ndarray, normal: np.ndarray, **changed: object
) -> dict[str, np.ndarray]:
    """What rays from `eye` (3,) see at points of panes, object space."""
    inputs = {**PLAIN, **{name.replace("_", " "): value for name, value in changed.items()}}
    pictures = {f"Room {k}": np.where(k, 0.1 * k, COORDINATES) for k in range(len(record.rooms))}
    rows = np.arange(8.0)[:, None] * np.ones(8)
    pictures["Middle Picture"] = np.stack([rows, rows.T, rows * 0.0, (rows < 4.0) * 1.0], -1)
    pictures["Curtain Picture"] = np.stack([rows, rows, rows, (rows.T < 2.0) * 1.0], -1)
    inputs |= {
        "Position": position,
        "Incoming": unit(eye - position),
        "Normal": np.broadcast_to(normal, position.shape),
    }
    return evaluate(interior(record).outputs, inputs, np.float64, pictures)


def facade(count: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """Points of a wall that faces −Y, from the lower left corner of a room on, and an eye before it."""
    rng = np.random.default_rng(8)
    position = np.stack([rng.uniform(-10.0, 10.0, count), np.zeros(count), rng.uniform(-9.0, 9.0, count)], -1)
    return position, np.array((3.0, -7.0, -1.0))


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.5])
@pytest.mark.parametrize("captured", [(0.0, 0.0, 0.0), (0.5, -1.0, 0.4)])
def test_a_pane_shows_the_room_that_stands_behind_it(turn: float, captured: tuple) -> None:
    """Rays meet real boxes behind a turned wall, plane by plane; the picture's box is turned another way."""
    position, eye = facade()
    tilt = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])  # the picture's axes of the room's own
    edges = tuple(tuple(row) for row in (tilt * (SIZE / 2.0)).T)
    record = Interior((RoomPicture(edges, tuple(tilt @ captured), HEIGHT),))
    wall = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    found = seen(record, position @ wall.T, wall @ eye, wall @ (0.0, -1.0, 0.0))["Radiance"]
    ray = unit(position - eye)
    room = np.round(position / (SIZE[0], 1.0, SIZE[2])) * (SIZE[0], 0.0, SIZE[2]) + (0.0, SIZE[1] / 2.0, 0.0)
    local = position - room
    exits = (np.sign(ray) * SIZE / 2.0 - local) / ray
    exits[:, 1] = (SIZE[1] / 2.0 - local[:, 1]) / ray[:, 1]
    hit = local + exits.min(-1, keepdims=True) * ray
    expected = equirect.lookup(COORDINATES, (hit - captured) @ tilt.T)
    np.testing.assert_allclose(found, expected, atol=2e-3)
    assert np.linalg.norm(unit(found) - unit((hit - captured) @ tilt.T), axis=-1).max() < 0.05


def test_rooms_scale_with_the_object_or_keep_their_metres() -> None:
    position, eye = facade()
    scale = np.array((2.0, 3.0, 0.5))
    record = Interior((RoomPicture(rows=HEIGHT),))
    plain = seen(record, position, eye, (0.0, -1.0, 0.0))
    with_it = seen(record, position, eye, (0.0, -1.0, 0.0), Object_Scale=scale)
    in_metres = seen(record, position / scale, eye / scale, (0.0, -1.0, 0.0), Object_Scale=scale, Real_Size=1.0)
    np.testing.assert_allclose(with_it["Radiance"], plain["Radiance"], atol=1e-9)
    np.testing.assert_allclose(in_metres["Radiance"], plain["Radiance"], atol=1e-9)


def test_a_uv_map_says_where_rooms_are() -> None:
    position, eye = facade()
    uv = np.stack([position[:, 0] / SIZE[0] + 0.5, position[:, 2] / SIZE[2] + 0.5, position[:, 0] * 0.0], -1)
    by_size, by_uv = (Interior((RoomPicture(rows=HEIGHT),), cells) for cells in Cells)
    expected = seen(by_size, position, eye, (0.0, -1.0, 0.0), Mirrored=0.5)
    found = seen(by_uv, position, eye, (0.0, -1.0, 0.0), Mirrored=0.5, UV=uv)
    np.testing.assert_allclose(found["Radiance"], expected["Radiance"], atol=1e-9)
    shifted = seen(by_uv, position, eye, (0.0, -1.0, 0.0), UV=uv, Offset=(1.0, -2.0, 0.0))
    np.testing.assert_array_equal(shifted["Cell"][:, :2], expected["Cell"][:, :2] + (1.0, -2.0))


@pytest.mark.parametrize(
    "normal", [(0.0, -1.0, 0.0), (0.6, 0.8, 0.0), (0.0, 0.6, 0.8), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
)
def test_the_axes_of_any_pane_are_square_and_have_up_above(normal: tuple) -> None:
    rng = np.random.default_rng(3)
    incoming = directions(50, rng)
    inputs = {**PLAIN, "Position": directions(50, rng), "Incoming": incoming, "Normal": np.tile(normal, (50, 1))}
    ray = evaluate(pane(), inputs, np.float64)["Ray"]
    np.testing.assert_allclose(np.linalg.norm(ray, axis=-1), 1.0, atol=1e-12)
    assert (ray[:, 1] >= 0.0).all()
    above = np.array((0.0, 1.0, 0.0) if abs(normal[2]) == 1.0 else (0.0, 0.0, 1.0))
    aloft = unit(above - np.array(normal) * (above @ normal))
    np.testing.assert_allclose(ray[:, 2], -(incoming @ aloft), atol=1e-12)


def test_every_room_varies_and_no_other_point_of_it_does() -> None:
    position, eye = facade(20_000)
    found = seen(Interior((RoomPicture(rows=HEIGHT),) * 3), position, eye, (0.0, -1.0, 0.0), Lit=0.5, Turns=1.0)
    rooms, which = np.unique(found["Cell"], axis=0, return_inverse=True)
    assert len(rooms) == 5 * 7
    numbers = [found["Random"][which == k] for k in range(len(rooms))]
    assert all((n == n[0]).all() for n in numbers)
    assert len({tuple(n[0]) for n in numbers}) == len(rooms)


def variety(count: int, **changed: object) -> dict[str, np.ndarray]:
    """Straight looks at the middles of many rooms; the wall on the left is −x, that ahead +y."""
    cells = np.arange(count)
    position = np.stack([cells % 200 * SIZE[0], cells * 0.0, cells // 200 * SIZE[2]], -1)
    edges = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    rooms = (RoomPicture(edges, rows=HEIGHT), *(RoomPicture(edges, rows=HEIGHT),) * int(changed.pop("others", 0)))
    inputs = {**PLAIN, **{name.replace("_", " "): value for name, value in changed.items()}}
    pictures = {f"Room {k}": np.where(k, 0.1 * k, COORDINATES) for k in range(len(rooms))}
    side = inputs.pop("Look", (0.0, -1.0, 0.0))
    inputs |= {
        "Position": position,
        "Incoming": np.tile(side, (count, 1)),
        "Normal": np.tile((0.0, -1.0, 0.0), (count, 1)),
    }
    return evaluate(interior(Interior(rooms)).outputs, inputs, np.float64, pictures)


def test_rooms_are_lit_as_often_as_asked() -> None:
    for share in (0.0, 0.3, 1.0):
        found = variety(20_000, Lit=share, Dark_Strength=0.25)
        lit = found["Is Lit"] == 1.0
        assert abs(lit.mean() - share) <= 0.015 * (0.0 < share < 1.0)
        strength = np.linalg.norm(found["Radiance"], axis=-1)
        np.testing.assert_allclose(strength, np.where(lit, 1.0, 0.25), atol=0.01)


def test_quarter_turns_show_each_wall_as_often() -> None:
    ahead = np.round(variety(20_000, Turns=1.0)["Radiance"])
    walls, counts = np.unique(ahead + 0.0, axis=0, return_counts=True)
    assert sorted(walls.tolist()) == [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    assert (abs(counts / 20_000 - 0.25) < 0.015).all()
    assert (np.round(variety(2000)["Radiance"]) == (0.0, 1.0, 0.0)).all(), "none is turned where nobody asks"


def test_mirrored_rooms_show_the_other_side_wall() -> None:
    steep = unit(np.array((0.95, -0.3, 0.0)))  # the eye stands far to the right and sees the left wall
    for share in (0.0, 0.4, 1.0):
        x = variety(20_000, Mirrored=share, Look=steep)["Radiance"][:, 0]
        assert (abs(x) > 0.5).all() and abs((x > 0.0).mean() - share) <= 0.015 * (0.0 < share < 1.0)


def test_pictures_are_chosen_as_often_as_each_other() -> None:
    radiance = variety(20_000, others=3)["Radiance"]
    numbers, counts = np.unique(np.round(radiance[:, 0], 6) + 0.0, return_counts=True)
    np.testing.assert_allclose(numbers, (0.0, 0.1, 0.2, 0.3), atol=1e-6)
    assert (abs(counts / 20_000 - 0.25) < 0.015).all()


def test_tints_lie_between_both_colours() -> None:
    found = variety(20_000, Tint_A=(1.0, 0.5, 0.0), Tint_B=(0.0, 1.0, 0.0))["Radiance"]
    np.testing.assert_allclose(found[:, 1].min(), 0.5, atol=0.01)
    np.testing.assert_allclose(found[:, 1].max(), 1.0, atol=0.01)
    assert abs(found[:, 1].mean() - 0.75) < 0.01


def test_seeds_objects_and_walls_have_rooms_of_their_own() -> None:
    plain = variety(5000, Lit=0.5)
    assert 0.4 < (plain["Is Lit"] == variety(5000, Lit=0.5, Seed=1.0)["Is Lit"]).mean() < 0.6
    other = variety(5000, Lit=0.5, Object_Random=0.7)
    assert 0.4 < (plain["Is Lit"] == other["Is Lit"]).mean() < 0.6
    shared = [variety(5000, Lit=0.5, Object_Random=r, Per_Object=0.0)["Is Lit"] for r in (0.3, 0.7)]
    assert (shared[0] == shared[1]).all()
    position, eye = facade(500)
    record = Interior((RoomPicture(rows=HEIGHT),))
    walls = {seen(record, position, eye, n)["Cell"][0, 2] for n in ((0, -1, 0), (0, 1, 0), (1, 0, 0), (-1, 0, 0))}
    assert len(walls) == 4


def test_chances_of_0_and_1_are_never_and_always() -> None:
    numbers = np.array((0.0, 2.0**-32, 0.5, 1.0))
    for share in (0.0, 1.0):
        outputs = {"Chance": chance(scalar("Number"), scalar("Share"))}
        assert (evaluate(outputs, {"Number": numbers, "Share": share})["Chance"] == share).all()


def test_layers_lie_where_a_ray_meets_their_planes() -> None:
    """The middle one fills the room's lower half, half way to the back; the curtain the left quarter of the pane."""
    position, eye = facade()
    record = Interior((RoomPicture(rows=HEIGHT),), middle=True, curtains=True)
    bare = seen(Interior((RoomPicture(rows=HEIGHT),)), position, eye, (0.0, -1.0, 0.0))["Radiance"]
    found = seen(record, position, eye, (0.0, -1.0, 0.0))["Radiance"]
    share = position / SIZE + 0.5
    pane_x, cell = share[:, 0] % 1.0, np.floor(share)
    ray = position - eye
    met = position + ray * (2.5 / ray[:, 1:2])
    x, z = met[:, 0] / SIZE[0] + 0.5 - cell[:, 0], met[:, 2] / SIZE[2] + 0.5 - cell[:, 2]
    curtain = pane_x < 0.25
    table = ~curtain & (x > 0.0) & (x < 1.0) & (z > 0.0) & (z < 0.5)
    near_edge = (
        (abs(pane_x - 0.25) < 0.07) | (abs(z - 0.5) < 0.07) | (abs(x * (1 - x)) < 0.01) | (abs(z * (1 - z)) < 0.01)
    )
    rows = np.clip(z * 8.0 - 0.5, 0.0, 7.0)
    for mask, expected in ((table, rows), (curtain, np.clip(share[:, 2] % 1.0 * 8.0 - 0.5, 0.0, 7.0))):
        mask = mask & ~near_edge
        assert mask.sum() > 200
        np.testing.assert_allclose(found[mask, 0], expected[mask], atol=1e-9)
    free = ~curtain & ~table & ~near_edge
    np.testing.assert_allclose(found[free], bare[free], atol=1e-9)


def test_glass_takes_what_fresnel_says() -> None:
    straight = np.linalg.norm(variety(1, IOR=1.5)["Radiance"])
    assert straight / np.linalg.norm(variety(1)["Radiance"]) == pytest.approx(0.96, abs=1e-9)


def test_a_flat_picture_is_nothing_beyond_its_edges() -> None:
    picture = np.arange(24.0).reshape(2, 3, 4) + 1.0
    places = np.array([(0.0, 0.0, 9.0), (1.0, 1.0, 0.0), (1.0001, 0.5, 0.0), (0.5, -1e-9, 0.0), (0.5, 0.5, 0.0)])
    found = flat.lookup(picture, places)
    np.testing.assert_allclose(found[:, 0], (1.0, 21.0, 0.0, 0.0, (5.0 + 17.0) / 2.0))


def test_a_capture_from_the_rooms_middle_subtracts_nothing() -> None:
    centred, aside = (
        sum(1 for _ in interior(Interior((RoomPicture(capture=c),))).parts()) for c in ((0.0,) * 3, (1.0,) * 3)
    )
    assert centred < aside
