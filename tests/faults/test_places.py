"""Folders that cannot be written, that are full, that vanish meanwhile."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.bake.job import BakeJob
from pcc_addon.blender.read.probes import all_probes
from pcc_addon.blender.store.levels import bake_folder
from pcc_addon.cli import run_in_blender

from .hall import Hall, changed, check, check_next_bake, run, settings
from .tally import fault

Mount = Callable[[str], Path]


def moved_to(place: Hall, folder: Path) -> Hall:
    """The hall on another disk."""
    moved = place.copied_to(folder)
    shutil.rmtree(place.folder)
    place.temporary.mkdir(parents=True)
    return moved


def but_for_sidecars(place: Hall) -> dict[str, bytes]:
    """Every file; sidecars describe the newest bake, saved or not."""
    return {name: content for name, content in place.everything().items() if not name.endswith(".json")}


def told(capfd: pytest.CaptureFixture[str]) -> list[str]:
    return [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]


def fill(disk: Path, leave: int) -> Path:
    """Leave so many bytes on a disk."""
    with pytest.raises(OSError), (disk / "filler").open("wb", buffering=0) as file:
        while file.write(bytes(4096)) == 4096:
            pass
        raise OSError
    os.truncate(disk / "filler", (disk / "filler").stat().st_size - leave)
    return disk / "filler"


@pytest.mark.parametrize("leave", [0, 8192, 60_000, 100_000])
def test_a_disk_that_is_really_full(place: Hall, mounted: Mount, capfd, leave: int) -> None:
    disk = mounted("size=4m")
    moved = moved_to(place, disk / "hall")
    filler = fill(disk, leave)
    before = but_for_sidecars(moved)
    capfd.readouterr()
    with fault("a small disk that is full"):
        assert run(moved) == 1
        lines = told(capfd)
        assert lines and all("free space" in line and str(disk) in line for line in lines), lines
        after = but_for_sidecars(moved)
        assert {name: after.get(name) for name in before} == before, "nothing was saved, as nothing could be"
        filler.unlink()
        check(moved)


def test_a_disk_with_room_for_the_pictures_and_not_for_the_file(place: Hall, mounted: Mount, capfd) -> None:
    """Blender reports success where it wrote half of a file."""
    disk = mounted("size=4m")
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    bpy.context.scene.pcc.folder = str(place.folder / "pictures")
    there = disk / "hall.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(there))
    before = there.read_bytes()
    filler = fill(disk, len(before) // 2)
    capfd.readouterr()
    with fault("a small disk that is full"):
        assert run_in_blender(["bake", str(there), "--save"]) == 1
        [line] = told(capfd)
        assert "cannot be saved" in line and "free space" in line
        assert there.read_bytes() == before
        assert sorted(path.name for path in disk.iterdir()) == ["filler", "hall.blend"]
        filler.unlink()
        assert run_in_blender(["bake", str(there), "--save"]) == 0


def test_a_disk_that_is_read_only(place: Hall, mounted: Mount, capfd) -> None:
    disk = mounted("ro")
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    bpy.context.scene.pcc.folder = str(disk)
    bpy.ops.wm.save_mainfile()
    before = place.everything()
    capfd.readouterr()
    with fault("a folder that cannot be written"):
        assert run(place) == 1
        [line] = told(capfd)
        assert str(disk) in line and "choose another folder" in line
        assert place.everything() == before


def test_a_write_protected_file_stays(place: Hall, capfd) -> None:
    place.blend.chmod(0o444)
    before = place.everything()
    capfd.readouterr()
    with fault("a file that cannot be written"):
        assert run(place) == 1
        [line] = told(capfd)
        assert str(place.blend) in line and "--output" in line
        assert run(place, "bake", f"--output={place.blend}") == 1
        assert place.everything() == before
        place.blend.chmod(0o644)
        check(place)


def test_a_file_in_the_folders_place_is_told(place: Hall, capfd) -> None:
    shutil.rmtree(place.pictures)
    place.pictures.write_text("in the way")
    capfd.readouterr()
    with fault("a folder that cannot be written"):
        assert run(place) == 1
        [line] = told(capfd)
        assert "choose another folder" in line
        assert place.pictures.read_text() == "in the way"
        place.pictures.unlink()
        check_next_bake(place)


@pytest.mark.sweep
@pytest.mark.parametrize("when", ["Preparing", "face", "storing"])
@pytest.mark.parametrize("what", ["the folder", "all that is in it", "a file instead"])
def test_a_folder_may_vanish_during_a_bake(place: Hall, what: str, when: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    before = settings()
    blend = place.blend.read_bytes()
    job = BakeJob(scene, view_layer, all_probes(scene), bake_folder(scene))
    with fault("a folder that vanishes during a bake"):
        while job.step():
            if when in job.message and place.pictures.is_dir():
                shutil.rmtree(place.pictures)
                if what == "all that is in it":
                    place.pictures.mkdir()
                if what == "a file instead":
                    place.pictures.write_text("in the way")
        for result in job.results:
            assert result.error is None or (result.probe in result.error and str(place.pictures) in result.error)
        assert len(job.results) == 2
        assert not changed(before)
        assert place.blend.read_bytes() == blend
        if place.pictures.is_file():
            place.pictures.unlink()
        check_next_bake(place)
