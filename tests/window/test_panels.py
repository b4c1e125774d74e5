"""The panels as a real Blender draws them. Pictures are kept in `tests/output/panels`, to be looked at."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven, run

pytestmark = [*MARKS, pytest.mark.heavy]
OUTPUT = Path(__file__).parents[1] / "output" / "panels"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_panels.py` found."""
    run("room.blend", "--command", "pcc", "bake", "--save", cwd=folder)
    return driven(folder, "panels", OUTPUT)


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
        "scene",
        "scene, light",
        *(f"{tab} {page}" for tab in ("tab", "tab, more settings", "tab, light") for page in (1, 2, 3)),
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


def test_the_pictures_of_a_bake_are_made_by_themselves(found) -> None:
    assert found["pictures of the bake"] == 2, "a ball and a cross"
