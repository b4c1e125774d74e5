"""Which effects a surface has, and why, in words for those who read a plan."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from .decisions import Decision, Effect, Forced
from .effects.dielectric import Dielectric
from .effects.metal import Metal, TintedMetal
from .effects.multiscatter import Multiscatter
from .effects.surface import SurfaceEffects
from .effects.thin_film import ThinFilm
from .forcing import DECIDING
from .readings import SurfaceReading


@dataclass(frozen=True)
class Found:
    """What was decided of a surface.

    Attributes:
        effects: what its shader computes.
        mixes: whether it mixes levels by a roughness that varies, or as if it did.
        mirror: whether it is one all over.
        hands_over: whether it keeps its own lobe where it is too rough.
        bent: whether its normals are bent.
    """

    effects: SurfaceEffects
    mixes: bool
    mirror: bool
    hands_over: bool
    bent: bool


def surface_decisions(surface: SurfaceReading, found: Found, forced: Forced) -> Iterator[Decision]:
    """Which effects a surface has of those that its kind may have, and why.

    Args:
        surface: as read, nothing forced.
        found: what was decided of it.
        forced: what its user decided.
    """
    parts = found.effects.effects
    metals = [part for part in parts if isinstance(part, (Metal, TintedMetal))]
    dielectrics = [part for part in parts if isinstance(part, Dielectric)]
    has = {
        Effect.METAL: bool(metals),
        Effect.TINT: any(m.tinted for m in metals) or any(d.f0 is None for d in dielectrics),
        Effect.TRANSMISSION: found.effects.transmits,
        Effect.FILM: any(isinstance(part, ThinFilm) for part in parts),
        Effect.ANISOTROPY: found.effects.anisotropy is not None,
    }
    for effect, inputs in DECIDING.items():
        for name in inputs:
            if surface.has(name):
                yield _said(effect, has[effect], _in_words(surface, name), forced)
    if surface.has("Metallic"):
        why = _in_words(surface, "Metallic" if surface.value("Metallic") != 0.0 else "IOR")
        yield _said(Effect.DIELECTRIC, bool(dielectrics), why, forced)
    scattering = any(isinstance(part, Multiscatter) for part in parts)
    facets = _FACETS.get(surface.distribution, surface.distribution.title()) or "those of a mirror"
    smooth = "it is a mirror" if found.mirror else f"its microfacets are {facets}"
    yield _said(Effect.MULTISCATTER, scattering, smooth, forced)
    if surface.has("Roughness"):
        yield _said(Effect.ROUGHNESS, found.mixes, _in_words(surface, "Roughness"), forced)
        limit = "it may be rougher than the limit" if found.hands_over else "it is nowhere too rough"
        limit = "it shows probes however rough it is" if Effect.OWN_LOBE in forced.off else limit
        yield _said(Effect.OWN_LOBE, found.hands_over, limit, forced)

    yield _said(Effect.BENT_NORMALS, found.bent, _normals_of(surface), forced)


def has_own_normals(surface: SurfaceReading) -> bool:
    """Whether something perturbs a surface's normals."""
    return surface.has("Normal") and surface.value("Normal") is None


def _normals_of(surface: SurfaceReading) -> str:
    return "something perturbs its normals" if has_own_normals(surface) else "nothing perturbs its normals"


_FACETS = {"GGX": "GGX", "MULTI_GGX": "Multiscatter GGX"}


def _said(effect: Effect, on: bool, why: str, forced: Forced) -> Decision:
    if effect in (forced.off if on else forced.on):
        return Decision(effect, on, f"cannot be forced {'off' if on else 'on'}: {why}")
    chosen = effect in (forced.on if on else forced.off)
    return Decision(effect, on, f"forced {'on' if on else 'off'}; {why}" if chosen else why, chosen)


def _in_words(surface: SurfaceReading, name: str) -> str:
    value = surface.value(name)
    if value is None:
        return f"its {name} varies"
    numbers = ", ".join(f"{v:.3g}" for v in (value[:3] if isinstance(value, tuple) else (value,)))
    return f"its {name} is {numbers}"
