"""Which pixels a probe serves, against the rays of the camera; and the truth, which must know its own noise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender.accuracy import truth
from pcc_addon.blender.accuracy.bench import Bench, Size
from pcc_addon.blender.accuracy.partner import partner_of
from pcc_addon.blender.accuracy.served import served_pixels
from pcc_addon.core.accuracy.metrics import noise_of_halves, relative_rmse
from pcc_addon.core.accuracy.records import Kind, Settings
from pcc_addon.core.errors import BakeError
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_box, add_room_probe, emissive, emissive_room, gallery, principled
from tests.blender.cost_scenes import HEIGHT, WIDTH, room_file
from tests.rna_dump import difference, dump

PATH = Settings(Kind.PATH, Engine.CYCLES, "NONE", frame_samples=16)


def mask() -> np.ndarray:
    scene = bpy.context.scene
    return served_pixels(scene, bpy.context.view_layer, bpy.data.objects["Room"], WIDTH, HEIGHT)


def rays() -> tuple[np.ndarray, np.ndarray]:
    """The camera's place, and the directions (h, w, 3) through the middles of pixels, along the room's axes."""
    camera = bpy.context.scene.camera
    x, y = np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH - 0.5, ((np.arange(HEIGHT) + 0.5) - HEIGHT / 2) / WIDTH)
    scale = camera.data.sensor_width / camera.data.lens
    local = np.stack([x * scale, y * scale, -np.ones_like(x)], -1)
    to_room = np.array(EMISSIVE_ROOM.matrix.inverted() @ camera.matrix_world)
    return to_room[:3, 3], local @ to_room[:3, :3].T


def floor_seen() -> np.ndarray:
    """(h, w): where a ray leaves the room through its floor."""
    start, directions = rays()
    half = np.array(EMISSIVE_ROOM.half_extents)
    away = (np.sign(directions) * half - start) / directions
    return (away.argmin(-1) == 2) & (directions[..., 2] < 0.0)


def test_the_mask_is_the_floor_that_the_camera_sees(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    expected = floor_seen()
    assert 0.3 < expected.mean() < 0.8
    np.testing.assert_array_equal(mask(), expected)


def test_finding_the_mask_leaves_everything_as_it_was(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    mask()
    dump()  # some properties come into being when they are first read
    before = dump()
    mask()
    assert difference(before, dump()) == []


def test_what_stands_before_the_floor_hides_it(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    whole = mask()
    chalk = principled("Chalk", Roughness=1.0, Specular_IOR_Level=0.0)
    box = add_box(EMISSIVE_ROOM, "Block", (-1.0, -1.0, -1.5), (0.5, 0.5, 0.5), chalk)
    bpy.context.view_layer.update()
    before, after = whole.sum(), mask().sum()
    box.hide_render = True
    assert 0 < after < before
    np.testing.assert_array_equal(mask(), whole)


def test_what_mirrors_the_floor_is_not_served(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """It is rougher than the scene's limit, so it keeps its own lobe, whose rays find the floor."""
    room_file(tmp_path)
    whole = mask()
    steel = principled("Steel", Metallic=1.0, Roughness=0.8)
    box = add_box(EMISSIVE_ROOM, "Block", (-1.0, -1.0, -1.0), (0.8, 0.8, 1.0), steel)
    bpy.context.view_layer.update()
    hidden = mask()
    box.hide_render = True
    np.testing.assert_array_equal(mask(), whole)
    gone = whole & ~hidden
    assert gone.sum() > 50 and not (hidden & ~whole).any()
    box.hide_render = False
    box.visible_camera = False  # now rays of the camera pass it, and the floor behind it counts again
    np.testing.assert_array_equal(mask(), whole)


def test_surfaces_that_keep_their_own_reflection_are_not_served(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    bpy.data.objects["Room"].pcc_probe.weight = 0.0
    assert not mask().any()


def test_a_lamp_as_bright_as_the_sun_changes_nothing(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    bpy.data.materials["Mirror"].node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = 0.5
    bpy.context.view_layer.update()
    whole = mask()
    lamp = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "POINT"))
    lamp.data.energy, lamp.location = 1e9, EMISSIVE_ROOM.world(0.0, 0.0, 1.0)
    scene = bpy.context.scene
    scene.collection.objects.link(lamp)
    np.testing.assert_array_equal(mask(), whole)


def test_a_probe_without_a_bake_is_named(scene: bpy.types.Scene) -> None:
    emissive_room()
    add_room_probe(EMISSIVE_ROOM)
    with pytest.raises(BakeError, match="probe 'Room' has no bake"):
        mask()


