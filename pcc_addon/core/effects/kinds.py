"""The kinds of surfaces that a probe can light: for each BSDF the effects that it may have, and what keeps it out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..readings import SurfaceReading, Value
from .anisotropy import LITTLE, Anisotropy
from .dielectric import Dielectric
from .glossy import Glossy
from .metal import Metal, TintedMetal
from .multiscatter import Multiscatter
from .thin_film import ThinFilm
from .transmission import Transmission

SurfaceEffect = Multiscatter | Anisotropy | ThinFilm | Dielectric | Metal | Glossy | TintedMetal | Transmission

PRINCIPLED = "ShaderNodeBsdfPrincipled"
MICROFACETS = {"GGX", "MULTI_GGX", "BECKMANN"}  # distributions that can be shown by levels made for GGX
LAYERS = {"Coat Weight": "coat", "Sheen Weight": "sheen"}
"""What may lie over the lobe of a Principled BSDF: it stays the renderer's own, and dims what is under it."""


@dataclass(frozen=True)
class Refusal:
    """An input that may keep a lobe from showing a probe.

    Attributes:
        why: in words.
        most: what it may be, of either sign, and still be served as if it were 0.
        served: what becomes of it then, in words.
        if_varying: whether it keeps it from that only where it varies.
    """

    why: str
    most: float = 0.0
    served: str = ""
    if_varying: bool = False

    def applies(self, value: Value) -> bool:
        """Whether the input, None where it varies, is the reason that a lobe keeps from showing a probe."""
        return not isinstance(value, (int, float)) or not (self.if_varying or self.ignored(value))

    def ignored(self, value: Value) -> bool:
        """Whether the input counts as 0."""
        return isinstance(value, (int, float)) and abs(value) <= self.most * (1.0 + _ROUNDING)


_ROUNDING = 1e-6  # of what a field in single precision says


@dataclass(frozen=True)
class Kind:
    """A BSDF.

    Attributes:
        effects: what tells each effect that it may have, or None where it is not wanted, in the order of their working.
        refused: which inputs keep its lobe from showing a probe, and why.
        leaves_base: whether a diffuse base is left beside the lobe.
    """

    effects: tuple[Callable[[SurfaceReading], SurfaceEffect | None], ...]
    refused: Mapping[str, Refusal]
    leaves_base: bool = False


_ANISOTROPY = Refusal(
    "has an anisotropy that varies (a constant one would show a probe)",
    LITTLE,
    "its anisotropy is little: the probe shows it as rough alike all around",
    if_varying=True,
)

KINDS: Mapping[str, Kind] = {
    PRINCIPLED: Kind(
        effects=(
            Multiscatter.wanted,
            Anisotropy.wanted,
            ThinFilm.wanted,
            Dielectric.wanted,
            Transmission.of_principled,
            Metal.wanted,
        ),
        refused={"Anisotropic": _ANISOTROPY},
        leaves_base=True,
    ),
    "ShaderNodeBsdfAnisotropic": Kind(
        (Multiscatter.wanted, Anisotropy.wanted, Glossy.wanted), {"Anisotropy": _ANISOTROPY}
    ),
    "ShaderNodeBsdfMetallic": Kind(
        (Multiscatter.wanted, Anisotropy.wanted, ThinFilm.wanted, TintedMetal.wanted),
        {"Anisotropy": _ANISOTROPY},
    ),
    "ShaderNodeBsdfGlass": Kind((Multiscatter.wanted, ThinFilm.wanted, Transmission.of_glass), {}),
    "ShaderNodeBsdfRefraction": Kind((Multiscatter.wanted, Transmission.of_refraction), {}),
}
"""By the type of its node. A new effect is a file beside this one and an entry here."""

WITHOUT_GLOSS = {
    "ShaderNodeBsdfDiffuse",
    "ShaderNodeBsdfTranslucent",
    "ShaderNodeBsdfTransparent",
    "ShaderNodeBsdfSheen",
    "ShaderNodeBsdfToon",
    "ShaderNodeBsdfRayPortal",
}


def may_transmit(surface: SurfaceReading) -> bool:
    """Whether light may pass through a surface and be bent."""
    if surface.kind == PRINCIPLED:
        return surface.has("Transmission Weight") and surface.value("Transmission Weight") != 0.0
    return surface.kind in {"ShaderNodeBsdfGlass", "ShaderNodeBsdfRefraction"}


def layers_of(surface: SurfaceReading) -> tuple[str, ...]:
    """The layers that lie over a surface's lobe, by their names."""
    return tuple(words for name, words in LAYERS.items() if surface.has(name) and surface.value(name) != 0.0)
