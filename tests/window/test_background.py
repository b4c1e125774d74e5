"""A bake in the background of a real Blender that is worked on. Pictures are kept in `tests/output/background`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window.real import MARKS, driven, run

pytestmark = MARKS
OUTPUT = Path(__file__).parents[1] / "output" / "background"


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, object]:
    """What `drive_background.py` found in a file whose probe has a bake."""
    run("room.blend", "--command", "pcc", "bake", "--save", cwd=folder)
    return driven(folder, "background", OUTPUT, "--enable-event-simulate")


def test_a_tool_goes_on_while_a_bake_runs_and_the_bake_waits_for_its_end(found) -> None:
    assert found["changed by starting"] == found["while it waits"] == ["Room: stale"]
    assert found["tool"] == ["TRANSFORM_OT_translate"]
    assert found["waits"] == "'Room' is baked and waits for the end of 'Move'"
    assert found["moved by"] > 0.1
    assert found["after a move"] == ["Room: stale"], "it was moved after the copy was made"


def test_esc_is_the_tools_own(found) -> None:
    assert found["esc"] == [0, True]
    assert found["baked again"] == ["Room: baked"]


def test_undo_and_redo_bring_back_each_bake_with_its_pictures(found) -> None:
    assert found["undone and redone"] == [[True, True, True]] * 10
    assert found["after undo"] == ["Room: baked"]


def test_a_cancelled_bake_leaves_nothing(found) -> None:
    assert found["cancelled"] == [True, True, [], ["Room: baked"]]


def test_a_probe_is_found_by_another_name_and_missed_when_it_is_deleted(found) -> None:
    assert found["renamed"] == [["Hall: baked"], ["PCC Hall"]]
    assert found["left"] == []
    assert found["deleted"] == ["probe 'Hall' was deleted meanwhile, and its new bake with it"]
    assert found["brought back"] == ["Hall: baked"]


def test_another_file_gets_nothing_of_it(found) -> None:
    assert found["opened"] == [True, True, ["Hall: baked"]] and found["left behind"] == []


def test_closing_blender_ends_the_other_one_which_leaves_nothing(found, folder: Path) -> None:
    assert [path.name for path in folder.rglob("*") if "unfinished" in path.name] == []


@pytest.mark.parametrize("panel", ["View3D", "Properties"])
@pytest.mark.parametrize("name", ["before", "running", "waiting", "done", "cancelled", "light, running", "light, done"])
def test_pictures_are_kept(found, name: str, panel: str) -> None:
    assert (OUTPUT / f"{name}, {panel}.png").stat().st_size > 3000
