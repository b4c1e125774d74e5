"""The operator that measures what accuracy costs, in a Blender of its own."""

from __future__ import annotations

import bpy

from ...blender.accuracy.applying import apply_to
from ...blender.accuracy.process import CostProcess
from ...blender.accuracy.question import Question
from ...blender.read.probes import all_probes
from ...core.accuracy.advice import advice
from ...core.errors import Cancelled, PccError
from ...core.probe import Engine
from ...core.workplace import real


class PCC_OT_cost(bpy.types.Operator):
    """Measure how good the probe is from the camera and what that costs in time, in the background on a copy of the
    file. Esc cancels; what was measured is kept"""

    bl_idname = "pcc.cost"
    bl_label = "Measure Accuracy"
    bl_options = {"UNDO"}  # not REGISTER: adjusting would measure again

    probe: bpy.props.StringProperty(
        name="Probe", description="Which; empty: the active one, or the only one", options={"SKIP_SAVE"}
    )
    camera: bpy.props.StringProperty(
        name="Camera", description="Whose picture is compared; empty: the scene's", options={"SKIP_SAVE"}
    )
    engine: bpy.props.EnumProperty(
        name="Engine",
        description="Whose frames are measured",
        items=[
            ("SCENE", "Scene's", "As the scene renders"),
            (Engine.CYCLES.value, "Cycles", ""),
            (Engine.EEVEE.value, "EEVEE", ""),
        ],
    )
    frames: bpy.props.IntProperty(
        name="Frames", description="Successive frames, from the current one on; 3 show flicker", default=1, min=1
    )
    target_error: bpy.props.FloatProperty(
        name="Target", description="Relative error to meet as cheaply as can be; 0: as good as can be had", min=0.0
    )
    budget: bpy.props.FloatProperty(
        name="Budget",
        description="Seconds that all may take; 0: ten minutes, or a minute and a half where it is to be quick",
        min=0.0,
        subtype="TIME_ABSOLUTE",
    )
    quick: bpy.props.BoolProperty(name="Quick", description="A quarter of the pixels, in a minute and a half")
    width: bpy.props.IntProperty(
        name="Width", description="Of the pictures; 0: as many pixels as 480 × 270", min=0, subtype="PIXEL"
    )
    resume: bpy.props.BoolProperty(
        name="Resume", description="Go on with the measurements that are in the folder", options={"SKIP_SAVE"}
    )
    folder: bpy.props.StringProperty(
        name="Folder", description="Where results go; empty: beside the .blend", subtype="DIR_PATH"
    )
    apply: bpy.props.BoolProperty(
        name="Apply", description="Write the recommended settings into the probe", options={"SKIP_SAVE"}
    )
    _job: CostProcess | None = None
    _timer: bpy.types.Timer | None = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not all_probes(context.scene):
            cls.poll_message_set("The scene has no parallax probe: add one with Add › Light Probe › Parallax Probe")
            return False
        return True

    def _start(self, context: bpy.types.Context) -> bool:
        active = context.object
        probe = self.probe or (active.name if active is not None and active.pcc_probe.is_probe else "")
        question = Question(
            probe=probe,
            camera=self.camera,
            engine=None if self.engine == "SCENE" else Engine(self.engine),
            frames=self.frames,
            target=self.target_error or None,
            budget=None if self.target_error else self.budget or None,  # the shell takes one of them
            quick=self.quick,
            width=self.width or None,
        )
        folder = real(bpy.path.abspath(self.folder)) if self.folder else None
        try:
            self._job = CostProcess(question, folder, resume=self.resume)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not self._start(context):
            return {"CANCELLED"}
        try:
            self._job.run()
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return self._tell(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background:
            return self.execute(context)
        if not self._start(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.25, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC":
            self._job.cancel()
            self._finish(context)
            self.report({"WARNING"}, f"Cancelled; what was measured is kept in {self._job.folder}")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}  # a copy is measured, so the file may be worked on
        try:
            more = self._job.step()
        except PccError as error:
            self._finish(context)
            self.report({"WARNING" if isinstance(error, Cancelled) else "ERROR"}, str(error))
            return {"CANCELLED"}
        context.workspace.status_text_set(f"{self._job.progress:.0%}  {self._job.message}  (Esc: cancel)")
        if more:
            return {"PASS_THROUGH"}
        self._finish(context)
        return self._tell(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends, or opens another file."""
        self._job.cancel()

    def _finish(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _tell(self, context: bpy.types.Context) -> set[str]:
        for note in self._job.notes:
            self.report({"WARNING"}, note)
        report = self._job.report
        found = advice(report)
        for sentence in found.sentences:
            self.report({"INFO"}, sentence)
        self.report({"INFO"}, f"Results are in {self._job.folder}")
        if self.apply and found.recommended is not None:
            try:
                apply_to(context.scene, context.view_layer, report, found)
            except PccError as error:
                self.report({"ERROR"}, str(error))
                return {"CANCELLED"}
            self.report({"INFO"}, f"'{report.probe}' has the recommended settings; bake it to see them")
        return {"FINISHED"}


CLASSES = (PCC_OT_cost,)
