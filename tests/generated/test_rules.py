"""Each rule by which something is left out, broken: the pictures tell that it was needed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest

from pcc_addon.core import lookup_plan, material_plan, probe_plan, surface_plan
from pcc_addon.core.decisions import Effect, Forced
from pcc_addon.core.effects.dielectric import Dielectric
from pcc_addon.core.effects.kinds import KINDS, PRINCIPLED
from pcc_addon.core.effects.metal import Metal
from pcc_addon.core.effects.records import Correction
from pcc_addon.core.lookup_plan import LookupPlan, Receivers
from pcc_addon.core.readings import SurfaceReading
from pcc_addon.core.surface_plan import SurfacePlan

from .build import build
from .pruning import compare
from .scenes import ANY, GLOWS, OPEN, Drawn, Kind, Paint, Room, Shape, Stand, Thing, View

MIRROR = Paint(Kind.METAL, 0.0, False, False, (0.9, 0.5, 0.2))
ROOM = Room(
    centre=(0.0, 0.0, 0.0),
    half=(2.0, 1.5, 1.0),
    turn=(0.0, 0.0, 0.0),
    shear=0.0,
    walls=(GLOWS,) * 6,
    capture=(0.0, 0.0, 0.0),
    padding=0.01,
    falloff=0.25,
    normal_fade=0.0,
    low=(0.0, 0.0, 0.0),
    high=(0.0, 0.0, 0.0),
    falloff_high=None,
    weight=1.0,
    priority=0,
    outside="OWN",
    hardening=False,
    corrected=True,
    moves=False,
    excludes=False,
)
BALL = Thing(Shape.BALL, 0, 0, 0.3, Stand.MIDDLE, 0, 1, (0.0, 0.0), (0.0, 0.0, 0.0), False)
VIEW = View(0, (-0.7, 0.0, 0.35), 0, (0.25, 0.0, 0.0), False, False)
SCENE = Drawn((MIRROR,), (ROOM,), (BALL,), VIEW, 0.6, 2, 16, (ANY,), (False,))


def with_room(**settings: Any) -> Drawn:
    return replace(SCENE, rooms=(replace(ROOM, **settings),))


def with_ball(**settings: Any) -> Drawn:
    return replace(SCENE, things=(replace(BALL, **settings),))


def with_paint(**settings: Any) -> Drawn:
    return replace(SCENE, paints=(replace(MIRROR, **settings),))


OPENING = replace(ROOM, walls=(GLOWS, GLOWS, GLOWS, OPEN, GLOWS, GLOWS))
OUTSIDE = View(0, (1.7, 0.3, 0.3), 0, (1.0, 0.0, 0.0), False, False)
DOORWAY = replace(SCENE, rooms=(OPENING,), things=(replace(BALL, stand=Stand.THROUGH),), view=OUTSIDE)
BESIDE = replace(
    DOORWAY,
    things=(replace(BALL, size=0.7, stand=Stand.THROUGH),),
    view=View(0, (1.3, -0.9, 0.1), 0, (1.0, 0.0, 0.0), False, False),
)
BEHIND = View(0, (0.9, 0.3, 0.3), 0, (0.25, 0.0, 0.0), False, False)
FROM_OUTSIDE = replace(SCENE, rooms=(replace(ROOM, walls=(GLOWS, GLOWS, GLOWS, 0, GLOWS, GLOWS)),), view=OUTSIDE)
ELSEWHERE = replace(
    DOORWAY,
    rooms=(replace(OPENING, falloff=0.0, padding=0.0),),
    things=(BALL, replace(BALL, stand=Stand.BEYOND)),
    excluded=(False, False),
)

Break = Callable[[pytest.MonkeyPatch], None]


def lookup_without(effect: Effect, **off: Any) -> Break:
    """Lookups never have an effect, unless it is forced."""

    def break_it(patch: pytest.MonkeyPatch) -> None:
        plan = lookup_plan.plan_lookup

        def broken(spec: Any, *rest: Any, **more: Any) -> LookupPlan:
            found = plan(spec, *rest, **more)
            return found if effect in spec.forced.on else replace(found, effects=replace(found.effects, **off))

        for module in (lookup_plan, probe_plan):
            patch.setattr(module, "plan_lookup", broken)

    return break_it


def receivers_with(**known: bool) -> Break:
    """All surfaces that show a probe are taken for what they need not be."""

    def break_it(patch: pytest.MonkeyPatch) -> None:
        patch.setattr(probe_plan, "Receivers", lambda **found: Receivers(**{**found, **known}))

    return break_it


def returning(owner: object, name: str, value: object) -> Break:
    return lambda patch: patch.setattr(owner, name, lambda *_, **__: value)


def levels_of_mirrors(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(SurfacePlan, "levels_of_ladder", lambda *_: {0})


def one_level(patch: pytest.MonkeyPatch) -> None:
    levels = SurfacePlan.levels
    patch.setattr(SurfacePlan, "levels", lambda self, *r: levels(self, *r) if self.blends else levels(self, *r)[:1])


def all_smooth(patch: pytest.MonkeyPatch) -> None:
    effects = surface_plan.surface_effects
    patch.setattr(surface_plan, "surface_effects", lambda *r: (found := effects(*r)) and replace(found, smooth=True))


def of_principled(known: type, rule: Callable[[SurfaceReading], bool]) -> Break:
    """A Principled surface has an effect only where its rule says so too."""

    def break_it(patch: pytest.MonkeyPatch) -> None:
        kind = KINDS[PRINCIPLED]
        effects = tuple(
            (lambda s, w=wanted: w(s) if rule(s) else None) if getattr(wanted, "__self__", None) is known else wanted
            for wanted in kind.effects
        )
        patch.setitem(KINDS, PRINCIPLED, replace(kind, effects=effects))

    return break_it


def varying(name: str) -> Callable[[SurfaceReading], bool]:
    return lambda surface: surface.value(name) is None


def no_tints(patch: pytest.MonkeyPatch) -> None:
    given = surface_plan.as_forced

    def broken(surface: SurfaceReading, forced: Forced) -> SurfaceReading:
        without = given(surface, replace(forced, off=forced.off | {Effect.TINT}))
        return given(surface, forced) if Effect.TINT in forced.on else without

    patch.setattr(surface_plan, "as_forced", broken)


@dataclass(frozen=True)
class Rule:
    """A rule of the plan: how it is broken, and a scene that tells."""

    name: str
    break_it: Break
    scene: Drawn


RULES = [
    Rule("all inside", receivers_with(all_inside=True, seen_from_outside=False), DOORWAY),
    Rule("on walls", receivers_with(on_walls=False), BESIDE),
    Rule("seen from outside", receivers_with(seen_from_outside=False), FROM_OUTSIDE),
    Rule("cameras within", returning(probe_plan, "_all_within", True), FROM_OUTSIDE),
    Rule(
        "rough", receivers_with(rough=False), replace(with_paint(roughness=0.3), rooms=(replace(ROOM, hardening=True),))
    ),
    Rule("strays", returning(material_plan, "_strays", frozenset()), ELSEWHERE),
    Rule("offset", lookup_without(Effect.OFFSET, offset=False), with_room(capture=(0.3, 0.3, 0.0))),
    Rule("turn", lookup_without(Effect.TURN, correction=Correction.ALIGNED_BOX), with_room(turn=(0.0, 0.0, 0.5))),
    Rule(
        "faces",
        lookup_without(Effect.FACE_FALLOFFS, per_face=False),
        replace(with_room(high=(-1.4, 0.0, 0.0)), view=BEHIND),
    ),
    Rule("weight", lookup_without(Effect.WEIGHT, weighted=False), with_room(weight=0.5)),
    Rule("fade", lookup_without(Effect.FADE, outside=None, facing=False), DOORWAY),
    Rule("outer sides", lookup_without(Effect.OUTER_SIDES, facing=False), FROM_OUTSIDE),
    Rule("walls", lookup_without(Effect.WALLS, on_walls=False), BESIDE),
    Rule("levels", levels_of_mirrors, with_paint(roughness=0.3)),
    Rule("levels beside", one_level, with_paint(roughness=0.3)),
    Rule("smooth", all_smooth, with_paint(roughness=0.5)),
    Rule("metal", of_principled(Metal, varying("Metallic")), with_paint(kind=Kind.MIXED)),
    Rule("dielectric", of_principled(Dielectric, varying("Metallic")), with_paint(kind=Kind.MIXED)),
    Rule("tint", no_tints, with_paint(kind=Kind.TINTED)),
]


@pytest.mark.sweep
@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_a_broken_rule_is_seen(rule: Rule, monkeypatch: pytest.MonkeyPatch) -> None:
    build(rule.scene)
    rule.break_it(monkeypatch)
    found = compare()
    assert bool((found.difference > found.allowed).any()), f"{found.relative:.1e}"


@pytest.mark.sweep
@pytest.mark.parametrize(
    "scene",
    dict.fromkeys(rule.scene for rule in RULES),
    ids=[r.name for r in {r.scene: r for r in reversed(RULES)}.values()],
)
def test_none_is_broken(scene: Drawn) -> None:
    build(scene)
    found = compare()
    assert not bool((found.difference > found.allowed).any()), f"{found.relative:.1e}"
