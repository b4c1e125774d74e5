"""When data may be changed by somebody but the user, as by a bake that comes from another Blender."""

from __future__ import annotations

import bpy

from . import handlers

_FREE_MODES = {"OBJECT", "POSE"}  # whose undo steps hold all data
_JOBS = {"RENDER": "a render", "OBJECT_BAKE": "a texture bake"}
_WRITES = {"UNDO", "BLOCKING", "GRAB_CURSOR"}
APART = frozenset({"PCC_OT_cost"})
"""Modal operators that work on a copy, beside which one goes on working."""


def why_not_now(manager: bpy.types.WindowManager) -> str:
    """What has to end before, in words that go on "waits for the end of …"; empty: nothing."""
    if handlers.is_paused():
        return "another job"
    for job, words in _JOBS.items():
        if bpy.app.is_job_running(job):
            return words
    for window in manager.windows:
        active = window.view_layer.objects.active
        if active is not None and active.mode not in _FREE_MODES:
            mode = bpy.types.Object.bl_rna.properties["mode"].enum_items[active.mode].name
            return f"{mode} of '{active.name}'"
        for tool in window.modal_operators:
            if _writes(tool):
                return f"'{tool.name or tool.bl_idname}'"
    return ""


def _writes(tool: bpy.types.Operator) -> bool:
    """Whether a tool that runs changes data; those of add-ons may run for ever, and say whether they do."""
    if tool.bl_idname in APART:
        return False
    by_addon = bpy.types.Operator.bl_rna_get_subclass_py(tool.bl_idname) is not None
    return not by_addon or bool(_WRITES & set(tool.bl_options))
