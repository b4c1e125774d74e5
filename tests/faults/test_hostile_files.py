"""Pictures, notes and .blend files that are truncated, hostile or no files at all."""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from pathlib import Path

import bpy
import pytest

from pcc_addon.blender.status import statuses

from . import hostile
from .hall import Hall, check_next_bake, run
from .processes import Victim
from .tally import fault
from .test_strangers import written_for

posix = pytest.mark.skipif(os.name != "posix", reason="pipes and links as POSIX systems have them")


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: random.Random(path.name).randrange(1, path.stat().st_size)])


def noise(path: Path) -> None:
    path.write_bytes(random.Random(1).randbytes(path.stat().st_size))


def folder(path: Path) -> None:
    path.unlink()
    path.mkdir()
    (path / "kept.txt").write_text("mine")


def endless_link(path: Path) -> None:
    path.unlink()
    path.symlink_to(path)


def pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


PICTURES: dict[str, Callable[[Path], object]] = {
    "gone": Path.unlink,
    "empty": lambda path: path.write_bytes(b""),
    "truncated": truncated,
    "noise": noise,
    "a letter": lambda path: path.write_text("Dear Sir"),
    "too large a header": lambda path: path.write_bytes(hostile.exr(2**30, 2**30)),
    "a header of no size": lambda path: path.write_bytes(hostile.exr(0, -5)),
    "another size": lambda path: path.write_bytes(hostile.exr(3, 7)),
    "a link to itself": endless_link,
}


@pytest.mark.sweep
@posix
@pytest.mark.parametrize("harm", PICTURES)
def test_a_picture_that_is_none_is_named_and_mended_by_the_next_bake(place: Hall, harm: str) -> None:
    for path in sorted(place.pictures.glob("Probe-*.exr")):
        PICTURES[harm](path)
    with fault("pictures that are none"):
        bpy.ops.wm.open_mainfile(filepath=str(place.blend))
        found = {status.probe: status for status in statuses(bpy.context.scene, bpy.context.view_layer)}
        assert {status.state for status in found.values()} == {"stale"}
        assert harm == "noise" or "its picture" in found["Probe"].words, found["Probe"]
        bpy.ops.pcc.inject()
        check_next_bake(place)


@posix
def test_a_folder_in_a_pictures_place_is_told_and_kept(place: Hall, capfd: pytest.CaptureFixture[str]) -> None:
    name = next(name for name in place.new if name.startswith("Probe") and name.endswith(".exr"))
    (place.pictures / name).mkdir()
    (place.pictures / name / "kept.txt").write_text("mine")
    with fault("pictures that are none"):
        assert run(place) == 1
        [line] = [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]
        assert "'Probe'" in line and str(place.pictures) in line
        assert (place.pictures / name / "kept.txt").read_text() == "mine"


SIDECARS: dict[str, tuple[Callable[[Path], object], int]] = {
    "gone": (Path.unlink, 0),
    "empty": (lambda path: path.write_bytes(b""), 0),
    "zeros": (lambda path: path.write_bytes(bytes(100)), 0),
    "truncated": (lambda path: path.write_bytes(path.read_bytes()[:100]), 0),
    "a later version": (lambda path: path.write_text(hostile.TEXTS["a later version"]), 0),
    "not ours": (lambda path: path.write_text(hostile.TEXTS["deep lists"]), 1),
    "a folder": (folder, 1),
    "a pipe": (pipe, 1),
}


@pytest.mark.sweep
@posix
@pytest.mark.parametrize("harm", SIDECARS)
def test_a_sidecar_that_is_none_is_replaced_where_it_is_ours_and_told_where_not(
    place: Hall, harm: str, capfd: pytest.CaptureFixture[str]
) -> None:
    spoil, code = SIDECARS[harm]
    path = place.pictures / written_for(place)
    spoil(path)
    with fault("sidecars that are none"):
        assert run(place) == code
        if code:
            lines = [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]
            assert len(lines) == 1 and "'Probe'" in lines[0] and str(path) in lines[0]
            path.rename(path.with_name("moved away"))
            assert run(place) == 0
            (path.with_name("moved away").rename(place.folder / "elsewhere"))
        check_next_bake(place)


@posix
def test_notes_that_are_none_hold_nothing_up(place: Hall) -> None:
    os.mkfifo(place.pictures / ".used-by-00000000.json")
    for index, text in enumerate(hostile.TEXTS.values(), 1):
        (place.pictures / f".used-by-{index:08x}.json").write_text(text)
    with fault("notes that are none"):
        for _ in range(3):
            assert run(place) == 0
        assert place.old <= {path.name for path in place.pictures.iterdir()}, "any picture may be wanted"


