"""Which pictures are removed after a save, and which are not: nobody's pictures are lost."""

from __future__ import annotations

import shutil
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.saving import save_whole
from pcc_addon.blender.status import statuses
from pcc_addon.blender.store import leftovers
from pcc_addon.core.sidecar import Sidecar
from tests.blender.helpers import bake, paint_wall, picture, pictures_of, save, small_probe, small_room


@pytest.fixture
def blend(scene, tmp_path: Path) -> Path:
    """A saved file with a baked probe that its pictures belong to."""
    small_room()
    path = tmp_path / "room.blend"
    save(path)
    bake(the_probe())
    save(path)
    return path


def the_probe(name: str = "Probe") -> bpy.types.Object:
    return bpy.data.objects[name]


def rebaked(resolution: int) -> set[Path]:
    """The pictures of another bake."""
    the_probe().pcc_probe.resolution = resolution
    bake(the_probe())
    return set(pictures_of(the_probe()))


def files(blend: Path) -> set[Path]:
    """All pictures of a file's own folder, which holds one sidecar beside them and nothing else."""
    found = sorted(blend.with_suffix(".pcc").iterdir())
    assert [path.suffix for path in found if path.suffix != ".exr"] == [".json"]
    return {path for path in found if path.suffix == ".exr"}


def state() -> str:
    [status] = statuses(bpy.context.scene, bpy.context.view_layer)
    return status.state


@pytest.mark.parametrize("compressed", [False, True])
def test_the_old_bake_goes_when_no_backup_shows_it_any_more(blend: Path, compressed: bool) -> None:
    first = set(pictures_of(the_probe()))
    second = rebaked(32)
    assert files(blend) == first | second, "the saved file shows the first"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=compressed)
    assert files(blend) == first | second, "the backup shows the first"
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=compressed)
    assert files(blend) == second
    assert state() == "baked"


def test_the_shells_save_removes_them_too(blend: Path) -> None:
    second = rebaked(32)
    save_whole(blend)
    save_whole(blend)
    assert files(blend) == second


def test_bakes_that_were_replaced_before_any_save_go_at_once(blend: Path) -> None:
    first = set(pictures_of(the_probe()))
    rebaked(32)
    third = rebaked(48)
    save(blend)
    assert files(blend) == first | third


def test_files_of_pictures_that_were_packed_before_any_save_go_at_once(blend: Path) -> None:
    kept, new = files(blend), rebaked(32)
    for level in the_probe().pcc_probe.levels:
        level.image.pack()
    save(blend)
    assert new and not new & files(blend) and files(blend) == kept, "the backup shows the first"


def test_images_whose_path_names_no_file_are_no_fault(blend: Path) -> None:
    bpy.data.images.new("Nowhere", 4, 4).filepath = "/"
    second = rebaked(32)
    leftovers.after_save(blend)
    assert second <= files(blend)


def test_a_bake_that_is_not_saved_takes_nothing_away(blend: Path) -> None:
    before = picture(the_probe()).copy()
    rebaked(32)
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert state() == "baked" and (picture(the_probe()) == before).all()


def test_a_bake_of_another_session_that_is_not_saved_yet_stays(blend: Path) -> None:
    unsaved = rebaked(32)
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    for _ in range(3):
        save(blend)
    assert unsaved <= files(blend)


@pytest.mark.parametrize("how", ["copied beside it", "saved elsewhere"])
def test_pictures_that_another_file_shows_stay(blend: Path, tmp_path: Path, how: str) -> None:
    first = set(pictures_of(the_probe()))
    if how == "copied beside it":
        other = shutil.copy(blend, tmp_path / "copy.blend")
    else:
        (tmp_path / "deep").mkdir()
        other = tmp_path / "deep" / "copy.blend"
        save(other)
        bpy.ops.wm.open_mainfile(filepath=str(blend))
    rebaked(32)
    for _ in range(3):
        save(blend)
    assert all(path.is_file() for path in first)
    bpy.ops.wm.open_mainfile(filepath=str(other))
    assert state() == "baked"


