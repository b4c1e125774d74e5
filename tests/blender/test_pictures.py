"""Picture files: every number comes back, what cannot be read or written is named, and no data block stays."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from pcc_addon.blender.store import pictures
from pcc_addon.core.errors import BakeError
from tests.blender.helpers import save

pytestmark = pytest.mark.usefixtures("scene")

PICTURE = np.random.default_rng(2).uniform(-1.0, 4.0, (4, 8, 3)).astype(np.float32)
PICTURE[0, 0], PICTURE[3, 7] = (1e30, 1e-30, 0.0), (70000.0, 0.1, 1.0 + 2.0**-23)


def blocks() -> list[str]:
    return [item.name for kind in (bpy.data.images, bpy.data.scenes) for item in kind]


def test_every_number_comes_back_and_no_data_block_stays(tmp_path: Path) -> None:
    before = blocks()
    with pictures.desk():
        for k, picture in enumerate((PICTURE, PICTURE[:2], PICTURE[:, :4], 2.0 * PICTURE)):
            pictures.write_file(tmp_path / f"{k}.exr", picture)
        np.testing.assert_array_equal(pictures.read_file(tmp_path / "1.exr"), PICTURE[:2])
        assert len(blocks()) == len(before) + 5, "three sizes, one to read and a scene"
    assert blocks() == before
    for k, picture in enumerate((PICTURE, PICTURE[:2], PICTURE[:, :4], 2.0 * PICTURE)):
        np.testing.assert_array_equal(pictures.read_file(tmp_path / f"{k}.exr"), picture)
        assert blocks() == before
    with pytest.raises(ZeroDivisionError), pictures.desk():
        raise ZeroDivisionError
    with pictures.desk() as first, pictures.desk() as second:
        assert first is second
    assert blocks() == before


def test_a_picture_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    path = tmp_path / "gone.exr"
    pictures.write_file(path, PICTURE)
    image = pictures.load(path)
    image.name = "Gone"
    assert pictures.check_pixels("Hall", image) == 4
    path.unlink()
    image.reload()
    with pytest.raises(BakeError, match=rf"picture 'Gone' \({path}\) cannot be read; bake its probe again"):
        pictures.read_pixels(image)
    with pytest.raises(BakeError, match=r"'Hall': its picture 'Gone' is missing or cannot be read; bake it again"):
        pictures.check_pixels("Hall", image)
    with pytest.raises(BakeError, match=r"'Hall': its picture 'of a level' is missing"):
        pictures.check_pixels("Hall", None)
    with pytest.raises(BakeError, match=r"'Square' is missing or cannot be read"):
        pictures.check_pixels("Hall", bpy.data.images.new("Square", 4, 4))


def test_a_picture_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    path = tmp_path / "file" / "a.exr"
    with pytest.raises(
        BakeError, match=rf"cannot write '{path}' \(.+\); free space on the disk or choose another folder"
    ):
        pictures.write_file(path, PICTURE)
    assert len(bpy.data.images) == 0


@pytest.mark.parametrize("left", [-40, 200, 0], ids=["its end", "most of it", "all of it"])
def test_a_file_that_a_full_disk_cut_short_is_removed_and_named(tmp_path: Path, monkeypatch, left: int) -> None:
    path, calls = tmp_path / "a.exr", []
    read_file = pictures.read_file

    def cut(_: Path) -> np.ndarray:
        calls.append(path.write_bytes(path.read_bytes()[:left]))
        return read_file(path)

    monkeypatch.setattr(pictures, "read_file", cut)
    with pytest.raises(BakeError, match=rf"cannot write '{path}' \(the file came out incomplete\)"):
        pictures.write_file(path, PICTURE)
    assert calls and not path.exists()


def test_a_whole_file_is_one_of_its_size_that_can_be_read(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    assert not pictures.is_whole(path, 8, 4)
    pictures.write_file(path, PICTURE)
    assert pictures.is_whole(path, 8, 4) and not pictures.is_whole(path, 8, 5) and not pictures.is_whole(path, 4, 4)
    path.write_bytes(path.read_bytes()[:200])
    assert not pictures.is_whole(path, 8, 4)
    path.write_bytes(b"")
    assert not pictures.is_whole(path, 8, 4)


def test_shaders_get_a_picture_as_numbers_from_beside_the_file(tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "deep" / "a.exr"
    path.parent.mkdir()
    pictures.write_file(path, PICTURE)
    assert pictures.load(path).filepath == str(path)
    save(tmp_path / "a.blend")
    image = pictures.load(path)
    assert image.filepath == "//deep/a.exr"
    assert (image.colorspace_settings.name, image.alpha_mode) == ("Non-Color", "NONE")
    np.testing.assert_array_equal(pictures.read_pixels(image), PICTURE)

    def other_drive(_: str) -> str:
        raise ValueError("path is on mount 'D:'")

    monkeypatch.setattr(bpy.path, "relpath", other_drive)
    assert pictures.blend_path(path) == str(path)
