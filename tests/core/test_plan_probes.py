"""What the planner decides of probes, and that it says why."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import pytest

from pcc_addon.core.decisions import Decision, Effect, Forced
from pcc_addon.core.effects.records import Correction, Outside
from pcc_addon.core.influence import Influence
from pcc_addon.core.pictures import LADDER, PictureKey, PictureKind
from pcc_addon.core.plan import make_plan
from pcc_addon.core.probe import Source
from pcc_addon.core.probe_plan import ProbePlan
from pcc_addon.core.readings import (
    CameraReading,
    MaterialReading,
    ProbeReading,
    SceneReading,
)

from .planning import decision, many, plan_of, probe_plan
from .scenes import material, placement, probe, surface


def test_a_probe_with_all_surfaces_inside_tests_and_fades_nothing() -> None:
    plan = probe_plan(placement("Table", "Wood"))
    assert plan.lookup.correction is Correction.ALIGNED_BOX and plan.lookup.outside is None
    assert not plan.lookup.offset and not plan.lookup.facing and not plan.shares
    assert plan.receivers.all_inside and not plan.receivers.seen_from_outside
    assert plan.reasons == ("1 materials show it",)
    assert decision(plan, Effect.FADE) == Decision(Effect.FADE, False, "all surfaces that show it are in its box")


@pytest.mark.parametrize("outside", list(Outside))
def test_a_surface_that_leaves_the_box_makes_it_fade_as_it_is_set(outside: Outside) -> None:
    plan = probe_plan(placement("Floor", "Wood", size=(5.0, 5.0, 0.1)), outside=outside)
    assert plan.lookup.outside is outside and plan.lookup.facing and not plan.receivers.all_inside
    assert decision(plan, Effect.FADE) == Decision(Effect.FADE, True, "surfaces of 'Wood' reach beyond its box")


WALL = placement("Wall", "Wood", x=1.5)


@pytest.mark.parametrize(
    ("places", "watched"),
    [
        ((), True),
        (((0.0, 0.0, 0.0),), False),
        (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), False),
        (((9.0, 0.0, 0.0),), True),
        (((0.0, 0.0, 0.0), (9.0, 0.0, 0.0)), True),
        ((None,), True),
        (((0.0, 0.0, 0.0), None), True),
    ],
    ids=["no camera", "inside", "both inside", "outside", "one outside", "animated", "one animated"],
)
def test_a_wall_on_the_box_is_looked_at_from_outside_unless_all_cameras_stay_in(places: tuple, watched: bool) -> None:
    cameras = tuple(CameraReading(f"Camera {k}", place) for k, place in enumerate(places))
    plan = probe_plan(WALL, cameras=cameras)
    assert plan.receivers.seen_from_outside is watched and plan.receivers.all_inside
    assert plan.lookup.facing is watched and (plan.lookup.outside is not None) is watched
    words = "surfaces of 'Wood' lie on its box and may be seen" if watched else "no surface on its box is seen"
    said = decision(plan, Effect.OUTER_SIDES)
    assert said.on is watched and said.why == f"{words} from outside"


def test_what_reaches_beyond_a_wall_may_turn_its_outer_side_to_a_camera_in_the_box() -> None:
    inside = (CameraReading("Camera", (0.0, 0.0, 0.0)),)
    assert not probe_plan(WALL, cameras=inside).lookup.facing
    assert probe_plan(placement("Wall", "Wood", x=1.505), cameras=inside).lookup.facing, "within the padding"


def test_a_camera_on_a_wall_or_in_the_padding_is_not_inside() -> None:
    for x, watched in ((1.9, False), (2.0, True), (2.005, True)):
        assert probe_plan(WALL, cameras=(CameraReading("Camera", (x, 0.0, 0.0)),)).lookup.facing is watched, x


def test_an_object_elsewhere_that_shows_the_probe_makes_it_fade() -> None:
    """Its material shows the probe wherever it is worn."""
    table, moon = placement("Table", "Wood"), placement("Moon", "Wood", x=50.0)
    assert probe_plan(table).lookup.outside is None
    plan = probe_plan(table, moon)
    assert plan.lookup.outside is not None and plan.lookup.facing and plan.lookup.on_walls


@pytest.mark.parametrize(("settings", "fades"), [({}, False), ({"weight": 0.5}, True), ({"normal_fade": 0.3}, True)])
def test_an_object_that_is_all_in_its_own_room_asks_nothing_of_the_other(settings: dict, fades: bool) -> None:
    """Unless its own probe leaves something, of which the other, whose box it is not in, would have a part."""
    probes = (probe("A"), probe("B", 10.0, influence=Influence(**settings)))
    placed = (placement("Here", "Wood"), placement("There", "Wood", x=10.0))
    plan = make_plan(SceneReading("Scene", probes, (material("Wood"),), placed)).probe("A")
    assert plan.shares and (plan.lookup.outside is not None) is fades


def test_nobody_looks_at_an_object_in_the_middle_from_outside() -> None:
    far = (CameraReading("Camera", (90.0, 0.0, 0.0)),)
    assert not probe_plan(placement("Table", "Wood"), cameras=far).receivers.seen_from_outside


def test_the_capture_point_counts_where_the_pictures_were_taken() -> None:
    table, wood = placement("Table", "Wood"), material("Wood")

    def offset(reading: ProbeReading) -> bool:
        plan = make_plan(SceneReading("Scene", (reading,), (wood,), (table,))).probe("Hall")
        assert plan is not None
        return plan.lookup.offset

    assert not offset(probe("Hall")), "before the first bake at the centre"
    assert offset(probe("Hall", capture_offset=(0.1, 0.0, 0.0)))
    assert offset(replace(probe("Hall"), captured_at=(0.5, 0.0, 0.0)))
    moved_back = replace(probe("Hall", capture_offset=(0.1, 0.0, 0.0)), captured_at=(0.0, 0.0, 0.0))
    assert not offset(moved_back)


def test_a_picture_from_elsewhere_is_stretched_as_long_as_it_is_shown() -> None:
    table, wood = placement("Table", "Wood"), material("Wood")

    def plan(reading: ProbeReading) -> ProbePlan:
        found = make_plan(SceneReading("Scene", (reading,), (wood,), (table,))).probe("Hall")
        assert found is not None
        return found

    def says_so(reading: ProbeReading) -> bool:
        found = plan(reading)
        assert found.lookup.stretched == any("stretched" in reason for reason in found.reasons)
        return found.lookup.stretched

    assert not says_so(probe("Hall"))
    assert says_so(probe("Hall", source=Source.WORLD)), "before the first bake by the setting"
    baked = replace(probe("Hall", source=Source.IMAGE), captured_at=(0.5, 0.0, 0.0))
    assert not says_so(baked) and plan(baked).lookup.offset, "then by what its pictures are"
    assert says_so(replace(probe("Hall"), captured_at=(0.0, 0.0, 0.0), source=Source.IMAGE))


def test_a_probe_that_shares_a_material_says_so_and_one_that_does_not_does_not() -> None:
    probes = (probe("A"), probe("B", 10.0), probe("C", 20.0), probe("D", 30.0))
    placed = (
        placement("One", "Wood"), placement("Two", "Wood", "Iron", x=10.0), placement("Three", "Iron", x=20.0),
        placement("Four", "Clay", x=30.0),
    )  # fmt: skip
    plan = make_plan(SceneReading("Scene", probes, tuple(map(material, ("Clay", "Iron", "Wood"))), placed))
    assert [(p.probe, p.shares) for p in plan.probes] == [("A", True), ("B", True), ("C", True), ("D", False)]
    b, d = plan.probe("B"), plan.probe("D")
    assert b is not None and d is not None and plan.probe("E") is None
    assert "shares 'Iron' and 'Wood' with other probes, by place" in b.reasons
    assert "2 materials show it" in b.reasons
    assert not any("shares" in reason for reason in d.reasons)


def test_a_probe_that_no_material_shows_says_so() -> None:
    plan = probe_plan()
    assert plan.reasons[0] == "no material shows it" and not plan.shares and plan.receivers.all_inside


def test_a_probe_that_nothing_can_show_needs_no_bake_and_says_why() -> None:
    assert probe_plan().unneeded == "no object is in its influence"
    table = placement("Table", "Wood")
    assert probe_plan(table).unneeded == ""
    matt = material("Wood", surface(Roughness=0.9))

    def unneeded(reading: ProbeReading, **scene: object) -> str:
        [plan] = make_plan(SceneReading("Scene", (reading,), (matt,), (table,), **scene)).probes
        return plan.unneeded

    assert unneeded(probe("Hall")) == "no material in its influence has a surface that could show it"
    assert not unneeded(probe("Hall"), animated=frozenset({"Table"})), "it may move to where it is shown"
    assert not unneeded(probe("Hall", animated=True))
    assert not unneeded(replace(probe("Hall"), by_hand=True)) and not unneeded(replace(probe("Hall"), in_windows=True))


def test_what_moves_may_leave_the_box_and_touch_its_walls() -> None:
    table = placement("Table", "Wood")
    still, moving = (
        make_plan(SceneReading("Scene", (probe("Hall"),), (material("Wood"),), (table,), animated=names)).probes[0]
        for names in (frozenset(), frozenset({"Table"}))
    )
    assert still.lookup.outside is None and not still.lookup.on_walls
    assert moving.lookup.outside is not None and moving.lookup.on_walls and moving.lookup.facing


def test_a_probe_dropped_for_want_of_samplers_is_not_counted_as_shown() -> None:
    probes, placed = many(3)
    plan = make_plan(SceneReading("Scene", probes, (material("Wood", textures=24),), placed))
    assert [p.reasons[0] for p in plan.probes] == ["1 materials show it", "1 materials show it", "no material shows it"]


def pictures(levels: Iterable[int]) -> tuple[PictureKey, ...]:
    return tuple(PictureKey(PictureKind.RADIANCE, level) for level in levels)


@pytest.mark.parametrize(
    ("roughness", "expected"),
    [(0.0, (0,)), (0.25, (0, 4, 5)), (0.44, (0, 6)), (None, tuple(range(8)))],
    ids=["mirror", "between two", "on a rung", "varying"],
)
def test_a_probe_needs_its_capture_and_the_levels_that_its_surfaces_read(roughness, expected) -> None:
    glossy = material("Wood", surface(Roughness=roughness, Metallic=1.0))
    [plan] = make_plan(SceneReading("Scene", (probe("Hall"),), (glossy,), (placement("Table", "Wood"),))).probes
    assert plan.pictures == pictures(expected)
    assert decision(plan, Effect.LEVELS).on is (len(expected) == len(LADDER))


def test_levels_above_the_limit_are_read_nowhere() -> None:
    glossy = material("Wood", surface(Roughness=None))
    placed = (placement("Table", "Wood"),)
    [plan] = make_plan(SceneReading("Scene", (probe("Hall"),), (glossy,), placed, roughness_limit=0.2)).probes
    assert plan.pictures == pictures(range(5)), "0.23 is the first that is not below the limit"


def test_whoever_reads_it_at_any_roughness_needs_all_levels() -> None:
    mirror, placed = material("Wood", surface(Roughness=0.0)), (placement("Table", "Wood"),)
    for reading, expected in (
        (probe("Hall"), (0,)),
        (replace(probe("Hall"), by_hand=True), range(8)),
        (replace(probe("Hall"), in_windows=True), (0,)),
        (probe("Hall", forced=Forced(on=frozenset({Effect.LEVELS}))), range(8)),
        (probe("Hall", forced=Forced(off=frozenset({Effect.LEVELS}))), (0,)),
    ):
        [plan] = make_plan(SceneReading("Scene", (reading,), (mirror,), placed)).probes
        assert plan.pictures == pictures(expected), reading
    assert probe_plan().pictures == pictures(range(8)), "nobody knows who will show it"


def test_the_classic_lookup_has_no_box() -> None:
    assert probe_plan(placement("Floor", "Wood", size=(5.0, 5.0, 0.1)), corrected=False).lookup.correction is (
        Correction.NONE
    )


def test_a_faulty_probe_is_named_and_the_others_go_on() -> None:
    broken = ProbeReading("Broken", None, "probe 'Broken': its box has no volume")
    plan = make_plan(SceneReading("Scene", (broken, probe("Hall")), (material("Wood"),), (placement("T", "Wood"),)))
    assert [p.probe for p in plan.probes] == ["Hall"] and plan.notes == ("probe 'Broken': its box has no volume",)
    assert plan.materials[0].probes == ("Hall",)


def test_the_scenes_own_limit_counts() -> None:
    wood = material("Wood", surface(Roughness=0.5))
    assert plan_of(wood, roughness_limit=0.4).probes == ()
    assert plan_of(wood, roughness_limit=0.5).probes == ("Hall",)


def test_a_probe_that_hardens_says_so() -> None:
    for value in (False, True):
        plan = probe_plan(placement("Table", "Wood"), contact_hardening=value)
        assert plan.lookup.hardening == value == decision(plan, Effect.HARDENING).on
    mirror = MaterialReading("Wood", (surface(Roughness=0.0),))
    scene = SceneReading("Scene", (probe("Hall", contact_hardening=True),), (mirror,), (placement("Table", "Wood"),))
    [plan] = make_plan(scene).probes
    assert not plan.lookup.hardening and decision(plan, Effect.HARDENING).why == "all surfaces that show it are mirrors"


@pytest.mark.parametrize(
    ("departure", "captured", "on"),
    [(None, False, True), (None, True, False), (0.4, True, True), (1e-5, True, False), (math.inf, True, True)],
    ids=["before its bake", "baked without distances", "furnished", "empty", "another box"],
)
def test_relief_is_on_where_what_was_captured_departs_from_the_box(departure, captured, on) -> None:
    at = (0.0, 0.0, 0.0) if captured else None
    reading = probe("Hall")
    reading = replace(reading, spec=replace(reading.spec, relief=True), captured_at=at, departure=departure)
    plan = make_plan(SceneReading("Scene", (reading,), (material("Wood"),), (placement("Table", "Wood"),)))
    [hall] = plan.probes
    assert decision(hall, Effect.RELIEF).on is on and bool(hall.lookup.steps) is on
    assert decision(hall, Effect.RELIEF).why


def test_what_a_measurement_of_costs_recommends_is_told() -> None:
    reading = replace(probe("Hall"), advice="Path tracing wins here, because its frames are as quick.")
    plan = make_plan(SceneReading("Scene", (reading,), (material("Wood"),), (placement("Table", "Wood"),)))
    assert "measured: Path tracing wins here, because its frames are as quick." in plan.probe("Hall").reasons
