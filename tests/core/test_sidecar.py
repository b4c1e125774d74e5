"""The file beside the pictures: what is written comes back, what is damaged is refused, names are safe."""

from __future__ import annotations

import dataclasses
import json
import re
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core import sidecar
from pcc_addon.core.cubemap import FACE_NAMES, FACES
from pcc_addon.core.errors import BakeError
from pcc_addon.core.pictures import PictureKey, PictureKind
from pcc_addon.core.probe import Box, ProbeSpec, Source
from pcc_addon.core.sequence import Moment
from pcc_addon.core.sidecar import (
    PICTURE_NAME,
    VERSION,
    Level,
    Sidecar,
    digest_of,
    digest_of_all,
    file_family,
    file_stem,
    level_file,
    move_into_place,
    uid_digest,
    uid_digest_of_file,
)

KEYS = [PictureKey(PictureKind.RADIANCE, k) for k in range(8)]
RECORD = Sidecar(
    probe="Höhle / 洞窟",
    uid="5b0c",
    matrix=(2.0, 0.0, 0.0, 0.1, 0.0, -3.0, 0.0, 1e-9, 0.0, 0.0, 1.5, 1e6, 0.0, 0.0, 0.0, 1.0),
    capture_point=(0.1, 0.2, 1 / 3),
    resolution=512,
    samples=64,
    engine="CYCLES",
    denoise=True,
    clip=(0.01, 1000.0),
    seconds=12.5,
    content_hash="abc123",
    blender="5.2.3",
    addon="0.1.0",
    levels=(Level(KEYS[0], 0.0, "a.exr", 2048, 1024), Level(KEYS[1], 0.3, "b.exr", 512, 256, 4711, "0a")),
    replaced_pixels=("face +X: 1 negative pixels were replaced",),
    date="2026-03-01T12:34:56+00:00",
)


DEFAULTED = {"departure", "half_float", "replaced_pixels", "source", "moments", "faces", "face_hashes", "date"}


def edited(**changes: object) -> str:
    document = {**json.loads(RECORD.to_json()), **changes}
    return json.dumps({key: value for key, value in document.items() if value is not ...})


def refusal(text: str) -> str:
    with pytest.raises(BakeError) as caught:
        Sidecar.from_json(text, "hall.json")
    message = str(caught.value)
    assert "'hall.json'" in message
    assert "\n" not in message
    assert "bake" in message, "it says what to do"
    return message


def test_what_is_written_comes_back() -> None:
    assert Sidecar.from_json(RECORD.to_json(), "here") == RECORD


@given(
    probe=st.text(),
    numbers=st.tuples(*[st.floats(-1e38, 1e38)] * 3),  # what shaders take
    levels=st.lists(
        st.builds(
            Level,
            st.sampled_from(KEYS),
            st.floats(0.0, 1.0),
            st.text(st.characters(exclude_characters="/\\:\0"), min_size=1).filter(lambda name: name.strip(".")),
            st.integers(1, 9999),
            st.integers(1, 9999),
            st.integers(0, 10**9),
            st.text(),
        ),
        max_size=3,
    ),
    words=st.lists(st.text(), max_size=3),
)
def test_any_record_comes_back_digit_for_digit(probe: str, numbers: tuple, levels: list, words: list) -> None:
    record = dataclasses.replace(
        RECORD, probe=probe, capture_point=numbers, levels=tuple(levels), replaced_pixels=tuple(words)
    )
    assert Sidecar.from_json(record.to_json(), "here") == record


@pytest.mark.parametrize("content_hash", ["", "0123abcd" * 8, "2:0123abcd", "99:whatever comes"])
def test_hashes_of_any_version_come_back(content_hash: str) -> None:
    record = dataclasses.replace(RECORD, content_hash=content_hash)
    assert Sidecar.from_json(record.to_json(), "a test") == record


