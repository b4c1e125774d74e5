"""The box of a room from what is seen in it: rooms whose walls are known."""

from __future__ import annotations

import json
from collections.abc import Generator
from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core import equirect
from pcc_addon.core.errors import ProbeError
from pcc_addon.core.fit.capture_point import seen_share
from pcc_addon.core.fit.choice import chosen
from pcc_addon.core.fit.cloud import FAR, cloud_of
from pcc_addon.core.fit.frames import named_after
from pcc_addon.core.fit.misfit import exits, misfit
from pcc_addon.core.fit.records import Fit
from pcc_addon.core.fit.report import headline, lines, record
from pcc_addon.core.fit.room import Fitted, fit_of, fit_room
from pcc_addon.core.probe import Box, Correction, ProbeSpec
from tests.core.rooms import Place, about_x, about_z, box, drawn_wrong, furnished, nearness, wall_errors

CLEAN = box((0.0, 0.0, 0.0), (3.0, 2.2, 1.3))
HALF_MILLIMETRE, FIVE_MILLIMETRES = 5e-4, 5e-3


def fitted(place: Place, drawn: Box, point: np.ndarray | None = None) -> Fitted:
    """The fit from a point; None: from the middle of the drawn box."""
    point = drawn.centre if point is None else np.asarray(point, float)
    return fit_room("Probe", drawn, nearness(place, point), point)


def one_room(seed: int, pieces: int) -> tuple[Place, Box]:
    """A furnished room of a size, turn and place drawn by lot, and its box drawn 20 % wrong."""
    random = np.random.default_rng(seed)
    room = box((0.0, 0.0, 0.0), random.uniform((1.6, 1.4, 1.2), (5.0, 4.0, 1.8)))
    place = furnished(room, seed, pieces)
    place = place.turned(about_z(random.uniform(-180.0, 180.0)), random.uniform(-50.0, 50.0, 3))
    return place, drawn_wrong(place.room, seed)


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(12))
def test_a_clean_room_is_found_to_half_a_millimetre(seed: int) -> None:
    place, drawn = one_room(seed, 0)
    found = fitted(place, drawn)
    assert found.found == 6
    assert wall_errors(place.room, found.box).max() < HALF_MILLIMETRE


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(24))
def test_a_furnished_room_is_found_to_five_millimetres(seed: int) -> None:
    place, drawn = one_room(seed, 8)
    found = fitted(place, drawn, place.room.centre)
    assert wall_errors(place.room, found.box).max() < FIVE_MILLIMETRES


@pytest.mark.heavy
def test_the_furniture_hides_much_of_what_is_found() -> None:
    """So that the test before shows something."""
    covered = [wall.covered for seed in range(24) for wall in fitted(*one_room(seed, 8)).walls]
    assert max(covered) > 0.5 and np.mean(covered) > 0.15


def test_the_same_survey_gives_the_same_box_to_the_last_bit() -> None:
    place, drawn = one_room(3, 8)
    seen = nearness(place, place.room.centre)
    one, two = (fit_room("Probe", drawn, seen.copy(), place.room.centre.copy()) for _ in range(2))
    assert one.box.matrix == two.box.matrix and one.walls == two.walls


def test_the_axes_are_named_after_the_drawn_ones() -> None:
    drawn = box((0.1, 0.1, 0.0), (2.6, 2.5, 1.2), -10.0)
    found = fitted(Place((CLEAN,)), drawn)
    assert found.box.half_extents == pytest.approx(CLEAN.half_extents, abs=HALF_MILLIMETRE)
    assert np.allclose(found.box.axes / found.box.half_extents, np.eye(3), atol=1e-4)
    turned = fitted(Place((CLEAN,)), box((0.1, 0.1, 0.0), (2.2, 3.0, 1.2), 80.0))
    assert turned.box.axes[1, 0] > 2.1, "the drawn X lies along the room's Y"


