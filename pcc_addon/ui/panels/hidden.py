"""What a capture leaves out."""

from __future__ import annotations

import bpy

from .of_probe import OfBake


class PCC_PT_hidden(OfBake, bpy.types.Panel):
    bl_label = "Hidden from Capture"
    bl_parent_id = "PCC_PT_capture"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        layout.prop(settings, "hidden_collection", text="Collection")
        for index, item in enumerate(settings.hidden_objects):
            row = layout.row(align=True)
            row.prop(item, "object", text="Object" if index == 0 else " ")
            row.operator("pcc.hidden_remove", icon="X", text="").index = index
        layout.operator("pcc.hidden_add", icon="ADD")


CLASSES = (PCC_PT_hidden,)
