"""EEVEE's own ray tracing adds nothing to what a surface shows of a probe, and takes nothing away."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Vector

from benchmarks.measure import pixels_of, render
from pcc_addon.core.probe import Engine
from sample_blends.scenes import Room, add_camera, add_wall, principled
from tests.blender.helpers import bake, glow, put_in, small_probe
from tests.eevee import without_shadows

ROOM = Room((2.0, 1.5, 1.0), (3.0, -2.0, 1.0), 0.0)
SURFACES = {
    "mirror": {"Metallic": 1.0, "Roughness": 0.0},
    "rough metal": {"Metallic": 1.0, "Roughness": 0.3},
    "dielectric": {"Base_Color": (0.0, 0.0, 0.0, 1.0), "Roughness": 0.1},
    "glass": {"Base_Color": (1.0, 1.0, 1.0, 1.0), "Transmission_Weight": 1.0, "Roughness": 0.0},
}


def _room(scene: bpy.types.Scene, surface: str, weight: float) -> np.ndarray:
    """A room of glowing walls, seen so that rays traced in the picture find them; the mask of its floor."""
    for side, color in zip(("+X", "-X", "+Y", "-Y", "+Z"), np.eye(3).tolist() * 2, strict=False):
        add_wall(ROOM, side, glow(side, color))
    add_wall(ROOM, "-Z", principled("Floor", **SURFACES[surface]))
    add_camera(ROOM.world(-1.8, -1.3, -0.2), Vector(ROOM.world(0.8, 0.6, -0.5)), 22.0, 48, 32)
    without_shadows(scene)
    probe = small_probe("Room", ROOM.centre, ROOM.half_extents)
    probe.pcc_probe.weight = weight
    probe.pcc_probe.hidden_objects.add().object = bpy.data.objects["Wall -Z"]
    bake(probe)
    return pixels_of(scene, {"Floor"})


def _mean(scene: bpy.types.Scene, floor: np.ndarray, engine: Engine, traced: bool = False) -> np.ndarray:
    scene.eevee.use_raytracing = traced
    return render(scene, engine, samples=8).pixels[floor].mean(0)


@pytest.mark.sweep
@pytest.mark.parametrize("surface", SURFACES)
def test_ray_tracing_of_eevee_changes_no_reflection_of_a_probe(scene: bpy.types.Scene, surface: str) -> None:
    """A second reflection, or one that is lost, is tens of per cent; both engines show the same."""
    floor = _room(scene, surface, weight=1.0)
    put_in()
    off, on, cycles = (_mean(scene, floor, *how) for how in ((Engine.EEVEE,), (Engine.EEVEE, True), (Engine.CYCLES,)))
    assert cycles.max() > 0.01
    np.testing.assert_allclose(on, off, rtol=0.002, atol=0.001)
    np.testing.assert_allclose(on, cycles, rtol=0.02, atol=0.003)


@pytest.mark.heavy
def test_what_a_probe_leaves_is_traced_by_eevee_as_ever(scene: bpy.types.Scene) -> None:
    """A surface that shows half of a probe keeps half of what EEVEE makes of it, with and without ray tracing."""
    floor = _room(scene, "mirror", weight=0.5)
    alone = [_mean(scene, floor, Engine.EEVEE, traced) for traced in (False, True)]
    put_in()
    half = [_mean(scene, floor, Engine.EEVEE, traced) for traced in (False, True)]
    bpy.data.objects["Room"].pcc_probe.weight = 1.0
    bpy.context.view_layer.update()
    put_in()
    whole = _mean(scene, floor, Engine.EEVEE)
    assert alone[1].max() > 0.1 > alone[0].max()
    for own, found in zip(alone, half, strict=True):
        np.testing.assert_allclose(found, 0.5 * own + 0.5 * whole, rtol=0.03, atol=0.01)
