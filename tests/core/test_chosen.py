"""What artists choose of the probes that materials and objects show is obeyed, and said in words."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pcc_addon.core.decisions import Effect, Forced
from pcc_addon.core.parts import Division, MaterialPart
from pcc_addon.core.plan import Plan, make_plan
from pcc_addon.core.readings import PlacementReading, ProbeReading, SceneReading

from .planning import plan_of
from .scenes import material, placement, probe

ROOMS = (probe("Hall"), probe("Attic", 10.0))
OFF = "its Show Probes is off"
BOTH = (placement("Here", "Wood"), placement("There", "Wood", x=10.0))


def only(*names: str) -> dict[str, frozenset[str]]:
    return {"allowed": frozenset(names)}


def test_the_chosen_probe_alone_serves_a_material_wherever_it_reaches() -> None:
    plan = plan_of(material("Wood", **only("Attic")), probes=ROOMS, placements=BOTH)
    assert plan.division == Division(("Attic",)) and plan.objects == (("There", "Attic"),)
    assert plan.choices == ("its Probe is 'Attic', which it shows alone",) and plan.reasons == () and plan.notes == ()
    assert plan.strays == {"Attic"}, "it is on an object that the probe does not reach, so the probe must fade"


def test_where_boxes_overlap_the_chosen_one_is_the_only_one() -> None:
    large = probe("Large", half=5.0)
    for chosen in ("Hall", "Large"):
        plan = plan_of(material("Wood", **only(chosen)), probes=(ROOMS[0], large))
        assert plan.probes == (chosen,)


def test_other_materials_of_the_same_object_show_what_they_showed() -> None:
    placed = (placement("Table", "Wood", "Iron"),)
    scene = SceneReading("Scene", ROOMS, (material("Iron"), material("Wood", **only())), placed)
    plan = make_plan(scene)
    assert [(m.material, m.probes) for m in plan.materials] == [("Iron", ("Hall",)), ("Wood", ())]
    hall = plan.probe("Hall")
    assert hall is not None and hall.reasons[0] == "1 materials show it"
    assert "'Wood' in its influence are to show another probe alone, or none" in hall.reasons


def test_an_excluded_material_shows_nothing_and_nobody_is_warned_of_it() -> None:
    plan = plan_of(material("Wood", **only()), probes=ROOMS, placements=BOTH)
    assert plan.division == Division(()) and plan.choices == (OFF,) and plan.notes == ()


@pytest.mark.parametrize(
    ("chosen", "why"),
    [
        ("Attic", "and none of its objects may show that: move it or choose another"),
        ("Cellar", "which is no probe of scene 'Scene': choose another"),
        ("Broken", "which is faulty: mend it or choose another"),
    ],
)
def test_a_choice_that_gives_nothing_says_why(chosen: str, why: str) -> None:
    probes = (*ROOMS, ProbeReading("Broken", None, "probe 'Broken' is faulty"))
    plan = plan_of(material("Wood", **only(chosen)), probes=probes)
    assert plan.probes == () and plan.notes == (f"material 'Wood' is to show '{chosen}' alone, {why}",)


def test_an_excluded_object_shows_nothing_and_others_show_the_material_in_a_copy() -> None:
    vase = replace(placement("Vase", "Wood"), excluded=True)
    plan = plan_of(material("Wood"), placements=(placement("Table", "Wood"), vase))
    assert plan.division == Division((), (MaterialPart(("Hall",), ("Table",)),))
    assert plan.choices == ("Show Probes of 'Vase' is off",)
    alone = plan_of(material("Wood"), placements=(vase,))
    assert alone.probes == () and alone.choices == plan.choices and alone.notes == ()
    chosen = plan_of(material("Wood", **only("Hall")), placements=(vase,))
    assert chosen.choices[1:] == plan.choices and chosen.reasons == (), "that is reason enough"


def test_several_by_place_forced_off_leaves_excluded_objects_out_too() -> None:
    placed = (placement("Here", "Wood"), replace(placement("Vase", "Wood"), excluded=True))
    both = (ROOMS[0], probe("Large", half=5.0))
    for which in ({"off": frozenset({Effect.BY_PLACE})}, {"on": frozenset({Effect.BY_PLACE})}):
        plan = plan_of(material("Wood", forced=Forced(**which)), probes=both, placements=placed)
        shown = {item: part.probes for part in plan.division.parts for item in part.objects}
        assert not shown.get("Vase", plan.division.kept) and shown["Here"]


def test_an_excluded_object_that_cannot_wear_a_copy_leaves_the_material_itself_clean() -> None:
    vase = replace(placement("Vase", "Wood"), excluded=True, fixed=True)
    plan = plan_of(material("Wood"), placements=(placement("Table", "Wood"), vase))
    assert plan.division == Division((), (MaterialPart(("Hall",), ("Table",)),)) and plan.notes[0].count("copies") == 1
    shelf = replace(placement("Shelf", "Wood"), fixed=True)
    stuck = plan_of(material("Wood"), placements=(shelf, vase))
    assert stuck.division.kept == ("Hall",)
    assert "shows probes on 'Vase' all the same: linked, or given it by a modifier" in stuck.reasons


def test_what_is_left_out_by_choice_alone_needs_no_bake_and_says_so() -> None:
    vase = replace(placement("Vase", "Wood"), excluded=True)
    for wood, placed in ((material("Wood", **only()), placement("Vase", "Wood")), (material("Wood"), vase)):
        hall = make_plan(SceneReading("Scene", ROOMS[:1], (wood,), (placed,))).probe("Hall")
        assert hall is not None and hall.unneeded == "what is in its influence cannot show it, or is not to"


# Whatever is chosen in whatever scene.


@st.composite
def scenes(draw: st.DrawFn) -> SceneReading:
    """Rooms in a row that may overlap, and objects anywhere with materials of which some are chosen for."""
    names = ("A", "B", "C")[: draw(st.integers(1, 3))]
    probes = tuple(probe(name, draw(st.sampled_from([3.0, 4.1, 6.0])) * k) for k, name in enumerate(names))
    some = st.one_of(st.none(), st.frozensets(st.sampled_from((*names, "Gone")), max_size=1))
    woods = tuple(material(f"M{k}", allowed=draw(some)) for k in range(3))

    def place(k: int) -> PlacementReading:
        worn = draw(st.lists(st.sampled_from([wood.name for wood in woods]), max_size=2, unique=True))
        size = draw(st.sampled_from([(0.5, 0.5, 0.5), (4.0, 1.0, 0.0)]))
        found = placement(f"O{k}", *worn, x=draw(st.sampled_from([0.0, 2.0, 4.0, 9.0])), size=size)
        return replace(found, excluded=draw(st.booleans()), fixed=draw(st.booleans()))

    return SceneReading("Scene", probes, woods, tuple(place(k) for k in range(draw(st.integers(1, 4)))))


def unchosen(scene: SceneReading) -> SceneReading:
    return replace(scene, materials=tuple(replace(one, allowed=None) for one in scene.materials))


def of(plan: Plan) -> dict[str, Division]:
    return {each.material: each.division for each in plan.materials}


@given(scenes())
def test_every_choice_is_obeyed_and_named(scene: SceneReading) -> None:
    plan = make_plan(scene)
    plans = {each.material: each for each in plan.materials}
    worn = {name for placed in scene.placements for name in placed.materials}
    for one in scene.materials:
        if one.allowed is not None and one.name in worn:
            assert set(plans[one.name].probes) <= one.allowed and plans[one.name].choices
    excluded = {placed.object for placed in scene.placements if placed.excluded}
    for each in plan.materials:
        assert not excluded & {item for item, _ in each.objects}
        for part in each.division.parts:
            assert not part.probes or not excluded & {*part.objects}


@given(scenes())
def test_a_choice_for_a_material_changes_no_other_material(scene: SceneReading) -> None:
    free = of(make_plan(unchosen(scene)))
    for name, division in of(make_plan(scene)).items():
        if next(one for one in scene.materials if one.name == name).allowed is None:
            assert division == free.get(name, Division(()))


@given(scenes())
def test_choosing_the_only_probe_that_a_material_shows_changes_nothing(scene: SceneReading) -> None:
    free = unchosen(scene)
    shown = {each.material: each for each in make_plan(free).materials}
    needs_one = {name for name, each in shown.items() if len(each.probes) == 1 and not each.division.parts}
    chosen = tuple(
        replace(one, allowed=frozenset(shown[one.name].probes)) if one.name in needs_one else one
        for one in free.materials
    )
    after = of(make_plan(replace(free, materials=chosen)))
    assert {name: after[name] for name in needs_one} == {name: shown[name].division for name in needs_one}
