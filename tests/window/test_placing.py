"""Placing a probe with the pointer in a real Blender. Pictures are kept in `tests/output/placing`, to be looked at."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven

pytestmark = MARKS
OUTPUT = Path(__file__).parents[1] / "output" / "placing"
LONGER = 0.2  # metres: what a drag is at the least


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_placing.py` found."""
    found = driven(folder, "placing", OUTPUT)
    if found["skipped"]:
        pytest.skip(found["skipped"])
    return found


def same(one: dict, other: dict, *without: str) -> bool:
    names = one.keys() - set(without)
    return all(one[name] == pytest.approx(other[name], abs=1e-5) for name in names)


def test_the_menu_lays_the_box_on_the_walls_of_a_room_whose_ceiling_is_hidden(found) -> None:
    added, true = found["added"], found["true"]
    assert added["half"] == pytest.approx(true["half"], abs=0.05)
    assert added["turn"] == pytest.approx(true["turn"], abs=1e-4)
    assert added["centre"] == pytest.approx(true["centre"], abs=0.05)


def test_the_panel_has_the_size_that_was_chosen(found) -> None:
    name, half, around = found["panel"]
    assert name == "PCC_OT_probe_add" and around == "ROOM"
    assert half == pytest.approx(found["added"]["half"], abs=1e-4)


def test_a_wall_of_the_box_is_dragged_alone(found) -> None:
    before, after = found["added"], found["box"]
    assert after["half"][0] > before["half"][0] + 0.5 * LONGER and after["half"][1:] == pytest.approx(
        before["half"][1:]
    )
    assert same(before, after, "half", "centre", "offset")


def test_a_drag_is_cancelled(found) -> None:
    assert same(found["box"], found["cancelled"])


def test_shift_is_precise(found) -> None:
    first = found["box"]["half"][0] - found["added"]["half"][0]
    precise = found["precise"]["half"][0] - found["cancelled"]["half"][0]
    assert 0.05 * first < precise < 0.3 * first


def test_ctrl_snaps_to_the_grid(found) -> None:
    moved = 2.0 * (found["snapped"]["half"][1] - found["precise"]["half"][1])
    assert moved > LONGER and moved == pytest.approx(round(moved), abs=1e-4)


def test_the_influence_is_dragged_alone(found) -> None:
    before, after = found["snapped"], found["influence"]
    assert after["low"][0] > LONGER and after["low"][1:] == [0.0, 0.0]
    assert same(before, after, "low")


def test_the_capture_point_is_dragged_alone(found) -> None:
    before, after = found["influence"], found["point"]
    assert same(before, after, "capture", "offset") and not same(before, after)


def test_each_drag_is_one_undo_step(found) -> None:
    expected = [found[name] for name in ("influence", "snapped", "precise", "box", "added")]
    for undone, before in zip(found["undone"], expected, strict=False):
        assert same(before, undone)
    assert found["undone"][5] is None, "and so is the probe"


def test_selected_probes_are_drawn_where_overlays_are(found) -> None:
    assert found["drawn"] == 1 and found["drawn without overlays"] == 0
