"""What is decided from readings, and why: bake, injection, status, panels and reports obey it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .belonging import belongings, vessels
from .chosen import told_choices, told_unserved
from .effects.transmission import Interface
from .faces_needed import FaceNeeds, with_faces
from .material_plan import MaterialPlan, plan_material
from .parts import Division
from .probe_plan import ProbePlan, plan_probe
from .readings import SceneReading
from .surface_plan import plan_surfaces

_THIN = 0.08  # thinness of a wall below which it is a pane


@dataclass(frozen=True)
class Plan:
    """What a scene requires.

    Attributes:
        probes, materials: by name; faulty probes are missing and named in the notes.
        notes: sentences on probes that were left alone.
    """

    probes: tuple[ProbePlan, ...]
    materials: tuple[MaterialPlan, ...]
    notes: tuple[str, ...] = ()

    def probe(self, name: str) -> ProbePlan | None:
        return next((probe for probe in self.probes if probe.probe == name), None)


def make_plan(scene: SceneReading) -> Plan:
    """Decide which probes each material shows, what each surface computes, and which pictures each probe needs."""
    specs = [probe.spec for probe in scene.probes if probe.spec is not None]
    notes = [probe.fault for probe in scene.probes if probe.fault]
    allowed = {material.name: material.allowed for material in scene.materials if material.allowed is not None}
    found = belongings(specs, scene.placements, scene.animated, allowed)
    materials = []
    shapes = _interfaces(scene)
    relieved = frozenset(spec.name for spec in specs if spec.captures_distance)
    hardening = frozenset(spec.name for spec in specs if spec.contact_hardening)
    for material in scene.materials:
        owners = found.owners.get(material.name, {})
        excluded = found.excluded.get(material.name, ())
        choices = tuple(told_choices(material, excluded))
        if owners:
            surfaces = plan_surfaces(material, scene.roughness_limit, shapes.get(material.name, Interface.SOLID))
            plan = plan_material(material, owners, found, surfaces, hardening, relieved, scene.borrowing)
            materials.append(replace(plan, choices=choices))
        elif choices:
            reasons = () if excluded else tuple(told_unserved(material, scene))
            materials.append(
                MaterialPlan(material.name, Division(()), (), (), reasons, material.emits, choices=choices)
            )
    read = {probe.name: probe for probe in scene.probes}
    showing: dict[str, list[MaterialPlan]] = {spec.name: [] for spec in specs}
    for plan in materials:
        for probe in plan.probes:
            showing[probe].append(plan)
    probes = [plan_probe(spec, showing[spec.name], found, scene, read[spec.name]) for spec in specs]
    faces = FaceNeeds(scene)
    probes = [with_faces(probe, faces, read[probe.probe], showing[probe.probe]) for probe in probes]
    return Plan(tuple(probes), tuple(materials), tuple(notes))


def _interfaces(scene: SceneReading) -> dict[str, Interface]:
    """How often each material bends the light that passes: as its user says, else as most of what it covers would.

    A surface that ends somewhere bends it once, as renderers do: it may be that of water. Thin walls count as panes.
    """
    areas: dict[str, dict[Interface, float]] = {}
    for wall in scene.walls:
        kind = Interface.ONCE if wall.is_open else Interface.PANE if wall.thinness < _THIN else Interface.SOLID
        tally = areas.setdefault(wall.material, {})
        tally[kind] = tally.get(kind, 0.0) + wall.area
    found = {name: max(tally, key=lambda kind: (tally[kind], kind.value)) for name, tally in areas.items()}
    found |= dict.fromkeys(vessels(scene.placements, set(areas)), Interface.VESSEL)
    return found | {material.name: Interface.PANE for material in scene.materials if material.slab}
