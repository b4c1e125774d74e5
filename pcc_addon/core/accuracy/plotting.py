"""Plots by a Python that has matplotlib: Blender's own has not."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from ..errors import PccError

VARIABLE = "PCC_PLOT_PYTHON"
HOW_TO_GET = (
    "no Python with matplotlib was found, so there are no plots; install it by 'python3 -m pip install matplotlib', or "
    f"name a Python that has it in the environment variable {VARIABLE}"
)
_SCRIPT = Path(__file__).with_name("plots.py")
_PATIENCE = 300.0  # seconds; matplotlib looks at all fonts the first time


def draw_plots(cost_json: Path, folder: Path, asked: str = "") -> tuple[Path, ...]:
    """Draw the plots of a cost.json into a folder, in another process.

    Args:
        asked: the Python to use, before all others; empty: none in particular.

    Returns:
        the pictures, PNG and SVG.

    Raises:
        PccError: no Python with matplotlib was found, or it failed; in words.
    """
    python = find_python(asked)
    if python is None:
        raise PccError(HOW_TO_GET)
    try:
        done = _run(python, str(_SCRIPT), str(cost_json), str(folder))
    except (OSError, subprocess.TimeoutExpired) as error:
        raise PccError(f"'{python}' did not draw the plots ({error})") from error
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["without a word"])[-1]
        raise PccError(f"'{python}' could not draw the plots ({last})")
    return tuple(Path(line) for line in done.stdout.splitlines())


def find_python(asked: str = "") -> str | None:
    """A Python that can import matplotlib: the one asked for, the environment's, this one, or one on PATH.

    Raises:
        PccError: one was named, by the setting or the environment variable, and has no matplotlib.
    """
    for named in (asked, os.environ.get(VARIABLE, "")):
        if named:
            if not _can_draw(named):
                raise PccError(f"'{named}' is no Python that can import matplotlib; name another, or install it there")
            return named
    return next((candidate for candidate in _others() if _can_draw(candidate)), None)


def _others() -> Iterator[str]:
    if "python" in Path(sys.executable or "").name.lower():  # inside Blender it may be Blender itself
        yield sys.executable
    for name in ("python3", "python"):
        if found := shutil.which(name):
            yield found


def _can_draw(python: str) -> bool:
    try:
        return _run(python, "-c", "import matplotlib").returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def _run(python: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run another Python as if from a shell of its own: ours may have set where modules are."""
    ours = ("PYTHONPATH", "PYTHONHOME", "PYTHONNOUSERSITE")
    surroundings = {**{k: v for k, v in os.environ.items() if k not in ours}, "PYTHONIOENCODING": "utf-8"}
    return subprocess.run(
        [python, *arguments],
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        timeout=_PATIENCE,
        env=surroundings,
    )
