"""The formulas that materials call once they show what is planned, so that they can be made ready before."""

from __future__ import annotations

from collections.abc import Iterator

from .effects import choice
from .effects.lookup import probe
from .effects.records import Correction
from .effects.surface import surface_formula
from .expression import Formula
from .material_plan import MaterialPlan
from .plan import Plan
from .probe_plan import ProbePlan


def formulas_shown(plan: Plan) -> Iterator[Formula]:
    """All but a few small ones, some of them repeatedly; to fit a lobe for the next one may take part of a second.

    Probes are taken to get the pictures that are planned.
    """
    probes = {found.probe: found for found in plan.probes if not found.unneeded}
    for found in probes.values():
        yield from probe(found.lookup, {"Level 0": 2}, shares=found.shares).called
    for material in plan.materials:
        yield from _of_material(material, [probes[name] for name in material.probes if name in probes])


def _of_material(material: MaterialPlan, probes: list[ProbePlan]) -> Iterator[Formula]:
    for surface in material.served.values() if probes else ():
        assert surface.effects is not None
        for ray in surface.effects.rays:
            yield ray.formula
            for shown in probes:
                hardening = shown.lookup.hardening and shown.lookup.correction is not Correction.NONE
                mixing = surface.mixing(shown.roughnesses, ray, hardening)
                if mixing is not None:
                    yield mixing
        yield surface_formula(surface.effects)
        yield choice.own_share(surface.handed_over)
    if len(probes) > 1:
        yield from (choice.OVER, choice.BESIDE, choice.OUTSIDE)
