"""The lobe of a Glossy BSDF: its colour at every angle, without Fresnel's curve."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..expression import maximum
from ..readings import SurfaceReading
from .fresnel import MIRRORS, Facets
from .multiscatter import with_returned_energy
from .shading import COLOR, Shading


@dataclass(frozen=True)
class Glossy:
    """A lobe whose facets are coloured mirrors; nothing lies under it."""

    @property
    def label(self) -> str:
        return "glossy"

    @property
    def facets(self) -> Facets:
        return MIRRORS

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> Glossy | None:
        return None if surface.color("Color") == (0.0, 0.0, 0.0) else cls()

    def apply(self, shading: Shading) -> Shading:
        color = maximum(COLOR, 0.0)
        single = color * shading.lobe.albedo()
        if shading.keeps_energy:
            single = with_returned_energy(single, color, shading.lobe, at_all_angles=True)
        return replace(shading, reflectance=single, left=shading.left * 0.0)
