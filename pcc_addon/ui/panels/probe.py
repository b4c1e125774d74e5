"""A probe in its data tab: where its pictures come from, how its bake stands."""

from __future__ import annotations

import bpy

from ...core.presets import Preset
from ..kept import states
from ..manual import Page, draw_button
from ..operators.chosen import chosen_probes
from ..sentences import say
from .presets import PCC_PT_presets
from .progress import draw_progress, draw_show_button


class PCC_PT_probe(bpy.types.Panel):
    bl_label = "Parallax Probe"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.pcc_probe.is_probe

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_button(self.layout, (Page.PANELS, ""))
        PCC_PT_presets.draw_panel_header(self.layout)

    def draw(self, context: bpy.types.Context) -> None:
        layout, probe = self.layout, context.object
        layout.use_property_split = True
        settings = probe.pcc_probe
        layout.prop(settings, "source")
        if settings.source == "IMAGE":
            row = layout.row(align=True)
            row.prop(settings, "picture")
            row.operator("pcc.picture_choose", icon="FILE_IMAGE", text="")
        row = layout.row(align=True)
        for preset in Preset:
            row.operator("pcc.preset", text=preset.label).preset = preset.name
        column = layout.column(align=True)
        known = states.of(context.scene, probe)
        say(column, context, known.sentence, known.icon, quiet=False)
        if not probe.select_get():
            say(column, context, "Select the probe to bake it")
            return
        those = "Selected Probes" if len(chosen_probes(context)) > 1 else "this Probe"
        draw_show_button(layout, "SELECTED", f"Bake and Show {those}")
        layout.operator("pcc.bake", icon="RENDER_STILL", text=f"Bake {those}").scope = "SELECTED"
        draw_progress(layout, context)


CLASSES = (PCC_PT_probe,)
