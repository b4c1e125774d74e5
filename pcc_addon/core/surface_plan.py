"""Which effects each surface of a material needs, and why."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from .decisions import Decision, Effect, Forced
from .effects.kinds import KINDS, MICROFACETS, WITHOUT_GLOSS, layers_of, may_transmit
from .effects.lookup import LEAST_SPREAD, MOST_SPREAD
from .effects.roughness import mixed_formula, neighbours
from .effects.surface import Ray, SurfaceEffects, surface_effects
from .effects.transmission import Interface
from .expression import Formula
from .forcing import as_forced
from .pictures import LADDER
from .readings import MaterialReading, SurfaceReading
from .surface_decisions import Found, has_own_normals, surface_decisions
from .words import named

REFLECTS_NOTHING = "it reflects nothing"


@dataclass(frozen=True)
class SurfacePlan:
    """One surface of a material.

    Attributes:
        path: as in its reading.
        effects: what its shader computes, or None where it keeps its own lobe.
        roughness: the least and the greatest that it may have.
        reasons: why, in words; all of them.
        interface: how often what it is on bends the light that passes, where it transmits.
        handed_over: the roughness from which on it is left to its own lobe, where it may be so rough; else None.
        layered: whether something lies over the lobe, such as a coat.
        bends_normals: whether its normals must be bent lest they mirror the view into the surface.
        blends: whether it reads all levels, as if its roughness varied.
        decisions: what each effect that its kind of surface may have was decided to be.
    """

    path: tuple[str, ...]
    effects: SurfaceEffects | None
    roughness: tuple[float, float]
    reasons: tuple[str, ...]
    interface: Interface = Interface.SOLID
    handed_over: float | None = None
    layered: bool = False
    bends_normals: bool = False
    blends: bool = False
    decisions: tuple[Decision, ...] = ()

    @property
    def name(self) -> str:
        """Its node, with the groups that lead to it."""
        return " › ".join(self.path)

    def levels(self, rungs: Sequence[float], ray: Ray, hardening: bool = False) -> range:
        """Which levels of a ladder of ascending roughnesses it reads along one of its rays.

        Args:
            rungs: the roughnesses.
            ray: which.
            hardening: whether the probe shows the sharper what is nearer.
        """
        if self.blends:
            return range(len(rungs))
        low, high = (roughness * ray.narrowing for roughness in self.roughness)
        if self.handed_over is not None:
            high = min(high, self.handed_over * ray.narrowing)
        if hardening:
            low, high = low * LEAST_SPREAD, high * MOST_SPREAD
        return neighbours(rungs, low, high)

    def mixing(self, rungs: Sequence[float], ray: Ray, hardening: bool = False) -> Formula | None:
        """What makes the radiance at its roughness of `levels`; None where it reads one as it is."""
        levels = self.levels(rungs, ray, hardening)
        return mixed_formula(tuple(rungs[k] / ray.narrowing for k in levels), hardening) if len(levels) > 1 else None

    def levels_of_ladder(self, hardening: bool) -> set[int]:
        """The levels of a whole ladder that it reads along all its rays."""
        rays = self.effects.rays if self.effects is not None else ()
        return {level for ray in rays for level in self.levels(LADDER, ray, hardening)}

    @property
    def varies(self) -> bool:
        """Whether its roughness may differ from point to point."""
        return self.roughness[0] < self.roughness[1]

    @property
    def captured_whole(self) -> bool:
        """Whether captures show its own lobes though they depend on the place, as glass is to be seen through."""
        return self.effects is not None and self.effects.transmits


def plan_surfaces(
    material: MaterialReading, roughness_limit: float, interface: Interface = Interface.SOLID
) -> tuple[SurfacePlan, ...]:
    """What each surface of a material computes, or why it keeps its own lobe."""
    return tuple(
        _plan_surface(surface, roughness_limit, material.bends_normals, interface, material.forced)
        for surface in material.surfaces
    )


def _plan_surface(
    given: SurfaceReading, limit: float, bends_normals: bool, interface: Interface, forced: Forced
) -> SurfacePlan:
    surface = as_forced(given, forced)
    if Effect.OWN_LOBE in forced.off:
        limit = 1.0
    roughness = surface.scalar("Roughness") if surface.has("Roughness") else 0.0
    reasons = list(_refusals(surface, roughness, limit))
    if interface is Interface.VESSEL and surface.kind in KINDS and may_transmit(surface):
        reasons.append("is seen through, and other objects stand inside what it covers, which no probe could show")
    # What reflects nothing shows nothing of a probe, whatever is forced on.
    reflects = surface.kind in KINDS and surface_effects(given) is not None
    effects = surface_effects(surface, interface) if reflects and not reasons else None
    low, high = (0.0, 1.0) if roughness is None else (min(max(roughness, 0.0), 1.0),) * 2
    if effects is None:
        off = () if reasons else tuple(_forced_away(given, interface, forced))
        reasons = reasons or [f"with {named([o.effect.label for o in off])} off {REFLECTS_NOTHING}"] * bool(off)
        return SurfacePlan(
            surface.path, None, (low, high), tuple(reasons or [REFLECTS_NOTHING]), interface, decisions=off
        )
    blends = Effect.ROUGHNESS in forced.on
    effects = replace(effects, smooth=effects.smooth and not blends)
    handed_over = limit if high > limit else None
    how = f"roughness {low:.3g}" if low == high else "roughness varies"
    beyond = f"; where it is above the limit {limit:.3g} it keeps its own lobe" if handed_over is not None else ""
    layers = layers_of(surface)
    refused = KINDS[surface.kind].refused
    values = {name: surface.value(name) for name in refused if surface.has(name)}
    rounded = [refused[name].served for name, value in values.items() if value != 0.0 and refused[name].ignored(value)]
    reasons = [how + beyond, effects.label, *rounded, *(f"its {layer} lies over that as it is" for layer in layers)]
    wanted = forced.decide(Effect.BENT_NORMALS, bends_normals, "").on
    bent = wanted and has_own_normals(surface)
    reasons += ["its normals are bent where they would mirror the view into the surface"] * bent
    if effects.transmits and interface is Interface.ONCE:
        reasons.append("it bends light once, as its objects have no far side (Thickness: Slab would make them panes)")
    plan = SurfacePlan(
        surface.path, effects, (low, high), tuple(reasons), interface, handed_over, bool(layers), bent, blends
    )
    found = Found(effects, blends or plan.varies, plan.roughness == (0.0, 0.0), handed_over is not None, bent)
    return replace(plan, decisions=tuple(surface_decisions(given, found, forced)))


def _forced_away(given: SurfaceReading, interface: Interface, forced: Forced) -> Iterator[Decision]:
    """What was forced off of a surface that reflects nothing since then; nothing of one that never did."""
    if given.kind in KINDS and surface_effects(given, interface) is not None:
        for effect in sorted(forced.off, key=list(Effect).index):
            if effect in (Effect.DIELECTRIC, Effect.METAL, Effect.TRANSMISSION):
                yield Decision(effect, False, f"forced off; {REFLECTS_NOTHING} then", True)


def _refusals(surface: SurfaceReading, roughness: float | None, limit: float) -> Iterator[str]:
    """Why a surface keeps its own lobe, all reasons; none where a probe can serve it or it reflects nothing."""
    if surface.kind in WITHOUT_GLOSS:
        return
    kind = KINDS.get(surface.kind)
    if kind is None:
        words = surface.kind.removeprefix("ShaderNode").removeprefix("Bsdf")
        yield f"is a {words} shader (a Principled BSDF would show a probe)"
        return
    yield from (no.why for name, no in kind.refused.items() if surface.has(name) and no.applies(surface.value(name)))
    if roughness != 0.0 and surface.distribution and surface.distribution not in MICROFACETS:
        yield f"its microfacets are {surface.distribution.replace('_', ' ').title()} (GGX would show a probe)"
    if surface.fresnel not in ("", "F82"):
        yield "has a physical conductor's curve (F82 Tint would show a probe)"
    ior = surface.scalar("IOR") if surface.has("IOR") else None
    if ior is not None and ior < 1.0 and roughness != 0.0:
        yield "has an IOR below 1 (1 or more would show a probe, or a roughness of 0)"
    if roughness is not None and roughness > limit:
        yield f"its roughness {roughness:.3g} is above the scene's limit {limit:.3g}"
