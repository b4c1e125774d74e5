"""The operators that bake: in this Blender for scripts, in a second one where an artist works."""

from __future__ import annotations

import bpy

from ...blender.bake.background import BackgroundBake
from ...blender.bake.job import BakeJob
from ...blender.read.probes import all_probes, unlocked
from ...blender.status import waiting_among
from ...blender.store.levels import bake_folder
from ...core.errors import PccError
from ...core.frames import FIRST_FRAME, LAST_FRAME, FrameRange, parse_frames
from ..kept import last_plan, running_bake
from ..kept.showing import Showing
from .running import RunsJob

_SCOPES = [
    ("STALE", "Stale", "Probes that have no bake, or that something has changed around since"),
    ("ALL", "All", "All probes of the scene"),
    ("SELECTED", "Selected", "Selected probes"),
]


class PCC_OT_bake(RunsJob, bpy.types.Operator):
    """Bake what the probes see, in the background on a copy of the file, while you go on working"""

    bl_idname = "pcc.bake"
    bl_label = "Bake Probes"
    bl_options = {"UNDO"}  # not REGISTER: adjusting a bake would bake again

    scope: bpy.props.EnumProperty(
        name="Scope",
        items=_SCOPES,
    )
    frames: bpy.props.StringProperty(
        name="Frames",
        description="Frames to bake the probes for, such as 1-250 or 1-250:2; 'still' for the current one alone. "
        "Empty: as each was last baked",
        options={"SKIP_SAVE"},
    )
    background: bpy.props.BoolProperty(
        name="In Background",
        description="Let a second Blender bake where this one has a window; else it waits, and Esc cancels. Scripts "
        "always wait",
        default=True,
        options={"SKIP_SAVE"},
    )
    show: bpy.props.BoolProperty(
        name="Show",
        description="Let materials show each probe as soon as it is baked, and a viewport without materials what "
        "renders show",
        options={"SKIP_SAVE"},
    )
    _job: BakeJob | None = None
    _left: int = 0  # probes that are stale and that nothing shows
    _when_cancelled = "Bake cancelled; probes that were not finished keep their old bakes"

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        shown = ". Materials show each probe as soon as it is baked, and the viewport shows them"
        return cls.__doc__ + shown * properties.show

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not all_probes(context.scene):
            cls.poll_message_set("The scene has no parallax probe: add one with Add › Light Probe › Parallax Probe")
            return False
        if running_bake.running() is not None:
            cls.poll_message_set("A bake runs already: wait for it, or cancel it")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background or not self.background:
            return super().invoke(context, event)
        try:
            frames, probes = parse_frames(self.frames), self._candidates(context)
            if not probes:
                self.report({"INFO"}, _NOTHING_TO_BAKE[self.scope])
                return {"CANCELLED"}
            stale = self.scope == "STALE"
            bake = BackgroundBake(context.scene, context.view_layer, probes, frames, stale=stale)
            running_bake.begin(bake, Showing.of(context.scene, context.view_layer) if self.show else None)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"CANCELLED"}  # nothing is changed yet, so there is nothing to undo

    def _start(self, context: bpy.types.Context) -> set[str]:
        """Make the job ready; returns how the operator has ended already, if it has."""
        try:
            frames = parse_frames(self.frames)
            probes = self._probes_in_scope(context, frames)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if not probes:
            self.report({"INFO"}, _NOTHING_TO_BAKE[self.scope] + self._left_in_words)
            self._show(context)
            return {"FINISHED"}
        folder = bake_folder(context.scene)
        if folder is None:
            self.report({"INFO"}, "The file is not saved yet: pictures are packed into it")
        reuse = self.scope == "STALE"
        self._job = BakeJob(context.scene, context.view_layer, probes, folder, frames, reuse)
        return set()

    def _probes_in_scope(self, context: bpy.types.Context, frames: FrameRange | str | None) -> list[bpy.types.Object]:
        probes = self._candidates(context)
        if self.scope != "STALE":
            return probes
        waiting = waiting_among(last_plan.check(context.scene, context.view_layer), probes, frames)
        for line in waiting.unneeded:
            self.report({"INFO"}, line)
        self._left = len(waiting.unneeded)
        return list(waiting.probes)

    def _candidates(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """The probes in scope, stale or not."""
        probes = all_probes(context.scene)
        if self.scope == "SELECTED":
            return [probe for probe in probes if probe.select_get(view_layer=context.view_layer)]
        probes, locked = unlocked(probes)
        for line in locked:
            self.report({"INFO"}, line)
        return probes

    @property
    def _left_in_words(self) -> str:
        """What the end of a report says of probes that were left out, each of which has a line before."""
        if not self._left:
            return ""
        verb, those = ("is", "it") if self._left == 1 else ("are", "them")
        return f"; {self._left} {verb} left as nothing shows {those}"

    def _stopped(self) -> set[str]:
        """What a bake that did not end returns: an undo step where some of its probes were finished."""
        return {"FINISHED"} if any(result.error is None for result in self._job.results) else {"CANCELLED"}

    def _report(self, context: bpy.types.Context) -> set[str]:
        results = self._job.results
        last_plan.make(context.scene, context.view_layer)
        for line in self._job.missing_textures:
            self.report({"WARNING"}, f"{line}; the bake shows it in pink")
        done = [r for r in results if r.error is None]
        for result in done:
            for line in (*result.replaced_pixels, *result.warnings):
                self.report({"WARNING"}, f"probe '{result.probe}': {line}")
        if done:
            self.report({"INFO"}, f"Baked {', '.join(str(result) for result in done)}{self._left_in_words}")
        failed = [r.error for r in results if r.error is not None]
        if done:
            self._show(context)
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        return {"FINISHED"} if done else {"CANCELLED"}

    def _show(self, context: bpy.types.Context) -> None:
        if not self.show:
            return
        showing = Showing.of(context.scene, context.view_layer)
        try:
            self.report({"INFO"}, showing.in_materials())
        except PccError as error:
            self.report({"WARNING"}, str(error))
        else:
            showing.in_viewport()


class PCC_OT_bake_frames(bpy.types.Operator):
    """Bake what the probes see at each frame; frames at which nothing changes share a picture"""

    bl_idname = "pcc.bake_frames"
    bl_label = "Bake Frames"

    scope: bpy.props.EnumProperty(name="Scope", items=_SCOPES)
    first: bpy.props.IntProperty(name="First", default=1, min=FIRST_FRAME, max=LAST_FRAME)
    last: bpy.props.IntProperty(name="Last", default=250, min=FIRST_FRAME, max=LAST_FRAME)
    step: bpy.props.IntProperty(
        name="Step", description="Between these frames the picture of the one before is shown", default=1, min=1
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return PCC_OT_bake.poll.__func__(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self.properties.is_property_set("first"):
            self.first, self.last = context.scene.frame_start, context.scene.frame_end
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            frames = FrameRange(self.first, self.last, self.step)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        started = bpy.ops.pcc.bake("INVOKE_DEFAULT", scope=self.scope, frames=frames.text)
        return {"CANCELLED"} if "CANCELLED" in started else {"FINISHED"}  # that one may run on by itself


class PCC_OT_bake_cancel(bpy.types.Operator):
    """Stop the bake that runs in the background. Probes that have their new bakes keep them, the others the old"""

    bl_idname = "pcc.bake_cancel"
    bl_label = "Cancel Bake"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if running_bake.running() is None:
            cls.poll_message_set("No bake runs in the background")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        running_bake.cancel()
        return {"FINISHED"}


class PCC_OT_bake_forget(bpy.types.Operator):
    """Take what became of the last bake off the panels"""

    bl_idname = "pcc.bake_forget"
    bl_label = "Hide"
    bl_options = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        running_bake.forget()
        return {"FINISHED"}


_NOTHING_TO_BAKE = {
    "STALE": "All probes that anything shows are baked, and nothing has changed since",
    "ALL": "All probes of the scene are locked",
    "SELECTED": "No probe is selected",
}


CLASSES = (PCC_OT_bake, PCC_OT_bake_frames, PCC_OT_bake_cancel, PCC_OT_bake_forget)
