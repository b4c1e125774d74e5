"""What may be left out where a scene does not call for it: each thing's name, and what was decided about it and why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum


class Effect(Enum):
    """Something that a probe or a surface does only where it is needed.

    Attributes:
        key: what settings and records call it.
        label: in words.
        meaning: what it does, a phrase.
        lossless: whether the picture stays the same where it is on and not needed.
    """

    def __init__(self, key: str, label: str, meaning: str, lossless: bool = True) -> None:
        self.key, self.label, self.meaning, self.lossless = key, label, meaning, lossless

    # Of a probe's lookup.
    PARALLAX = "parallax", "Parallax Correction", "Look up where the ray meets the box instead of along it", False
    TURN = "turn", "Turned Box", "Follow a box whose walls are not along the world's axes"
    RELIEF = (
        "relief",
        "Relief",
        "Follow rays through the captured distance to what stands before the box's walls",
        False,
    )
    OFFSET = "offset", "Capture Point off the Centre", "Look from the capture point instead of the box's centre"
    FADE = "fade", "Fade Outside", "Fade the reflection where surfaces reach beyond the box"
    OUTER_SIDES = "outer_sides", "Outer Sides", "Keep the reflection off the outer sides of walls"
    FACE_FALLOFFS = "face_falloffs", "Influence per Face", "Heed an influence that differs from face to face"
    NORMAL_FADE = "normal_fade", "Fade by Normal", "Fade surfaces that face away from the capture point", False
    WEIGHT = "weight", "Weight", "Leave a part of the reflection to the surface's own"
    HARDENING = "hardening", "Contact Hardening", "Show the sharper what is nearer to rough surfaces", False
    WALLS = "walls", "Points on Walls", "Guard the division for points that lie on the box"
    # Of its pictures.
    LEVELS = "levels", "All Levels", "Keep pictures for all roughnesses, whatever surfaces have"
    FACES = "faces", "All Faces", "Capture all six faces, whether surfaces can mirror them or not"
    # Of surfaces.
    MULTISCATTER = "multiscatter", "Multiple Scattering", "Give back the energy that microfacets scatter", False
    ANISOTROPY = "anisotropy", "Anisotropy", "Look up wide lobes at five places", False
    FILM = "film", "Thin Film", "Colour the reflection by a thin film's interference", False
    DIELECTRIC = "dielectric", "Dielectric", "Reflect by Fresnel's law over the base colour"
    TINT = "tint", "Specular Tint", "Colour the dielectric reflection at normal incidence"
    METAL = "metal", "Metal", "Reflect in the base colour"
    TRANSMISSION = "transmission", "Transmission", "Look up the ray that is seen through the surface", False
    ROUGHNESS = "roughness", "Varying Roughness", "Mix all levels by the roughness at each point"
    BENT_NORMALS = "bent_normals", "Bent Normals", "Bend normals that would mirror the view into the surface", False
    OWN_LOBE = "own_lobe", "Own Lobe where Rough", "Hand over to the own lobe above the roughness limit", False
    BY_PLACE = (
        "by_place",
        "Several Probes by Place",
        "Choose between several probes at each point of the material",
        False,
    )


OF_PROBES = (
    Effect.PARALLAX,
    Effect.TURN,
    Effect.RELIEF,
    Effect.OFFSET,
    Effect.FADE,
    Effect.OUTER_SIDES,
    Effect.FACE_FALLOFFS,
    Effect.NORMAL_FADE,
    Effect.WEIGHT,
    Effect.HARDENING,
    Effect.WALLS,
    Effect.LEVELS,
    Effect.FACES,
)
"""What can be forced for a probe."""

OF_MATERIALS = tuple(effect for effect in Effect if effect not in OF_PROBES)
"""What can be forced for a material."""


@dataclass(frozen=True)
class Decision:
    """Whether an effect is on.

    Attributes:
        effect: which.
        on: what was decided.
        why: in words.
        forced: whether the artist decided it.
    """

    effect: Effect
    on: bool
    why: str
    forced: bool = False


@dataclass(frozen=True)
class Forced:
    """What an artist decided whatever a scene calls for.

    Attributes:
        on, off: effects.
    """

    on: frozenset[Effect] = field(default=frozenset())
    off: frozenset[Effect] = field(default=frozenset())

    def decide(self, effect: Effect, needed: bool, why: str) -> Decision:
        """The decision about an effect that a scene needs or not, for a reason."""
        if effect in self.on:
            return Decision(effect, True, "forced on" if needed else f"forced on, though {why}", True)
        if effect in self.off:
            return Decision(effect, False, f"forced off, though {why}" if needed else "forced off", True)
        return Decision(effect, needed, why)

    @classmethod
    def of(cls, settings: Mapping[Effect, str]) -> Forced:
        """From settings 'ON', 'OFF' or anything else for neither."""
        on, off = (frozenset(e for e, state in settings.items() if state == wanted) for wanted in ("ON", "OFF"))
        return cls(on, off)
