"""The manifest of bakes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from pcc_addon.core.errors import PccError
from pcc_addon.core.manifest import add, entries, manifest_file


def test_lines_are_added_and_a_torn_one_harms_no_other(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "hall.bakes.jsonl"
    add(path, {"probe": "A"})
    with path.open("ab") as file:
        file.write(b'{"probe": "to')
    add(path, {"probe": "B"})
    assert [entry["probe"] for entry in entries(path)] == ["A", "B"]


def test_one_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(PccError, match="name another with --manifest"):
        add(tmp_path, {})


@pytest.mark.skipif(os.name != "posix", reason="links and pipes need no rights on POSIX systems alone")
def test_a_link_in_its_place_goes_and_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    theirs, path = tmp_path / "theirs", tmp_path / "hall.bakes.jsonl"
    theirs.write_text("theirs")
    path.symlink_to(theirs)
    add(manifest_file(tmp_path, Path("hall.blend")), {"probe": "A"})
    assert theirs.read_text() == "theirs" and [entry["probe"] for entry in entries(path)] == ["A"]
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(PccError, match="it is no file"):
        add(tmp_path / "pipe", {})