def test_a_mirrored_box_stays_mirrored() -> None:
    matrix = np.array(box((0.1, 0.0, 0.0), (2.6, 2.5, 1.2), 20.0).matrix).reshape(4, 4)
    matrix[:3, 0] *= -1.0
    found = fitted(Place((CLEAN,)), Box(tuple(matrix.ravel())))
    assert np.linalg.det(found.box.axes) < 0.0
    assert wall_errors(CLEAN, found.box).max() < HALF_MILLIMETRE


def test_a_room_along_the_axes_has_the_lookup_of_boxes_along_the_axes() -> None:
    found = fitted(furnished_along(), drawn_wrong(CLEAN, 2))
    assert found.box.correction is Correction.ALIGNED_BOX
    turned = fitted(furnished_along().turned(about_z(24.0), (12.0, -7.5, 1.8)), box((12.1, -7.4, 1.7), (3.4, 2.0, 1.4)))
    assert turned.box.correction is Correction.TURNED_BOX


def furnished_along() -> Place:
    return furnished(CLEAN, 5, 6)


@pytest.mark.parametrize("rough", [5e-4, 2e-3, 4e-3])
def test_uneven_walls_are_found_where_they_are_in_the_mean(rough: float) -> None:
    place, drawn = one_room(4, 6)
    seen = nearness(place, place.room.centre)
    bumps = np.random.default_rng(1).normal(0.0, rough, seen.shape)
    found = fit_room("Probe", drawn, (1.0 / (1.0 / seen + bumps)).astype(np.float32), place.room.centre)
    assert found.found == 6 and wall_errors(place.room, found.box).max() < 1e-3


def test_skirtings_frames_and_rugs_are_no_walls() -> None:
    skirting = [box((0.0, end * 2.19, -1.2), (3.0, 0.01, 0.1)) for end in (-1.0, 1.0)]
    frames = [box((2.985, 0.0, 0.2), (0.015, 1.2, 0.7)), box((-2.98, 0.5, 0.0), (0.02, 0.8, 0.5))]
    rug = box((0.0, 0.0, -1.295), (2.0, 1.5, 0.005))
    found = fitted(Place((CLEAN,), (*skirting, *frames, rug)), drawn_wrong(CLEAN, 1))
    assert wall_errors(CLEAN, found.box).max() < HALF_MILLIMETRE


@pytest.mark.parametrize("cover", [0.4, 0.6, 0.8])
def test_cupboards_before_a_wall_leave_it_the_wall(cover: float) -> None:
    """Wide ones, which leave a gap below the ceiling."""
    height = cover * 1.3
    cupboard = box((2.7, 0.0, height - 1.3), (0.3, 2.0, height))
    found = fitted(Place((CLEAN,), (cupboard,)), drawn_wrong(CLEAN, 4), np.array([-0.5, 0.2, 0.1]))
    assert wall_errors(CLEAN, found.box).max() < HALF_MILLIMETRE
    covered = max(wall.covered for wall in found.walls)
    assert covered > 0.6 * cover


def test_fitted_cupboards_from_floor_to_ceiling_are_the_wall() -> None:
    cupboard = box((2.7, 0.0, 0.0), (0.3, 2.2, 1.3))
    found = fitted(Place((CLEAN,), (cupboard,)), drawn_wrong(CLEAN, 4), np.zeros(3))
    seen = box((-0.3, 0.0, 0.0), (2.7, 2.2, 1.3))
    assert wall_errors(seen, found.box).max() < HALF_MILLIMETRE


@pytest.mark.parametrize("wide", [0.5, 0.85])
def test_a_wall_with_a_large_window_is_found(wide: float) -> None:
    window = box((53.0, 0.0, 0.1), (50.1, wide * 2.2, 0.9))
    found = fitted(Place((CLEAN, window), (), (1,)), drawn_wrong(CLEAN, 7), np.zeros(3))
    assert found.found == 6 and wall_errors(CLEAN, found.box).max() < HALF_MILLIMETRE
    assert max(wall.open for wall in found.walls) > 0.3


