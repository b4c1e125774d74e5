"""Energy that scattering between microfacets gives back (Turquin 2019, Kulla and Conty 2017)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..expression import Expr
from ..readings import SurfaceReading
from .lobe import Lobe
from .shading import Shading


@dataclass(frozen=True)
class Multiscatter:
    """The lobes of this surface keep the energy of multiple scattering."""

    @property
    def label(self) -> str:
        return "multiscatter"

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> Multiscatter | None:
        mirror = surface.scalar("Roughness") == 0.0
        return cls() if surface.distribution == "MULTI_GGX" and not mirror else None

    def apply(self, shading: Shading) -> Shading:
        return replace(shading, keeps_energy=True)


def with_returned_energy(single: Expr, f0: Expr | float, lobe: Lobe, *, at_all_angles: bool = False) -> Expr:
    """A lobe's reflectance by single scattering, plus the rest.

    Args:
        single: by single scattering.
        f0: what its facets reflect at normal incidence.
        lobe: the lobe.
        at_all_angles: whether they reflect as much at all others.
    """
    average_fresnel = f0 if at_all_angles else f0 + (1.0 - f0) * (1.0 / 21.0)
    average_albedo, albedo = lobe.average_albedo(), lobe.albedo()
    returned = average_fresnel * average_albedo / (1.0 - average_fresnel * (1.0 - average_albedo))
    return single * (1.0 + returned * ((1.0 - albedo) / albedo))
