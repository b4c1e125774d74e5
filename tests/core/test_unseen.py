"""What a capture point does not see: rooms of which that is known exactly."""

from __future__ import annotations

import numpy as np
import pytest

from pcc_addon.core.accuracy.sampling import Make, Place, Triangles, make_of, sample
from pcc_addon.core.accuracy.unseen import Part, Unseen, influence_of, unseen, viewers_of
from pcc_addon.core.accuracy.unseen_words import lines, square_metres
from pcc_addon.core.influence import Influence
from tests.core.triangle_rooms import cuboid, rectangle, scene, spec_of, surveyed

HALF, CENTRE = (3.0, 2.5, 1.4), (10.0, -7.0, 1.4)
COUNT = 20_000
ROOM = 8.0 * (3.0 * 2.5 + 3.0 * 1.4 + 2.5 * 1.4)  # square metres


def found(receivers: frozenset[str] = frozenset(), half=HALF, offset=(0.0, 0.0, 0.0), **meshes) -> Unseen:
    m = np.diag([*half, 1.0])
    m[:3, 3] = CENTRE
    spec = spec_of(m, 128, capture_offset=offset)
    if "Room" not in meshes:
        meshes = {"Room": cuboid(CENTRE, HALF)} | meshes
    triangles = scene(spec.capture_point, **meshes)
    return unseen(spec, surveyed(spec, triangles), sample(triangles, COUNT, influence_of(spec)), receivers)


def areas(result: Unseen) -> dict[tuple[str, Part], float]:
    return {(part.name, part.part): part.area for part in result.parts}


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (2.0, -1.5, 0.9), (-1.0, 0.5, -1.3)])
def test_an_empty_room_is_seen_whole(offset: tuple[float, float, float]) -> None:
    result = found(offset=offset)
    assert result.unseen_area <= 6e-4 * ROOM and result.idle == 0.0 and result.area == pytest.approx(ROOM)
    assert result.parts == () or any(offset)  # a texel in a corner may mix three walls
    assert list(lines(result)) == ["The capture point sees all surfaces in the probe's influence"]


def test_a_room_of_sheets_is_seen_whole_whichever_way_its_normals_point() -> None:
    for sign in (1.0, -1.0):
        walls = {}
        for axis in range(3):
            for side in (1.0, -1.0):
                ways = np.diag(HALF)
                centre = np.array(CENTRE) + side * ways[axis]
                walls[f"Wall{axis}{side}"] = rectangle(centre, sign * ways[(axis + 1) % 3], ways[(axis + 2) % 3])
        result = found(Room=walls.pop("Wall21.0"), **walls)
        assert result.parts == () and result.area == pytest.approx(ROOM)
        larger = found(
            half=tuple(h + 0.1 for h in HALF), Room=rectangle((10, -7, 2.8), (3, 0, 0), (0, 2.5, 0)), **walls
        )
        assert larger.parts == () and larger.area == pytest.approx(ROOM)


def test_a_box_on_the_floor_below_hides_its_sides_and_its_shadow() -> None:
    result = found(Crate=cuboid((10.0, -7.0, 0.2), (0.4, 0.3, 0.2)))
    sides, base = 2.0 * (0.8 + 0.6) * 0.4, 0.8 * 0.6
    shadow = base * (1.4 / 1.0) ** 2  # of its top, as the capture point throws it; what it stands on is in it
    got = areas(result)
    assert set(got) == {("Crate", Part.BACK), ("Room", Part.HIDDEN)}
    assert got["Crate", Part.BACK] == pytest.approx(sides, rel=0.03)
    assert got["Room", Part.HIDDEN] == pytest.approx(shadow, rel=0.05)
    assert result.idle == pytest.approx(base, rel=0.03)
    [room] = [part for part in result.parts if part.name == "Room"]
    assert room.share == pytest.approx(shadow / ROOM, rel=0.05) and room.materials == ("room",)


def test_a_table_hides_its_underside_and_who_faces_it_is_named() -> None:
    floor = rectangle((10, -7, 0), (3, 0, 0), (0, 2.5, 0))
    ceiling = rectangle((10, -7, 2.8), (3, 0, 0), (0, 2.5, 0))
    table = cuboid((10.0, -7.0, 0.7), (0.6, 0.4, 0.02))
    result = found(frozenset({"room", "ceiling"}), Room=floor, Ceiling=ceiling, Table=table)
    got = areas(result)
    assert got["Table", Part.UNDERSIDE] == pytest.approx(0.96, rel=0.03)
    assert got["Room", Part.HIDDEN] == pytest.approx(0.96 * (1.4 / 0.68) ** 2, rel=0.05)
    by_part = {(part.name, part.part): part for part in result.parts}
    assert by_part["Table", Part.UNDERSIDE].facing == ("Room",)
    assert by_part["Room", Part.HIDDEN].facing == ("Ceiling",)
    text = list(lines(result))
    under = next(line for line in text if line.startswith("the underside of 'Table', "))
    assert under.split(", ")[1] in {"0.9 m²", "0.95 m²", "1.0 m²"} and under.endswith(", which 'Room' may mirror")
    assert any(line.startswith("14 % of 'Room', 4.") for line in text), text


def test_a_flat_table_top_has_two_sides_and_a_wardrobe_a_top_and_a_back() -> None:
    result = found(
        Sheet=rectangle((10.0, -7.0, 0.7), (0.5, 0, 0), (0, 0.5, 0)),
        Wardrobe=cuboid((12.5, -7.0, 1.0), (0.3, 0.5, 1.0)),
    )
    got = areas(result)
    assert got["Sheet", Part.UNDERSIDE] == pytest.approx(1.0, rel=0.03)
    assert got["Wardrobe", Part.TOP] == pytest.approx(0.6, rel=0.03)  # above the eye
    assert got["Wardrobe", Part.BACK] == pytest.approx(1.0 * 2.0 + 2.0 * 0.6 * 2.0, rel=0.03)
    assert ("Wardrobe", Part.HIDDEN) not in got and result.idle == pytest.approx(0.6, rel=0.05)


