"""Metallic lobes: Schlick's curve over the base colour, with the F82 tint; mixed into a Principled BSDF, or alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..expression import Expr, clamp, minimum, mix
from ..readings import SurfaceReading
from .fresnel import METAL, Facets, dip, schlick
from .multiscatter import with_returned_energy
from .shading import BASE_COLOR, CAPTURED, EDGE_TINT, MATT, METALLIC, SPECULAR_TINT, Shading

_F82_COSINE = 1.0 / 7.0
_LEAST_F0 = 0.02  # of a metal that is worth a reflection


@dataclass(frozen=True)
class TintedMetal:
    """The lobe of a Metallic BSDF by colour and edge tint, which is all that there is.

    Attributes:
        tinted: whether the edge tint is not white all over.
    """

    tinted: bool

    @property
    def label(self) -> str:
        return "edge-tinted metal" if self.tinted else "metal of its own"

    @property
    def facets(self) -> Facets:
        return METAL

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> TintedMetal:
        return cls(surface.color("Edge Tint") != (1.0, 1.0, 1.0))

    def apply(self, shading: Shading) -> Shading:
        metal = metallic_reflectance(shading, EDGE_TINT if self.tinted else None)
        return replace(shading, reflectance=metal, left=shading.left * 0.0)


@dataclass(frozen=True)
class Metal:
    """A metallic lobe, mixed by Metallic over what there is; captures see a matt base of its colour instead.

    Attributes:
        tinted: whether the specular tint is not white all over.
        pure: whether the surface is metal all over, so that nothing is left of what lies under it.
    """

    tinted: bool = False
    pure: bool = False

    @property
    def label(self) -> str:
        return " ".join(["tinted"] * self.tinted + ["metal"] + ["alone"] * self.pure)

    @property
    def facets(self) -> Facets:
        return METAL

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> Metal | None:
        metallic = surface.scalar("Metallic")
        if metallic is not None and metallic <= 0.0:
            return None
        tinted = surface.color("Specular Tint") != (1.0, 1.0, 1.0)
        return cls(tinted, metallic is not None and metallic >= 1.0)

    def apply(self, shading: Shading) -> Shading:
        metal = metallic_reflectance(shading, SPECULAR_TINT if self.tinted else None)
        mixed = metal * METALLIC if self.pure else mix(shading.reflectance, metal, METALLIC)
        rest = 1.0 - METALLIC
        left = CAPTURED * MATT * METALLIC + shading.left * rest
        return replace(shading, reflectance=mixed, transmittance=shading.transmittance * rest, left=left)


def metallic_reflectance(shading: Shading, tint: Expr | None) -> Expr:
    """What a metal of the base colour reflects, a colour; an F82 tint darkens it towards the edge (Hoffman 2023)."""
    lobe, f0 = shading.lobe, clamp(BASE_COLOR)
    if shading.film is not None and shading.film.on_metal:
        single = lobe.albedo() * shading.film.over_metal(lobe, f0, tint)
        return with_returned_energy(single, f0, lobe) if shading.keeps_energy else single
    angle = lobe.effective_cosine(schlick, _LEAST_F0)
    grazing = 1.0 - angle
    squared = grazing * grazing
    single = mix(f0, 1.0, squared * squared * grazing)
    if tint is not None:
        at_82 = mix(f0, 1.0, (1.0 - _F82_COSINE) ** 5)
        depth = at_82 * (1.0 - minimum(tint, 1.0)) * (1.0 / (_F82_COSINE * (1.0 - _F82_COSINE) ** 6))
        single = clamp(single - depth * lobe.average(dip, schlick, angle * squared * squared * squared))
    single = lobe.albedo() * single
    return with_returned_energy(single, f0, lobe) if shading.keeps_energy else single
