"""A probe with a given picture against walls that are painted with it, and one with the world's against the sky."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Euler

from benchmarks.measure import relative_rmse, render
from pcc_addon.core.probe import Engine
from sample_blends.any_cubemap import chequered_sky, mirror_ball, paint_walls, write_cross

TILTED = Euler((0.4, -0.3, 0.5))


def small_ball(tilt: Euler | None) -> bpy.types.Scene:
    """The mirror ball in few pixels, and its probe."""
    scene = mirror_ball(tilt=tilt)
    scene.render.resolution_x, scene.render.resolution_y = 96, 54
    return scene


def shown(scene: bpy.types.Scene, engine: Engine = Engine.CYCLES) -> np.ndarray:
    return render(scene, engine, 16).pixels


def truth_of_painted_walls(scene: bpy.types.Scene) -> np.ndarray:
    """What the ball shows in the painted room, black around it; the walls are gone afterwards."""
    probe = bpy.data.objects["Room"]
    paint_walls(probe.matrix_world, 64)
    walls = [item for item in bpy.data.objects if item.name.startswith("Wall ")]
    for wall in walls:
        wall.visible_camera = False
    truth = shown(scene)
    for wall in walls:
        bpy.data.objects.remove(wall)
    return truth


@pytest.mark.sweep
@pytest.mark.parametrize("mirrored", [False, True], ids=["as it is", "mirrored"])
@pytest.mark.parametrize("tilt", [None, TILTED], ids=["turned", "tilted"])
def test_the_ball_shows_the_picture_as_if_it_were_painted_on_walls(
    scene, tmp_path: Path, tilt: Euler | None, mirrored: bool
) -> None:
    """Every face, turned and stretched with the box: any that were mirrored or turned would be far off."""
    ball = small_ball(tilt)
    probe = bpy.data.objects["Room"]
    probe.scale.y *= -1.0 if mirrored else 1.0
    bpy.context.view_layer.update()
    truth = truth_of_painted_walls(ball)
    write_cross(tmp_path / "cross.png", 64)
    settings = probe.pcc_probe
    settings.source, settings.picture, settings.resolution = "IMAGE", str(tmp_path / "cross.png"), 128
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    assert relative_rmse(shown(ball), truth) <= 0.06
    settings.correction = "NONE"
    assert relative_rmse(shown(ball), truth) >= 0.4
    if tilt is not None and not mirrored:
        settings.correction = "BOX"
        assert relative_rmse(shown(ball, Engine.EEVEE), truth) <= 0.08


def test_the_box_may_be_fitted_afterwards_and_the_picture_follows(scene, tmp_path: Path) -> None:
    ball = small_ball(None)
    write_cross(tmp_path / "cross.png", 64)
    settings = bpy.data.objects["Room"].pcc_probe
    settings.source, settings.picture, settings.resolution = "IMAGE", str(tmp_path / "cross.png"), 128
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    probe = bpy.data.objects["Room"]
    probe.rotation_euler, probe.scale, probe.location.x = TILTED, (3.5, 3.0, 2.5), probe.location.x + 0.3
    bpy.context.view_layer.update()
    truth = truth_of_painted_walls(ball)
    assert relative_rmse(shown(ball), truth) <= 0.06


@pytest.mark.heavy
def test_a_sky_that_is_not_corrected_stays_where_the_sky_is(scene) -> None:
    """Its picture is taken along the axes of the tilted box and looked up along them."""
    ball = small_ball(TILTED)
    chequered_sky(ball)
    truth = shown(ball)
    settings = bpy.data.objects["Room"].pcc_probe
    settings.source, settings.correction, settings.resolution, settings.samples = "WORLD", "NONE", 128, 4
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    found = shown(ball)
    assert relative_rmse(found, truth) <= 0.05 and not np.array_equal(found, truth)
