"""In the sidebar: materials that show probes, and what is left alone and why."""

from __future__ import annotations

import bpy

from ...blender.read.probes import all_probes
from ...core.accuracy.labels import counted
from ...core.remarks import remarks
from ..kept import last_plan
from ..sentences import say
from .scene import InSidebar

_MOST = 6  # remarks that are written out


class PCC_PT_scene_materials(InSidebar, bpy.types.Panel):
    bl_label = "Materials"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return bool(all_probes(context.scene))

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        column = layout.column(align=True)
        column.operator("pcc.inject", icon="MATERIAL")
        column.operator("pcc.remove", icon="X")
        column.operator("pcc.plan", icon="PRESET")
        last = last_plan.of(context.scene)
        if last is None:
            return
        column = layout.column(align=True)
        planned = last.plan.materials
        showing = sum(bool(material.probes) for material in planned)
        say(column, context, f"{showing} of {counted(len(planned), 'material')} in reach can show probes", "MATERIAL")
        if last.late:
            say(column, context, "As it was before the last change")
        told = remarks(last.plan, context.scene.pcc.roughness_limit)
        for remark in told[:_MOST]:
            say(layout.column(align=True), context, remark, "INFO")
        if len(told) > _MOST:
            say(layout.column(align=True), context, f"And {len(told) - _MOST} more: Show Plan tells them in Info")


CLASSES = (PCC_PT_scene_materials,)
