"""How much a surface reflects, and what it leaves to a diffuse base: its effects, one after the other.

A Principled surface follows the layering of Blender's own: a metallic lobe mixed by Metallic with a dielectric lobe
over the diffuse base, which gets what the largest channel of the dielectric lobe leaves. The radiance that reaches the
lobe is averaged apart from it (split sum, Karis 2013).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

from ..expression import Expr, Formula, Section, lift, vector
from ..ggx import Distribution
from ..readings import SurfaceReading
from .anisotropy import Anisotropy, look
from .dominant import dominant, seen_lobe
from .kinds import KINDS, SurfaceEffect
from .lookup import MIRROR
from .metal import Metal
from .multiscatter import Multiscatter
from .shading import BASE_COLOR, BEHIND, RADIANCE, ROUGHNESS, Shading
from .thin_film import ThinFilm
from .transmission import Interface, Transmission


@dataclass(frozen=True)
class Ray:
    """A ray from a surface that a probe is looked up along.

    Attributes:
        formula: its direction.
        radiance: the input of a surface's formula that gets what the probe shows there.
        narrowing: the roughness of the level to be shown, over that of the surface.
    """

    formula: Formula
    radiance: str
    narrowing: float = 1.0


REFLECTED = Ray(MIRROR, "Radiance")
_NO_LOBES = (Multiscatter, ThinFilm, Anisotropy)


@dataclass(frozen=True)
class SurfaceEffects:
    """What a surface's shader computes; equal records share one node group.

    Attributes:
        effects: one after the other.
        leaves_base: whether a diffuse base is left beside the lobe.
        smooth: whether it is a mirror all over.
        distribution: of its microfacets; the levels of probes are those of GGX, of which the most similar is taken.
    """

    effects: tuple[SurfaceEffect, ...]
    leaves_base: bool = True
    smooth: bool = False
    distribution: Distribution = Distribution.GGX

    @property
    def label(self) -> str:
        """A short name, unique for the record, for the node group's title."""
        return ", ".join(effect.label for effect in self.effects) + self.distribution.words

    @property
    def rays(self) -> tuple[Ray, ...]:
        """Along which it looks probes up."""
        through = [e for e in self.effects if isinstance(e, Transmission)]
        seen = [Ray(e.ray, "Transmitted Radiance", e.narrowing * self.distribution.nearest) for e in through]
        return (*self._reflected, *seen)

    @property
    def _reflected(self) -> tuple[Ray, ...]:
        lobes = [e for e in self.effects if not isinstance(e, _NO_LOBES)]
        mirroring = [e for e in lobes if not (isinstance(e, Transmission) and not e.mirrors)]
        if not mirroring:
            return ()
        if self.smooth:
            return (REFLECTED,)
        first, last = mirroring[0], mirroring[-1]
        mixed = isinstance(last, Metal) and last is not first
        facets = (first.facets, last.facets) if mixed else (first.facets,)
        wide = self.anisotropy
        if wide is None:
            return (Ray(dominant(facets, self.distribution), "Radiance", self.distribution.nearest),)
        narrowing = wide.narrowing * self.distribution.nearest
        return tuple(
            Ray(look(wide, k, facets, self.distribution), f"Radiance {k}", narrowing) for k in range(len(wide.places))
        )

    @property
    def anisotropy(self) -> Anisotropy | None:
        """Of its lobe, where that is to be seen."""
        return next((effect for effect in self.effects if isinstance(effect, Anisotropy)), None)

    @property
    def transmits(self) -> bool:
        return any(isinstance(effect, Transmission) for effect in self.effects)


def surface_effects(surface: SurfaceReading, interface: Interface = Interface.SOLID) -> SurfaceEffects | None:
    """The effects that a surface of a known kind requires, or None where it shows nothing of its surroundings.

    Where it has an index of refraction that is constant.

    Args:
        surface: as read.
        interface: how often what it is on bends light that passes.
    """
    kind = KINDS[surface.kind]
    found = [effect for wanted in kind.effects if (effect := wanted(surface)) is not None]
    found = [replace(effect, interface=interface) if isinstance(effect, Transmission) else effect for effect in found]
    reflects = any(not isinstance(effect, _NO_LOBES) for effect in found)
    roughness = surface.scalar("Roughness") if surface.has("Roughness") else 0.0
    smooth = roughness is not None and roughness <= 0.0
    beckmann = surface.distribution == "BECKMANN" and not smooth
    distribution = Distribution.BECKMANN if beckmann else Distribution.GGX
    return SurfaceEffects(tuple(found), kind.leaves_base, smooth, distribution) if reflects else None


def surface(effects: SurfaceEffects) -> dict[str, Expr]:
    """A surface lit by a probe.

    Returns:
        "Reflection": the radiance that the specular lobe, and what passes, sends to the eye; where a base is left,
        "Diffuse Color": the base colour for a BSDF without specular and metal. Both are linear colours.
    """
    shading = Shading(seen_lobe(ROUGHNESS, effects.distribution), lift(0.0), lift(1.0))
    for effect in effects.effects:
        shading = effect.apply(shading)
    wide = effects.anisotropy
    mirrored: Expr = RADIANCE
    if wide is not None:
        first, *others = (vector(f"Radiance {k}") * share for k, share in enumerate(wide.shares()))
        mirrored = Section("Looks", sum(others, first))
    parts = []
    if any(ray.radiance != "Transmitted Radiance" for ray in effects.rays):
        parts.append(mirrored * shading.reflectance)
    if effects.transmits:
        parts.append(BEHIND * shading.transmittance)
    reflection = {"Reflection": sum(parts[1:], parts[0])}
    return {**reflection, "Diffuse Color": BASE_COLOR * shading.left} if effects.leaves_base else reflection


@cache
def surface_formula(effects: SurfaceEffects) -> Formula:
    """`surface`, to be shared by all surfaces with these effects."""
    return Formula(f"Surface, {effects.label}", surface(effects))
