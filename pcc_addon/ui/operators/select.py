"""The operators that select probes, and that lock them."""

from __future__ import annotations

import bpy

from ...blender.read.probes import all_probes
from ..kept import states
from .chosen import chosen_probes

_WAITING = {states.State.STALE, states.State.UNBAKED, states.State.ERROR}


class PCC_OT_select(bpy.types.Operator):
    """Select probes of the scene"""

    bl_idname = "pcc.select"
    bl_label = "Select Probes"
    bl_options = {"REGISTER", "UNDO"}

    which: bpy.props.EnumProperty(
        name="Which",
        items=[
            ("ALL", "All", "All probes of the scene"),
            ("WAITING", "To Be Baked", "Those that are stale, faulty or not baked, as far as that is known"),
        ],
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        why = ""
        if context.mode != "OBJECT":
            why = "Objects are selected in Object Mode"
        elif not all_probes(context.scene):
            why = "The scene has no parallax probe: add one with Add › Light Probe › Parallax Probe"
        cls.poll_message_set(why)
        return not why

    def execute(self, context: bpy.types.Context) -> set[str]:
        there = [probe for probe in all_probes(context.scene) if probe.name in context.view_layer.objects]
        wanted = [p for p in there if self.which == "ALL" or states.of(context.scene, p).state in _WAITING]
        for item in context.selected_objects:
            item.select_set(False)
        for probe in wanted:
            probe.select_set(True)
        if wanted and context.view_layer.objects.active not in wanted:
            context.view_layer.objects.active = wanted[0]
        return {"FINISHED"}


class PCC_OT_lock(bpy.types.Operator):
    """Lock the selected probes, so that bakes of all or of stale ones leave them as they are; or unlock them"""

    bl_idname = "pcc.lock"
    bl_label = "Lock Selected Probes"
    bl_options = {"REGISTER", "UNDO"}

    locked: bpy.props.BoolProperty(name="Locked", description="Whether they are locked", default=True)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not chosen_probes(context):
            cls.poll_message_set("Select a parallax probe that is not linked")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        for probe in chosen_probes(context):
            probe.pcc_probe.locked = self.locked
        return {"FINISHED"}


CLASSES = (PCC_OT_select, PCC_OT_lock)
