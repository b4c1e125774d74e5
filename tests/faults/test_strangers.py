"""What a .blend from a stranger may do to the files of who opens, bakes and saves it (docs/files.md says it)."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.read.probes import all_probes, bake_record
from pcc_addon.blender.status import statuses
from pcc_addon.core.sidecar import sidecar_file

from .hall import Hall, check_next_bake, run
from .tally import fault

MINE = "mine, and nobody else's"


def opened(place: Hall) -> dict[str, bpy.types.Object]:
    bpy.ops.wm.open_mainfile(filepath=str(place.blend))
    return {probe.name: probe for probe in all_probes(bpy.context.scene)}


def written_for(place: Hall, name: str = "Probe") -> str:
    """What the sidecar of a probe is called."""
    return sidecar_file(name, opened(place)[name].pcc_probe.uid)


def points_to(place: Hall, folder: Path) -> None:
    """Let the file's folder of pictures be another one."""
    opened(place)
    bpy.context.scene.pcc.folder = str(folder)
    bpy.ops.wm.save_mainfile()


@pytest.fixture
def victim(tmp_path: Path) -> Path:
    """A folder of somebody's, with files of many names."""
    folder = tmp_path / "victim"
    (folder / "deeper").mkdir(parents=True)
    for name in ("letter.txt", "picture.exr", "notes.json", ".profile", "deeper/file", "hall.blend"):
        (folder / name).write_text(MINE)
    return folder


def untouched(victim: Path, *besides: str) -> None:
    names = ("letter.txt", "picture.exr", "notes.json", ".profile", "deeper/file", "hall.blend", *besides)
    assert {name: (victim / name).read_text() for name in names} == dict.fromkeys(names, MINE)


def test_a_folder_anywhere_gets_files_of_our_names_and_loses_none(place: Hall, victim: Path) -> None:
    ours = set(place.old | place.new)
    points_to(place, victim)
    with fault("a stranger's file"):
        for _ in range(3):  # old pictures go at the second save
            assert run(place) == 0
        untouched(victim)
        added = {path.name for path in victim.iterdir()}
        assert added - ours == {"letter.txt", "picture.exr", "notes.json", ".profile", "deeper", "hall.blend"}


def test_a_file_that_is_called_like_a_sidecar_of_ours_is_not_written_over(
    place: Hall, victim: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    name = written_for(place)
    (victim / name).write_text(MINE)
    points_to(place, victim)
    with fault("a stranger's file"):
        assert run(place) == 1
        [line] = [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]
        assert "'Probe'" in line and str(victim / name) in line and "move it away" in line
        untouched(victim, name)
        (victim / name).unlink()
        assert run(place) == 0


@pytest.mark.skipif(os.name != "posix", reason="links need no rights on POSIX systems alone")
def test_links_are_not_written_through(place: Hall, victim: Path) -> None:
    """Links lie in the folder that came with the file, where files of ours will be."""
    sidecar = written_for(place)
    for name in place.new - place.old:
        (place.pictures / name).symlink_to(victim / "picture.exr")
    (place.pictures / sidecar).unlink()
    (place.pictures / sidecar).symlink_to(victim / "notes.json")
    with fault("a stranger's file"):
        assert run(place) == 1, "the sidecar's name leads to what is none of ours"
        untouched(victim)
        (place.pictures / sidecar).unlink()
        (place.pictures / sidecar).symlink_to(victim / "nothing.json")
        assert run(place) == 0
        untouched(victim)
        assert not (victim / "nothing.json").exists()
        check_next_bake(place)


@pytest.mark.skipif(os.name != "posix", reason="links need no rights on POSIX systems alone")
def test_notes_for_other_files_are_not_written_through_links(place: Hall, victim: Path) -> None:
    theirs = place.copied_to(victim.parent / "theirs")
    opened(place)
    for image in bpy.data.images:
        if image.filepath:
            image.filepath = str(theirs.pictures / Path(image.filepath).name)
    bpy.ops.wm.save_mainfile()
    [note] = theirs.pictures.glob(".used-by-*")
    note.unlink()
    note.symlink_to(victim / ".profile")
    with fault("a stranger's file"):
        bpy.ops.wm.save_mainfile()
        untouched(victim)
        assert json.loads(note.read_text())["blend"] == str(place.blend.resolve()) and not note.is_symlink()


@pytest.mark.skipif(os.name != "posix", reason="links need no rights on POSIX systems alone")
def test_nothing_is_removed_through_a_link(place: Hall, victim: Path) -> None:
    """The same probes in another file, whose pictures lie where the link leads to."""
    theirs = place.copied_to(victim.parent / "theirs")
    before = theirs.everything()
    for path in place.pictures.iterdir():
        path.unlink()
    place.pictures.rmdir()
    place.pictures.symlink_to(theirs.pictures)
    with fault("a stranger's file"):
        for _ in range(3):
            assert run(place) == 0
        after = theirs.everything()
        assert {name: after.get(name) for name in before if name.endswith(".exr")} == {
            name: content for name, content in before.items() if name.endswith(".exr")
        }


def test_a_record_that_names_a_path_is_refused_and_mended_by_a_bake(place: Hall, victim: Path) -> None:
    probe = opened(place)["Probe"]
    record = bake_record(probe)
    for path in (str(victim / "picture.exr"), "../../victim/picture.exr", "..\\..\\victim\\picture.exr"):
        with fault("a stranger's file"):
            levels = tuple(replace(level, file=path) for level in record.levels)
            probe.pcc_probe.bake_record = replace(record, levels=levels).to_json()
            bpy.ops.wm.save_mainfile()
            untouched(victim)
            [status] = [s for s in statuses(bpy.context.scene, bpy.context.view_layer) if s.probe == "Probe"]
            assert status.state == "error" and "bake" in status.words
    assert run(place) == 0
    untouched(victim)
    check_next_bake(place)


def test_images_of_probes_that_are_anybodys_files_are_left_alone(place: Hall, victim: Path) -> None:
    for probe in opened(place).values():
        for level in probe.pcc_probe.levels:
            level.image.filepath = str(victim / "picture.exr")
    bpy.ops.wm.save_mainfile()
    with fault("a stranger's file"):
        for _ in range(3):
            assert run(place) == 0
        untouched(victim)
        assert len(list(victim.iterdir())) == 6


def test_what_others_left_unfinished_stays(place: Hall, victim: Path) -> None:
    """Their names say that they are of another machine, or say nothing."""
    names = (".unfinished-00000000-00000000-1-abc", ".unfinished-mine", "pcc-mine")
    for name in names:
        (victim / name).mkdir()
    points_to(place, victim)
    with fault("a stranger's file"):
        assert run(place) == 0
        untouched(victim)
        assert all((victim / name).is_dir() for name in names)
