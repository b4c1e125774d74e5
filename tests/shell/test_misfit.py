"""`pcc misfit`: words, records, pictures, exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import bpy
import pytest

from pcc_addon.cli import run_in_blender
from sample_blends.scenes import EMISSIVE_ROOM, emissive_room


@pytest.fixture
def blend(tmp_path: Path, addon: None) -> Path:
    """The emissive room with two probes, saved; afterwards no file is open."""
    emissive_room()
    room = EMISSIVE_ROOM
    for name, half in (("Room", room.half_extents), ("Larger: 10 %", tuple(1.1 * h for h in room.half_extents))):
        bpy.ops.pcc.probe_add(name=name, location=room.centre, rotation=(0, 0, room.turn), half_extents=half)
    path = tmp_path / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def test_words_and_progress(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    before = blend.read_bytes()
    capfd.readouterr()
    assert run_in_blender(["misfit", str(blend), "--probe", "Room"]) == 0
    lines = capfd.readouterr().out.splitlines()
    told = lines.index("probe 'Room':")
    assert lines[told + 1].startswith("    The box is on what is seen, within 1 cm, in ")
    assert lines[0].startswith("  0% ") and len(lines[:told]) == len(set(lines[:told])) >= 8
    assert blend.read_bytes() == before


def test_records_and_pictures(capfd: pytest.CaptureFixture[str], blend: Path, tmp_path: Path) -> None:
    capfd.readouterr()
    out = tmp_path / "new" / "folder"
    assert run_in_blender(["misfit", str(blend), "--json", "--out", str(out)]) == 0
    events = [json.loads(line) for line in capfd.readouterr().out.splitlines()]
    found = {event["probe"]: event for event in events if event["event"] == "misfit"}
    assert found["Room"]["fit"]["on"]["share"] > 0.8
    assert found["Larger: 10 %"]["fit"]["before"]["share"] > 0.99
    assert found["Larger: 10 %"]["degrees"] > found["Room"]["degrees"]
    assert sum(share["share"] for share in found["Room"]["fit"].values()) == pytest.approx(1.0)
    unseen = found["Room"]["unseen"]
    assert sum(part["area"] for part in unseen) == pytest.approx(found["Room"]["unseen_area"])
    files = [Path(event["file"]) for event in events if event["event"] == "picture"]
    assert len(files) == 6 and sorted(files) == sorted(out.iterdir())
    assert {file.name.split(".")[1] for file in files} == {"misfit", "faces", "unseen"}
    image = bpy.data.images.load(str(files[0]))
    assert image.size[0] == 512 and image.size[1] > 256


def test_what_cannot_be_done_is_said(capfd: pytest.CaptureFixture[str], blend: Path, tmp_path: Path) -> None:
    assert run_in_blender(["misfit", str(blend), "--probe", "Attic"]) == 1
    assert "'Attic'" in capfd.readouterr().err
    assert run_in_blender(["misfit", str(blend), "--out", str(blend)]) == 1
    assert "is a file; name a folder" in capfd.readouterr().err
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "empty.blend"))
    assert run_in_blender(["misfit", str(tmp_path / "empty.blend")]) == 1
    assert "has no parallax probe" in capfd.readouterr().err
    assert run_in_blender(["misfit", str(blend), "--save"]) == 2
