"""A file, and the add-on installed in a real Blender."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module to make the zip and the file")

import bpy

from tests.packaging.extension import build
from tests.window.real import install


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, addon: None) -> Path:
    """A folder with a saved room; the add-on is installed in the real Blender."""
    from sample_blends.scenes import EMISSIVE_ROOM as room
    from sample_blends.scenes import emissive_room

    place = tmp_path_factory.mktemp("real")
    install(build(place), place)
    emissive_room()
    bpy.ops.pcc.probe_add(name="Room", location=room.centre, rotation=(0, 0, room.turn), half_extents=room.half_extents)
    probe = bpy.data.objects["Room"].pcc_probe
    probe.resolution, probe.samples = 32, 1
    bpy.ops.wm.save_as_mainfile(filepath=str(place / "room.blend"))
    return place
