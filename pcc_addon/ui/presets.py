"""The operator and the menu that set a probe for a purpose."""

from __future__ import annotations

from dataclasses import asdict

import bpy

from ..core.presets import Preset
from .chosen import chosen_probes


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
        if not chosen_probes(context):
            cls.poll_message_set("Select a parallax probe")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        for probe in chosen_probes(context):
            for name, value in asdict(Preset[self.preset].settings).items():
                if getattr(probe.pcc_probe, name) != value:
                    setattr(probe.pcc_probe, name, value)
        return {"FINISHED"}


CLASSES = (PCC_OT_preset,)
