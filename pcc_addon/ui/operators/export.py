"""Writes baked probes for another engine."""

from __future__ import annotations

import bpy

from ...blender.export import ExportJob
from ...blender.read.probes import all_probes
from ...core.errors import PccError
from ...core.export.targets import TARGETS, target_of
from ...core.workplace import real
from .chosen import chosen_probes
from .running import RunsJob

_TARGETS = [(target.key, target.title[0].upper() + target.title[1:], f"For {target.title}") for target in TARGETS]
_WIDTHS = [("AUTO", "As Baked", "Each probe's face resolution, or the next power of two")]
_WIDTHS += [(str(1 << k), f"{1 << k} px", "Texels across a face") for k in range(5, 13)]


class PCC_OT_export(RunsJob, bpy.types.Operator):
    """Write the baked probes for another engine: cubemaps with levels, boxes as JSON, and the lookup as a shader"""

    bl_idname = "pcc.export"
    bl_label = "Export Probes"
    _job: ExportJob | None = None
    _browsing = False
    _when_cancelled = "Cancelled; the folder is as it was"

    directory: bpy.props.StringProperty(subtype="DIR_PATH", options={"SKIP_SAVE"})
    filter_folder: bpy.props.BoolProperty(default=True, options={"SKIP_SAVE", "HIDDEN"})
    target: bpy.props.EnumProperty(name="Engine", description="Whose axes, files and shaders to write", items=_TARGETS)
    width: bpy.props.EnumProperty(name="Faces", description="Texels across the cubemaps' faces", items=_WIDTHS)
    selected: bpy.props.BoolProperty(
        name="Selected Probes Only", description="Otherwise all probes of the scene", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not any(probe.pcc_probe.bake_record for probe in all_probes(context.scene)):
            cls.poll_message_set("Bake a parallax probe first")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self.directory:
            return super().invoke(context, event)
        self._browsing = True
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not self._browsing:
            return super().execute(context)
        settings = self.as_keywords(ignore=("filter_folder",))  # a file browser's operator cannot go on by timers
        return {"CANCELLED"} if "CANCELLED" in bpy.ops.pcc.export("INVOKE_DEFAULT", **settings) else {"FINISHED"}

    def _start(self, context: bpy.types.Context) -> set[str]:
        if not self.directory:
            self.report({"ERROR"}, "No folder is chosen to export into; choose one")
            return {"CANCELLED"}
        probes = chosen_probes(context) if self.selected else all_probes(context.scene)
        if not probes:
            self.report({"ERROR"}, "No parallax probe is selected; select one, or export all")
            return {"CANCELLED"}
        width = None if self.width == "AUTO" else int(self.width)
        to = real(bpy.path.abspath(self.directory))
        try:
            self._job = ExportJob(context.scene, context.view_layer, probes, target_of(self.target), to, width)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return set()

    def _stopped(self) -> set[str]:
        return {"CANCELLED"}

    def _report(self, context: bpy.types.Context) -> set[str]:
        failed = [result.error for result in self._job.results if result.error is not None]
        done = [result for result in self._job.results if result.error is None]
        for note in (note for result in done for note in result.notes):
            self.report({"INFO"}, note)
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        if not done:
            return {"CANCELLED"}
        many = "probe" if len(done) == 1 else "probes"
        self.report({"INFO"}, f"Wrote {len(done)} {many} for {target_of(self.target).title} into {self.directory}")
        return {"FINISHED"}


CLASSES = (PCC_OT_export,)
