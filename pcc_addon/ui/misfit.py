"""How a probe's box lies to the room and what it does not see: the operator and its panel."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..blender.accuracy.misfit_job import MisfitJob, ProbeMisfit
from ..blender.read.probes import all_probes
from ..core.errors import Cancelled, PccError
from . import last_misfit
from .sentences import say


class PCC_OT_misfit(bpy.types.Operator):
    """Measure how far the boxes of selected probes are from what these see, and what they do not see. Esc cancels"""

    bl_idname = "pcc.misfit"
    bl_label = "Check Fit"

    _job: MisfitJob | None = None
    _timer: bpy.types.Timer | None = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not _chosen(context):
            cls.poll_message_set("Select a parallax probe")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        self._job = MisfitJob(context.scene, context.view_layer, _chosen(context))
        try:
            results = self._job.run()
        except Cancelled as error:
            self.report({"WARNING"}, str(error))
            return {"CANCELLED"}
        return self._report(context, results)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background:
            return self.execute(context)
        self._job = MisfitJob(context.scene, context.view_layer, _chosen(context))
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.01, window=context.window)
        manager.progress_begin(0.0, 1.0)
        context.window.cursor_modal_set("WAIT")
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC":
            self._job.cancel()
            self._finish(context)
            self.report({"WARNING"}, "Cancelled; what was known of the probes before is kept")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}  # nothing may be edited while the scene is set up for the survey
        try:
            more = self._job.step()
        except Exception as error:
            self._finish(context)
            if not isinstance(error, PccError):
                raise
            self.report({"WARNING" if isinstance(error, Cancelled) else "ERROR"}, str(error))
            return {"CANCELLED"}
        context.window_manager.progress_update(self._job.progress)
        context.workspace.status_text_set(f"{self._job.progress:.0%}  {self._job.message}  (Esc: cancel)")
        if more:
            return {"RUNNING_MODAL"}
        self._finish(context)
        return self._report(context, self._job.results)

    def _finish(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)

    def _report(self, context: bpy.types.Context, results: Sequence[ProbeMisfit]) -> set[str]:
        done = [result for result in results if result.error is None]
        for result in done:
            last_misfit.keep(context.scene, context.view_layer, result)
            for line in result.lines:
                self.report({"INFO"}, f"probe '{result.probe}': {line}")
        failed = [result.error for result in results if result.error is not None]
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        return {"FINISHED"} if done else {"CANCELLED"}


def _chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The selected probes, or the active one where none is."""
    probes = all_probes(context.scene)
    selected = [probe for probe in probes if probe.select_get(view_layer=context.view_layer)]
    return selected or [probe for probe in probes if probe == context.object]


class PCC_PT_fit(bpy.types.Panel):
    bl_label = "Fit"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"
    bl_parent_id = "PCC_PT_probe"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.pcc_probe.source == "BAKE"

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
