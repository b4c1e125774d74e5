"""A file that is saved, saved elsewhere, packed, moved: it shows its probes, and nobody else's pictures change."""

from __future__ import annotations

import shutil
from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.saving import save_whole
from pcc_addon.core.errors import PccError
from tests.blender.filing import check, check_nothing_pink, opened, seen, shown, status, works_again
from tests.blender.helpers import contents, pictures_of, save


def probe() -> bpy.types.Object:
    return bpy.data.objects["Probe"]


def test_a_file_that_is_opened_again_is_as_it_was_saved(home: Path) -> None:
    before = seen()
    check()
    for _ in range(2):
        save(home)
        opened(home)
        check()
    assert np.array_equal(seen(), before) and shown() == shown("Wood") == ["Probe"]
    works_again()


def test_a_file_that_is_saved_in_another_folder_shows_the_same(home: Path, tmp_path: Path) -> None:
    before, first = seen(), contents(home.parent)
    other = tmp_path / "away" / "deep" / "other.blend"
    other.parent.mkdir(parents=True)
    save(other)
    check()
    assert any("used-by" in name for name in contents(home.parent)), "or the first file's next bake would remove them"
    opened(other)
    check()
    assert np.array_equal(seen(), before)
    works_again()
    save(other)
    after = contents(home.parent)
    assert after == first, "the first file's pictures are its own, and nobody else says that he needs them"
    opened(other)
    check()


def test_where_paths_are_not_remapped_on_purpose_status_says_what_is_missing(home: Path, tmp_path: Path) -> None:
    (tmp_path / "away").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "away" / "other.blend"), relative_remap=False)
    assert status().state == "stale" and f"{tmp_path / 'away' / 'room.pcc'}" in status().why
    shutil.copytree(home.with_suffix(".pcc"), tmp_path / "away" / "room.pcc")
    check()


def test_what_is_baked_after_saving_elsewhere_lies_beside_the_new_file(home: Path, tmp_path: Path) -> None:
    save(tmp_path / "other.blend")
    works_again()
    assert {path.parent for path in pictures_of(probe())} == {tmp_path / "other.pcc"}


@pytest.mark.parametrize("how", ["absolute", "relative"])
def test_paths_may_be_absolute_or_relative(home: Path, how: str) -> None:
    before = seen()
    getattr(bpy.ops.file, f"make_paths_{how}")()
    save(home)
    opened(home)
    check()
    assert np.array_equal(seen(), before)


@pytest.mark.parametrize("unpack", ["USE_LOCAL", "WRITE_LOCAL", "USE_ORIGINAL", "WRITE_ORIGINAL", "REMOVE"])
def test_pictures_may_be_packed_and_unpacked(home: Path, unpack: str) -> None:
    before = seen()
    bpy.ops.file.pack_all()
    check()
    save(home)
    opened(home)
    check()
    assert np.array_equal(seen(), before)
    bpy.ops.file.unpack_all(method=unpack)
    save(home)
    opened(home)
    assert np.array_equal(seen(), before)
    check()
    works_again()


def test_a_packed_file_needs_no_folder(home: Path, tmp_path: Path) -> None:
    before = seen()
    bpy.ops.file.pack_all()
    save(home)
    moved = tmp_path / "alone.blend"
    shutil.move(home, moved)
    shutil.rmtree(home.parent)
    opened(moved)
    check()
    assert np.array_equal(seen(), before)
    works_again()


@pytest.mark.parametrize("renamed", [False, True])
def test_a_folder_may_be_moved_whole_and_its_file_renamed(home: Path, tmp_path: Path, renamed: bool) -> None:
    before = seen()
    shutil.move(home.parent, tmp_path / "Büro 二階")
    blend = tmp_path / "Büro 二階" / home.name
    if renamed:
        blend = blend.rename(blend.with_name("other.blend"))
    opened(blend)
    check()
    assert np.array_equal(seen(), before)
    works_again()
    save(blend)
    opened(blend)
    check()


@pytest.mark.parametrize("why", ["left behind", "renamed"])
def test_a_file_without_its_folder_says_which_picture_is_missing_and_is_baked_again(
    home: Path, tmp_path: Path, why: str
) -> None:
    if why == "renamed":
        home.with_suffix(".pcc").rename(home.parent / "old.pcc")
    else:
        home = Path(shutil.move(home, tmp_path / "alone.blend"))
    opened(home)
    found = status()
    assert found.state == "stale" and "is missing; bake it again" in found.why and ".exr'" in found.why
    with pytest.raises(RuntimeError, match="missing"):
        bpy.ops.pcc.inject()
    works_again()
    save(home)
    opened(home)
    check_nothing_pink()


def test_two_files_in_a_folder_with_probes_of_one_name_keep_apart(home: Path) -> None:
    first = contents(home.parent)
    for name in ("two", "three"):
        save(home.with_name(f"{name}.blend"))
        probe().pcc_probe.resolution += 8
        bpy.ops.pcc.bake(scope="ALL")
        save(home.with_name(f"{name}.blend"))
    for name in ("room", "two", "three"):
        opened(home.with_name(f"{name}.blend"))
        check()
    after = contents(home.parent)
    assert {name: after[name] for name in first} == first


def test_a_file_that_lost_something_while_it_was_written_leaves_the_old_one(home: Path) -> None:
    """As on a disk that is full for a moment only: Blender says nothing where one write fails and others do not."""
    before, files = home.read_bytes(), sorted(home.parent.iterdir())
    bpy.data.materials.new("New").use_fake_user = True

    def lose(path: str, _: object) -> None:
        shutil.copy(home, path)

    bpy.app.handlers.save_post.append(lose)
    try:
        with pytest.raises(PccError, match="'New' of materials is not in what was written"):
            save_whole(home)
    finally:
        bpy.app.handlers.save_post.remove(lose)
    assert home.read_bytes() == before and sorted(home.parent.iterdir()) == files
    save_whole(home)
    opened(home)
    assert "New" in bpy.data.materials
