"""Relief in Blender: distances are captured where they are asked for, stored with the pictures, and left out where they
change nothing."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.bake.job import BakedProbe, BakeJob
from pcc_addon.blender.planning import plan_scene
from pcc_addon.blender.read.probes import bake_record, probe_spec
from pcc_addon.blender.shade import probe_group
from pcc_addon.blender.shade.by_hand import group_for
from pcc_addon.blender.status import ProbeStatus, stale_probes, statuses
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.core.decisions import Decision, Effect
from pcc_addon.core.effects import relief
from pcc_addon.core.pictures import NEARNESS
from pcc_addon.core.radiance import as_half
from tests.blender.helpers import (
    ROOM,
    bake,
    glow,
    paint_wall,
    picture,
    pictures_of,
    put_in,
    save,
    small_probe,
    small_room,
)

MISSING = "its distances were not captured and are needed now; bake it again, which then renders nothing else"


@pytest.fixture
def room(scene) -> bpy.types.Object:
    """The probe of a room with a mirror for a floor, whose lookups follow relief."""
    probe = small_room()
    probe.pcc_probe.correction = "RELIEF"
    return probe


@pytest.fixture
def furnished(room) -> bpy.types.Object:
    """The same with a glowing block on the floor."""
    add_block()
    return room


def add_block() -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=ROOM.world(0.9, 0.5, -0.7))
    block = bpy.context.object
    block.name = "Block"
    block.data.materials.append(glow("Block", (0.2, 0.9, 0.9)))
    bpy.context.view_layer.update()
    return block


def decided() -> Decision:
    [probe] = plan_scene(bpy.context.scene, bpy.context.view_layer).probes
    return next(decision for decision in probe.decisions if decision.effect is Effect.RELIEF)


def steps_shown(probe: bpy.types.Object) -> int:
    return probe_group.built_lookup(probe.pcc_probe.group).steps


def found() -> list[ProbeStatus]:
    return statuses(bpy.context.scene, bpy.context.view_layer)


def bake_stale(*probes: bpy.types.Object) -> list[BakedProbe]:
    scene = bpy.context.scene
    stale = stale_probes(scene, bpy.context.view_layer, probes)
    return BakeJob(scene, bpy.context.view_layer, stale, bake_folder(scene), reuse=True).run()


def distances(probe: bpy.types.Object) -> bpy.types.Image:
    return next(level.image for level in probe.pcc_probe.levels if level.roughness == NEARNESS)


@pytest.mark.parametrize("saved", [False, True], ids=["packed", "files"])
def test_a_bake_keeps_how_near_things_are(furnished, tmp_path, saved) -> None:
    if saved:
        save(tmp_path / "room.blend")
    [result] = bake(furnished)
    assert result.error is None
    record, image = bake_record(furnished), distances(furnished)
    assert image.name == "PCC Probe Distance" and (image.packed_file is None) == saved
    assert record.departure > 0.3 and record.levels[-1].key.text == "nearness-0"
    spec = probe_spec(furnished)
    near = picture(furnished, NEARNESS)
    assert (near[..., 0] == near[..., 1]).all() and (near > 0.9 / np.linalg.norm(spec.box.half_extents)).all()
    assert near.max() < 1.0 / 0.2
    assert steps_shown(furnished) == 12 and decided().on
    assert [status.state for status in found()] == ["baked"]
    if saved:
        kinds = {path.name.split(".")[1] for path in pictures_of(furnished)}
        assert kinds == {f"radiance-{k}" for k in range(8)} | {"nearness-0"}


def test_an_empty_room_is_shown_as_by_its_box(room) -> None:
    assert decided().on, "nobody knows yet"
    bake(room)
    assert bake_record(room).departure < relief.DEPARTS
    assert decided() == Decision(Effect.RELIEF, False, "all that it captured lies on its box")
    assert steps_shown(room) == 0
    with_relief = probe_group.shown_effects(room.pcc_probe.group)
    room.pcc_probe.correction = "BOX"
    assert probe_group.shown_effects(room.pcc_probe.group) == with_relief


def test_distances_come_alone_and_leave_the_pictures_as_they_are(furnished, tmp_path) -> None:
    save(tmp_path / "room.blend")
    furnished.pcc_probe.correction = "BOX"
    bake(furnished)
    put_in()
    before = {path: path.read_bytes() for path in pictures_of(furnished)}
    assert bake_record(furnished).departure is None and not decided().on
    furnished.pcc_probe.correction = "RELIEF"
    assert [(status.state, status.why) for status in found()] == [("stale", MISSING)]
    assert steps_shown(furnished) == 0 and decided().why == "its bake has no distances"
    [result] = bake_stale(furnished)
    assert result.error is None and result.faces == ()
    after = {path: path.read_bytes() for path in pictures_of(furnished)}
    assert before.items() <= after.items() and len(after) == len(before) + 1
    assert steps_shown(furnished) == 12 and found()[0].words == ""
    assert bake_record(furnished).seconds >= result.seconds


def test_without_relief_they_are_let_go_of_with_the_next_bake(furnished, tmp_path) -> None:
    save(tmp_path / "room.blend")
    bake(furnished)
    image = distances(furnished)
    furnished.pcc_probe.correction = "BOX"
    assert steps_shown(furnished) == 0 and found()[0].state == "baked"
    paint_wall()
    bake_stale(furnished)
    assert NEARNESS not in {level.roughness for level in furnished.pcc_probe.levels}
    assert bake_record(furnished).departure is None
    with pytest.raises(ReferenceError):
        _ = image.name


def test_settings_act_at_once(furnished) -> None:
    bake(furnished)
    furnished.pcc_probe.relief_steps, furnished.pcc_probe.relief_refinements = 5, 2
    lookup = probe_group.built_lookup(furnished.pcc_probe.group)
    assert (lookup.steps, lookup.refinements) == (5, 2)
    reads = [n for n in furnished.pcc_probe.group.nodes if getattr(n, "image", None) == distances(furnished)]
    assert len(reads) == 5 + 2 + 1


def test_another_box_keeps_it_on(room) -> None:
    bake(room)
    assert steps_shown(room) == 0
    room.scale.x *= 1.2
    bpy.context.view_layer.update()
    assert decided().on and steps_shown(room) == 12


@pytest.mark.parametrize(("correction", "choice", "steps"), [("BOX", "ON", 12), ("RELIEF", "OFF", 0)])
def test_it_can_be_forced(furnished, correction, choice, steps) -> None:
    furnished.pcc_probe.correction = correction
    furnished.pcc_probe.effects.relief = choice
    bake(furnished)
    assert steps_shown(furnished) == steps
    assert (bake_record(furnished).departure is not None) == (choice == "ON")
    assert decided().forced or choice == "OFF"


def test_levels_that_are_made_later_leave_them(furnished) -> None:
    furnished.pcc_probe.effects.levels = "AUTO"
    bake(furnished)
    before = picture(furnished, NEARNESS).copy()
    count = len(furnished.pcc_probe.levels)
    bpy.data.materials["Floor"].node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.3
    put_in()
    assert len(furnished.pcc_probe.levels) > count and np.array_equal(picture(furnished, NEARNESS), before)
    assert bake_record(furnished).departure > 0.3 and steps_shown(furnished) == 12


def test_shaders_by_hand_follow_it(furnished) -> None:
    bake(furnished)
    tree = group_for(furnished)
    assert distances(furnished) in {getattr(node, "image", None) for node in tree.nodes}


def test_a_missing_picture_is_a_fault(furnished) -> None:
    bake(furnished)
    next(level for level in furnished.pcc_probe.levels if level.roughness == NEARNESS).image = None
    [status] = found()
    assert status.state == "stale" and "its picture of distances is missing" in status.why


def test_pictures_in_half_precision(furnished, tmp_path: Path) -> None:
    save(tmp_path / "room.blend")
    bake(furnished)
    whole, size = picture(furnished).copy(), pictures_of(furnished)[1].stat().st_size
    furnished.pcc_probe.half_float = True
    assert found()[0].state == "stale"
    bake(furnished)
    assert np.array_equal(picture(furnished), as_half(whole)) and found()[0].state == "baked"
    assert pictures_of(furnished)[1].stat().st_size < size
    assert not np.array_equal(as_half(picture(furnished, NEARNESS)), picture(furnished, NEARNESS))


def test_a_second_probe_shows_what_the_first_cannot_see(furnished) -> None:
    """Its capture point lies behind the block, so that points there choose by what each of them sees."""
    second = small_probe("Second", capture_offset=(1.6, 1.2, -0.6))
    second.pcc_probe.correction = "RELIEF"
    furnished.pcc_probe.priority = 1
    bake(furnished, second)
    put_in()
    tree = bpy.data.materials["Floor"].node_tree
    groups = [node.node_tree.name for node in tree.nodes if node.bl_idname == "ShaderNodeGroup"]
    assert groups.count("PCC Probe Yields") == 1 and "PCC Seen by Both" not in groups
    assert "Seen" in probe_group.outputs(furnished.pcc_probe.group)
    for probe in (furnished, second):
        probe.pcc_probe.correction = "BOX"
    groups = [node.node_tree.name for node in tree.nodes if node.bl_idname == "ShaderNodeGroup"]
    assert "PCC Probe Yields" not in groups
