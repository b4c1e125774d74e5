"""The list of probes in a real Blender's sidebar. Pictures are kept in `tests/output/list`, to be looked at."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven, run

pytestmark = [*MARKS, pytest.mark.heavy]
OUTPUT = Path(__file__).parents[1] / "output" / "list"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_list.py` found."""
    run("room.blend", "--command", "pcc", "bake", "--save", cwd=folder)
    return driven(folder, "list", OUTPUT)


@pytest.mark.parametrize("name", ["list", "injected", "injected, light", "no probes"])
def test_it_is_drawn(found, name: str) -> None:
    assert found["pictures"][name] > 50  # colours, with those of the letters' rims
    assert (OUTPUT / f"{name}.png").stat().st_size > 2000


def test_states_come_by_themselves(found) -> None:
    assert found["by itself"] == {"Room": "BAKED", "Attic": "UNBAKED", "Cellar": "UNBAKED"}
    assert found["at once after a change"], "what was found before is told as such"
    assert found["after a change"]["Room"] == "STALE"


def test_nothing_is_checked_while_nothing_changes(found) -> None:
    assert found["checks with nothing to do"] == 0


def test_a_click_selects_the_probe(found) -> None:
    if found["clicked"] is None:
        pytest.skip("nothing here can click")
    name, selected = found["clicked"]
    assert selected == [name]


def test_what_is_added_in_the_window_is_set_as_the_scene_says(found) -> None:
    assert found["new"] == 128


def test_materials_are_restored_after_the_last_probe_went(found) -> None:
    assert found["restored"] == ["FINISHED"]