def test_the_text_explains_itself_to_other_programs() -> None:
    document = json.loads(RECORD.to_json())
    assert document["format"] == "parallax-probe"
    assert document["version"] == VERSION
    assert document["convention"]["space"] == "world axes, Z up, right-handed, metres, scene-linear radiance"
    assert document["convention"]["picture"] == (
        "equirectangular, u = 1/2 - atan2(y, x) / 2 pi, v = 1/2 + asin(z) / pi from the bottom"
    )
    faces = document["convention"]["faces"]
    assert [face["name"] for face in faces] == [face.name for face in FACES]
    assert [tuple(face["up"]) for face in faces] == [face.up for face in FACES]


def test_what_a_later_release_of_this_version_adds_is_ignored() -> None:
    assert Sidecar.from_json(edited(mood="sunny"), "here") == RECORD
    levels = [{**level, "mood": "sunny"} for level in json.loads(RECORD.to_json())["levels"]]
    assert Sidecar.from_json(edited(levels=levels), "here") == RECORD


def test_what_may_be_missing_has_a_default() -> None:
    assert Sidecar.from_json(edited(replaced_pixels=...), "here").replaced_pixels == ()
    assert Sidecar.from_json(edited(source=...), "here").source is Source.BAKE
    assert Sidecar.from_json(edited(moments=...), "here").moments == ()
    assert Sidecar.from_json(edited(faces=...), "here").faces == FACE_NAMES, "older bakes have all six"
    levels = [
        {k: v for k, v in level.items() if k not in ("size", "digest")} for level in json.loads(edited())["levels"]
    ]
    found = Sidecar.from_json(edited(levels=levels), "here").levels
    assert [(level.size, level.digest) for level in found] == [(0, ""), (0, "")]


@pytest.mark.parametrize("source", list(Source))
def test_where_pictures_come_from_is_told_with_the_axes_that_they_have(source: Source) -> None:
    record = dataclasses.replace(RECORD, source=source)
    assert Sidecar.from_json(record.to_json(), "here") == record
    space = json.loads(record.to_json())["convention"]["space"]
    assert ("world axes" in space) == (source is Source.BAKE)


def test_a_record_of_the_first_version_gets_keys_in_the_order_of_roughness() -> None:
    level = {"roughness": 0.3, "file": "b.exr", "width": 512, "height": 256}
    sharp = {"roughness": 0.0, "file": "a.exr", "width": 2048, "height": 1024}
    found = Sidecar.from_json(edited(version=1, levels=[level, sharp]), "here")
    assert [(level.key, level.file) for level in found.levels] == [(KEYS[0], "a.exr"), (KEYS[1], "b.exr")]
    assert Sidecar.from_json(found.to_json(), "here") == found


@pytest.mark.parametrize("version", [0, -1, True, 1.5])
def test_a_version_that_never_was_is_refused(version: object) -> None:
    assert "version" in refusal(edited(version=version))


@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(), lambda c: st.lists(c) | st.dictionaries(st.text(), c)
    )
)
def test_a_tampered_record_is_refused_or_read_but_never_anything_else(value: object) -> None:
    for key in json.loads(RECORD.to_json()):
        try:
            Sidecar.from_json(edited(**{key: value}), "hall.json")
        except BakeError as error:
            assert "'hall.json'" in str(error)


@pytest.mark.parametrize("version", [VERSION + 1, VERSION + 100])
def test_a_later_version_is_refused_before_anything_else_of_it_is_read(version: int) -> None:
    assert "later version" in refusal(edited(version=version, levels="packed differently", matrix=...))


@pytest.mark.parametrize(
    "key", ["format", "version", *(f.name for f in dataclasses.fields(Sidecar) if f.name not in DEFAULTED)]
)
def test_a_record_with_something_missing_is_refused(key: str) -> None:
    assert key in refusal(edited(**{key: ...}))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "not json",
        "{",
        "[]",
        "null",
        "7",
        '"parallax-probe"',
        "{}",
        "[" * 100_000,
        edited(format="something else"),
        edited(version="1"),
        edited(version=None),
        edited(levels=None),
        edited(levels=[3]),
        edited(levels=[{"roughness": 0.5}]),
        edited(levels=[{"key": "mood-1", "roughness": 0.5, "file": "f", "width": 2, "height": 1}]),
        edited(matrix=None),
        edited(clip=5.0),
    ],
    ids=lambda text: text[:20],
)
def test_damaged_text_is_refused_in_one_line(text: str) -> None:
    refusal(text)


