"""What a material and an object show, chosen in a real Blender. Pictures are kept in `tests/output/choices`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven, run

pytestmark = [*MARKS, pytest.mark.heavy]
OUTPUT = Path(__file__).parents[1] / "output" / "choices"
SHOWN, ONE, NONE, AGAIN, NOT_HERE = (
    ["", True, True, True],
    ["Room", True, True, True],
    ["Room", False, True, False],
    ["Room", True, True, True],
    ["Room", True, False, False],
)
"""Chosen probe, Show Probes of the material and of the object, whether the floor shows a probe."""


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_choices.py` found."""
    run("room.blend", "--command", "pcc", "bake", "--inject", "--save", cwd=folder)
    return driven(folder, "choices", OUTPUT)


def test_choices_show_at_once(found) -> None:
    assert found["states"] == [SHOWN, ONE, NONE, AGAIN, NOT_HERE]


def test_each_choice_is_one_undo_step(found) -> None:
    assert found["undone"] == [AGAIN, NONE, ONE, SHOWN] and found["redone"] == [ONE, NONE, AGAIN, NOT_HERE]


def test_panels_are_drawn(found) -> None:
    assert len(found["pictures"]) >= 8
    for name, colours in found["pictures"].items():
        assert colours > 50, name  # with those of the letters' rims
