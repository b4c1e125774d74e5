"""What the subcommands do, and how they end."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.store.pictures import write_file
from pcc_addon.cli import run_in_blender
from sample_blends.scenes import EMISSIVE_ROOM, emissive_room

ROOT = Path(__file__).resolve().parents[2]
FAST = ["--resolution", "16", "--samples", "1"]


@pytest.fixture
def blend(tmp_path: Path) -> Path:
    """The emissive room with a probe, saved; afterwards no file is open."""
    emissive_room()
    room = EMISSIVE_ROOM
    for name in ("Room", "Other"):
        bpy.ops.pcc.probe_add(
            name=name, location=room.centre, rotation=(0, 0, room.turn), half_extents=room.half_extents
        )
    path = tmp_path / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def events(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, list[dict]]:
    """Exit code and the JSON lines; any line that is not JSON fails here."""
    capfd.readouterr()
    code = run_in_blender([*(str(a) for a in arguments), "--json"])
    return code, [json.loads(line) for line in capfd.readouterr().out.splitlines()]


def test_nothing_is_saved_unless_asked(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    before = blend.read_bytes()
    code, lines = events(capfd, "bake", blend, *FAST, "--inject")
    assert code == 0
    assert [line["probe"] for line in lines if line["event"] == "baked"] == ["Other", "Room"]
    assert blend.read_bytes() == before


def test_bake_inject_status_remove_round_trip(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    _, lines = events(capfd, "status", blend)
    assert {line["state"] for line in lines} == {"unbaked"}
    code, lines = events(capfd, "bake", blend, *FAST, "--probe", "Room", "--inject", "--save")
    assert code == 0
    assert [(line["material"], line["probe"]) for line in lines if line["event"] == "injected"] == [("Mirror", "Room")]
    _, lines = events(capfd, "status", blend)
    assert {line["probe"]: line["state"] for line in lines} == {"Room": "baked", "Other": "unbaked"}
    code, lines = events(capfd, "bake", blend, "--probe", "Room", "--stale")
    assert code == 0 and not [line for line in lines if line["event"] == "baked"]
    code, lines = events(capfd, "remove", blend, "--save")
    assert [line["material"] for line in lines if line["event"] == "restored"] == ["Mirror"]
    for again in (("inject", blend), ("bake", blend, "--probe", "Room", "--stale", "--inject")):
        code, lines = events(capfd, *again)
        assert code == 0 and "Mirror" in {line["material"] for line in lines if line["event"] == "injected"}


def test_locked_probes_are_baked_by_name_alone(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.data.objects["Other"].pcc_probe.locked = True
    bpy.ops.wm.save_mainfile()
    for arguments, baked in (((), ["Room"]), (("--stale",), ["Room"]), (("--probe", "Other"), ["Other"])):
        code, lines = events(capfd, "bake", blend, *FAST, *arguments)
        assert code == 0 and [line["probe"] for line in lines if line["event"] == "baked"] == baked
        told = [line["note"] for line in lines if line["event"] == "note"]
        assert any("'Other' is left as it is: it is locked" in note for note in told) == (baked == ["Room"])


def test_a_picture_is_shown_instead_of_a_bake(capfd: pytest.CaptureFixture[str], blend: Path, tmp_path: Path) -> None:
    picture = tmp_path / "sky.exr"
    write_file(picture, np.full((32, 64, 3), 0.5, np.float32))
    asked = ("bake", blend, *FAST, "--probe", "Room", "--picture")
    code, lines = events(capfd, *asked, picture, "--inject", "--save")
    assert code == 0 and [line["probe"] for line in lines if line["event"] == "baked"] == ["Room"]
    _, lines = events(capfd, "status", blend)
    assert {line["probe"]: line["state"] for line in lines} == {"Room": "baked", "Other": "unbaked"}
    code, lines = events(capfd, "plan", blend)
    assert code == 0 and "stretched" in str(next(line for line in lines if line.get("probe") == "Room"))
    for wrong, why in ((tmp_path / "gone.exr", "does not exist"), (blend, "cannot be read")):
        code, lines = events(capfd, *asked, wrong)
        assert code == 1 and any(why in line.get("error", "") and "'Room'" in line["error"] for line in lines)
    picture.unlink()
    code, lines = events(capfd, "status", blend)
    assert code == 1 and "does not exist" in next(line for line in lines if line.get("state") == "error")["why"]


def test_frames_are_baked_told_and_kept_up_to_date(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    wall = bpy.data.objects["Wall +X"]
    for frame, x in ((3, wall.location.x), (4, wall.location.x + 0.5)):
        wall.location.x = x
        wall.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(2)
    bpy.ops.wm.save_mainfile()
    asked = ("bake", blend, *FAST, "--probe", "Room")
    code, lines = events(capfd, *asked, "--frames", "1-5", "--save")
    [baked] = [line for line in lines if line["event"] == "baked"]
    assert code == 0 and (baked["frames"], baked["pictures"], baked["rendered"]) == ("1-5", 2, 2)
    messages = [line["message"] for line in lines if line["event"] == "progress"]
    assert "frame 4, Room: face -Z" in messages and "frame 5: reading the scene" in messages
    code, lines = events(capfd, "status", blend)
    assert next(line for line in lines if line["probe"] == "Room")["frames"] == "1-5"
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert bpy.context.scene.frame_current == 2
    bpy.data.objects["Wall +X"].location.x += 0.25
    bpy.data.objects["Wall +X"].keyframe_insert("location", frame=5)
    bpy.ops.wm.save_mainfile()
    code, lines = events(capfd, "status", blend)
    [status] = [line for line in lines if line["probe"] == "Room"]
    assert status["state"] == "stale" and status["stale_frames"] == [5]
    code, lines = events(capfd, *asked, "--stale", "--save")
    [baked] = [line for line in lines if line["event"] == "baked"]
    assert (baked["frames"], baked["pictures"], baked["rendered"]) == ("1-5", 3, 1)
    code, lines = events(capfd, *asked, "--frames", "still", "--save")
    assert [line["frames"] for line in lines if line["event"] == "baked"] == [""]
    assert bpy.data.objects["Room"].pcc_probe.levels[0].image.source == "FILE"


def test_output_has_its_own_pictures_beside_it(capfd: pytest.CaptureFixture[str], blend: Path, tmp_path: Path) -> None:
    target = tmp_path / "elsewhere" / "copy.blend"
    target.parent.mkdir()
    before = blend.read_bytes()
    code, _ = events(capfd, "bake", blend, *FAST, "--probe", "Room", "--engine", "cycles", "--output", target)
    assert code == 0 and blend.read_bytes() == before
    bpy.ops.wm.open_mainfile(filepath=str(target))
    image = bpy.data.objects["Room"].pcc_probe.levels[0].image
    path = Path(bpy.path.abspath(image.filepath))
    assert image.filepath.startswith("//copy.pcc")
    assert path.is_file() and path.parent == target.with_suffix(".pcc")
    sidecar = json.loads(next(path.parent.glob("*.json")).read_text())
    assert sidecar["engine"] == "CYCLES" and sidecar["resolution"] == 16


def test_the_module_runs_as_a_program(blend: Path) -> None:
    command = [sys.executable, "-m", "pcc_addon", "bake", str(blend), *FAST, "--probe", "Room", "--json"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert [json.loads(line)["event"] for line in done.stdout.splitlines()][-1] == "baked"


def test_the_plan_names_probes_materials_objects_and_reasons(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    code, found = events(capfd, "plan", blend)
    assert code == 0
    [mirror] = [e for e in found if e.get("material") == "Mirror"]
    assert mirror["objects"] == [{"object": "Wall -Z", "probe": name} for name in ("Other", "Room")], "of one box"
    assert mirror["surfaces"][0]["effects"] and mirror["surfaces"][0]["reasons"]
    glow = [e for e in found if str(e.get("material", "")).startswith("Glow")]
    assert glow and all(not e["probes"] and e["reasons"] for e in glow)
    probes = [e for e in found if e.get("about") == "probe"]
    assert len(probes) == 2 and all("radiance-0" in e["pictures"] and e["reasons"] for e in probes)


def test_the_plan_is_readable_and_the_operator_tells_the_same(capfd: pytest.CaptureFixture[str], blend: Path) -> None:
    capfd.readouterr()
    assert run_in_blender(["plan", str(blend)]) == 0
    text = capfd.readouterr().out
    assert "material 'Mirror': 'Other'" in text and "object 'Wall -Z' shows" in text
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert bpy.ops.pcc.plan() == {"FINISHED"}