@pytest.mark.parametrize("deep", [0.08, 0.5, 1.5, 3.0])
def test_what_lies_beyond_a_window_or_a_door_is_no_wall(deep: float) -> None:
    """A niche, a cupboard's inside, a corridor, a room."""
    window = box((3.0 + deep / 2.0, 0.0, 0.2), (deep / 2.0 + 0.1, 1.2, 0.8))
    door = box((-1.2, -2.2 - deep / 2.0, -0.3), (0.45, deep / 2.0 + 0.1, 1.0))
    found = fitted(Place((CLEAN, window, door)), drawn_wrong(CLEAN, 8), np.array([0.2, 0.3, 0.1]))
    assert wall_errors(CLEAN, found.box).max() < HALF_MILLIMETRE


def test_without_a_ceiling_the_drawn_face_is_kept_and_told() -> None:
    open_top = box((0.0, 0.0, 100.0), (3.0, 2.2, 101.3))
    place = Place((open_top,), (), (0,))
    walls = Place((box((0.0, 0.0, 0.2), (3.0, 2.2, 1.5)),))
    drawn = box((0.1, 0.1, 0.1), (3.2, 2.0, 1.5), 7.0)
    height = 128
    seen = nearness(walls, np.zeros(3), height)
    up = equirect.directions(2 * height, height) * (1.0 / np.maximum(seen, 1e-9))[..., None]
    seen[up[..., 2] > 1.69] = 0.0
    assert place.room.half_extents[2] > 100.0
    found = fit_room("Probe", drawn, seen, np.zeros(3))
    wall = found.walls[5]
    assert not wall.found and found.found == 5 and "nothing is there" in str(wall)
    top = found.box.centre[2] + found.box.half_extents[2]
    assert top == pytest.approx(1.6, abs=1e-6)
    said = " ".join(fit_of("Probe", found, found, drawn).warnings)
    assert "+Z is as drawn: open" in said


def test_an_l_shaped_room_gets_one_of_its_boxes_and_is_told() -> None:
    main, wing = CLEAN, box((4.9, -0.8, 0.0), (2.0, 1.4, 1.3))
    place = Place((main, wing))
    drawn = drawn_wrong(main, 3)
    found = fitted(place, drawn, np.array([1.5, -0.4, 0.0]))
    whole = box((1.95, 0.0, 0.0), (4.95, 2.2, 1.3))
    assert min(wall_errors(each, found.box).max() for each in (main, whole)) < FIVE_MILLIMETRES
    record = fit_of("Probe", found, found, drawn)
    assert record.misfit_after.most > 0.3 and record.misfit_after.beyond > 0.1
    assert any("L-shaped" in line for line in record.warnings)


@pytest.mark.parametrize("degrees", [3.0, 11.0])
@pytest.mark.parametrize("along", [False, True])
def test_a_cabin_that_leans_is_fitted_as_it_leans(degrees: float, along: bool) -> None:
    """Drawn upright, and drawn leaning."""
    place = furnished(CLEAN, 9, 5).turned(about_x(degrees) @ about_z(30.0), (4.0, 2.0, 9.0))
    start = about_x(degrees) @ about_z(12.0) if along else about_z(12.0)
    found = fitted(place, box((4.1, 1.9, 9.1), (3.4, 1.9, 1.5), start), place.room.centre)
    assert found.leaning and wall_errors(place.room, found.box).max() < HALF_MILLIMETRE


def test_a_box_drawn_leaning_in_an_upright_room_is_set_upright() -> None:
    found = fitted(furnished_along(), box((0.1, 0.0, 0.0), (3.3, 2.0, 1.2), about_x(8.0) @ about_z(15.0)), np.zeros(3))
    assert not found.leaning and wall_errors(CLEAN, found.box).max() < HALF_MILLIMETRE


