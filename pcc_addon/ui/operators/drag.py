"""What the handles of a probe do: they drag a wall of its box or of its influence, or its capture point."""

from __future__ import annotations

import bpy
import numpy as np
from bpy_extras import view3d_utils

from ...blender import reshaping
from ...core.dragging import Travel, Wall, along_line, on_plane, snapped, way_of
from ...core.errors import ProbeError

_FINE = 0.1  # of a step, where it is precise
_KEYS = "Ctrl: snap, Shift: precise, Right Click or Esc: cancel"
_AXES = "XYZ"


def _metres(context: bpy.types.Context, value: float) -> str:
    return bpy.utils.units.to_string(
        context.scene.unit_settings.system, "LENGTH", value * context.scene.unit_settings.scale_length, precision=5
    )


class _Drags:
    """A base of such operators, which say what the pointer means and what is moved.

    One drag is one undo step; what it moved can be typed afterwards.
    """

    _start: reshaping.Before | None = None
    _travel: Travel | None = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        probe = context.object
        if probe is None or not probe.pcc_probe.is_probe or probe.library is not None:
            cls.poll_message_set("The active object is no parallax probe of this file")
            return False
        return True

    def _given(self) -> np.ndarray:
        """How far it was moved, or is to be as somebody typed."""
        raise NotImplementedError

    def _pointed(self, context: bpy.types.Context, event: bpy.types.Event) -> np.ndarray | None:
        """Where the pointer is, as what is moved counts; None where the view cannot tell."""
        raise NotImplementedError

    def _move(self, context: bpy.types.Context, gone: np.ndarray) -> str:
        """Move it so far from where it was; returns what the header says."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            self._start = reshaping.before(context.object)
        except ProbeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._move(context, self._given())
        context.view_layer.update()  # materials follow now, as part of this undo step
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if context.region_data is None:
            return self.execute(context)
        try:
            self._start = reshaping.before(context.object)
        except ProbeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        pointed = self._pointed(context, event)
        if pointed is None:
            self.report({"WARNING"}, "The view looks along the way that this would move; turn the view")
            return {"CANCELLED"}
        self._travel = Travel(np.zeros_like(pointed), pointed)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type in {"ESC", "RIGHTMOUSE"}:
            reshaping.restore(context.object, self._start)
            return self._end(context, {"CANCELLED"})
        if event.type == "LEFTMOUSE" and event.value == "RELEASE":
            return self._end(context, {"FINISHED"} if np.any(self._travel.gone) else {"CANCELLED"})
        pointed = self._pointed(context, event)
        if pointed is not None:
            self._travel = self._travel.to(pointed, precise=event.shift)
            gone = self._travel.gone
            if event.ctrl:
                step = context.space_data.overlay.grid_scale_unit
                gone = snapped(gone, step * _FINE if event.shift else step)
            context.area.header_text_set(f"{self._move(context, gone)}    ({_KEYS})")
        return {"RUNNING_MODAL"}

    def _end(self, context: bpy.types.Context, how: set[str]) -> set[str]:
        context.area.header_text_set(None)
        context.view_layer.update()
        return how


def _ray(context: bpy.types.Context, event: bpy.types.Event) -> tuple[np.ndarray, np.ndarray]:
    """The eye, (3,) metres, and the way, (3,) unit, that the view looks along under the pointer."""
    where = context.region, context.region_data, (event.mouse_region_x, event.mouse_region_y)
    eye, look = view3d_utils.region_2d_to_origin_3d(*where), view3d_utils.region_2d_to_vector_3d(*where)
    return np.array(eye, np.float64), np.array(look, np.float64)


class PCC_OT_drag_wall(_Drags, bpy.types.Operator):
    """Drag a wall of the box, or of the influence. Ctrl snaps, Shift is precise"""

    bl_idname = "pcc.drag_wall"
    bl_label = "Move Probe Wall"
    bl_options = {"REGISTER", "UNDO", "INTERNAL", "BLOCKING"}

    axis: bpy.props.IntProperty(name="Axis", min=0, max=2, options={"SKIP_SAVE", "HIDDEN"})
    high: bpy.props.BoolProperty(name="High", options={"SKIP_SAVE", "HIDDEN"})
    influence: bpy.props.BoolProperty(name="Influence", options={"SKIP_SAVE", "HIDDEN"})
    metres: bpy.props.FloatProperty(
        name="Outwards", description="How far the wall moves out of the box", unit="LENGTH", options={"SKIP_SAVE"}
    )

    @property
    def _wall(self) -> Wall:
        return Wall(self.axis, self.high, self.influence)

    def _given(self) -> np.ndarray:
        return np.array(self.metres)

    def _pointed(self, context: bpy.types.Context, event: bpy.types.Event) -> np.ndarray | None:
        spec = self._start.spec
        metres = along_line(spec.box.centre, way_of(spec, self._wall), *_ray(context, event))
        return None if metres is None else np.array(metres)

    def _move(self, context: bpy.types.Context, gone: np.ndarray) -> str:
        self.metres = reshaping.move_wall(context.object, self._start, self._wall, float(gone))
        name = f"{'Influence' if self.influence else 'Box'} {'+' if self.high else '−'}{_AXES[self.axis]}"
        settings = context.object.pcc_probe
        if self.influence:
            reach = (settings.influence_high if self.high else settings.influence_low)[self.axis]
            return f"{name}: {_metres(context, reach)} beyond the box"
        size = 2.0 * float(self._start.spec.box.half_extents[self.axis]) + self.metres
        return f"{name}: {_metres(context, self.metres)}, size {_metres(context, size)}"


class PCC_OT_drag_capture_point(_Drags, bpy.types.Operator):
    """Drag the capture point; it counts from the next bake. Ctrl snaps, Shift is precise"""

    bl_idname = "pcc.drag_capture_point"
    bl_label = "Move Capture Point"
    bl_options = {"REGISTER", "UNDO", "INTERNAL", "BLOCKING"}

    by: bpy.props.FloatVectorProperty(
        name="Along Box Axes", size=3, subtype="XYZ", unit="LENGTH", options={"SKIP_SAVE"}
    )

    def _given(self) -> np.ndarray:
        return np.array(self.by)

    def _pointed(self, context: bpy.types.Context, event: bpy.types.Event) -> np.ndarray | None:
        spec = self._start.spec
        normal = np.array(context.region_data.view_rotation.to_matrix())[:, 2]
        place = on_plane(spec.capture_point, normal, *_ray(context, event))
        return None if place is None else np.linalg.solve(spec.box.axes / spec.box.half_extents, place)

    def _move(self, context: bpy.types.Context, gone: np.ndarray) -> str:
        self.by = gone
        reshaping.move_capture_point(context.object, self._start, tuple(gone))
        offset = context.object.pcc_probe.capture_offset
        return "Capture Offset: " + "  ".join(
            f"{axis} {_metres(context, value)}" for axis, value in zip(_AXES, offset, strict=True)
        )


CLASSES = (PCC_OT_drag_wall, PCC_OT_drag_capture_point)
