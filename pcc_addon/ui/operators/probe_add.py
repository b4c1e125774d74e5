"""The operator that adds a probe."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...blender import placing
from ...blender.probes import add_probe
from ...blender.properties import PRESETS
from ...blender.read.probes import all_probes
from ...blender.setting_groups import apply_preset, take_over
from ...core.errors import PccError
from ...core.placing import contains
from ...core.presets import Preset
from ...core.probe import Box

_NO_TURN = 1e-6  # radians that only rounding makes
_DIGITS = 5  # decimals of metres that a person may want to read
_HERE = {"SKIP_SAVE"}  # options of what is no matter of the next probe


class Around(str, Enum):
    """What a new probe's box is laid around."""

    VALUES = "VALUES"
    SELECTION = "SELECTION"
    ROOM = "ROOM"
    CURSOR = "CURSOR"


_AROUND = bpy.props.EnumProperty(
    name="Around",
    items=[
        (Around.VALUES.value, "Values", "Where the values below say"),
        (Around.SELECTION.value, "Selection", "The selected objects stand around: walls lie on the box"),
        (Around.ROOM.value, "Room", "The room around the 3D cursor, the view or what is selected, as rays find it"),
        (Around.CURSOR.value, "Cursor", "2 m at the 3D cursor"),
    ],
    options=_HERE,
)


class PCC_OT_probe_add(bpy.types.Operator):
    """Add a parallax probe: a box on the selected walls, or of the room around the 3D cursor or the view"""

    bl_idname = "pcc.probe_add"
    bl_label = "Parallax Probe"
    bl_options = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(name="Name", default="Probe", options=_HERE)
    around: _AROUND
    placed: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # what the values were last found around
    location: bpy.props.FloatVectorProperty(
        name="Location", size=3, subtype="TRANSLATION", unit="LENGTH", options=_HERE
    )
    rotation: bpy.props.FloatVectorProperty(name="Rotation", size=3, subtype="EULER", unit="ROTATION", options=_HERE)
    half_extents: bpy.props.FloatVectorProperty(
        name="Half Extents",
        description="Half the box's size along its axes",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        default=(2.0, 2.0, 1.5),
        options=_HERE,
    )
    capture_offset: bpy.props.FloatVectorProperty(
        name="Capture Offset",
        description="Where the pictures are taken, from the box's centre along its axes",
        size=3,
        subtype="XYZ",
        unit="LENGTH",
        options=_HERE,
    )
    like: bpy.props.StringProperty(
        name="Settings Of",
        description="The probe whose engine, quality, correction and falloff the new one gets; empty: the defaults",
        options=_HERE,
    )
    preset: bpy.props.EnumProperty(
        name="Preset",
        description="What the new probe is set to; that of the scene where it is added in the window",
        items=PRESETS,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Parallax probes are added in Object Mode")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        given = [name for name in ("location", "rotation", "half_extents", "around") if self._is_given(name)]
        if not self._is_given("like"):
            self.like = _last_probe(context)
        if not given:
            self._find_place(context)
        elif "location" not in given:
            self.location = context.scene.cursor.location
        if not self._is_given("preset"):
            self.preset = context.scene.pcc.preset
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        if self.around not in (Around.VALUES, self.placed) and not self._place(context, Around(self.around)):
            self.report({"WARNING"}, _MISSING[Around(self.around)])
        self.placed = self.around
        try:
            probe = add_probe(
                context.collection, self.name, self.location, self.rotation, self.half_extents, self.capture_offset
            )
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        other = next((item for item in all_probes(context.scene) if item.name == self.like and item != probe), None)
        if other is not None:
            take_over(probe, other)
        if self.preset != "NONE":
            apply_preset(probe, Preset[self.preset])
        for item in context.selected_objects:
            item.select_set(False)
        probe.select_set(True)
        context.view_layer.objects.active = probe
        return {"FINISHED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "name")
        layout.prop(self, "around")
        for name in ("location", "rotation", "half_extents", "capture_offset"):
            layout.prop(self, name)
        layout.prop(self, "preset")
        layout.prop_search(self, "like", context.scene, "objects", icon="LIGHTPROBE_SPHERE")

    def _is_given(self, name: str) -> bool:
        return self.properties.is_property_set(name)

    def _find_place(self, context: bpy.types.Context) -> None:
        """The first of what there is."""
        for around in (Around.SELECTION, Around.ROOM, Around.CURSOR):
            if (around is not Around.SELECTION or _encloses(context)) and self._place(context, around):
                self.around = self.placed = around.value
                return

    def _place(self, context: bpy.types.Context, around: Around) -> bool:
        """Set the values so that the box is around something; False where there is nothing."""
        box = _box(context, around)
        if box is None:
            return False
        self.location = [round(value, _DIGITS) for value in box.centre]
        turn = Matrix((box.axes / box.half_extents).tolist()).to_euler()
        self.rotation = [0.0 if abs(angle) < _NO_TURN else angle for angle in turn]
        self.half_extents = [round(value, _DIGITS) for value in box.half_extents]
        return True


_MISSING = {
    Around.SELECTION: "Nothing is selected that has a size; the box is where the values say",
    Around.ROOM: "No room is found around the 3D cursor or the view: set the cursor into it; the box is where the "
    "values say",
}


def _box(context: bpy.types.Context, around: Around) -> Box | None:
    scene, view_layer, cursor = context.scene, context.view_layer, context.scene.cursor.location
    if around is Around.CURSOR:
        return Box.from_matrix("new", np.array(Matrix.Translation(cursor)))
    selected = placing.selection_box(scene, view_layer, context.selected_objects)
    if around is Around.SELECTION:
        return selected
    first = None
    for room in _rooms(context, selected):
        first = first or room
        if not any(contains(room, np.array(probe.matrix_world.translation)) for probe in all_probes(scene)):
            return room  # one that has no probe yet
    return first


def _rooms(context: bpy.types.Context, selected: Box | None) -> Iterator[Box]:
    """The rooms that may be meant, the likeliest first."""
    eye = _eye(context)
    places = [context.scene.cursor.location, eye, Vector(selected.centre) if selected is not None else None]
    for place in places:
        room = placing.room_box(context.view_layer, place) if place is not None else None
        if room is not None and (place is not eye or contains(room, np.array(eye))):
            yield room


def _encloses(context: bpy.types.Context) -> bool:
    """Whether what is selected is around a room, and not something in it."""
    scene, view_layer, objects = context.scene, context.view_layer, context.selected_objects
    box = placing.selection_box(scene, view_layer, objects)
    return box is not None and not placing.stands_in_room(scene, view_layer, objects, box, _eye(context))


def _eye(context: bpy.types.Context) -> Vector | None:
    """From where the 3D view looks; None where that is no place."""
    region = getattr(context.space_data, "region_3d", None)
    return region.view_matrix.inverted().translation if region is not None and region.is_perspective else None


def _last_probe(context: bpy.types.Context) -> str:
    """The active probe, else the one that was made last; empty where there is none."""
    probes = all_probes(context.scene)
    active = context.view_layer.objects.active
    if active in probes:
        return active.name
    return max(probes, key=lambda probe: probe.session_uid).name if probes else ""


CLASSES = (PCC_OT_probe_add,)