@pytest.mark.parametrize(("name", "count"), [("matrix", 16), ("capture_point", 3), ("clip", 2)])
def test_lists_of_numbers_are_as_long_as_they_must_be_and_hold_finite_numbers(name: str, count: int) -> None:
    numbers = [float(k) for k in range(count)]
    assert getattr(Sidecar.from_json(edited(**{name: numbers}), "here"), name) == tuple(numbers)
    for wrong in ([], numbers[:-1], [*numbers, 0.0], [*numbers[:-1], float("nan")], [*numbers[:-1], float("inf")]):
        assert f"'{name}' is not {count} finite numbers" in refusal(edited(**{name: wrong}))
    for wrong in ("7" * count, [*numbers[:-1], "0"], [*numbers[:-1], None], [*numbers[:-1], 10**400]):
        refusal(edited(**{name: wrong}))


@pytest.mark.parametrize(
    ("name", "kind", "wrong"),
    [
        ("seconds", "finite number", [True, "5", None, float("nan"), float("inf"), [1.0]]),
        ("resolution", "whole number", [True, "5", None, 1.5, -1]),
        ("blender", "text", [True, 5, None, ["5.2"]]),
    ],
)
def test_a_value_of_another_kind_is_refused(name: str, kind: str, wrong: list) -> None:
    for value in wrong:
        assert f"is no {kind}" in refusal(edited(**{name: value}))
    assert Sidecar.from_json(edited(seconds=0, resolution=0, blender=""), "here").seconds == 0.0


def test_text_cut_off_anywhere_is_refused() -> None:
    text = RECORD.to_json().rstrip()
    for length in range(0, len(text), 31):
        refusal(text[:length])


SAFE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,62}")
RESERVED = {"CON", "PRN", "AUX", "NUL", *(f"{port}{n}" for port in ("COM", "LPT") for n in "0123456789¹²³")}


@given(st.one_of(st.text(), st.text(alphabet='-_./\\:*?"<>| aé\n\0', max_size=60)), st.text(max_size=40))
def test_a_stem_is_a_safe_file_name_on_every_system(name: str, uid: str) -> None:
    assert SAFE.fullmatch(file_stem(name, uid))


@pytest.mark.parametrize(
    "name", [*sorted(RESERVED), "con.txt", "nul", "COM1.exr", "..", "-rf", "~", "a" * 5000, "", " "]
)
def test_names_with_a_meaning_of_their_own_lose_it(name: str) -> None:
    stem = file_stem(name, "5b0c")
    assert SAFE.fullmatch(stem)
    assert level_file(stem, KEYS[0], "00").split(".")[0].upper() not in RESERVED


def test_a_readable_name_can_still_be_read() -> None:
    assert file_stem("Living Room.001", "5b0c").startswith("Living_Room_001-")


def test_different_probes_never_share_a_stem_and_one_probe_keeps_its() -> None:
    uids = [f"{k:032x}" for k in range(3000)]
    stems = {file_stem("Probe", uid) for uid in uids}
    assert len({stem.lower() for stem in stems}) == len(uids)
    assert file_stem("Probe", "a") == file_stem("Probe", "a")
    assert file_stem("x" * 100 + "1", "a") != file_stem("x" * 100 + "1", "b")
    assert file_stem("洞", "a") != file_stem("穴", "b")


def test_pictures_that_differ_in_anything_have_names_of_their_own() -> None:
    pixels = np.zeros((2, 4, 3), np.float32)
    other = pixels.copy()
    other[1, 2, 0] = 1e-30
    assert digest_of(pixels) != digest_of(other)
    files = [level_file("stem", key, digest_of(p)) for key in KEYS for p in (pixels, other)]
    assert len(set(files)) == len(files)
    assert {Path(file).suffix for file in files} == {".exr"}


