"""Faces that nothing can look up are not rendered, missing ones are added, and none is ever missing in silence."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake import capture
from pcc_addon.blender.bake.job import BakedProbe, BakeJob
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.probes import bake_record
from pcc_addon.blender.rendering import Renderer, RenderSettings, render
from pcc_addon.blender.shade.by_hand import group_for
from pcc_addon.blender.status import ProbeStatus, stale_probes, statuses
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.core.cubemap import FACE_NAMES
from pcc_addon.core.probe import Engine
from sample_blends.scenes import principled
from tests.blender.helpers import ROOM, bake, paint_wall, picture, put_in, save, small_probe, small_room

WITHOUT_BELOW = ("+X", "-X", "+Y", "-Y", "+Z")
NEEDED = "its face -Z is not captured and needed now; bake it again"
together = pytest.mark.skipif(bpy.app.version < (5, 0), reason="4.5 cannot read the file of one view: one by one there")


@pytest.fixture
def rendered(monkeypatch) -> list[str]:
    """The faces that are rendered one by one."""
    calls, once = [], Renderer.picture

    def counted(self: Renderer, what: str, *rest: object) -> object:
        calls.append(what.rpartition(" ")[2])
        return once(self, what, *rest)

    monkeypatch.setattr(Renderer, "picture", counted)
    return calls


@pytest.fixture
def hall(scene, monkeypatch) -> bpy.types.Object:
    """The probe of a room that a lamp lights with noise, with a mirror for a floor; faces are rendered one by one."""
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 0)
    return lit_hall()


def lit_hall() -> bpy.types.Object:
    probe = small_room()
    probe.pcc_probe.resolution, probe.pcc_probe.samples = 32, 4
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location = ROOM.world(0.5, 0.5, 0.5)
    bpy.context.scene.collection.objects.link(lamp)
    bpy.context.view_layer.update()
    return probe


def add_ball(probe: bpy.types.Object) -> bpy.types.Object:
    """A mirror ball that the probe's capture does not see."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, segments=12, ring_count=6, location=ROOM.world(0.4, 0.0, -0.3))
    ball = bpy.context.object
    ball.name = "Ball"
    ball.data.shade_smooth()
    ball.data.materials.append(principled("Ball", Roughness=0.0, Metallic=1.0))
    probe.pcc_probe.hidden_objects.add().object = ball
    bpy.context.view_layer.update()
    return ball


def planned() -> tuple[str, ...]:
    return plan_scene(bpy.context.scene, bpy.context.view_layer).probes[0].faces


def found() -> list[ProbeStatus]:
    return statuses(bpy.context.scene, bpy.context.view_layer)


def bake_stale(*probes: bpy.types.Object) -> list[BakedProbe]:
    scene = bpy.context.scene
    stale = stale_probes(scene, bpy.context.view_layer, probes)
    return BakeJob(scene, bpy.context.view_layer, stale, bake_folder(scene), reuse=True).run()


def bake_everything(*probes: bpy.types.Object) -> None:
    for probe in probes:
        probe.pcc_probe.effects.faces = "ON"
    bake(*probes)
    for probe in probes:
        probe.pcc_probe.effects.faces = "AUTO"


def levels_of(probe: bpy.types.Object) -> dict[float, np.ndarray]:
    return {level.roughness: picture(probe, level.roughness).copy() for level in probe.pcc_probe.levels}


def below(height: int = 64) -> np.ndarray:
    """(h, 2h) bool: the texels of face -Z."""
    from pcc_addon.core import equirect

    d = equirect.directions(2 * height, height)
    return (d[..., 2] < 0.0) & (np.abs(d[..., 2]) > np.abs(d[..., :2]).max(-1))


def test_a_face_that_a_floor_cannot_mirror_is_not_rendered_but_guessed(hall, rendered) -> None:
    assert planned() == WITHOUT_BELOW
    [result] = bake(hall)
    assert result.error is None and tuple(rendered) == result.faces == WITHOUT_BELOW
    assert str(result).startswith("'Probe', 5 of 6 faces, in ")
    assert bake_record(hall).faces == WITHOUT_BELOW
    assert found() == [ProbeStatus("Probe", "baked")]
    five = picture(hall).copy()
    bake_everything(hall)
    assert rendered[5:] == list(FACE_NAMES) and bake_record(hall).faces == FACE_NAMES
    six = picture(hall)
    assert len(np.unique(five[below()], axis=0)) == 1 and len(np.unique(six[below()], axis=0)) > 1
    assert np.array_equal(five[~below()], six[~below()])


