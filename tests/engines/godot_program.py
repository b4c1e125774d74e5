"""Pictures from Godot, with a project that loads an export."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

_PROJECT = Path(__file__).parent / "godot"
_SECONDS = 300


def godot() -> list[str]:
    """The command; skips the test where there is none."""
    command = os.environ.get("PCC_GODOT") or shutil.which("godot") or shutil.which("godot4")
    if not command:
        pytest.skip('needs Godot 4.4 or later and a screen, such as PCC_GODOT="xvfb-run -a godot"')
    return shlex.split(command)


def picture_of(export: Path, scene: Mapping[str, object]) -> np.ndarray:
    """What Godot renders of a scene of `views.scene`: (height, width, 3) float32 linear, row 0 at the bottom.

    Raises:
        AssertionError: it failed; says why.
    """
    command = godot()
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        shutil.copytree(_PROJECT, work, dirs_exist_ok=True)
        shutil.copytree(export, work / "export")
        (work / "scene.json").write_text(json.dumps(scene))
        options = ["--path", str(work), "--script", "res://picture.gd", "--audio-driver", "Dummy"]
        done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=_SECONDS)
        picture = work / "picture.bin"
        said = f"{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
        assert picture.is_file() and "SHADER ERROR" not in said, said
        pixels = np.fromfile(picture, np.float32)
    width, height = scene["size"]
    return pixels.reshape(height, width, 4)[..., :3]
