"""The switch to judge by in a real Blender. Pictures are kept in `tests/output/judging`, to be looked at."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven, run

pytestmark = [*MARKS, pytest.mark.heavy]
OUTPUT = Path(__file__).parents[1] / "output" / "judging"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_judging.py` found."""
    run("room.blend", "--command", "pcc", "bake", "--save", cwd=folder)
    return driven(folder, "judging", OUTPUT)


@pytest.mark.parametrize("view", ["UNCORRECTED", "OFF"])
def test_renders_in_a_thread_of_their_own_are_corrected_and_the_view_goes_on(found, view: str) -> None:
    assert found["shown"][view]
    assert found["rendered"][view] == [[True]] * 3
    assert found["after"][view]


def test_misfit_and_corrected_are_what_renders_show(found) -> None:
    assert found["misfit"] and found["corrected"]
