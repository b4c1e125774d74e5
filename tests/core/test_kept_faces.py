"""Faces on disk: whole or not there, and never another's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pcc_addon.core.kept_faces import FOLDER, KeptFace, KeptFaces, clear

PICTURE = np.arange(75, dtype=np.float32).reshape(5, 5, 3)


def test_a_face_comes_back_with_its_words(tmp_path: Path) -> None:
    KeptFaces(tmp_path, resumes=False).of("Room-1", "seen").keep("+X", KeptFace(PICTURE, ("a spot",), 2.5))
    found = KeptFaces(tmp_path, resumes=True).of("Room-1", "seen").take("+X")
    assert np.array_equal(found.picture, PICTURE) and (found.words, found.seconds) == (("a spot",), 2.5)


@pytest.mark.parametrize(
    ("stem", "seen", "face"), [("Other-1", "seen", "+X"), ("Room-1", "more", "+X"), ("Room-1", "seen", "-X")]
)
def test_another_probe_scene_or_face_has_none(tmp_path: Path, stem: str, seen: str, face: str) -> None:
    kept = KeptFaces(tmp_path, resumes=True)
    kept.of("Room-1", "seen").keep("+X", KeptFace(PICTURE))
    assert kept.of(stem, seen).take(face) is None


def test_who_does_not_resume_takes_none(tmp_path: Path) -> None:
    kept = KeptFaces(tmp_path, resumes=False).of("Room-1", "seen")
    kept.keep("+X", KeptFace(PICTURE))
    assert kept.take("+X") is None


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.99])
def test_a_torn_file_counts_as_not_there(tmp_path: Path, share: float) -> None:
    kept = KeptFaces(tmp_path, resumes=True).of("Room-1", "seen")
    kept.keep("+X", KeptFace(PICTURE))
    [path] = (tmp_path / FOLDER).iterdir()
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    assert kept.take("+X") is None
    path.write_bytes(bytes(len(whole)))
    assert kept.take("+X") is None
    path.write_bytes(whole.replace(PICTURE.tobytes(), (PICTURE + 1).tobytes()))
    assert kept.take("+X") is None


def test_faces_of_whole_bakes_go_whatever_they_saw(tmp_path: Path) -> None:
    kept = KeptFaces(tmp_path, resumes=True)
    for stem, seen in (("Room-1", "now"), ("Room-1", "before"), ("Hall-2", "now")):
        kept.of(stem, seen).keep("+X", KeptFace(PICTURE))
    kept.forget(["Room-1"])
    assert [path.name.partition(".")[0] for path in (tmp_path / FOLDER).iterdir()] == ["Hall-2"]
    kept.forget(["Hall-2"])
    assert list(tmp_path.iterdir()) == []


def test_a_link_in_the_place_of_the_folder_is_never_followed(tmp_path: Path) -> None:
    elsewhere, pictures = tmp_path / "elsewhere", tmp_path / "hall.pcc"
    elsewhere.mkdir()
    pictures.mkdir()
    (elsewhere / "Room-1.npz").write_text("somebody's")
    (pictures / FOLDER).symlink_to(elsewhere, target_is_directory=True)
    kept = KeptFaces(pictures, resumes=True)
    kept.of("Room-1", "seen").keep("+X", KeptFace(PICTURE))
    kept.forget(["Room-1"])
    clear(pictures)
    assert [path.name for path in elsewhere.iterdir()] == ["Room-1.npz"]
