"""Which probes materials show, by the plan, and that it says why."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pcc_addon.core.decisions import Effect, Forced
from pcc_addon.core.influence import Influence
from pcc_addon.core.pictures import LADDER
from pcc_addon.core.plan import make_plan
from pcc_addon.core.probe import Source
from pcc_addon.core.readings import (
    MaterialReading,
    SceneReading,
)

from .planning import ANISOTROPIC, ROUGH, many, plan_of, planned
from .scenes import material, placement, probe, surface


def test_a_material_shows_the_probe_that_its_object_is_in() -> None:
    plan = plan_of(material("Wood", emits=True), probes=(probe("Attic", 50.0), probe("Hall")))
    assert plan.probes == ("Hall",) and plan.objects == (("Wears Wood", "Hall"),)
    assert plan.emits and plan.reasons == () and plan.notes == ()
    assert set(plan.served) == {("Principled BSDF",)}


def test_materials_far_from_every_probe_have_no_plan() -> None:
    scene = SceneReading("Scene", (probe("Hall"),), (material("Wood"),), (placement("Moon", "Wood", x=90.0),))
    assert make_plan(scene).materials == ()


@pytest.mark.parametrize("turned", [False, True])
def test_the_probe_with_most_of_a_materials_objects_comes_first(turned: bool) -> None:
    probes = (probe("A", 0.0), probe("B", 10.0))
    placed = [placement("One", "Wood"), placement("Two", "Wood", x=10.0), placement("Three", "Wood", x=11.0)]
    plan = plan_of(material("Wood"), probes=probes[::-1] if turned else probes, placements=tuple(placed))
    assert plan.probes == ("B", "A")
    assert plan.objects == (("One", "A"), ("Three", "B"), ("Two", "B"))


def test_where_two_probes_have_as_much_the_name_decides() -> None:
    placed = (placement("One", "Wood"), placement("Two", "Wood", x=10.0))
    for names in (("A", "B"), ("B", "A")):
        plan = plan_of(material("Wood"), probes=(probe(names[0]), probe(names[1], 10.0)), placements=placed)
        assert plan.probes == ("A", "B")


def test_of_two_probes_in_one_place_the_one_with_pictures_of_its_own_comes_first() -> None:
    both = (replace(probe("A"), copy_of="C"), probe("B"), probe("C", 10.0))
    assert plan_of(material("Wood"), probes=both).probes == ("B", "A")
    given = (replace(both[0], source=Source.IMAGE), *both[1:])
    assert plan_of(material("Wood"), probes=given).probes == ("A", "B"), "a given picture is as good in any box"


def test_each_surface_is_planned_on_its_own_and_the_one_left_is_named() -> None:
    plan = plan_of(material("Wood", surface("Good"), surface("Odd", Anisotropic=None, Roughness=0.9)))
    assert set(plan.served) == {("Good",)} and plan.probes == ("Hall",)
    assert plan.notes == (f"material 'Wood': surface 'Odd' keeps its own lobe: {ANISOTROPIC} and {ROUGH}",)


def test_a_material_none_of_whose_surfaces_can_be_served_shows_nothing_and_names_each() -> None:
    plan = plan_of(material("Wood", surface("A", Anisotropic=None), surface("B", Roughness=0.9), emits=True))
    assert plan.probes == () and plan.objects == () and plan.served == {} and plan.emits
    assert [note.split(" keeps")[0] for note in plan.notes] == [
        "material 'Wood': surface 'A'",
        "material 'Wood': surface 'B'",
    ]


def test_obstacles_keep_a_material_as_it_is_and_are_all_named_once() -> None:
    plan = plan_of(material("Wood", surface(Anisotropic=None), obstacles=("is linked", "is odd")))
    assert plan.probes == ()
    assert plan.notes == ("material 'Wood' is linked; left as it is", "material 'Wood' is odd; left as it is")
    assert plan_of(material("Wood", obstacles=("is linked",))).probes == ()


def test_what_reflects_nothing_is_in_the_plan_and_nobody_is_told() -> None:
    light = plan_of(MaterialReading("Light"))
    assert light.reasons == ("has no surface that a probe could light; left as it is",) and light.notes == ()
    matt = plan_of(material("Matt", surface("Matt", Specular_IOR_Level=0.0), surface("Odd", Anisotropic=None)))
    assert matt.surfaces[0].reasons == ("it reflects nothing",)
    assert matt.notes == (f"material 'Matt': surface 'Odd' keeps its own lobe: {ANISOTROPIC}",)


@pytest.mark.parametrize(
    ("surfaces", "textures", "expected"),
    [
        ((surface(),), 0, 10),  # 30 samplers, three pictures each
        ((surface(),), 3, 9),
        ((surface(),), 4, 8),
        ((surface("A"), surface("B")), 0, 5),
        ((surface(Roughness=None),), 0, 3),  # eight levels each
        ((surface("A"), surface("B", Anisotropic=None)), 0, 10),  # one that is not served reads nothing
        ((surface(),), 40, 1),
    ],
    ids=[
        "one surface", "three textures", "four textures", "two surfaces", "a varying roughness", "one not served",
        "too many textures",
    ],
)  # fmt: skip
def test_a_material_shows_as_many_probes_as_eevee_can_read(surfaces: tuple, textures: int, expected: int) -> None:
    probes, placed = many(12)
    plan = plan_of(material("Wood", *surfaces, textures=textures), probes=probes, placements=placed)
    assert plan.probes == tuple(f"P{k:02}" for k in range(expected)), "those with most objects stay"
    assert {name for _, name in plan.objects} == set(plan.probes)
    [reason] = plan.reasons
    assert reason.startswith(f"shows {expected} probes and not 'P{expected:02}'") and reason.count("'P11'") == 1
    assert plan.notes[0] == f"material 'Wood' {reason}"


def test_probes_with_relief_have_one_picture_more() -> None:
    probes, placed = many(12)
    plan = plan_of(material("Wood", surface()), probes=probes, placements=placed)
    relieved = tuple(replace(one, spec=replace(one.spec, relief=True)) for one in probes)
    assert len(plan.probes) == 10  # 30 samplers, three pictures each
    assert len(plan_of(material("Wood", surface()), probes=relieved, placements=placed).probes) == 7


def test_probes_that_harden_read_every_level_of_rough_surfaces() -> None:
    """A slider that is changed within their reach then asks for no other choice of probes."""
    probes, placed = many(12)
    hard = tuple(replace(one, spec=replace(one.spec, contact_hardening=True)) for one in probes)
    plan = plan_of(material("Wood", surface()), probes=hard, placements=placed)
    assert plan.probes == ("P00", "P01", "P02")
    rough, mirror = (planned(surface(Roughness=value)) for value in (0.3, 0.0))
    assert rough.effects is not None and mirror.effects is not None
    [ray], [straight] = rough.effects.rays, mirror.effects.rays
    read = [LADDER[k] for k in rough.levels(LADDER, ray, hardening=True)]
    assert read == [0.1, 0.16, 0.23, 0.32, 0.44, 0.6], "from 0.3 times 0.35 to 0.3 times 1.5"
    assert list(rough.levels(LADDER, ray)) == [4, 5] and list(mirror.levels(LADDER, straight, hardening=True)) == [0]


def test_as_many_as_can_be_read_give_no_reason() -> None:
    probes, placed = many(10)
    plan = plan_of(material("Wood"), probes=probes, placements=placed)
    assert len(plan.probes) == 10 and plan.reasons == ()


def test_forcing_several_by_place_shows_nothing_on_objects_that_are_not_to_show_it() -> None:
    both = Forced(on=frozenset({Effect.BY_PLACE}))
    hall = probe("Hall", influence=Influence(excluded=frozenset({"Vase"})))
    placed = (placement("Table", "Wood", x=0.8), placement("Vase", "Wood", x=-0.8))
    for forced in (Forced(), both):
        scene = SceneReading("Scene", (hall,), (material("Wood", forced=forced),), placed)
        [plan] = make_plan(scene).materials
        [part] = plan.division.parts
        assert part.objects == ("Table",) and plan.division.kept == ()
