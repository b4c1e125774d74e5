"""The question marks in panels."""

from __future__ import annotations

import bpy

from ..manual import Page, address


class PCC_OT_manual(bpy.types.Operator):
    """Show the manual's page about this in the browser; it came with the add-on, so no network is needed"""

    bl_idname = "pcc.manual"
    bl_label = "Manual"
    bl_options = {"INTERNAL"}

    page: bpy.props.EnumProperty(
        name="Page", items=[(page.name, page.name.replace("_", " ").title(), "") for page in Page]
    )
    anchor: bpy.props.StringProperty(name="Heading")

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            found = address((Page[self.page], self.anchor))
        except FileNotFoundError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return bpy.ops.wm.url_open(url=found)


CLASSES = (PCC_OT_manual,)
