"""The operator that shows what was measured as plots."""

from __future__ import annotations

import bpy

from ...core.accuracy.plots import NAMES
from ..kept import last_cost


class PCC_OT_cost_show(bpy.types.Operator):
    """Show what was measured as plots of error against seconds, in an Image Editor"""

    bl_idname = "pcc.cost_show"
    bl_label = "Show Plots"
    bl_options = {"REGISTER", "UNDO"}

    plot: bpy.props.EnumProperty(
        name="Plot",
        items=[
            ("error_frame", "Error and Frame", "Error against the seconds of a frame"),
            ("error_bake", "Error and Bake", "Error against the seconds of the bake"),
            ("error_rungs", "Settings", "The error of each setting"),
        ],
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        folder = last_cost.folder()
        if folder is None or not all((folder / f"{name}.png").is_file() for name in NAMES):
            cls.poll_message_set("There are no plots beside the .blend: measure, with a Python that has matplotlib")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        image = bpy.data.images.load(str(last_cost.folder() / f"{self.plot}.png"), check_existing=True)
        image.reload()
        editor = next((area for area in context.screen.areas if area.type == "IMAGE_EDITOR"), None)
        if editor is None and not bpy.app.background:
            bpy.ops.wm.window_new()
            editor = context.window_manager.windows[-1].screen.areas[0]
            editor.type = "IMAGE_EDITOR"
        if editor is not None:
            editor.spaces.active.image = image
        return {"FINISHED"}


CLASSES = (PCC_OT_cost_show,)
