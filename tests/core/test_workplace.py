"""Temporary folders tell whose they are, and only those of processes that are surely gone are removed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pcc_addon.core import workplace
from pcc_addon.core.workplace import UNFINISHED, aside, remove_abandoned, temporary_folder

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
