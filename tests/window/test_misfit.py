"""A misfit as a real Blender draws it. Pictures are kept in `tests/output/misfit`, to be looked at."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven

pytestmark = [*MARKS, pytest.mark.heavy]
OUTPUT = Path(__file__).parents[1] / "output" / "misfit"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_misfit.py` found."""
    return driven(folder, "misfit", OUTPUT)


def test_it_is_drawn_while_it_is_switched_on(found) -> None:
    drawn = found["pictures"]
    for name in ("before", "found", "off"):
        assert drawn[f"{name}, view"]["magenta"] == 0, name
    for name in ("shown", "shown again", "light"):
        assert drawn[f"{name}, view"]["magenta"] > 50, name
    assert drawn["shown, view"]["red"] > drawn["found, view"]["red"] + 200


def test_it_is_made_once_and_forgotten_when_it_is_switched_off(found) -> None:
    assert found["made once"] and found["forgotten"]
