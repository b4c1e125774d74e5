"""What the planner decides, from readings alone, and that it says why."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import pytest

from pcc_addon.core.decisions import Decision, Effect, Forced
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.glossy import Glossy
from pcc_addon.core.effects.metal import Metal, TintedMetal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.records import Correction, Outside
from pcc_addon.core.effects.transmission import Interface
from pcc_addon.core.ggx import Distribution
from pcc_addon.core.influence import Influence
from pcc_addon.core.material_plan import MaterialPlan
from pcc_addon.core.pictures import LADDER, PictureKey, PictureKind
from pcc_addon.core.plan import make_plan
from pcc_addon.core.probe import Source
from pcc_addon.core.probe_plan import ProbePlan
from pcc_addon.core.readings import (
    CameraReading,
    MaterialReading,
    ProbeReading,
    SceneReading,
    SurfaceReading,
    Value,
    WallReading,
)
from pcc_addon.core.surface_plan import SurfacePlan, plan_surfaces

from .scenes import INPUTS, material, placement, probe, surface

LIMIT = 0.6


def planned(reading: SurfaceReading, limit: float = LIMIT) -> SurfacePlan:
    [plan] = plan_surfaces(MaterialReading("Wood", (reading,)), limit)
    return plan


def plan_of(*materials: MaterialReading, probes: tuple[ProbeReading, ...] = (), **scene: object) -> MaterialPlan:
    """The plan of the only material, on one object in the middle."""
    probes = probes or (probe("Hall"),)
    placed = scene.pop("placements", tuple(placement(f"Wears {m.name}", m.name) for m in materials))
    [plan] = make_plan(SceneReading("Scene", probes, materials, placed, **scene)).materials
    return plan


ANISOTROPIC = "has an anisotropy that varies (a constant one would show a probe)"

ROUGH = "its roughness 0.9 is above the scene's limit 0.6"

# Surfaces


def test_a_plain_surface_is_served_and_says_its_roughness_and_effects() -> None:
    plan = planned(surface())
    assert plan.effects is not None and plan.effects.effects == (Dielectric(1.5, 1.5, pytest.approx(0.04)),)
    assert plan.roughness == (0.25, 0.25) and plan.handed_over is None
    assert plan.reasons == ("roughness 0.25", plan.effects.label)
    assert plan.path == ("Principled BSDF",) and plan.name == "Principled BSDF"


def test_a_mirror_with_an_index_below_1_is_served() -> None:
    plan = planned(surface(IOR=0.75, Roughness=0.0))
    assert plan.effects is not None and plan.effects.effects[0].eta == 0.75


def test_a_surface_in_groups_is_named_with_the_way_to_it() -> None:
    assert planned(replace(surface(), path=("Outer", "Inner", "Shiny"))).name == "Outer › Inner › Shiny"


@pytest.mark.parametrize(
    ("inputs", "reason"),
    [
        ({"IOR": 0.99}, "has an IOR below 1 (1 or more would show a probe, or a roughness of 0)"),
        ({"Anisotropic": None}, ANISOTROPIC),
        ({"Roughness": 0.61}, "its roughness 0.61 is above the scene's limit 0.6"),
        ({"Roughness": 7.0}, "its roughness 7 is above the scene's limit 0.6"),
        ({"Specular_IOR_Level": 0.0}, "it reflects nothing"),
        ({"IOR": 1.0}, "it reflects nothing"),
    ],
    ids=str,
)
def test_a_surface_that_no_probe_can_serve_keeps_its_lobe_and_says_why(inputs: dict, reason: str) -> None:
    plan = planned(surface(**inputs))
    assert plan.effects is None and plan.reasons == (reason,)


@pytest.mark.parametrize(("name", "layer"), [("Coat_Weight", "coat"), ("Sheen_Weight", "sheen")])
@pytest.mark.parametrize("weight", [0.01, None])
def test_layers_stay_over_the_lobe(name: str, layer: str, weight: float | None) -> None:
    plan = planned(surface(**{name: weight}))
    assert plan.effects == planned(surface()).effects and plan.layered and not planned(surface()).layered
    assert plan.reasons[-1] == f"its {layer} lies over that as it is"


def test_a_little_anisotropy_is_shown_as_none_and_said() -> None:
    words = "its anisotropy is little: the probe shows it as rough alike all around"
    for value, little in ((0.2, True), (0.21, False), (0.0, True)):
        plan = planned(surface(Anisotropic=value))
        assert (plan.effects == planned(surface()).effects) is little
        assert (words in plan.reasons) is (little and value != 0.0)
    for kind, inputs in (("ShaderNodeBsdfAnisotropic", {"Color": WHITE}), ("ShaderNodeBsdfMetallic", {})):
        for value, little in ((0.2, True), (-0.2, True), (0.21, False)):
            plan = planned(
                other(kind, fresnel="F82" * ("Metallic" in kind), Anisotropy=value, Edge_Tint=WHITE, **inputs)
            )
            assert plan.effects is not None and (plan.effects.anisotropy is None) is little


def other(kind: str, distribution: str = "GGX", fresnel: str = "", **inputs: Value) -> SurfaceReading:
    given = {key.replace("_", " "): value for key, value in {"Roughness": 0.1, **inputs}.items()}
    return SurfaceReading(("Other",), kind, tuple(given.items()), distribution, fresnel)


WHITE = (1.0, 1.0, 1.0, 1.0)


def test_glossy_and_metallic_surfaces_are_served_and_leave_no_base() -> None:
    glossy = planned(other("ShaderNodeBsdfAnisotropic", Color=WHITE, Anisotropy=0.0))
    metal = planned(other("ShaderNodeBsdfMetallic", "MULTI_GGX", "F82", Edge_Tint=WHITE))
    assert glossy.effects.effects == (Glossy(),) and not glossy.effects.leaves_base
    assert metal.effects.effects == (Multiscatter(), TintedMetal(False)) and not metal.effects.leaves_base
    tinted = planned(other("ShaderNodeBsdfMetallic", "GGX", "F82", Edge_Tint=(1.0, 0.9, 1.0, 1.0)))
    assert tinted.effects.effects == (TintedMetal(True),)


def test_a_mirror_has_no_microfacets_whatever_their_distribution() -> None:
    mirror = planned(other("ShaderNodeBsdfAnisotropic", "BECKMANN", Color=WHITE, Roughness=0.0))
    assert mirror.effects.effects == (Glossy(),)
    assert mirror.effects == planned(other("ShaderNodeBsdfAnisotropic", Color=WHITE, Roughness=0.0)).effects
    odd = planned(other("ShaderNodeBsdfAnisotropic", "ASHIKHMIN_SHIRLEY", Color=WHITE, Roughness=None))
    assert odd.effects is None and odd.reasons == ("its microfacets are Ashikhmin Shirley (GGX would show a probe)",)


@pytest.mark.parametrize("roughness", [0.3, None])
def test_beckmanns_facets_read_the_levels_of_the_ggx_lobe_that_is_most_like_theirs(roughness: float | None) -> None:
    beckmann, ggx = (
        planned(other("ShaderNodeBsdfGlass", kind, IOR=1.5, Color=WHITE, Roughness=roughness))
        for kind in ("BECKMANN", "GGX")
    )
    assert beckmann.effects.distribution is Distribution.BECKMANN and "Beckmann" in beckmann.effects.label
    assert beckmann.effects.effects == ggx.effects.effects and beckmann.effects != ggx.effects
    for own, other_ray in zip(beckmann.effects.rays, ggx.effects.rays, strict=True):
        assert own.narrowing == pytest.approx(0.96 * other_ray.narrowing)
    assert beckmann.effects.rays[0].formula.title != ggx.effects.rays[0].formula.title


@pytest.mark.parametrize(
    ("reading", "reason"),
    [
        (other("ShaderNodeBsdfAnisotropic", Color=WHITE, Anisotropy=None), ANISOTROPIC),
        (
            other("ShaderNodeBsdfAnisotropic", "ASHIKHMIN_SHIRLEY", Color=WHITE),
            "its microfacets are Ashikhmin Shirley (GGX would show a probe)",
        ),
        (
            other("ShaderNodeBsdfMetallic", "GGX", "PHYSICAL_CONDUCTOR", Edge_Tint=WHITE),
            "has a physical conductor's curve (F82 Tint would show a probe)",
        ),
        (other("ShaderNodeBsdfAnisotropic", Color=(0.0, 0.0, 0.0, 1.0)), "it reflects nothing"),
        (other("ShaderNodeBsdfDiffuse"), "it reflects nothing"),
        (SurfaceReading(("Other",), "ShaderNodeBsdfTransparent", ()), "it reflects nothing"),
        (SurfaceReading(("Other",), "ShaderNodeBsdfRayPortal", ()), "it reflects nothing"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.kind,
)
def test_other_surfaces_that_no_probe_can_serve_say_why(reading: SurfaceReading, reason: str) -> None:
    plan = planned(reading)
    assert plan.effects is None and plan.reasons == (reason,)


def test_all_reasons_are_given() -> None:
    plan = planned(surface(Anisotropic=None, Roughness=0.9))
    assert plan.reasons == (ANISOTROPIC, ROUGH)


def test_inputs_that_a_version_does_not_have_are_no_reason() -> None:
    few = tuple((name, value) for name, value in INPUTS.items() if name not in {"Thin Film Thickness", "Sheen Weight"})
    assert planned(replace(surface(), inputs=few)).effects is not None


@pytest.mark.parametrize(
    ("kind", "words"),
    [("ShaderNodeBsdfHair", "Hair"), ("ShaderNodeEeveeSpecular", "EeveeSpecular")],
)
def test_another_shader_is_named(kind: str, words: str) -> None:
    plan = planned(SurfaceReading(("Odd",), kind, (("Roughness", 0.1),)))
    assert plan.effects is None and plan.reasons == (f"is a {words} shader (a Principled BSDF would show a probe)",)


@pytest.mark.parametrize("limit", [0.0, 0.3, 1.0])
def test_the_limit_itself_is_served(limit: float) -> None:
    assert planned(surface(Roughness=limit), limit).effects is not None
    if limit < 1.0:
        assert planned(surface(Roughness=limit + 0.001), limit).effects is None


@pytest.mark.parametrize(("value", "expected"), [(-0.5, 0.0), (0.0, 0.0), (0.4, 0.4), (1.5, 1.0)])
def test_a_roughness_is_what_the_renderer_makes_of_it(value: float, expected: float) -> None:
    assert planned(surface(Roughness=value), 2.0).roughness == (expected, expected)


def test_a_varying_roughness_may_be_anything_and_is_handed_over_at_the_limit() -> None:
    plan = planned(surface(Roughness=None))
    assert plan.roughness == (0.0, 1.0) and plan.handed_over == LIMIT
    assert plan.reasons[0] == "roughness varies; where it is above the limit 0.6 it keeps its own lobe"
    everywhere = planned(surface(Roughness=None), 1.0)
    assert everywhere.handed_over is None and everywhere.reasons[0] == "roughness varies"


@pytest.mark.parametrize(
    ("inputs", "kinds"),
    [
        ({"distribution": "MULTI_GGX"}, (Multiscatter, Dielectric)),
        ({"distribution": "MULTI_GGX", "Roughness": 0.0}, (Dielectric,)),
        ({"distribution": "MULTI_GGX", "Roughness": None}, (Multiscatter, Dielectric)),
        ({"Metallic": 1.0}, (Metal,)),
        ({"Metallic": 0.5}, (Dielectric, Metal)),
        ({"Metallic": None}, (Dielectric, Metal)),
        ({"Metallic": 1.0, "distribution": "MULTI_GGX"}, (Multiscatter, Metal)),
        ({"Specular_IOR_Level": 0.0, "Metallic": 0.5}, (Metal,)),
    ],
    ids=str,
)
def test_a_surface_gets_the_effects_that_its_sockets_require(inputs: dict, kinds: tuple) -> None:
    plan = planned(surface(**inputs))
    assert plan.effects is not None and tuple(type(effect) for effect in plan.effects.effects) == kinds


@pytest.mark.parametrize(
    ("inputs", "expected"),
    [
        ({"Specular_Tint": (1.0, 0.5, 0.5, 1.0)}, Dielectric(1.5, 1.5, None)),
        ({"Specular_Tint": None}, Dielectric(1.5, 1.5, None)),
        ({"Specular_IOR_Level": None}, Dielectric(1.5, 1.5, None)),
        ({"Metallic": 1.0, "Specular_Tint": (1.0, 1.0, 0.5, 1.0)}, Metal(tinted=True, pure=True)),
        ({"Metallic": 1.0}, Metal(tinted=False, pure=True)),
    ],
    ids=str,
)
def test_a_tint_is_computed_where_it_is_not_white(inputs: dict, expected: Dielectric | Metal) -> None:
    plan = planned(surface(**inputs))
    assert plan.effects is not None and plan.effects.effects == (expected,)


def test_a_surfaces_inputs_are_read_by_name() -> None:
    wood = surface(Base_Color=(0.1, 0.2, 0.3, 1.0), Metallic=None)
    assert wood.color("Base Color") == (0.1, 0.2, 0.3) and wood.color("Metallic") is None
    assert wood.scalar("Base Color") is None and wood.scalar("Metallic") is None and wood.scalar("IOR") == 1.5
    assert wood.has("Metallic") and not wood.has("Nothing")
    with pytest.raises(KeyError, match="Nothing"):
        wood.value("Nothing")


def test_the_titles_of_what_surfaces_need_are_told_apart() -> None:
    def title(**inputs: object) -> str:
        effects = planned(surface(**inputs)).effects
        assert effects is not None
        return effects.label

    assert title() == "IOR 1.5 F0 0.04"
    assert title(distribution="MULTI_GGX") == "multiscatter, IOR 1.5 F0 0.04"
    assert title(Metallic=1.0) == "metal alone" and title(Metallic=None) == "IOR 1.5 F0 0.04, metal"
    assert title(Specular_Tint=None, Metallic=0.5) == "IOR 1.5 varying F0, tinted metal"
    assert title(Specular_IOR_Level=1.0).startswith("IOR 1.5 as 1.78") and title(Specular_IOR_Level=1.0).endswith(
        "0.08"
    )
    kinds = (
        Glossy(),
        TintedMetal(False),
        TintedMetal(True),
        Metal(),
        Metal(True),
        Metal(False, True),
        Metal(True, True),
    )
    assert len({kind.label for kind in kinds}) == len(kinds)


def test_multiple_scattering_alone_reflects_nothing() -> None:
    assert planned(surface(distribution="MULTI_GGX", Specular_IOR_Level=0.0)).reasons == ("it reflects nothing",)


# Materials


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


def many(count: int) -> tuple[tuple[ProbeReading, ...], tuple]:
    """Probes side by side, and objects in each that cannot wear copies, more of them in the earlier ones."""
    probes = tuple(probe(f"P{k:02}", 10.0 * k) for k in range(count))
    placed = (placement(f"{k:02} {n}", "Wood", x=10.0 * k) for k in range(count) for n in range(count - k))
    return probes, tuple(replace(one, fixed=True) for one in placed)


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


def test_a_probe_that_hardens_says_so() -> None:
    for value in (False, True):
        plan = probe_plan(placement("Table", "Wood"), contact_hardening=value)
        assert plan.lookup.hardening == value == decision(plan, Effect.HARDENING).on
    mirror = MaterialReading("Wood", (surface(Roughness=0.0),))
    scene = SceneReading("Scene", (probe("Hall", contact_hardening=True),), (mirror,), (placement("Table", "Wood"),))
    [plan] = make_plan(scene).probes
    assert not plan.lookup.hardening and decision(plan, Effect.HARDENING).why == "all surfaces that show it are mirrors"


def test_as_many_as_can_be_read_give_no_reason() -> None:
    probes, placed = many(10)
    plan = plan_of(material("Wood"), probes=probes, placements=placed)
    assert len(plan.probes) == 10 and plan.reasons == ()


# Probes


def decision(plan: ProbePlan | SurfacePlan | MaterialPlan, effect: Effect) -> Decision:
    """The only one about an effect."""
    [found] = [each for each in plan.decisions if each.effect is effect]
    return found


def probe_plan(*placed: object, cameras: tuple = (), **more: object) -> object:
    plan = make_plan(SceneReading("Scene", (probe("Hall", **more),), (material("Wood"),), placed, cameras=cameras))
    return plan.probe("Hall")


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


def test_forcing_several_by_place_shows_nothing_on_objects_that_are_not_to_show_it() -> None:
    both = Forced(on=frozenset({Effect.BY_PLACE}))
    hall = probe("Hall", influence=Influence(excluded=frozenset({"Vase"})))
    placed = (placement("Table", "Wood", x=0.8), placement("Vase", "Wood", x=-0.8))
    for forced in (Forced(), both):
        scene = SceneReading("Scene", (hall,), (material("Wood", forced=forced),), placed)
        [plan] = make_plan(scene).materials
        [part] = plan.division.parts
        assert part.objects == ("Table",) and plan.division.kept == ()


def test_what_is_lossless_can_be_forced_on_a_surface_as_read() -> None:
    lossless = Forced(on=frozenset(effect for effect in Effect if effect.lossless))
    [plan] = plan_surfaces(material("Wood", surface(Metallic=1.0), forced=lossless), 0.6)
    forced = {Effect.METAL, Effect.TINT, Effect.DIELECTRIC, Effect.ROUGHNESS}
    assert forced <= {decision.effect for decision in plan.decisions if decision.on}
    [matt] = plan_surfaces(material("Wood", surface(Specular_IOR_Level=0.0), forced=lossless), 0.6)
    assert matt.effects is None, "what reflects nothing shows nothing"


def test_a_metal_keeps_its_film_where_there_is_no_room_for_both() -> None:
    forced = Forced(on=frozenset({Effect.DIELECTRIC}))
    film = surface(Metallic=1.0, Thin_Film_Thickness=400.0)
    [plan] = plan_surfaces(material("Wood", replace(film, films_on_both=False), forced=forced), 0.6)
    assert not decision(plan, Effect.DIELECTRIC).on
    [plan] = plan_surfaces(material("Wood", film, forced=forced), 0.6)
    assert decision(plan, Effect.DIELECTRIC).on


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


# What a user forces of surfaces


def forced(effect: Effect, on: bool, reading: SurfaceReading) -> SurfacePlan:
    choice = Forced(on=frozenset({effect})) if on else Forced(off=frozenset({effect}))
    [plan] = plan_surfaces(material("Wood", reading, forced=choice), LIMIT)
    return plan


@pytest.mark.parametrize(
    ("effect", "reading", "why"),
    [
        (Effect.MULTISCATTER, surface(), "forced on; its microfacets are GGX"),
        (Effect.TINT, surface(), "forced on; its Specular Tint is 1, 1, 1"),
        (Effect.METAL, surface(), "forced on; its Metallic is 0"),
        (Effect.ROUGHNESS, surface(), "forced on; its Roughness is 0.25"),
    ],
)
def test_what_a_surface_may_have_is_on_where_it_is_forced(effect: Effect, reading: SurfaceReading, why: str) -> None:
    plan = forced(effect, True, reading)
    assert decision(plan, effect) == Decision(effect, True, why, forced=True)
    assert plan.effects.label != planned(reading).effects.label or plan.blends


@pytest.mark.parametrize(
    ("effect", "why"),
    [
        (Effect.FILM, "cannot be forced on: its Thin Film Thickness is 0"),
        (Effect.TRANSMISSION, "cannot be forced on: its Transmission Weight is 0"),
        (Effect.OWN_LOBE, "cannot be forced on: it is nowhere too rough"),
        (Effect.BENT_NORMALS, "cannot be forced on: nothing perturbs its normals"),
    ],
)
def test_what_a_surface_cannot_have_stays_off_and_says_so(effect: Effect, why: str) -> None:
    plan = forced(effect, True, surface())
    assert decision(plan, effect) == Decision(effect, False, why)
    assert plan.effects == planned(surface()).effects


def test_a_surface_that_reflects_nothing_since_something_is_forced_off_says_what() -> None:
    plan = forced(Effect.DIELECTRIC, False, surface())
    assert plan.effects is None and plan.reasons == ("with 'Dielectric' off it reflects nothing",)
    assert plan.decisions == (Decision(Effect.DIELECTRIC, False, "forced off; it reflects nothing then", True),)
    black = forced(Effect.DIELECTRIC, False, surface(Specular_IOR_Level=0.0))
    assert black.reasons == ("it reflects nothing",) and black.decisions == ()


# What light passes through


def wall(thinness: float, area: float = 1.0, is_open: bool = False) -> WallReading:
    return WallReading("Glass", area, thinness, is_open)


@pytest.mark.parametrize(
    ("walls", "slab", "expected"),
    [
        ((), False, Interface.SOLID),
        ((wall(0.3),), False, Interface.SOLID),
        ((wall(0.01),), False, Interface.PANE),
        ((wall(0.3, is_open=True),), False, Interface.ONCE),
        ((wall(0.3), wall(0.01, 0.4), wall(0.02, 0.7)), False, Interface.PANE),
        ((wall(0.3, 3.0), wall(0.01, 0.4), wall(0.02, 0.7)), False, Interface.SOLID),
        ((wall(0.3), wall(0.0, is_open=True)), True, Interface.PANE),
    ],
)
def test_most_of_what_a_material_covers_says_how_often_light_is_bent(
    walls: tuple[WallReading, ...], slab: bool, expected: Interface
) -> None:
    glass = material("Glass", surface(Transmission_Weight=1.0), slab=slab)
    [plan] = plan_of(glass, walls=walls).surfaces
    assert plan.interface is expected and plan.effects is not None and plan.effects.transmits
    assert any("no far side" in reason for reason in plan.reasons) == (expected is Interface.ONCE)


def test_glass_around_other_things_is_left_to_the_renderer() -> None:
    glass = material("Glass", surface("Clear", Transmission_Weight=1.0), surface("Label"))
    bottle, liquid = placement("Bottle", "Glass"), placement("Liquid", "Wine", size=(0.2, 0.2, 0.2))
    beside = placement("Liquid", "Wine", x=0.7)
    for other, served in ((liquid, ("Label",)), (beside, ("Clear", "Label"))):
        plan = plan_of(glass, walls=(wall(0.01),), placements=(bottle, other))
        assert tuple(name for (name,) in sorted(plan.served)) == served
    [clear] = [s for s in plan_of(glass, walls=(wall(0.01),), placements=(bottle, liquid)).surfaces if not s.effects]
    assert "other objects stand inside" in clear.reasons[0]
    slab = material("Glass", surface(Transmission_Weight=1.0), slab=True)
    assert plan_of(slab, walls=(wall(0.01),), placements=(bottle, liquid)).served, "as its user says"


def test_captures_see_through_glass_and_see_no_reflections() -> None:
    assert planned(surface(Transmission_Weight=0.5)).captured_whole
    for more in ({}, {"Metallic": 1.0}, {"Transmission_Weight": 1.0, "Metallic": 1.0}):
        assert not planned(surface(**more)).captured_whole
