"""Animated probes: which pictures are rendered, what shows them when, what a bake leaves when it ends early."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake import capture
from pcc_addon.blender.bake.job import BakedProbe, BakeJob
from pcc_addon.blender.read.probes import bake_record, hidden_objects, probe_spec
from pcc_addon.blender.shade import by_hand
from pcc_addon.blender.shade.interior import Window, interior_node, room_of_probe, window_material
from pcc_addon.blender.status import ProbeStatus, stale_probes, statuses
from pcc_addon.blender.store.levels import bake_folder, ensure_levels
from pcc_addon.blender.store.pictures import read_file
from pcc_addon.core import equirect
from pcc_addon.core.errors import BakeError
from pcc_addon.core.frames import STILL, FrameRange
from pcc_addon.core.pictures import LADDER
from sample_blends.scenes import principled_node
from tests.blender.helpers import ROOM, bake, contents, put_in, save, small_probe, small_room

TOWARDS_WALL = np.array((1.0, 0.0, 0.0))


def strength() -> bpy.types.NodeSocket:
    """How bright the wall at +X is."""
    return principled_node(bpy.data.materials["Glow +X"]).inputs["Emission Strength"]


def keys(values: Sequence[tuple[int, float]]) -> None:
    """Let the wall have these strengths from these frames on."""
    for frame, value in values:
        strength().default_value = value
        strength().keyframe_insert("default_value", frame=frame)


@pytest.fixture
def blinking(scene: bpy.types.Scene, tmp_path: Path) -> bpy.types.Object:
    """A saved room whose wall is bright, dark from frame 3 on, bright from 5 on; its probe, which nobody has baked."""
    probe = small_room()
    keys([(1, 1.0), (2, 1.0), (3, 0.0), (4, 0.0), (5, 1.0), (9, 1.0)])
    scene.frame_set(1)
    save(tmp_path / "room.blend")
    return probe


def film(probe: bpy.types.Object, frames: FrameRange | str | None = None, reuse: bool = False) -> BakedProbe:
    scene = bpy.context.scene
    [result] = BakeJob(scene, bpy.context.view_layer, [probe], bake_folder(scene), frames, reuse).run()
    return result


def state(name: str = "Probe") -> ProbeStatus:
    return next(s for s in statuses(bpy.context.scene, bpy.context.view_layer) if s.probe == name)


def shown_file(tree: bpy.types.ShaderNodeTree, node: str) -> Path:
    """The file that a node shows at the frame where the scene is, as Blender finds it."""
    node = tree.evaluated_get(bpy.context.evaluated_depsgraph_get()).nodes[node]
    first = Path(bpy.path.abspath(node.image.filepath))
    head = first.name.removesuffix(".0000.exr")
    return first.with_name(f"{head}.{node.image_user.frame_duration + node.image_user.frame_offset:04d}.exr")


def wall_seen(file: Path) -> float:
    return float(equirect.lookup(read_file(file), TOWARDS_WALL).max())


def test_only_frames_that_show_something_new_are_rendered(blinking, renders) -> None:
    result = film(blinking, FrameRange(1, 8))
    assert result.error is None and (result.frames, result.pictures, result.rendered) == ("1-8", 2, 2)
    assert len(renders) == 2 * 6
    record = bake_record(blinking)
    assert [moment.number for moment in record.moments] == [0, 0, 1, 1, 0, 0, 0, 0]
    assert len(record.levels) == 2 * len(LADDER)
    assert {image.source for image in (level.image for level in blinking.pcc_probe.levels)} == {"SEQUENCE"}


@pytest.mark.parametrize("by", ["materials", "hand"])
def test_each_frame_shows_its_picture(blinking, by: str) -> None:
    film(blinking, FrameRange(1, 8))
    put_in()
    tree = blinking.pcc_probe.group
    if by == "hand":
        tree, nodes = by_hand.group_for(blinking), bpy.data.materials["Glow +Y"].node_tree.nodes
        nodes.new("ShaderNodeGroup").node_tree = tree
    for _ in range(2):  # once as built, once as saved
        for frame in (8, 3, 1, 5, 4, 2, -7, 100):
            bpy.context.scene.frame_set(frame)
            bright = wall_seen(shown_file(tree, "Level 0"))
            assert bright == pytest.approx(0.0 if frame in (3, 4) else 1.0, abs=0.02), frame
        name = tree.name
        bpy.ops.wm.save_mainfile()
        bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
        tree = bpy.data.node_groups[name]


def test_between_frames_the_one_before_is_shown(blinking, renders) -> None:
    result = film(blinking, FrameRange(1, 9, 4))  # 1, 5, 9 are bright
    assert (result.frames, result.pictures) == ("1-9:4", 1) and len(renders) == 6
    result = film(blinking, FrameRange(2, 6, 2))  # 2, 4, 6: bright, dark, bright
    assert [moment.number for moment in bake_record(blinking).moments] == [0, 1, 0]
    bpy.context.scene.frame_set(3)
    assert wall_seen(shown_file(blinking.pcc_probe.group, "Level 0")) == pytest.approx(1.0, abs=0.02)


def test_status_names_the_frames_that_changed_and_only_they_are_rendered_again(blinking, renders) -> None:
    film(blinking, FrameRange(1, 8))
    assert (state().state, state().frames) == ("baked", "1-8")
    renders.clear()
    keys([(7, 0.5), (8, 0.5)])
    bpy.context.scene.frame_set(1)
    found = state()
    assert found.state == "stale" and found.stale_frames == (6, 7, 8), "6 lies between the keys of 5 and 7"
    assert "3 of its 8 frames: 6-8" in found.why
    assert stale_probes(bpy.context.scene, bpy.context.view_layer, [blinking]) == [blinking]
    result = film(blinking, reuse=True)
    assert (result.pictures, result.rendered) == (4, 2) and len(renders) == 2 * 6
    assert state().state == "baked"
    bpy.context.scene.frame_set(8)
    assert wall_seen(shown_file(blinking.pcc_probe.group, "Level 0")) == pytest.approx(0.5, abs=0.02)
    bpy.context.scene.frame_set(4)
    assert wall_seen(shown_file(blinking.pcc_probe.group, "Level 0")) == pytest.approx(0.0, abs=0.02)


def test_a_longer_range_renders_only_what_is_new(blinking, renders) -> None:
    film(blinking, FrameRange(1, 2))
    renders.clear()
    assert film(blinking, FrameRange(1, 8), reuse=True).rendered == 1 and len(renders) == 6
    assert stale_probes(bpy.context.scene, bpy.context.view_layer, [blinking], FrameRange(1, 8)) == []
    assert stale_probes(bpy.context.scene, bpy.context.view_layer, [blinking], FrameRange(1, 9)) == [blinking]
    assert stale_probes(bpy.context.scene, bpy.context.view_layer, [blinking], STILL) == [blinking]


def test_a_bake_that_is_no_update_renders_everything(blinking, renders) -> None:
    film(blinking, FrameRange(1, 8))
    renders.clear()
    assert film(blinking).rendered == 2 and len(renders) == 2 * 6, "the frames are those of the last bake"


def test_a_still_takes_the_place_of_a_sequence_and_back(blinking) -> None:
    film(blinking, FrameRange(1, 8))
    bpy.context.scene.frame_set(3)
    result = film(blinking, STILL)
    assert result.frames == "" and bake_record(blinking).moments == ()
    assert {level.image.source for level in blinking.pcc_probe.levels} == {"FILE"}
    drivers = blinking.pcc_probe.group.animation_data
    assert not [c for c in (drivers.drivers if drivers else ()) if c.driver.expression == "frame"]
    assert state().state == "baked"
    assert film(blinking, FrameRange(1, 3)).pictures == 2
    assert {level.image.source for level in blinking.pcc_probe.levels} == {"SEQUENCE"}


def test_what_a_missing_picture_of_a_sequence_makes_stale_is_rendered_again(blinking, renders) -> None:
    film(blinking, FrameRange(1, 8))
    folder = bake_folder(bpy.context.scene)
    level = next(level for level in bake_record(blinking).levels if level.key.number == 1)
    (folder / level.file).unlink()
    assert state().state == "stale" and level.file in state().why
    renders.clear()
    assert film(blinking, reuse=True).rendered == 1 and len(renders) == 6
    assert state().state == "baked"


def test_pictures_of_frames_cannot_be_packed(scene) -> None:
    probe = small_room()
    result = film(probe, FrameRange(1, 3))
    assert "save it first" in result.error and "'Probe'" in result.error
    assert not probe.pcc_probe.bake_record


def test_a_fault_at_one_frame_is_named_with_it_and_leaves_the_old_bake(blinking) -> None:
    film(blinking, FrameRange(1, 2))
    before = blinking.pcc_probe.bake_record
    for frame, scale in ((1, 1.0), (3, 0.0)):
        blinking.scale[0] = scale
        blinking.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)
    result = film(blinking, FrameRange(1, 4))
    assert "zero size along" in result.error and "frame 3" in result.error
    assert blinking.pcc_probe.bake_record == before


@pytest.mark.heavy
def test_cancelling_after_any_step_keeps_the_old_bake_and_the_frame(blinking) -> None:
    film(blinking, FrameRange(1, 4))
    scene, folder = bpy.context.scene, bake_folder(bpy.context.scene)
    scene.frame_set(6, subframe=0.25)
    before, record = contents(folder), blinking.pcc_probe.bake_record
    settings = (scene.render.engine, scene.render.resolution_x, scene.camera, scene.cycles.samples)
    blinking.pcc_probe.resolution = 32
    reached = []
    for count in range(1, 200):
        work = BakeJob(scene, bpy.context.view_layer, [blinking], folder, FrameRange(1, 4))
        if not all(work.step() for _ in range(count)):
            break
        reached.append((work.progress, work.message))
        work.cancel()
        assert (scene.frame_current, scene.frame_subframe) == (6, 0.25), work.message
        assert contents(folder) == before and blinking.pcc_probe.bake_record == record, reached[-1]
        assert settings == (scene.render.engine, scene.render.resolution_x, scene.camera, scene.cycles.samples)
    assert "frame 3, Probe: face -Z" in [message for _, message in reached]
    assert [progress for progress, _ in reached] == sorted(progress for progress, _ in reached)
    assert blinking.pcc_probe.bake_record != record, "the last one was not cancelled"


def test_old_pictures_of_a_sequence_go_together_and_only_when_nobody_shows_them(blinking, tmp_path: Path) -> None:
    blend = tmp_path / "room.blend"
    film(blinking, FrameRange(1, 4))
    save(blend)
    first = set(contents(blend.with_suffix(".pcc")))
    assert len(first) == 2 * len(LADDER) + 1
    blinking.pcc_probe.resolution = 32
    film(blinking, FrameRange(1, 8))
    save(blend)
    assert set(contents(blend.with_suffix(".pcc"))) > first, "the backup shows them"
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    save(blend)
    left = {name for name in contents(blend.with_suffix(".pcc")) if name.endswith(".exr")}
    assert left == {level.file for level in bake_record(bpy.data.objects["Probe"]).levels}
    assert state().state == "baked"


def test_a_level_that_is_missing_is_made_for_all_frames(blinking) -> None:
    film(blinking, FrameRange(1, 4))
    ensure_levels(blinking, [*LADDER, 0.5], bake_folder(bpy.context.scene))
    record = bake_record(blinking)
    assert sum(level.roughness == 0.5 for level in record.levels) == 2
    assert len(record.levels) == 2 * (len(LADDER) + 1) and state().state == "baked"


def test_levels_of_a_sequence_need_all_its_captures(blinking) -> None:
    film(blinking, FrameRange(1, 4))
    before, folder = bake_record(blinking), bake_folder(bpy.context.scene)
    sharp, blurred = (
        next(level for level in before.levels if level.key.number == 1 and level.key.level == k) for k in (0, 1)
    )
    for level in (blurred, sharp):
        (folder / level.file).rename(folder.parent / level.file)
        with pytest.raises(BakeError, match=r"^probe 'Probe': a capture of its sequence is missing; bake it again$"):
            ensure_levels(blinking, [*LADDER, 0.5], folder)
        assert bake_record(blinking) == before
        (folder.parent / level.file).rename(folder / level.file)


def follow_target(scene: bpy.types.Scene) -> bpy.types.Object:
    """A thing with parts that goes through the room."""
    mesh = bpy.data.meshes.new("Thing")
    mesh.from_pydata([(0, 0, 0), (0.2, 0, 0), (0, 0.2, 0)], [], [(0, 1, 2)])
    thing, part = bpy.data.objects.new("Thing", mesh), bpy.data.objects.new("Part", mesh)
    lamp = bpy.data.objects.new("Lamp of Thing", bpy.data.lights.new("Lamp", "POINT"))
    for item in (thing, part, lamp):
        scene.collection.objects.link(item)
    part.parent = lamp.parent = thing
    for frame, x in ((1, -1.0), (3, 1.0)):
        thing.location = ROOM.world(x, 0.5, 0.1)
        thing.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    return thing


def test_a_probe_is_captured_where_what_it_follows_is_and_leaves_it_out(blinking, scene) -> None:
    blinking.pcc_probe.follow = follow_target(scene)
    blinking.pcc_probe.capture_offset = (0.0, 0.0, 0.25)
    assert [item.name for item in hidden_objects(blinking)] == ["Part", "Thing"], "lamps light the room as ever"
    assert probe_spec(blinking).hidden == ("Part", "Thing")
    film(blinking, FrameRange(1, 3))
    points = [moment.capture_point for moment in bake_record(blinking).moments]
    np.testing.assert_allclose([points[0], points[2]], [ROOM.world(x, 0.5, 0.35) for x in (-1.0, 1.0)], atol=1e-5)
    for frame in (3, 1, 2):
        scene.frame_set(frame)
        tree = blinking.pcc_probe.group.evaluated_get(bpy.context.evaluated_depsgraph_get())
        shown = [n.inputs["Capture Point"].default_value for n in tree.nodes if "Capture Point" in n.inputs]
        assert shown, "an offset capture needs its point"
        for value in shown:
            np.testing.assert_allclose(value, points[frame - 1], atol=1e-6)


def test_what_it_follows_does_not_make_frames_new_by_itself(blinking, scene, renders) -> None:
    """Only where it is counts, not what it looks like: it is not in the picture."""
    thing = follow_target(scene)
    thing.animation_data_clear()
    blinking.pcc_probe.follow = thing
    for frame, turn in ((1, 0.0), (3, 1.0)):
        thing.rotation_euler[2] = turn
        thing.keyframe_insert("rotation_euler", frame=frame)
    bpy.data.objects.remove(bpy.data.objects["Lamp of Thing"])  # whose light would be another
    assert film(blinking, FrameRange(1, 2)).rendered == 1


def test_what_viewports_leave_out_is_not_taken_for_standing_still(blinking, scene) -> None:
    thing = blinking.pcc_probe.follow = follow_target(scene)
    thing.hide_set(True)
    assert film(blinking, FrameRange(1, 3)).pictures == 3, "what is only hidden moves"
    thing.hide_viewport = True
    assert "'Thing' is animated and disabled in viewports" in film(blinking, FrameRange(1, 3)).error
    thing.hide_viewport = False
    collection = bpy.data.collections.new("Left Out")
    scene.collection.children.link(collection)
    collection.objects.link(thing)
    scene.collection.objects.unlink(thing)
    bpy.context.view_layer.layer_collection.children["Left Out"].exclude = True
    assert "follows 'Thing', which is not in view layer" in film(blinking, STILL).error


@pytest.mark.parametrize("together", [False, True])
def test_two_probes_share_renders_of_a_frame_but_not_of_another(blinking, scene, monkeypatch, together: bool) -> None:
    """Nothing of a probe tells two frames apart here: neither it nor its settings change."""
    monkeypatch.setattr(capture, "_VIEWS_TO_REST", 2**30 if together else 0)
    other = small_probe("Other", half_extents=(1.0, 1.0, 0.5))
    results = BakeJob(scene, bpy.context.view_layer, [blinking, other], bake_folder(scene), FrameRange(1, 4)).run()
    assert [(r.probe, r.error, r.pictures) for r in results] == [("Probe", None, 2), ("Other", None, 2)]
    for frame, bright in ((1, 1.0), (4, 0.0)):
        scene.frame_set(frame)
        for probe in (blinking, other):
            assert wall_seen(shown_file(probe.pcc_probe.group, "Level 0")) == pytest.approx(bright, abs=0.02)


def test_injecting_again_and_removing_keep_the_sequence(blinking, scene) -> None:
    film(blinking, FrameRange(1, 4))
    for _ in range(2):
        put_in()
    drivers = blinking.pcc_probe.group.animation_data.drivers
    paths = [c.data_path for c in drivers if c.driver.expression == "frame"]
    assert len(paths) == len(set(paths)) == len(LADDER)
    assert bpy.ops.pcc.remove() == {"FINISHED"} and state().state == "baked"


def test_a_copied_probe_plays_the_sequence_and_a_still_beside_it_does_not(blinking, scene) -> None:
    still = small_probe("Still")
    bake(still)
    film(blinking, FrameRange(1, 4))
    animation = still.pcc_probe.group.animation_data
    assert not [c for c in (animation.drivers if animation else ()) if c.driver.expression == "frame"]
    scene.frame_set(3)
    assert wall_seen(shown_file(blinking.pcc_probe.group, "Level 0")) == pytest.approx(0.0, abs=0.02)


def test_an_uncorrected_probe_plays_too_and_is_not_taken_for_a_deleted_one(blinking, scene) -> None:
    blinking.pcc_probe.correction = "NONE"
    film(blinking, FrameRange(1, 4))
    put_in()
    from pcc_addon.blender.shade.probe_group import probe_of

    assert probe_of(blinking.pcc_probe.group) == blinking
    scene.frame_set(3)
    assert wall_seen(shown_file(blinking.pcc_probe.group, "Level 0")) == pytest.approx(0.0, abs=0.02)


def test_the_operator_takes_frames_and_refuses_what_is_no_range(blinking) -> None:
    assert bpy.ops.pcc.bake(scope="STALE", frames="1-4") == {"FINISHED"}
    assert bake_record(blinking).frames == (1, 2, 3, 4)
    assert bpy.ops.pcc.bake_frames(scope="ALL", first=1, last=5, step=2) == {"FINISHED"}
    assert bake_record(blinking).frames == (1, 3, 5)
    assert bpy.ops.pcc.bake(scope="ALL", frames="still") == {"FINISHED"}
    assert bake_record(blinking).frames == ()
    with pytest.raises(RuntimeError, match="such as 1-250"):
        bpy.ops.pcc.bake(frames="1")
    with pytest.raises(RuntimeError, match="ask for 1-5"):
        bpy.ops.pcc.bake_frames(first=5, last=1)


def test_a_window_onto_the_room_plays_the_sequence(blinking, scene) -> None:
    film(blinking, FrameRange(1, 4))
    material = window_material("Window", Window((room_of_probe(blinking),)), {})
    pane = bpy.data.meshes.new("Pane")
    pane.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Pane", pane))
    for again in (False, True):
        if again:
            film(blinking, FrameRange(1, 4))
        for frame, bright in ((3, 0.0), (1, 1.0)):
            scene.frame_set(frame)
            assert wall_seen(shown_file(interior_node(material).node_tree, "Room 0")) == pytest.approx(bright, abs=0.02)
    film(blinking, STILL)
    tree = interior_node(material).node_tree
    assert not [c for c in tree.animation_data.drivers if c.driver.expression == "frame"]
