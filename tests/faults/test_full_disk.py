"""A disk that is full: at each change of a file that a bake makes, from the first folder to the last rename."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from . import full_disk, tally
from .hall import Hall
from .processes import ROOT

COMPILER = shutil.which("cc") or shutil.which("gcc")


@pytest.mark.skipif(
    COMPILER is None or not sys.platform.startswith("linux"), reason="needs Linux and a C compiler, for LD_PRELOAD"
)
@pytest.mark.parametrize("each", [37, pytest.param(1, marks=pytest.mark.heavy)])
def test_any_change_of_a_file_may_find_the_disk_full(built: Hall, tmp_path: Path, each: int) -> None:
    library = full_disk.compiled(tmp_path, COMPILER)
    start = built.copied_to(tmp_path / "start")
    names = {"old": sorted(built.old), "new": sorted(built.new)}
    (tmp_path / "names.json").write_text(json.dumps(names), encoding="utf-8")
    command = [sys.executable, "-m", "tests.faults.full_disk", library, start.folder]
    environment = {**os.environ, "LD_PRELOAD": str(library), "PYTHONPATH": str(ROOT)}
    starts = (1, 1 + each)
    halves = [
        subprocess.Popen(
            [*command, tmp_path / f"copies {first}", str(first), str(2 * each)],
            cwd=ROOT,
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        for first in starts
    ]
    outputs = [half.communicate()[0] for half in halves]
    assert [half.returncode for half in halves] == [0, 0], outputs
    said = [[json.loads(line) for line in output.splitlines() if line.startswith("{")] for output in outputs]
    tried = [event for of_half in said for event in of_half if "survived" in event]
    tally.add("a full disk from one change of a file on, or at it alone", len(tried), sum(e["survived"] for e in tried))
    for first, of_half in zip(starts, said, strict=True):  # a slow half waits for the disk more often
        changes = of_half[-1]["changes"]
        assert {event["change"] for event in of_half[:-1]} == set(range(first, changes + 1, 2 * each)) and changes > 20
    assert [event for event in tried if not event["survived"]] == []
    assert any(event["code"] for event in tried)
