"""The ray along which a rough surface is looked up: between the mirrored view and where its lobe's light comes from.

Towards grazing angles microfacets hide each other and half of the lobe would lie below the surface, so the light comes
from nearer to the normal than the mirrored view (the off-specular peak of Torrance and Sparrow 1967; the "dominant
direction" of Lagarde and de Rousiers 2014).
"""

from __future__ import annotations

from functools import cache

from ..expression import Expr, Formula, Section, clamp, dot, mix, multiply_add, normalize
from ..ggx import Distribution
from .fresnel import Facets
from .lobe import Lobe
from .lookup import INCOMING, MIRRORED, NORMAL
from .shading import METALLIC, ROUGHNESS


def seen_lobe(roughness: Expr, distribution: Distribution) -> Lobe:
    """The lobe of a roughness under the view's angle."""
    # At 0 and below the critical angle Fresnel's terms are 0/0.
    return Lobe(Section("View angle", clamp(dot(NORMAL, INCOMING), 1e-12)), roughness, distribution)


def bent(lobe: Lobe, facets: tuple[Facets, ...], mirrored: Expr) -> Expr:
    """Where a lobe is looked up, unit: as far from the mirrored view towards the normal as its light comes from.

    Args:
        lobe: the lobe.
        facets: of it; where a metallic lobe is mixed by Metallic over another, of both, the metallic one last.
        mirrored: the mirrored view, unit.
    """
    first, *metal = facets
    lean = mix(lobe.lean(first), lobe.lean(metal[0]), METALLIC) if metal else lobe.lean(first)
    return normalize(multiply_add(NORMAL, Section("Dominant direction", lean), mirrored))


def words(facets: tuple[Facets, ...], distribution: Distribution) -> str:
    """What a lobe is of, for titles; unique."""
    return " over ".join(one.label for one in reversed(facets)) + distribution.words


@cache
def dominant(facets: tuple[Facets, ...], distribution: Distribution = Distribution.GGX) -> Formula:
    """The reflected ray of a rough surface, "Direction", unit.

    Args:
        facets: of its lobe, as for `bent`.
        distribution: of them.
    """
    direction = bent(seen_lobe(ROUGHNESS, distribution), facets, MIRRORED)
    return Formula(f"Dominant Direction, {words(facets, distribution)}", {"Direction": direction})
