"""Moving a probe's walls and capture point, whatever turns, parents and scales it."""

from __future__ import annotations

from itertools import product

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from pcc_addon.blender import reshaping
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.core.dragging import LEAST, Wall
from tests.blender.helpers import pretend_bake, small_probe

WALLS = [Wall(axis, high) for axis, high in product(range(3), (False, True))]


def plain() -> bpy.types.Object:
    return small_probe(rotation=(0.2, -0.3, 0.7), capture_offset=(0.3, 0.2, -0.1))


def parented() -> bpy.types.Object:
    """Within a parent that is turned and scaled unevenly, so that the box leans as a parallelepiped."""
    probe = plain()
    parent = bpy.data.objects.new("House", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.matrix_world = Matrix.LocRotScale((1.0, 2.0, 0.5), Matrix.Rotation(0.4, 3, "X"), (1.5, 0.7, 1.0))
    probe.parent, probe.matrix_parent_inverse = parent, Matrix.Translation((0.0, 0.4, 0.0))
    return probe


def mirrored() -> bpy.types.Object:
    probe = plain()
    probe.scale.x *= -1.0
    return probe


def resized() -> bpy.types.Object:
    """Its drawn size is another, and it has delta transforms."""
    probe = plain()
    probe.empty_display_size, probe.delta_scale, probe.delta_location = 0.5, (2.0, 1.0, 3.0), (0.3, 0.0, 0.0)
    return probe


def following() -> bpy.types.Object:
    probe = plain()
    probe.pcc_probe.follow = bpy.data.objects.new("Car", None)
    bpy.context.scene.collection.objects.link(probe.pcc_probe.follow)
    return probe


KINDS = [plain, parented, mirrored, resized, following]


@pytest.mark.parametrize("wall", WALLS, ids=str)
@pytest.mark.parametrize("kind", KINDS)
def test_the_opposite_wall_the_capture_point_and_the_reach_stay(scene, kind, wall: Wall) -> None:
    probe = kind()
    bpy.context.view_layer.update()
    start = reshaping.before(probe)
    assert reshaping.move_wall(probe, start, wall, 0.5) == 0.5
    bpy.context.view_layer.update()
    before, after = start.spec, probe_spec(probe)
    along = before.box.axes[:, wall.axis] * wall.sign
    assert after.box.centre - after.box.axes[:, wall.axis] * wall.sign == pytest.approx(
        before.box.centre - along, abs=1e-5
    )
    moved = 0.5 * along / np.linalg.norm(along)
    expected = before.box.centre + along + moved
    assert after.box.centre + after.box.axes[:, wall.axis] * wall.sign == pytest.approx(expected, abs=1e-5)
    others = [axis for axis in range(3) if axis != wall.axis]
    assert after.box.axes[:, others] == pytest.approx(before.box.axes[:, others], abs=1e-5)
    assert after.capture_point == pytest.approx(before.capture_point, abs=1e-5)
    assert after.influence == before.influence
    assert tuple(probe.rotation_euler) == pytest.approx((0.2, -0.3, 0.7), abs=1e-7)


def test_a_wall_stops_before_the_opposite_one(scene) -> None:
    probe = plain()
    start = reshaping.before(probe)
    gone = reshaping.move_wall(probe, start, WALLS[0], -100.0)
    bpy.context.view_layer.update()
    assert gone == pytest.approx(LEAST - 2.0 * start.spec.box.half_extents[0])
    assert probe_spec(probe).box.half_extents[0] == pytest.approx(0.5 * LEAST, rel=0.01)


@pytest.mark.parametrize("wall", WALLS, ids=str)
def test_the_influence_moves_alone(scene, wall: Wall) -> None:
    probe = parented()
    bpy.context.view_layer.update()
    start = reshaping.before(probe)
    reach = Wall(wall.axis, wall.high, influence=True)
    reshaping.move_wall(probe, start, reach, 0.4)
    after = probe_spec(probe)
    assert after.box == start.spec.box and tuple(after.capture_point) == tuple(start.spec.capture_point)
    change = np.array([after.influence.low, after.influence.high])
    assert change[int(wall.high), wall.axis] == pytest.approx(0.4) and change.sum() == pytest.approx(0.4)
    reshaping.move_wall(probe, start, reach, -100.0)
    left = probe_spec(probe)  # which refuses an influence without size
    width = 2.0 * left.box.half_widths[wall.axis] + left.influence.low[wall.axis] + left.influence.high[wall.axis]
    assert width == pytest.approx(LEAST, rel=0.01)


def test_what_is_restored_is_what_was(scene) -> None:
    probe = parented()
    bpy.context.view_layer.update()
    start = reshaping.before(probe)
    for wall in (*WALLS, Wall(0, True, influence=True)):
        reshaping.move_wall(probe, start, wall, 0.3)
    reshaping.move_capture_point(probe, start, (0.1, 0.2, 0.3))
    reshaping.restore(probe, start)
    bpy.context.view_layer.update()
    assert probe_spec(probe) == start.spec


def test_operators_move_what_is_typed(scene) -> None:
    probe = plain()
    bpy.context.view_layer.objects.active = probe
    before = probe_spec(probe)
    assert bpy.ops.pcc.drag_wall(axis=2, high=True, metres=0.5) == {"FINISHED"}
    assert bpy.ops.pcc.drag_wall(axis=0, high=False, influence=True, metres=0.25) == {"FINISHED"}
    assert bpy.ops.pcc.drag_capture_point(by=(0.0, 0.1, 0.0)) == {"FINISHED"}
    bpy.context.view_layer.update()
    after = probe_spec(probe)
    assert after.box.half_extents[2] == pytest.approx(before.box.half_extents[2] + 0.25)
    assert after.influence.low[0] == pytest.approx(0.25)
    assert after.capture_offset == pytest.approx((0.3, 0.3, -0.1 - 0.25))


def test_operators_say_why_they_cannot_run(scene) -> None:
    with pytest.raises(RuntimeError, match="no parallax probe"):
        bpy.ops.pcc.drag_wall(axis=0, high=True, metres=1.0)


def test_a_capture_point_that_was_moved_counts_from_the_next_bake(scene) -> None:
    probe = plain()
    assert not reshaping.captured_elsewhere(probe), "it has no bake"
    pretend_bake(probe)
    assert not reshaping.captured_elsewhere(probe)
    start = reshaping.before(probe)
    reshaping.move_wall(probe, start, WALLS[0], 0.5)
    bpy.context.view_layer.update()
    assert not reshaping.captured_elsewhere(probe), "the box moved alone"
    probe.pcc_probe.capture_offset[1] += 0.01
    assert reshaping.captured_elsewhere(probe)
    pretend_bake(probe)
    assert not reshaping.captured_elsewhere(probe)
