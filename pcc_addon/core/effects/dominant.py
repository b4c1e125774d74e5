"""The ray that a rough surface reflects: where most of its lobe's light comes from, and how blurred that is.

Towards grazing angles microfacets hide each other and half of the lobe would lie below the surface, so the light comes
from nearer to the normal than the mirrored view (the off-specular peak of Torrance and Sparrow 1967; the "dominant
direction" of Lagarde and de Rousiers 2014). There the lobe is narrow across the plane of view and normal, too, so that
a level of less roughness, which is as narrow all around, is nearer to it.
"""

from __future__ import annotations

from functools import cache

from ..expression import Expr, Formula, Section, clamp, dot, mix, multiply_add, normalize
from .fresnel import Facets
from .lobe import Lobe
from .lookup import INCOMING, MIRRORED, NORMAL
from .shading import METALLIC, ROUGHNESS

LEAST_BLUR = 0.74
"""The roughness of the level along the surface, over that of the surface; head-on it is 1."""


def _lean(lobe: Lobe, facets: tuple[Facets, ...]) -> Expr:
    first, *metal = facets
    return mix(lobe.lean(first), lobe.lean(metal[0]), METALLIC) if metal else lobe.lean(first)


@cache
def dominant(facets: tuple[Facets, ...]) -> Formula:
    """The reflected ray of a rough surface.

    Args:
        facets: of its lobe; where a metallic lobe is mixed by Metallic over another, of both, the metallic one last.

    Returns:
        A formula with "Direction", unit, and "Roughness", that of the level to be shown there.
    """
    cosine = Section("View angle", clamp(dot(NORMAL, INCOMING), 1e-12))
    lean = Section("Dominant direction", _lean(Lobe(cosine, ROUGHNESS), facets))
    direction = normalize(multiply_add(NORMAL, lean, MIRRORED))
    blur = Section("Narrower across", ROUGHNESS * multiply_add(cosine, 1.0 - LEAST_BLUR, LEAST_BLUR))
    title = " over ".join(one.label for one in reversed(facets))
    return Formula(f"Dominant Direction, {title}", {"Direction": direction, "Roughness": blur})