def test_a_capture_point_in_a_cupboard_or_outside_is_told() -> None:
    cupboard = box((2.7, 0.0, -0.3), (0.3, 0.8, 1.0))
    place = Place((CLEAN,), (cupboard,))
    drawn = box((0.0, 0.0, 0.0), (3.0, 2.2, 1.3))
    inside = fitted(place, drawn, np.array([2.75, 0.1, -0.2]))
    assert any("in furniture or outside" in line for line in fit_of("Probe", inside, inside, drawn).warnings)
    garden = Place((box((0.0, 0.0, 0.0), (60.0, 60.0, 20.0)),), (box((9.0, 0.0, 0.0), (3.0, 2.2, 1.3)),), (0,))
    outside = fitted(garden, box((9.0, 0.0, 0.0), (3.0, 2.2, 1.3)), np.array([4.0, 0.0, 0.0]))
    assert any("outside" in line for line in fit_of("Probe", outside, outside, drawn).warnings)


def test_where_nothing_is_seen_the_probe_is_named() -> None:
    with pytest.raises(ProbeError, match=r"probe 'Probe': nothing is seen"):
        fit_room("Probe", CLEAN, np.zeros((64, 128), np.float32), np.zeros(3))


def test_normals_and_areas_are_those_of_the_walls() -> None:
    point = np.array([0.4, -0.3, 0.2])
    cloud = cloud_of(nearness(Place((CLEAN,)), point), point)
    flat = cloud.areas > 0.0
    assert (np.abs(cloud.normals[flat]).max(-1) > 1.0 - 1e-6).mean() > 0.99
    assert flat.mean() > 0.93
    surface = 4.0 * 2.0 * (3.0 * 2.2 + 3.0 * 1.3 + 2.2 * 1.3)
    assert cloud.areas.sum() == pytest.approx(surface, rel=0.15)
    assert cloud.solid_angles.sum() == pytest.approx(4.0 * np.pi)


