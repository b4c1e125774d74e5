"""How much a Principled surface reflects, and what it leaves to the diffuse part: its effects, one after the other.

Follows the layering of Blender's Principled BSDF: a metallic lobe mixed by Metallic with a dielectric lobe over the
diffuse base, which gets what the largest channel of the dielectric lobe leaves. The radiance that reaches the lobe is
averaged apart from it (split sum, Karis 2013).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ..expression import Expr, Formula, Section, clamp, dot, lift
from ..readings import SurfaceReading
from .dielectric import Dielectric
from .lobe import Lobe
from .lookup import INCOMING, NORMAL
from .metal import Metal
from .multiscatter import Multiscatter
from .shading import BASE_COLOR, RADIANCE, ROUGHNESS, Shading

EFFECTS = (Multiscatter, Dielectric, Metal)
"""All that there are, in the order of their working. A new one is a file beside this one and an entry here."""

SurfaceEffect = Multiscatter | Dielectric | Metal


@dataclass(frozen=True)
class SurfaceEffects:
    """What a surface's shader computes; equal records share one node group."""

    effects: tuple[SurfaceEffect, ...]

    @property
    def label(self) -> str:
        """A short name, unique for the record, for the node group's title."""
        return ", ".join(effect.label for effect in self.effects)


def surface_effects(surface: SurfaceReading) -> SurfaceEffects | None:
    """The effects that a surface requires, or None where it reflects nothing. Its index of refraction is constant."""
    found = [effect for kind in EFFECTS if (effect := kind.wanted(surface)) is not None]
    reflects = any(not isinstance(effect, Multiscatter) for effect in found)
    return SurfaceEffects(tuple(found)) if reflects else None


def surface(effects: SurfaceEffects) -> dict[str, Expr]:
    """A Principled surface lit by a probe.

    Returns:
        "Reflection": the radiance that the specular lobe sends to the eye; "Diffuse Color": the base colour
        that is left for a BSDF without specular and metal. Both are linear colours.
    """
    # At 0 and below the critical angle Fresnel's terms are 0/0.
    cosine = Section("View angle", clamp(dot(NORMAL, INCOMING), 1e-12))
    shading = Shading(Lobe(cosine, ROUGHNESS), lift(0.0), lift(1.0))
    for effect in effects.effects:
        shading = effect.apply(shading)
    return {"Reflection": RADIANCE * shading.reflectance, "Diffuse Color": BASE_COLOR * shading.left}


@cache
def surface_formula(effects: SurfaceEffects) -> Formula:
    """`surface`, to be shared by all surfaces with these effects."""
    return Formula(f"Surface, {effects.label}", surface(effects))
