"""How a material is divided among objects that show different probes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pcc_addon.core.influence import Influence
from pcc_addon.core.parts import Division, MaterialPart, divide
from pcc_addon.core.plan import Plan, make_plan
from pcc_addon.core.readings import SceneReading

from .scenes import material, placement, probe

ABC = ("A", "B", "C")
EACH = {"a": {"A"}, "b": {"B"}, "c": {"C"}}


def test_two_probes_are_shown_by_place_and_three_by_copies() -> None:
    assert divide(("A", "B"), {"a": {"A"}, "b": {"B"}}, {}, (), 10) == Division(("A", "B"))
    parts = tuple(MaterialPart((name,), (name.lower(),)) for name in ABC)
    found = divide(ABC, EACH, {}, (), 10)
    assert found == Division((), parts) and found.probes == ABC
    assert not any(found.blends(name) for name in ABC)


def test_objects_that_show_the_same_wear_the_same_copy_and_points_of_one_choose_among_its_own() -> None:
    found = divide(ABC, {**EACH, "d": {"A"}, "e": {"C", "B"}}, {}, (), 10)
    assert found.parts == (
        MaterialPart(("A",), ("a", "d")), MaterialPart(("B",), ("b",)), MaterialPart(("B", "C"), ("e",)),
        MaterialPart(("C",), ("c",)),
    )  # fmt: skip
    assert [found.blends(name) for name in ABC] == [False, True, True]


def test_probes_of_a_copy_come_in_the_order_of_the_material_and_the_last_are_dropped() -> None:
    """The one that most objects belong to is first, wherever its name is in the alphabet."""
    found = divide(("C", "A", "B"), {"a": {"A", "C"}, "b": {"B", "A"}, "c": {"C"}}, {}, (), 2)
    assert set(found.parts) == {
        MaterialPart(("C", "A"), ("a",)), MaterialPart(("A", "B"), ("b",)), MaterialPart(("C",), ("c",)),
    }  # fmt: skip
    narrow = divide(("C", "A", "B"), {"a": set(ABC), "b": {"B"}}, {}, (), 1)
    assert {part.probes for part in narrow.parts} == {("C",), ("B",)} and narrow.dropped == ("A",)


def test_where_all_objects_show_the_same_nothing_is_divided() -> None:
    assert divide(ABC, {"a": set(ABC), "b": set(ABC)}, {}, (), 2) == Division(("A", "B"), (), ("C",))


def test_what_cannot_wear_a_copy_shows_the_material_itself() -> None:
    found = divide(ABC, EACH, {}, {"b"}, 10)
    assert found.kept == ("B",) and [part.probes for part in found.parts] == [("A",), ("C",)]
    assert set(found.probes) == set(ABC)


def test_a_part_shows_no_more_than_fit_and_says_what_nobody_shows() -> None:
    found = divide(ABC, {"a": set(ABC), "b": {"B"}}, {}, (), 2)
    assert found.parts == (MaterialPart(("A", "B"), ("a",)), MaterialPart(("B",), ("b",)))
    assert found.dropped == ("C",)


def test_one_object_that_is_not_to_show_the_probe_divides_even_two() -> None:
    needs = {"a": {"A"}, "b": set()}
    assert divide(("A",), needs, {"b": {"A"}}, (), 10) == Division((), (MaterialPart(("A",), ("a",)),))
    assert divide(("A",), needs, {"b": {"Z"}}, (), 10) == Division(("A",)), "nobody shows what it refuses"
    kept = divide(("A",), needs, {"b": {"A"}}, {"a"}, 10)
    assert kept == Division(("A",), (MaterialPart((), ("b",)),)), "it wears a copy that shows nothing"


def scene(*placed: object, **influence: object) -> Plan:
    hall = probe("Hall", influence=Influence(**influence))
    return make_plan(SceneReading("Scene", (hall, probe("Attic", 10.0)), (material("Wood"),), placed))


def test_excluded_objects_and_those_that_are_no_receivers_do_not_show_a_probe() -> None:
    placed = (placement("Table", "Wood"), placement("Vase", "Wood"))
    for influence in ({"excluded": frozenset({"Vase"})}, {"receivers": frozenset({"Table"})}):
        plan = scene(*placed, **influence)
        [wood] = plan.materials
        assert wood.objects == (("Table", "Hall"),)
        assert wood.division.parts == (MaterialPart(("Hall",), ("Table",)),)
        hall = plan.probe("Hall")
        assert hall is not None and "'Vase' in its influence are not to show it" in hall.reasons
    assert scene(*placed).materials[0].division == Division(("Hall",))


def test_an_object_that_no_probe_accepts_is_left_out_of_the_plan() -> None:
    assert scene(placement("Vase", "Wood"), receivers=frozenset()).materials == ()


@pytest.mark.parametrize(
    ("gap", "expected"),
    [(0.2, [("A",), ("B",), ("C",)]), (0.02, [("A", "B"), ("A", "B", "C"), ("B", "C")])],
)
def test_a_floor_inside_its_room_needs_the_neighbour_where_the_wall_is_thinner_than_the_handover(
    gap: float, expected: list
) -> None:
    """The boxes are four metres wide; a fifth of the falloff of 0.25 m is 0.05 m."""
    probes = tuple(probe(name, k * (4.0 + gap), padding=0.0) for k, name in enumerate(ABC))
    placed = tuple(placement(f"Floor {k}", "Wood", x=k * (4.0 + gap), size=(2.0, 2.0, 0.0)) for k in range(3))
    [wood] = make_plan(SceneReading("Scene", probes, (material("Wood"),), placed)).materials
    assert sorted(tuple(sorted(part.probes)) for part in wood.division.parts) == expected


def test_an_object_through_many_rooms_belongs_to_all_of_them() -> None:
    """A floor of forty rooms, each of which has a fortieth of it."""
    probes = tuple(probe(f"P{k:02}", 4.2 * k) for k in range(40))
    floor = placement("Floor", "Wood", x=4.2 * 19.5, size=(4.2 * 20.0, 2.0, 0.0))
    reading = SceneReading("Scene", probes, (material("Wood"),), (floor,))
    [wood] = make_plan(reading).materials
    assert len(wood.probes) == 10 and not wood.division.parts and len(wood.division.dropped) == 30
    [fixed] = make_plan(replace(reading, placements=(replace(floor, fixed=True),))).materials
    assert fixed.division == wood.division