def test_finished_files_replace_the_old_ones(tmp_path: Path) -> None:
    parts, target = tmp_path / "parts", tmp_path / "target"
    for folder, text in ((parts, "new"), (target, "old")):
        folder.mkdir()
        for name in ("a.exr", "a.json"):
            (folder / name).write_text(text)
    move_into_place(parts, target, ["a.exr", "a.json"])
    assert sorted(path.name for path in target.iterdir()) == ["a.exr", "a.json"]
    assert {path.read_text() for path in target.iterdir()} == {"new"}
    assert not list(parts.iterdir())


def test_where_a_picture_is_missing_the_record_is_not_replaced(tmp_path: Path) -> None:
    """The record goes last, so it never describes pictures that are not there."""
    parts, target = tmp_path / "parts", tmp_path / "target"
    parts.mkdir(), target.mkdir()
    (parts / "a.json").write_text("new")
    (target / "a.json").write_text("old")
    with pytest.raises(FileNotFoundError):
        move_into_place(parts, target, ["a.exr", "a.json"])
    assert (target / "a.json").read_text() == "old"


def test_where_one_file_cannot_be_moved_those_before_it_are_gone_again(tmp_path: Path) -> None:
    parts, target = tmp_path / "parts", tmp_path / "target"
    parts.mkdir(), target.mkdir()
    for name in ("a.exr", "b.exr", "a.json"):
        (parts / name).write_text("new")
    (target / "b.exr").mkdir()
    (target / "b.exr" / "something").write_text("in the way")
    with pytest.raises(OSError):
        move_into_place(parts, target, ["a.exr", "b.exr", "a.json"])
    assert [path.name for path in target.iterdir()] == ["b.exr"]


def test_a_sequence_comes_back_and_no_moment_that_is_none() -> None:
    moments = (Moment(-3, "a", 0, (0.0, 1.0, 2.0)), Moment(7, "b", 1, (0.0, 1.0, 9.0)))
    record = dataclasses.replace(RECORD, moments=moments, levels=(Level(SEQUENCE[0], 0.0, "a.exr", 64, 32),))
    assert Sidecar.from_json(record.to_json(), "here") == record
    assert record.frames == (-3, 7)
    plain = json.loads(record.to_json())["moments"]
    for key, wrong in (("frame", 1.5), ("frame", True), ("number", -1), ("content_hash", 3), ("capture_point", [1.0])):
        refusal(edited(moments=[plain[0], {**plain[1], key: wrong}]))


def test_the_faces_that_were_captured_come_back_and_none_that_there_are_not() -> None:
    record = dataclasses.replace(RECORD, faces=("+X", "-Z"))
    assert Sidecar.from_json(record.to_json(), "here") == record
    assert Sidecar.from_json(edited(faces=["-Z", "+X"]), "here").faces == ("+X", "-Z")
    assert record.lacks(("+X", "-Y", "-Z", "+Z")) == ("-Y", "+Z") and RECORD.lacks(FACE_NAMES) == ()
    for wrong in ([], None, "+X", {"+X": 1}, ["+X", "+X"], ["+X", "up"], ["+X", 3], [["+X"]], list(FACE_NAMES) * 2):
        assert "faces" in refusal(edited(faces=wrong))


def test_the_hashes_of_faces_come_back_and_tell_which_may_have_changed() -> None:
    six = tuple("2:abcdef"[k:] for k in range(6))
    record = dataclasses.replace(RECORD, face_hashes=six)
    assert Sidecar.from_json(record.to_json(), "here") == record
    assert Sidecar.from_json(edited(face_hashes=...), "here").face_hashes == (), "older bakes have none"
    for wrong in (None, "six", {"+X": "a"}, list(six[:5]), [*six, "a"], [*six[:5], 3]):
        assert refusal(edited(face_hashes=wrong))
    other = ("2:x", *six[1:5], "2:y")
    assert record.changed(record.content_hash, other) == ()
    assert record.changed("2:new", other) == ("+X", "-Z") and record.changed("2:new", six) == ()
    assert dataclasses.replace(record, faces=("-X", "-Z")).changed("2:new", other) == ("-Z",)
    assert record.changed("2:new", ()) == RECORD.changed("2:new", six) == FACE_NAMES


