"""Straight up and straight down are directions like any other."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import render
from pcc_addon.core.effects.lookup import steepest_slope
from sample_blends.scenes import add_camera, empty_scene, principled
from tests.poles import halves
from tests.shader_harness import evaluate_group

CASES = 2000


def test_a_mirror_seen_from_straight_above_shows_the_ceiling_and_nothing_of_the_floor() -> None:
    scene = empty_scene()
    background = next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Strength"].default_value = 1.0
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    bpy.ops.mesh.primitive_plane_add(size=100.0)  # black below in the capture, a mirror in the picture
    mirror = principled("Mirror", Base_Color=(1.0, 1.0, 1.0, 1.0), Metallic=1.0, Roughness=0.0)
    bpy.context.object.data.materials.append(mirror)
    bpy.ops.pcc.probe_add(name="P", location=(0, 0, 2), half_extents=(3, 3, 2))
    settings = bpy.data.objects["P"].pcc_probe
    settings.resolution, settings.samples, settings.denoise = 16, 1, False
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    camera = add_camera(Vector((0.0, 0.0, 3.0)), Vector((0.0, 0.0, 0.0)), 35.0, 32, 32)
    for kind in ("PERSP", "ORTHO"):
        camera.data.type, camera.data.ortho_scale = kind, 1.0
        np.testing.assert_allclose(render(scene, samples=4).pixels, 1.0, atol=0.02, err_msg=kind)


@pytest.mark.parametrize("height", [32, 256, 1024, 2048])
def test_near_a_pole_no_picture_however_large_shows_the_other(scene, height: int) -> None:
    """White above and black below; directions within a texel of the poles, and the poles themselves."""
    rng = np.random.default_rng(1)
    tilt, azimuth = np.pi / height * rng.random(CASES) ** 2, 2.0 * np.pi * rng.random(CASES)
    tilt[: CASES // 10] = 0.0
    side = rng.choice([-1.0, 1.0], CASES)
    directions = [np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), side * np.cos(tilt)]
    found = evaluate_group(
        halves(height, guarded=True), {"Direction": np.stack(directions, -1), "Steepest": steepest_slope(height)}
    )
    np.testing.assert_allclose(found["Color"][:, 0], side > 0, rtol=0.0, atol=1e-6)
