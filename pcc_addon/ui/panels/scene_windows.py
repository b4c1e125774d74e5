"""In the sidebar: windows that show baked rooms."""

from __future__ import annotations

import bpy

from .scene import InSidebar


class PCC_PT_scene_windows(InSidebar, bpy.types.Panel):
    bl_label = "Windows"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("pcc.interior_add", icon="MOD_LATTICE")
        column.operator("pcc.interior_add_pictures", icon="IMAGE_DATA")


CLASSES = (PCC_PT_scene_windows,)
