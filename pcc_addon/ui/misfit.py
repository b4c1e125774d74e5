"""How a probe's box lies to the room and what it does not see: the operator and its panel."""

from __future__ import annotations

import bpy

from ..blender.accuracy.misfit_job import MisfitJob
from . import last_misfit
from .chosen import chosen_probes
from .probe_panel import OfBake
from .running import RunsJob
from .sentences import say


class PCC_OT_misfit(RunsJob, bpy.types.Operator):
    """Measure how far the boxes of selected probes are from what these see, and what they do not see. Esc cancels"""

    bl_idname = "pcc.misfit"
    bl_label = "Check Fit"
    _job: MisfitJob | None = None
    _when_cancelled = "Cancelled; what was known of the probes before is kept"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not chosen_probes(context):
            cls.poll_message_set("Select a parallax probe")
            return False
        return True

    def _start(self, context: bpy.types.Context) -> set[str]:
        self._job = MisfitJob(context.scene, context.view_layer, chosen_probes(context))
        return set()

    def _stopped(self) -> set[str]:
        return {"CANCELLED"}

    def _report(self, context: bpy.types.Context) -> set[str]:
        done = [result for result in self._job.results if result.error is None]
        for result in done:
            last_misfit.keep(context.scene, context.view_layer, result)
            for line in result.lines:
                self.report({"INFO"}, f"probe '{result.probe}': {line}")
        failed = [result.error for result in self._job.results if result.error is not None]
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        return {"FINISHED"} if done else {"CANCELLED"}


class PCC_PT_fit(OfBake, bpy.types.Panel):
    bl_label = "Fit"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("pcc.misfit", icon="VIEW_PERSPECTIVE")
        last = last_misfit.of(context.scene, context.object)
        if last is None:
            return
        layout.prop(context.window_manager, "pcc_show_misfit")
        if last.late:
            say(layout.column(align=True), context, "As it was before the last change", "ERROR")
        for lines, icon in ((last.found.fit_lines, "MOD_LATTICE"), (last.found.unseen_lines, "HIDE_ON")):
            column = layout.column(align=True)
            for index, line in enumerate(lines):
                say(column, context, line, icon if not index else "DOT")


CLASSES = (PCC_OT_misfit, PCC_PT_fit)
