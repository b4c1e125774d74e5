"""The operators that tell what is planned, and how bakes stand."""

from __future__ import annotations

from collections import Counter

import bpy

from ...core.plan_report import lines
from ...core.words import listed
from ..kept import last_plan


class PCC_OT_plan(bpy.types.Operator):
    """Tell which materials show which probe, and why others do not; panels show it, and the Info editor all of it"""

    bl_idname = "pcc.plan"
    bl_label = "Show Plan"

    def execute(self, context: bpy.types.Context) -> set[str]:
        plan = last_plan.make(context.scene, context.view_layer)
        for line in lines(plan):
            self.report({"INFO"}, line)
        shown = sum(bool(material.probes) for material in plan.materials)
        self.report(
            {"INFO"}, f"Planned: probes show in {shown} of {len(plan.materials)} materials; details are in Info"
        )
        return {"FINISHED"}


class PCC_OT_status(bpy.types.Operator):
    """Tell which probes are baked, stale or faulty, and why; goes through the frames of animated ones"""

    bl_idname = "pcc.status"
    bl_label = "Check Bakes"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not context.scene.objects:
            cls.poll_message_set("The scene is empty: add a probe with Add › Light Probe › Parallax Probe")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        found = last_plan.check(context.scene, context.view_layer)
        for status in found:
            why = f": {status.words}" if status.words else ""
            self.report({"INFO"}, f"probe '{status.probe}' is {status.state}{why}")
        counts = Counter(status.state for status in found)
        self.report({"INFO"}, f"Probes: {listed([f'{n} {s}' for s, n in sorted(counts.items())]) or 'none'}")
        return {"FINISHED"}


CLASSES = (PCC_OT_plan, PCC_OT_status)
