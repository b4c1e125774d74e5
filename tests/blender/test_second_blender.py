"""The copy that a second Blender works on, and how that one ends."""

from __future__ import annotations

import io
import os
from contextlib import ExitStack
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.second_blender import SecondBlender, snapshot
from pcc_addon.cli.voice import Voice
from pcc_addon.core.errors import Cancelled, PccError
from pcc_addon.core.workplace import workplace
from tests.blender.helpers import contents, save, small_room


def objects_in(blend: Path) -> set[str]:
    with bpy.data.libraries.load(str(blend)) as (found, _):
        return set(found.objects)


def test_the_copy_holds_what_is_not_saved_and_changes_nothing(scene, tmp_path: Path) -> None:
    small_room()
    picture = bpy.data.images.new("Rug", 4, 4)
    picture.filepath_raw, picture.file_format = str(tmp_path / "rug.png"), "PNG"
    picture.save()
    picture = bpy.data.images.load(str(tmp_path / "rug.png"))
    save(tmp_path / "room.blend")
    bpy.data.objects["Probe"].name = "Not saved"
    bpy.data.use_autopack = True
    filepaths, before = bpy.context.preferences.filepaths, contents(tmp_path)
    kept = (bpy.data.filepath, filepaths.file_preview_type, bpy.context.preferences.is_dirty)
    with ExitStack() as stack:
        copy = snapshot(stack, workplace(stack))
        assert copy.parent == tmp_path and "Not saved" in objects_in(copy)
        assert (bpy.data.filepath, filepaths.file_preview_type, bpy.context.preferences.is_dirty) == kept
        assert bpy.data.use_autopack and picture.packed_file is None
    bpy.data.use_autopack = False
    assert contents(tmp_path) == before


def test_the_copy_holds_what_is_edited(scene, tmp_path: Path) -> None:
    bpy.ops.mesh.primitive_cube_add()
    save(tmp_path / "room.blend")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="FACE")
    with ExitStack() as stack:
        with bpy.data.libraries.load(str(snapshot(stack, workplace(stack)))) as (_, taken):
            taken.meshes = ["Cube"]
        assert bpy.context.mode == "EDIT_MESH"
        assert len(taken.meshes[0].polygons) == 0
    bpy.ops.object.mode_set(mode="OBJECT")


def test_where_no_copy_can_be_saved_the_folder_is_named(scene, tmp_path: Path, monkeypatch) -> None:
    save(tmp_path / "room.blend")
    (tmp_path / "room.blend").rename(tmp_path.with_name("elsewhere.blend"))
    tmp_path.rmdir()
    with ExitStack() as stack, pytest.raises(PccError, match=r"no copy of the file can be saved beside '.*room.blend'"):
        snapshot(stack, workplace(stack))


def test_it_is_ended_at_once_and_its_temporary_files_go(scene, tmp_path: Path) -> None:
    small_room()
    save(tmp_path / "room.blend")
    with ExitStack() as stack:
        place = workplace(stack)
        blender = SecondBlender(snapshot(stack, place), "bake", [f"--folder={tmp_path / 'out'}"], place)
        event = next(event for _ in range(1000) for event in blender.news(1.0) if event["event"] == "progress")
        assert event["probe"] == ""
        blender.stop()
        while blender.code is None:
            list(blender.news(1.0))
        assert blender.code < 0
    assert not place.exists()


def test_what_it_says_last_is_known(scene, tmp_path: Path) -> None:
    small_room()
    save(tmp_path / "room.blend")
    with ExitStack() as stack:
        place = workplace(stack)
        blender = SecondBlender(tmp_path / "room.blend", "bake", ["--probe=Attic"], place)
        told = []
        while blender.code is None:
            told += blender.news(1.0)
        assert blender.code == 1 and "no probe is called 'Attic'" in blender.last_words
        assert [event["event"] for event in told] == ["error"]


class Broken(io.StringIO):
    def write(self, text: str) -> int:
        raise BrokenPipeError(32, "Broken pipe")


def test_work_for_somebody_who_listens_ends_with_them_and_other_work_does_not() -> None:
    with pytest.raises(Cancelled, match="is gone"):
        Voice(Broken(), True, attended=True).progress(0.5, "face +X")
    alone = Voice(Broken(), True)
    alone.progress(0.5, "face +X")
    assert alone.lost == "Broken pipe"


@pytest.mark.skipif(not hasattr(os, "getpriority"), reason="no POSIX system")
@pytest.mark.parametrize("gives_way", [False, True])
def test_a_second_blender_that_gives_way_is_less_urgent_than_this_one(scene, tmp_path: Path, gives_way: bool) -> None:
    save(tmp_path / "room.blend")
    blender = SecondBlender(tmp_path / "room.blend", "status", [], tmp_path, gives_way=gives_way)
    try:
        own, other = (os.getpriority(os.PRIO_PROCESS, pid) for pid in (0, blender._process.pid))
    finally:
        blender.stop()
    assert (other > own or own == 19) if gives_way else other == own
