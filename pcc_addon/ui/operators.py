"""The operators. They gather what is asked, call `blender/`, and report; headless they do the same at once."""

from __future__ import annotations

import bpy

from ..blender.bake.job import BakeJob
from ..blender.probes import add_probe
from ..blender.read.probes import all_probes
from ..blender.shade import injection
from ..blender.status import waiting_among
from ..blender.store.levels import bake_folder
from ..core.errors import PccError
from ..core.frames import FIRST_FRAME, LAST_FRAME, FrameRange, parse_frames
from . import last_plan
from .running import RunsJob

_SCOPE = bpy.props.EnumProperty(
    name="Scope",
    items=[
        ("SCENE", "Scene", "All materials around the scene's probes"),
        ("SELECTED", "Selected", "Only the materials of selected objects"),
    ],
)
_SCOPES = [
    ("STALE", "Stale", "Probes that have no bake, or that something has changed around since"),
    ("ALL", "All", "All probes of the scene"),
    ("SELECTED", "Selected", "Selected probes"),
]


class PCC_OT_probe_add(bpy.types.Operator):
    """Add a parallax probe: a box that follows the walls of a room"""

    bl_idname = "pcc.probe_add"
    bl_label = "Parallax Probe"
    bl_options = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(name="Name", default="Probe")
    location: bpy.props.FloatVectorProperty(name="Location", size=3, subtype="TRANSLATION", unit="LENGTH")
    rotation: bpy.props.FloatVectorProperty(name="Rotation", size=3, subtype="EULER", unit="ROTATION")
    half_extents: bpy.props.FloatVectorProperty(
        name="Half Extents",
        description="Half the box's size along its axes",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        default=(2.0, 2.0, 1.5),
    )
    capture_offset: bpy.props.FloatVectorProperty(
        name="Capture Offset",
        description="Where the pictures are taken, from the box's centre along its axes",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Parallax probes are added in Object Mode")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self.properties.is_property_set("location"):
            self.location = context.scene.cursor.location
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            probe = add_probe(
                context.collection, self.name, self.location, self.rotation, self.half_extents, self.capture_offset
            )
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for item in context.selected_objects:
            item.select_set(False)
        probe.select_set(True)
        context.view_layer.objects.active = probe
        return {"FINISHED"}


class PCC_OT_bake(RunsJob, bpy.types.Operator):
    """Bake what the probes see. Esc cancels and leaves everything as it was"""

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
    _job: BakeJob | None = None
    _left: int = 0  # probes that are stale and that nothing shows
    _when_cancelled = "Bake cancelled; probes that were not finished keep their old bakes"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not all_probes(context.scene):
            cls.poll_message_set("The scene has no parallax probe: add one with Add › Light Probe › Parallax Probe")
            return False
        return True

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
            return {"FINISHED"}
        folder = bake_folder(context.scene)
        if folder is None:
            self.report({"INFO"}, "The file is not saved yet: pictures are packed into it")
        reuse = self.scope == "STALE"
        self._job = BakeJob(context.scene, context.view_layer, probes, folder, frames, reuse)
        return set()

    def _probes_in_scope(self, context: bpy.types.Context, frames: FrameRange | str | None) -> list[bpy.types.Object]:
        probes = all_probes(context.scene)
        if self.scope == "SELECTED":
            return [probe for probe in probes if probe.select_get(view_layer=context.view_layer)]
        if self.scope == "ALL":
            return probes
        waiting = waiting_among(last_plan.check(context.scene, context.view_layer), probes, frames)
        for line in waiting.unneeded:
            self.report({"INFO"}, line)
        self._left = len(waiting.unneeded)
        return list(waiting.probes)

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
        if failed:
            self.report({"ERROR"}, "; ".join(failed))
        return {"FINISHED"} if done else {"CANCELLED"}


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


_NOTHING_TO_BAKE = {
    "STALE": "All probes that anything shows are baked, and nothing has changed since",
    "ALL": "The scene has no probes",
    "SELECTED": "No probe is selected",
}


class PCC_OT_inject(bpy.types.Operator):
    """Let materials show the baked probes around them; the materials' own nodes are kept"""

    bl_idname = "pcc.inject"
    bl_label = "Inject into Materials"
    bl_options = {"REGISTER", "UNDO"}

    scope: _SCOPE

    def execute(self, context: bpy.types.Context) -> set[str]:
        objects = list(context.selected_objects) if self.scope == "SELECTED" else None
        try:
            report = injection.inject(context.scene, context.view_layer, objects)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        last_plan.keep(context.scene, context.view_layer, report.plan)
        for note in report.notes:
            self.report({"WARNING"}, note)
        self.report({"INFO"}, f"{len(report.materials)} materials show their probes")
        return {"FINISHED"}


class PCC_OT_remove(bpy.types.Operator):
    """Take the probes out of materials: they are again exactly what they were"""

    bl_idname = "pcc.remove"
    bl_label = "Remove from Materials"
    bl_options = {"REGISTER", "UNDO"}

    scope: _SCOPE

    def execute(self, context: bpy.types.Context) -> set[str]:
        restored = injection.remove(list(context.selected_objects) if self.scope == "SELECTED" else None)
        self.report({"INFO"}, f"{len(restored)} materials restored")
        return {"FINISHED"}


class PCC_OT_hidden_add(bpy.types.Operator):
    """Leave the other selected objects out of the active probe's capture"""

    bl_idname = "pcc.hidden_add"
    bl_label = "Hide Selected from Capture"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not (context.object and context.object.pcc_probe.is_probe and len(context.selected_objects) > 1):
            cls.poll_message_set("Select objects, and the probe last")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        hidden = context.object.pcc_probe.hidden_objects
        known = {item.object for item in hidden}
        for item in context.selected_objects:
            if item not in known and not item.pcc_probe.is_probe:
                hidden.add().object = item
        return {"FINISHED"}


class PCC_OT_hidden_remove(bpy.types.Operator):
    """Show an object in the active probe's capture again"""

    bl_idname = "pcc.hidden_remove"
    bl_label = "Show in Capture"
    bl_options = {"REGISTER", "UNDO"}

    index: bpy.props.IntProperty(min=0)

    def execute(self, context: bpy.types.Context) -> set[str]:
        hidden = context.object.pcc_probe.hidden_objects
        if self.index < len(hidden):
            hidden.remove(self.index)
        return {"FINISHED"}


CLASSES = (
    PCC_OT_probe_add,
    PCC_OT_bake,
    PCC_OT_bake_frames,
    PCC_OT_inject,
    PCC_OT_remove,
    PCC_OT_hidden_add,
    PCC_OT_hidden_remove,
)
