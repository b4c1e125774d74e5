"""The switch to judge probes by: in the sidebar, and in the 3D view's header where there are probes."""

from __future__ import annotations

import bpy

from ...blender.read.probes import all_probes
from ...blender.shade import groups
from ..manual import Helped, Page
from ..operators.judge import Judged, judged

_ICONS = {
    Judged.CORRECTED: "LIGHTPROBE_SPHERE",
    Judged.UNCORRECTED: "MATSPHERE",
    Judged.MISFIT: "MOD_LATTICE",
    Judged.OFF: "HIDE_ON",
}


class PCC_PT_judging(Helped, bpy.types.Panel):
    bl_label = "Judge"
    about = Page.PLACING, "judging"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Probes"
    bl_ui_units_x = 12

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return bool(all_probes(context.scene))

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        current = judged(context.window_manager)
        for view, icon in _ICONS.items():
            column.operator("pcc.judge", text=view.value.capitalize(), icon=icon, depress=view is current).view = view
        if current in (Judged.UNCORRECTED, Judged.OFF):
            column = self.layout.column(align=True)
            column.label(text="Only viewports show this:", icon="INFO")
            column.label(text="files and renders stay corrected", icon="BLANK1")


def draw_in_header(self: bpy.types.Header, context: bpy.types.Context) -> None:
    if groups.parallax_nodes():  # quicker than to ask all objects
        current, row = judged(context.window_manager), self.layout.row()
        row.alert = current in (Judged.UNCORRECTED, Judged.OFF)
        row.popover("PCC_PT_judging", text="", icon=_ICONS[current])


def register() -> None:
    bpy.types.VIEW3D_HT_header.append(draw_in_header)


def unregister() -> None:
    bpy.types.VIEW3D_HT_header.remove(draw_in_header)


CLASSES = (PCC_PT_judging,)
