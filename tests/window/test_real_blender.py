"""The shell command inside a real Blender."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.window.real import MARKS, run

pytestmark = MARKS


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


@pytest.mark.heavy
def test_accuracy_is_measured_by_a_second_blender(folder: Path) -> None:
    script = "import bpy; print('COST', bpy.ops.pcc.cost(width=64, budget=40))"
    done = run("--background", "room.blend", "--python-expr", script, cwd=folder)
    assert "COST {'FINISHED'}" in done.stdout, done.stdout + done.stderr
    report = json.loads((folder / "room.cost" / "cost.json").read_text(encoding="utf-8"))["report"]
    assert report["file"] == "room.blend" and report["measurements"]
    assert not [path for path in folder.iterdir() if "unfinished" in path.name]
