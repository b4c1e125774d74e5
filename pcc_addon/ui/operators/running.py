"""Operators that run a job: at once where there is no window, else a step at a time, with progress and Esc."""

from __future__ import annotations

import bpy

from ...blender.stepping import SteppedJob
from ...core.errors import Cancelled, PccError


class RunsJob:
    """A base of such operators, which say how to start, what to report and how they end where they are stopped."""

    _job: SteppedJob | None = None
    _timer: bpy.types.Timer | None = None
    _when_cancelled: str

    def _start(self, context: bpy.types.Context) -> set[str]:
        """Make the job ready; returns how the operator has ended already, if it has."""
        raise NotImplementedError

    def _report(self, context: bpy.types.Context) -> set[str]:
        """Tell what became of a job that ended; returns how the operator ends."""
        raise NotImplementedError

    def _stopped(self) -> set[str]:
        """How the operator ends where the job did not: an undo step where something was done."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        if ended := self._start(context):
            return ended
        try:
            self._job.finish()
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return self._stopped()
        return self._report(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background:
            return self.execute(context)
        if ended := self._start(context):
            return ended
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
            self.report({"WARNING"}, self._when_cancelled)
            return self._stopped()
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}  # nothing may be edited while the scene is set up for the job
        try:
            more = self._job.step()
        except Exception as error:
            self._finish(context)
            if not isinstance(error, PccError):
                raise
            self.report({"WARNING" if isinstance(error, Cancelled) else "ERROR"}, str(error))
            return self._stopped()
        context.window_manager.progress_update(self._job.progress)
        context.workspace.status_text_set(f"{self._job.progress:.0%}  {self._job.message}  (Esc: cancel)")
        if more:
            return {"RUNNING_MODAL"}
        self._finish(context)
        return self._report(context)

    def _finish(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
