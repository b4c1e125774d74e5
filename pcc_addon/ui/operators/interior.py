"""The operators that make window materials."""

from __future__ import annotations

from pathlib import Path

import bpy
from mathutils import Matrix

from ...blender import windows
from ...blender.read.probes import all_probes, named_probes
from ...blender.shade.interior import RoomImage, Window, room_of_probe, window_material
from ...core.effects.interior import Cells
from ...core.errors import PccError
from ...core.room_map import Corner
from ...core.window import Side
from .by_hand import warn_of_missing_faces

_AUTOMATIC = "0: that of the room in the picture"
_CORNERS = [("NONE", "None", "There is no such layer")] + [
    (corner.name, corner.value.capitalize(), f"The {corner.value} tile of the room map") for corner in Corner
]


class _Options:
    """What both operators ask."""

    name: bpy.props.StringProperty(name="Name", description="Of the material", default="Window")
    cells: bpy.props.EnumProperty(
        name="Rooms by",
        items=[
            ("OBJECT", "Size", "Rooms repeat along the pane in metres, from the object's origin"),
            ("UV", "UV Map", "Each unit square of the UV map is a room"),
        ],
    )
    width: bpy.props.FloatProperty(name="Width", description=f"Of a room. {_AUTOMATIC}", min=0.0, unit="LENGTH")
    depth: bpy.props.FloatProperty(name="Depth", description=f"Of a room. {_AUTOMATIC}", min=0.0, unit="LENGTH")
    height: bpy.props.FloatProperty(name="Height", description=f"Of a room. {_AUTOMATIC}", min=0.0, unit="LENGTH")
    seed: bpy.props.IntProperty(name="Seed", description="Another number, other rooms")
    middle: bpy.props.StringProperty(
        name="Middle Layer", description="A flat picture with alpha of what stands in the room", subtype="FILE_PATH"
    )
    curtains: bpy.props.StringProperty(
        name="Curtains", description="A flat picture with alpha of what hangs at the pane", subtype="FILE_PATH"
    )

    def _layers(self) -> list[bpy.types.Image | None]:
        return [windows.layer(path) if path else None for path in (self.middle, self.curtains)]

    def _finish(self, context: bpy.types.Context, window: Window, size: tuple[float, float, float]) -> set[str]:
        """Make the material and put it on the selected objects, or on a new pane where none is selected."""
        width, depth, height = (
            given or own for given, own in zip((self.width, self.depth, self.height), size, strict=True)
        )
        panes = [o for o in context.selected_objects if o.type == "MESH" and not o.library and not o.data.library]
        values = {"Width": width, "Depth": depth, "Height": height, "Seed": float(self.seed)}
        if panes and windows.lies_flat(panes[0].data):
            values["Up"] = (0.0, 1.0, 0.0)
        material = window_material(self.name, window, values)
        if not panes:
            place = Matrix.Translation(context.scene.cursor.location)
            panes = [windows.add_pane(context.collection, self.name, place, width, height)]
            for item in context.selected_objects:
                item.select_set(False)
            panes[0].select_set(True)
            context.view_layer.objects.active = panes[0]
        windows.put_on(material, panes)
        self.report({"INFO"}, f"'{material.name}' shows rooms behind {len(panes)} objects")
        return {"FINISHED"}


class PCC_OT_interior_add(_Options, bpy.types.Operator):
    """Show rooms that probes have baked behind selected objects, or behind a new pane. Selected probes are the rooms"""

    bl_idname = "pcc.interior_add"
    bl_label = "Window onto Baked Rooms"
    bl_options = {"REGISTER", "UNDO"}

    probes: bpy.props.StringProperty(
        name="Probes", description="Names of probes to choose rooms from, with commas between; empty: the selected ones"
    )
    side: bpy.props.EnumProperty(
        name="Window in",
        description="Which wall of the probe's box the window is in, by the box's own axes",
        items=[(side.name, side.value, f"The wall at {side.value}") for side in Side],
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Window materials are added in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            probes = self._probes(context)
            rooms = tuple(room_of_probe(probe, Side[self.side]) for probe in probes)
            if not rooms:
                raise PccError("no probe is selected to show behind the window; select baked probes with the panes")
            across, away, up = rooms[0].picture.half_edges
            size = tuple(2.0 * sum(c * c for c in edge) ** 0.5 for edge in (across, away, up))
            warn_of_missing_faces(self, probes)
            return self._finish(context, Window(rooms, Cells[self.cells], *self._layers()), size)
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def _probes(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        names = [name.strip() for name in self.probes.split(",") if name.strip()]
        if names:
            return named_probes(context.scene, names)
        return [probe for probe in all_probes(context.scene) if probe.select_get(view_layer=context.view_layer)]


class PCC_OT_interior_add_pictures(_Options, bpy.types.Operator):
    """Show rooms of picture files behind selected objects, or behind a new pane"""

    bl_idname = "pcc.interior_add_pictures"
    bl_label = "Window onto Pictures"
    bl_options = {"REGISTER", "UNDO"}

    directory: bpy.props.StringProperty(subtype="DIR_PATH", options={"HIDDEN"})
    files: bpy.props.CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN"})
    layout_of: bpy.props.EnumProperty(
        name="Layout",
        items=[
            ("EQUIRECTANGULAR", "Equirectangular", "Twice as wide as high; the back wall is in the middle"),
            (
                "ROOM_MAP",
                "Room Map",
                "3 × 3 tiles, the back wall in the middle one, as JIWindowBox and wParallax have it",
            ),
        ],
    )
    middle_corner: bpy.props.EnumProperty(name="Middle Layer", items=_CORNERS, default="BOTTOM_LEFT")
    curtain_corner: bpy.props.EnumProperty(name="Curtains", items=_CORNERS, default="TOP_LEFT")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return PCC_OT_interior_add.poll(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        for name in ("layout_of", "name", "cells", "width", "depth", "height", "seed"):
            layout.prop(self, name)
        corners = self.layout_of == "ROOM_MAP"
        for name in ("middle_corner", "curtain_corner") if corners else ("middle", "curtains"):
            layout.prop(self, name)

    def execute(self, context: bpy.types.Context) -> set[str]:
        paths = [str(Path(self.directory) / item.name) for item in self.files if item.name]
        unfolded = self.layout_of == "ROOM_MAP"
        try:
            if not paths:
                raise PccError("no picture is chosen to show behind the window")
            rooms: tuple[RoomImage, ...] = tuple(
                windows.unfolded_room(path) if unfolded else windows.equirectangular_room(path) for path in paths
            )
            if unfolded:
                layers = [
                    None if corner == "NONE" else windows.layer(paths[0], Corner[corner])
                    for corner in (self.middle_corner, self.curtain_corner)
                ]
            else:
                layers = self._layers()
            return self._finish(context, Window(rooms, Cells[self.cells], *layers), (4.0, 4.0, 3.0))
        except PccError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


CLASSES = (PCC_OT_interior_add, PCC_OT_interior_add_pictures)
