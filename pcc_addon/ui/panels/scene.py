"""The sidebar of the 3D view: all probes of the scene, and their bakes."""

from __future__ import annotations

import bpy

from ...blender import marks
from ...blender.read.probes import all_probes
from ...blender.shade.twin import has_twins
from ..kept import states
from ..manual import Helped, Page
from ..sentences import say
from .probe_list import draw_list, summary
from .progress import draw_progress, draw_show_button


class InSidebar:
    """A base of panels beside `bpy.types.Panel`: they are in the sidebar, under the first one."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Probes"
    bl_parent_id = "PCC_PT_scene"


class PCC_PT_scene(Helped, bpy.types.Panel):
    bl_label = "Parallax Probes"
    about = Page.FIRST_PROBE, ""
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Probes"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        probes = all_probes(context.scene)
        if not probes:
            _draw_without(layout, context)
            return
        draw_list(layout, context)
        column = layout.column(align=True)
        _draw_state(column, context, probes)
        draw_show_button(layout, "STALE", "Bake and Show")
        column = layout.column(align=True)
        column.operator("pcc.status", icon="FILE_REFRESH")
        column.operator("pcc.bake", icon="RENDER_STILL", text="Bake Stale").scope = "STALE"
        row = column.row(align=True)
        row.operator("pcc.bake", text="All").scope = "ALL"
        row.operator("pcc.bake", text="Selected").scope = "SELECTED"
        column.operator("pcc.bake_frames", icon="RENDER_ANIMATION")
        draw_progress(layout, context)


def _draw_state(layout: bpy.types.UILayout, context: bpy.types.Context, probes: list[bpy.types.Object]) -> None:
    """What is known of the active probe, else of all."""
    if context.object in probes:
        known = states.of(context.scene, context.object)
        say(layout, context, known.sentence, known.icon, quiet=False)
        return
    say(layout, context, summary(context.scene, probes), "INFO", quiet=False)
    if states.all_late(context.scene):
        say(layout, context, "Not checked since the last change")


def _draw_without(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    column = layout.column(align=True)
    say(column, context, "No probes yet", "INFO", quiet=False)
    column.operator("pcc.probe_add", icon="LIGHTPROBE_SPHERE", text="Add Parallax Probe")
    if any(has_twins(material) or marks.is_copy(material) for material in bpy.data.materials):
        column = layout.column(align=True)  # copies of deleted probes' rooms, or probes of other scenes
        say(column, context, "Some materials are not yet what they were without probes", "INFO")
        column.operator("pcc.remove", icon="X")


CLASSES = (PCC_PT_scene,)