GIVEN: dict[str, Callable[[Path], object]] = {
    "an EXR too large": lambda path: path.with_suffix(".exr").write_bytes(hostile.exr(2**30, 2**30)),
    "an HDR too large": lambda path: path.with_suffix(".hdr").write_bytes(hostile.radiance_hdr(2**30, 2**30)),
    "an HDR without pixels": lambda path: path.with_suffix(".hdr").write_bytes(hostile.radiance_hdr(64, 32)),
    "noise": lambda path: path.with_suffix(".png").write_bytes(random.Random(2).randbytes(5000)),
    "nothing": lambda path: path.with_suffix(".png").write_bytes(b""),
    "a folder": lambda path: path.with_suffix(".png").mkdir(),
    "a pipe": lambda path: os.mkfifo(path.with_suffix(".png")),
    "a link to itself": lambda path: path.with_suffix(".png").symlink_to(path.with_suffix(".png")),
}


@pytest.mark.sweep
@posix
@pytest.mark.parametrize("harm", GIVEN)
def test_a_given_picture_that_is_none_is_named(place: Hall, harm: str, capfd: pytest.CaptureFixture[str]) -> None:
    before = place.blend.read_bytes()
    GIVEN[harm](place.folder / "given")
    [path] = place.folder.glob("given.*")
    with fault("given pictures that are none"):
        assert run(place, "bake", f"--picture={path}", "--save") == 1
        lines = [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]
        assert lines and all("given." in line for line in lines), lines
        assert place.blend.read_bytes() == before
        check_next_bake(place)


def a_blend(harm: str, place: Hall) -> Path:
    """A path that is given to `pcc` as a .blend, and is none."""
    path, whole = place.folder / "given.blend", place.blend.read_bytes()
    match harm:
        case "a letter":
            path.write_text("Dear Sir")
        case "nothing":
            path.write_bytes(b"")
        case "zeros":
            path.write_bytes(bytes(100_000))
        case "noise":
            path.write_bytes(random.Random(3).randbytes(100_000))
        case "the head alone":
            path.write_bytes(whole[:64])
        case "a picture":
            path.write_bytes(next(place.pictures.glob("*.exr")).read_bytes())
        case "a folder":
            path.mkdir()
        case "a pipe":
            os.mkfifo(path)
        case "a device":
            return Path("/dev/zero")
        case "a link to itself":
            path.symlink_to(path)
        case "a name too long":
            return place.folder / f"{'x' * 5000}.blend"
        case "a path too long":
            return place.folder.joinpath(*["x" * 200] * 40, "hall.blend")
        case "a name with a zero":
            return place.folder / "ha\0ll.blend"
        case "a name of bytes":
            return place.folder / os.fsdecode(b"\xff\xfe.blend")
        case "a name of lines":
            return place.folder / "two\nlines.blend"
    return path


BLENDS = [
    "a letter", "nothing", "zeros", "noise", "the head alone", "a picture", "a folder", "a pipe", "a device",
    "a link to itself", "a name too long", "a path too long", "a name with a zero", "a name of bytes",
    "a name of lines",
]  # fmt: skip


@posix
@pytest.mark.parametrize("harm", BLENDS)
def test_what_is_no_blend_is_refused_in_one_line(place: Hall, harm: str, capfd: pytest.CaptureFixture[str]) -> None:
    from pcc_addon.cli import run_in_blender

    bpy.ops.wm.read_factory_settings(use_empty=True)
    with fault("what is no .blend"):
        path = a_blend(harm, place)
        before = place.everything() if harm != "a pipe" else None
        capfd.readouterr()
        assert run_in_blender(["bake", str(path), "--inject", "--save"]) == 1
        lines = [line for line in capfd.readouterr().err.splitlines() if line.startswith("pcc")]
        assert len(lines) == 1 and any(word in lines[0] for word in ("give", "name a", "check the path")), lines
        assert harm == "a pipe" or place.everything() == before


@pytest.mark.heavy
def test_a_blend_that_was_cut_anywhere_is_opened_or_refused(place: Hall) -> None:
    """Each in a process of its own, as it is Blender that reads it."""
    whole = place.blend.read_bytes()
    for cut in sorted(random.Random(4).sample(range(100, len(whole)), 8)):
        torn = place.folder / "torn.blend"
        torn.write_bytes(whole[:cut])
        with fault("a truncated .blend"):
            victim = Victim(place.temporary)
            victim.tell("bake", str(torn))
            code, lines = victim.ended()
            assert code in (0, 1) and torn.read_bytes() == whole[:cut], lines
