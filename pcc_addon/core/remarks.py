"""What of a plan an artist should be told unasked."""

from __future__ import annotations

from .material_plan import MaterialPlan
from .plan import Plan


def remarks(plan: Plan, roughness_limit: float) -> tuple[str, ...]:
    """Sentences on what is left alone, and what else is to be known.

    Of materials that are merely rough, which in a furnished room most are, there is one sentence, and it comes last.

    Args:
        plan: of a scene.
        roughness_limit: of the scene.
    """
    rough = [material for material in plan.materials if _is_merely_rough(material, roughness_limit)]
    if len(rough) < 2:
        rough = []
    each = (note for material in plan.materials if material not in rough for note in material.notes)
    limit = f"{roughness_limit:.3g}"
    together = [
        f"{len(rough)} materials are rougher than the scene's Roughness Limit of {limit} and keep their own lobes"
    ]
    return (*plan.notes, *each, *(together if rough else ()))


def _is_merely_rough(material: MaterialPlan, limit: float) -> bool:
    alone = all(s.effects is None and s.roughness[0] > limit and len(s.reasons) == 1 for s in material.surfaces)
    return bool(material.surfaces) and alone and not material.reasons
