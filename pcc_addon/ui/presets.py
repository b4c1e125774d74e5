"""The operator and the menu that set a probe for a purpose."""

from __future__ import annotations

from dataclasses import asdict

import bpy

from ..core.presets import Preset


class PCC_OT_preset(bpy.types.Operator):
    """Set size, samples, precision and relief of the selected probes for a purpose; nothing is baked"""

    bl_idname = "pcc.preset"
    bl_label = "Probe Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.EnumProperty(
        name="Preset", items=[(p.name, p.label, p.purpose) for p in Preset], default=Preset.MEDIUM.name
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not _chosen(context):
            cls.poll_message_set("Select a parallax probe")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        for probe in _chosen(context):
            for name, value in asdict(Preset[self.preset].settings).items():
                if getattr(probe.pcc_probe, name) != value:
                    setattr(probe.pcc_probe, name, value)
        return {"FINISHED"}


def _chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The selected probes; the active one where none is selected."""
    selected = [item for item in context.selected_objects if item.pcc_probe.is_probe]
    active = context.view_layer.objects.active
    return selected or [item for item in [active] if item is not None and item.pcc_probe.is_probe]


CLASSES = (PCC_OT_preset,)
