"""Plans of small scenes, and what is decided in them."""

from __future__ import annotations

from dataclasses import replace

from pcc_addon.core.decisions import Decision, Effect
from pcc_addon.core.material_plan import MaterialPlan
from pcc_addon.core.plan import make_plan
from pcc_addon.core.probe_plan import ProbePlan
from pcc_addon.core.readings import (
    MaterialReading,
    ProbeReading,
    SceneReading,
    SurfaceReading,
)
from pcc_addon.core.surface_plan import SurfacePlan, plan_surfaces

from .scenes import material, placement, probe

LIMIT = 0.6
ANISOTROPIC = "has an anisotropy that varies (a constant one would show a probe)"
ROUGH = "its roughness 0.9 is above the scene's limit 0.6"


def planned(reading: SurfaceReading, limit: float = LIMIT) -> SurfacePlan:
    [plan] = plan_surfaces(MaterialReading("Wood", (reading,)), limit)
    return plan


def plan_of(*materials: MaterialReading, probes: tuple[ProbeReading, ...] = (), **scene: object) -> MaterialPlan:
    """The plan of the only material, on one object in the middle."""
    probes = probes or (probe("Hall"),)
    placed = scene.pop("placements", tuple(placement(f"Wears {m.name}", m.name) for m in materials))
    [plan] = make_plan(SceneReading("Scene", probes, materials, placed, **scene)).materials
    return plan


def many(count: int) -> tuple[tuple[ProbeReading, ...], tuple]:
    """Probes side by side, and objects in each that cannot wear copies, more of them in the earlier ones."""
    probes = tuple(probe(f"P{k:02}", 10.0 * k) for k in range(count))
    placed = (placement(f"{k:02} {n}", "Wood", x=10.0 * k) for k in range(count) for n in range(count - k))
    return probes, tuple(replace(one, fixed=True) for one in placed)


def decision(plan: ProbePlan | SurfacePlan | MaterialPlan, effect: Effect) -> Decision:
    """The only one about an effect."""
    [found] = [each for each in plan.decisions if each.effect is effect]
    return found


def probe_plan(*placed: object, cameras: tuple = (), **more: object) -> object:
    plan = make_plan(SceneReading("Scene", (probe("Hall", **more),), (material("Wood"),), placed, cameras=cameras))
    return plan.probe("Hall")
