"""Six files are told by the ends of their names; whatever is missing is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from pcc_addon.core.errors import ProbeError
from pcc_addon.core.picture_files import FACE_NAMES, digest, missing_faces, picture_files


def make(folder: Path, *names: str) -> list[Path]:
    paths = [folder / name for name in names]
    for path in paths:
        path.write_bytes(path.name.encode())
    return paths


@pytest.mark.parametrize("names", FACE_NAMES, ids=lambda names: names[0] + names[2])
@pytest.mark.parametrize("pattern", ["{}.png", "room_{}.hdr", "Room {}.EXR", "sky.{}.jpg", "cube-{}.tif"])
def test_any_of_six_files_stands_for_all_in_the_engines_order(tmp_path: Path, names, pattern: str) -> None:
    make(tmp_path, "other.png", "room_pq.hdr", "cube.tif")
    paths = make(tmp_path, *(pattern.format(name) for name in names))
    for path in paths:
        assert picture_files("Hall", str(path)) == tuple(paths)
        assert missing_faces(path) == ()


def test_the_case_of_letters_does_not_count(tmp_path: Path) -> None:
    paths = make(
        tmp_path, "Sky_Right.PNG", "sky_LEFT.png", "sky_Top.png", "sky_bottom.png", "sky_front.png", "sky_back.png"
    )
    assert picture_files("Hall", str(paths[0])) == tuple(paths)


def test_a_file_of_another_kind_or_beginning_is_none_of_the_six(tmp_path: Path) -> None:
    first, *_ = make(tmp_path, "a_px.png", "a_nx.png", "a_py.png", "a_ny.png", "a_pz.png", "a_nz.jpg", "b_nz.png")
    assert picture_files("Hall", str(first)) == (first,)
    assert missing_faces(first) == ("a_nz.png",)


def test_where_a_name_belongs_to_two_sets_the_one_that_lacks_least_is_meant(tmp_path: Path) -> None:
    paths = make(tmp_path, "z_right.png", "z_left.png", "z_up.png", "z_down.png", "z_front.png")
    assert missing_faces(paths[0]) == ("z_back.png",)
    paths = make(tmp_path, "y_right.png", "y_left.png", "y_down.png", "y_front.png", "y_back.png")
    assert missing_faces(paths[0]) == ("y_up.png",), "though those of the other set come before it in the alphabet"


def test_a_single_file_is_itself_whatever_it_is_called(tmp_path: Path) -> None:
    for name in ("sky.hdr", "garden_right.hdr", "px.png"):
        [path] = make(tmp_path, name)
        assert picture_files("Hall", str(path)) == (path,)
    assert missing_faces(tmp_path / "sky.hdr") == ()
    assert missing_faces(tmp_path / "garden_right.hdr")[0] == "garden_left.hdr"


@pytest.mark.parametrize("chosen", ["", "gone.png", "nowhere/gone.png", "x" * 5000])
def test_what_is_not_there_is_refused_by_name_with_a_remedy(tmp_path: Path, chosen: str) -> None:
    path = str(tmp_path / chosen) if chosen else ""
    with pytest.raises(ProbeError, match=r"^probe 'Hall'.*choose") as caught:
        picture_files("Hall", path)
    assert path in str(caught.value)


def test_a_folder_is_no_picture(tmp_path: Path) -> None:
    with pytest.raises(ProbeError, match="does not exist"):
        picture_files("Hall", str(tmp_path))


def test_another_content_or_order_has_another_digest_and_another_name_has_not(tmp_path: Path) -> None:
    a, b = make(tmp_path, "a", "b")
    before = digest([a, b])
    assert digest([b, a]) != before
    moved = a.rename(tmp_path / "c")
    assert digest([moved, b]) == before
    b.write_bytes(b"B")
    assert digest([moved, b]) != before
    c, d = make(tmp_path, "1", "23")
    c.write_bytes(b"12"), d.write_bytes(b"3")
    joined = digest([c, d])
    c.write_bytes(b"1"), d.write_bytes(b"23")
    assert digest([c, d]) != joined, "where one file ends counts"
