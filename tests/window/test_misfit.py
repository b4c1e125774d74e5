"""A misfit as a real Blender draws it. Pictures are kept in `tests/output/misfit`, to be looked at."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.window.real import MARKS, run

pytestmark = MARKS
OUTPUT = Path(__file__).parents[1] / "output" / "misfit"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_misfit.py` found; all that it needs is in the folder, which may be all that the real Blender sees."""
    shutil.copy(Path(__file__).with_name("drive_misfit.py"), folder)
    window = ("-p", "0", "0", "1600", "900", "--python-exit-code", "1")
    done = run(*window, "room.blend", "--python", "drive_misfit.py", "--", str(folder), cwd=folder)
    if "unable to open a display" in done.stdout + done.stderr:
        pytest.skip("the real Blender has no screen")
    assert (folder / "misfit.json").is_file(), done.stdout + done.stderr
    told = json.loads((folder / "misfit.json").read_text(encoding="utf-8"))
    shutil.rmtree(OUTPUT, ignore_errors=True)
    OUTPUT.mkdir(parents=True)
    for picture in folder.glob("*, *.png"):
        shutil.copy(picture, OUTPUT)
    assert told.get("done"), told.get("error")
    assert "Traceback" not in done.stdout + done.stderr, done.stdout + done.stderr
    return told


def test_it_is_drawn_while_it_is_switched_on(found) -> None:
    drawn = found["pictures"]
    for name in ("before", "found", "off"):
        assert drawn[f"{name}, view"]["magenta"] == 0, name
    for name in ("shown", "shown again", "light"):
        assert drawn[f"{name}, view"]["magenta"] > 50, name
    assert drawn["shown, view"]["red"] > drawn["found, view"]["red"] + 200


def test_it_is_made_once_and_forgotten_when_it_is_switched_off(found) -> None:
    assert found["made once"] and found["forgotten"]
