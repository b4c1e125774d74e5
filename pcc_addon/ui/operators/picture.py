"""The operator that chooses the picture of a probe."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...blender.store.pictures import blend_path
from ...core.errors import PccError, ProbeError
from ...core.picture_files import picture_files
from ...core.probe import Source


class PCC_OT_picture_choose(bpy.types.Operator):
    """Choose the picture that the active probe shows: one file, or six with the names of their faces"""

    bl_idname = "pcc.picture_choose"
    bl_label = "Choose Picture"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    directory: bpy.props.StringProperty(subtype="DIR_PATH", options={"SKIP_SAVE", "HIDDEN"})
    files: bpy.props.CollectionProperty(type=bpy.types.OperatorFileListElement, options={"SKIP_SAVE", "HIDDEN"})
    filter_image: bpy.props.BoolProperty(default=True, options={"SKIP_SAVE", "HIDDEN"})
    filter_folder: bpy.props.BoolProperty(default=True, options={"SKIP_SAVE", "HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.object is None or not context.object.pcc_probe.is_probe:
            cls.poll_message_set("Make a parallax probe the active object")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        probe = context.object
        try:
            path = self._chosen(probe.name)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        settings = probe.pcc_probe
        settings.source, settings.picture = Source.IMAGE.value, blend_path(path)
        return {"FINISHED"}

    def _chosen(self, probe: str) -> Path:
        """The file that stands for all that were chosen.

        Raises:
            ProbeError: there is none, or they are not the six files of one picture.
        """
        several = [Path(self.directory) / file.name for file in self.files if file.name]
        path = several[0] if several else Path(bpy.path.abspath(self.filepath)) if self.filepath else None
        found = picture_files(probe, str(path) if path else "")
        if len(several) > 1 and set(several) != set(found):
            raise ProbeError(
                f"probe '{probe}': the {len(several)} chosen files are not six faces of one picture; their names must "
                "be alike but for the ends px nx py ny pz nz (or posx …, right …, +x …)"
            )
        return path


CLASSES = (PCC_OT_picture_choose,)
