"""Which faces the plan captures: five where all that shows a probe is a mirror on its floor, six in any doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pcc_addon.core import faces_needed
from pcc_addon.core.cubemap import FACE_NAMES
from pcc_addon.core.decisions import Effect, Forced
from pcc_addon.core.effects.records import Outside
from pcc_addon.core.faces_needed import said, told_missing
from pcc_addon.core.plan import make_plan
from pcc_addon.core.probe import Source
from pcc_addon.core.probe_plan import ProbePlan
from pcc_addon.core.readings import (
    CameraReading,
    FacetReading,
    MaterialReading,
    PlacementReading,
    ProbeReading,
    SceneReading,
    SurfaceReading,
    Value,
)

from .scenes import material, placement, probe, surface

WITHOUT_BELOW = ("+X", "-X", "+Y", "-Y", "+Z")
WAY = (0.0, 0.0, 0.0)


def mirror(name: str = "Mirror", *others: SurfaceReading, **inputs: Value) -> MaterialReading:
    given = {"Roughness": 0.0, "Normal": WAY, **inputs}
    return material(name, replace(surface(**given)), *others)


def slab(name: str, *materials: str, x: float = 0.0, height: float = -2.0, half: float = 1.5) -> PlacementReading:
    """A square that lies at a height; rooms are cubes of 4 m around points of the x axis."""
    flat = placement(name, *materials, x=x, size=(half, half, 0.0))
    return replace(flat, corners=flat.corners + np.array([0.0, 0.0, height]))


def lying(item: PlacementReading, worn: str = "Mirror") -> FacetReading:
    return FacetReading.of(item.object, worn, np.array([[0.0, 0.0, 1.0]]), [item.corners])


FLOOR = slab("Floor", "Mirror")
HALL = probe("Hall", capture_offset=(0.0, 0.0, -1.0), resolution=512)
INSIDE = (CameraReading("Camera", (0.0, 0.0, 0.0)),)


def scene(
    *extra: PlacementReading,
    materials: tuple[MaterialReading, ...] = (mirror(),),
    halls: tuple[ProbeReading, ...] = (HALL,),
    facets: tuple[FacetReading, ...] | None = None,
    **more: object,
) -> SceneReading:
    placed = (FLOOR, *extra)
    flat = tuple(lying(item, worn) for item in placed for worn in item.materials) if facets is None else facets
    return SceneReading("Scene", halls, materials, placed, cameras=INSIDE, facets=flat, **more)


def planned(reading: SceneReading) -> ProbePlan:
    return make_plan(reading).probes[0]


def why(plan: ProbePlan) -> str:
    [decision] = [decision for decision in plan.decisions if decision.effect is Effect.FACES]
    assert decision.on is (plan.faces == FACE_NAMES)
    return decision.why


def test_relief_may_end_at_what_stands_below_the_capture_point() -> None:
    new = probe("Hall", capture_offset=(0.0, 0.0, -1.0), resolution=512, relief=True)
    captured = replace(new, captured_at=(0.0, 0.0, -1.0))
    for hall, needs_all in (
        (new, True),
        (replace(captured, departure=0.5), True),
        (captured, True),  # by its box; distances are captured next
        (replace(captured, departure=1e-4), False),
    ):
        plan = planned(scene(halls=(hall,)))
        assert plan.faces == (FACE_NAMES if needs_all else WITHOUT_BELOW), hall
        assert ("what stands in its box" in why(plan)) is needs_all


def test_what_a_floor_cannot_mirror_is_not_captured_and_the_plan_says_so() -> None:
    plan = planned(scene())
    assert plan.faces == plan.shown_faces == WITHOUT_BELOW
    assert why(plan) == "its face -Z is not captured: no surface that shows it can mirror that way"


def test_faces_are_named_in_sentences() -> None:
    assert said(["-Y"]) == "face -Y is" and said(["-X", "-Y", "-Z"]) == "faces -X, -Y and -Z are"
    assert told_missing("Hall", ["-Z"]) == "probe 'Hall': its face -Z is not captured and needed now; bake it again"


def test_everything_can_be_asked_for() -> None:
    plan = planned(with_hall(forced=Forced(on=frozenset({Effect.FACES}))))
    assert plan.faces == FACE_NAMES and why(plan).startswith("forced on, though its face -Z is not captured")


def with_hall(**settings: object) -> SceneReading:
    return scene(halls=(probe("Hall", **{"capture_offset": (0.0, 0.0, -1.0), "resolution": 512, **settings}),))


TABLE = slab("Table", "Mirror", height=-1.0, half=0.5)
LEAVING = slab("Floor2", "Mirror", half=2.5)
ELSEWHERE = slab("Pit", "Mirror", x=50.0, height=-4.0)
WAVY = material("Mirror", replace(surface(Roughness=0.0, Normal=None)), bends_normals=False)

RUG = slab("Rug", "Wool", half=0.5)

IN_DOUBT = {
    "no material shows it": scene(materials=(mirror(Roughness=0.9),)),
    "a shape that is not known to be flat": scene(facets=()),
    "a shape of which one part is not": scene(TABLE, facets=(lying(FLOOR),)),
    "an object that moves": scene(animated=frozenset({"Floor"})),
    "roughness that mixes what lies all around": scene(materials=(mirror(Roughness=0.3),)),
    "roughness that varies": scene(materials=(mirror(Roughness=None),)),
    "glass": scene(materials=(mirror(**{"Transmission Weight": 1.0}),)),
    "an anisotropic lobe": scene(materials=(mirror(Anisotropic=0.9, Roughness=0.02),)),
    "normals that are not bent": scene(materials=(WAVY,)),
    "a normal of its own": scene(materials=(mirror(Normal=(0.0, 0.6, 0.8)),)),
    "both sides of a table": scene(TABLE),
    "surfaces out of the box": scene(LEAVING),
    "surfaces that no probe reaches": scene(ELSEWHERE),
    "rough surfaces beside sharp ones": scene(materials=(mirror("Mirror", surface("Other", Roughness=0.4)),)),
    "a classic lookup": with_hall(corrected=False),
    "a probe that moves": with_hall(animated=True),
    "pictures from elsewhere": with_hall(source=Source.WORLD),
    "wide texels of a blurred level": replace(with_hall(resolution=16), materials=(mirror(Roughness=0.04),)),
    "a capture point at a wall": with_hall(capture_offset=(1.9, 0.0, 0.0)),
    "a capture point outside": with_hall(capture_offset=(2.5, 0.0, 0.0)),
    "shaders by hand": scene(halls=(replace(HALL, by_hand=True),)),
}


@pytest.mark.parametrize("reading", IN_DOUBT.values(), ids=IN_DOUBT)
def test_in_doubt_all_are_captured(reading: SceneReading) -> None:
    plan = planned(reading)
    assert plan.faces == plan.shown_faces == FACE_NAMES
    assert why(plan) == "surfaces that show it may mirror any way"


def test_the_uncorrected_lookup_outside_goes_anywhere() -> None:
    watched = replace(with_hall(outside=Outside.UNCORRECTED), cameras=())
    assert planned(watched).lookup.outside is Outside.UNCORRECTED
    assert planned(watched).faces == FACE_NAMES
    assert planned(replace(with_hall(outside=Outside.OWN), cameras=())).faces == WITHOUT_BELOW


SPARED = {
    "sharp lobes": scene(materials=(mirror(Roughness=0.05),)),
    "metal": scene(materials=(mirror(Metallic=1.0, Roughness=0.03),)),
    "bent normals": scene(materials=(mirror(Normal=None),)),
    "rugs that show nothing": scene(RUG, materials=(mirror(), mirror("Wool", Roughness=0.9))),
    "floors side by side": scene(slab("Rug", "Mirror", half=0.5)),
    "a floor a little below the wall": scene(slab("Pit", "Mirror", height=-2.005, half=0.5)),
    "an object that moves and shows nothing": scene(animated=frozenset({"Lamp"})),
    "contact hardening of mirrors": with_hall(contact_hardening=True),
}


@pytest.mark.parametrize("reading", SPARED.values(), ids=SPARED)
def test_what_is_known_spares_a_face(reading: SceneReading) -> None:
    assert planned(reading).faces == WITHOUT_BELOW


def test_the_picture_that_there_is_may_have_been_taken_elsewhere() -> None:
    moved = replace(HALL, captured_at=(1.9, 0.0, -1.0))
    plan = planned(scene(halls=(moved,)))
    assert plan.faces == WITHOUT_BELOW and plan.shown_faces == FACE_NAMES


def test_a_material_that_rooms_share_needs_no_more() -> None:
    """By place or as copies: what lies in another room shows that room's probe."""
    for count in (2, 4):
        rooms = [hall_at(10.0 * k) for k in range(count)]
        floors = [slab(f"Floor {k}", "Mirror", x=10.0 * k) for k in range(1, count)]
        plan = make_plan(scene(*floors, halls=tuple(rooms)))
        assert [each.faces for each in plan.probes] == [WITHOUT_BELOW] * count
        assert bool(plan.materials[0].division.parts) == (count > 2)
        plan = make_plan(scene(*floors, ELSEWHERE, halls=tuple(rooms)))
        expected = FACE_NAMES if count == 2 else WITHOUT_BELOW  # what is in no room shows both, or wears no copy
        assert [each.faces for each in plan.probes] == [expected] * count


def hall_at(x: float, half: float = 2.0) -> ProbeReading:
    return probe(f"Hall {x}", x, half, capture_offset=(0.0, 0.0, -1.0), resolution=512)


def test_what_lies_deep_in_another_room_shows_that_rooms_probe_only() -> None:
    deep = slab("Deep", "Mirror", x=10.0, height=-3.0)
    plan = make_plan(scene(deep, halls=(HALL, hall_at(10.0, 3.0))))
    assert plan.probes[0].faces == WITHOUT_BELOW
    leaving = slab("Deep", "Mirror", x=10.0, height=-3.0, half=3.5)
    plan = make_plan(scene(leaving, halls=(HALL, hall_at(10.0, 3.0))))
    assert plan.probes[0].faces == FACE_NAMES, "beyond its room it may show the other"


def test_how_far_objects_reach_out_of_a_box() -> None:
    assert faces_needed._beyond(HALL.spec, FLOOR.corners) == 0.0
    assert faces_needed._beyond(HALL.spec, slab("Pit", height=-2.5, half=2.25).corners) == pytest.approx(0.5)
