"""The inputs of a window material."""

from __future__ import annotations

import bpy

from ...blender.shade.interior import SOCKETS, interior_node
from ..manual import Helped, Page


class PCC_PT_interior(Helped, bpy.types.Panel):
    """The inputs of the window group in the active material."""

    bl_label = "Parallax Interior"
    about = Page.WINDOWS, "numbers-of-a-window"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.material is not None and interior_node(context.material) is not None

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        inputs = interior_node(context.material).inputs
        for socket in SOCKETS:
            if socket.name in inputs:
                layout.prop(inputs[socket.name], "default_value", text=socket.name)


CLASSES = (PCC_PT_interior,)
