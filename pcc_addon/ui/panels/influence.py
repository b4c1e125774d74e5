"""How far a probe is shown, and by what."""

from __future__ import annotations

import bpy

from .of_probe import OfProbe

_LOW, _HIGH = ("−X", "−Y", "−Z"), ("+X", "+Y", "+Z")


class PCC_PT_influence(OfProbe, bpy.types.Panel):
    bl_label = "Influence"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        settings = context.object.pcc_probe
        column = layout.column()
        column.prop(settings, "weight")
        column.prop(settings, "priority")
        box = layout.column()
        box.active = settings.correction != "NONE"
        box.prop(settings, "outside")
        if not settings.falloff_per_face:
            box.prop(settings, "falloff")
        box.prop(settings, "falloff_per_face", text="Per Face")
        if settings.falloff_per_face:
            _draw_faces(box, settings, "falloff_low", "falloff_high", "Falloff")
        box.prop(settings, "normal_fade")
        _draw_faces(box, settings, "influence_low", "influence_high", "Reach")
        column = layout.column()
        column.prop(settings, "receivers")
        column.prop(settings, "excluded")


def _draw_faces(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, low: str, high: str, name: str) -> None:
    """Lengths beyond each face, a row each."""
    column = layout.column(align=True)
    for axis in range(3):
        for ends, prop in ((_LOW, low), (_HIGH, high)):
            first = not axis and prop == low
            column.prop(settings, prop, index=axis, text=f"{name} {ends[axis]}" if first else ends[axis])


CLASSES = (PCC_PT_influence,)
