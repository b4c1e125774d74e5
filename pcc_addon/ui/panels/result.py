"""What the last bake of a probe looks like, and how it came about."""

from __future__ import annotations

import bpy

from ...blender.read.probes import bake_record
from ...core.bake_words import kept_as, made_when, made_with, not_captured
from ...core.errors import PccError
from ..kept import states, thumbnails
from ..sentences import room, say, unit
from .of_probe import OfProbe

_LARGEST = 9.0  # units across the ball
_CROSS = 4.0 / 3.0  # how much wider the cross is, which is four faces wide and three high


class PCC_PT_result(OfProbe, bpy.types.Panel):
    bl_label = "Result"

    def draw(self, context: bpy.types.Context) -> None:
        layout, probe = self.layout, context.object
        try:
            record = bake_record(probe)
        except PccError as error:
            say(layout.column(align=True), context, str(error), "ERROR")
            return
        if record is None:
            say(layout.column(align=True), context, "It has no bake", states.State.UNBAKED.icon)
            return
        _draw_pictures(layout, context, probe)
        column = layout.column(align=True)
        say(column, context, made_with(record), "RENDER_STILL")
        say(column, context, made_when(record), "TIME")
        say(column, context, kept_as(record), "DISK_DRIVE")
        left_out = not_captured(record)
        if left_out:
            say(column, context, left_out, "HIDE_ON")
        known = states.of(context.scene, probe)
        if known.words:
            say(column, context, known.words, known.icon)


def _draw_pictures(layout: bpy.types.UILayout, context: bpy.types.Context, probe: bpy.types.Object) -> None:
    icons = thumbnails.of(probe)
    if icons is not None and icons.ball is None:
        say(layout.column(align=True), context, "Its pictures cannot be read", "ERROR")
        return
    across = min(room(context) / unit(context) / (1.0 + _CROSS), _LARGEST)
    row = layout.row()
    row.alignment = "CENTER"
    ball, cross = (icons.ball, icons.cross) if icons is not None else (0, 0)  # nothing moves when they come
    row.template_icon(ball, scale=across)
    row.template_icon(cross, scale=_CROSS * across)


CLASSES = (PCC_PT_result,)
