"""The operator behind the sign of how a probe's bake stands."""

from __future__ import annotations

import bpy

from ...blender.read.probes import named_probes
from ...core.errors import PccError
from ..kept import last_plan, states


class PCC_OT_state(bpy.types.Operator):
    """Tell how a probe's bake stands, and why"""

    bl_idname = "pcc.state"
    bl_label = "State of Bake"
    bl_options = {"INTERNAL"}

    probe: bpy.props.StringProperty(name="Probe", description="Its name", options={"SKIP_SAVE"})

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        try:
            [probe] = named_probes(context.scene, [properties.probe])
        except PccError as error:
            return str(error)
        return f"{states.of(context.scene, probe).sentence}.\nClick to check all bakes again"

    def execute(self, context: bpy.types.Context) -> set[str]:
        last_plan.check(context.scene, context.view_layer)
        try:
            [probe] = named_probes(context.scene, [self.probe])
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"'{probe.name}': {states.of(context.scene, probe).sentence}")
        return {"FINISHED"}


CLASSES = (PCC_OT_state,)
