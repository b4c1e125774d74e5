"""Placing a probe in scenes: on the walls of what is selected, of the room around the cursor, or at the cursor."""

from __future__ import annotations

import math
import shutil
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

from pcc_addon.blender.placing import room_box, selection_box
from pcc_addon.blender.placing import stands_in_room as stands_in
from pcc_addon.core.probe import Box
from sample_blends.scenes import Room, add_box, principled
from sample_blends.two_rooms import DOORWAY_Y, LOUNGE, STUDY, WHOLE, two_rooms
from tests.blender.helpers import ROOM, small_room
from tests.core.rooms import box, wall_errors

LIVING_ROOM = Path(__file__).resolve().parents[3] / "shared" / "scenes" / "living_room.blend"
TRUE = box(ROOM.centre, ROOM.half_extents)
MILLIMETRE = 1e-3
THICK = 0.2


def room_around(point: tuple[float, float, float]) -> Box | None:
    bpy.context.view_layer.update()
    return room_box(bpy.context.view_layer, Vector(point))


def around_selection(*objects: bpy.types.Object) -> Box | None:
    bpy.context.view_layer.update()
    return selection_box(bpy.context.scene, bpy.context.view_layer, objects)


def at(x: float, y: float, z: float) -> tuple[float, float, float]:
    """A place in the room, by shares of its half extents."""
    return tuple(c + h * s for c, h, s in zip(ROOM.centre, ROOM.half_extents, (x, y, z), strict=True))


def turn_all(degrees: float) -> None:
    """Turn the whole scene about the vertical axis of the world, and leave no object turned."""
    turn = Matrix.Rotation(math.radians(degrees), 4, "Z")
    for item in bpy.context.scene.objects:
        if item.type == "MESH":
            item.data.transform(turn @ item.matrix_world)
            item.matrix_world = Matrix()


