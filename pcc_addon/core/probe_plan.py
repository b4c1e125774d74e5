"""What each probe needs: whether anything shows it, what its lookup computes, and which pictures, with the reasons."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .belonging import Belongings
from .cubemap import FACE_NAMES
from .decisions import Decision, Effect
from .effects.records import LookupEffects
from .lookup_plan import Receivers, plan_lookup
from .material_plan import MaterialPlan
from .pictures import LADDER, PictureKey, PictureKind
from .probe import ProbeSpec
from .readings import CameraReading, ProbeReading, SceneReading
from .words import named


@dataclass(frozen=True)
class ProbePlan:
    """One probe.

    Attributes:
        probe: its name.
        receivers: what is known of the surfaces that show it.
        shares: whether a material shows it and others, each where it is the right one.
        lookup: what its lookup computes.
        pictures: those that it needs, sharpest first.
        reasons: why, in words.
        decisions: what each effect that a probe may have was decided to be.
        unneeded: why it needs no bake, in words; empty: it needs one.
        faces: those that its bake must capture, by name, in the order of `cubemap.FACES`.
        shown_faces: those that lookups may read of the picture that it has.
    """

    probe: str
    receivers: Receivers
    shares: bool
    lookup: LookupEffects
    pictures: tuple[PictureKey, ...]
    reasons: tuple[str, ...]
    decisions: tuple[Decision, ...] = ()
    unneeded: str = ""
    faces: tuple[str, ...] = FACE_NAMES
    shown_faces: tuple[str, ...] = FACE_NAMES

    @property
    def roughnesses(self) -> tuple[float, ...]:
        """Those of its pictures, ascending."""
        return tuple(LADDER[key.level] for key in self.pictures)


def plan_probe(
    spec: ProbeSpec,
    shown_by: Sequence[MaterialPlan],
    found: Belongings,
    scene: SceneReading,
    reading: ProbeReading,
) -> ProbePlan:
    """The plan of a probe that some materials show.

    Args:
        spec: its settings.
        shown_by: what was decided of the materials.
        found: what belongs to which probe.
        scene: all that is there.
        reading: what is known of the probe beside its settings.
    """
    showing = [material.material for material in shown_by]
    shared = [m.material for m in shown_by if m.division.blends(spec.name)]
    strays = {material.material for material in shown_by if spec.name in material.strays}
    outside, touching, beyond = (
        [name for name in showing if name in strays | reached.get(spec.name, set())]
        for reached in (found.leaving, found.touching, found.beyond)
    )
    surfaces = [surface for material in shown_by for surface in material.served.values()]
    starting_aside = any(surface.effects is not None and surface.effects.transmits for surface in surfaces)
    # What reaches beyond a wall may turn its outer side to an eye in the box too, as a ball in a doorway does.
    watched = bool(beyond) or (bool(touching) and not _all_within(spec, scene.cameras))
    receivers = Receivers(
        all_inside=not outside,
        seen_from_outside=watched,
        on_walls=bool(touching) or starting_aside,
        rough=any(surface.roughness != (0.0, 0.0) for surface in surfaces),
    )
    causes = (
        (Effect.FADE, outside, "reach beyond its box"),
        (Effect.OUTER_SIDES, touching, "lie on its box and may be seen from outside"),
        (Effect.WALLS, touching, "touch its walls"),
    )
    words = {effect: f"surfaces of {named(names)} {do}" for effect, names, do in causes if names}
    captured_at = reading.captured_at if reading.captured_at is not None else tuple(spec.capture_point)
    source = reading.source if reading.captured_at is not None else spec.source
    departure = reading.departure
    if reading.captured_at is None and spec.captures_distance:
        departure = math.inf  # nobody knows before the bake
    lookup = plan_lookup(spec, receivers, captured_at, source, words, departure)
    reasons = [f"{len(showing)} materials show it" if showing else "no material shows it"]
    if reading.copy_of:
        reasons.append(f"{told_copy(reading.copy_of)}; those with pictures of their own go before it")
    if lookup.effects.stretched:
        reasons.append("its picture was not captured in its box, so it is stretched to it and turns with it")
    refusing = sorted(found.refusing.get(spec.name, ()))
    if refusing:
        reasons.append(f"{named(refusing)} in its influence are not to show it")
    avoiding = sorted(found.avoiding.get(spec.name, ()))
    if avoiding:
        reasons.append(f"{named(avoiding)} in its influence are to show another probe alone, or none")
    if shared:
        reasons.append(f"shares {named(shared)} with other probes, by place")
    if reading.advice:
        reasons.append(f"measured: {reading.advice}")
    unneeded = "" if showing else _unneeded(spec, found, scene, reading)
    levels, decision = _levels(spec, shown_by, reading)
    pictures = tuple(PictureKey(PictureKind.RADIANCE, level) for level in levels)
    decisions = (*lookup.decisions, decision)
    return ProbePlan(spec.name, receivers, bool(shared), lookup.effects, pictures, tuple(reasons), decisions, unneeded)


def told_copy(original: str) -> str:
    """What is to be said of a probe that shows the pictures of the one that it was copied from."""
    return f"it is a copy of '{original}', whose pictures it shows until it is baked"


def _unneeded(spec: ProbeSpec, found: Belongings, scene: SceneReading, reading: ProbeReading) -> str:
    """Why a probe that no material shows needs no bake; empty where something may show it all the same."""
    moving = any(placement.object in scene.animated for placement in scene.placements)
    if reading.by_hand or reading.in_windows or spec.animated or moving:
        return ""
    if spec.name in found.refusing or spec.name in found.avoiding:
        return "what is in its influence cannot show it, or is not to"
    if any(spec.name in owners for owners in found.owners.values()):
        return "no material in its influence has a surface that could show it"
    return "no object is in its influence"


def _levels(spec: ProbeSpec, shown_by: Sequence[MaterialPlan], reading: ProbeReading) -> tuple[Sequence[int], Decision]:
    """The levels that surfaces can read, the capture always, and why these."""
    every = range(len(LADDER))
    if reading.by_hand or not (shown_by or reading.in_windows):
        readers = (
            "shaders made by hand may read it at any roughness" if reading.by_hand else "nobody knows who will show it"
        )
        return every, spec.forced.decide(Effect.LEVELS, True, readers)
    read = {0}
    for material in shown_by:
        for surface in material.served.values():
            read |= surface.levels_of_ladder(spec.contact_hardening)
    rough = ", ".join(f"{LADDER[level]:.3g}" for level in sorted(read - {0}))
    what = f"its surfaces read those of roughness {rough}" if rough else "only mirrors show it"
    decision = spec.forced.decide(Effect.LEVELS, len(read) == len(every), what)
    if decision.on:
        return every, decision
    return ([0] if decision.forced else sorted(read)), decision


def _all_within(probe: ProbeSpec, cameras: Sequence[CameraReading]) -> bool:
    """Whether all cameras are known to stay in a probe's box, off its walls; False where there is none."""
    places = [camera.place for camera in cameras if camera.place is not None]
    return len(places) == len(cameras) > 0 and probe.keeps_clear_of(np.array(places))
