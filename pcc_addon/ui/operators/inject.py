"""The operators that let materials show probes, and that restore them."""

from __future__ import annotations

import bpy

from ...blender.read.probes import all_probes
from ...blender.shade import injection
from ...core.accuracy.labels import counted
from ...core.errors import PccError
from ..kept import showing

_SCOPE = bpy.props.EnumProperty(
    name="Scope",
    items=[
        ("SCENE", "Scene", "All materials around the scene's probes"),
        ("SELECTED", "Selected", "Only the materials of selected objects"),
    ],
)


class PCC_OT_inject(bpy.types.Operator):
    """Let materials show the baked probes around them; the materials' own nodes are kept"""

    bl_idname = "pcc.inject"
    bl_label = "Inject into Materials"
    bl_options = {"REGISTER", "UNDO"}

    scope: _SCOPE

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        probes = all_probes(context.scene)
        if not any(probe.pcc_probe.bake_record for probe in probes):
            name = context.scene.name
            why = f"Scene '{name}' has no probe; add one and bake it"
            cls.poll_message_set(f"No probe of scene '{name}' has a bake; bake one to see it" if probes else why)
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        objects = list(context.selected_objects) if self.scope == "SELECTED" else None
        try:
            report = showing.inject(context.scene, context.view_layer, objects)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for note in report.notes:
            self.report({"WARNING"}, note)
        self.report({"WARNING" if report.notes else "INFO"}, showing.in_words(report))
        return {"FINISHED"}


class PCC_OT_remove(bpy.types.Operator):
    """Take the probes out of materials: they are again exactly what they were"""

    bl_idname = "pcc.remove"
    bl_label = "Remove from Materials"
    bl_options = {"REGISTER", "UNDO"}

    scope: _SCOPE

    def execute(self, context: bpy.types.Context) -> set[str]:
        restored = injection.remove(list(context.selected_objects) if self.scope == "SELECTED" else None)
        told = f"{counted(len(restored), 'material')} restored" if restored else "No material shows a probe"
        self.report({"INFO"}, told)
        return {"FINISHED"}


CLASSES = (PCC_OT_inject, PCC_OT_remove)
