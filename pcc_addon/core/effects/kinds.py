"""The kinds of surfaces that a probe can light: for each BSDF the effects that it may have, and what keeps it out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..readings import SurfaceReading
from .dielectric import Dielectric
from .glossy import Glossy
from .metal import Metal, TintedMetal
from .multiscatter import Multiscatter

SurfaceEffect = Multiscatter | Dielectric | Metal | Glossy | TintedMetal

PRINCIPLED = "ShaderNodeBsdfPrincipled"
MICROFACETS = {"GGX", "MULTI_GGX"}  # distributions that the levels are made for
LAYERS = {"Coat Weight": "coat", "Sheen Weight": "sheen"}
"""What may lie over the lobe of a Principled BSDF: it stays the renderer's own, and dims what is under it."""


@dataclass(frozen=True)
class Kind:
    """A BSDF.

    Attributes:
        effects: all that it may have, in the order of their working.
        refused: why an input that is not 0 keeps its lobe from showing a probe.
        leaves_base: whether a diffuse base is left beside the lobe.
    """

    effects: tuple[type[SurfaceEffect], ...]
    refused: Mapping[str, str]
    leaves_base: bool = False


_FILM = "has a thin film (a thickness of 0 would show a probe)"
_ANISOTROPIC = "is anisotropic (0 would show a probe)"

KINDS: Mapping[str, Kind] = {
    PRINCIPLED: Kind(
        effects=(Multiscatter, Dielectric, Metal),
        refused={
            "Transmission Weight": "transmits light",
            "Anisotropic": _ANISOTROPIC,
            "Thin Film Thickness": _FILM,
        },
        leaves_base=True,
    ),
    "ShaderNodeBsdfAnisotropic": Kind((Multiscatter, Glossy), {"Anisotropy": _ANISOTROPIC}),
    "ShaderNodeBsdfMetallic": Kind(
        (Multiscatter, TintedMetal), {"Anisotropy": _ANISOTROPIC, "Thin Film Thickness": _FILM}
    ),
}
"""By the type of its node. A new effect is a file beside this one and an entry here."""

WITHOUT_GLOSS = {
    "ShaderNodeBsdfDiffuse",
    "ShaderNodeBsdfTranslucent",
    "ShaderNodeBsdfTransparent",
    "ShaderNodeBsdfSheen",
    "ShaderNodeBsdfToon",
}


def layers_of(surface: SurfaceReading) -> tuple[str, ...]:
    """The layers that lie over a surface's lobe, by their names."""
    return tuple(words for name, words in LAYERS.items() if surface.has(name) and surface.value(name) != 0.0)
