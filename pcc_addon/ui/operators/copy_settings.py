"""The operator that gives other probes the settings of the active one."""

from __future__ import annotations

import bpy

from ...blender.setting_groups import Group, copy_settings
from .chosen import chosen_probes


class PCC_OT_copy_settings(bpy.types.Operator):
    """Give the other selected probes the settings of the active one; where they are and their bakes stay"""

    bl_idname = "pcc.copy_settings"
    bl_label = "Copy Settings to Selected"
    bl_options = {"REGISTER", "UNDO"}

    groups: bpy.props.EnumProperty(
        name="Settings",
        description="Which of them",
        items=[(group.name, group.label, group.meaning) for group in Group],
        options={"ENUM_FLAG"},
        default={group.name for group in Group},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        active = context.object
        if active is None or not active.pcc_probe.is_probe:
            cls.poll_message_set("Make the parallax probe active whose settings are to be copied")
            return False
        if all(probe == active for probe in chosen_probes(context)):
            cls.poll_message_set("Select other parallax probes too; the active one gives its settings to them")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.column(align=True).prop(self, "groups", expand=True)

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not self.groups:
            self.report({"WARNING"}, "No settings are chosen, so nothing is copied")
            return {"CANCELLED"}
        others = [probe for probe in chosen_probes(context) if probe != context.object]
        for probe in others:
            copy_settings(context.object, probe, [Group[name] for name in self.groups])
        self.report({"INFO"}, f"Settings of '{context.object.name}' copied to {len(others)} probes")
        return {"FINISHED"}


CLASSES = (PCC_OT_copy_settings,)
