"""What holds for all probes of a scene, in its own tab."""

from __future__ import annotations

import bpy

from ..manual import Helped, Page


class PCC_PT_scene_settings(Helped, bpy.types.Panel):
    bl_label = "Parallax Probes"
    about = Page.PANELS, "scene"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "scene"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.pcc
        layout.prop(settings, "preset", text="New Probes")
        layout.prop(settings, "roughness_limit", text="Roughness")
        layout.prop(settings, "folder")


CLASSES = (PCC_PT_scene_settings,)
