"""The plan of a scene: read, then decided."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..core.plan import Plan, make_plan
from ..core.readings import SceneReading
from .read.probes import all_probes
from .read.scene import read_scene


@dataclass(frozen=True)
class PlannedScene:
    """A scene as it was read, and what was planned for it."""

    reading: SceneReading
    plan: Plan

    def names_are_known(self, scene: bpy.types.Scene) -> bool:
        """Whether the scene still has all that the plan names."""
        materials = {material.name_full for material in bpy.data.materials}
        probes = {probe.name for probe in all_probes(scene)}
        return materials.issuperset(m.material for m in self.plan.materials) and probes.issuperset(
            probe.name for probe in self.reading.probes
        )


def read_and_plan(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> PlannedScene:
    """What a scene requires of its probes and materials, and what that was decided from."""
    reading = read_scene(scene, view_layer)
    return PlannedScene(reading, make_plan(reading))


def plan_scene(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Plan:
    """What a scene requires of its probes and materials."""
    return read_and_plan(scene, view_layer).plan
