"""The specular layer over a Principled BSDF's diffuse base: Fresnel's curve scaled to its F0 and tint."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..expression import Expr, greatest, lift, maximum, minimum, mix
from ..readings import SurfaceReading
from .fresnel import (
    USUAL_IOR,
    Facets,
    curve_position,
    dielectric_facets,
    f0_from_ior,
    fresnel,
    ior_from_f0,
    schlick,
    varying_ior_from_f0,
)
from .multiscatter import with_returned_energy
from .shading import IOR, SPECULAR_LEVEL, SPECULAR_TINT, Shading
from .thin_film import ThinFilm, is_coated, tinted

_STEEPEST_CURVE = 3.0  # above this index the curve dips before it rises, and has no effective cosine


@dataclass(frozen=True)
class Dielectric:
    """A dielectric lobe.

    Attributes:
        ior: index of refraction of the material; gives the reflectance at normal incidence. None where it varies.
        eta: the index whose Fresnel curve the lobe follows, after the specular level; a usual one where it varies.
        f0: the reflectance at normal incidence where it is the same grey all over the surface; None where the
            specular level or tint vary or have a colour.
    """

    ior: float | None
    eta: float
    f0: float | None

    @property
    def label(self) -> str:
        if self.ior is None:
            return "varying IOR"
        words = [f"IOR {self.ior:.6g}"]
        if self.eta != self.ior:
            words.append(f"as {self.eta:.6g}")
        words.append("varying F0" if self.f0 is None else f"F0 {self.f0:.6g}")
        return " ".join(words)

    @property
    def facets(self) -> Facets:
        steepest = max(self.eta, 1.0 / self.eta)
        return dielectric_facets(USUAL_IOR if steepest == 1.0 else steepest)  # 1: under a film

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> Dielectric | None:
        metallic = surface.scalar("Metallic")
        if metallic is not None and metallic >= 1.0:
            return None
        if surface.has("Transmission Weight") and (surface.scalar("Transmission Weight") or 0.0) >= 1.0:
            return None
        ior = surface.scalar("IOR")
        if ior is None:
            return cls(None, USUAL_IOR, None)
        tinted = surface.color("Specular Tint") != (1.0, 1.0, 1.0)
        return cls.of(ior, surface.scalar("Specular IOR Level"), tinted, coated=is_coated(surface))

    @classmethod
    def of(cls, ior: float, level: float | None, tinted: bool = False, *, coated: bool = False) -> Dielectric | None:
        """The lobe of an index of refraction, or None where it reflects nothing.

        Args:
            ior: of the material.
            level: the specular IOR level, or None where it varies.
            tinted: whether the specular tint is not white all over.
            coated: whether a film lies over it, which reflects over anything.
        """
        f0 = f0_from_ior(ior) if level is None else f0_from_ior(ior) * 2.0 * level
        eta = ior
        if level is not None and level != 0.5:
            eta = ior_from_f0(f0)
            eta = 1.0 / eta if ior < 1.0 else eta
        if (eta == 1.0 or ior == 1.0) and not coated:
            return None
        return cls(ior, eta, None if tinted or level is None else min(f0, 1.0))

    def apply(self, shading: Shading) -> Shading:
        if shading.film is not None:
            return self._under_film(shading, shading.film)
        reflectance = self._reflectance(shading)
        left = 1.0 - (reflectance if reflectance.width == 1 else minimum(greatest(reflectance), 1.0))
        return replace(shading, reflectance=reflectance, left=shading.left * left)

    def _under_film(self, shading: Shading, film: ThinFilm) -> Shading:
        """What is left to the base is what a mirror would leave that shines as much again, as Cycles estimates it."""
        lobe, index = shading.lobe, self._index()
        average, mirrored = film.over_dielectric(lobe, index), film.dielectric_at(lobe.cosine, index)
        if self.f0 is None:
            f0 = f0_from_ior(index)
            average, mirrored = (tinted(one, SPECULAR_TINT, f0) for one in (average, mirrored))
        single = lobe.albedo() * average
        if shading.keeps_energy:
            f0 = self._tinted_f0() if self.f0 is None else lift(self.f0)
            single, mirrored = (with_returned_energy(one, f0, lobe) for one in (single, lobe.albedo() * mirrored))
        left = 1.0 - minimum(greatest(mirrored), 1.0)
        return replace(shading, reflectance=single, left=shading.left * left)

    def _index(self) -> Expr:
        """Of refraction, after the specular level."""
        if self.f0 is not None:
            return lift(self.eta)
        f0 = f0_from_ior(IOR if self.ior is None else lift(self.ior))
        index = varying_ior_from_f0(SPECULAR_LEVEL * (f0 * 2.0))
        return lift(1.0) / index if self.ior is not None and self.ior < 1.0 else index

    def _reflectance(self, shading: Shading) -> Expr:
        """A scalar where F0 is grey and constant, else a colour."""
        lobe = shading.lobe
        f0 = lift(self.f0) if self.f0 is not None else self._tinted_f0()
        single = lobe.albedo() * self._at_effective_angle(shading)
        return with_returned_energy(single, f0, lobe) if shading.keeps_energy else single

    def _at_effective_angle(self, shading: Shading) -> Expr:
        lobe, start = shading.lobe, f0_from_ior(self.eta)
        if self.ior is None:
            start_here = minimum(SPECULAR_LEVEL * (2.0 * f0_from_ior(IOR)), 0.99)
            facet = fresnel(lobe.effective_cosine(curve_position(self.eta), start), varying_ior_from_f0(start_here))
            return maximum(mix(self._tinted_f0(), 1.0, (facet - start_here) / (1.0 - start_here)), 0.0)
        curve = curve_position(self.eta)
        if self.eta > _STEEPEST_CURVE:
            mirror = fresnel(lobe.effective_cosine(schlick, 1.0), self.eta)
            position = lobe.average(curve, schlick, (mirror - start) / (1.0 - start))
        else:
            mirror = fresnel(lobe.effective_cosine(curve, start if self.f0 is None else self.f0), self.eta)
            if self.f0 is not None and abs(self.f0 - start) < 1e-6:
                return mirror
            position = (mirror - start) / (1.0 - start)
        f0 = self._tinted_f0() if self.f0 is None else lift(self.f0)
        # The curve of a high index dips below its start, which must not make a black tint negative.
        return maximum(mix(f0, 1.0, position), 0.0)

    def _tinted_f0(self) -> Expr:
        twice = f0_from_ior(IOR) * 2.0 if self.ior is None else lift(2.0 * f0_from_ior(self.ior))
        return minimum(SPECULAR_TINT * (SPECULAR_LEVEL * twice), 1.0)
