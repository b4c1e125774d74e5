"""The box of a probe, and how it corrects reflections."""

from __future__ import annotations

import bpy

from .of_probe import OfProbe


class PCC_PT_box(OfProbe, bpy.types.Panel):
    bl_label = "Box"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        layout.column().prop(settings, "size")
        layout.operator("pcc.fit", icon="FULLSCREEN_EXIT")
        column = layout.column()
        column.prop(settings, "correction")
        box = column.column()
        box.active = settings.correction != "NONE"
        if settings.correction == "RELIEF":
            steps = box.column(align=True)
            steps.prop(settings, "relief_steps", text="Steps")
            steps.prop(settings, "relief_refinements", text="Refinements")
        box.prop(settings, "padding")
        box.column(heading="Contact").prop(settings, "contact_hardening", text="Hardening")


CLASSES = (PCC_PT_box,)
