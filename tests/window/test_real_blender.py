"""The shell command inside a real Blender. PCC_BLENDER is the command that starts one, words split as a shell does."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="needs Blender as a module to make the zip and the file")

import bpy

from tests.packaging.extension import build

BLENDER = shlex.split(os.environ.get("PCC_BLENDER", ""))
pytestmark = [
    pytest.mark.window,
    pytest.mark.skipif(not BLENDER, reason="set PCC_BLENDER to the command of a real Blender"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, addon: None) -> Path:
    """A folder with a saved room; the add-on is installed in the real Blender."""
    from sample_blends.scenes import EMISSIVE_ROOM as room
    from sample_blends.scenes import emissive_room

    place = tmp_path_factory.mktemp("real")
    run("-b", "--command", "extension", "install-file", "-r", "user_default", "--enable", str(build(place)), cwd=place)
    emissive_room()
    bpy.ops.pcc.probe_add(name="Room", location=room.centre, rotation=(0, 0, room.turn), half_extents=room.half_extents)
    probe = bpy.data.objects["Room"].pcc_probe
    probe.resolution, probe.samples = 32, 1
    bpy.ops.wm.save_as_mainfile(filepath=str(place / "room.blend"))
    return place


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*BLENDER, *arguments], cwd=cwd, capture_output=True, text=True, timeout=300)


def test_command_bakes_injects_and_saves(folder: Path) -> None:
    done = run("room.blend", "--command", "pcc", "bake", "--inject", "--save", "--json", cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    status = run("room.blend", "--command", "pcc", "status", "--json", cwd=folder)
    lines = [json.loads(line) for line in status.stdout.splitlines() if line.startswith("{")]
    assert [(line["probe"], line["state"]) for line in lines] == [("Room", "baked")]


def test_command_ends_with_the_exit_code_of_its_failure(folder: Path) -> None:
    done = run("room.blend", "--command", "pcc", "bake", "--probe", "Attic", cwd=folder)
    assert done.returncode == 1 and "'Attic'" in done.stderr


def test_operators_work_in_the_background(folder: Path) -> None:
    script = "import bpy; bpy.ops.pcc.bake(scope='ALL'); bpy.ops.pcc.inject(); print('MATERIALS', bpy.ops.pcc.remove())"
    done = run("--background", "room.blend", "--python-expr", script, cwd=folder)
    assert "MATERIALS {'FINISHED'}" in done.stdout, done.stdout + done.stderr