def thing(name: str, centre: Sequence[float], half: Sequence[float]) -> bpy.types.Object:
    """A box along the world's axes."""
    return add_box(Room((1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 0.0), name, tuple(centre), tuple(half), principled(name))


def slabs() -> list[bpy.types.Object]:
    """The room's six walls as boxes that are 20 cm thick."""
    made = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            centre, half = list(ROOM.centre), [h + THICK for h in ROOM.half_extents]
            centre[axis] += sign * (ROOM.half_extents[axis] + 0.5 * THICK)
            half[axis] = 0.5 * THICK
            made.append(thing(f"Slab {axis} {sign}", centre, half))
    return made


@pytest.mark.parametrize("place", [(0, 0, 0), (0, 0, -1), (0.9, -0.9, -1), (0, 0, 1), (-0.8, 0.3, 0.2)])
def test_the_room_is_found_from_its_floor_its_ceiling_and_its_corners(scene, place) -> None:
    small_room()
    assert wall_errors(TRUE, room_around(at(*place))).max() < MILLIMETRE


def test_the_turn_of_a_room_is_found_where_no_object_has_it(scene) -> None:
    small_room()
    bpy.context.view_layer.update()
    turn_all(24.0)
    turn = np.array(Matrix.Rotation(math.radians(24.0), 3, "Z"))
    found = room_around(tuple(turn @ np.array(at(0.2, 0.2, -1))))
    assert wall_errors(box(turn @ np.array(ROOM.centre), ROOM.half_extents, 24.0), found).max() < MILLIMETRE


def test_under_a_table_the_room_is_found_and_not_the_table(scene) -> None:
    small_room()
    thing("Table", at(0.0, 0.0, -0.4), (0.8, 0.8, 0.03))
    assert wall_errors(TRUE, room_around(at(0.0, 0.0, -1.0))).max() < MILLIMETRE


@pytest.mark.parametrize("hidden", ["hide_render", "display_type"])
def test_what_renders_do_not_show_is_no_wall(scene, hidden: str) -> None:
    small_room()
    cutter = thing("Cutter", ROOM.centre, (0.9, 0.9, 0.9))
    assert wall_errors(TRUE, room_around(at(0, 0, 0.1))).max() > 0.1, "it is in the way"
    setattr(cutter, hidden, True if hidden == "hide_render" else "WIRE")
    assert wall_errors(TRUE, room_around(at(0, 0, 0.1))).max() < MILLIMETRE


def test_nothing_around_and_a_floor_alone_are_no_room(scene) -> None:
    assert room_around((0.0, 0.0, 0.0)) is None
    thing("Ground", (0.0, 0.0, -0.1), (50.0, 50.0, 0.1))
    assert room_around((0.0, 0.0, 0.0)) is None


def test_a_room_without_a_ceiling_is_as_high_as_its_walls(scene) -> None:
    small_room()
    bpy.data.objects["Wall +Z"].hide_set(True)
    found = room_around(at(0.1, 0.2, -1))
    assert wall_errors(TRUE, found).max() < 0.1


def test_walls_without_thickness_lie_on_the_box(scene) -> None:
    small_room()
    walls = [item for item in scene.objects if item.name.startswith("Wall")]
    assert wall_errors(TRUE, around_selection(*walls)).max() < MILLIMETRE


def test_of_thick_walls_the_inner_sides_lie_on_the_box(scene) -> None:
    assert wall_errors(TRUE, around_selection(*slabs())).max() < MILLIMETRE


def test_a_thing_has_its_bounds(scene) -> None:
    crate = thing("Crate", (1.0, 2.0, 3.0), (1.0, 0.5, 0.25))
    assert wall_errors(box((1.0, 2.0, 3.0), (1.0, 0.5, 0.25)), around_selection(crate)).max() < MILLIMETRE


@pytest.mark.parametrize("agree", [True, False])
def test_the_axes_are_those_of_the_active_object_where_the_others_have_them_too(scene, agree: bool) -> None:
    one = thing("One", (0.0, 0.0, 0.0), (1.0, 0.5, 0.25))
    other = thing("Other", (0.0, 0.0, 2.0), (1.0, 0.5, 0.25))
    one.rotation_euler.z = math.radians(30.0)
    other.rotation_euler.z = math.radians(30.0 + (90.0 if agree else 10.0))
    bpy.context.view_layer.objects.active = one
    found = around_selection(one, other)
    turn = math.degrees(math.atan2(found.axes[1, 0], found.axes[0, 0]))
    assert turn == pytest.approx(30.0 if agree else 0.0, abs=1e-4)


def test_lamps_and_empties_have_no_size(scene) -> None:
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    empty = bpy.data.objects.new("Empty", None)
    for item in (lamp, empty):
        scene.collection.objects.link(item)
    assert around_selection(lamp, empty) is None and around_selection() is None


@pytest.mark.skipif(not LIVING_ROOM.is_file(), reason="the living room is not here")
@pytest.mark.parametrize("place", [(0.1, 0.2, 0.0), (-0.5, -0.4, -1.0), (0.7, 0.6, -0.9)])
def test_the_living_room_which_is_turned_by_24_degrees_is_found(scene, tmp_path: Path, place) -> None:
    path = tmp_path / "room.blend"
    shutil.copyfile(LIVING_ROOM, path)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    true = box((12.0, -7.5, 1.8), (4.0, 3.0, 1.4), 24.0)
    found = room_around(tuple(true.centre + true.axes @ np.array(place)))
    assert wall_errors(true, found).max() < MILLIMETRE


def stands_in_room(*objects: bpy.types.Object, eye: Vector | None = None) -> bool:
    found = around_selection(*objects)
    return stands_in(bpy.context.scene, bpy.context.view_layer, objects, found, eye)


def test_furniture_stands_in_a_room_and_walls_do_not(scene) -> None:
    small_room()
    chair = thing("Chair", at(0.3, 0.2, -0.7), (0.2, 0.2, 0.2))
    walls = [item for item in scene.objects if item.name.startswith("Wall")]
    assert stands_in_room(chair) and not stands_in_room(*walls) and not stands_in_room(*walls, chair)
    assert not stands_in_room(bpy.data.objects["Wall -Z"]), "a floor alone"


def test_what_one_looks_out_of_is_a_room_by_itself(scene) -> None:
    small_room()
    case = thing("Showcase", at(0.3, 0.2, -0.5), (0.3, 0.3, 0.3))
    assert stands_in_room(case, eye=Vector(ROOM.centre)) and not stands_in_room(case, eye=case.location.copy())
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = case.location
    scene.collection.objects.link(camera)
    assert not stands_in_room(case)


def test_a_thing_in_the_open_is_in_no_room(scene) -> None:
    assert not stands_in_room(thing("Crate", (1.0, 2.0, 3.0), (1.0, 0.5, 0.25)))


@pytest.mark.sweep
@pytest.mark.parametrize("beyond", [0.15, 0.3, 0.6, 1.5])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_near_a_doorway_the_room_is_that_of_the_point(scene, beyond: float, sign: float) -> None:
    two_rooms(doorway=True)
    room = STUDY if sign > 0 else LOUNGE
    point = WHOLE.world(sign * beyond, DOORWAY_Y, -1.3)
    true = box(room.centre, room.half_extents, math.degrees(room.turn))
    assert wall_errors(true, room_around(tuple(point))).max() < MILLIMETRE