def test_exits_are_where_rays_leave_the_box() -> None:
    point = np.array([0.4, -0.3, 0.2])
    seen = nearness(Place((CLEAN,)), point)
    cloud = cloud_of(seen, point)
    leaves, walls = exits(CLEAN, cloud)
    assert np.allclose(leaves, cloud.distances, rtol=1e-6)
    assert set(walls) == set(range(6)) and np.array_equal(walls % 2 == 1, cloud.ways[range(len(walls)), walls // 2] > 0)
    missed, _ = exits(box((50.0, 0.0, 0.0), (1.0, 1.0, 1.0)), cloud)
    assert (missed == 0.0).mean() > 0.99 and missed.max() == pytest.approx(50.6, abs=0.5)


def test_misfits_are_distances_along_rays() -> None:
    cloud = cloud_of(nearness(Place((CLEAN,)), np.zeros(3)), np.zeros(3))
    exact = misfit(CLEAN, cloud)
    assert exact.median < 1e-6 and exact.share == 1.0 and exact.beyond == 0.0
    larger = misfit(box((0.0, 0.0, 0.0), 1.1 * CLEAN.half_extents), cloud)
    nearer = 0.1 * cloud.distances < larger.median
    assert cloud.solid_angles[nearer].sum() == pytest.approx(2.0 * np.pi, rel=1e-3) and larger.share == 0.0
    assert cloud.solid_angles[0.1 * cloud.distances < larger.most].sum() == pytest.approx(3.6 * np.pi, rel=5e-3)
    assert misfit(box((0.0, 0.0, 0.0), 0.9 * CLEAN.half_extents), cloud).beyond == 1.0
    half = replace(cloud, distances=np.where(cloud.ways[:, 2] > 0.0, FAR, cloud.distances))
    assert misfit(CLEAN, half).median < 1e-6, "what sees nothing has no distance"


def choose(place: Place, drawn: Box, offset: tuple[float, float, float] = (0.0, 0.0, 0.0), **settings: object) -> Fit:
    """The fit of a probe with that box and capture offset, without a renderer."""
    spec = ProbeSpec("Probe", drawn, offset, **settings)

    def look(point: np.ndarray) -> Generator[str, None, Fitted]:
        yield "looking"
        return fit_room(spec.name, spec.box, nearness(place, point), point)

    work = chosen(spec, look)
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


def room_with_a_screen() -> Place:
    """What stands in a corner behind the screen sees little of the room."""
    return Place((CLEAN,), (box((1.6, 0.9, 0.0), (0.05, 1.2, 1.2)),))


def test_a_capture_point_behind_furniture_moves_to_where_more_is_seen() -> None:
    place = room_with_a_screen()
    fit = choose(place, CLEAN, (2.4, 1.0, 0.0))
    assert np.linalg.norm(np.subtract(fit.point_after, fit.point_before)) > 1.0
    before, after = (
        seen_share(cloud_of(nearness(place, np.array(point)), np.array(point)), CLEAN)
        for point in (fit.point_before, fit.point_after)
    )
    assert after > before + 0.1
    assert fit.found == 6 and wall_errors(CLEAN, fit.after).max() < HALF_MILLIMETRE
    assert fit.capture_offset == pytest.approx(fit.point_after, abs=1e-4), "this box is at the origin, along the axes"


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(6))
def test_a_suggested_point_is_clear_of_everything(seed: int) -> None:
    place, drawn = one_room(seed, 12)
    random = np.random.default_rng(seed)
    fit = choose(place, drawn, tuple(0.7 * drawn.half_extents * random.uniform(-1.0, 1.0, 3)))
    point = np.array(fit.point_after)
    assert (np.abs(place.room.coordinates(point[None])[0]) < place.room.half_widths).all()
    assert 1.0 / nearness(place, point).max() > (0.25 if fit.point_after != fit.point_before else 0.0)


def test_a_point_that_sees_enough_stays_to_the_last_bit() -> None:
    fit = choose(furnished_along(), drawn_wrong(CLEAN, 1, turn=5.0))
    assert fit.point_after == fit.point_before


def test_from_a_cupboard_the_room_is_found_all_the_same() -> None:
    cupboard = box((2.7, 0.0, -0.3), (0.3, 0.8, 1.0))
    fit = choose(Place((CLEAN,), (cupboard,)), box((0.2, 0.0, 0.1), (3.3, 2.0, 1.4), 8.0), (2.5, 0.0, -0.3))
    assert fit.found == 6 and wall_errors(CLEAN, fit.after).max() < HALF_MILLIMETRE
    assert any("was in furniture" in line for line in fit.warnings)


def test_what_follows_an_object_keeps_its_capture_point() -> None:
    fit = choose(room_with_a_screen(), CLEAN, (0.1, 0.0, 0.0), followed=(2.4, 1.0, 0.0))
    assert fit.point_after == fit.point_before == (2.5, 1.0, 0.0)


def test_a_fit_is_told_in_words_and_for_machines() -> None:
    fit = choose(Place((CLEAN,)), box((0.1, 0.0, 0.0), (3.3, 2.0, 1.4), 8.0))
    assert headline(fit) == (
        "box 6.600 × 4.000 × 2.800 m → 6.000 × 4.400 × 2.600 m, moved by 0.100 m, turned by 8.00°; 6 of 6 walls found"
    )
    said = "\n".join(lines(fit))
    assert "misfit after: median 0.0000 m, 90 % within 0.000 m, 100% within 1 cm" in said and "wall -Y found" in said
    assert "capture point (0.10, 0.00, 0.00) stays" in said
    whole = json.loads(json.dumps(record(fit)))
    assert whole["after"]["half_extents"] == pytest.approx([3.0, 2.2, 1.3]) and len(whole["walls"]) == 6
    moved = {wall["name"]: wall["moved"] for wall in whole["walls"]}
    assert moved["+X"] == pytest.approx(-0.4, abs=1e-3) and moved["-X"] == pytest.approx(-0.2, abs=1e-3)


def test_axes_are_named_whatever_they_are_turned_by() -> None:
    random = np.random.default_rng(7)
    for _ in range(200):
        frame, start = (np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in range(2))
        named = named_after(frame, start)
        assert 1 <= len(named) <= 2
        for axes in named:
            assert np.linalg.det(axes) * np.linalg.det(start) > 0.0
            assert np.allclose(np.sort(np.abs(axes.T @ frame), axis=1), [0.0, 0.0, 1.0])
    assert np.allclose(named_after(about_z(90.0 + 10.0), np.eye(3))[0], about_z(10.0))
