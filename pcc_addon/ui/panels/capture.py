"""How a probe's pictures are taken and kept."""

from __future__ import annotations

import contextlib

import bpy

from ...blender.reshaping import captured_elsewhere
from ...core.errors import PccError
from ..sentences import say
from .of_probe import OfProbe
from .progress import draw_denoise


class PCC_PT_capture(OfProbe, bpy.types.Panel):
    bl_label = "Capture"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        rendered = settings.source != "IMAGE"
        if rendered:
            layout.prop(settings, "engine")
        layout.prop(settings, "resolution")
        if rendered:
            column = layout.column(align=True)
            column.prop(settings, "samples")
            if settings.engine == "CYCLES":
                column.prop(settings, "adaptive", text="Noise Limit")
                draw_denoise(layout.column(), context)
        layout.prop(settings, "half_float")
        if settings.source == "BAKE":
            layout.prop(settings, "follow")
            layout.column().prop(settings, "capture_offset", text="Offset")
            with contextlib.suppress(PccError):  # status tells
                if captured_elsewhere(context.object):
                    say(layout.column(align=True), context, "the capture point counts from the next bake", "INFO")
            column = layout.column(align=True)
            column.prop(settings, "clip_start")
            column.prop(settings, "clip_end", text="End")


CLASSES = (PCC_PT_capture,)
