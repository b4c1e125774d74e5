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


def _lean(lobe: Lobe, facets: tuple[Facets, ...]) -> Expr:
    first, *metal = facets
    return mix(lobe.lean(first), lobe.lean(metal[0]), METALLIC) if metal else lobe.lean(first)


@cache
def dominant(facets: tuple[Facets, ...], distribution: Distribution = Distribution.GGX) -> Formula:
    """The reflected ray of a rough surface, "Direction", unit.

    Args:
        facets: of its lobe; where a metallic lobe is mixed by Metallic over another, of both, the metallic one last.
        distribution: of them.
    """
    cosine = Section("View angle", clamp(dot(NORMAL, INCOMING), 1e-12))
    lean = Section("Dominant direction", _lean(Lobe(cosine, ROUGHNESS, distribution), facets))
    title = " over ".join(one.label for one in reversed(facets)) + distribution.words
    return Formula(f"Dominant Direction, {title}", {"Direction": normalize(multiply_add(NORMAL, lean, MIRRORED))})