def test_a_copy_that_shares_a_chosen_folder_keeps_its_pictures(scene, tmp_path: Path) -> None:
    small_room()
    scene.pcc.folder = str(tmp_path / "shared")
    one, two = tmp_path / "one.blend", tmp_path / "two.blend"
    save(one)
    bake(the_probe())
    save(one)
    shutil.copy(one, two)
    for blend in (one, two):
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        paint_wall()
        rebaked(32 if blend == one else 48)
        save(blend), save(blend), save(blend)
        for path in (one, two):
            bpy.ops.wm.open_mainfile(filepath=str(path))
            assert state() == "baked"


def test_pictures_are_not_removed_while_undo_may_bring_them_back(blend: Path, monkeypatch) -> None:
    class App:
        background = False

    class Windowed:
        app, data, path, types = App, bpy.data, bpy.path, bpy.types

    bpy.ops.ed.undo_push(message="opened")
    second = rebaked(32)
    bpy.ops.ed.undo_push(message="second bake")
    third = rebaked(48)
    bpy.ops.ed.undo_push(message="third bake")
    monkeypatch.setattr(leftovers, "bpy", Windowed)
    save(blend), save(blend)
    assert second | third <= files(blend)
    bpy.ops.ed.undo()
    assert state() == "baked" and set(pictures_of(the_probe())) == second
    bpy.ops.ed.redo()
    monkeypatch.undo()
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert not second & files(blend)


def test_the_sidecar_describes_what_is_saved_where_a_bake_was_undone(blend: Path) -> None:
    first = set(pictures_of(the_probe()))
    bpy.ops.ed.undo_push(message="opened")
    rebaked(32)
    bpy.ops.ed.undo_push(message="second bake")
    bpy.ops.ed.undo()
    save(blend)
    assert files(blend) == first
    [path] = blend.with_suffix(".pcc").glob("*.json")
    assert {path.parent / level.file for level in Sidecar.from_json(path.read_text(), "it").levels} == first


def test_a_deleted_probes_pictures_go_and_others_stay(blend: Path) -> None:
    other = small_probe("Other", half_extents=(1.0, 1.0, 0.5))
    bake(other)
    save(blend)
    bpy.data.objects.remove(the_probe())
    folder = blend.with_suffix(".pcc")
    for name in ("holiday.exr", "Probe-12345678.radiance-0.0123456789ab.exr", "notes.json"):
        (folder / name).write_text("another's")
    kept = set(pictures_of(other))
    bpy.data.orphans_purge(do_recursive=True)
    save(blend), save(blend)
    left = {path for path in folder.iterdir() if path.read_bytes() != b"another's"}
    assert {path for path in left if path.suffix == ".exr"} == kept and len(left) == len(kept) + 1
    assert len(list(folder.iterdir())) == len(left) + 3


def test_a_renamed_probes_old_files_go(blend: Path) -> None:
    old = set(blend.with_suffix(".pcc").iterdir())
    the_probe().name = "Hall"
    bake(the_probe("Hall"))
    save(blend)
    assert old < set(blend.with_suffix(".pcc").iterdir()), "the backup shows them, and the sidecar describes them"
    save(blend)
    assert all(path.name.startswith("Hall-") for path in blend.with_suffix(".pcc").iterdir())


@pytest.mark.parametrize("why", ["damaged", "too large"])
def test_where_neighbours_cannot_be_read_nothing_is_removed(blend: Path, tmp_path: Path, monkeypatch, why: str) -> None:
    if why == "too large":
        monkeypatch.setattr(leftovers, "_MOST_BYTES", 1000)
    else:
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), compress=True)
        whole = blend.read_bytes()
        (tmp_path / "torn.blend").write_bytes(whole[:1000] + bytes(1000) + whole[2000:])
    first, second = set(pictures_of(the_probe())), rebaked(32)
    for _ in range(3):
        save(blend)
    assert files(blend) == first | second
