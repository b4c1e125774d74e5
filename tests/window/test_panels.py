"""The panels of effects as a real Blender draws them. Pictures are kept in `tests/output/panels`, to be looked at."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.window.real import MARKS, run

pytestmark = MARKS
OUTPUT = Path(__file__).parents[1] / "output" / "panels"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_panels.py` found; all that it needs is in the folder, which may be all that the real Blender sees."""
    run("room.blend", "--command", "pcc", "bake", "--save", cwd=folder)
    shutil.copy(Path(__file__).with_name("drive_panels.py"), folder)
    window = ("-p", "0", "0", "1600", "900", "--python-exit-code", "1")
    done = run(*window, "room.blend", "--python", "drive_panels.py", "--", str(folder), cwd=folder)
    if "unable to open a display" in done.stdout + done.stderr:
        pytest.skip("the real Blender has no screen")
    assert (folder / "found.json").is_file(), done.stdout + done.stderr
    told = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    shutil.rmtree(OUTPUT, ignore_errors=True)
    OUTPUT.mkdir(parents=True)
    for picture in folder.glob("*.png"):
        shutil.copy(picture, OUTPUT)
    assert told.get("done"), told.get("error")
    assert "Traceback" not in done.stdout + done.stderr, done.stdout + done.stderr
    return told


@pytest.mark.parametrize("width", ["narrow", "wide"])
@pytest.mark.parametrize(
    "name",
    [
        "probe, not planned",
        "probe",
        "probe, forced",
        "material",
        "material, injected",
        "probe, light",
        "material, light",
    ],
)
def test_panels_are_drawn(found, name: str, width: str) -> None:
    assert found["pictures"][f"{name} {width}"] > 100  # colours, with those of the letters' rims
    assert (OUTPUT / f"{name} {width}.png").stat().st_size > 3000


def test_drawing_plans_nothing(found) -> None:
    assert found["planned by drawing"] == 0


def test_the_plan_is_late_after_a_change_and_not_after_what_it_ordered(found) -> None:
    assert not found["late after injection"] and found["late after a move"]


def test_a_choice_shows_at_once_is_planned_and_is_one_undo_step(found) -> None:
    assert found["shown at once"] and found["forced"] == ["weight"]
    assert found["undone"] == ["AUTO", True]
