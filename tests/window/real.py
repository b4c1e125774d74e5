"""A real Blender. PCC_BLENDER is the command that starts one, words split as a shell does; panels need a screen too."""

from __future__ import annotations

import os
import shlex
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
