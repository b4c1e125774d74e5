"""The operator that tells what is planned."""

from __future__ import annotations

import bpy

from ..blender.planning import plan_scene
from ..core.plan_report import lines


class PCC_OT_plan(bpy.types.Operator):
    """Tell which materials show which probe, and why others do not"""

    bl_idname = "pcc.plan"
    bl_label = "Show Plan"

    def execute(self, context: bpy.types.Context) -> set[str]:
        plan = plan_scene(context.scene, context.view_layer)
        for line in lines(plan):
            self.report({"INFO"}, line)
        return {"FINISHED"}


CLASSES = (PCC_OT_plan,)
