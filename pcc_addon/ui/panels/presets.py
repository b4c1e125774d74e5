"""Presets as a menu in a panel's header: ours, and those that an artist saved."""

from __future__ import annotations

import bpy
from bl_ui.utils import PresetPanel

from ...core.presets import Preset
from ..operators.presets import SUBDIR


class PCC_PT_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Probe Presets"
    preset_subdir = SUBDIR
    preset_operator = "pcc.preset_load"
    preset_add_operator = "pcc.preset_add"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        column = layout.column(align=True)
        column.emboss, column.operator_context = "PULLDOWN_MENU", "EXEC_DEFAULT"
        for preset in Preset:
            column.operator("pcc.preset", text=preset.label).preset = preset.name
        layout.separator()
        if bpy.utils.preset_paths(SUBDIR):
            super().draw(context)
            return
        row = layout.row()  # as there are none yet
        manager = context.window_manager
        row.prop(manager, "preset_name", text="")
        row.operator(self.preset_add_operator, text="", icon="ADD", emboss=False).name = manager.preset_name


CLASSES = (PCC_PT_presets,)
