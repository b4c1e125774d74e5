"""A tour as a new user makes it, with mouse and keys. Pictures are kept in `tests/output/tour`, to be looked at."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from tests.packaging.extension import build
from tests.window.real import MARKS, driven, install
from tests.window.touring import MOST_CLICKS, MOST_SECONDS, seconds, two_rooms_without_probes

pytestmark = MARKS
OUTPUT = Path(__file__).parents[1] / "output" / "tour"
NEAR = 0.05  # metres: what a first guess may be off


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory, addon: None) -> dict[str, object]:
    """What `drive_tour.py` found in two rooms that share a floor."""
    place = tmp_path_factory.mktemp("tour")
    install(build(place), place)
    two_rooms_without_probes()
    bpy.ops.wm.save_as_mainfile(filepath=str(place / "room.blend"))
    found = driven(place, "tour", OUTPUT)
    if found["skipped"]:
        pytest.skip(found["skipped"])
    return found


def test_it_takes_few_clicks_and_little_of_a_persons_time(found) -> None:
    assert sum(step["clicks"] for step in found["steps"]) <= MOST_CLICKS
    assert sum(map(seconds, found["steps"])) <= MOST_SECONDS


def test_each_box_lies_on_the_walls_of_another_room(found) -> None:
    from sample_blends.two_rooms import LOUNGE, STUDY

    for box, room in zip(found["added"]["boxes"], (LOUNGE, STUDY), strict=True):
        assert box[:3] == pytest.approx(room.centre, abs=NEAR)
        assert sorted(box[3:6]) == pytest.approx(sorted(room.half_extents), abs=NEAR)


def test_what_was_baked_shows_in_materials_and_in_the_viewport(found) -> None:
    assert found["added"]["baked"] == 0 and found["shown"]["baked"] == 2 and found["shown"]["showing"] >= 2
    assert found["shading"] == ["SOLID", "RENDERED"]
    assert "Probes show in" in found["outcome"][0] and len(found["outcome"]) == 1


def test_each_step_is_undone_and_redone(found) -> None:
    went = [(len(each["boxes"]), each["baked"], each["showing"] > 0) for each in found["undone"]]
    without_the_cursor = [each for k, each in enumerate(went) if k == 0 or each != went[k - 1]]
    bakes = [(2, 2, True), (2, 1, True), (2, 1, False), (2, 0, False)]  # each probe is shown a step after its bake
    assert without_the_cursor == [*bakes, (1, 0, False), (0, 0, False)]
    assert found["undone"][-1] == found["empty"] and found["redone"][-1] == found["shown"]
