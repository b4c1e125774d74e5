"""Which effects the lookup of a probe needs, and why."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .decisions import Decision, Effect
from .effects.records import Correction, LookupEffects
from .effects.relief import DEPARTS
from .probe import ProbeSpec, Source


@dataclass(frozen=True)
class Receivers:
    """What is known of the surfaces that show a probe; as it stands it holds for any.

    Attributes:
        all_inside: whether none of them leaves the probe's box and padding.
        seen_from_outside: whether one of them touches or leaves the box and may be seen from outside.
        on_walls: whether a ray may leave from one of the box's walls or from beyond.
        rough: whether one of them is no mirror.
    """

    all_inside: bool = False
    seen_from_outside: bool = True
    on_walls: bool = True
    rough: bool = True


@dataclass(frozen=True)
class LookupPlan:
    """What a probe's lookup computes, and why."""

    effects: LookupEffects
    decisions: tuple[Decision, ...]


def lookup_effects(
    spec: ProbeSpec,
    receivers: Receivers,
    captured_at: Sequence[float],
    source: Source = Source.BAKE,
    departure: float | None = None,
) -> LookupEffects:
    """The effects of `plan_lookup`."""
    return plan_lookup(spec, receivers, captured_at, source, departure=departure).effects


def plan_lookup(
    spec: ProbeSpec,
    receivers: Receivers,
    captured_at: Sequence[float],
    source: Source = Source.BAKE,
    words: Mapping[Effect, str] | None = None,
    departure: float | None = None,
) -> LookupPlan:
    """The lookup effects that a probe requires; all that there are where it is animated.

    Args:
        spec: the probe.
        receivers: what is known of the surfaces that show it.
        captured_at: where its pictures were taken, world space, metres.
        source: where its pictures came from, whatever its next ones will.
        words: why an effect is needed, where that can be said better than by what receivers tell.
        departure: as `Sidecar.departs_from`.
    """
    found: dict[Effect, Decision] = {}

    def decide(effect: Effect, needed: bool, needed_since: str, not_since: str) -> bool:
        why = (words or {}).get(effect, needed_since) if needed else not_since
        found[effect] = spec.forced.decide(effect, needed, why)
        return found[effect].on

    stretched, moves = source.stretched, spec.animated
    fitting = spec.box.own_axes_correction if stretched else spec.box.correction
    corrected = decide(Effect.PARALLAX, spec.corrected, "its Correction is Box", "its Correction is None")
    turned = decide(
        Effect.TURN,
        moves or fitting is not Correction.ALIGNED_BOX,
        "it may be turned by animation" if moves else f"its box is a {fitting.words}",
        "its box is along the world's axes",
    )
    own = {
        "per_face": decide(
            Effect.FACE_FALLOFFS,
            spec.has_different_faces,
            "its influence differs from face to face",
            "its influence is its box, with one falloff",
        ),
        "by_normal": decide(
            Effect.NORMAL_FADE, spec.influence.normal_fade > 0.0, "its Normal Fade is above 0", "its Normal Fade is 0"
        ),
        "weighted": decide(
            Effect.WEIGHT, spec.influence.weight < 1.0, "its Weight is below 1", "its Weight is 1, all of a surface"
        ),
    }
    if not corrected:
        along = stretched and turned
        return LookupPlan(LookupEffects(Correction.NONE, None, False, stretched=along, **own), tuple(found.values()))
    distance = float(np.linalg.norm(np.subtract(captured_at, spec.box.centre)))
    offset = decide(
        Effect.OFFSET,
        not stretched and (moves or tuple(captured_at) != tuple(spec.box.centre)),
        "it may be moved off the capture point by animation" if moves else f"captured {distance:.3g} m off the centre",
        "its picture is stretched to its box" if stretched else "captured at the centre of its box",
    )
    relief = _relief(spec, stretched, departure)
    found[Effect.RELIEF] = relief
    facing = decide(
        Effect.OUTER_SIDES,
        moves or receivers.seen_from_outside,
        "it may be moved by animation" if moves else "surfaces on its box may be seen from outside",
        "no surface on its box is seen from outside",
    )
    fades = decide(
        Effect.FADE,
        moves or facing or not receivers.all_inside,
        "it may be moved by animation"
        if moves
        else "surfaces may reach beyond its box"
        if not receivers.all_inside
        else "outer sides of walls do not show it",
        "all surfaces that show it are in its box",
    )
    if facing and not fades:
        found[Effect.OUTER_SIDES] = Decision(Effect.OUTER_SIDES, False, "nothing fades")
    on_walls = decide(
        Effect.WALLS,
        moves or receivers.on_walls,
        "it may be moved by animation" if moves else "surfaces may touch its walls",
        "no surface that shows it touches its walls",
    )
    hardening = decide(
        Effect.HARDENING,
        spec.contact_hardening and receivers.rough,
        "its Contact Hardening is on",
        "all surfaces that show it are mirrors" if spec.contact_hardening else "its Contact Hardening is off",
    )
    effects = LookupEffects(
        _correction(fitting, turned, general=moves or Effect.TURN in spec.forced.on),
        spec.outside if fades else None,
        offset and not stretched,
        facing and fades,
        stretched,
        on_walls=on_walls,
        hardening=hardening,
        steps=spec.relief_steps if relief.on else 0,
        refinements=spec.relief_refinements if relief.on else 0,
        **own,
    )
    return LookupPlan(effects, tuple(found.values()))


def _relief(spec: ProbeSpec, stretched: bool, departure: float | None) -> Decision:
    """Whether rays are followed through what was captured; never where no distances were."""
    if stretched or departure is None:
        why = "its picture was not captured in its box" if stretched else "its bake has no distances"
        return Decision(Effect.RELIEF, False, why if spec.captures_distance else "its Correction is Box")
    if math.isinf(departure):
        why = "what stands in its box is not known, or was captured for another box"
    elif departure > DEPARTS:
        why = f"what it captured departs from its box by up to {100.0 * departure:.3g} % of the distance"
    else:
        why = "all that it captured lies on its box"
    needed = spec.relief and departure > DEPARTS
    return spec.forced.decide(Effect.RELIEF, needed, why if spec.relief else "its Correction is Box")


def lacking(built: LookupEffects, needed: LookupEffects) -> tuple[Effect, ...]:
    """The effects that a lookup needs and another has not."""
    ranks = list(Correction)
    found = {
        Effect.PARALLAX: Correction.NONE in (built.correction, needed.correction)
        and built.correction is not needed.correction,
        Effect.TURN: ranks.index(built.correction) < ranks.index(needed.correction),
        Effect.RELIEF: needed.steps > 0 and not built.steps,
        Effect.OFFSET: needed.offset and not built.offset,
        Effect.FADE: needed.outside is not None and built.outside is not needed.outside,
        Effect.OUTER_SIDES: needed.facing and not built.facing,
        Effect.FACE_FALLOFFS: needed.per_face and not built.per_face,
        Effect.NORMAL_FADE: needed.by_normal and not built.by_normal,
        Effect.WEIGHT: needed.weighted and not built.weighted,
        Effect.HARDENING: needed.hardening and not built.hardening,
        Effect.WALLS: needed.on_walls and not built.on_walls,
    }
    return tuple(effect for effect, missing in found.items() if missing)


def _correction(fitting: Correction, turned: bool, *, general: bool) -> Correction:
    if not turned:
        return Correction.ALIGNED_BOX
    return Correction.ORIENTED_BOX if general else fitting