def test_rungs_that_share_a_bake_show_it_again_to_the_last_digit(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    scene, probe = bpy.context.scene, bpy.data.objects["Room"]
    bench = Bench(scene, bpy.context.view_layer, probe, Size(WIDTH, HEIGHT), (1,), tmp_path / "bakes")
    fine = Settings(Kind.PROBE, Engine.CYCLES, "BOX", 64, 1, frame_samples=4)
    classic, coarse, relief = (
        replace(fine, correction="NONE"),
        replace(fine, resolution=16),
        replace(fine, correction="RELIEF", steps=8, refinements=3),
    )
    floor, seen = floor_seen(), {}
    for rung in (fine, classic, coarse, relief, PATH, fine, classic, coarse):
        if rung.kind is Kind.PROBE and rung.bake_key not in bench.baked:
            for _ in bench.bake(rung, 5):
                pass
        bench.show(rung)
        picture = bench.frame(rung, 1, 5).pixels
        np.testing.assert_array_equal(seen.setdefault(rung, picture), picture)
    assert len(list((tmp_path / "bakes").iterdir())) == 3  # of five rungs
    errors = {rung: relative_rmse(picture, seen[PATH], floor) for rung, picture in seen.items()}
    assert errors[classic] > 0.5 > errors[coarse] > 2.0 * errors[fine]
    assert errors[relief] == pytest.approx(errors[fine], rel=1e-3)  # an empty room


def test_a_second_probe_in_the_room_is_baked_and_shown_by_paired_rungs_alone(scene, tmp_path: Path) -> None:
    """It sees the side of a block that the first one cannot, which relief shows in the floor."""
    room_file(tmp_path)
    scene, probe = bpy.context.scene, bpy.data.objects["Room"]
    glow, emission = emissive("Glow")
    emission.inputs["Color"].default_value = (0.2, 2.0, 0.2, 1.0)
    add_box(EMISSIVE_ROOM, "Block", (-0.2, 0.0, -1.2), (0.3, 1.2, 0.7), glow)
    far = add_room_probe(EMISSIVE_ROOM)
    far.name, far.pcc_probe.capture_offset, probe.pcc_probe.capture_offset = "Far", (-2.0, 0, 0), (2.0, 0, 0)
    bpy.context.view_layer.update()
    assert partner_of(probe, scene, bpy.context.view_layer) == far
    bench = Bench(scene, bpy.context.view_layer, probe, Size(WIDTH, HEIGHT), (1,), tmp_path / "bakes")
    alone = Settings(Kind.PROBE, Engine.CYCLES, "RELIEF", 64, 1, frame_samples=4, steps=12, refinements=4)
    pair = replace(alone, paired=True)
    seen: dict[Settings, np.ndarray] = {}
    for rung in (alone, pair, PATH, alone, pair):
        if rung.kind is Kind.PROBE and rung.bake_key not in bench.baked:
            for _ in bench.bake(rung, 5):
                pass
        bench.show(rung)
        picture = bench.frame(rung, 1, 5).pixels
        np.testing.assert_array_equal(seen.setdefault(rung, picture), picture)
    hidden = floor_seen() & (np.abs(seen[alone] - seen[PATH]).max(-1) > 0.5)
    errors = [relative_rmse(seen[rung], seen[PATH], hidden) for rung in (alone, pair)]
    assert hidden.sum() > 50 and errors[1] < 0.5 * errors[0]
    assert [len(bench.bake_of(rung).records) for rung in (alone, pair)] == [1, 2]
    far.location += far.matrix_world.to_3x3() @ Vector((1.9, 0, 0))  # the room beside, whose box overlaps a little
    bpy.context.view_layer.update()
    assert partner_of(probe, scene, bpy.context.view_layer) is None


@pytest.mark.heavy
def test_the_truth_knows_its_own_noise(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """The estimate of two halves against the distance to a picture with many more samples."""
    gallery()
    scene = bpy.context.scene
    probe = next(item for item in scene.objects if item.pcc_probe.is_probe)
    bpy.context.view_layer.update()
    bench = Bench(scene, bpy.context.view_layer, probe, Size(48, 27), (1,), tmp_path)
    everything = np.ones((27, 48), bool)
    pairs = truth.deepened(bench, 1, everything, 1e9, None, 7)
    halves = next(pairs)
    while halves.samples < 16:
        halves = next(pairs)
    pairs.close()
    best = bench.frame(Settings(Kind.PATH, Engine.CYCLES, "NONE", frame_samples=1024), 1, 99)
    matt = best.pixels.max(-1) < 0.6  # a few pixels at the lamps' edges have most of the noise: too few to tell
    estimated = noise_of_halves(halves.first, halves.second, matt)
    assert matt.mean() > 0.7 and estimated > 0.01
    assert relative_rmse(halves.mean, best.pixels, matt) == pytest.approx(estimated, rel=0.2)


def test_the_truth_ends_in_time_or_where_it_is_clean(scene: bpy.types.Scene, tmp_path: Path) -> None:
    room_file(tmp_path)
    scene = bpy.context.scene
    probe = bpy.data.objects["Room"]
    bench = Bench(scene, bpy.context.view_layer, probe, Size(WIDTH, HEIGHT), (1,), tmp_path / "bakes")
    walls = ~floor_seen()
    walls[:-4] = False  # the ceiling's squares alone: filtered edges are all the noise there is
    *_, last = truth.deepened(bench, 1, walls, 1.0, None, 7)
    assert last.seconds < 2.0
    *_, again = truth.deepened(bench, 1, walls, 1.0, last, 1007)
    assert again.samples < last.samples + 64
