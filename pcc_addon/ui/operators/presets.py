"""The operators that set probes for a purpose, or as an artist saved it."""

from __future__ import annotations

import bpy
from bl_operators.presets import AddPresetBase

from ...blender.setting_groups import Group, apply_preset
from ...core.presets import Preset
from .chosen import chosen_probes

SUBDIR = "parallax_probes"
"""The folder of saved presets, below Blender's."""

_OF_PLACES = {"source", "picture", "hidden_collection", "hidden_objects"}  # what other files do not have


class _OfChosen:
    """Sets the selected probes, or the active one."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not chosen_probes(context):
            cls.poll_message_set("Select a parallax probe that is not linked")
            return False
        return True


class PCC_OT_preset(_OfChosen, bpy.types.Operator):
    """Set size, samples, precision and relief of the selected probes for a purpose; nothing is baked"""

    bl_idname = "pcc.preset"
    bl_label = "Probe Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.EnumProperty(
        name="Preset", items=[(p.name, p.label, p.purpose) for p in Preset], default=Preset.MEDIUM.name
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        preset = Preset[properties.preset]
        own = preset.settings
        denoised = " denoised" if own.denoise else ""
        return f"{preset.purpose}: {own.resolution} px faces, {own.samples} samples{denoised}. Nothing is baked"

    def execute(self, context: bpy.types.Context) -> set[str]:
        for probe in chosen_probes(context):
            apply_preset(probe, Preset[self.preset])
        return {"FINISHED"}


class PCC_OT_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the capture and correction of the active probe as a preset of your own, or remove one"""

    bl_idname = "pcc.preset_add"
    bl_label = "Add Probe Preset"
    preset_menu = "PCC_PT_presets"
    preset_subdir = SUBDIR
    preset_defines = ["probe = bpy.context.object.pcc_probe"]
    preset_values = [
        f"probe.{name}" for group in (Group.CAPTURE, Group.BOX) for name in group.names if name not in _OF_PLACES
    ]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.object is None or not context.object.pcc_probe.is_probe:
            cls.poll_message_set("Make a parallax probe the active object")
            return False
        return True


class PCC_OT_preset_load(_OfChosen, bpy.types.Operator):
    """Set the selected probes as the preset says; nothing is baked"""

    bl_idname = "pcc.preset_load"
    bl_label = "Load Probe Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    menu_idname: bpy.props.StringProperty(options={"SKIP_SAVE", "HIDDEN"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        name = bpy.path.display_name_from_filepath(self.filepath)
        for probe in chosen_probes(context):
            try:
                with context.temp_override(object=probe):
                    bpy.utils.execfile(bpy.path.abspath(self.filepath))
            except Exception as error:  # a file that anybody may have edited
                self.report({"ERROR"}, f"Preset '{name}' cannot be loaded ({error}); save it again")
                return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (PCC_OT_preset, PCC_OT_preset_add, PCC_OT_preset_load)