def test_what_lies_outside_the_influence_is_not_asked_for() -> None:
    result = found(Ground=rectangle((10, -7, 0), (300, 0, 0), (0, 300, 0)), Far=cuboid((30, -7, 1), (1, 1, 1)))
    assert result.area == pytest.approx(ROOM + 6.1 * 5.1, rel=0.01)
    assert "Far" not in {part.name for part in result.parts}


@pytest.mark.parametrize(("height", "hides"), [(0.005, False), (0.1, True)])
def test_only_what_lies_apart_from_a_surface_hides_it(height: float, hides: bool) -> None:
    result = found(Rug=rectangle((10.0, -7.0, height), (0.5, 0, 0), (0, 0.5, 0)))
    assert areas(result).get(("Room", Part.HIDDEN), 0.0) == pytest.approx(
        (1.4 / (1.4 - height)) ** 2 if hides else 0.0, rel=0.05
    )


def test_sentences_are_few_and_sorted() -> None:
    stools = {f"Stool{k}": cuboid((8.0 + 0.4 * k, -7.0, 0.2), (0.1, 0.1 + 0.01 * k, 0.2)) for k in range(10)}
    result = found(**stools)
    text = list(lines(result))
    assert text[0].startswith("The capture point does not see") and len(text) == 1 + 8 + 1 + 1
    assert text[9].startswith("and ") and "more, " in text[9] and text[10].endswith("what stands on the floor")
    assert [part.area for part in result.parts] == sorted((p.area for p in result.parts), reverse=True)
    assert sum(part.area for part in result.parts) == pytest.approx(result.unseen_area)
    assert len(result.points) == pytest.approx(result.unseen_area / result.area * COUNT, abs=120)


def test_nothing_there_is_said() -> None:
    m = np.diag([1.0, 1.0, 1.0, 1.0])
    spec = spec_of(m, 16)
    nothing = Triangles(np.zeros((0, 3, 3)), np.zeros(0, int), np.zeros(0, int), ())
    result = unseen(spec, np.zeros((32, 64)), sample(nothing, 100, influence_of(spec)))
    assert list(lines(result)) == ["No surface is in the probe's influence"]
    assert viewers_of(sample(nothing, 100, influence_of(spec)), frozenset({"x"})) is None


def test_samples_are_clipped_exactly_and_lie_in_the_place() -> None:
    place = Place(np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0]]), np.array([1.0, 1.0, 1.0, 1.0]))
    big = scene(np.array([0, 0, 5.0]), Floor=rectangle((0.3, 0.2, 0), (9, 3, 0), (-3, 9, 0)))
    got = sample(big, 1000, place)
    assert got.area * 1000 == pytest.approx(4.0, rel=1e-9)
    assert (np.abs(got.points[:, :2]) <= 1.0 + 1e-9).all() and np.allclose(got.normals, (0, 0, 1))
    counts = np.histogram2d(*got.points[:, :2].T, bins=4, range=[[-1, 1], [-1, 1]])[0]
    assert counts.min() > 45 and counts.max() < 80
    triangle = Triangles(
        np.array([[[0, 0, 0], [3.0, 0, 0], [0, 3.0, 0]]]), np.zeros(1, int), np.zeros(1, int), (("A", "a"),)
    )
    assert sample(triangle, 10, place).area * 10 == pytest.approx(1.0)


def test_meshes_are_told_apart_and_turned() -> None:
    corners, vertices = cuboid((0, 0, 0), (1, 1, 1))
    outside, inside = np.array([5.0, 0, 0]), np.array([0.2, 0.1, 0.3])
    assert make_of(corners, vertices, outside) == (Make.SOLID, False)
    assert make_of(corners, vertices, inside) == (Make.SOLID, True)
    assert make_of(corners[:, ::-1], vertices[:, ::-1], outside) == (Make.SOLID, True)
    assert make_of(corners[:, ::-1], vertices[:, ::-1], inside) == (Make.SOLID, False)
    assert make_of(corners[1:], vertices[1:], outside) == (Make.SHELL, False)
    assert make_of(*rectangle((0, 0, 0), (1, 0, 0), (0, 1, 0)), outside)[0] is Make.SHEET


@pytest.mark.parametrize(("area", "words"), [(12.4, "12 m²"), (1.26, "1.3 m²"), (0.04, "0.04 m²"), (0.97, "1.0 m²")])
def test_areas_in_words(area: float, words: str) -> None:
    assert square_metres(area) == words


def test_surfaces_are_asked_for_where_the_influence_reaches_and_at_least_a_little_around_the_box() -> None:
    spec = spec_of(np.diag([1.0, 1.0, 1.0, 1.0]), influence=Influence(low=(2.0, 0.0, 0.0), high=(0.0, 0.5, 0.0)))
    place = influence_of(spec)

    def holds(*point: float) -> bool:
        return bool((place.normals @ point <= place.offsets).all())

    assert holds(-2.9, 0, 0) and not holds(1.1, 0, 0) and holds(1.04, 0, 0) and not holds(-3.1, 0, 0)
    assert holds(0, 1.5, 0) and not holds(0, -1.1, 0) and holds(0, 0, -1.04) and not holds(0, 0, -1.06)
