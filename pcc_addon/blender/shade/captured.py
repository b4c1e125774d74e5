"""Which surfaces captures see without their specular lobes, as materials stand."""

from __future__ import annotations

import bpy

from ...core.plan import Plan
from .twin import has_twins, reflection_nodes


def seen_matt(plan: Plan) -> dict[str, frozenset[tuple[str, ...]]]:
    """By a material's full name the surfaces, by path, of which captures see a diffuse base wherever they are.

    Not those that are handed over to their own lobe anywhere, nor those of materials whose objects wear copies.
    """
    materials = {material.name_full: material for material in bpy.data.materials}
    found = {}
    for each in plan.materials:
        material = materials[each.material]
        if not each.probes or each.division.parts or (has_twins(material) and not reflection_nodes(material)):
            continue
        found[each.material] = frozenset(
            path
            for path, surface in each.served.items()
            if surface.effects.leaves_base and not surface.captured_whole and surface.handed_over is None
        )
    return found
