"""Where probes err, asked of real scenes: by the job, the operator and the panel's memory."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from pcc_addon.blender.accuracy.misfit_job import MisfitJob, ProbeMisfit
from pcc_addon.blender.accuracy.surfaces import read_triangles
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.core.accuracy.misfit import Fit, at
from pcc_addon.core.accuracy.sampling import Make
from pcc_addon.core.accuracy.unseen import Part
from pcc_addon.ui.kept import last_misfit
from pcc_addon.ui.viewport import misfit_shapes
from sample_blends.scenes import add_box, principled
from tests.blender.helpers import ROOM, small_probe, small_room
from tests.blender.snapshots import settled

BOTTOM = -ROOM.half_extents[2]


def run(*probes: bpy.types.Object) -> list[ProbeMisfit]:
    return MisfitJob(bpy.context.scene, bpy.context.view_layer, probes).run()


def crate(name: str = "Crate", half=(0.3, 0.2, 0.2), place=(0.0, 0.0), material: str = "Wood") -> bpy.types.Object:
    """A box on the floor."""
    return add_box(ROOM, name, (*place, BOTTOM + half[2]), half, principled(material))


def update() -> None:
    bpy.context.view_layer.update()


def test_an_empty_room_fits_and_is_seen_whole(scene) -> None:
    [result] = run(small_room())
    assert result.error is None
    assert np.abs(result.misfit.offsets).max() < 1e-4 and result.misfit.angles.max() < 1e-4
    assert result.unseen.unseen_area < 2e-4 * result.unseen.area
    assert result.unseen.area == pytest.approx(8.0 * (2.0 * 1.5 + 2.0 * 1.0 + 1.5 * 1.0), rel=1e-3)
    assert result.lines == (
        "The box is on what is seen, within 1 cm, in 100 % of directions",
        "The capture point sees all surfaces in the probe's influence",
    )


def test_a_crate_is_named_with_its_back_and_its_shadow_and_who_may_mirror_it(scene) -> None:
    probe = small_room()
    crate()
    [result] = run(probe)
    parts = {(part.name, part.part): part for part in result.unseen.parts}
    assert parts["Crate", Part.BACK].area == pytest.approx(2.0 * (0.6 + 0.4) * 0.4, rel=0.05)
    assert parts["Wall -Z", Part.HIDDEN].area == pytest.approx(0.6 * 0.4 / 0.6**2, rel=0.08)
    assert parts["Crate", Part.BACK].materials == ("Wood",)
    assert parts["Crate", Part.BACK].facing == ("Wall -Z",)
    assert result.unseen.idle == pytest.approx(0.24, rel=0.05)
    assert "('Crate')" in result.fit_lines[1] and "before the box" in result.fit_lines[1]
    assert at(result.misfit.offsets, np.array([0.0, 0.0, -1.0])) == pytest.approx(-0.4, abs=1e-3)


def test_a_box_that_is_drawn_too_large_is_off_by_that(scene) -> None:
    small_room()
    larger = small_probe("Larger", half_extents=tuple(h + 0.1 for h in ROOM.half_extents))
    [result] = run(larger)
    assert result.misfit.share(Fit.BEFORE).share == pytest.approx(1.0)
    for way in (*np.eye(3), *-np.eye(3)):
        assert at(result.misfit.offsets, way) == pytest.approx(-0.1, abs=1e-3)
    assert "13 cm before the box in 100 %" in result.fit_lines[1]
    assert "'Wall" in result.fit_lines[1]
    assert result.unseen.unseen_area < 1e-3 * result.unseen.area  # walls have no outer side that anything faces


def test_a_survey_of_several_leaves_no_trace_and_tells_how_far_it_is(scene) -> None:
    probe, other = small_room(), small_probe("Other", capture_offset=(0.5, 0.2, 0.1))
    run(probe)  # the first render makes an image
    before = settled()
    job = MisfitJob(scene, bpy.context.view_layer, [probe, other])
    told = [job.progress]
    while job.step():
        told.append(job.progress)
    assert told == sorted(told) and told[-1] < 1.0 == job.progress
    assert [result.probe for result in job.results] == ["Probe", "Other"] and settled() == before


def test_a_cancelled_survey_leaves_no_trace(scene) -> None:
    probe = small_room()
    run(probe)
    before = settled()
    for steps in (1, 3, 8):
        job = MisfitJob(scene, bpy.context.view_layer, [probe])
        for _ in range(steps):
            job.step()
        job.cancel()
        assert settled() == before and job.results == []


def test_probes_without_a_fit_say_why_and_do_not_stop_others(scene) -> None:
    probe = small_room()
    world = small_probe("World")
    world.pcc_probe.source = "WORLD"
    outside = small_probe("Outside", capture_offset=(9.0, 0.0, 0.0))
    errors = {result.probe: result.error for result in run(world, outside, probe)}
    assert "from elsewhere" in errors["World"] and "not inside its box" in errors["Outside"] and errors["Probe"] is None


def test_what_a_capture_does_not_show_is_not_asked_for(scene) -> None:
    probe = small_room()
    for name, settle in (
        ("Off", lambda o: setattr(o, "hide_render", True)),
        ("Camera only", lambda o: setattr(o, "visible_glossy", False)),
        ("Left out", lambda o: setattr(probe.pcc_probe.hidden_objects.add(), "object", o)),
    ):
        settle(crate(name))
    pane = crate("Pane", material="Pane")
    pane.data.materials[0] = principled("Clear", Transmission_Weight=1.0)
    update()
    names = {name for name, _ in read_triangles(probe_spec(probe), bpy.context.view_layer).names}
    assert names == {f"Wall {side}" for side in ("+X", "-X", "+Y", "-Y", "+Z", "-Z")}


def test_a_name_is_found_behind_a_pane(scene) -> None:
    probe = small_room()
    crate(half=(0.3, 0.3, 0.2))
    pane = add_box(ROOM, "Pane", (0, 0, -0.4), (1.0, 1.0, 0.01), principled("Clear", Transmission_Weight=1.0))
    [result] = run(probe)
    assert "'Crate'" in result.fit_lines[1] and pane.name not in result.fit_lines[1]


def test_shapes_of_all_kinds_are_read_and_mirrored_ones_face_out(scene) -> None:
    probe = small_probe()
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=ROOM.centre)
    cube = bpy.context.object
    cube.location.x += 1.0
    cube.scale.x = -1.0
    bpy.ops.object.text_add(location=ROOM.centre)
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.2, location=ROOM.centre)
    bpy.context.object.data.bevel_depth = 0.02
    bpy.ops.object.metaball_add(radius=0.3, location=ROOM.centre)
    empty = bpy.data.objects.new("Copies", None)
    empty.instance_type = "COLLECTION"
    empty.instance_collection = bpy.data.collections.new("Inside")
    made = bpy.data.objects.new("Copied", cube.data)
    made.scale = (0.5, 0.5, 0.5)
    empty.instance_collection.objects.link(made)
    empty.location = ROOM.centre
    scene.collection.objects.link(empty)
    update()
    found = read_triangles(probe_spec(probe), bpy.context.view_layer)
    assert {"Cube", "Text", "BézierCircle", "Mball", "Copied"} <= {
        n.replace("Bezier", "Bézier") for n, _ in found.names
    }
    mine = np.array([name == "Cube" for name, _ in found.names])[found.owners]
    corners = found.corners[mine]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = corners.mean(1) - np.array(ROOM.centre) - (1.0, 0.0, 0.0)
    assert len(corners) == 12 and ((outward * away).sum(-1) > 0.0).all() and (found.makes[mine] == Make.SOLID).all()


def test_the_operator_asks_about_selected_probes_and_keeps_what_it_finds(scene) -> None:
    probe = small_room()
    other = small_probe("Other")
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.pcc.misfit.poll()
    other.select_set(True)
    assert bpy.ops.pcc.misfit() == {"FINISHED"}
    assert last_misfit.of(scene, probe) is None
    last = last_misfit.of(scene, other)
    assert not last.late and last.found.lines[0].startswith("The box is on what is seen")
    other.pcc_probe.source = "WORLD"
    with pytest.raises(RuntimeError, match="from elsewhere"):
        bpy.ops.pcc.misfit()


@pytest.mark.heavy
def test_what_is_known_is_late_after_a_move_and_not_after_a_colour_or_a_camera(scene) -> None:
    probe = small_room()
    box, camera = crate(), bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    update()
    probe.select_set(True)

    def late_after(change) -> bool:
        bpy.ops.pcc.misfit()
        assert not last_misfit.of(scene, probe).late
        change()
        update()
        return last_misfit.of(scene, probe).late

    assert not late_after(lambda: setattr(camera.location, "x", 1.0))
    assert not late_after(lambda: setattr(bpy.data.materials["Wood"], "roughness", 0.3))
    assert not late_after(lambda: probe.select_set(True))
    assert late_after(lambda: setattr(box.location, "x", box.location.x + 0.1))
    assert late_after(lambda: setattr(probe.pcc_probe, "capture_offset", (0.1, 0.0, 0.0)))
    assert late_after(lambda: setattr(probe, "scale", (1.9, 1.5, 1.0)))
    assert late_after(lambda: bpy.data.objects.remove(box))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert not last_misfit._found


def test_a_deleted_probe_is_drawn_no_more(scene) -> None:
    probe = small_room()
    probe.select_set(True)
    bpy.ops.pcc.misfit()
    assert [found.probe for found in last_misfit.all_of(scene)] == ["Probe"]
    bpy.data.objects.remove(probe)
    assert list(last_misfit.all_of(scene)) == []


@pytest.mark.parametrize("mirrored", [False, True])
def test_walls_are_drawn_just_inside_the_box_seen_from_within_in_the_colours_of_pictures(scene, mirrored: bool) -> None:
    probe = small_room()
    crate()
    if mirrored:
        probe.scale.x *= -1.0
        update()
    [result] = run(probe)
    drawn = misfit_shapes.walls(result.misfit)
    box = result.misfit.spec.box
    near = np.abs(box.coordinates(drawn.points.astype(np.float64))) / box.half_widths
    assert near.max(-1) == pytest.approx(0.995, abs=1e-5)
    a, b, c = (drawn.points[drawn.triangles[:, k]].astype(np.float64) for k in range(3))
    assert ((np.cross(b - a, c - a) * (box.centre - a)).sum(-1) > 0.0).all()
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=-1).sum()
    assert area == pytest.approx(8.0 * (2.0 * 1.5 + 2.0 * 1.0 + 1.5 * 1.0) * 0.995**2, rel=1e-4)
    down = np.array([0.0, 0.0, BOTTOM * 0.995])
    floor = np.abs(drawn.points - (ROOM.centre + down)).max(-1).argmin()
    assert drawn.colours[floor, 0] > drawn.colours[floor, 2] + 0.2 and drawn.colours[floor, 3] > 0.7
    ceiling = np.abs(drawn.points - (ROOM.centre - down)).max(-1).argmin()
    assert drawn.colours[ceiling, :3].min() > 0.85 and drawn.colours[ceiling, 3] < 0.2
    assert all(array.flags.c_contiguous for array in (drawn.points, drawn.colours, drawn.triangles))


def test_squares_lie_over_what_is_not_seen_and_face_as_it_does(scene) -> None:
    probe = small_room()
    crate()
    [result] = run(probe)
    drawn, hidden = misfit_shapes.patches(result.misfit, result.unseen), result.unseen
    a, b, c = (drawn.points[drawn.triangles[:, k]].astype(np.float64) for k in range(3))
    ways = np.cross(b - a, c - a)
    count = len(hidden.points)
    assert len(drawn.triangles) == 2 * count and len(drawn.points) == 4 * count
    unit = ways / np.linalg.norm(ways, axis=-1, keepdims=True)
    assert np.allclose(unit, np.tile(hidden.normals, (2, 1)), atol=1e-3)
    assert 0.5 * np.linalg.norm(ways, axis=-1).sum() == pytest.approx(0.36 * hidden.unseen_area, rel=1e-3)
    lifted = drawn.points.reshape(count, 4, 3).mean(1) - hidden.points
    assert (lifted * hidden.normals).sum(-1) == pytest.approx(0.002 * 2.0, abs=1e-4)
