"""The operator that fits boxes to rooms."""

from __future__ import annotations

import bpy

from ...blender.fitting import FitJob, apply_fit
from ...blender.read.probes import named_probes
from ...core.errors import PccError
from ...core.fit.report import headline
from .chosen import chosen_probes
from .running import RunsJob


class PCC_OT_fit(RunsJob, bpy.types.Operator):
    """Fit the boxes of the selected probes to the walls around them, and choose where to capture. Esc cancels"""

    bl_idname = "pcc.fit"
    bl_label = "Fit to Room"
    bl_options = {"UNDO"}  # not REGISTER: there is nothing to adjust

    _job: FitJob | None = None
    _when_cancelled = "Fit cancelled; the probes are as they were"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not chosen_probes(context):
            cls.poll_message_set("Select a parallax probe that is not linked")
            return False
        return True

    def _start(self, context: bpy.types.Context) -> set[str]:
        self._job = FitJob(context.scene, context.view_layer, chosen_probes(context))
        return set()

    def _stopped(self) -> set[str]:
        return {"CANCELLED"}

    def _report(self, context: bpy.types.Context) -> set[str]:
        failed, fitted = [], 0
        for result in self._job.results:
            try:
                if result.fit is None:
                    raise PccError(result.error)
                apply_fit(named_probes(context.scene, [result.probe])[0], result.fit, context.view_layer)
            except PccError as error:
                failed.append(str(error))
                continue
            fitted += 1
            for line in result.fit.warnings:
                self.report({"WARNING"}, f"probe '{result.probe}': {line}")
            before, after = result.fit.misfit_before, result.fit.misfit_after
            self.report({"INFO"}, f"'{result.probe}': {headline(result.fit)}; misfit {before} → {after}")
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        return {"FINISHED"} if fitted else {"CANCELLED"}


CLASSES = (PCC_OT_fit,)
