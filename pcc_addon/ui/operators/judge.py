"""The switch to judge probes by, and its measurement where that is not known yet."""

from __future__ import annotations

from enum import Enum

import bpy

from ...blender import judging
from ...blender.accuracy.misfit_job import MisfitJob
from ...blender.judging import View
from ...blender.read.probes import all_probes
from ..kept import last_misfit
from ..kept.redrawing import redraw
from .chosen import chosen_probes
from .misfit import keep_found
from .running import RunsJob


class Judged(str, Enum):
    """What viewports show."""

    CORRECTED = "CORRECTED"
    UNCORRECTED = "UNCORRECTED"
    MISFIT = "MISFIT"
    OFF = "OFF"


_VIEWS = {Judged.UNCORRECTED: View.UNCORRECTED, Judged.OFF: View.OFF}  # the others are corrected


def judged(manager: bpy.types.WindowManager) -> Judged:
    """What viewports show at present."""
    if judging.view() is not View.CORRECTED:
        return Judged(judging.view().value)
    return Judged.MISFIT if manager.pcc_show_misfit else Judged.CORRECTED


class PCC_OT_judge(RunsJob, bpy.types.Operator):
    bl_idname = "pcc.judge"
    bl_label = "Show Probes"
    bl_options = {"INTERNAL"}
    _job: MisfitJob | None = None
    _when_cancelled = "Cancelled; what was known of the probes before is shown"

    view: bpy.props.EnumProperty(
        name="View",
        items=[
            (Judged.CORRECTED.value, "Corrected", "With parallax, as renders show it"),
            (Judged.UNCORRECTED.value, "Uncorrected", "The same pictures, looked up without parallax"),
            (Judged.MISFIT.value, "Misfit", "The boxes, coloured by how far they are from what is seen"),
            (Judged.OFF.value, "Off", "The materials' own reflections"),
        ],
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        item = properties.bl_rna.properties["view"].enum_items[properties.view]
        return f"{item.description}. Only viewports are changed: files and renders stay corrected"

    def _start(self, context: bpy.types.Context) -> set[str]:
        view = Judged(self.view)
        judging.show(_VIEWS.get(view, View.CORRECTED))
        context.window_manager.pcc_show_misfit = view is Judged.MISFIT
        redraw()
        unknown = _unknown(context) if view is Judged.MISFIT else []
        if not unknown:
            return {"FINISHED"}
        self._job = MisfitJob(context.scene, context.view_layer, unknown)
        return set()

    def _stopped(self) -> set[str]:
        return {"CANCELLED"}

    def _report(self, context: bpy.types.Context) -> set[str]:
        failed = keep_found(context, self._job.results)
        if failed:
            self.report({"WARNING"}, "; ".join(failed))
        return {"FINISHED"}


def _unknown(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The chosen probes, else all, whose misfit is not known or not any more; given pictures have none."""
    probes = chosen_probes(context) or all_probes(context.scene)
    known = [last_misfit.of(context.scene, probe) for probe in probes]
    unknown = [probe for probe, last in zip(probes, known, strict=True) if last is None or last.late]
    return [probe for probe in unknown if probe.pcc_probe.source == "BAKE"]


CLASSES = (PCC_OT_judge,)
