"""Two furnished rooms that share a floor of textured roughness: each object shows the probe of its room."""

from __future__ import annotations

import bpy

from pcc_addon.blender.planning import plan_scene
from sample_blends.two_rooms import two_rooms


def test_the_plan_gives_each_floor_the_probe_of_its_room_and_says_so(addon) -> None:
    two_rooms()
    bpy.context.view_layer.update()
    plans = {plan.material: plan for plan in plan_scene(bpy.context.scene, bpy.context.view_layer).materials}
    floor = plans["Tiles"]
    assert set(floor.objects) == {("Lounge -Z", "Lounge"), ("Study -Z", "Study")}
    [surface] = floor.surfaces
    assert surface.effects is not None and surface.roughness == (0.0, 1.0)
    assert surface.reasons[0] == "roughness varies; where it is above the limit 0.6 it keeps its own lobe"
    assert plans["Lounge Mirror"].probes == ("Lounge",) and plans["Study Mirror"].probes == ("Study",)
    for name in ("Lounge Wall", "Study Cloth"):
        assert plans[name].probes == () and "above the scene's limit" in plans[name].notes[0]
