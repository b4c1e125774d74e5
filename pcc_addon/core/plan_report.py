"""A plan for people, as a table, and for programs, as records."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from .costs import cost_table
from .decisions import Decision
from .material_plan import MaterialPlan
from .plan import Plan
from .probe_plan import ProbePlan


def lines(plan: Plan) -> Iterator[str]:
    """The plan as text, a line at a time."""
    for probe in plan.probes:
        yield f"probe '{probe.probe}': {probe.lookup.label}; {len(probe.pictures)} pictures"
        yield from (f"    {reason}" for reason in probe.reasons)
        if probe.unneeded:
            yield f"    needs no bake: {probe.unneeded}"
        yield from (f"    {told(decision)}" for decision in probe.decisions)
    for material in plan.materials:
        shown = ", ".join(f"'{probe}'" for probe in material.probes) or "no probe"
        yield f"material '{material.material}': {shown}"
        yield from (f"    {reason}" for reason in (*material.choices, *material.reasons))
        yield from (f"    {told(decision)}" for decision in material.decisions)
        yield from (f"    object '{item}' shows '{probe}'" for item, probe in material.objects)
        for surface in material.surfaces:
            kept = "" if surface.effects else "keeps its own lobe: "
            yield f"    surface '{surface.name}': {kept}{'; '.join(surface.reasons)}"
            yield from (f"        {told(decision)}" for decision in surface.decisions)
    yield from plan.notes
    if cost_table().where:
        yield f"costs and savings: with ÷ without the effect, measured on {cost_table().where}"


def told(decision: Decision) -> str:
    """A decision in words: the effect, whether it is on, why, and what that costs or saves."""
    cost = f" ({price(decision)})" if price(decision) else ""
    return f"[{'on' if decision.on else 'off'}] {decision.effect.label}: {decision.why}{cost}"


def price(decision: Decision) -> str:
    """What a decision costs or saves, in words; empty where that was not measured."""
    words = cost_table().of(decision.effect).words
    return f"{'costs' if decision.on else 'saves'} {words}" if words else ""


def records(plan: Plan) -> Iterator[dict[str, object]]:
    """The plan as plain values, one dictionary a probe, material or note; "about" says of what."""
    yield from (_probe(probe) for probe in plan.probes)
    yield from (_material(material) for material in plan.materials)
    for note in plan.notes:
        yield {"about": "note", "note": note}


def _probe(probe: ProbePlan) -> dict[str, object]:
    return {
        "about": "probe",
        "probe": probe.probe,
        "lookup": probe.lookup.label,
        "pictures": [key.text for key in probe.pictures],
        "faces": list(probe.faces),
        "reasons": list(probe.reasons),
        "unneeded": probe.unneeded,
        "effects": list(map(_decision, probe.decisions)),
    }


def _material(material: MaterialPlan) -> dict[str, object]:
    return {
        "about": "material",
        "material": material.material,
        "probes": list(material.probes),
        "objects": [{"object": item, "probe": probe} for item, probe in material.objects],
        "surfaces": [
            {
                "path": list(surface.path),
                "effects": surface.effects.label if surface.effects else None,
                "reasons": list(surface.reasons),
                "decisions": list(map(_decision, surface.decisions)),
            }
            for surface in material.surfaces
        ],
        "choices": list(material.choices),
        "reasons": list(material.reasons),
        "effects": list(map(_decision, material.decisions)),
    }


def _decision(decision: Decision) -> dict[str, object]:
    return {
        "effect": decision.effect.key,
        "on": decision.on,
        "why": decision.why,
        "forced": decision.forced,
        "cost": asdict(cost_table().of(decision.effect)),
    }
