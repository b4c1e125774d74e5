"""How a probe's box lies to the room and what it does not see."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...blender.accuracy.misfit_job import MisfitJob, ProbeMisfit
from ..kept import last_misfit
from .chosen import chosen_probes
from .running import RunsJob


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
        for result in self._job.results:
            for line in result.lines:
                self.report({"INFO"}, f"probe '{result.probe}': {line}")
        failed = keep_found(context, self._job.results)
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        return {"FINISHED"} if len(failed) < len(self._job.results) else {"CANCELLED"}


def keep_found(context: bpy.types.Context, results: Sequence[ProbeMisfit]) -> list[str]:
    """Keep what was found, for panels and viewports; returns why the others failed."""
    for result in results:
        if result.error is None:
            last_misfit.keep(context.scene, context.view_layer, result)
    return [result.error for result in results if result.error is not None]


CLASSES = (PCC_OT_misfit,)
