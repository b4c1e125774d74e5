"""A file with a room that is quick to measure, its probe baked and shown."""

from __future__ import annotations

from pathlib import Path

import bpy

from sample_blends.scenes import EMISSIVE_ROOM, add_room_probe, emissive_room
from tests.blender.helpers import bake, put_in

WIDTH, HEIGHT = 64, 36
ENOUGH = 20.0  # seconds in which a few rungs can be measured


def room_file(folder: Path) -> Path:
    """A saved emissive room whose floor shows the probe "Room"; it is open then."""
    emissive_room()
    probe = add_room_probe(EMISSIVE_ROOM)
    bpy.context.view_layer.update()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "room.blend"))
    settings = probe.pcc_probe
    settings.resolution, settings.samples, settings.denoise = 16, 1, False
    bake(probe)
    put_in()
    bpy.ops.wm.save_mainfile()
    return folder / "room.blend"
