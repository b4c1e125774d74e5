"""In the sidebar: what accuracy costs."""

from __future__ import annotations

import bpy

from ...blender.read.probes import all_probes
from .scene import InSidebar


class PCC_PT_scene_accuracy(InSidebar, bpy.types.Panel):
    bl_label = "Accuracy"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return bool(all_probes(context.scene))

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("pcc.misfit", icon="VIEW_PERSPECTIVE")
        column.operator("pcc.cost", icon="DRIVER_DISTANCE").quick = False
        column.operator("pcc.cost", icon="BLANK1", text="Measure Quickly").quick = True


CLASSES = (PCC_PT_scene_accuracy,)
