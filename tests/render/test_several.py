"""Several probes in one picture, against the path tracer: overlapping in one room, and through a doorway."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from benchmarks import doorway
from benchmarks.measure import covered, relative_rmse, render
from pcc_addon.core.probe import Engine
from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room


def overlapping(count: int) -> bpy.types.Scene:
    """The emissive room with probes whose boxes are the room's and whose influences overlap, each with its settings."""
    scene = emissive_room()
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    rng = np.random.default_rng(count)
    half = np.array(EMISSIVE_ROOM.half_extents)
    for k in range(count):
        probe = add_room_probe(EMISSIVE_ROOM, tuple(rng.uniform(-0.3, 0.3, 3) * half))
        probe.name = f"Room {k}"
        settings = probe.pcc_probe
        settings.resolution, settings.samples, settings.denoise = 128, 4, False
        settings.falloff, settings.priority = float(rng.uniform(0.1, 1.0)), int(rng.integers(0, 3))
        if k > 0:  # the first has all of the room
            settings.influence_low = -rng.uniform(0.0, 0.7, 3) * half
            settings.influence_high = -rng.uniform(0.0, 0.7, 3) * half
            settings.influence_low[2] = settings.influence_high[2] = 0.0
            settings.weight = float(rng.uniform(0.3, 1.0))
    return scene


@pytest.mark.heavy
@pytest.mark.parametrize("count", [1, 2, 3, 5, 8])
def test_overlapping_probes_are_as_exact_as_one(addon, count: int) -> None:
    """Each lookup is right for its capture point, so any shares that add up to one are."""
    scene = overlapping(count)
    truth, floor = render(scene).pixels, covered(scene, bpy.data.objects["Wall -Z"])
    bpy.ops.pcc.bake(scope="ALL")
    bpy.ops.pcc.inject()
    assert relative_rmse(render(scene).pixels, truth, floor) <= 0.13
    assert relative_rmse(render(scene, Engine.EEVEE).pixels, truth, floor) <= 0.13


@pytest.mark.heavy
@pytest.mark.skipif(bpy.app.version < (5, 2), reason="minutes of path tracing; one Blender says it")
def test_two_probes_through_a_doorway_are_nearer_the_truth_than_each_of_them(addon, monkeypatch) -> None:
    monkeypatch.setattr(doorway, "TRUTH_SAMPLES", 256)
    monkeypatch.setattr(doorway, "SAMPLES", {Engine.CYCLES: 64})
    monkeypatch.setattr(doorway, "RESOLUTION", 128)
    found = {way: by_engine["Cycles"] for way, by_engine in doorway.measure().items()}
    assert found["both"] < min(found["Lounge alone"], found["Study alone"])
