"""The last misfits in the viewport: the walls of the box by their misfit, and squares on what is not seen."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ...blender.accuracy.misfit_job import ProbeMisfit
from ...core.accuracy.misfit_pictures import UNSEEN
from ..kept import last_misfit
from ..kept.redrawing import redraw
from . import misfit_shapes


@dataclass(frozen=True, eq=False)
class _Drawn:
    """What the graphics card has of a misfit, made once."""

    found: ProbeMisfit
    walls: gpu.types.GPUBatch
    patches: gpu.types.GPUBatch | None


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
            _draw_one(_batches(found))
    finally:
        gpu.state.face_culling_set("NONE")
        gpu.state.depth_test_set(before[0])
        gpu.state.depth_mask_set(before[1])
        gpu.state.blend_set(before[2])


def _draw_one(drawn: _Drawn) -> None:
    gpu.state.face_culling_set("BACK")  # one looks into the box from outside, and at surfaces from their sides
    drawn.walls.draw(gpu.shader.from_builtin("SMOOTH_COLOR"))
    if drawn.patches is not None:
        shader = gpu.shader.from_builtin("UNIFORM_COLOR")
        shader.bind()
        shader.uniform_float("color", (*UNSEEN, 1.0))
        drawn.patches.draw(shader)


def _batches(found: ProbeMisfit) -> _Drawn:
    kept = _drawn.get(found.probe)
    if kept is None or kept.found is not found:
        kept = _drawn[found.probe] = _made(found)
    return kept


def _made(found: ProbeMisfit) -> _Drawn:
    walls = misfit_shapes.walls(found.misfit)
    coloured = {"pos": walls.points, "color": walls.colours}
    patches = misfit_shapes.patches(found.misfit, found.unseen)
    plain = gpu.shader.from_builtin("UNIFORM_COLOR")
    return _Drawn(
        found,
        batch_for_shader(gpu.shader.from_builtin("SMOOTH_COLOR"), "TRIS", coloured, indices=walls.triangles),
        batch_for_shader(plain, "TRIS", {"pos": patches.points}, indices=patches.triangles)
        if len(patches.triangles)
        else None,
    )


def _redraw(manager: bpy.types.WindowManager, context: bpy.types.Context) -> None:
    redraw()


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
