"""How the probe's box lies to the room, and what the probe does not see."""

from __future__ import annotations

import bpy

from ..kept import last_misfit
from ..sentences import say
from .of_probe import OfBake


class PCC_PT_fit(OfBake, bpy.types.Panel):
    bl_label = "Fit"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("pcc.misfit", icon="VIEW_PERSPECTIVE")
        last = last_misfit.of(context.scene, context.object)
        if last is None:
            return
        layout.prop(context.window_manager, "pcc_show_misfit")
        if last.late:
            say(layout.column(align=True), context, "As it was before the last change", "ERROR")
        for lines, icon in ((last.found.fit_lines, "MOD_LATTICE"), (last.found.unseen_lines, "HIDE_ON")):
            column = layout.column(align=True)
            for index, line in enumerate(lines):
                say(column, context, line, icon if not index else "DOT")


CLASSES = (PCC_PT_fit,)