def test_of_several_capture_points_the_farthest_tells_whether_they_are_apart_from_a_place() -> None:
    moments = (Moment(1, "a", 0, (0.0, 0.0, 0.0)), Moment(2, "b", 1, (0.0, 0.0, 5.0)))
    record = dataclasses.replace(RECORD, capture_point=(0.0, 0.0, 0.0), moments=moments)
    assert record.capture_point_apart_from((0.0, 0.0, 0.0)) == (0.0, 0.0, 5.0)
    assert record.capture_point_apart_from((0.0, 0.0, 5.0)) == (0.0, 0.0, 0.0)
    assert RECORD.capture_point_apart_from((9.0, 9.0, 9.0)) == RECORD.capture_point


SEQUENCE = [PictureKey(PictureKind.RADIANCE, 3, number) for number in (0, 7, 12345)]


def test_pictures_of_a_sequence_differ_in_a_number_at_the_end_and_belong_together() -> None:
    stem, digest = file_stem("Ball", "5b0c"), digest_of_all(["a", "b", "c"])
    files = [level_file(stem, key, digest) for key in SEQUENCE]
    assert [file.removesuffix(".exr").rpartition(".")[2] for file in files] == ["0000", "0007", "12345"]
    assert len({file_family(file) for file in files}) == 1
    assert file_family(files[0]) not in files and file_family(file_family(files[0])) == file_family(files[0])
    for file in files:
        assert uid_digest_of_file(file) == uid_digest("5b0c")
        assert PICTURE_NAME.fullmatch(file.encode())
    still = level_file(stem, KEYS[3], digest)
    assert file_family(still) == still and file_family(files[0]) == still
    assert digest_of_all(["a", "b"]) != digest_of_all(["b", "a"]) != digest_of_all(["ba"])
    for other in ("frame.0001.exr", f"{stem}.json", f"{stem}.r00000.exr"):
        assert file_family(other) == other


def test_a_bake_knows_when_it_was_made_and_older_ones_do_not() -> None:
    spec = ProbeSpec("Hall", Box(tuple(np.eye(4).ravel().tolist())))
    before = datetime.now(UTC).replace(microsecond=0)
    made = datetime.fromisoformat(
        Sidecar.of_bake(spec, "5b0c", seconds=0.0, content_hash="", blender="", addon="").date
    )
    assert before <= made <= datetime.now(UTC)
    assert Sidecar.from_json(edited(date=...), "here").date == ""


@pytest.mark.parametrize("wrong", ["yesterday", "2026-03-01T12:34:56", 20260301, None])
def test_a_date_that_is_none_is_refused(wrong: object) -> None:
    refusal(edited(date=wrong))


@pytest.mark.parametrize("content", [b"", bytes(50), RECORD.to_json().encode(), RECORD.to_json()[:40].encode()])
def test_a_sidecar_takes_the_place_of_a_sidecar_or_of_nothing(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "hall.json"
    assert sidecar.may_replace(path)
    for written in (content, content.replace(b"\n", b"\r\n")):
        path.write_bytes(written)
        assert sidecar.may_replace(path)


@pytest.mark.parametrize("content", [b"{}", b"Dear Sir", b'{\n "format": "another",' + bytes(40), b" " * 40])
def test_a_sidecar_takes_no_other_place(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "hall.json").write_bytes(content)
    assert not sidecar.may_replace(tmp_path / "hall.json")
    assert not sidecar.may_replace(tmp_path)


@pytest.mark.parametrize("name", ["", ".", "..", "../a.exr", "/a.exr", "b\\a.exr", "C:a.exr", "a\0.exr"])
def test_a_record_names_files_and_no_paths(name: str) -> None:
    levels = [{**level, "file": name} for level in json.loads(RECORD.to_json())["levels"]]
    with pytest.raises(BakeError, match="name of a file"):
        Sidecar.from_json(edited(levels=levels), "hall.json")


def test_what_is_too_large_for_a_sidecar_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "hall.json"
    with path.open("wb") as file:
        file.truncate(2**28 + 1)
    with pytest.raises(BakeError, match="too large"):
        sidecar.read_file(path)
