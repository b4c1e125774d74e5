"""A real Blender. PCC_BLENDER is the command that starts one, words split as a shell does; panels need a screen too."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

BLENDER = shlex.split(os.environ.get("PCC_BLENDER", ""))
MARKS = [
    pytest.mark.window,
    pytest.mark.skipif(not BLENDER, reason="set PCC_BLENDER to the command of a real Blender"),
]


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Start it, and wait until it ends."""
    return subprocess.run([*BLENDER, *arguments], cwd=cwd, capture_output=True, text=True, timeout=180)


def driven(folder: Path, name: str, output: Path) -> dict[str, object]:
    """What `drive_NAME.py` finds in a window with the folder's room; its pictures are kept in `output`.

    All that it needs is in the folder, which may be all that the real Blender sees.
    """
    for script in (f"drive_{name}.py", "driving.py"):
        shutil.copy(Path(__file__).with_name(script), folder)
    window = ("-p", "0", "0", "1600", "900", "--python-exit-code", "1")
    done = run(*window, "room.blend", "--python", f"drive_{name}.py", "--", str(folder), cwd=folder)
    if "unable to open a display" in done.stdout + done.stderr:
        pytest.skip("the real Blender has no screen")
    told = folder / f"{name}.json"
    assert told.is_file(), done.stdout + done.stderr
    found = json.loads(told.read_text(encoding="utf-8"))
    shutil.rmtree(output, ignore_errors=True)
    output.mkdir(parents=True)
    for picture in folder.glob("*.png"):
        shutil.copy(picture, output)
    assert found.get("done"), found.get("error")
    assert "Traceback" not in done.stdout + done.stderr, done.stdout + done.stderr
    return found
