"""`pcc fit`: what it says, what it sets, and that it sets nothing unless asked."""

from __future__ import annotations

import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

from pcc_addon.blender.accuracy import fit_errors
from pcc_addon.blender.read.probes import probe_spec
from pcc_addon.cli import run_in_blender
from pcc_addon.core.probe import Box
from sample_blends.scenes import add_camera, principled_node
from tests.blender.helpers import ROOM, save, small_probe, small_room
from tests.core.rooms import box, wall_errors

TRUE = box(ROOM.centre, ROOM.half_extents)


@pytest.fixture
def blend(tmp_path: Path) -> Path:
    """A small room with one probe drawn too large and askew and one that is animated, saved; no file is open then."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    small_room()
    probe = bpy.data.objects["Probe"]
    probe.scale = [1.2 * length for length in probe.scale]
    probe.rotation_euler.z = 0.4
    moving = small_probe("Moving")
    moving.keyframe_insert("location", frame=1)
    path = tmp_path / "room.blend"
    save(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def events(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, list[dict]]:
    """Exit code and the JSON lines; any line that is not JSON fails here."""
    capfd.readouterr()
    code = run_in_blender([*(str(a) for a in arguments), "--json"])
    return code, [json.loads(line) for line in capfd.readouterr().out.splitlines()]


def box_in(path: Path) -> Box:
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return probe_spec(bpy.data.objects["Probe"]).box


def test_a_fit_is_told_and_nothing_is_changed(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    before = blend.read_bytes()
    code, lines = events(capfd, "fit", blend, "--probe", "Probe")
    [fitted] = [line for line in lines if line["event"] == "fitted"]
    assert code == 0 and fitted["probe"] == "Probe" and blend.read_bytes() == before
    assert fitted["after"]["half_extents"] == pytest.approx(ROOM.half_extents, abs=1e-3)
    assert fitted["after"]["misfit"]["share"] > 0.99 > 0.1 > fitted["before"]["misfit"]["share"]
    assert [wall["name"] for wall in fitted["walls"]] == ["-X", "+X", "-Y", "+Y", "-Z", "+Z"]
    assert fitted["turned"] == pytest.approx(np.degrees(0.4), abs=0.01)
    assert not [line for line in lines if line["event"] in {"applied", "saved"}]
    assert "progress" in {line["event"] for line in lines}
    assert wall_errors(TRUE, probe_spec(bpy.data.objects["Probe"]).box).max() > 0.1, "nor in the open file"


def test_a_fit_that_is_applied_is_saved(capfd: pytest.CaptureFixture[str], blend: Path, tmp_path: Path) -> None:
    code, lines = events(capfd, "fit", blend, "--probe", "Probe", "--apply", "--save")
    assert code == 0 and [line["event"] for line in lines][-2:] == ["applied", "saved"]
    assert wall_errors(TRUE, box_in(blend)).max() < 1e-3
    code, lines = events(capfd, "fit", blend, "--probe", "Probe", "--apply", "--output", tmp_path / "other.blend")
    assert code == 0 and wall_errors(TRUE, box_in(tmp_path / "other.blend")).max() < 1e-3


def test_what_cannot_be_fitted_is_one_failure_and_the_others_are_fitted(
    capfd: pytest.CaptureFixture[str], blend: Path
) -> None:
    code, lines = events(capfd, "fit", blend, "--apply", "--save")
    assert code == 1
    [error] = [line["error"] for line in lines if line["event"] == "error"]
    assert "'Moving'" in error and "animated" in error
    assert wall_errors(TRUE, box_in(blend)).max() < 1e-3
    before = blend.read_bytes()
    code, lines = events(capfd, "fit", blend, "--probe", "Moving", "--apply", "--save")
    assert code == 1 and blend.read_bytes() == before, "there was nothing to save"


def test_saving_without_applying_is_refused(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    code, lines = events(capfd, "fit", blend, "--save")
    assert code == 1 and "--apply" in lines[-1]["error"]


def test_people_read_sentences(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    capfd.readouterr()
    assert run_in_blender(["fit", str(blend), "--probe", "Probe"]) == 0
    text = capfd.readouterr().out
    assert "'Probe': box 4.800 × 3.600 × 2.400 m → 4.000 × 3.000 × 2.000 m, moved by 0.000 m, turned by 22.92°" in text
    assert "misfit after: median 0.0000 m" in text and "wall +X found (-0.400 m" in text and "capture point" in text
    code, lines = events(capfd, "fit", blend, "--probe", "Attic")
    assert code == 1 and "'Attic'" in lines[-1]["error"]


@pytest.mark.heavy
def test_what_a_fit_does_to_the_picture_is_measured(
    capfd: pytest.CaptureFixture[str], blend: Path, monkeypatch
) -> None:
    monkeypatch.setattr(fit_errors, "_TRUTH_SECONDS", 1.0)
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    add_camera(ROOM.world(-1.2, -0.9, 0.6), Vector(ROOM.world(0.5, 0.3, -1.0)), 24.0, 64, 36)
    bpy.context.scene.render.engine = "CYCLES"
    principled_node(bpy.data.materials["Floor"]).inputs["Metallic"].default_value = 1.0
    bpy.ops.wm.save_mainfile()
    before = blend.read_bytes()
    code, lines = events(capfd, "fit", blend, "--probe", "Probe", "--render")
    [measured] = [line for line in lines if line["event"] == "measured"]
    assert code == 0 and measured["after"] < 0.8 * measured["before"] and blend.read_bytes() == before


def test_without_a_camera_the_picture_cannot_be_measured(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    code, lines = events(capfd, "fit", blend, "--probe", "Probe", "--render")
    assert code == 1 and "no camera" in next(line for line in lines if line["event"] == "error")["error"]
