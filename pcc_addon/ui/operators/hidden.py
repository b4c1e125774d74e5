"""The operators that choose what a capture leaves out."""

from __future__ import annotations

import bpy


class PCC_OT_hidden_add(bpy.types.Operator):
    """Leave the other selected objects out of the active probe's capture"""

    bl_idname = "pcc.hidden_add"
    bl_label = "Hide Selected from Capture"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not (context.object and context.object.pcc_probe.is_probe and len(context.selected_objects) > 1):
            cls.poll_message_set("Select objects, and the probe last")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        hidden = context.object.pcc_probe.hidden_objects
        known = {item.object for item in hidden}
        for item in context.selected_objects:
            if item not in known and not item.pcc_probe.is_probe:
                hidden.add().object = item
        return {"FINISHED"}


class PCC_OT_hidden_remove(bpy.types.Operator):
    """Show an object in the active probe's capture again"""

    bl_idname = "pcc.hidden_remove"
    bl_label = "Show in Capture"
    bl_options = {"REGISTER", "UNDO"}

    index: bpy.props.IntProperty(name="Index", description="Which of those that are left out", min=0)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.object is None or not context.object.pcc_probe.is_probe:
            cls.poll_message_set("Make a parallax probe the active object")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        hidden = context.object.pcc_probe.hidden_objects
        if self.index < len(hidden):
            hidden.remove(self.index)
        return {"FINISHED"}


CLASSES = (PCC_OT_hidden_add, PCC_OT_hidden_remove)