@pytest.mark.heavy
def test_what_a_floor_shows_is_the_same_to_the_last_digit(hall) -> None:
    """From low and high, near and far, with the roughness of a level that mixes in what lies a little aside."""
    node = next(n for n in bpy.data.materials["Floor"].node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    camera.data.lens = 12.0
    hall.pcc_probe.resolution = 128
    hall.pcc_probe.capture_offset.z = -0.3
    for roughness in (0.0, 0.02):
        node.inputs["Roughness"].default_value = roughness
        bpy.context.view_layer.update()
        assert planned() == WITHOUT_BELOW
        shown = {}
        for faces in (5, 6):
            bake(hall) if faces == 5 else bake_everything(hall)
            assert len(bake_record(hall).faces) == faces and put_in().notes == ()
            for place in ((0.8, -0.8, -0.9), (-0.9, 0.9, 0.8), (0.0, 0.0, -0.5)):
                camera.location = ROOM.world(*place)
                track(camera, ROOM.world(0.1, 0.1, -1.0))
                shown[faces, place] = render(bpy.context.scene, RenderSettings(Engine.CYCLES, 4, False, 48, 32)).pixels
        for (faces, place), pixels in shown.items():
            difference = np.abs(pixels - shown[6, place])
            assert difference.max() <= 1e-5 * pixels.max(), (faces, place)
            assert pixels.std() > 0.05


def track(camera: bpy.types.Object, target: tuple[float, float, float]) -> None:
    from mathutils import Vector

    way = Vector(target) - camera.location
    camera.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
    bpy.context.view_layer.update()


@pytest.mark.parametrize("saved", [False, True], ids=["packed", "files"])
def test_a_face_that_is_needed_now_is_added_and_all_is_as_if_baked_at_once(
    hall, rendered, tmp_path: Path, saved: bool
) -> None:
    if saved:
        save(tmp_path / "hall.blend")
    bake(hall)
    add_ball(hall)
    assert planned() == FACE_NAMES
    [status] = found()
    assert status.state == "stale" and status.why == f"{NEEDED}, which then renders nothing else"
    rendered.clear()
    [result] = bake_stale(hall)
    assert result.error is None and rendered == ["-Z"] and result.faces == ("-Z",)
    assert bake_record(hall).faces == FACE_NAMES and found() == [ProbeStatus("Probe", "baked")]
    completed, record = levels_of(hall), bake_record(hall)
    rendered.clear()
    bake(hall)
    assert rendered == list(FACE_NAMES)
    again = levels_of(hall)
    assert len(completed) == len(again) == 8
    assert all(np.array_equal(completed[roughness], again[roughness]) for roughness in again)
    assert record.content_hash == bake_record(hall).content_hash and record.seconds > result.seconds


def test_a_bake_of_all_renders_all_that_is_planned(hall, rendered) -> None:
    bake(hall)
    rendered.clear()
    bake(hall)
    assert tuple(rendered) == WITHOUT_BELOW
    rendered.clear()
    assert bake_stale(hall) == [] and rendered == []


def another_scene(probe: bpy.types.Object) -> None:
    paint_wall()


def another_blender(probe: bpy.types.Object) -> None:
    probe.pcc_probe.bake_record = replace(bake_record(probe), blender="1.0").to_json()


def another_addon(probe: bpy.types.Object) -> None:
    probe.pcc_probe.bake_record = replace(bake_record(probe), addon="0.0.1").to_json()


def torn_picture(probe: bpy.types.Object) -> None:
    probe.pcc_probe.levels[0].image = None


def another_picture(probe: bpy.types.Object) -> None:
    probe.pcc_probe.levels[0].image = bpy.data.images.new("Other", 128, 64, float_buffer=True)


def damaged_record(probe: bpy.types.Object) -> None:
    probe.pcc_probe.bake_record = "{"


@pytest.mark.sweep
@pytest.mark.parametrize(
    "change", [another_scene, another_blender, another_addon, torn_picture, another_picture, damaged_record]
)
def test_faces_are_taken_over_only_where_they_are_what_would_be_rendered(hall, rendered, change) -> None:
    bake(hall)
    add_ball(hall)
    change(hall)
    rendered.clear()
    [result] = bake_stale(hall)
    assert result.error is None and rendered == list(FACE_NAMES)
    assert picture(hall)[below()].mean() > 0.01


def test_what_needs_fewer_faces_than_it_has_is_fresh(hall, rendered) -> None:
    bake_everything(hall)
    assert planned() == WITHOUT_BELOW and found() == [ProbeStatus("Probe", "baked")]
    rendered.clear()
    assert bake_stale(hall) == []


def test_an_injection_that_shows_a_missing_face_says_so(hall) -> None:
    bake(hall)
    assert put_in().notes == ()
    add_ball(hall)
    assert put_in().notes == (f"probe 'Probe': {NEEDED}",)
    bake_stale(hall)
    assert put_in().notes == ()


def test_a_picture_that_a_smaller_box_shows_from_outside_lacks_a_face(hall) -> None:
    bake(hall)
    hall.scale.x *= 0.3
    hall.location.x += 1.2
    bpy.context.view_layer.update()
    assert f"probe 'Probe': {NEEDED}" in put_in().notes


def test_a_shader_by_hand_looks_any_way(hall) -> None:
    bake(hall)
    group = group_for(hall)
    assert planned() == WITHOUT_BELOW, "nothing uses it"
    material = principled("Own")
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    assert planned() == FACE_NAMES
    [status] = found()
    assert status.state == "stale" and "face -Z" in status.why
    node.node_tree = None
    group.user_clear()
    assert planned() == WITHOUT_BELOW


def test_a_window_looks_any_way(hall) -> None:
    bake(hall)
    assert bpy.ops.pcc.interior_add(probes="Probe") == {"FINISHED"}
    assert planned() == FACE_NAMES


def test_operators_that_show_a_probe_any_way_name_what_is_missing(hall, capfd) -> None:
    bake(hall)
    floor = bpy.data.objects["Wall -Z"]
    bpy.context.view_layer.objects.active = floor
    bpy.ops.pcc.node_add(probe="Probe")
    assert f"probe 'Probe': {NEEDED}" in capfd.readouterr().out
    bake_stale(hall)
    bpy.ops.pcc.node_add(probe="Probe")
    assert NEEDED not in capfd.readouterr().out


def test_every_face_that_is_rendered_is_a_step(hall) -> None:
    add_ball(hall).hide_render = True
    bpy.context.view_layer.update()
    job = BakeJob(bpy.context.scene, bpy.context.view_layer, [hall], None)
    messages, progress = [], []
    while job.step():
        messages.append(job.message)
        progress.append(job.progress)
    assert [m.removeprefix("Probe: face ") for m in messages if "face" in m] == list(WITHOUT_BELOW)
    assert progress == sorted(progress) and progress[-1] == pytest.approx(1.0)


def test_frames_have_all_faces(hall, rendered, tmp_path: Path) -> None:
    save(tmp_path / "hall.blend")
    assert planned() == WITHOUT_BELOW
    assert bpy.ops.pcc.bake(scope="ALL", frames="1-2") == {"FINISHED"}
    assert rendered == list(FACE_NAMES) and bake_record(hall).faces == FACE_NAMES
    assert planned() == FACE_NAMES


@together
def test_faces_of_many_probes_in_one_render_are_those_that_are_planned(scene, monkeypatch) -> None:
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 10**9)
    probe, nested = small_room(), small_probe("Nested", capture_offset=(0.0, 0.0, -0.2))
    far = small_probe("Far", location=(100.0, 0.0, 0.0))
    for each in (probe, nested, far):
        each.pcc_probe.resolution, each.pcc_probe.samples = 32, 16
    bpy.context.view_layer.update()
    wanted = {each.probe: each.faces for each in plan_scene(scene, bpy.context.view_layer).probes}
    assert [len(wanted[name]) for name in ("Probe", "Nested", "Far")] == [5, 5, 6]
    views, seen = Renderer.views, []

    def counted(self: Renderer, what: str, cameras: list) -> list[np.ndarray]:
        seen.append(len(cameras))
        return views(self, what, cameras)

    monkeypatch.setattr(Renderer, "views", counted)
    results = bake(probe, nested, far)
    assert seen == [16]
    assert {result.probe: result.faces for result in results} == wanted
    at_once = [picture(each).copy() for each in (probe, nested, far)]
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 0)
    bake(probe, nested, far)
    for each, before in zip((probe, nested, far), at_once, strict=True):
        assert np.abs(picture(each) - before).mean() < 0.01
