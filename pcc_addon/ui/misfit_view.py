"""The last misfits in the viewport: the walls of the box by their misfit, and what is not seen as points."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ..blender.accuracy.misfit_job import ProbeMisfit
from ..core.accuracy.misfit_pictures import UNSEEN
from . import last_misfit, misfit_shapes

_POINT = 3.0  # pixels, at a scale of 1


@dataclass(frozen=True, eq=False)
class _Drawn:
    """What the graphics card has of a misfit, made once."""

    found: ProbeMisfit
    walls: gpu.types.GPUBatch
    points: gpu.types.GPUBatch | None


_drawn: dict[str, _Drawn] = {}  # by the probe's name
_handle: object = None


def draw() -> None:
    """Draw the misfits of the scene that is looked at, where that is switched on."""
    context = bpy.context
    if not context.window_manager.pcc_show_misfit:
        _drawn.clear()
        return
    shown = [found for found in last_misfit.all_of(context.scene) if found.misfit is not None]
    for name in set(_drawn) - {found.probe for found in shown}:
        del _drawn[name]
    if not shown:
        return
    before = gpu.state.depth_test_get(), gpu.state.depth_mask_get(), gpu.state.blend_get()
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(False)
    gpu.state.blend_set("ALPHA")
    try:
        for found in shown:
            _draw_one(_batches(found), context.preferences.system.ui_scale or 1.0)
    finally:
        gpu.state.face_culling_set("NONE")
        gpu.state.depth_test_set(before[0])
        gpu.state.depth_mask_set(before[1])
        gpu.state.blend_set(before[2])
        gpu.state.point_size_set(1.0)


def _draw_one(drawn: _Drawn, scale: float) -> None:
    gpu.state.face_culling_set("BACK")  # one looks into the box from outside
    drawn.walls.draw(gpu.shader.from_builtin("SMOOTH_COLOR"))
    gpu.state.face_culling_set("NONE")
    if drawn.points is not None:
        shader = gpu.shader.from_builtin("POINT_UNIFORM_COLOR")
        shader.bind()
        shader.uniform_float("color", (*UNSEEN, 1.0))
        gpu.state.point_size_set(_POINT * scale)
        drawn.points.draw(shader)


def _batches(found: ProbeMisfit) -> _Drawn:
    kept = _drawn.get(found.probe)
    if kept is None or kept.found is not found:
        kept = _drawn[found.probe] = _made(found)
    return kept


def _made(found: ProbeMisfit) -> _Drawn:
    walls = misfit_shapes.walls(found.misfit)
    points = misfit_shapes.points(found.misfit, found.unseen)
    return _Drawn(
        found,
        batch_for_shader(
            gpu.shader.from_builtin("SMOOTH_COLOR"),
            "TRIS",
            {"pos": walls.points, "color": walls.colours},
            indices=walls.triangles,
        ),
        batch_for_shader(gpu.shader.from_builtin("POINT_UNIFORM_COLOR"), "POINTS", {"pos": points})
        if len(points)
        else None,
    )


def _redraw(manager: bpy.types.WindowManager, context: bpy.types.Context) -> None:
    last_misfit.redraw()


def register() -> None:
    global _handle
    bpy.types.WindowManager.pcc_show_misfit = bpy.props.BoolProperty(
        name="Show in Viewport",
        description="Colour the box by how far it is from what the capture point sees (red: things before it, blue: "
        "beyond it), and mark the surfaces that are not seen",
        update=_redraw,
    )
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _drawn.clear()
    del bpy.types.WindowManager.pcc_show_misfit
