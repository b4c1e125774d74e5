"""A plan for people, as a table, and for programs, as records."""

from __future__ import annotations

from collections.abc import Iterator

from .plan import MaterialPlan, Plan, ProbePlan


def lines(plan: Plan) -> Iterator[str]:
    """The plan as text, a line at a time."""
    for probe in plan.probes:
        yield f"probe '{probe.probe}': {probe.lookup.label}; {len(probe.pictures)} pictures"
        yield from (f"    {reason}" for reason in probe.reasons)
    for material in plan.materials:
        shown = ", ".join(f"'{probe}'" for probe in material.probes) or "no probe"
        yield f"material '{material.material}': {shown}"
        yield from (f"    {reason}" for reason in material.reasons)
        yield from (f"    object '{item}' shows '{probe}'" for item, probe in material.objects)
        for surface in material.surfaces:
            kept = "" if surface.effects else "keeps its own lobe: "
            yield f"    surface '{surface.name}': {kept}{'; '.join(surface.reasons)}"
    yield from plan.notes


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
            }
            for surface in material.surfaces
        ],
        "reasons": list(material.reasons),
    }
