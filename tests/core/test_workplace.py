"""Temporary folders tell whose they are, and only those of processes that are surely gone are removed."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

import pytest

from pcc_addon.core import workplace
from pcc_addon.core.errors import PccError
from pcc_addon.core.workplace import UNFINISHED, aside, real, remove_abandoned, temporary_folder

pytestmark = pytest.mark.skipif(os.name != "posix", reason="elsewhere nobody can ask whether a process runs")


def ended_process() -> int:
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def left_by(process: int, folder: Path, machine: str | None = None, start: str | None = None) -> Path:
    """What a process would have left in a folder."""
    machine, start = machine or workplace._machine(), start or workplace._start()
    path = folder / f"{UNFINISHED}{machine}-{start}-{process}-xyz"
    path.mkdir()
    (path / "half.exr").write_text("half")
    return path


def test_a_folder_is_there_while_it_is_needed(tmp_path: Path) -> None:
    with temporary_folder(UNFINISHED, tmp_path) as folder:
        assert folder.parent == tmp_path and folder.is_dir()
        remove_abandoned(UNFINISHED, tmp_path)
        assert folder.is_dir(), "its process runs"
    assert list(tmp_path.iterdir()) == []


def test_what_an_ended_process_left_is_removed(tmp_path: Path) -> None:
    left_by(ended_process(), tmp_path)
    aside(tmp_path / "hall.blend").write_text("mine")
    (tmp_path / f"{UNFINISHED}{workplace._machine()}-{workplace._start()}-{ended_process()}-a.blend").write_text("half")
    with temporary_folder(UNFINISHED, tmp_path):
        assert len(list(tmp_path.iterdir())) == 2, "this process's own two"


def test_what_was_left_before_the_machine_was_started_anew_is_removed(tmp_path: Path) -> None:
    left_by(os.getpid(), tmp_path, start="00000000")
    remove_abandoned(UNFINISHED, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_told_stays(tmp_path: Path) -> None:
    left = [
        left_by(ended_process(), tmp_path, machine="00000000"),
        left_by(os.getppid(), tmp_path),
        tmp_path / f"{UNFINISHED}abcdefgh",
        tmp_path / f"{UNFINISHED}{workplace._machine()}-{workplace._start()}-{10**30}-x",
        tmp_path / f"other-{workplace._machine()}-{workplace._start()}-{ended_process()}-x",
    ]
    for path in left:
        path.mkdir(exist_ok=True)
    target = tmp_path / "target"
    target.mkdir()
    link = tmp_path / f"{UNFINISHED}{workplace._machine()}-{workplace._start()}-{ended_process()}-link"
    link.symlink_to(target)
    remove_abandoned(UNFINISHED, tmp_path)
    assert set(tmp_path.iterdir()) == {*left, target, link}


def test_a_folder_that_is_not_there_is_no_fault(tmp_path: Path) -> None:
    remove_abandoned(UNFINISHED, tmp_path / "nowhere")


def test_a_file_is_written_whole_and_not_through_a_link(tmp_path: Path) -> None:
    mine, note = tmp_path / "mine", tmp_path / "note.json"
    mine.write_text("mine")
    note.symlink_to(mine)
    workplace.write_whole(note, "told")
    assert (mine.read_text(), note.read_text(), note.is_symlink()) == ("mine", "told", False)
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError):
        workplace.write_whole(tmp_path / "folder", "told")
    assert {path.name for path in tmp_path.iterdir()} == {"mine", "note.json", "folder"}


def test_what_blender_wrote_aside_is_discarded_too(tmp_path: Path) -> None:
    for name in ("a.blend", "a.blend@", "b.blend@"):
        (tmp_path / name).write_text("half")
    workplace.discard(tmp_path / "a.blend")
    workplace.discard(tmp_path / "nowhere" / "a.blend")
    assert [path.name for path in tmp_path.iterdir()] == ["b.blend@"]


def test_where_no_temporary_folder_can_be_made_its_place_is_named(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "nowhere"))
    with ExitStack() as stack, pytest.raises(PccError, match=r"nowhere.*free space"):
        workplace.workplace(stack)


def test_a_second_name_is_a_copy_where_there_can_be_none(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "a").write_text("it")
    workplace.link(tmp_path / "a", tmp_path / "b")
    monkeypatch.setattr(os, "link", lambda *_: (_ for _ in ()).throw(OSError("none here")))
    workplace.link(tmp_path / "a", tmp_path / "c")
    assert (tmp_path / "b").read_text() == (tmp_path / "c").read_text() == "it"


def test_links_are_followed_and_one_to_itself_stays(tmp_path: Path) -> None:
    """`Path.resolve` refuses it up to Python 3.12, with an error that is no `OSError`."""
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to("there")
    (tmp_path / "loop").symlink_to("loop")
    assert real(tmp_path / "link" / "a.exr") == tmp_path.resolve() / "there" / "a.exr"
    assert real(str(tmp_path / "loop")) == tmp_path.resolve() / "loop"
