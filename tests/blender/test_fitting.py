"""Fitting probes in Blender: what is found in real scenes, and that a probe takes it whatever holds it."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from pcc_addon.blender.fitting import FitJob, FittedProbe, apply_fit
from pcc_addon.blender.read.probes import all_probes, probe_spec
from pcc_addon.core.errors import ProbeError
from pcc_addon.core.probe import Box, Correction
from sample_blends.scenes import EMISSIVE_ROOM, add_box, emissive_room, principled
from tests.blender.helpers import ROOM, glow, small_probe, small_room
from tests.blender.snapshots import settled
from tests.core.rooms import box, drawn_wrong, wall_errors

LIVING_ROOM = Path(__file__).resolve().parents[3] / "shared" / "scenes" / "living_room.blend"
MILLIMETRE = 1e-3
TRUE = box(ROOM.centre, ROOM.half_extents)


def fit(*probes: bpy.types.Object) -> list[FittedProbe]:
    return FitJob(bpy.context.scene, bpy.context.view_layer, probes).run()


def draw(probe: bpy.types.Object, drawn: Box) -> bpy.types.Object:
    """Give a probe a box, as an artist draws it."""
    probe.matrix_world = Matrix(np.array(drawn.matrix).reshape(4, 4).tolist())
    bpy.context.view_layer.update()
    return probe


def applied(probe: bpy.types.Object) -> Box:
    """The box that a probe has once it is fitted."""
    [result] = fit(probe)
    assert result.error is None
    apply_fit(probe, result.fit, bpy.context.view_layer)
    return probe_spec(probe).box


@pytest.fixture
def drawn(scene) -> bpy.types.Object:
    """A probe drawn wrong in a clean room."""
    return draw(small_room(), drawn_wrong(TRUE, 5))


@pytest.mark.sweep
@pytest.mark.skipif(not LIVING_ROOM.is_file(), reason="the living room is not here")
@pytest.mark.parametrize("seed", range(3))
def test_the_living_room_is_found_to_five_millimetres(scene, tmp_path: Path, seed: int) -> None:
    path = tmp_path / "room.blend"
    shutil.copyfile(LIVING_ROOM, path)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    true = box((12.0, -7.5, 1.8), (4.0, 3.0, 1.4), 24.0)
    straight = box(true.centre, true.half_extents)
    start = drawn_wrong(straight, seed, centre=0.15, turn=0.0)
    bpy.ops.pcc.probe_add(location=start.centre, half_extents=start.half_extents)
    probe = bpy.context.view_layer.objects.active
    bpy.context.view_layer.update()
    before = probe_spec(probe)
    assert wall_errors(true, before.box).max() > 0.5
    found = applied(probe)
    assert wall_errors(true, found).max() < 5 * MILLIMETRE
    assert found.correction is Correction.TURNED_BOX
    [again] = fit(probe)
    assert again.fit.misfit_before.share > 0.6, "of the box that it has now"
    assert np.linalg.norm(np.subtract(again.fit.point_after, again.fit.point_before)) < 1e-3, "nothing better is found"


def test_a_clean_room_is_found_to_a_millimetre_and_has_the_cheapest_lookup(drawn) -> None:
    found = applied(drawn)
    assert wall_errors(TRUE, found).max() < MILLIMETRE
    assert found.correction is Correction.ALIGNED_BOX


def test_a_box_before_a_wall_is_not_the_wall(drawn) -> None:
    add_box(ROOM, "Cupboard", (1.6, 0.2, -0.4), (0.4, 1.0, 0.6), glow("Wood", (0.2, 0.1, 0.0)))
    [result] = fit(drawn)
    assert wall_errors(TRUE, result.fit.after).max() < MILLIMETRE
    assert max(wall.covered for wall in result.fit.walls) > 0.2


def test_what_the_capture_does_not_show_is_not_fitted_to(drawn) -> None:
    """A hidden screen in the middle of the room, and a pane."""
    screen = add_box(ROOM, "Screen", (0.9, 0.0, 0.0), (0.02, 1.5, 1.0), glow("Cloth", (0.2, 0.1, 0.0)))
    pane = add_box(ROOM, "Pane", (-0.9, 0.0, 0.0), (0.02, 1.5, 1.0), principled("Pane", Transmission_Weight=1.0))
    drawn.pcc_probe.hidden_objects.add().object = screen
    assert pane.visible_get() and wall_errors(TRUE, applied(drawn)).max() < MILLIMETRE


@pytest.mark.sweep
@pytest.mark.parametrize("size", [1.0, 0.25])
@pytest.mark.parametrize("mode", ["XYZ", "ZYX", "QUATERNION", "AXIS_ANGLE"])
def test_the_display_size_and_the_way_of_turning_stay(drawn, size: float, mode: str) -> None:
    drawn.rotation_mode, drawn.empty_display_size = mode, size
    drawn.scale = [length / size for length in drawn.scale]
    bpy.context.view_layer.update()
    assert wall_errors(TRUE, applied(drawn)).max() < MILLIMETRE
    assert drawn.empty_display_size == size and drawn.rotation_mode == mode


def test_a_parented_probe_is_fitted_in_the_world(drawn) -> None:
    parent = bpy.data.objects.new("House", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.matrix_world = Matrix.LocRotScale((3.0, 1.0, 0.5), Matrix.Rotation(0.7, 3, "Z"), (1.5, 1.5, 1.5))
    drawn.parent = parent
    drawn.matrix_parent_inverse = Matrix.Translation((0.0, 0.4, 0.0))
    draw(drawn, drawn_wrong(TRUE, 6))
    found = applied(drawn)
    assert wall_errors(TRUE, found).max() < MILLIMETRE and drawn.parent == parent
    capture = probe_spec(drawn).capture_point
    assert (np.abs(TRUE.coordinates(capture[None])[0]) < TRUE.half_widths).all()


def test_a_parent_that_shears_is_refused_and_the_probe_stays(drawn) -> None:
    parent = bpy.data.objects.new("House", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.matrix_world = Matrix.LocRotScale(None, Matrix.Rotation(0.7, 3, "Z"), (2.0, 1.0, 1.0))
    drawn.parent = parent
    bpy.context.view_layer.update()
    drawn.rotation_euler.z = 0.3
    bpy.context.view_layer.update()
    before, offset = drawn.matrix_world.copy(), tuple(drawn.pcc_probe.capture_offset)
    [result] = fit(drawn)
    with pytest.raises(ProbeError, match=r"probe 'Probe': its parents shear it"):
        apply_fit(drawn, result.fit, bpy.context.view_layer)
    assert np.allclose(before, drawn.matrix_world, atol=1e-5) and tuple(drawn.pcc_probe.capture_offset) == offset


def test_animated_and_constrained_probes_are_refused(drawn) -> None:
    other = small_probe("Constrained")
    other.constraints.new("COPY_LOCATION")
    drawn.keyframe_insert("location", frame=1)
    one, two = fit(drawn, other)
    assert "'Probe' or a parent of it is animated" in one.error and "'Constrained'" in two.error


def test_a_probe_that_sees_nothing_is_named_and_others_are_fitted(drawn) -> None:
    lost = small_probe("Lost", location=(500.0, 0.0, 0.0))
    lost.pcc_probe.clip_end = 5.0
    one, two = sorted(fit(lost, drawn), key=lambda result: result.probe)
    assert "probe 'Lost': nothing is seen" in one.error and two.fit.found == 6


def test_a_capture_point_in_a_corner_moves_and_one_that_sees_enough_stays(drawn) -> None:
    add_box(ROOM, "Cupboard", (1.3, 0.6, 0.0), (0.2, 0.6, 0.9), glow("Wood", (0.2, 0.1, 0.0)))
    draw(drawn, box(ROOM.centre, 1.1 * np.array(ROOM.half_extents)))
    drawn.pcc_probe.capture_offset = (1.7, 0.9, 0.0)  # behind the cupboard
    [moved] = fit(drawn)
    assert np.linalg.norm(np.subtract(moved.fit.point_after, moved.fit.point_before)) > 0.5
    drawn.pcc_probe.capture_offset = (-0.3, 0.0, 0.1)
    [stays] = fit(drawn)
    assert stays.fit.point_after == stays.fit.point_before
    apply_fit(drawn, stays.fit, bpy.context.view_layer)
    assert np.allclose(probe_spec(drawn).capture_point, stays.fit.point_before, atol=1e-5)


def test_a_followed_capture_point_stays_where_it_is(drawn) -> None:
    followed = bpy.data.objects.new("Ball", None)
    followed.location = ROOM.world(0.5, 0.3, 0.2)
    bpy.context.scene.collection.objects.link(followed)
    drawn.pcc_probe.follow = followed
    drawn.pcc_probe.capture_offset = (0.1, 0.0, 0.0)
    bpy.context.view_layer.update()
    before = probe_spec(drawn).capture_point
    assert wall_errors(TRUE, applied(drawn)).max() < MILLIMETRE
    assert np.allclose(probe_spec(drawn).capture_point, before, atol=1e-5)


def test_a_probe_with_a_given_picture_is_fitted_from_its_middle(drawn) -> None:
    drawn.pcc_probe.source = "WORLD"
    drawn.pcc_probe.capture_offset = (0.2, 0.0, 0.0)
    [result] = fit(drawn)
    apply_fit(drawn, result.fit, bpy.context.view_layer)
    assert np.allclose(result.fit.point_after, ROOM.centre, atol=1e-3)
    assert tuple(drawn.pcc_probe.capture_offset) == pytest.approx((0.2, 0.0, 0.0))
    assert wall_errors(TRUE, probe_spec(drawn).box).max() < MILLIMETRE


def test_a_fit_leaves_no_trace_until_it_is_applied(drawn) -> None:
    fit(drawn)
    before, place = settled(), drawn.matrix_world.copy()
    fit(drawn)
    assert settled() == before and drawn.matrix_world == place


def test_cancelling_after_any_step_restores_everything(drawn) -> None:
    fit(drawn)
    before = settled()
    reached = []
    for count in range(1, 40):
        work = FitJob(bpy.context.scene, bpy.context.view_layer, [drawn])
        if not all(work.step() for _ in range(count)):
            break
        reached.append((work.progress, work.message))
        work.cancel()
        assert settled() == before
    assert len(reached) > 7 and reached == sorted(reached, key=lambda each: each[0])
    assert any("distance, face" in message for _, message in reached)


def test_the_operator_fits_the_selected_probes_in_one_undo_step(drawn, capfd: pytest.CaptureFixture[str]) -> None:
    other = draw(small_probe("Other"), drawn_wrong(TRUE, 8))
    for item in bpy.context.selected_objects:
        item.select_set(False)
    drawn.select_set(True)
    bpy.ops.ed.undo_push(message="drawn")
    before = {probe.name: probe.matrix_world.copy() for probe in (drawn, other)}
    assert bpy.ops.pcc.fit("EXEC_DEFAULT", True) == {"FINISHED"}
    probes = {probe.name: probe for probe in all_probes(bpy.context.scene)}
    assert wall_errors(TRUE, probe_spec(probes["Probe"]).box).max() < MILLIMETRE
    assert probes["Other"].matrix_world == before["Other"]
    said = capfd.readouterr().out
    assert "'Probe': box" in said and "misfit" in said and "Other" not in said
    bpy.ops.ed.undo()
    assert bpy.data.objects["Probe"].matrix_world == before["Probe"]
    bpy.ops.ed.redo()
    bpy.context.view_layer.update()
    assert wall_errors(TRUE, probe_spec(bpy.data.objects["Probe"]).box).max() < MILLIMETRE


def test_the_operator_says_which_probe_it_cannot_fit(drawn) -> None:
    drawn.select_set(True)
    drawn.keyframe_insert("location", frame=1)
    with pytest.raises(RuntimeError, match="'Probe' or a parent of it is animated"):
        bpy.ops.pcc.fit()
    drawn.animation_data_clear()
    assert bpy.ops.pcc.fit() == {"FINISHED"}


def test_the_operator_needs_a_probe(scene) -> None:
    with pytest.raises(RuntimeError, match="Select a parallax probe"):
        bpy.ops.pcc.fit()


def test_a_room_far_from_the_origin_is_found(scene) -> None:
    emissive_room()
    room = box(EMISSIVE_ROOM.centre, EMISSIVE_ROOM.half_extents, math.degrees(EMISSIVE_ROOM.turn))
    probe = draw(small_probe(), drawn_wrong(room, 2))
    assert wall_errors(room, applied(probe)).max() < MILLIMETRE
