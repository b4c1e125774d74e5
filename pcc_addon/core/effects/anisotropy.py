"""Anisotropic lobes, as brushed metal has: wider one way, so they are looked up at several places along that way.

Each look is of a level that is about as blurred as the lobe is wide the other way. Places, shares and level are those
whose sum of round GGX lobes is nearest to the wide one, for microfacets that are mirrored head-on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..expression import (
    Expr,
    Formula,
    Section,
    cosine,
    cross,
    dot,
    maximum,
    multiply_add,
    normalize,
    reflect,
    scalar,
    vector,
)
from ..ggx import Distribution
from ..readings import SurfaceReading
from .dominant import bent, seen_lobe, words
from .fresnel import Facets
from .lookup import INCOMING, NORMAL
from .shading import ROUGHNESS, Shading

TANGENT = vector("Tangent")  # in world space, of any length, not along the normal
LITTLE = 0.2
"""Up to which anisotropy is not seen: a Principled BSDF's widths then are as 5 to 4, a Glossy BSDF's as 3 to 2."""


@dataclass(frozen=True)
class Looks:
    """The sum of round GGX lobes along a line that is nearest to a wide one, by the narrow width over the wide one.

    Attributes:
        ratios: of the widths, ascending.
        widths: of each round lobe over the wide width.
        places: of those on either side of the one in the middle, over the wide width, nearest first.
        shares: of the one in the middle and then of each on either side.
    """

    ratios: tuple[float, ...]
    widths: tuple[float, ...]
    places: tuple[tuple[float, ...], ...]
    shares: tuple[tuple[float, ...], ...]


LOOKS = Looks(
    ratios=(0.1, 0.28, 0.46, 0.64, 0.82),
    widths=(0.172, 0.317, 0.469, 0.634, 0.815),
    places=((0.322, 0.430, 0.507, 0.558, 0.58), (0.699, 0.980, 1.233, 1.490, 1.75)),
    shares=(
        (0.243, 0.302, 0.382, 0.498, 0.68),
        (0.217, 0.228, 0.226, 0.202, 0.14),
        (0.162, 0.121, 0.083, 0.049, 0.02),
    ),
)
"""Those that are chosen: five, which come to within 5 to 48 % of the lobe (RMS, the wider the lobe the more)."""


@dataclass(frozen=True)
class Anisotropy:
    """A lobe that is wider one way than the other.

    Attributes:
        ratio: of the narrow width over the wide one, in alpha, below 1; their geometric mean is the roughness' own.
        across: whether it is wide across the tangent and not along it.
        rotation: the input that turns the tangent about the normal, in turns; empty where it is 0.
    """

    ratio: float
    across: bool = False
    rotation: str = ""

    @property
    def label(self) -> str:
        way = "across" if self.across else "along"
        turned = " turned" * bool(self.rotation)
        return f"{len(self.places)} looks, {1.0 / self.ratio:.3g} times as wide {way} the tangent{turned}"

    @classmethod
    def wanted(cls, surface: SurfaceReading) -> Anisotropy | None:
        name = "Anisotropic" if surface.has("Anisotropic") else "Anisotropy"
        amount = surface.scalar(name) if surface.has(name) else 0.0
        roughness = surface.scalar("Roughness")
        if amount is None or abs(amount) <= LITTLE * (1.0 + 1e-6) or roughness == 0.0 or _is_glass(surface):
            return None
        rotation = "Anisotropic Rotation" if surface.has("Anisotropic Rotation") else "Rotation"
        turned = surface.has(rotation) and surface.value(rotation) != 0.0
        if surface.kind == "ShaderNodeBsdfAnisotropic":
            ratio = (1.0 - min(abs(amount), 0.99)) ** 2
            across = amount > 0.0
        else:
            ratio, across = 1.0 - 0.9 * min(max(amount, 0.0), 1.0), False
        return cls(ratio, across, rotation if turned else "") if ratio < 1.0 else None

    def apply(self, shading: Shading) -> Shading:
        """It changes where light comes from; how much of it is that of the round lobe."""
        return shading

    def wide_axis(self) -> Expr:
        """The direction along the surface in which the lobe is wide, unit."""
        aside = normalize(cross(NORMAL, TANGENT))
        tangent = cross(aside, NORMAL)
        first, second = (aside, tangent * -1.0) if self.across else (tangent, aside)
        if not self.rotation:
            return Section("Wide axis", first)
        angle = scalar(self.rotation) * (2.0 * math.pi)
        return Section("Wide axis", first * cosine(angle) + second * cosine(angle - 0.5 * math.pi))

    @property
    def narrowing(self) -> float:
        """The roughness of the level of each look, over that of the surface."""
        return math.sqrt(self._at(LOOKS.widths) / math.sqrt(self.ratio))

    @property
    def places(self) -> tuple[float, ...]:
        """Of the looks, along the wide axis, as slopes of facets over the roughness' alpha."""
        beside = (self._at(values) / math.sqrt(self.ratio) for values in LOOKS.places)
        return (0.0, *(side * place for place in beside for side in (1.0, -1.0)))

    def shares(self) -> list[Expr]:
        """How much of the lobe's light comes from each look: facets that turn away from the view are seen less."""
        middle, *beside = (self._at(values) for values in LOOKS.shares)
        shares = (middle, *(share for share in beside for _ in range(2)))
        axis = self.wide_axis()
        seen = [
            share * maximum(dot(_facet(axis, place), INCOMING), 0.0)
            for share, place in zip(shares, self.places, strict=True)
        ]
        total = maximum(sum(seen[1:], seen[0]), 1e-6)
        return [part / total for part in seen]

    def _at(self, values: tuple[float, ...]) -> float:
        return float(np.interp(self.ratio, LOOKS.ratios, values))


def _is_glass(surface: SurfaceReading) -> bool:
    """Whether light passes all of a surface, which renderers draw with round lobes."""
    if not surface.has("Transmission Weight") or surface.scalar("Metallic") != 0.0:
        return False
    return (surface.scalar("Transmission Weight") or 0.0) >= 1.0


def _facet(axis: Expr, place: float) -> Expr:
    """The normal of the facets at a place, unit."""
    return normalize(multiply_add(axis, ROUGHNESS * ROUGHNESS * place, NORMAL))


@cache
def look(anisotropy: Anisotropy, k: int, facets: tuple[Facets, ...], distribution: Distribution) -> Formula:
    """The ray of a look, "Direction", unit: mirrored by the facets there, and bent as that of a lobe of its width.

    Args:
        anisotropy: of the lobe.
        k: which look.
        facets: of the lobe, as for `bent`.
        distribution: of them.
    """
    lobe = seen_lobe(ROUGHNESS * anisotropy.narrowing, distribution)
    mirrored = reflect(INCOMING, _facet(anisotropy.wide_axis(), anisotropy.places[k])) * -1.0
    title = f"Look {k}, {anisotropy.label}, {words(facets, distribution)}"
    return Formula(title, {"Direction": bent(lobe, facets, mirrored)})
