"""Bakes that go on where they were killed, that several processes share, and what they leave."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.bake.capture import Stage
from pcc_addon.cli import run_in_blender
from pcc_addon.core.manifest import entries
from tests.blender.helpers import contents, small_probe, small_room

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("Probe", "Second")


class Killed(BaseException):
    """Ends a bake at once, as far as a process that goes on can."""


@pytest.fixture
def blend(tmp_path: Path) -> Path:
    """A saved file with two probes that were never baked; afterwards no file is open."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    small_room()
    small_probe("Second", half_extents=(1.0, 1.0, 0.5))
    for name in NAMES:
        bpy.data.objects[name].pcc_probe.effects.levels = "AUTO"
    path = tmp_path / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


@pytest.fixture
def rendered(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Which faces were rendered, in order."""
    found, face = [], Stage.face

    def counted(self: Stage, probe, index: int):
        found.append(f"{probe.name} {index}")
        return face(self, probe, index)

    monkeypatch.setattr(Stage, "face", counted)
    return found


def pcc(*arguments: object) -> int:
    return run_in_blender([str(each) for each in arguments])


def pictures(folder: Path) -> dict[str, bytes]:
    return {name: data for name, data in contents(folder).items() if name.endswith(".exr")}


def whole(blend: Path) -> dict[str, bytes]:
    """The pictures that a bake in one go makes, which are the same as its place is."""
    assert pcc("bake", blend) == 0
    folder = blend.with_suffix(".pcc")
    found = pictures(folder)
    for path in sorted(folder.rglob("*"), reverse=True):
        path.unlink()
    return found


@pytest.mark.parametrize("at", [0, 3, 7])
def test_a_killed_bake_goes_on_and_repeats_one_face_at_most(blend, monkeypatch, rendered, at: int) -> None:
    expected = whole(blend)
    count, face = len(rendered), Stage.face
    rendered.clear()

    def killed(self: Stage, probe, index: int):
        found = face(self, probe, index)
        if len(rendered) > at:
            raise Killed
        return found

    with monkeypatch.context() as patch:
        patch.setattr(Stage, "face", killed)
        with pytest.raises(Killed):
            pcc("bake", blend)
    assert pcc("bake", blend, "--resume", "--save") == 0
    assert len(rendered) <= count + 1 and pictures(blend.with_suffix(".pcc")) == expected
    rendered.clear()
    assert pcc("bake", blend, "--resume") == 0 and not rendered
    assert not (blend.with_suffix(".pcc") / ".faces").exists()


@pytest.mark.parametrize("of", [2, 5])
def test_shares_together_are_the_bake(capfd, blend, rendered, of: int) -> None:
    expected = whole(blend)
    count = len(rendered)
    rendered.clear()
    for number in (*range(1, of + 1), 1):  # the last as a retry
        assert pcc("bake", blend, "--resume", "--share", f"{number}/{of}") == 0
    assert len(rendered) == len(set(rendered)) == count
    capfd.readouterr()
    assert pcc("bake", blend, "--resume", "--save", "--json") == 0
    told = [json.loads(line) for line in capfd.readouterr().out.splitlines()]
    assert sorted(line["probe"] for line in told if line["event"] == "baked") == sorted(NAMES)
    assert len(rendered) == count and pictures(blend.with_suffix(".pcc")) == expected
    assert pcc("status", blend) == 0
    assert capfd.readouterr().out.count(": baked") == 2


def test_a_file_that_is_not_saved_leaves_one_set_of_pictures(blend) -> None:
    assert pcc("bake", blend) == 0
    before = pictures(blend.with_suffix(".pcc"))
    assert pcc("bake", blend) == 0
    assert pictures(blend.with_suffix(".pcc")) == before


def test_the_manifest_says_what_was_done(blend, tmp_path: Path) -> None:
    other = tmp_path / "done.jsonl"
    assert pcc("bake", blend) == 0 and pcc("bake", blend, "--probe", "Second", "--manifest", other) == 0
    lines = entries(blend.with_suffix(".pcc") / "room.bakes.jsonl")
    assert sorted(line["probe"] for line in lines) == sorted(NAMES)
    [line] = entries(other)
    assert line["probe"] == "Second" and line["error"] is None and line["seconds"] > 0.0
    assert line["blender"] == bpy.app.version_string and line["addon"] and line["content_hash"]


def test_files_have_their_turn_whatever_is_wrong_with_one(capfd, blend, tmp_path: Path) -> None:
    broken, copy = tmp_path / "broken.blend", tmp_path / "copy.blend"
    broken.write_bytes(b"nothing")
    copy.write_bytes(blend.read_bytes())
    assert pcc("bake", blend, broken, copy, "--save") == 1
    assert "broken.blend" in capfd.readouterr().err
    for path in (blend, copy):
        assert pcc("status", path) == 0
        assert capfd.readouterr().out.count(": baked") == 2
        assert pictures(path.with_suffix(".pcc"))


def test_cleaning_removes_what_is_ours_and_nobody_shows(capfd, blend) -> None:
    assert pcc("bake", blend, "--save") == 0
    folder = blend.with_suffix(".pcc")
    shown = contents(folder)
    assert pcc("bake", blend, "--resolution", "24") == 0
    (folder / "notes.txt").write_text("mine")
    foreign = folder / "Photo-0123abcd.radiance-0.0123456789ab.exr"
    foreign.write_bytes(b"mine, too")
    assert len(pictures(folder)) > len([name for name in shown if name.endswith(".exr")])
    assert pcc("status", blend, "--clean") == 0
    assert "removed " in capfd.readouterr().out
    assert {name for name in contents(folder) if name.endswith(".exr")} == {
        *(name for name in shown if name.endswith(".exr")),
        foreign.name,
    }
    assert (folder / "notes.txt").read_text() == "mine"
    assert pcc("status", blend) == 0 and capfd.readouterr().out.count(": baked") == 2


@pytest.mark.parametrize(
    "arguments",
    [("--share", "3/2"), ("--share", "1/2", "--save"), ("--jobs", "0"), ("other.blend", "--output", "out.blend")],
)
def test_what_does_not_go_together_is_wrong_usage(blend, arguments: tuple[str, ...]) -> None:
    assert pcc("bake", blend, *arguments) == 2


@pytest.mark.heavy
@pytest.mark.parametrize("killed", [False, True])
def test_processes_share_a_bake(blend, killed: bool) -> None:
    expected = whole(blend)
    command = [sys.executable, "-m", "pcc_addon", "bake", str(blend), "--jobs", "2", "--save"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if killed:
        if os.name != "posix":
            pytest.skip("kills as POSIX systems do")
        for line in process.stdout:
            if "face" in line:
                process.send_signal(signal.SIGKILL)
                break
        process.communicate()
        process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    process.communicate(timeout=300)
    assert process.returncode == 0 and pictures(blend.with_suffix(".pcc")) == expected
