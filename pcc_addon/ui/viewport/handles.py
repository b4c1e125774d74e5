"""Handles of the active probe: an arrow on each wall of its box and of its influence, a ring at its capture point."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...blender.read.probes import probe_spec
from ...core.dragging import Wall, place_of, way_of
from ...core.errors import PccError
from ...core.probe import ProbeSpec

_ASIDE = 0.35  # of the half width: the influence's arrows beside those of the box
_OPACITY, _OPACITY_UNDER = 0.8, 1.0  # of a handle, and of that under the pointer
_WALLS = [Wall(axis, high) for axis in range(3) for high in (False, True)]
_REACHES = [Wall(wall.axis, wall.high, influence=True) for wall in _WALLS]


class PCC_GGT_probe(bpy.types.GizmoGroup):
    bl_idname = "PCC_GGT_probe"
    bl_label = "Parallax Probe"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "PERSISTENT"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        probe = context.object
        if probe is None or not probe.pcc_probe.is_probe or probe.library is not None:
            return False
        return context.mode == "OBJECT" and probe.select_get() and probe.visible_in_viewport_get(context.space_data)

    def setup(self, context: bpy.types.Context) -> None:
        theme = context.preferences.themes[0].user_interface
        self.arrows = {wall: self._arrow(wall, theme) for wall in (*_WALLS, *_REACHES)}
        self.point = self.gizmos.new("GIZMO_GT_move_3d")
        self.point.draw_style, self.point.draw_options = "RING_2D", {"ALIGN_VIEW", "FILL_SELECT"}
        self.point.scale_basis = 0.15
        self.point.target_set_operator("pcc.drag_capture_point")
        _paint(self.point, theme.gizmo_primary, theme)

    def _arrow(self, wall: Wall, theme: bpy.types.ThemeUserInterface) -> bpy.types.Gizmo:
        arrow = self.gizmos.new("GIZMO_GT_arrow_3d")
        arrow.draw_style = "NORMAL" if wall.influence else "BOX"
        arrow.length = 0.4
        drag = arrow.target_set_operator("pcc.drag_wall")
        drag.axis, drag.high, drag.influence = wall.axis, wall.high, wall.influence
        colour = theme.gizmo_secondary if wall.influence else (theme.axis_x, theme.axis_y, theme.axis_z)[wall.axis]
        _paint(arrow, colour, theme)
        return arrow

    def draw_prepare(self, context: bpy.types.Context) -> None:
        """Put the handles where the probe is now."""
        try:
            spec = probe_spec(context.object)
        except PccError:  # a box without volume, which the bake names
            for gizmo in self.gizmos:
                gizmo.hide = True
            return
        for wall, arrow in self.arrows.items():
            arrow.hide = wall.influence and not spec.corrected
            arrow.matrix_basis = _along(_place(spec, wall), way_of(spec, wall))
        self.point.hide = spec.source.stretched
        self.point.matrix_basis = Matrix.Translation(Vector(spec.capture_point))


def _place(spec: ProbeSpec, wall: Wall) -> np.ndarray:
    """Where the arrow of a wall starts: on the middle of the box's, on the border where the influence has faded."""
    if not wall.influence:
        return place_of(spec, wall)
    return place_of(spec, wall, float(spec.fading_reach[int(wall.high), wall.axis]), _ASIDE)


def _along(place: np.ndarray, way: np.ndarray) -> Matrix:
    """A place, with Z along a unit vector."""
    turn = Vector((0.0, 0.0, 1.0)).rotation_difference(Vector(way)).to_matrix().to_4x4()
    return Matrix.Translation(Vector(place)) @ turn


def _paint(gizmo: bpy.types.Gizmo, colour: bpy.types.bpy_prop_array, theme: bpy.types.ThemeUserInterface) -> None:
    gizmo.color, gizmo.alpha = colour[:3], _OPACITY
    gizmo.color_highlight, gizmo.alpha_highlight = theme.gizmo_hi[:3], _OPACITY_UNDER


CLASSES = (PCC_GGT_probe,)
