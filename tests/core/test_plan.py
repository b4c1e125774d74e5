"""What the planner decides of surfaces, from readings alone, and that it says why."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pcc_addon.core.decisions import Decision, Effect, Forced
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.glossy import Glossy
from pcc_addon.core.effects.metal import Metal, TintedMetal
from pcc_addon.core.effects.multiscatter import Multiscatter
from pcc_addon.core.effects.transmission import Interface
from pcc_addon.core.ggx import Distribution
from pcc_addon.core.readings import (
    SurfaceReading,
    Value,
    WallReading,
)
from pcc_addon.core.surface_plan import SurfacePlan, plan_surfaces

from .planning import ANISOTROPIC, LIMIT, ROUGH, decision, plan_of, planned
from .scenes import INPUTS, material, placement, surface

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
