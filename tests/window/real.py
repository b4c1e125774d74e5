"""A real Blender. PCC_BLENDER is the command that starts one, words split as a shell does; panels need a screen too."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

BLENDER = shlex.split(os.environ.get("PCC_BLENDER", ""))
_PATIENCE = 1200  # seconds, after which a Blender that does not end fails its test
MARKS = [
    pytest.mark.window,
    pytest.mark.skipif(not BLENDER, reason="set PCC_BLENDER to the command of a real Blender"),
]


def run(*arguments: str, cwd: Path, seconds: float = _PATIENCE) -> subprocess.CompletedProcess[str]:
    """Start it, and wait until it ends, so many seconds at most."""
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    with subprocess.Popen([*BLENDER, *arguments], cwd=cwd, **streams) as process:
        try:
            out, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # the command may have started others
            raise
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def install(zip_file: Path, cwd: Path) -> None:
    """Install and enable the add-on's zip, as users do."""
    run("-b", "--command", "extension", "install-file", "-r", "user_default", "--enable", str(zip_file), cwd=cwd)


def driven(folder: Path, name: str, output: Path, *options: str) -> dict[str, object]:
    """What `drive_NAME.py` finds in a window with the folder's room; its pictures are kept in `output`."""
    try:
        return in_window(folder, Path(__file__).with_name(f"drive_{name}.py"), "room.blend", *options)
    finally:
        shutil.rmtree(output, ignore_errors=True)
        output.mkdir(parents=True)
        for picture in folder.glob("*.png"):
            shutil.copy(picture, output)


def in_window(folder: Path, script: Path, file: str, *options: str, seconds: float = _PATIENCE) -> dict[str, object]:
    """What a script finds in a window of 1600 × 900 pixels with a file of the folder.

    All that it needs is in the folder, which may be all that the real Blender sees; `options` are for that one. What it
    finds is in the JSON file called as the script is, `drive_` left off.
    """
    for needed in (script, *(Path(__file__).with_name(name) for name in ("driving.py", "pointing.py"))):
        shutil.copy(needed, folder)
    window = ("-p", "0", "0", "1600", "900", "--python-exit-code", "1")
    words = (*window, *options, file, "--python", script.name, "--", str(folder))
    done = run(*words, cwd=folder, seconds=seconds)
    if "unable to open a display" in done.stdout + done.stderr:
        pytest.skip("the real Blender has no screen")
    told = folder / f"{script.stem.removeprefix('drive_')}.json"
    assert told.is_file(), done.stdout + done.stderr
    found = json.loads(told.read_text(encoding="utf-8"))
    assert found.get("done"), found.get("error", done.stdout + done.stderr)
    assert "Traceback" not in done.stdout + done.stderr, done.stdout + done.stderr
    return found
